//! Settings that have the right form but make no sense.

use super::Settings;
use crate::error::{Error, Result};
use crate::scene::SceneDescription;
use crate::scene::description::{
    BandwidthRule, CameraDescription, FilmDescription, FilterDescription, IntegratorDescription, PhotonMapSettings,
    RenderDescription, Show, TimeDescription,
};

/// Most pixels of a picture: 2²⁶, 8192 × 8192, which take about five gigabytes while they are rendered.
const MOST_PIXELS: u64 = 1 << 26;

/// Most light paths of a pass: 2²⁵, whose photons take some gigabytes. More light is a matter of more passes.
const MOST_PATHS: u32 = 1 << 25;

/// How far a filter may reach, in pixels: a sample is spread over all that it covers.
const WIDEST_FILTER: f32 = 16.0;

impl SceneDescription {
    /// Checks the numbers of the integrator, the film, the camera and `render` for their ranges.
    ///
    /// # Errors
    /// The first that is out of range, with its key, such as `integrator.k`.
    pub fn check_settings(&self) -> Result<()> {
        Settings::of(self).check()
    }
}

impl Settings {
    pub(super) fn check(&self) -> Result<()> {
        integrator(&self.integrator)?;
        film(&self.film)?;
        if let Some(time) = &self.film.time {
            self::time(time, self.film.size)?;
            if let IntegratorDescription::PhotonMap(PhotonMapSettings {
                show: Show::Photons | Show::Caustics, ..
            }) = &self.integrator
            {
                return Err(Error::at_key("film.time", "a picture of the photon map itself has no time")
                    .with_hint("set show to radiance, or leave time out"));
            }
        }
        render(&self.render)?;
        self.camera.as_ref().map_or(Ok(()), camera)
    }
}

fn integrator(integrator: &IntegratorDescription) -> Result<()> {
    match integrator {
        IntegratorDescription::Auto(settings) => {
            settings.photons.map_or(Ok(()), paths)?;
            at_least_one("integrator.samples", settings.samples)?;
            settings.radius.map_or(Ok(()), |radius| positive("integrator.radius", radius))?;
            settings.volume_radius.map_or(Ok(()), |radius| positive("integrator.volume-radius", radius))?;
            between("integrator.alpha", settings.alpha, 0.0, 1.0)
        }
        IntegratorDescription::PhotonMap(settings) => {
            paths(settings.photons)?;
            at_least_one("integrator.samples", settings.samples)?;
            at_least_one("integrator.k", settings.k)?;
            if settings.k == 1 && settings.bandwidth == BandwidthRule::Nearest {
                return Err(Error::at_key("integrator.k", "'k' must be at least 2 for the bandwidth nearest")
                    .with_hint("the k-th photon gives the radius and is not counted itself"));
            }
            settings.radius.map_or(Ok(()), |radius| positive("integrator.radius", radius))?;
            settings.volume_radius.map_or(Ok(()), |radius| positive("integrator.volume-radius", radius))?;
            settings.volume_alpha.map_or(Ok(()), |alpha| between("integrator.volume-alpha", alpha, 0.0, 1.0))?;
            between("integrator.alpha", settings.alpha, 0.0, 1.0)
        }
        IntegratorDescription::Path(settings) => at_least_one("integrator.samples", settings.samples),
        IntegratorDescription::Light(settings) => settings.photons.map_or(Ok(()), paths),
    }
}

fn paths(photons: u32) -> Result<()> {
    at_least_one("integrator.photons", photons)?;
    if photons <= MOST_PATHS {
        return Ok(());
    }
    Err(Error::at_key("integrator.photons", format!("'photons' must be at most {MOST_PATHS} in a pass, not {photons}"))
        .with_hint("render more passes instead"))
}

fn film(film: &FilmDescription) -> Result<()> {
    let [width, height] = film.size;
    if width == 0 || height == 0 {
        let message = format!("the picture must be at least 1 pixel wide and high, not {width}×{height}");
        return Err(Error::at_key("film.size", message));
    }
    if u64::from(width) * u64::from(height) > MOST_PIXELS {
        let message = format!("a picture of {width}×{height} is too large: at most {MOST_PIXELS} pixels");
        return Err(Error::at_key("film.size", message));
    }
    let (key, size) = match film.filter {
        FilterDescription::Box { radius } | FilterDescription::Tent { radius } => ("film.filter.radius", radius),
        FilterDescription::Gaussian { stddev } => ("film.filter.stddev", stddev),
    };
    positive(key, size)?;
    if film.filter.radius() > WIDEST_FILTER {
        let most = WIDEST_FILTER * size / film.filter.radius();
        return Err(Error::at_key(key, format!("'{}' must be at most {most} pixels, not {size}", last(key)))
            .with_hint("blur the finished picture instead"));
    }
    Ok(())
}

/// What makes no complex amplitudes.
fn amplitudes(time: &TimeDescription) -> Result<()> {
    if let (Some(_), false) = (time.phasor, time.frequencies.is_empty()) {
        let message = "'frequencies' are given by 'phasor' as well";
        return Err(Error::at_key("film.time.frequencies", message).with_hint("leave one of them out"));
    }
    if let Some(broken) = time.frequencies.iter().find(|frequency| !frequency.is_finite()) {
        return Err(Error::at_key("film.time.frequencies", format!("'frequencies' must be finite, not {broken}")));
    }
    if time.variance && time.keeps_amplitudes() {
        return Err(Error::at_key("film.time.variance", "amplitudes have no variance, only bins do"));
    }
    match time.amplitudes() {
        Ok(_) => Ok(()),
        Err(error) => Err(Error { key: Some("film.time.phasor".into()), ..error }),
    }
}

fn time(time: &TimeDescription, size: [u32; 2]) -> Result<()> {
    at_least_one("film.time.bins", time.bins)?;
    let widths = [("film.time.bin-width", time.bin_width), ("film.time.bin-width-seconds", time.bin_width_seconds)];
    let starts = [("film.time.start", time.start), ("film.time.start-seconds", time.start_seconds)];
    for [(_, in_units), (key, in_seconds)] in [widths, starts] {
        if in_units.is_some() && in_seconds.is_some() {
            let message = format!("'{}' is given in scene units as well", last(key));
            return Err(Error::at_key(key, message).with_hint("leave one of them out"));
        }
    }
    for (key, width) in widths.into_iter().filter_map(|(key, width)| Some((key, width?))) {
        if !(width.is_finite() && width > 0.0) {
            let message = format!("'{}' must be greater than 0 and finite, not {width}", last(key));
            return Err(Error::at_key(key, message));
        }
    }
    for (key, start) in starts.into_iter().filter_map(|(key, start)| Some((key, start?))) {
        if !start.is_finite() {
            return Err(Error::at_key(key, format!("'{}' must be finite, not {start}", last(key))));
        }
    }
    amplitudes(time)?;
    let (bytes, [width, height]) = (time.bytes(size), size);
    if bytes > MOST_BYTES || time.slots() > f64::from(u32::MAX) {
        let kept = match time.amplitudes() {
            Ok(frequencies) if !frequencies.is_empty() => format!("{} frequencies", frequencies.len()),
            _ => format!("{} time bins", time.bins),
        };
        let tib = bytes / f64::from(1_u32 << 20).powi(2);
        let message = format!("{kept} of {width}×{height} pixels take {tib:.1} TiB, more than a program can have");
        let message = match time.layers().count() {
            0 => message,
            count => format!("{message}, once for all light and once for each of {count} layers"),
        };
        return Err(Error::at_key("film.time.bins", message).with_hint("keep fewer bins, layers or pixels"));
    }
    Ok(())
}

/// What processors can address of a program, in bytes: 47 bits.
const MOST_BYTES: f64 = (1_u64 << 47) as f64;

fn render(render: &RenderDescription) -> Result<()> {
    render.passes.map_or(Ok(()), |passes| at_least_one("render.passes", passes))
}

fn camera(camera: &CameraDescription) -> Result<()> {
    let vectors = [
        ("camera.origin", Some(camera.origin)),
        ("camera.left", camera.left),
        ("camera.up", camera.up),
        ("camera.forward", camera.forward),
        ("camera.target", camera.target),
    ];
    for (key, vector) in vectors {
        if vector.is_some_and(|vector| vector.iter().any(|x| !x.is_finite())) {
            return Err(Error::at_key(key, format!("'{}' must be finite", last(key))));
        }
    }
    camera.fov.map_or(Ok(()), |fov| between("camera.fov", fov, 0.0, 180.0))?;
    camera.focus_distance.map_or(Ok(()), |distance| positive("camera.focus-distance", distance))?;
    for (name, length) in [("aperture-radius", camera.aperture_radius), ("near-distance", camera.near_distance)] {
        if !(length.is_finite() && length >= 0.0) {
            let message = format!("'{name}' must be at least 0, not {length}");
            return Err(Error::at_key(format!("camera.{name}"), message));
        }
    }
    Ok(())
}

/// What a user calls the key.
fn last(key: &str) -> &str {
    key.rsplit('.').next().unwrap_or(key)
}

fn at_least_one(key: &str, value: u32) -> Result<()> {
    if value >= 1 { Ok(()) } else { Err(Error::at_key(key, format!("'{}' must be at least 1", last(key)))) }
}

fn positive(key: &str, value: f32) -> Result<()> {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    Err(Error::at_key(key, format!("'{}' must be greater than 0 and finite, not {value}", last(key))))
}

/// Between the two and equal to neither, which NaN is not.
fn between(key: &str, value: f32, low: f32, high: f32) -> Result<()> {
    if value > low && value < high {
        return Ok(());
    }
    Err(Error::at_key(key, format!("'{}' must lie between {low} and {high}, not {value}", last(key))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::description::{LightSettings, PathSettings, PhotonMapSettings};

    fn with(change: impl FnOnce(&mut PhotonMapSettings)) -> SceneDescription {
        let mut settings = PhotonMapSettings::default();
        change(&mut settings);
        SceneDescription { integrator: IntegratorDescription::PhotonMap(settings), ..Default::default() }
    }

    fn fails(scene: &SceneDescription, key: &str, message: &str) {
        let error = scene.check_settings().expect_err("out of range");
        assert_eq!((error.key.as_deref(), &*error.message), (Some(key), message));
    }

    #[test]
    fn the_defaults_are_in_range() {
        SceneDescription::default().check_settings().expect("defaults make sense");
    }

    #[test]
    fn counts_are_at_least_one() {
        fails(&with(|settings| settings.photons = 0), "integrator.photons", "'photons' must be at least 1");
        fails(
            &with(|settings| settings.photons = u32::MAX),
            "integrator.photons",
            "'photons' must be at most 33554432 in a pass, not 4294967295",
        );
        fails(
            &with(|settings| (settings.k, settings.bandwidth) = (1, BandwidthRule::Nearest)),
            "integrator.k",
            "'k' must be at least 2 for the bandwidth nearest",
        );
        fails(&with(|settings| settings.samples = 0), "integrator.samples", "'samples' must be at least 1");
        fails(&with(|settings| settings.k = 0), "integrator.k", "'k' must be at least 1");
        let path = IntegratorDescription::Path(PathSettings { samples: 0, ..Default::default() });
        let scene = SceneDescription { integrator: path, ..Default::default() };
        fails(&scene, "integrator.samples", "'samples' must be at least 1");
        let light = IntegratorDescription::Light(LightSettings { photons: Some(0), max_bounces: 1 });
        let scene = SceneDescription { integrator: light, ..Default::default() };
        fails(&scene, "integrator.photons", "'photons' must be at least 1");
    }

    #[test]
    fn no_bounce_at_all_is_a_fair_wish() {
        with(|settings| settings.max_bounces = 0).check_settings().expect("lamps alone");
    }

    #[test]
    fn a_radius_is_positive_and_finite() {
        for radius in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            let message = format!("'radius' must be greater than 0 and finite, not {radius}");
            fails(&with(|settings| settings.radius = Some(radius)), "integrator.radius", &message);
        }
    }

    #[test]
    fn alpha_lies_between_its_ends() {
        for alpha in [0.0, 1.0, f32::NAN] {
            let message = format!("'alpha' must lie between 0 and 1, not {alpha}");
            fails(&with(|settings| settings.alpha = alpha), "integrator.alpha", &message);
        }
    }

    #[test]
    fn a_picture_has_pixels_but_not_too_many() {
        let sized =
            |size| SceneDescription { film: FilmDescription { size, ..Default::default() }, ..Default::default() };
        fails(&sized([4, 0]), "film.size", "the picture must be at least 1 pixel wide and high, not 4×0");
        fails(
            &sized([u32::MAX, u32::MAX]),
            "film.size",
            "a picture of 4294967295×4294967295 is too large: at most 67108864 pixels",
        );
        sized([8192, 8192]).check_settings().expect("just small enough");
    }

    #[test]
    fn time_has_a_range_and_a_size() {
        let timed = |change: fn(&mut TimeDescription)| {
            let mut time = TimeDescription::default();
            change(&mut time);
            SceneDescription { film: FilmDescription { time: Some(time), ..Default::default() }, ..Default::default() }
        };
        timed(|_| {}).check_settings().expect("the defaults are small enough");
        fails(&timed(|time| time.bins = 0), "film.time.bins", "'bins' must be at least 1");
        fails(
            &timed(|time| time.bins = 1 << 24),
            "film.time.bins",
            "16777216 time bins of 512×512 pixels take 204.0 TiB, more than a program can have",
        );
        fails(
            &timed(|time| time.bin_width = Some(-1.0)),
            "film.time.bin-width",
            "'bin-width' must be greater than 0 and finite, not -1",
        );
        fails(
            &timed(|time| (time.start, time.start_seconds) = (Some(0.0), Some(0.0))),
            "film.time.start-seconds",
            "'start-seconds' is given in scene units as well",
        );
        let scene = with(|settings| settings.show = Show::Photons);
        let film = FilmDescription { time: Some(TimeDescription::default()), ..Default::default() };
        fails(&SceneDescription { film, ..scene }, "film.time", "a picture of the photon map itself has no time");
    }

    #[test]
    fn a_filter_has_a_size() {
        let filtered =
            |filter| SceneDescription { film: FilmDescription { filter, ..Default::default() }, ..Default::default() };
        fails(
            &filtered(FilterDescription::Gaussian { stddev: 0.0 }),
            "film.filter.stddev",
            "'stddev' must be greater than 0 and finite, not 0",
        );
        fails(
            &filtered(FilterDescription::Box { radius: 1e9 }),
            "film.filter.radius",
            "'radius' must be at most 16 pixels, not 1000000000",
        );
    }

    #[test]
    fn a_camera_can_see() {
        let seen = |change: fn(&mut CameraDescription)| {
            let mut camera = CameraDescription::default();
            change(&mut camera);
            SceneDescription { camera: Some(camera), ..Default::default() }
        };
        fails(&seen(|c| c.fov = Some(180.0)), "camera.fov", "'fov' must lie between 0 and 180, not 180");
        fails(&seen(|c| c.origin[1] = f32::NAN), "camera.origin", "'origin' must be finite");
        fails(
            &seen(|c| c.focus_distance = Some(0.0)),
            "camera.focus-distance",
            "'focus-distance' must be greater than 0 and finite, not 0",
        );
        fails(
            &seen(|c| c.near_distance = f32::INFINITY),
            "camera.near-distance",
            "'near-distance' must be at least 0, not inf",
        );
        fails(
            &seen(|c| c.aperture_radius = -1.0),
            "camera.aperture-radius",
            "'aperture-radius' must be at least 0, not -1",
        );
    }

    #[test]
    fn no_passes_are_no_picture() {
        let render = RenderDescription { passes: Some(0), ..RenderDescription::default() };
        let scene = SceneDescription { render, ..Default::default() };
        fails(&scene, "render.passes", "'passes' must be at least 1");
    }
}
