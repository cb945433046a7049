//! The principled BSDFs of Mitsuba 3.

use super::Scattering;
use crate::error::Result;
use crate::import::mitsuba::Importer;
use crate::import::mitsuba::query::Query;
use crate::import::mitsuba::spectrum::Role;
use crate::scene::description::{MaterialDescription, Paint, Principled, PrincipledThin};

/// How the samples are drawn, which is our own business.
const SAMPLING: [&str; 6] = [
    "main_specular_sampling_rate",
    "clearcoat_sampling_rate",
    "diffuse_reflectance_sampling_rate",
    "diffuse_transmittance_sampling_rate",
    "specular_reflectance_sampling_rate",
    "specular_transmittance_sampling_rate",
];

impl Importer<'_> {
    /// Opaque unless some light is transmitted.
    pub(super) fn principled(&mut self, query: Query) -> Result<Scattering> {
        query.ignore(&SAMPLING);
        let mut paint = |name: &str, default: f32| self.paint(query, name, Role::Surface, default);
        let principled = Principled {
            base_color: paint("base_color", 0.5)?,
            roughness: paint("roughness", 0.5)?,
            anisotropic: paint("anisotropic", 0.0)?,
            metallic: paint("metallic", 0.0)?,
            spec_trans: paint("spec_trans", 0.0)?,
            eta: query.optional_float("eta")?.map(|eta| eta as f32),
            specular: query.float("specular", 0.5)? as f32,
            spec_tint: paint("spec_tint", 0.0)?,
            sheen: paint("sheen", 0.0)?,
            sheen_tint: paint("sheen_tint", 0.0)?,
            flatness: paint("flatness", 0.0)?,
            clearcoat: paint("clearcoat", 0.0)?,
            clearcoat_gloss: paint("clearcoat_gloss", 0.0)?,
        };
        let opaque = principled.spec_trans == Paint::grey(0.0);
        let material = MaterialDescription::Principled(Box::new(principled));
        Ok(if opaque { Scattering::one_sided(material) } else { Scattering::complete(material) })
    }

    pub(super) fn principled_thin(&mut self, query: Query) -> Result<MaterialDescription> {
        query.ignore(&SAMPLING);
        let eta = self.color(query, "eta", Role::Surface, 1.5)?;
        let mut paint = |name: &str, default: f32| self.paint(query, name, Role::Surface, default);
        Ok(MaterialDescription::PrincipledThin(Box::new(PrincipledThin {
            base_color: paint("base_color", 0.5)?,
            roughness: paint("roughness", 0.5)?,
            anisotropic: paint("anisotropic", 0.0)?,
            spec_trans: paint("spec_trans", 0.0)?,
            eta: eta.0[1],
            spec_tint: paint("spec_tint", 0.0)?,
            sheen: paint("sheen", 0.0)?,
            sheen_tint: paint("sheen_tint", 0.0)?,
            flatness: paint("flatness", 0.0)?,
            diff_trans: paint("diff_trans", 0.0)?,
        })))
    }
}
