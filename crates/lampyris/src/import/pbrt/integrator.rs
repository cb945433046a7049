//! Integrators: what they are called there, and the nearest we have.

use super::Importer;
use super::statement::Statement;
use crate::error::{Result, did_you_mean};
use crate::scene::description::{AutoSettings, IntegratorDescription, LightSettings, PhotonMapSettings};

/// What pbrt does without `maxdepth`.
const DEFAULT_DEPTH: u32 = 5;

/// All integrators, to propose them for wrong names.
const SORTS: [&str; 12] = [
    "ambientocclusion",
    "bdpt",
    "function",
    "lightpath",
    "mlt",
    "path",
    "randomwalk",
    "simplepath",
    "simplevolpath",
    "sppm",
    "volpath",
    "whitted",
];

impl Importer<'_> {
    /// The integrator. Whatever finds all light there becomes the default here, of its depth, which counts scattering events
    /// in both.
    pub(super) fn integrator(&mut self, statement: Option<&Statement>) -> Result<()> {
        let auto = |max_bounces| IntegratorDescription::Auto(AutoSettings { max_bounces, ..AutoSettings::default() });
        let Some(statement) = statement else {
            self.description().integrator = auto(DEFAULT_DEPTH);
            return Ok(());
        };
        let max_bounces = self.placed(statement.count("maxdepth"))?.unwrap_or(DEFAULT_DEPTH);
        if self.placed(statement.boolean("regularize", false))? {
            self.warn(statement.spot_of("regularize"), "'regularize' is not supported: mirrors stay mirrors");
        }
        statement.ignore(&["rrthreshold", "lightsampler", "lightsamplestrategy", "pixelbounds", "strategy"]);
        let integrator = match statement.sort() {
            "path" | "volpath" | "simplepath" | "simplevolpath" | "randomwalk" => {
                statement.ignore(&["samplebsdf", "samplelights"]);
                auto(max_bounces)
            }
            "lightpath" => IntegratorDescription::Light(LightSettings { max_bounces, ..LightSettings::default() }),
            "sppm" => self.photon_map(statement, max_bounces)?,
            sort => {
                let message = format!("integrator '{sort}' is not supported: 'auto' of its depth is used");
                match did_you_mean(sort, SORTS).filter(|near| *near != sort) {
                    Some(near) => self.warn_with(statement.spot, message, &format!("did you mean '{near}'?")),
                    None => self.warn(statement.spot, message),
                }
                // What it says of an integrator that we do not have needs no word.
                statement.leftovers();
                auto(max_bounces)
            }
        };
        self.leftovers(statement);
        self.note("integrator", statement.spot);
        self.description().integrator = integrator;
        Ok(())
    }

    /// Progressive photon mapping: an iteration there is a pass here.
    fn photon_map(&mut self, statement: &Statement, max_bounces: u32) -> Result<IntegratorDescription> {
        let default = PhotonMapSettings::default();
        let size = self.description().film.size;
        let pixels = size[0].saturating_mul(size[1]);
        // pbrt emits as many photons as there are pixels.
        let photons = self.placed(statement.optional_number("photonsperiteration"))?.filter(|count| *count >= 1.0);
        let radius = self.placed(statement.optional_number("radius"))?.filter(|radius| *radius > 0.0);
        // pbrt-v3 counts iterations here, pbrt-v4 in the sampler.
        if let Some(iterations) = self.placed(statement.count("iterations"))?.filter(|&count| count > 0) {
            self.description().render.passes = Some(iterations);
        }
        statement.ignore(&["seed", "imagewritefrequency", "numiterations"]);
        Ok(IntegratorDescription::PhotonMap(PhotonMapSettings {
            photons: photons.map_or(pixels, |count| count.min(f64::from(u32::MAX)) as u32).max(1),
            radius: radius.map(|radius| radius as f32),
            max_bounces,
            ..default
        }))
    }
}
