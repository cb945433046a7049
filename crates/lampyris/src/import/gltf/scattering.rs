//! How the materials of glTF scatter light, as our own.
//!
//! The roughness of glTF is the square root of the microfacets' α, like that of `principled`.

use super::Importer;
use super::document::Material;
use super::extensions::{Specular, SpecularGlossiness, Volume};
use super::surface::{inline, share};
use crate::error::Result;
use crate::scene::description::{
    Channel, Color, Ior, IorFormula, MaterialDescription, Paint, Principled, PrincipledThin, Roughness,
    TextureDescription,
};

/// Reflectance at normal incidence and index of refraction that `principled` still takes.
const LARGEST_F0: f32 = 0.95;
const SMALLEST_ETA: f32 = 1.001;

/// The core of a material.
struct Core {
    base_color: Paint,
    metallic: Paint,
    roughness: Paint,
    /// Index of refraction that gives the reflectance of what is not metal.
    eta: f32,
}

impl Importer<'_> {
    /// How a material that stands at `path` scatters light, without normal map and holes.
    pub(super) fn scattering(
        &mut self,
        material: &Material,
        has_colors: bool,
        name: &str,
        path: &str,
    ) -> Result<MaterialDescription> {
        let scattering = self.of_all_wavelengths(material, has_colors, name, path)?;
        let dispersion = material.extensions.dispersion.as_ref().map_or(0.0, |extension| extension.dispersion);
        if dispersion.is_nan() || dispersion <= 0.0 {
            return Ok(scattering);
        }
        match scattering {
            MaterialDescription::Glass { ior: Ior::Number(d), exterior_ior, reflectance, transmittance, roughness } => {
                let ior = Ior::Formula(IorFormula::Abbe([d, 20.0 / dispersion]));
                Ok(MaterialDescription::Glass { ior, exterior_ior, reflectance, transmittance, roughness })
            }
            other => {
                self.warn(path, "KHR_materials_dispersion is passed over: only a body of clear glass disperses light");
                Ok(other)
            }
        }
    }

    fn of_all_wavelengths(
        &mut self,
        material: &Material,
        has_colors: bool,
        name: &str,
        path: &str,
    ) -> Result<MaterialDescription> {
        let core = match &material.extensions.specular_glossiness {
            Some(old) => self.specular_glossiness(old, name, path)?,
            None => self.metallic_roughness(material, name, path)?,
        };
        let core = match has_colors {
            true => Core { base_color: self.with_vertex_colors(core.base_color, name, path), ..core },
            false => core,
        };
        let extensions = &material.extensions;
        if extensions.unlit.is_some() {
            self.warn(path, "KHR_materials_unlit is approximated by a diffuse surface");
            return Ok(two_sided(MaterialDescription::Diffuse { reflectance: core.base_color }));
        }
        if extensions.iridescence.as_ref().is_some_and(|extension| extension.iridescence_factor > 0.0) {
            self.warn(path, "KHR_materials_iridescence is approximated by the surface without its film");
        }
        let transmission = match &extensions.transmission {
            Some(extension) => {
                let path = format!("{path}.extensions.KHR_materials_transmission.transmissionTexture");
                let texture = self.paint(&extension.transmission_texture, Channel::Red, true, &path)?;
                let factor = Paint::grey(share(extension.transmission_factor));
                self.product(factor, texture, &format!("{name}-transmission"), &path)
            }
            None => Paint::grey(0.0),
        };
        if transmission == Paint::grey(0.0) || core.metallic == Paint::grey(1.0) {
            return Ok(two_sided(MaterialDescription::Principled(Box::new(self.opaque(material, core, path)?))));
        }
        match &extensions.volume {
            Some(volume) if volume.thickness_factor > 0.0 => {
                self.clear(material, volume, core, transmission, name, path)
            }
            _ => self.thin(material, core, transmission, path),
        }
    }

    fn metallic_roughness(&mut self, material: &Material, name: &str, path: &str) -> Result<Core> {
        let pbr = &material.pbr_metallic_roughness;
        let path = format!("{path}.pbrMetallicRoughness");
        let [r, g, b, _] = pbr.base_color_factor.map(share);
        let texture_path = format!("{path}.baseColorTexture");
        let texture = self.paint(&pbr.base_color_texture, Channel::Color, false, &texture_path)?;
        let base_color = self.product(Color([r, g, b]).into(), texture, &format!("{name}-base-color"), &texture_path);
        let texture_path = format!("{path}.metallicRoughnessTexture");
        let mut channel = |factor: f32, channel: Channel, word: &str| -> Result<Paint> {
            let texture = self.paint(&pbr.metallic_roughness_texture, channel, true, &texture_path)?;
            Ok(self.product(Paint::grey(share(factor)), texture, &format!("{name}-{word}"), &texture_path))
        };
        let roughness = channel(pbr.roughness_factor, Channel::Green, "roughness")?;
        let metallic = channel(pbr.metallic_factor, Channel::Blue, "metallic")?;
        let ior = self.ior(material, &path);
        Ok(Core { base_color, metallic, roughness, eta: ior })
    }

    /// The older model: a dielectric of the given reflectance, or a metal where that is all there is.
    fn specular_glossiness(&mut self, old: &SpecularGlossiness, name: &str, path: &str) -> Result<Core> {
        self.warn(path, "KHR_materials_pbrSpecularGlossiness is approximated by metalness and roughness");
        let path = format!("{path}.extensions.KHR_materials_pbrSpecularGlossiness");
        let largest = |color: &[f32]| color.iter().copied().map(share).fold(0.0, f32::max);
        let is_textured = old.diffuse_texture.is_some() || old.specular_glossiness_texture.is_some();
        let reflectance = if old.specular_glossiness_texture.is_some() { 0.04 } else { largest(&old.specular_factor) };
        let is_metal = !is_textured && reflectance > 0.25 && reflectance > largest(&old.diffuse_factor[..3]);
        let [r, g, b, _] = old.diffuse_factor.map(share);
        let color = Color(if is_metal { old.specular_factor.map(share) } else { [r, g, b] });
        let texture_path = format!("{path}.diffuseTexture");
        let texture = self.paint(&old.diffuse_texture, Channel::Color, false, &texture_path)?;
        let base_color = self.product(color.into(), texture, &format!("{name}-base-color"), &texture_path);
        let texture_path = format!("{path}.specularGlossinessTexture");
        let glossiness = share(old.glossiness_factor);
        let roughness = match self.paint(&old.specular_glossiness_texture, Channel::Alpha, false, &texture_path)? {
            Paint::Color(_) => Paint::grey(1.0 - glossiness),
            weight => {
                // 1 where the picture has no gloss, and what the factor leaves where it has all.
                let mix =
                    TextureDescription::Mix { weight, first: Paint::grey(1.0), second: Paint::grey(1.0 - glossiness) };
                Paint::Texture(self.named_texture(format!("{name}-roughness"), mix, &texture_path))
            }
        };
        Ok(Core { base_color, metallic: Paint::grey(f32::from(u8::from(is_metal))), roughness, eta: eta(reflectance) })
    }

    fn with_vertex_colors(&mut self, base_color: Paint, name: &str, path: &str) -> Paint {
        let colors = self.named_texture("vertex-colours".into(), TextureDescription::VertexColor {}, path);
        self.product(Paint::Texture(colors), base_color, &format!("{name}-base-color"), path)
    }

    fn ior(&mut self, material: &Material, path: &str) -> f32 {
        match &material.extensions.ior {
            Some(extension) if extension.ior >= 1.0 => extension.ior,
            // 0 stands for a reflectance of 1, for the sake of files converted from the older model.
            Some(extension) if extension.ior == 0.0 => 1.5,
            Some(extension) => {
                self.warn(path, format!("an index of refraction of {} is passed over", extension.ior));
                1.5
            }
            None => 1.5,
        }
    }

    fn opaque(&mut self, material: &Material, core: Core, path: &str) -> Result<Principled> {
        let extensions = &material.extensions;
        let mut principled = Principled {
            base_color: core.base_color,
            metallic: core.metallic,
            roughness: core.roughness,
            eta: Some(core.eta.max(SMALLEST_ETA)),
            ..Principled::default()
        };
        if let Some(specular) = &extensions.specular {
            self.warn(path, "KHR_materials_specular is approximated by an index of refraction");
            principled.eta = Some(specular_eta(core.eta, specular));
        }
        if let Some(coat) = extensions.clearcoat.as_ref().filter(|coat| coat.clearcoat_factor > 0.0) {
            self.warn(path, "KHR_materials_clearcoat is approximated by the coat of 'principled', on the same normals");
            let path = format!("{path}.extensions.KHR_materials_clearcoat.clearcoatTexture");
            let texture = self.paint(&coat.clearcoat_texture, Channel::Red, true, &path)?;
            let factor = Paint::grey(share(coat.clearcoat_factor));
            principled.clearcoat = self.product(factor, texture, "clearcoat", &path);
            principled.clearcoat_gloss = Paint::grey(coat_gloss(share(coat.clearcoat_roughness_factor)));
        }
        if let Some(sheen) = extensions.sheen.as_ref().filter(|sheen| sheen.sheen_color_factor != [0.0; 3]) {
            self.warn(path, "KHR_materials_sheen is approximated by the sheen of 'principled'");
            let [r, g, b] = sheen.sheen_color_factor.map(share);
            principled.sheen = Paint::grey(r.max(g).max(b));
            let is_coloured = sheen.sheen_color_texture.is_some() || r != g || g != b;
            principled.sheen_tint = Paint::grey(if is_coloured { 1.0 } else { 0.0 });
        }
        if let Some(anisotropy) = extensions.anisotropy.as_ref().filter(|extension| extension.anisotropy_strength > 0.0)
        {
            self.warn(path, "KHR_materials_anisotropy is approximated along the texture coordinates");
            principled.anisotropic = Paint::grey(share(anisotropy.anisotropy_strength));
        }
        Ok(principled)
    }

    /// The boundary of a clear body.
    fn clear(
        &mut self,
        material: &Material,
        volume: &Volume,
        core: Core,
        transmission: Paint,
        name: &str,
        path: &str,
    ) -> Result<MaterialDescription> {
        let tint = Paint::Color(self.absorption(volume, path));
        let base_color = self.product(core.base_color, tint, &format!("{name}-tint"), path);
        if transmission != Paint::grey(1.0) || core.metallic != Paint::grey(0.0) {
            let core = Core { base_color, ..core };
            let opaque = self.opaque(material, core, path)?;
            return Ok(MaterialDescription::Principled(Box::new(Principled { spec_trans: transmission, ..opaque })));
        }
        let roughness = match core.roughness {
            Paint::Color(Color([0.0, ..])) => None,
            roughness => {
                let alpha = self.product(roughness.clone(), roughness, &format!("{name}-alpha"), path);
                Some(Roughness { alpha, alpha_v: None, distribution: Default::default(), multiple_scattering: false })
            }
        };
        // The facets of a rough boundary without a change of index have no direction.
        let ior = if roughness.is_some() { core.eta.max(SMALLEST_ETA) } else { core.eta };
        let (ior, exterior_ior, reflectance) = (ior.into(), 1.0.into(), Paint::grey(1.0));
        Ok(MaterialDescription::Glass { ior, exterior_ior, reflectance, transmittance: base_color, roughness })
    }

    /// What each of two boundaries lets through of white light, so that a way of the thickness between them has the
    /// colour that it should have.
    fn absorption(&mut self, volume: &Volume, path: &str) -> Color {
        let lengths = 0.5 * volume.thickness_factor / volume.attenuation_distance;
        if volume.attenuation_color == [1.0; 3] || lengths.is_nan() || lengths <= 0.0 {
            return Color::grey(1.0);
        }
        self.warn(path, "absorption (KHR_materials_volume) is approximated by a tint of the surface for its thickness");
        Color(volume.attenuation_color.map(|channel| share(share(channel).powf(lengths))))
    }

    /// A thin sheet: light goes straight through.
    fn thin(
        &mut self,
        material: &Material,
        core: Core,
        transmission: Paint,
        path: &str,
    ) -> Result<MaterialDescription> {
        let is_smooth = core.roughness == Paint::grey(0.0) && transmission == Paint::grey(1.0);
        let sheet = match is_smooth {
            true => MaterialDescription::ThinGlass {
                ior: core.eta,
                exterior_ior: 1.0,
                reflectance: Paint::grey(1.0),
                transmittance: core.base_color.clone(),
            },
            false => MaterialDescription::PrincipledThin(Box::new(PrincipledThin {
                base_color: core.base_color.clone(),
                roughness: core.roughness.clone(),
                spec_trans: transmission,
                eta: core.eta.max(SMALLEST_ETA),
                ..PrincipledThin::default()
            })),
        };
        if core.metallic == Paint::grey(0.0) {
            return Ok(sheet);
        }
        let weight = core.metallic.clone();
        let metal = self.opaque(material, Core { metallic: Paint::grey(1.0), ..core }, path)?;
        let metal = two_sided(MaterialDescription::Principled(Box::new(metal)));
        Ok(MaterialDescription::Blend { weight, first: inline(sheet), second: inline(metal) })
    }
}

/// Opaque surfaces of glTF look alike from both sides, or are not seen from behind at all.
fn two_sided(material: MaterialDescription) -> MaterialDescription {
    MaterialDescription::TwoSided { front: inline(material), back: None }
}

/// The index of refraction with this reflectance at normal incidence.
fn eta(reflectance: f32) -> f32 {
    let root = reflectance.clamp(0.0, LARGEST_F0).sqrt();
    ((1.0 + root) / (1.0 - root)).max(SMALLEST_ETA)
}

/// The index of refraction with the reflectance, at normal incidence and in the brightest channel, that
/// `KHR_materials_specular` asks for.
fn specular_eta(ior: f32, specular: &Specular) -> f32 {
    let [r, g, b] = specular.specular_color_factor;
    let root = (ior - 1.0) / (ior + 1.0);
    eta((root * root * r.max(g).max(b)).min(1.0) * share(specular.specular_factor))
}

/// The gloss of `principled`'s coat, whose α is 0.1 at gloss 0 and 0.001 at gloss 1 [Burley 2012], nearest to a coat of this
/// roughness.
fn coat_gloss(roughness: f32) -> f32 {
    share((0.1 - roughness * roughness) / (0.1 - 0.001))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_index_of_refraction_has_the_reflectance_that_it_is_made_from() {
        assert!((eta(0.04) - 1.5).abs() < 1e-6);
        assert!((specular_eta(1.5, &Specular::default()) - 1.5).abs() < 1e-5);
        let half = Specular { specular_factor: 0.25, ..Specular::default() };
        assert!((specular_eta(1.5, &half) - 1.1 / 0.9).abs() < 1e-5);
        assert!(eta(1.0).is_finite() && eta(0.0) == SMALLEST_ETA);
    }

    #[test]
    fn the_coat_is_as_smooth_as_it_can_be_made() {
        assert_eq!(coat_gloss(0.0), 1.0);
        assert_eq!(coat_gloss(1.0), 0.0);
    }
}
