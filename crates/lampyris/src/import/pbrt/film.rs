//! The film, its filter, and the number of samples.

use super::Importer;
use super::camera::Crop;
use super::statement::Statement;
use crate::error::Result;
use crate::scene::description::{FilmDescription, FilterDescription};

impl Importer<'_> {
    /// The statements before `WorldBegin`, each of which may stand anywhere there.
    pub(super) fn finish_options(&mut self) -> Result<()> {
        if !self.in_world {
            self.find_exposure();
        }
        let mut options = std::mem::take(&mut self.options);
        let crop = match options.remove("Film") {
            Some((film, _)) => self.film(&film)?,
            None => Crop::whole(if self.is_v3 { [640, 480] } else { [1280, 720] }),
        };
        let filter = match options.remove("PixelFilter") {
            Some((filter, _)) => self.filter(&filter)?,
            None if self.is_v3 => FilterDescription::Box { radius: 0.5 },
            None => FilterDescription::Gaussian { stddev: 0.5 },
        };
        let size = [0, 1].map(|axis| crop.high[axis] - crop.low[axis]);
        self.description().film = FilmDescription { size, filter, time: None };
        if let Some((camera, to_camera)) = options.remove("Camera") {
            self.camera(&camera, to_camera, crop)?;
        }
        if let Some((sampler, _)) = options.remove("Sampler") {
            self.sampler(&sampler)?;
        }
        let integrator = options.remove("Integrator").map(|(statement, _)| statement);
        self.integrator(integrator.as_ref())
    }

    /// What the film makes of a radiance of 1: exposure time × ISO / 100.
    pub(super) fn find_exposure(&mut self) {
        let option = |keyword, name: &'static str, default: f64| {
            let found = self.options.get(keyword).and_then(|(statement, _)| statement.number(name, default).ok());
            found.unwrap_or(default)
        };
        let time = option("Camera", "shutterclose", 1.0) - option("Camera", "shutteropen", 0.0);
        let sensitivity = option("Film", "iso", 100.0) / 100.0;
        let exposure = option("Film", "exposuretime", time) * sensitivity;
        self.exposure = if exposure > 0.0 { exposure } else { 1.0 };
    }

    fn film(&mut self, statement: &Statement) -> Result<Crop> {
        if !matches!(statement.sort(), "rgb" | "image" | "gbuffer" | "spectral") {
            let message = format!("film '{}' is not known: an ordinary film of its size is used", statement.sort());
            self.warn(statement.spot, message);
        }
        let default = if statement.sort() == "image" { [640, 480] } else { [1280, 720] };
        let full = [
            self.placed(statement.count("xresolution"))?.unwrap_or(default[0]),
            self.placed(statement.count("yresolution"))?.unwrap_or(default[1]),
        ];
        if full.contains(&0) {
            return Err(self.reader.fault(statement.spot, "the film has no pixels"));
        }
        let sensor = self.placed(statement.text("sensor"))?.unwrap_or("cie1931").to_string();
        if sensor != "cie1931" {
            let message = format!("the sensor '{sensor}' is not supported: colours are as the eye sees them");
            self.warn(statement.spot_of("sensor"), message);
        }
        if self.placed(statement.number("whitebalance", 0.0))? != 0.0 && sensor == "cie1931" {
            self.warn(statement.spot_of("whitebalance"), "white balance is not supported: colours stay as they are");
        }
        if statement.has("maxcomponentvalue") || statement.has("maxsampleluminance") {
            let name = if statement.has("maxcomponentvalue") { "maxcomponentvalue" } else { "maxsampleluminance" };
            self.warn(statement.spot_of(name), format!("'{name}' is ignored: bright samples are not cut"));
        }
        statement.ignore(&["filename", "savefp16", "diagonal", "iso", "exposuretime", "maxcomponentvalue", "scale"]);
        statement.ignore(&[
            "maxsampleluminance",
            "whitebalance",
            "coordinatesystem",
            "nbuckets",
            "lambdamin",
            "lambdamax",
        ]);
        let crop = self.crop(statement, full)?;
        self.leftovers(statement);
        self.note("film", statement.spot);
        self.note("film.size", statement.spot_of("xresolution"));
        Ok(crop)
    }

    fn crop(&mut self, statement: &Statement, full: [u32; 2]) -> Result<Crop> {
        let mut crop = Crop::whole(full);
        let pixels = |value: f64, axis: usize| value.clamp(0.0, f64::from(full[axis])) as u32;
        for (name, is_share) in [("pixelbounds", false), ("cropwindow", true)] {
            let Some(values) = self.placed(statement.numbers(name))?.filter(|values| !values.is_empty()) else {
                continue;
            };
            let &[left, right, top, bottom] = values else {
                return Err(self.reader.fault(statement.spot_of(name), format!("'{name}' must be four numbers")));
            };
            let at = |value: f64, axis: usize| {
                pixels(if is_share { (value * f64::from(full[axis])).ceil() } else { value }, axis)
            };
            crop.low = [at(left.min(right), 0), at(top.min(bottom), 1)];
            crop.high = [at(left.max(right), 0), at(top.max(bottom), 1)];
            if (0..2).any(|axis| crop.low[axis] >= crop.high[axis]) {
                return Err(self.reader.fault(statement.spot_of(name), "no pixel of the film is left"));
            }
        }
        Ok(crop)
    }

    fn filter(&mut self, statement: &Statement) -> Result<FilterDescription> {
        let sort = statement.sort();
        let (x, y) = match statement.has("xwidth") || statement.has("ywidth") {
            // The way of pbrt-v3.
            true => ("xwidth", "ywidth"),
            false => ("xradius", "yradius"),
        };
        let default = match sort {
            "box" => 0.5,
            "gaussian" => 1.5,
            "sinc" => 4.0,
            _ => 2.0,
        };
        let radius = self.placed(statement.number(x, default))?;
        let other = self.placed(statement.number(y, radius))?;
        if other != radius && sort != "gaussian" {
            let message = format!("a filter as wide as high is used: '{y}' is ignored");
            self.warn(statement.spot_of(y), message);
        }
        let radius = radius as f32;
        let filter = match sort {
            "box" => FilterDescription::Box { radius },
            "triangle" => FilterDescription::Tent { radius },
            "gaussian" => {
                // pbrt-v3 gives 1 / (2 σ²) as alpha.
                let alpha = self.placed(statement.number("alpha", 2.0))?;
                let default = if statement.has("alpha") && alpha > 0.0 { (0.5 / alpha).sqrt() } else { 0.5 };
                FilterDescription::Gaussian { stddev: self.placed(statement.number("sigma", default))? as f32 }
            }
            _ => {
                statement.ignore(&["B", "C", "tau"]);
                self.warn(
                    statement.spot,
                    format!("filter '{sort}' is not supported: a Gaussian of 0.5 pixels is used"),
                );
                FilterDescription::Gaussian { stddev: 0.5 }
            }
        };
        self.leftovers(statement);
        self.note("film.filter", statement.spot);
        Ok(filter)
    }

    /// Samples per pixel; the pattern is ours whatever theirs is.
    fn sampler(&mut self, statement: &Statement) -> Result<()> {
        let passes = match (statement.sort(), statement.has("xsamples") || statement.has("ysamples")) {
            ("stratified", true) => {
                let x = self.placed(statement.count("xsamples"))?.unwrap_or(4);
                let y = self.placed(statement.count("ysamples"))?.unwrap_or(4);
                Some(x.saturating_mul(y))
            }
            _ => self.placed(statement.count("pixelsamples"))?,
        };
        if let Some(seed) = self.placed(statement.count("seed"))? {
            self.description().render.seed = seed.into();
        }
        statement.ignore(&["randomization", "jitter", "dimensions", "xsamples", "ysamples", "pixelsamples"]);
        statement.ignore(&["scramble", "samplepixelcenter"]);
        self.description().render.passes = passes.filter(|&passes| passes > 0);
        self.note("render.passes", statement.spot_of("pixelsamples"));
        self.leftovers(statement);
        Ok(())
    }
}
