//! BSDFs of one surface, smooth and rough.

use super::pane;
use crate::error::{Result, did_you_mean};
use crate::import::mitsuba::Importer;
use crate::import::mitsuba::document::Value;
use crate::import::mitsuba::named;
use crate::import::mitsuba::query::Query;
use crate::import::mitsuba::spectrum::Role;
use crate::scene::description::{Color, MaterialDescription, MicrofacetDistribution, Paint, Roughness, WardVariant};

/// How the samples are drawn, which is our own business.
const SAMPLING: [&str; 2] = ["sample_visible", "specular_sampling_weight"];

impl Importer<'_> {
    pub(super) fn diffuse(&mut self, query: Query, name: &str) -> Result<MaterialDescription> {
        // 0.x knows the colour under two names.
        let old = "diffuse_reflectance";
        let name = if query.has(old) { old } else { name };
        Ok(MaterialDescription::Diffuse { reflectance: self.paint(query, name, Role::Surface, 0.5)? })
    }

    pub(super) fn rough_diffuse(&mut self, query: Query) -> Result<MaterialDescription> {
        Ok(MaterialDescription::RoughDiffuse {
            reflectance: self.paint(query, "reflectance", Role::Surface, 0.5)?,
            alpha: self.paint(query, "alpha", Role::Surface, 0.2)?,
            fast: query.boolean("use_fast_approx", false)?,
        })
    }

    pub(super) fn dielectric(&mut self, query: Query, rough: bool) -> Result<MaterialDescription> {
        Ok(MaterialDescription::Glass {
            ior: ior(query, "int_ior", "bk7")?.into(),
            exterior_ior: ior(query, "ext_ior", "air")?.into(),
            reflectance: self.paint(query, "specular_reflectance", Role::Surface, 1.0)?,
            transmittance: self.paint(query, "specular_transmittance", Role::Surface, 1.0)?,
            roughness: self.roughness(query, rough)?,
        })
    }

    pub(super) fn thin_dielectric(&mut self, query: Query) -> Result<MaterialDescription> {
        Ok(MaterialDescription::ThinGlass {
            ior: ior(query, "int_ior", "bk7")?,
            exterior_ior: ior(query, "ext_ior", "air")?,
            reflectance: self.paint(query, "specular_reflectance", Role::Surface, 1.0)?,
            transmittance: self.paint(query, "specular_transmittance", Role::Surface, 1.0)?,
        })
    }

    pub(super) fn plastic(&mut self, query: Query, rough: bool) -> Result<MaterialDescription> {
        Ok(MaterialDescription::Plastic {
            reflectance: self.paint(query, "diffuse_reflectance", Role::Surface, 0.5)?,
            specular: self.paint(query, "specular_reflectance", Role::Surface, 1.0)?,
            ior: ior(query, "int_ior", "polypropylene")?,
            exterior_ior: ior(query, "ext_ior", "air")?,
            nonlinear: query.boolean("nonlinear", false)?,
            roughness: self.roughness(query, rough)?,
        })
    }

    /// A metal by name, by index of refraction, or a perfect mirror, the default of versions 2 and 3; that of 0.x is
    /// copper.
    pub(super) fn conductor(&mut self, query: Query, rough: bool) -> Result<MaterialDescription> {
        let reflectance = self.paint(query, "specular_reflectance", Role::Surface, 1.0)?;
        let roughness = self.roughness(query, rough)?;
        let (eta, k) = if query.has("eta") || query.has("k") {
            let eta = self.color(query, "eta", Role::Surface, 0.0)?;
            (eta, self.color(query, "k", Role::Surface, 1.0)?)
        } else {
            let default = if query.object.old { "Cu" } else { "none" };
            let material = query.text("material")?.unwrap_or(default);
            match (material.eq_ignore_ascii_case("none"), &roughness) {
                (true, None) => return Ok(MaterialDescription::Mirror { reflectance }),
                // As the mirror of Mitsuba: without a real part all light is reflected.
                (true, Some(_)) => (Color::grey(0.0), Color::grey(1.0)),
                (false, _) => {
                    let (eta, k) = self.metal(query, material);
                    (Color(eta), Color(k))
                }
            }
        };
        // 0.x has the metal in a medium; only the ratio counts.
        let outside = if query.property("ext_eta").is_some() { ior(query, "ext_eta", "air")? } else { 1.0 };
        Ok(MaterialDescription::Conductor {
            metal: None,
            eta: Some(Color(eta.0.map(|eta| eta / outside))),
            k: Some(Color(k.0.map(|k| k / outside))),
            reflectance,
            roughness,
        })
    }

    fn metal(&mut self, query: Query, name: &str) -> ([f32; 3], [f32; 3]) {
        if let Some(found) = named::conductor(name) {
            return found;
        }
        let near = did_you_mean(name, named::CONDUCTORS.iter().map(|(known, ..)| *known)).unwrap_or("Al");
        self.warn(query.spot("material"), format!("the conductor '{name}' is not known: '{near}' is used"));
        named::conductor(near).unwrap_or_default()
    }

    /// The microfacets of a rough surface, or none of a smooth one.
    pub(super) fn roughness(&mut self, query: Query, rough: bool) -> Result<Option<Roughness>> {
        query.ignore(&SAMPLING);
        if !rough {
            return Ok(None);
        }
        let distribution = match query.text("distribution")?.unwrap_or("beckmann").to_ascii_lowercase().as_str() {
            "beckmann" => MicrofacetDistribution::Beckmann,
            "ggx" => MicrofacetDistribution::Ggx,
            other => {
                let message = format!("the distribution '{other}' is not supported: 'beckmann' is used");
                self.warn(query.spot("distribution"), message);
                MicrofacetDistribution::Beckmann
            }
        };
        let along = |name| if query.has(name) { name } else { "alpha" };
        let (u, v) = (along("alpha_u"), along("alpha_v"));
        let alpha = self.paint(query, u, Role::Surface, 0.1)?;
        let alpha_v =
            if v == "alpha_v" || u == "alpha_u" { Some(self.paint(query, v, Role::Surface, 0.1)?) } else { None };
        Ok(Some(Roughness { alpha, alpha_v, distribution, multiple_scattering: false }))
    }

    pub(super) fn phong(&mut self, query: Query) -> Result<MaterialDescription> {
        query.ignore(&SAMPLING);
        Ok(MaterialDescription::Phong {
            diffuse: self.paint(query, "diffuse_reflectance", Role::Surface, 0.5)?,
            specular: self.paint(query, "specular_reflectance", Role::Surface, 0.2)?,
            exponent: self.paint(query, "exponent", Role::Surface, 30.0)?,
        })
    }

    pub(super) fn ward(&mut self, query: Query) -> Result<MaterialDescription> {
        query.ignore(&SAMPLING);
        let variant = match query.text("variant")?.unwrap_or("balanced").to_ascii_lowercase().as_str() {
            "ward" => WardVariant::Ward,
            "ward-duer" => WardVariant::WardDuer,
            "balanced" => WardVariant::Balanced,
            other => {
                let message = format!("'variant' must be ward, ward-duer or balanced, not '{other}'");
                return Err(query.fault("variant", message));
            }
        };
        Ok(MaterialDescription::Ward {
            variant,
            diffuse: self.paint(query, "diffuse_reflectance", Role::Surface, 0.5)?,
            specular: self.paint(query, "specular_reflectance", Role::Surface, 0.2)?,
            alpha_u: self.paint(query, "alpha_u", Role::Surface, 0.1)?,
            alpha_v: self.paint(query, "alpha_v", Role::Surface, 0.1)?,
        })
    }

    pub(super) fn diffuse_transmission(&mut self, query: Query) -> Result<MaterialDescription> {
        Ok(MaterialDescription::DiffuseTransmission {
            reflectance: Paint::grey(0.0),
            transmittance: self.paint(query, "transmittance", Role::Surface, 0.5)?,
        })
    }

    /// A thin scattering slab [Hanrahan & Krueger 1993]: of the light that meets something in it, the albedo's
    /// share leaves again, half to either side.
    pub(super) fn hanrahan_krueger(&mut self, query: Query) -> Result<MaterialDescription> {
        let message = "bsdf 'hk' is not supported: diffuse reflection and transmission of its albedo are used";
        self.warn(query.object.spot, message);
        let thickness = query.float("thickness", 1.0)? as f32;
        let (albedo, extinction) = if query.has("sigma_s") || query.has("sigma_a") {
            let scattering = self.color(query, "sigma_s", Role::Surface, 0.0)?.0;
            let absorption = self.color(query, "sigma_a", Role::Surface, 0.0)?.0;
            let extinction = [0, 1, 2].map(|channel| scattering[channel] + absorption[channel]);
            let albedo = |channel: usize| match extinction[channel] {
                sum if sum > 0.0 => scattering[channel] / sum,
                _ => 0.0,
            };
            ([0, 1, 2].map(albedo), extinction)
        } else {
            let extinction = self.color(query, "sigma_t", Role::Surface, 1.0)?.0;
            (self.color(query, "albedo", Role::Surface, 0.5)?.0, extinction)
        };
        query.ignore(&["material"]);
        let share = |channel: usize| 0.5 * albedo[channel] * -(-extinction[channel] * thickness).exp_m1();
        let half = Paint::from(Color([0, 1, 2].map(share)));
        Ok(MaterialDescription::DiffuseTransmission { reflectance: half.clone(), transmittance: half })
    }

    /// A filter of polarised light, for light that is not polarised: of that, it lets half pass or, as a retarder,
    /// all.
    pub(super) fn polariser(&mut self, query: Query) -> Result<MaterialDescription> {
        let plugin = query.object.plugin.as_str();
        let message = format!("bsdf '{plugin}' is not supported: it is a filter of light that is not polarised");
        self.warn(query.object.spot, message);
        query.ignore(&["theta", "delta", "polarizing", "left_handed"]);
        let passes = if plugin == "retarder" { 1.0 } else { 0.5 };
        let transmittance = self.color(query, "transmittance", Role::Surface, 1.0)?;
        Ok(pane(Color(transmittance.0.map(|share| 1.0 - passes * share)).into()))
    }
}

/// An index of refraction: a number, or the name of a substance.
pub(super) fn ior(query: Query, name: &str, default: &str) -> Result<f32> {
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
