//! Materials, by name and in place.

use std::collections::HashMap;

use super::textures::Quantity;
use super::{check, textures};
use crate::error::{Error, Result, did_you_mean};
use crate::material::{Coefficients, MAX_PARTS, Material, MaterialId, Materials, Plastic};
use crate::scene::Assets;
use crate::scene::description::{Color, MaterialDescription, MaterialRef, Paint, SceneDescription};
use crate::spectrum::Spectrum;
use crate::texture::{Asks, Texture};

/// Resolves materials as shapes ask for them.
pub(super) struct Builder<'d> {
    description: &'d SceneDescription,
    textures: textures::Builder<'d>,
    materials: Materials,
    named: HashMap<&'d str, Named>,
    /// What the textures of each material ask for, where they ask for anything.
    asks: HashMap<MaterialId, Asks>,
    default: Option<MaterialId>,
    black: Option<MaterialId>,
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
        Builder { description, textures, materials, named, asks, default: None, black: None }
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

    /// The material of a shape: what it says, else black for a lamp and grey for all others.
    pub(super) fn of_shape(&mut self, material: Option<&'d MaterialRef>, emits: bool) -> Result<MaterialId> {
        if let Some(material) = material {
            return self.resolve(material, "material");
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
        self.named.insert(name, Named::UnderWay);
        // The fault lies where the material is written, not where it is used.
        let id = self.add(material).map_err(|error| error.under(&format!("materials.{name}")).at_root())?;
        self.named.insert(name, Named::Done(id));
        Ok(id)
    }

    fn add(&mut self, material: &'d MaterialDescription) -> Result<MaterialId> {
        let material = match material {
            MaterialDescription::Diffuse { reflectance } => {
                Material::Diffuse { reflectance: self.paint("reflectance", reflectance)? }
            }
            MaterialDescription::Mirror { reflectance } => {
                Material::Mirror { reflectance: self.paint("reflectance", reflectance)? }
            }
            MaterialDescription::Glass { ior, exterior_ior, reflectance, transmittance, roughness: None } => {
                Material::Glass {
                    ior: ratio(*ior, *exterior_ior)?,
                    reflectance: self.paint("reflectance", reflectance)?,
                    transmittance: self.paint("transmittance", transmittance)?,
                }
            }
            MaterialDescription::ThinGlass { ior, exterior_ior, reflectance, transmittance } => Material::ThinGlass {
                ior: ratio(*ior, *exterior_ior)?,
                reflectance: self.paint("reflectance", reflectance)?,
                transmittance: self.paint("transmittance", transmittance)?,
            },
            MaterialDescription::Conductor { metal: None, eta, k, reflectance, roughness: None } => {
                Material::Conductor {
                    eta: check::light("eta", eta.unwrap_or_default())?,
                    k: check::light("k", k.unwrap_or_default())?,
                    reflectance: self.paint("reflectance", reflectance)?,
                }
            }
            MaterialDescription::Plastic { reflectance, specular, ior, exterior_ior, nonlinear, roughness: None } => {
                let ior = ratio(*ior, *exterior_ior)?;
                Material::Plastic {
                    reflectance: self.paint("reflectance", reflectance)?,
                    specular: self.paint("specular", specular)?,
                    ior,
                    inner_reflectance: Plastic::inner_reflectance(ior),
                    nonlinear: *nonlinear,
                }
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
            _ => return Err(Error::new("this material cannot be rendered yet")),
        };
        let id = self.materials.add(material);
        let parts = self.materials.parts(id);
        if parts > MAX_PARTS {
            return Err(Error::new(format!("a mix of {parts} materials is too deep"))
                .with_hint(format!("at most {MAX_PARTS} can be mixed")));
        }
        Ok(id)
    }

    fn paint(&mut self, key: &str, paint: &'d Paint) -> Result<Texture> {
        self.textures.paint(key, paint, Quantity::Share)
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

/// Index inside over index outside.
fn ratio(interior: f32, exterior: f32) -> Result<f32> {
    Ok(check::above_zero("ior", interior)? / check::above_zero("exterior-ior", exterior)?)
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
