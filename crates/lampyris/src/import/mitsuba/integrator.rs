//! Integrators: what they are called there, and the nearest we have.

use super::Importer;
use super::document::Kind;
use super::query::Query;
use crate::error::Result;
use crate::scene::description::{
    AutoSettings, IntegratorDescription, LightSettings, PhotonMapSettings, TimeDescription,
};
use crate::transient::Unwarp;

impl<'a> Importer<'a> {
    /// The first integrator of the scene. Whatever finds all light there becomes the default here, of its depth.
    pub(super) fn integrator(&mut self, integrators: &[usize]) -> Result<()> {
        for &other in integrators.iter().skip(1) {
            self.left_out(other, "only the first integrator is used");
        }
        let integrator = match integrators.first() {
            Some(&object) => {
                self.note("integrator", self.document.objects[object].spot);
                self.one_integrator(object)?
            }
            None => IntegratorDescription::default(),
        };
        self.description().integrator = integrator;
        Ok(())
    }

    fn one_integrator(&mut self, object: usize) -> Result<IntegratorDescription> {
        let query = self.innermost(object)?;
        let plugin = query.object.plugin.as_str();
        let max_bounces = self.max_bounces(query)?;
        query.ignore(&["rr_depth", "block_size", "samples_per_pass", "timeout", "strict_normals"]);
        if query.boolean("hide_emitters", false)? {
            self.warn(query.spot("hide_emitters"), "'hide_emitters' is not supported: lights stay visible");
        }
        let auto = |max_bounces: Option<u32>| {
            let default = AutoSettings::default();
            let max_bounces = max_bounces.unwrap_or(default.max_bounces);
            IntegratorDescription::Auto(AutoSettings { max_bounces, ..default })
        };
        let integrator = match plugin {
            "path" | "volpath" | "volpathmis" | "prbvolpath" => auto(max_bounces),
            "transient_path" | "transient_prbvolpath" | "transient_nlos_path" => {
                if plugin == "transient_nlos_path" {
                    self.nlos(query)?;
                }
                self.transient(query)?;
                auto(if query.has("max_depth") { max_bounces } else { Some(TRANSIENT_BOUNCES) })
            }
            // Emission and one scattering event: all paths are cut after the first.
            "direct" => {
                query.ignore(&["shading_samples", "emitter_samples", "bsdf_samples"]);
                auto(Some(1))
            }
            "ptracer" | "particle" => {
                query.ignore(&["samples"]);
                let default = LightSettings::default();
                let max_bounces = max_bounces.unwrap_or(default.max_bounces);
                IntegratorDescription::Light(LightSettings { max_bounces, ..default })
            }
            "photonmapper" | "ppm" | "sppm" => photon_map(query, max_bounces)?,
            _ => {
                let message = format!("integrator '{plugin}' is not supported: 'auto' of its depth is used");
                self.warn(query.object.spot, message);
                return Ok(auto(max_bounces));
            }
        };
        self.leftovers(query);
        Ok(integrator)
    }

    /// What integrators of mitransient have in common: the film has its time.
    fn transient(&mut self, query: Query) -> Result<()> {
        // Only the box was ever there.
        query.ignore(&["temporal_filter", "gaussian_stddev"]);
        if query.boolean("camera_unwarp", false)? {
            let unwarp = Unwarp::FirstSurface;
            self.description().film.time = Some(TimeDescription { unwarp, ..TimeDescription::default() });
        }
        for name in ["discard_direct_light", "discard_direct_paths"] {
            if self.capture.is_none() && query.boolean(name, false)? {
                self.warn(query.spot(name), format!("'{name}' is not supported: direct light is in the film, too"));
            }
        }
        Ok(())
    }

    /// The integrator inside those that only do something with the result of another.
    fn innermost(&mut self, mut object: usize) -> Result<Query<'a>> {
        for depth in 0.. {
            let query = self.query(object);
            self.visit(query, depth)?;
            let Some(inner) = query.part(Kind::Integrator) else { break };
            let message = format!("integrator '{}' is not supported: the one in it is used", query.object.plugin);
            self.warn(query.object.spot, message);
            object = inner.object;
        }
        Ok(self.query(object))
    }

    /// Mitsuba counts the edges of a path, so that depth 1 shows emission only; `None` is its -1, no limit.
    fn max_bounces(&mut self, query: Query) -> Result<Option<u32>> {
        match query.integer("max_depth")? {
            None | Some(-1) => Ok(None),
            Some(depth) => match u32::try_from(depth) {
                Ok(depth) => Ok(Some(depth.saturating_sub(1))),
                Err(_) => Err(query.fault("max_depth", format!("'max_depth' must be -1 or at least 0, not {depth}"))),
            },
        }
    }
}

/// The depth of mitransient's integrators where the file gives none, of 6 edges.
const TRANSIENT_BOUNCES: u32 = 5;

/// The photon mappers of 0.x. A radius of 0 is one that the program chooses.
fn photon_map(query: Query, max_bounces: Option<u32>) -> Result<IntegratorDescription> {
    let default = PhotonMapSettings::default();
    let photons = match query.count("photon_count", 1)? {
        Some(count) => Some(count),
        None => query.count("global_photons", 1)?,
    };
    let k = match query.count("k_nn", 0)? {
        Some(count) => Some(count),
        None => query.count("lookup_size", 0)?,
    };
    // The rest says how those programs do what we do otherwise, or not at all.
    query.ignore(&["max_passes", "step_snapshot", "dual_buffer", "caustic_photons", "volume_photons", "granularity"]);
    query.ignore(&[
        "direct_samples",
        "glossy_samples",
        "global_lookup_radius",
        "caustic_lookup_radius",
        "auto_cancel_gathering",
    ]);
    Ok(IntegratorDescription::PhotonMap(PhotonMapSettings {
        photons: photons.unwrap_or(default.photons),
        k: k.filter(|&k| k > 0).unwrap_or(default.k),
        radius: query.optional_float("initial_radius")?.filter(|&radius| radius > 0.0).map(|radius| radius as f32),
        alpha: query.optional_float("alpha")?.map_or(default.alpha, |alpha| alpha as f32),
        max_bounces: max_bounces.unwrap_or(default.max_bounces),
        ..default
    }))
}
