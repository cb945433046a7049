//! Materials, by name and in place.

use std::collections::HashMap;

use glam::Vec2;

use super::textures::Quantity;
use super::{check, textures};
use crate::error::{Error, Result, did_you_mean};
use crate::material::{
    BothSides, Coat, Coefficients, Ior, MAX_PARTS, Material, MaterialId, Materials, Metal, Microfacets, Plastic,
    PrincipledTextures, PrincipledThinTextures, RoughTextures, Table, white_reflection,
};
use crate::scene::Assets;
use crate::scene::description::{
    self, Color, IorFormula, MaterialDescription, MaterialRef, Paint, Principled, PrincipledThin, Roughness,
    SceneDescription,
};
use crate::spectrum::{Dispersion, Spectrum, metals};
use crate::texture::{Asks, Texture};

/// Named materials can be made of named materials, so deep.
const DEEPEST: usize = 64;

/// Resolves materials as shapes ask for them.
pub(super) struct Builder<'d> {
    description: &'d SceneDescription,
    textures: textures::Builder<'d>,
    materials: Materials,
    named: HashMap<&'d str, Named>,
    /// How many named materials are under way.
    depth: usize,
    /// What the textures of each material ask for, where they ask for anything.
    asks: HashMap<MaterialId, Asks>,
    default: Option<MaterialId>,
    black: Option<MaterialId>,
    nothing: Option<MaterialId>,
}

/// How far a named material is.
#[derive(Clone, Copy)]
enum Named {
    UnderWay,
    Done(MaterialId),
}

impl<'d> Builder<'d> {
    pub(super) fn new(description: &'d SceneDescription, assets: &'d dyn Assets) -> Builder<'d> {
        let (textures, materials) = (textures::Builder::new(description, assets), Materials::default());
        let (named, asks) = (HashMap::new(), HashMap::new());
        Builder { description, textures, materials, named, depth: 0, asks, default: None, black: None, nothing: None }
    }

    /// The textures, for what else has some.
    pub(super) fn textures(&mut self) -> &mut textures::Builder<'d> {
        &mut self.textures
    }

    /// What the textures of a material, and of those that it is made of, ask for.
    pub(super) fn asks(&self, id: MaterialId) -> Asks {
        self.asks.get(&id).copied().unwrap_or_default()
    }

    pub(super) fn finish(self) -> Materials {
        self.materials
    }

    /// The material of a shape: what it says, else black for a lamp, nothing for what only holds a medium, and grey for
    /// all others.
    pub(super) fn of_shape(
        &mut self,
        material: Option<&'d MaterialRef>,
        emits: bool,
        holds: bool,
    ) -> Result<MaterialId> {
        if let Some(material) = material {
            return self.resolve(material, "material");
        }
        if holds && !emits {
            return Ok(*self.nothing.get_or_insert_with(|| self.materials.add(Material::None)));
        }
        let (slot, reflectance) = if emits { (&mut self.black, 0.0) } else { (&mut self.default, 0.5) };
        let reflectance = Texture::Constant(Spectrum::grey(reflectance));
        Ok(*slot.get_or_insert_with(|| self.materials.add(Material::Diffuse { reflectance })))
    }

    fn resolve(&mut self, material: &'d MaterialRef, key: &str) -> Result<MaterialId> {
        let of_others = self.textures.take_asked();
        let id = match material {
            MaterialRef::Named(name) => self.by_name(name, key)?,
            MaterialRef::Inline(material) => self.add(material).map_err(|error| error.under(key))?,
        };
        // Of a material that was built before, the textures have asked before.
        let asks = self.textures.take_asked() | self.asks(id);
        self.asks.insert(id, asks);
        self.textures.ask(of_others | asks);
        Ok(id)
    }

    fn by_name(&mut self, name: &'d str, key: &str) -> Result<MaterialId> {
        match self.named.get(name) {
            Some(Named::Done(id)) => return Ok(*id),
            Some(Named::UnderWay) => {
                return Err(Error::at_key(key, format!("the material '{name}' contains itself")));
            }
            None => {}
        }
        let Some(material) = self.description.materials.get(name) else {
            return Err(unknown("material", name, self.description.materials.keys(), key));
        };
        if self.depth == DEEPEST {
            return Err(Error::at_key(key, format!("the material '{name}' is too deep in others"))
                .with_hint(format!("materials can be made of materials made of materials, {DEEPEST} in all")));
        }
        self.named.insert(name, Named::UnderWay);
        self.depth += 1;
        // The fault lies where the material is written, not where it is used.
        let id = self.add(material).map_err(|error| error.under(&format!("materials.{name}")).at_root())?;
        self.depth -= 1;
        self.named.insert(name, Named::Done(id));
        Ok(id)
    }

    fn add(&mut self, material: &'d MaterialDescription) -> Result<MaterialId> {
        let material = match material {
            MaterialDescription::None {} => Material::None,
            MaterialDescription::Diffuse { reflectance } => {
                Material::Diffuse { reflectance: self.paint("reflectance", reflectance)? }
            }
            MaterialDescription::Mirror { reflectance } => {
                Material::Mirror { reflectance: self.paint("reflectance", reflectance)? }
            }
            MaterialDescription::Glass { ior, exterior_ior, reflectance, transmittance, roughness: None } => {
                Material::Glass {
                    ior: self.boundary(ior, exterior_ior)?,
                    reflectance: self.paint("reflectance", reflectance)?,
                    transmittance: self.paint("transmittance", transmittance)?,
                }
            }
            MaterialDescription::ThinGlass { ior, exterior_ior, reflectance, transmittance } => Material::ThinGlass {
                ior: ratio(*ior, *exterior_ior)?,
                reflectance: self.paint("reflectance", reflectance)?,
                transmittance: self.paint("transmittance", transmittance)?,
            },
            MaterialDescription::Glass {
                ior,
                exterior_ior,
                reflectance,
                transmittance,
                roughness: Some(roughness),
            } => {
                let ior = self.boundary(ior, exterior_ior)?;
                let reflectance = self.paint("reflectance", reflectance)?;
                let transmittance = self.paint("transmittance", transmittance)?;
                self.rough_glass(ior, reflectance, transmittance, roughness)
                    .map_err(|error| error.under("roughness"))?
            }
            MaterialDescription::Conductor { metal, eta, k, reflectance, roughness } => {
                let (eta, k) = index(metal.as_deref(), *eta, *k)?;
                let reflectance = self.paint("reflectance", reflectance)?;
                match roughness {
                    None => Material::Conductor { eta, k, reflectance },
                    Some(roughness) => self
                        .rough_conductor(Metal::new(eta, k), reflectance, roughness)
                        .map_err(|error| error.under("roughness"))?,
                }
            }
            MaterialDescription::Plastic { reflectance, specular, ior, exterior_ior, nonlinear, roughness } => {
                let ior = ratio(*ior, *exterior_ior)?;
                let (reflectance, specular) =
                    (self.paint("reflectance", reflectance)?, self.paint("specular", specular)?);
                let nonlinear = *nonlinear;
                match roughness {
                    None => {
                        let inner_reflectance = Plastic::inner_reflectance(ior);
                        Material::Plastic { reflectance, specular, ior, inner_reflectance, nonlinear }
                    }
                    Some(roughness) => {
                        let (rough, alpha) = self.rough(roughness).map_err(|error| error.under("roughness"))?;
                        let (distribution, whole) = (roughness.distribution, roughness.multiple_scattering);
                        let coat = Table::new(alpha, |alpha| Coat::new(distribution, alpha, ior, whole));
                        Material::RoughPlastic { reflectance, specular, ior, rough, coat, nonlinear }
                    }
                }
            }
            MaterialDescription::RoughDiffuse { reflectance, alpha, fast } => Material::RoughDiffuse {
                reflectance: self.paint("reflectance", reflectance)?,
                alpha: self.amount("alpha", alpha)?,
                fast: *fast,
            },
            MaterialDescription::DiffuseTransmission { reflectance, transmittance } => Material::DiffuseTransmission {
                reflectance: self.paint("reflectance", reflectance)?,
                transmittance: self.paint("transmittance", transmittance)?,
            },
            MaterialDescription::Phong { diffuse, specular, exponent } => Material::Phong {
                diffuse: self.paint("diffuse", diffuse)?,
                specular: self.paint("specular", specular)?,
                exponent: self.amount("exponent", exponent)?,
            },
            MaterialDescription::Ward { variant, diffuse, specular, alpha_u, alpha_v } => Material::Ward {
                variant: *variant,
                diffuse: self.paint("diffuse", diffuse)?,
                specular: self.paint("specular", specular)?,
                alpha: Box::new([self.amount("alpha-u", alpha_u)?, self.amount("alpha-v", alpha_v)?]),
            },
            MaterialDescription::Principled(principled) => Material::Principled(Box::new(self.principled(principled)?)),
            MaterialDescription::PrincipledThin(thin) => {
                Material::PrincipledThin(Box::new(self.principled_thin(thin)?))
            }
            MaterialDescription::Coefficients { kd, ks, kt, ior, fresnel } => {
                Material::Coefficients(coefficients(*kd, *ks, *kt, *ior, *fresnel)?)
            }
            MaterialDescription::TwoSided { front, back } => {
                let front_id = self.resolve(front, "front")?;
                let back = back.as_ref().map_or(Ok(front_id), |back| self.resolve(back, "back"))?;
                Material::TwoSided { front: front_id, back }
            }
            MaterialDescription::Mask { opacity, material } => Material::Mask {
                opacity: self.paint("opacity", opacity)?,
                material: self.resolve(material, "material")?,
            },
            MaterialDescription::Blend { weight, first, second } => Material::Blend {
                weight: self.paint("weight", weight)?,
                first: self.resolve(first, "first")?,
                second: self.resolve(second, "second")?,
            },
            MaterialDescription::NormalMap { normals, strength, material } => Material::NormalMap {
                normals: self.textures.raw("normals", normals)?,
                strength: check::finite("strength", *strength)?,
                material: self.resolve(material, "material")?,
            },
            MaterialDescription::BumpMap { height, scale, material } => Material::BumpMap {
                height: self.textures.named(height, "height", Quantity::Height)?,
                scale: check::finite("scale", *scale)?,
                material: self.resolve(material, "material")?,
            },
        };
        let id = self.materials.add(material);
        let parts = self.materials.parts(id);
        if parts > MAX_PARTS {
            return Err(Error::new(format!("a mix of {parts} materials is too deep"))
                .with_hint(format!("at most {MAX_PARTS} can be mixed")));
        }
        Ok(id)
    }

    /// The roughness of a boundary, and its mean α if that is the same everywhere.
    fn rough(&mut self, roughness: &'d Roughness) -> Result<(RoughTextures, Option<f32>)> {
        let alpha_u = self.amount("alpha", &roughness.alpha)?;
        let alpha_v = match &roughness.alpha_v {
            Some(alpha) => Some(self.amount("alpha-v", alpha)?),
            None => None,
        };
        let constant = match (&alpha_u, &alpha_v) {
            (Texture::Constant(alpha), None) => Some(alpha.mean()),
            (Texture::Constant(u), Some(Texture::Constant(v))) => Some((u.mean() * v.mean()).sqrt()),
            _ => None,
        };
        Ok((RoughTextures { distribution: roughness.distribution, alpha_u, alpha_v }, constant))
    }

    fn rough_conductor(&mut self, metal: Metal, reflectance: Texture, roughness: &'d Roughness) -> Result<Material> {
        let (rough, alpha) = self.rough(roughness)?;
        let facets = |alpha: f32| Microfacets::new(roughness.distribution, Vec2::splat(alpha));
        let white = roughness.multiple_scattering.then(|| Table::new(alpha, |alpha| white_reflection(&facets(alpha))));
        Ok(Material::RoughConductor { metal, reflectance, rough, white })
    }

    fn rough_glass(
        &mut self,
        ior: Ior,
        reflectance: Texture,
        transmittance: Texture,
        roughness: &'d Roughness,
    ) -> Result<Material> {
        let (rough, alpha) = self.rough(roughness)?;
        // Between equal substances there is nothing to be rough, and no facet that could be found from two directions.
        let at_d = ior.at_d();
        if (at_d - 1.0).abs() < 1e-4 {
            return Ok(Material::Glass { ior, reflectance, transmittance });
        }
        let facets = |alpha: f32| Microfacets::new(roughness.distribution, Vec2::splat(alpha));
        let once =
            roughness.multiple_scattering.then(|| Table::new(alpha, |alpha| BothSides::new(&facets(alpha), at_d)));
        Ok(Material::RoughGlass { ior, reflectance, transmittance, rough, once })
    }

    /// The index of a boundary between two substances.
    fn boundary(&self, interior: &description::Ior, exterior: &description::Ior) -> Result<Ior> {
        let index = self.description.film.time.as_ref().map(|time| time.index).unwrap_or_default();
        Ok(boundary(interior, exterior)?.with_index(index))
    }

    fn principled(&mut self, from: &'d Principled) -> Result<PrincipledTextures> {
        let spec_trans = self.paint("spec-trans", &from.spec_trans)?;
        let transmits = !matches!(&spec_trans, Texture::Constant(share) if share.is_zero());
        let eta = match from.eta {
            Some(eta) => check::above_zero("eta", eta)?,
            None => {
                let specular = check::share("specular", Color::grey(from.specular))?.max();
                let specular = if transmits { specular.max(1e-3) } else { specular };
                2.0 / (1.0 - (0.08 * specular).sqrt()) - 1.0
            }
        };
        Ok(PrincipledTextures {
            base_color: self.paint("base-color", &from.base_color)?,
            roughness: self.paint("roughness", &from.roughness)?,
            anisotropic: self.paint("anisotropic", &from.anisotropic)?,
            metallic: self.paint("metallic", &from.metallic)?,
            spec_trans,
            transmits,
            eta: not_one(eta, transmits),
            spec_tint: self.paint("spec-tint", &from.spec_tint)?,
            sheen: self.paint("sheen", &from.sheen)?,
            sheen_tint: self.paint("sheen-tint", &from.sheen_tint)?,
            flatness: self.paint("flatness", &from.flatness)?,
            clearcoat: self.paint("clearcoat", &from.clearcoat)?,
            clearcoat_gloss: self.paint("clearcoat-gloss", &from.clearcoat_gloss)?,
        })
    }

    fn principled_thin(&mut self, from: &'d PrincipledThin) -> Result<PrincipledThinTextures> {
        let diff_trans = self.amount("diff-trans", &from.diff_trans)?;
        if let Texture::Constant(value) = &diff_trans
            && value.max() > 2.0
        {
            return Err(Error::at_key("diff-trans", format!("diff-trans must not exceed 2, but is {}", value.max())));
        }
        Ok(PrincipledThinTextures {
            base_color: self.paint("base-color", &from.base_color)?,
            roughness: self.paint("roughness", &from.roughness)?,
            anisotropic: self.paint("anisotropic", &from.anisotropic)?,
            spec_trans: self.paint("spec-trans", &from.spec_trans)?,
            eta: check::above_zero("eta", from.eta)?,
            spec_tint: self.paint("spec-tint", &from.spec_tint)?,
            sheen: self.paint("sheen", &from.sheen)?,
            sheen_tint: self.paint("sheen-tint", &from.sheen_tint)?,
            flatness: self.paint("flatness", &from.flatness)?,
            diff_trans,
        })
    }

    /// A paint of shares, 0 to 1.
    fn paint(&mut self, key: &str, paint: &'d Paint) -> Result<Texture> {
        self.textures.paint(key, paint, Quantity::Share)
    }

    /// A paint of numbers that may exceed 1.
    fn amount(&mut self, key: &str, paint: &'d Paint) -> Result<Texture> {
        self.textures.paint(key, paint, Quantity::Light)
    }
}

/// The name at `key` is none of `names`.
pub(super) fn unknown<'n>(what: &str, name: &str, names: impl Iterator<Item = &'n String> + Clone, key: &str) -> Error {
    let error = Error::at_key(key, format!("there is no {what} named '{name}'"));
    match did_you_mean(name, names.clone().map(String::as_str)) {
        Some(near) => error.with_hint(format!("did you mean '{near}'?")),
        None => {
            let names: Vec<&str> = names.map(String::as_str).collect();
            error.with_hint(if names.is_empty() {
                format!("the scene names no {what} at all")
            } else {
                format!("the scene has: {}", names.join(", "))
            })
        }
    }
}

/// The complex index of refraction of a metal, by name or by numbers.
fn index(metal: Option<&str>, eta: Option<Color>, k: Option<Color>) -> Result<(Spectrum, Spectrum)> {
    match (metal, eta, k) {
        (Some(name), None, None) => {
            let (eta, k) = metals::named(name).ok_or_else(|| {
                let error = Error::at_key("metal", format!("no metal named '{name}' is known"));
                match did_you_mean(name, metals::METALS.iter().map(|metal| metal.0)) {
                    Some(near) => error.with_hint(format!("did you mean '{near}'?")),
                    None => error.with_hint("give `eta` and `k` instead"),
                }
            })?;
            Ok((Spectrum::from_rgb(eta), Spectrum::from_rgb(k)))
        }
        (None, Some(eta), Some(k)) => Ok((check::light("eta", eta)?, check::light("k", k)?)),
        _ => Err(Error::new("a conductor needs either `metal` or both `eta` and `k`")),
    }
}

/// Where light passes, an index of 1 leaves no facet that could be found from two directions; nobody sees a difference.
fn not_one(ior: f32, transmits: bool) -> f32 {
    if transmits && (ior - 1.0).abs() < 1e-3 { 1.001 } else { ior }
}

/// Index inside over index outside.
fn ratio(interior: f32, exterior: f32) -> Result<f32> {
    Ok(check::above_zero("ior", interior)? / check::above_zero("exterior-ior", exterior)?)
}

/// The phase index of a boundary between two substances.
fn boundary(interior: &description::Ior, exterior: &description::Ior) -> Result<Ior> {
    if let (description::Ior::Number(interior), description::Ior::Number(exterior)) = (interior, exterior) {
        return Ok(ratio(*interior, *exterior)?.into());
    }
    Ok(Ior::new(dispersion("ior", interior)?, dispersion("exterior-ior", exterior)?))
}

/// The index of refraction of a substance over the wavelength.
fn dispersion(key: &str, ior: &description::Ior) -> Result<Dispersion> {
    let dispersion = match ior {
        description::Ior::Number(number) => return Ok(Dispersion::None(check::above_zero(key, *number)?.into())),
        description::Ior::Substance(name) => {
            return Dispersion::of_substance(name).ok_or_else(|| {
                let error = Error::at_key(key, format!("no substance named '{name}' is known"));
                let known: Vec<&str> = Dispersion::substances().collect();
                match did_you_mean(name, known.iter().copied()) {
                    Some(near) => error.with_hint(format!("did you mean '{near}'?")),
                    None => error.with_hint(format!("known are {}; or give a formula", known.join(", "))),
                }
            });
        }
        description::Ior::Formula(IorFormula::Sellmeier([b1, b2, b3, c1, c2, c3])) => {
            let terms = [[b1, c1], [b2, c2], [b3, c3], [&0.0; 2]];
            Dispersion::Sellmeier(terms.map(|term| term.map(|number| f64::from(*number))))
        }
        description::Ior::Formula(IorFormula::Cauchy(terms)) => Dispersion::Cauchy(terms.map(f64::from)),
        description::Ior::Formula(IorFormula::Abbe([d, number])) => {
            check::above_zero(key, *number)?;
            Dispersion::of_abbe(f64::from(*d), f64::from(*number))
        }
    };
    // A resonance among the colours, or numbers of another unit.
    let odd = (380..=780).find(|&nanometres| !(0.1..10.0).contains(&dispersion.at(nanometres.into())));
    match odd {
        None => Ok(dispersion),
        Some(nanometres) => {
            let index = dispersion.at(nanometres.into());
            Err(Error::at_key(key, format!("{key} is {index} at {nanometres} nm, which is no index of refraction"))
                .with_hint("formulas have the wavelength in µm, and C in µm²"))
        }
    }
}

fn coefficients(kd: Color, ks: Color, kt: Color, ior: f32, fresnel: bool) -> Result<Coefficients> {
    let (kd, ks, kt) = (check::share("kd", kd)?, check::share("ks", ks)?, check::share("kt", kt)?);
    for (channel, sum) in ["red", "green", "blue"].iter().zip((kd + ks + kt).to_rgb()) {
        // Three decimal numbers that add up to 1 may exceed it by rounding.
        if sum > 1.0 + 1e-5 {
            return Err(Error::at_key("kd", format!("kd + ks + kt is {sum} in {channel}, more than 1"))
                .with_hint("a surface cannot send back more light than it gets"));
        }
    }
    Ok(Coefficients { kd, ks, kt, ior: check::above_zero("ior", ior)?, fresnel })
}
