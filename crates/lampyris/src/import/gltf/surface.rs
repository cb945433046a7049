//! What a material says of a surface: how it scatters light, whether it glows, which texture coordinates it wants.

use super::Importer;
use super::document::{AlphaMode, Material, TextureInfo};
use super::source::missing;
use super::texture::uv_set;
use crate::error::Result;
use crate::scene::description::{
    Channel, Color, EmissionDescription, MaterialDescription, MaterialRef, Paint, TextureDescription,
};

/// A material as a shape of the description has it.
#[derive(Clone, Debug)]
pub(super) struct Surface {
    /// Name in the description's materials.
    pub material: String,
    pub emission: Option<EmissionDescription>,
    /// Which of the mesh's texture coordinates its textures use.
    pub uv_set: u32,
}

impl Importer<'_> {
    /// The surface of material number `index`, or of the format's default, on a mesh with or without colours.
    pub(super) fn surface(&mut self, index: Option<usize>, has_colors: bool) -> Result<Surface> {
        if let Some(known) = self.surfaces.get(&(index, has_colors)) {
            return Ok(known.clone());
        }
        let default = Material::default();
        let materials = &self.document.materials;
        let (path, material) = match index {
            Some(index) => {
                let path = format!("materials[{index}]");
                let material = materials.get(index).ok_or_else(|| missing(&self.spots, &path, materials.len()))?;
                (path, material)
            }
            None => ("materials".into(), &default),
        };
        let name = self.free_name(index, material, has_colors);
        let uv_set = self.chosen_uv_set(material, &path);
        let description = self.scattering(material, has_colors, &name, &path)?;
        let description = self.with_normals(material, description, &path)?;
        let description = self.with_holes(material, description, &name, &path)?;
        let emission = self.emission(material, &name, &path)?;
        self.note(format!("materials.{name}"), &path);
        self.imported.description.materials.insert(name.clone(), description);
        let surface = Surface { material: name, emission, uv_set };
        self.surfaces.insert((index, has_colors), surface.clone());
        Ok(surface)
    }

    fn free_name(&self, index: Option<usize>, material: &Material, has_colors: bool) -> String {
        let name = match (&material.name, index) {
            (Some(name), _) if !name.is_empty() => name.clone(),
            (_, Some(index)) => format!("material{index}"),
            (_, None) => "default".into(),
        };
        let name = if has_colors { format!("{name} with vertex colours") } else { name };
        let taken = |name: &String| self.imported.description.materials.contains_key(name);
        match taken(&name) {
            true => format!("{name} (material {})", index.map_or("default".into(), |index| index.to_string())),
            false => name,
        }
    }

    /// The texture coordinates of the first texture.
    fn chosen_uv_set(&mut self, material: &Material, path: &str) -> u32 {
        let (pbr, extensions) = (&material.pbr_metallic_roughness, &material.extensions);
        let textures: [&Option<TextureInfo>; 6] = [
            &pbr.base_color_texture,
            &pbr.metallic_roughness_texture,
            &material.normal_texture,
            &material.emissive_texture,
            extensions.transmission.as_ref().map_or(&None, |transmission| &transmission.transmission_texture),
            extensions.specular_glossiness.as_ref().map_or(&None, |old| &old.diffuse_texture),
        ];
        let mut sets = textures.into_iter().flatten().map(uv_set);
        let first = sets.next().unwrap_or(0);
        if sets.any(|set| set != first) {
            let message =
                format!("all textures of a material use the coordinates TEXCOORD_{first} of its first texture");
            self.warn(path, message);
        }
        if first > 1 {
            self.warn(path, format!("the texture coordinates TEXCOORD_{first} are not read: TEXCOORD_0 is used"));
        }
        first
    }

    fn with_normals(
        &mut self,
        material: &Material,
        description: MaterialDescription,
        path: &str,
    ) -> Result<MaterialDescription> {
        let Some(info) = &material.normal_texture else { return Ok(description) };
        if material.extensions.unlit.is_some() {
            return Ok(description);
        }
        let path = format!("{path}.normalTexture");
        let Some(normals) = self.texture(info, Channel::Color, true, &path)? else { return Ok(description) };
        let strength = info.scale.unwrap_or(1.0);
        Ok(match description {
            // The picture turns the normal of the side that is seen.
            MaterialDescription::TwoSided { front, back: None } => {
                let front = inline(MaterialDescription::NormalMap { normals, strength, material: front });
                MaterialDescription::TwoSided { front, back: None }
            }
            other => MaterialDescription::NormalMap { normals, strength, material: inline(other) },
        })
    }

    fn with_holes(
        &mut self,
        material: &Material,
        description: MaterialDescription,
        name: &str,
        path: &str,
    ) -> Result<MaterialDescription> {
        if material.alpha_mode == AlphaMode::Opaque {
            return Ok(description);
        }
        let (factor, texture) = match &material.extensions.specular_glossiness {
            Some(old) => (old.diffuse_factor[3], &old.diffuse_texture),
            None => {
                let pbr = &material.pbr_metallic_roughness;
                (pbr.base_color_factor[3], &pbr.base_color_texture)
            }
        };
        let cutoff = material.alpha_cutoff.unwrap_or(0.5);
        let opacity = match (material.alpha_mode, texture) {
            (AlphaMode::Mask, None) => Paint::grey(if factor < cutoff { 0.0 } else { 1.0 }),
            (mode, texture) => {
                let path = format!("{path}.pbrMetallicRoughness.baseColorTexture");
                let texture = self.paint(texture, Channel::Alpha, false, &path)?;
                let opacity = self.product(Paint::grey(share(factor)), texture, &format!("{name}-opacity"), &path);
                if mode == AlphaMode::Mask { self.cut_off(opacity, cutoff, name, &path) } else { opacity }
            }
        };
        Ok(match opacity {
            Paint::Color(Color([1.0, 1.0, 1.0])) => description,
            opacity => MaterialDescription::Mask { opacity, material: inline(description) },
        })
    }

    /// Opaque where `opacity` reaches `cutoff`, and a hole elsewhere.
    fn cut_off(&mut self, opacity: Paint, cutoff: f32, name: &str, path: &str) -> Paint {
        let least = if cutoff >= 0.0 { cutoff.min(f32::MAX) } else { 0.0 };
        match opacity {
            Paint::Color(Color(channels)) => Paint::grey(if channels[0] < least { 0.0 } else { 1.0 }),
            texture => {
                let threshold = TextureDescription::Threshold { texture, least };
                Paint::Texture(self.named_texture(format!("{name}-holes"), threshold, path))
            }
        }
    }

    fn emission(&mut self, material: &Material, name: &str, path: &str) -> Result<Option<EmissionDescription>> {
        let strength =
            material.extensions.emissive_strength.as_ref().map_or(1.0, |extension| extension.emissive_strength);
        let factor = material.emissive_factor.map(|channel| if channel > 0.0 { channel } else { 0.0 });
        if factor == [0.0; 3] || strength.is_nan() || strength <= 0.0 || material.extensions.unlit.is_some() {
            return Ok(None);
        }
        let path = format!("{path}.emissiveTexture");
        let texture = self.paint(&material.emissive_texture, Channel::Color, false, &path)?;
        self.glows |= matches!(texture, Paint::Color(_)) || strength > 1.0;
        let radiance = self.product(Color(factor).into(), texture, &format!("{name}-emission"), &path);
        Ok(Some(EmissionDescription {
            radiance: Some(radiance),
            power: None,
            scale: strength,
            two_sided: material.double_sided,
        }))
    }

    /// A texture as a paint; white where there is none.
    pub(super) fn paint(
        &mut self,
        texture: &Option<TextureInfo>,
        channel: Channel,
        raw: bool,
        path: &str,
    ) -> Result<Paint> {
        let Some(info) = texture else { return Ok(Paint::grey(1.0)) };
        Ok(self.texture(info, channel, raw, path)?.map_or(Paint::grey(1.0), Paint::Texture))
    }
}

pub(super) fn inline(material: MaterialDescription) -> MaterialRef {
    MaterialRef::Inline(Box::new(material))
}

/// The number cut to 0..1, as factors are.
pub(super) fn share(value: f32) -> f32 {
    if value.is_nan() { 0.0 } else { value.clamp(0.0, 1.0) }
}
