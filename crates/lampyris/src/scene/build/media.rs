//! Media, by name.

use std::collections::HashMap;
use std::sync::Arc;

use glam::{Affine3A, Mat4, Vec3};

use super::{check, materials};
use crate::error::{Error, Result};
use crate::medium::{Cloud, Grid, Interior, Medium, MediumId, Phase, Table, VolumeData};
use crate::scene::Assets;
use crate::scene::description::{Color, MediumDescription, PhaseDescription, SceneDescription, Transform};
use crate::spectrum::Spectrum;
use crate::transient::SPEED_OF_LIGHT;

/// The interior of a shape that holds nothing.
const CLEAR: &str = "clear";

/// Phase functions can be blends of blends, so deep.
const DEEPEST: usize = 8;

/// All media of a scene.
pub(super) struct Builder<'d> {
    description: &'d SceneDescription,
    media: Vec<Medium>,
    named: HashMap<&'d str, MediumId>,
}

impl<'d> Builder<'d> {
    pub(super) fn new(description: &'d SceneDescription, assets: &dyn Assets) -> Result<Builder<'d>> {
        let (mut media, mut named) = (Vec::new(), HashMap::new());
        for (name, medium) in &description.media {
            let Ok(number) = MediumId::try_from(media.len()) else {
                return Err(Error::at_key("media", "there are too many media: a scene can have 65,536"));
            };
            if name == CLEAR {
                return Err(Error::at_key(format!("media.{name}"), format!("'{CLEAR}' is the name of empty space"))
                    .with_hint("give the medium another name"));
            }
            media.push(built(medium, assets).map_err(|error| error.under(&format!("media.{name}")))?);
            named.insert(name.as_str(), number);
        }
        Ok(Builder { description, media, named })
    }

    /// What a shape says that it holds.
    pub(super) fn interior(&self, name: Option<&String>, priority: u16) -> Result<Option<Interior>> {
        let Some(name) = name else { return Ok(None) };
        let medium = if name == CLEAR { None } else { Some(self.by_name(name, "interior")?) };
        Ok(Some(Interior { medium, priority }))
    }

    pub(super) fn by_name(&self, name: &str, key: &str) -> Result<MediumId> {
        let known = self.named.get(name).copied();
        known.ok_or_else(|| materials::unknown("medium", name, self.description.media.keys(), key))
    }

    pub(super) fn finish(self) -> Vec<Medium> {
        self.media
    }
}

fn built(medium: &MediumDescription, assets: &dyn Assets) -> Result<Medium> {
    match medium {
        MediumDescription::Homogeneous { sigma_t, albedo, sigma_s, sigma_a, scale, phase, delay, delay_seconds } => {
            let scale = check::at_least_zero("scale", *scale)?;
            let (extinction, scattering) = coefficients([*sigma_t, *albedo, *sigma_s, *sigma_a])?;
            let phase = built_phase(phase, 0).map_err(|error| error.under("phase"))?;
            let (extinction, scattering) = (extinction * scale, scattering * scale);
            if !extinction.is_finite() {
                return Err(Error::at_key("scale", "the coefficients times their scale are too large a number"));
            }
            let delay = built_delay(*delay, *delay_seconds)?;
            Ok(Medium { extinction, scattering, phase, cloud: None, delay })
        }
        MediumDescription::Grid {
            file,
            sigma_t,
            albedo,
            albedo_file,
            scale,
            transform,
            file_bounds,
            nearest,
            phase,
            delay,
            delay_seconds,
        } => {
            let scale = check::at_least_zero("scale", *scale)?;
            let extinction = check::light("sigma-t", sigma_t.unwrap_or(Color::grey(1.0)))? * scale;
            let albedo = match (albedo, albedo_file) {
                (Some(_), Some(_)) => {
                    return Err(Error::at_key("albedo", "the medium has an albedo and an albedo-file"));
                }
                (None, Some(_)) => Spectrum::ONE,
                (albedo, None) => check::share("albedo", albedo.unwrap_or(Color::grey(0.75)))?,
            };
            check::transform("transform", transform)?;
            let grid = |key: &str, file: &str| {
                let data = assets.volume(file).map_err(|error| error.under(key))?;
                let to_unit = to_unit(transform, &data, *file_bounds).ok_or_else(|| {
                    Error::at_key(key, format!("the grid '{file}' fills a box without an inside, or is out of reach"))
                })?;
                Ok((Arc::clone(&data), Grid::new(data, to_unit, *nearest)))
            };
            let (_, density) = grid("file", file)?;
            let shares = match albedo_file {
                None => None,
                Some(file) => {
                    let (data, grid) = grid("albedo-file", file)?;
                    if let Some(share) = data.values.iter().find(|share| **share > 1.0) {
                        let message = format!("the grid '{file}' holds {share}, which is no share");
                        return Err(Error::at_key("albedo-file", message));
                    }
                    Some(grid)
                }
            };
            let cloud = Cloud::new(density, shares);
            if !(extinction * cloud.most()).is_finite() {
                return Err(Error::at_key("scale", "the densities times their scale are too large a number"));
            }
            let phase = built_phase(phase, 0).map_err(|error| error.under("phase"))?;
            let (scattering, delay) = (extinction * albedo, built_delay(*delay, *delay_seconds)?);
            Ok(Medium { extinction, scattering, phase, cloud: Some(Arc::new(cloud)), delay })
        }
    }
}

/// From the world to where a grid fills the unit cube.
fn to_unit(transform: &Transform, data: &VolumeData, file_bounds: bool) -> Option<Affine3A> {
    let [low, high] = data.bounds.map(Vec3::from_array);
    let of_file = if file_bounds { Mat4::from_translation(low) * Mat4::from_scale(high - low) } else { Mat4::IDENTITY };
    let to_unit = (transform.0 * of_file).inverse();
    to_unit.is_finite().then(|| Affine3A::from_mat4(to_unit))
}

/// Extinction and scattering coefficient from σ_t and albedo, or from σ_s and σ_a.
fn coefficients([sigma_t, albedo, sigma_s, sigma_a]: [Option<Color>; 4]) -> Result<(Spectrum, Spectrum)> {
    match (sigma_t, sigma_s, sigma_a) {
        (Some(sigma_t), None, None) => {
            let extinction = check::light("sigma-t", sigma_t)?;
            let albedo = check::share("albedo", albedo.unwrap_or(Color::grey(0.75)))?;
            Ok((extinction, extinction * albedo))
        }
        (None, Some(_), _) | (None, _, Some(_)) if albedo.is_none() => {
            let scattering = check::light("sigma-s", sigma_s.unwrap_or(Color::grey(0.0)))?;
            let absorption = check::light("sigma-a", sigma_a.unwrap_or(Color::grey(0.0)))?;
            Ok((scattering + absorption, scattering))
        }
        _ => Err(Error::new("a medium needs either sigma-t, with albedo, or sigma-s and sigma-a")),
    }
}

/// A mean delay in scene units.
fn built_delay(delay: f32, seconds: Option<f32>) -> Result<f32> {
    let delay = check::at_least_zero("delay", delay)?;
    match seconds {
        None => Ok(delay),
        Some(_) if delay > 0.0 => {
            Err(Error::at_key("delay-seconds", "'delay-seconds' is given in scene units as well")
                .with_hint("leave one of them out"))
        }
        Some(seconds) => {
            let seconds = check::at_least_zero("delay-seconds", seconds)?;
            Ok((f64::from(seconds) * SPEED_OF_LIGHT) as f32)
        }
    }
}

fn built_phase(phase: &PhaseDescription, depth: usize) -> Result<Phase> {
    if depth > DEEPEST {
        return Err(Error::new(format!("phase functions can be blends of blends, {DEEPEST} in all")));
    }
    Ok(match phase {
        PhaseDescription::Isotropic {} => Phase::Isotropic,
        PhaseDescription::Rayleigh {} => Phase::Rayleigh,
        PhaseDescription::HenyeyGreenstein { g } => {
            let g = check::finite("g", *g)?;
            if g.abs() >= 1.0 {
                return Err(Error::at_key("g", format!("g must lie between -1 and 1, not be {g}")));
            }
            Phase::HenyeyGreenstein { g }
        }
        PhaseDescription::Tabulated { values } => {
            let table = Table::new(values).ok_or_else(|| {
                Error::at_key(
                    "values",
                    "a table needs at least two values, none of them negative and not all of them 0",
                )
            })?;
            Phase::Tabulated(Arc::new(table))
        }
        PhaseDescription::Blend { weight, first, second } => {
            let [weight, ..] = check::share("weight", Color::grey(*weight))?.lanes();
            let part = |key: &str, phase| built_phase(phase, depth + 1).map_err(|error| error.under(key));
            Phase::Blend { weight, of: Arc::new([part("first", first)?, part("second", second)?]) }
        }
    })
}
