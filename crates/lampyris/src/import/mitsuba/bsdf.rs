//! BSDFs: each to the nearest material we have.
//!
//! Mitsuba's opaque BSDFs are black from behind unless wrapped in `twosided`; ours have two sides. A
//! [`Scattering`] therefore knows whether it is one-sided, and gets a black back where it is finished.

use super::Importer;
use super::document::{Kind, Value};
use super::named;
use super::query::Query;
use super::spectrum::Role;
use crate::error::{Result, did_you_mean};
use crate::scene::description::{Color, MaterialDescription, MaterialRef, Paint};
use crate::spectrum::metals;

/// A material before it is decided what its back is like.
struct Scattering {
    material: MaterialDescription,
    /// Whether nothing is reflected from behind.
    one_sided: bool,
}

impl Scattering {
    fn one_sided(material: MaterialDescription) -> Scattering {
        Scattering { material, one_sided: true }
    }

    fn complete(material: MaterialDescription) -> Scattering {
        Scattering { material, one_sided: false }
    }

    fn finished(self) -> MaterialDescription {
        match self.one_sided {
            true => MaterialDescription::TwoSided { front: inline(self.material), back: Some(inline(black())) },
            false => self.material,
        }
    }
}

fn inline(material: MaterialDescription) -> MaterialRef {
    MaterialRef::Inline(Box::new(material))
}

fn black() -> MaterialDescription {
    MaterialDescription::Diffuse { reflectance: Paint::grey(0.0) }
}

/// What Mitsuba gives a shape without a BSDF that does not emit.
pub(super) fn default_material() -> MaterialRef {
    inline(Scattering::one_sided(MaterialDescription::Diffuse { reflectance: Paint::grey(0.5) }).finished())
}

impl Importer<'_> {
    /// A BSDF of the scene itself, which stays in the description under its id; one without an id is of no use.
    pub(super) fn named_bsdf(&mut self, object: usize) -> Result<()> {
        match self.document.objects[object].id {
            Some(_) => self.material(object).map(|_| ()),
            None => Ok(()),
        }
    }

    /// The material of a shape: by name where the BSDF has an id, so that it stands in the description once.
    pub(super) fn material(&mut self, object: usize) -> Result<MaterialRef> {
        if let Some(name) = self.materials.get(&object) {
            return Ok(MaterialRef::Named(name.clone()));
        }
        let material = self.bsdf(object, 0)?.finished();
        let Some(id) = &self.document.objects[object].id else { return Ok(inline(material)) };
        self.note(format!("materials.{id}"), self.document.objects[object].spot);
        self.materials.insert(object, id.clone());
        self.description().materials.insert(id.clone(), material);
        Ok(MaterialRef::Named(id.clone()))
    }

    fn bsdf(&mut self, object: usize, depth: usize) -> Result<Scattering> {
        let query = self.query(object);
        self.visit(query, depth)?;
        let plugin = query.object.plugin.as_str();
        if let Some(smooth @ ("conductor" | "dielectric" | "plastic" | "diffuse")) = plugin.strip_prefix("rough") {
            self.left_out(object, &format!("the smooth '{smooth}' is used"));
            query.ignore(&["alpha", "alpha_u", "alpha_v", "distribution", "sample_visible", "use_fast_approx"]);
        }
        let scattering = match plugin {
            "diffuse" | "roughdiffuse" => Scattering::one_sided(self.diffuse(query, "reflectance")?),
            "dielectric" | "roughdielectric" => Scattering::complete(self.dielectric(query)?),
            "thindielectric" => Scattering::complete(self.thin_dielectric(query)?),
            "conductor" | "roughconductor" => Scattering::one_sided(self.conductor(query)?),
            "plastic" | "roughplastic" => Scattering::one_sided(self.plastic(query)?),
            "null" => {
                let material = inline(black());
                Scattering::complete(MaterialDescription::Mask { opacity: Paint::grey(0.0), material })
            }
            "twosided" => self.two_sided(query, depth)?,
            "mask" => self.mask(query, depth)?,
            "blendbsdf" => self.blend(query, depth)?,
            "mixturebsdf" => self.mixture(query, depth)?,
            _ => return self.unknown(object, depth),
        };
        self.leftovers(query);
        Ok(scattering)
    }

    fn diffuse(&mut self, query: Query, name: &str) -> Result<MaterialDescription> {
        // 0.x knows the colour under two names.
        let old = "diffuse_reflectance";
        let name = if query.has(old) { old } else { name };
        Ok(MaterialDescription::Diffuse { reflectance: self.paint(query, name, Role::Surface, 0.5)? })
    }

    fn dielectric(&mut self, query: Query) -> Result<MaterialDescription> {
        Ok(MaterialDescription::Glass {
            ior: ior(query, "int_ior", "bk7")?,
            exterior_ior: ior(query, "ext_ior", "air")?,
            reflectance: self.paint(query, "specular_reflectance", Role::Surface, 1.0)?,
            transmittance: self.paint(query, "specular_transmittance", Role::Surface, 1.0)?,
            roughness: None,
        })
    }

    fn thin_dielectric(&mut self, query: Query) -> Result<MaterialDescription> {
        Ok(MaterialDescription::ThinGlass {
            ior: ior(query, "int_ior", "bk7")?,
            exterior_ior: ior(query, "ext_ior", "air")?,
            reflectance: self.paint(query, "specular_reflectance", Role::Surface, 1.0)?,
            transmittance: self.paint(query, "specular_transmittance", Role::Surface, 1.0)?,
        })
    }

    fn plastic(&mut self, query: Query) -> Result<MaterialDescription> {
        Ok(MaterialDescription::Plastic {
            reflectance: self.paint(query, "diffuse_reflectance", Role::Surface, 0.5)?,
            specular: self.paint(query, "specular_reflectance", Role::Surface, 1.0)?,
            ior: ior(query, "int_ior", "polypropylene")?,
            exterior_ior: ior(query, "ext_ior", "air")?,
            nonlinear: query.boolean("nonlinear", false)?,
            roughness: None,
        })
    }

    /// A metal by name, by index of refraction, or a perfect mirror, Mitsuba's default.
    fn conductor(&mut self, query: Query) -> Result<MaterialDescription> {
        let reflectance = self.paint(query, "specular_reflectance", Role::Surface, 1.0)?;
        let (eta, k) = if query.has("eta") || query.has("k") {
            let eta = self.color(query, "eta", Role::Surface, 0.0)?;
            (eta, self.color(query, "k", Role::Surface, 1.0)?)
        } else {
            let material = query.text("material")?.unwrap_or("none");
            if material.eq_ignore_ascii_case("none") {
                return Ok(MaterialDescription::Mirror { reflectance });
            }
            let (eta, k) = self.metal(query, material);
            (Color(eta), Color(k))
        };
        // 0.x has the metal in a medium; only the ratio counts.
        let outside = if query.property("ext_eta").is_some() { ior(query, "ext_eta", "air")? } else { 1.0 };
        Ok(MaterialDescription::Conductor {
            metal: None,
            eta: Some(Color(eta.0.map(|eta| eta / outside))),
            k: Some(Color(k.0.map(|k| k / outside))),
            reflectance,
            roughness: None,
        })
    }

    fn metal(&mut self, query: Query, name: &str) -> ([f32; 3], [f32; 3]) {
        if let Some(found) = metals::named(name) {
            return found;
        }
        let near = did_you_mean(name, metals::METALS.iter().map(|(known, ..)| *known)).unwrap_or("Al");
        self.warn(query.spot("material"), format!("the conductor '{name}' is not known: '{near}' is used"));
        metals::named(near).unwrap_or_default()
    }

    fn two_sided(&mut self, query: Query, depth: usize) -> Result<Scattering> {
        let parts = query.parts(Kind::Bsdf);
        let (front, back) = match parts[..] {
            [front] => (front, None),
            [front, back] => (front, Some(back)),
            _ => return Err(query.fault("", format!("a twosided has one or two BSDFs, not {}", parts.len()))),
        };
        let front = inline(self.bsdf(front.object, depth + 1)?.material);
        let back = match back {
            Some(back) => Some(inline(self.bsdf(back.object, depth + 1)?.material)),
            None => None,
        };
        Ok(Scattering::complete(MaterialDescription::TwoSided { front, back }))
    }

    /// What is not covered passes from both sides, so that the covering gets its black back here.
    fn mask(&mut self, query: Query, depth: usize) -> Result<Scattering> {
        let opacity = self.paint(query, "opacity", Role::Surface, 0.5)?;
        let [part] = query.parts(Kind::Bsdf)[..] else { return Err(query.fault("", "a mask needs one BSDF")) };
        let material = inline(self.bsdf(part.object, depth + 1)?.finished());
        Ok(Scattering::complete(MaterialDescription::Mask { opacity, material }))
    }

    fn blend(&mut self, query: Query, depth: usize) -> Result<Scattering> {
        let weight = self.paint(query, "weight", Role::Surface, 0.5)?;
        let parts = query.parts(Kind::Bsdf);
        let [first, second] = parts[..] else {
            return Err(query.fault("", format!("a blendbsdf needs two BSDFs, not {}", parts.len())));
        };
        let (first, second) = (self.bsdf(first.object, depth + 1)?, self.bsdf(second.object, depth + 1)?);
        Ok(blend(weight, first, second))
    }

    /// 0.x: BSDFs with constant weights, blended one after the other.
    fn mixture(&mut self, query: Query, depth: usize) -> Result<Scattering> {
        let weights = super::value::numbers(query.text("weights")?.unwrap_or(""))
            .map_err(|message| query.fault("weights", message))?;
        let parts = query.parts(Kind::Bsdf);
        if parts.len() != weights.len() || weights.iter().any(|&weight| weight < 0.0) || parts.is_empty() {
            let message = format!("a mixturebsdf of {} BSDFs needs as many weights of at least 0", parts.len());
            return Err(query.fault("weights", message));
        }
        let mut sum = weights[0];
        let mut mixed = self.bsdf(parts[0].object, depth + 1)?;
        for (part, weight) in parts.iter().zip(&weights).skip(1) {
            sum += weight;
            let share = if sum > 0.0 { weight / sum } else { 0.0 };
            let next = self.bsdf(part.object, depth + 1)?;
            mixed = blend(Paint::grey(share as f32), mixed, next);
        }
        if (sum - 1.0).abs() > 1e-3 {
            self.warn(query.spot("weights"), format!("the weights sum to {sum}; they are scaled to 1"));
        }
        Ok(mixed)
    }

    /// A BSDF we do not have: what it covers, or a diffuse surface of its colour.
    fn unknown(&mut self, object: usize, depth: usize) -> Result<Scattering> {
        let query = self.query(object);
        if let Some(inner) = query.part(Kind::Bsdf) {
            let plugin = self.document.objects[inner.object].plugin.as_str();
            self.left_out(object, &format!("the '{plugin}' in it is used alone"));
            return self.bsdf(inner.object, depth + 1);
        }
        if query.object.plugin == "pplastic" {
            self.left_out(object, "'plastic' is used");
            return Ok(Scattering::one_sided(self.plastic(query)?));
        }
        let names = ["reflectance", "diffuse_reflectance", "base_color"];
        let reflectance = match names.iter().find(|name| query.has(name)) {
            Some(name) => {
                self.left_out(object, "a diffuse surface of its colour is used");
                self.paint(query, name, Role::Surface, 0.5)?
            }
            None => {
                self.left_out(object, "a diffuse surface of reflectance 0.5 is used");
                Paint::grey(0.5)
            }
        };
        Ok(Scattering::one_sided(MaterialDescription::Diffuse { reflectance }))
    }
}

/// Two that are both black from behind stay so together; otherwise each gets its back first.
fn blend(weight: Paint, first: Scattering, second: Scattering) -> Scattering {
    let one_sided = first.one_sided && second.one_sided;
    let part = |scattering: Scattering| inline(if one_sided { scattering.material } else { scattering.finished() });
    let (first, second) = (part(first), part(second));
    Scattering { material: MaterialDescription::Blend { weight, first, second }, one_sided }
}

/// An index of refraction: a number, or the name of a substance.
fn ior(query: Query, name: &str, default: &str) -> Result<f32> {
    let substance = match query.property(name).map(|property| &property.value) {
        Some(Value::Text(substance)) => substance.as_str(),
        Some(_) => return Ok(query.float(name, 1.0)? as f32),
        None => default,
    };
    named::ior(substance).ok_or_else(|| {
        let error = query.fault(name, format!("no index of refraction is known for '{substance}'"));
        match did_you_mean(substance, named::IORS.iter().map(|(known, _)| *known)) {
            Some(near) => error.with_hint(format!("did you mean '{near}'?")),
            None => error.with_hint("write it as a float"),
        }
    })
}
