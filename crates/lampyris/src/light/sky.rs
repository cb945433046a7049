//! The sky of the day and the sun in it.

use std::f32::consts::{PI, TAU};

use glam::Vec3;
use hw_skymodel::rgb::{Channel, SkyParams, SkyState};

use crate::image::Image;
use crate::spectrum::Spectrum;
use crate::spectrum::eye::{Role, rgb};

/// The weather: where the sun stands and how hazy the air is. Directions are in the sky's own axes, +y up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sky {
    /// Towards the sun, unit length, not below the horizon.
    pub sun: Vec3,
    /// Haze, from 1 (clear) to 10.
    pub turbidity: f32,
    /// Mean reflectance of the ground, 0 to 1.
    pub albedo: [f32; 3],
}

/// Rows of the picture above one that lies on the nadir.
const HEIGHT: usize = 256;
/// The row on the horizon.
const HORIZON: usize = HEIGHT / 2;
/// From the unit of the model's RGB data, in which CIE Y is the integral over ȳ per nm, to the mean over ȳ.
const UNIT: f32 = 1.0 / 106.750_26;

/// The radiance in W/(m² sr nm) of the sky without the sun [Hošek & Wilkie 2012] as a lat-long picture, black below the horizon; none
/// where a parameter is out of its range.
pub fn sky_picture(sky: &Sky) -> Option<Image> {
    let elevation = sky.sun.y.clamp(0.0, 1.0).asin();
    let params = SkyParams { elevation, turbidity: sky.turbidity, albedo: sky.albedo };
    let state = SkyState::new(&params).ok()?;
    let (width, height) = (2 * HEIGHT, HEIGHT + 1);
    let pixels = (0..width * height).map(|index| {
        let longitude = ((index % width) as f32 + 0.5) / width as f32 * TAU;
        if index / width > HORIZON {
            return [0.0; 3];
        }
        let from_zenith = (index / width) as f32 / HEIGHT as f32 * PI;
        let (sine, cosine) = from_zenith.sin_cos();
        let direction = Vec3::new(sine * longitude.sin(), cosine, -sine * longitude.cos());
        let from_sun = direction.dot(sky.sun).clamp(-1.0, 1.0).acos();
        // Between rows radiance is linear: with half of it on the horizon, as much light shines below as is missing above.
        let share = if index / width == HORIZON { 0.5 * UNIT } else { UNIT };
        [Channel::R, Channel::G, Channel::B]
            .map(|channel| share * state.radiance(from_zenith, from_sun, channel).max(0.0))
    });
    Image::from_pixels(width, height, pixels.collect())
}

/// Irradiance of the sun on a surface that faces it, in W/(m² nm): what comes through the air of its spectrum, by
/// Beer's law. The optical depths are fitted to the solar radiance of [Hošek & Wilkie 2013]: within 0.5 % from 8° above
/// the horizon, 1 % from 5°, and 3 % from 4°.
pub fn sun_irradiance(sky: &Sky) -> Spectrum {
    let elevation = f64::from(sky.sun.y.clamp(0.0, 1.0)).asin().to_degrees();
    let (air, haze) = (AIR.mass(elevation), HAZE.mass(elevation) * haze_depth(sky.turbidity));
    let [outside, air_depths, haze_depths] = SUN;
    let color = rgb(Role::Light, |wavelength| {
        let depth = air * at(&air_depths, wavelength) + haze * at(&haze_depths, wavelength);
        at(&outside, wavelength) * (-depth).exp()
    });
    let scaled = [0, 1, 2].map(|channel| (color[channel].max(0.0) * TO_MITSUBA[channel]) as f32);
    Spectrum::from_rgb(scaled)
}

/// How many times as much of a layer light crosses as from the zenith, in the form of [Kasten & Young 1989].
struct Layer(f64, f64, f64);

/// The air itself, and the haze in it, which lies lower.
const AIR: Layer = Layer(11.2826, 12.0156, 2.3391);
const HAZE: Layer = Layer(820.25, 8.0026, 5.2823);

impl Layer {
    fn mass(&self, degrees: f64) -> f64 {
        1.0 / (degrees.to_radians().sin() + self.0 * (degrees + self.1).powf(-self.2))
    }
}

/// By wavelength, 320 to 720 nm in steps of 40: irradiance above the air in W/(m² nm), the optical depth of the air towards
/// the zenith, and that of haze relative to 560 nm.
#[allow(clippy::approx_constant)] // One depth resembles 1/π.
const SUN: [[f64; 11]; 3] = [
    [0.3572, 0.6309, 1.0586, 1.3880, 1.6332, 1.5126, 1.4099, 1.4113, 1.3196, 1.2384, 1.1555],
    [1.1335, 0.7079, 0.4650, 0.3180, 0.2248, 0.1633, 0.1214, 0.0921, 0.0712, 0.0559, 0.0445],
    [0.7213, 0.7495, 0.8637, 0.9462, 0.9932, 1.0120, 1.0000, 0.9461, 0.9149, 0.8600, 0.8059],
];

/// The optical depth of haze at 560 nm, for turbidities of 1 to 10.
const HAZES: [f64; 10] = [0.0, 0.0099, 0.0261, 0.0530, 0.0827, 0.1049, 0.1409, 0.1996, 0.2962, 0.4556];

/// In RGB Mitsuba's sun is, at all heights and in all weathers, brighter by these factors than its own spectrum is; its
/// numbers are kept, as for the sky.
const TO_MITSUBA: [f64; 3] = [1.0549, 1.0747, 1.0893];

/// Between two entries of a table over wavelength (nm), constant beyond its ends.
fn at(table: &[f64; 11], wavelength: f64) -> f64 {
    between(table, (wavelength - 320.0) / 40.0)
}

fn haze_depth(turbidity: f32) -> f64 {
    between(&HAZES, f64::from(turbidity) - 1.0)
}

fn between(table: &[f64], index: f64) -> f64 {
    let last = table.len() - 1;
    let index = index.clamp(0.0, last as f64);
    let (low, part) = (index as usize, index.fract());
    table[low] + part * (table[(low + 1).min(last)] - table[low])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sky(elevation: f32) -> Sky {
        let (sine, cosine) = elevation.to_radians().sin_cos();
        Sky { sun: Vec3::new(cosine, sine, 0.0), turbidity: 3.0, albedo: [0.15; 3] }
    }

    #[test]
    fn the_zenith_has_the_radiance_of_mitsuba_3_9_1() {
        for (elevation, zenith) in [(10.0, [0.0081, 0.0164, 0.0289]), (45.0, [0.0220, 0.0380, 0.0771])] {
            let picture = sky_picture(&sky(elevation)).expect("a sky");
            for (ours, theirs) in picture.pixel(0, 0).into_iter().zip(zenith) {
                assert!((ours - theirs).abs() < 1e-4, "{ours} {theirs}");
            }
        }
    }

    #[test]
    fn the_rows_hold_as_much_light_as_the_sky() {
        let sky = sky(30.0);
        let picture = sky_picture(&sky).expect("a sky");
        let step = PI / HEIGHT as f32;
        let rows: f32 = (0..=HEIGHT).map(|row| picture.pixel(0, row)[1] * (row as f32 * step).sin() * step).sum();
        let state = SkyState::new(&SkyParams { elevation: 30f32.to_radians(), turbidity: 3.0, albedo: [0.15; 3] });
        let (state, fine, longitude) = (state.expect("a state"), 20_000, 0.5 / (2 * HEIGHT) as f32 * TAU);
        let exact: f32 = (0..fine)
            .map(|index| {
                let from_zenith = (index as f32 + 0.5) / fine as f32 * 0.5 * PI;
                let (sine, cosine) = from_zenith.sin_cos();
                let direction = Vec3::new(sine * longitude.sin(), cosine, -sine * longitude.cos());
                let from_sun = direction.dot(sky.sun).acos();
                UNIT * state.radiance(from_zenith, from_sun, Channel::G) * sine * 0.5 * PI / fine as f32
            })
            .sum();
        assert!((rows / exact - 1.0).abs() < 2e-3, "{rows} {exact}");
    }

    #[test]
    fn the_sun_reddens_and_pales_as_it_sets() {
        let [high, low] = [60.0, 5.0].map(|elevation| sun_irradiance(&sky(elevation)).to_rgb());
        assert!(low[0] < high[0] && low[2] / low[0] < 0.5 * high[2] / high[0], "{high:?} {low:?}");
    }

    #[test]
    fn the_sun_has_the_irradiance_of_mitsuba_3_9_1_within_a_hundredth() {
        let measured = [
            (2.0, 5.0, [0.7646, 0.3464, 0.0464]),
            (2.0, 20.0, [1.3421, 0.9919, 0.5633]),
            (2.0, 80.0, [1.5453, 1.3094, 1.0323]),
            (3.0, 10.0, [0.9955, 0.6037, 0.2157]),
            (3.0, 40.0, [1.4492, 1.1779, 0.8465]),
            (6.0, 20.0, [1.0374, 0.7472, 0.4302]),
            (6.0, 60.0, [1.3817, 1.1467, 0.8873]),
        ];
        for (turbidity, elevation, theirs) in measured {
            let ours = sun_irradiance(&Sky { turbidity, ..sky(elevation) }).to_rgb();
            for (ours, theirs) in ours.into_iter().zip(theirs) {
                let close = (ours / theirs - 1.0).abs() < 0.01 || (ours - theirs).abs() < 0.01;
                assert!(close, "turbidity {turbidity}, {elevation}°: {ours} {theirs}");
            }
        }
    }

    #[test]
    fn haze_beyond_the_models_range_has_no_sky() {
        assert!(sky_picture(&Sky { turbidity: 11.0, ..sky(30.0) }).is_none());
    }
}
