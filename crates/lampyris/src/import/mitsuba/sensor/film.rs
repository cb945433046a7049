//! The film, its filter and the sampler.

use glam::DVec3;

use crate::error::Result;
use crate::import::mitsuba::Importer;
use crate::import::mitsuba::document::Kind;
use crate::import::mitsuba::query::Query;
use crate::scene::description::{CaptureMode, FilmDescription, FilterDescription, PhasorDescription, TimeDescription};
use crate::transient::Unwarp;

/// The part of the picture that is drawn, in pixels from the top left corner.
pub(super) struct Window {
    /// Width and height of the whole picture.
    pub full: [u32; 2],
    offset: [u32; 2],
    size: [u32; 2],
}

impl Window {
    pub fn is_whole(&self) -> bool {
        self.size == self.full
    }

    /// The vectors from the middle of the window to its left and top edges and that to its middle, from those of the
    /// whole picture.
    pub fn part(&self, [left, up]: [DVec3; 2], middle: DVec3) -> [DVec3; 3] {
        let share = |axis: usize| f64::from(self.size[axis]) / f64::from(self.full[axis]);
        // Of the window's middle, 1 at the left or top edge and -1 at the other.
        let place = |axis: usize| 1.0 - 2.0 * f64::from(self.offset[axis]) / f64::from(self.full[axis]) - share(axis);
        [left * share(0), up * share(1), middle + place(0) * left + place(1) * up]
    }
}

impl Importer<'_> {
    /// Reads the film, and says which part of it the camera draws.
    pub(super) fn film(&mut self, object: Option<usize>) -> Result<Window> {
        // Mitsuba's sizes where the file gives none.
        let mut film =
            FilmDescription { size: [768, 576], filter: FilterDescription::Gaussian { stddev: 0.5 }, time: None };
        let Some(object) = object else {
            let full = film.size;
            self.description().film = film;
            return Ok(Window { full, offset: [0, 0], size: full });
        };
        let query = self.query(object);
        let full =
            [query.count("width", 1)?.unwrap_or(film.size[0]), query.count("height", 1)?.unwrap_or(film.size[1])];
        let window = crop(query, full)?;
        film.size = window.size;
        if let Some(part) = query.part(Kind::Filter) {
            film.filter = self.filter(part.object)?;
        }
        // How their file is written, and what we always or never do.
        query.ignore(&["file_format", "pixel_format", "component_format", "gamma", "banner", "attach_log"]);
        query.ignore(&[
            "high_quality_edges",
            "sample_border",
            "compensate",
            "tonemap_method",
            "exposure",
            "key",
            "burn",
        ]);
        let plugin = query.object.plugin.as_str();
        let unwarp = self.description().film.time.take().map_or(Unwarp::None, |time| time.unwarp);
        if matches!(plugin, "transient_hdr_film" | "phasor_hdr_film") {
            film.time = Some(self.time(query, unwarp)?);
        }
        let known = film.time.is_some() || matches!(plugin, "hdrfilm" | "ldrfilm" | "mfilm" | "specfilm");
        if known {
            self.leftovers(query);
        } else {
            self.left_out(object, "an ordinary film of its size is used");
        }
        self.note("film", query.object.spot);
        self.note_all("film", query, &[("size", "width")]);
        self.description().film = film;
        Ok(window)
    }

    /// The time bins of mitransient's films.
    fn time(&mut self, query: Query, unwarp: Unwarp) -> Result<TimeDescription> {
        // Their defaults where the file gives none.
        let keeps_amplitudes = query.object.plugin == "phasor_hdr_film";
        let bins = query.count("temporal_bins", 1)?.unwrap_or(if keeps_amplitudes { 4096 } else { 2048 });
        let bin_width = Some(query.float("bin_width_opl", 0.003)?);
        let start = Some(query.float("start_opl", 0.0)?);
        let unwarps = unwarp != Unwarp::None || query.boolean("camera_unwarp", false)?;
        let is_exhaustive = self.capture.as_ref().is_some_and(|capture| capture.mode == CaptureMode::Exhaustive);
        if query.boolean("exhaustive_scan", false)? && !is_exhaustive {
            self.warn(query.spot("exhaustive_scan"), "'exhaustive_scan' is not supported: the laser stays where it is");
        }
        query.ignore(&["laser_scan_width", "laser_scan_height", "auto_detect_bins"]);
        let phasor = match keeps_amplitudes {
            true => {
                let (mean, sigma) = (query.float("wl_mean", 100.0)?, query.float("wl_sigma", 1000.0)?);
                Some(PhasorDescription { mean, sigma })
            }
            false => None,
        };
        let unwarp = if unwarps { Unwarp::FirstSurface } else { Unwarp::None };
        self.note_all(
            "film.time",
            query,
            &[("bins", "temporal_bins"), ("bin-width", "bin_width_opl"), ("start", "start_opl"), ("phasor", "wl_mean")],
        );
        Ok(TimeDescription { bins, bin_width, start, unwarp, phasor, ..TimeDescription::default() })
    }

    fn filter(&mut self, object: usize) -> Result<FilterDescription> {
        let query = self.query(object);
        let filter = match query.object.plugin.as_str() {
            "box" => FilterDescription::Box { radius: query.float("radius", 0.5)? as f32 },
            "tent" => FilterDescription::Tent { radius: query.float("radius", 1.0)? as f32 },
            "gaussian" => FilterDescription::Gaussian { stddev: query.float("stddev", 0.5)? as f32 },
            _ => {
                self.left_out(object, "a Gaussian of standard deviation 0.5 is used");
                return Ok(FilterDescription::Gaussian { stddev: 0.5 });
            }
        };
        self.leftovers(query);
        self.note("film.filter", query.object.spot);
        Ok(filter)
    }

    /// Samples per pixel; the pattern is ours whatever theirs is.
    pub(super) fn sampler(&mut self, object: usize) -> Result<()> {
        let query = self.query(object);
        let passes = query.count("sample_count", 1)?;
        let seed = query.integer("seed")?;
        self.description().render.passes = passes;
        if let Some(seed) = seed {
            let seed = u64::try_from(seed).map_err(|_| query.fault("seed", "the seed must not be negative"))?;
            self.description().render.seed = seed;
        }
        query.ignore(&["jitter", "dimension", "scramble"]);
        self.note("render.passes", query.spot("sample_count"));
        self.leftovers(query);
        Ok(())
    }
}

fn crop(query: Query, full: [u32; 2]) -> Result<Window> {
    let count =
        |name: &str, least: u32, default: u32| -> Result<u32> { Ok(query.count(name, least)?.unwrap_or(default)) };
    let offset = [count("crop_offset_x", 0, 0)?, count("crop_offset_y", 0, 0)?];
    let rest = |axis: usize| full[axis].saturating_sub(offset[axis]);
    let size = [count("crop_width", 1, rest(0))?, count("crop_height", 1, rest(1))?];
    for (axis, name) in ["crop_width", "crop_height"].into_iter().enumerate() {
        if size[axis] == 0 || size[axis] > rest(axis) {
            return Err(query.fault(name, "the crop window lies outside the picture"));
        }
    }
    Ok(Window { full, offset, size })
}
