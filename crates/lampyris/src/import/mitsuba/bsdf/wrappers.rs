//! BSDFs made of others.

use super::surfaces::ior;
use super::{Scattering, inline};
use crate::error::Result;
use crate::import::mitsuba::Importer;
use crate::import::mitsuba::document::{Kind, Part};
use crate::import::mitsuba::query::Query;
use crate::import::mitsuba::spectrum::Role;
use crate::import::mitsuba::value;
use crate::scene::description::{MaterialDescription, Paint};

impl<'a> Importer<'a> {
    pub(super) fn two_sided(&mut self, query: Query, depth: usize) -> Result<Scattering> {
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
    pub(super) fn mask(&mut self, query: Query, depth: usize) -> Result<Scattering> {
        let opacity = self.paint(query, "opacity", Role::Surface, 0.5)?;
        let [part] = query.parts(Kind::Bsdf)[..] else { return Err(query.fault("", "a mask needs one BSDF")) };
        let material = inline(self.bsdf(part.object, depth + 1)?.finished());
        Ok(Scattering::complete(MaterialDescription::Mask { opacity, material }))
    }

    pub(super) fn blend(&mut self, query: Query, depth: usize) -> Result<Scattering> {
        let weight = self.paint(query, "weight", Role::Surface, 0.5)?;
        let parts = query.parts(Kind::Bsdf);
        let [first, second] = parts[..] else {
            return Err(query.fault("", format!("a blendbsdf needs two BSDFs, not {}", parts.len())));
        };
        let (first, second) = (self.bsdf(first.object, depth + 1)?, self.bsdf(second.object, depth + 1)?);
        Ok(blend(weight, first, second))
    }

    /// 0.x: BSDFs with constant weights, blended one after the other.
    pub(super) fn mixture(&mut self, query: Query, depth: usize) -> Result<Scattering> {
        let weights =
            value::numbers(query.text("weights")?.unwrap_or("")).map_err(|message| query.fault("weights", message))?;
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

    /// The one BSDF in another.
    fn covered(&self, query: Query<'a>) -> Result<&'a Part> {
        let plugin = &query.object.plugin;
        query.part(Kind::Bsdf).ok_or_else(|| query.fault("", format!("'{plugin}' needs a BSDF in it")))
    }

    /// The texture under any name is that of the heights. In 0.x its factor is a texture around it.
    pub(super) fn bump_map(&mut self, query: Query<'a>, depth: usize) -> Result<Scattering> {
        let inner = self.bsdf(self.covered(query)?.object, depth + 1)?;
        let scale = query.float("scale", 1.0)?;
        let Some(part) = query.part(Kind::Texture) else {
            return Err(query.fault("", "a bumpmap needs a texture of heights"));
        };
        let (object, factor) = self.unscaled(part.object)?;
        let Paint::Texture(height) = self.painted(object, Role::Surface, 0.0)? else {
            // A flat surface stays as it is.
            return Ok(inner);
        };
        let scale = (scale * factor) as f32;
        Ok(inner.wrapped(|material| MaterialDescription::BumpMap { height, scale, material }))
    }

    /// The normals stand in a texture of any name or, in real files, in a picture named right here.
    pub(super) fn normal_map(&mut self, query: Query<'a>, depth: usize) -> Result<Scattering> {
        let inner = self.bsdf(self.covered(query)?.object, depth + 1)?;
        let normals = match query.part(Kind::Texture) {
            Some(part) => self.painted(part.object, Role::Surface, 0.5)?,
            None if query.has("filename") => Paint::Texture(self.raw_picture(query)?),
            None => return Err(query.fault("", "a normalmap needs a texture of normals")),
        };
        let Paint::Texture(normals) = normals else { return Ok(inner) };
        Ok(inner.wrapped(|material| MaterialDescription::NormalMap { normals, strength: 1.0, material }))
    }

    /// 0.x: a clear coat over anything. Over a diffuse base it is plastic; else it is left out.
    pub(super) fn coating(&mut self, query: Query<'a>, depth: usize, rough: bool) -> Result<Scattering> {
        let plugin = query.object.plugin.as_str();
        let inner = self.bsdf(self.covered(query)?.object, depth + 1)?;
        let (ior, exterior_ior) = (ior(query, "int_ior", "bk7")?, ior(query, "ext_ior", "air")?);
        let specular = self.paint(query, "specular_reflectance", Role::Surface, 1.0)?;
        let roughness = self.roughness(query, rough)?;
        if query.has("sigma_a") {
            self.warn(
                query.spot("sigma_a"),
                format!("'sigma_a' of bsdf '{plugin}' is not supported: the coat is clear"),
            );
        }
        query.ignore(&["sigma_a", "thickness"]);
        match inner.material {
            MaterialDescription::Diffuse { reflectance } | MaterialDescription::RoughDiffuse { reflectance, .. } => {
                self.warn(query.object.spot, format!("bsdf '{plugin}' is not supported: plastic of its base is used"));
                let nonlinear = true;
                let plastic =
                    MaterialDescription::Plastic { reflectance, specular, ior, exterior_ior, nonlinear, roughness };
                Ok(Scattering::one_sided(plastic))
            }
            material => {
                self.warn(query.object.spot, format!("bsdf '{plugin}' is not supported: what it covers is used alone"));
                Ok(Scattering { material, one_sided: inner.one_sided })
            }
        }
    }
}

/// Two that are both black from behind stay so together; otherwise each gets its back first.
fn blend(weight: Paint, first: Scattering, second: Scattering) -> Scattering {
    let one_sided = first.one_sided && second.one_sided;
    let part = |scattering: Scattering| inline(if one_sided { scattering.material } else { scattering.finished() });
    let (first, second) = (part(first), part(second));
    Scattering { material: MaterialDescription::Blend { weight, first, second }, one_sided }
}
