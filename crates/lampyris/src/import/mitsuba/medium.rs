//! Media, and where they are: each to the one of ours that is the same.
//!
//! There, a surface says what is on either side. Here, a shape says what is inside of it, and what lies around is what it
//! stands in: the `exterior` of a shape and the medium of a sensor or a light are found from the shapes that hold them, or
//! fill everything if there is none.

use glam::DMat4;

use super::Importer;
use super::document::Kind;
use super::query::Query;
use super::spectrum::Role;
use super::value;
use crate::error::Result;
use crate::scene::description::{Color, MediumDescription, PhaseDescription, Transform};

/// Where a grid lies.
#[derive(PartialEq)]
struct Place {
    transform: Transform,
    file_bounds: bool,
    nearest: bool,
}

/// Blends of phase functions can lie in one another, so deep.
const DEEPEST: usize = 8;

impl Importer<'_> {
    /// The name of the medium inside of a shape, which is read with it; the one outside is noted.
    pub(super) fn interior(&mut self, query: Query, key: &str) -> Result<Option<String>> {
        self.exterior(query)?;
        let Some(part) = query.named_part("interior") else { return Ok(None) };
        let name = self.medium(part.object)?;
        if let Some(name) = &name {
            self.note(format!("{key}.interior"), part.spot);
            self.interiors.insert(name.clone());
        }
        Ok(name)
    }

    /// What an object says that it stands in: a shape by its exterior, a sensor or a light by its medium.
    pub(super) fn exterior(&mut self, query: Query) -> Result<()> {
        let named = query.named_part("exterior");
        let held =
            matches!(query.object.kind, Kind::Sensor | Kind::Emitter).then(|| query.part(Kind::Medium)).flatten();
        for part in named.into_iter().chain(held) {
            if let Some(name) = self.medium(part.object)? {
                self.exteriors.push((name, part.spot));
            }
        }
        Ok(())
    }

    /// What no shape holds, but something stands in, is around everything.
    pub(super) fn medium_around(&mut self) {
        let outside: Vec<_> =
            self.exteriors.iter().filter(|(name, _)| !self.interiors.contains(name)).cloned().collect();
        let Some((name, spot)) = outside.first().cloned() else { return };
        if let Some((other, at)) = outside.iter().find(|(other, _)| *other != name) {
            let message = format!("the media '{name}' and '{other}' cannot both be around everything: '{name}' is");
            self.warn(*at, message);
        }
        self.note("medium", spot);
        self.description().medium = Some(name);
    }

    /// The name in the description of a medium; none if it is not supported.
    fn medium(&mut self, object: usize) -> Result<Option<String>> {
        if let Some(name) = self.media.get(&object) {
            return Ok(Some(name.clone()));
        }
        let query = self.query(object);
        let is_taken = |name: &str| self.media.values().any(|other| other == name);
        // "clear" is our word for no medium.
        let own = query.object.id.clone().filter(|id| id != "clear" && !is_taken(id));
        let mut numbered = (self.media.len() + 1..).map(|number| format!("medium-{number}"));
        let Some(name) = own.or_else(|| numbered.find(|name| !is_taken(name))) else { return Ok(None) };
        let medium = match query.object.plugin.as_str() {
            "homogeneous" => self.homogeneous(query)?,
            "heterogeneous" => self.heterogeneous(query)?,
            _ => {
                self.left_out(object, "it is left out");
                return Ok(None);
            }
        };
        self.note(format!("media.{name}"), query.object.spot);
        self.description().media.insert(name.clone(), medium);
        self.media.insert(object, name.clone());
        Ok(Some(name))
    }

    fn homogeneous(&mut self, query: Query) -> Result<MediumDescription> {
        let scale = query.float("scale", 1.0)? as f32;
        query.ignore(&["sample_emitters", "has_spectral_extinction"]);
        let phase = self.phase_of(query, 0)?;
        let color = |this: &mut Self, names: [&str; 2], default: f32| {
            let name = names.into_iter().find(|name| query.has(name));
            name.map(|name| this.coefficient(query, name, default)).transpose()
        };
        let scattering = color(self, ["sigma_s", "sigmaS"], 0.0)?;
        let absorption = color(self, ["sigma_a", "sigmaA"], 0.0)?;
        let extinction = color(self, ["sigma_t", "sigmaT"], 1.0)?;
        let albedo = color(self, ["albedo", "albedo"], 0.75)?;
        if query.has("material") {
            self.warn(query.spot("material"), "measured materials are not supported: the coefficients are used");
            query.ignore(&["material"]);
        }
        self.leftovers(query);
        let by_parts = scattering.is_some() || absorption.is_some();
        Ok(match by_parts {
            true => MediumDescription::Homogeneous {
                sigma_t: None,
                albedo: None,
                sigma_s: scattering,
                sigma_a: absorption,
                scale,
                phase,
                delay: 0.0,
                delay_seconds: None,
            },
            false => MediumDescription::Homogeneous {
                sigma_t: Some(extinction.unwrap_or(Color::grey(1.0))),
                albedo: Some(albedo.unwrap_or(Color::grey(0.75))),
                sigma_s: None,
                sigma_a: None,
                scale,
                phase,
                delay: 0.0,
                delay_seconds: None,
            },
        })
    }

    fn heterogeneous(&mut self, query: Query) -> Result<MediumDescription> {
        let scale = query.float("scale", 1.0)? as f32;
        query.ignore(&["sample_emitters", "has_spectral_extinction", "majorant_resolution_factor", "majorant_grid"]);
        let phase = self.phase_of(query, 0)?;
        let name = ["sigma_t", "density"].into_iter().find(|name| query.has(name)).unwrap_or("sigma_t");
        let density = self.grid_of(query, name)?;
        let shares = self.grid_of(query, "albedo")?;
        let albedo = if shares.is_some() { None } else { Some(self.coefficient(query, "albedo", 0.75)?) };
        let Some((file, place)) = density else {
            let sigma_t = Some(self.coefficient(query, name, 1.0)?);
            if shares.is_some() {
                self.warn(
                    query.spot("albedo"),
                    "an albedo that varies needs a density that does: 0.75 is used instead",
                );
            }
            self.leftovers(query);
            let albedo = albedo.or(Some(Color::grey(0.75)));
            let (sigma_s, sigma_a, delay, delay_seconds) = (None, None, 0.0, None);
            return Ok(MediumDescription::Homogeneous {
                sigma_t,
                albedo,
                sigma_s,
                sigma_a,
                scale,
                phase,
                delay,
                delay_seconds,
            });
        };
        if shares.as_ref().is_some_and(|(_, other)| *other != place) {
            self.warn(query.spot("albedo"), "the grid of the albedo is taken to lie where that of the density does");
        }
        self.leftovers(query);
        let Place { transform, file_bounds, nearest } = place;
        let (sigma_t, albedo_file) = (None, shares.map(|(file, _)| file));
        Ok(MediumDescription::Grid {
            file,
            sigma_t,
            albedo,
            albedo_file,
            scale,
            transform,
            file_bounds,
            nearest,
            phase,
            delay: 0.0,
            delay_seconds: None,
        })
    }

    /// The file of a grid, and where it lies, if that is what stands there.
    fn grid_of(&mut self, query: Query, name: &str) -> Result<Option<(String, Place)>> {
        let part = query.named_part(name);
        let Some(part) = part.filter(|part| self.document.objects[part.object].plugin == "gridvolume") else {
            return Ok(None);
        };
        let volume = self.query(part.object);
        let Some(file) = volume.text("filename")? else {
            return Err(volume.fault("filename", "a 'gridvolume' needs a 'filename'"));
        };
        let wrap = volume.text("wrap_mode")?.unwrap_or("clamp");
        if wrap != "clamp" {
            self.warn(volume.spot("wrap_mode"), format!("the wrap mode '{wrap}' is not supported: 'clamp' is used"));
        }
        let matrix = volume.transform("to_world")?.unwrap_or(DMat4::IDENTITY);
        let place = Place {
            transform: Transform(matrix.as_mat4()),
            file_bounds: volume.boolean("use_grid_bbox", false)?,
            nearest: volume.text("filter_type")? == Some("nearest"),
        };
        volume.ignore(&["raw", "accel"]);
        self.leftovers(volume);
        Ok(Some((file.to_string(), place)))
    }

    /// A colour, or what a volume is everywhere.
    fn coefficient(&mut self, query: Query, name: &str, default: f32) -> Result<Color> {
        if let Some(part) =
            query.named_part(name).filter(|part| self.document.objects[part.object].kind == Kind::Volume)
        {
            let volume = self.query(part.object);
            if volume.object.plugin != "constvolume" {
                self.left_out(part.object, &format!("{default} is used instead"));
                return Ok(Color::grey(default));
            }
            let color = self.color(volume, "value", Role::Surface, default)?;
            self.leftovers(volume);
            return Ok(color);
        }
        self.color(query, name, Role::Surface, default)
    }

    /// The phase function of a medium, isotropic by default.
    fn phase_of(&mut self, query: Query, depth: usize) -> Result<PhaseDescription> {
        match query.part(Kind::Phase) {
            Some(part) => self.phase(part.object, depth),
            None => Ok(PhaseDescription::default()),
        }
    }

    fn phase(&mut self, object: usize, depth: usize) -> Result<PhaseDescription> {
        let query = self.query(object);
        self.visit(query, depth)?;
        let phase = match query.object.plugin.as_str() {
            "isotropic" => PhaseDescription::Isotropic {},
            "rayleigh" => PhaseDescription::Rayleigh {},
            "hg" => {
                let g = query.float("g", 0.8)? as f32;
                if g.is_nan() || g.abs() >= 1.0 {
                    return Err(query.fault("g", format!("'g' must lie between -1 and 1, not be {g}")));
                }
                PhaseDescription::HenyeyGreenstein { g }
            }
            "tabphase" => {
                let Some(text) = query.text("values")? else {
                    return Err(query.fault("values", "a 'tabphase' needs 'values'"));
                };
                let values = value::numbers(text).map_err(|message| query.fault("values", message))?;
                PhaseDescription::Tabulated { values: values.into_iter().map(|value| value as f32).collect() }
            }
            "blendphase" if depth < DEEPEST => {
                let parts = query.parts(Kind::Phase);
                let [first, second] = parts[..] else {
                    return Err(query.fault("", "a 'blendphase' needs two phase functions"));
                };
                let weight = self.color(query, "weight", Role::Surface, 0.5)?.0[0];
                let first = Box::new(self.phase(first.object, depth + 1)?);
                let second = Box::new(self.phase(second.object, depth + 1)?);
                PhaseDescription::Blend { weight, first, second }
            }
            _ => {
                self.left_out(object, "light is scattered in all directions alike");
                return Ok(PhaseDescription::default());
            }
        };
        self.leftovers(query);
        Ok(phase)
    }
}
