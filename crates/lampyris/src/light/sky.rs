//! The sky of the day and the sun in it.

use std::f32::consts::{FRAC_PI_2, PI, TAU};

use glam::Vec3;
use hw_skymodel::rgb::{Channel, SkyParams, SkyState};

use crate::image::Image;
use crate::spectrum::Spectrum;
use crate::spectrum::eye::{Role, planck, rgb};

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
        let from_zenith = (index / width) as f32 / (height - 1) as f32 * PI;
        if from_zenith > FRAC_PI_2 {
            return [0.0; 3];
        }
        let (sine, cosine) = from_zenith.sin_cos();
        let direction = Vec3::new(sine * longitude.sin(), cosine, -sine * longitude.cos());
        let from_sun = direction.dot(sky.sun).clamp(-1.0, 1.0).acos();
        [Channel::R, Channel::G, Channel::B]
            .map(|channel| UNIT * state.radiance(from_zenith, from_sun, channel).max(0.0))
    });
    Image::from_pixels(width, height, pixels.collect())
}

/// Irradiance of the sun on a surface that faces it, in W/(m² nm): a black body of 5778 K seen through
/// air and haze [Preetham et al. 1999, appendix A.1], whose absorption by ozone, other gases and water is left out.
pub fn sun_irradiance(sky: &Sky) -> Spectrum {
    let elevation = f64::from(sky.sun.y.clamp(0.0, 1.0)).asin().to_degrees();
    let zenith = 90.0 - elevation;
    // Relative optical mass [Kasten 1965].
    let mass = 1.0 / (zenith.to_radians().cos() + 0.15 * (93.885 - zenith).powf(-1.253));
    let haze = 0.046_08 * f64::from(sky.turbidity) - 0.045_86;
    let solid_angle = 6.794e-5;
    let color = rgb(Role::Light, |wavelength| {
        let micrometres = wavelength * 1e-3;
        let rayleigh = (-0.008_735 * mass * micrometres.powf(-4.08)).exp();
        let aerosol = (-haze.max(0.0) * mass * micrometres.powf(-1.3)).exp();
        planck(wavelength, 5778.0) * rayleigh * aerosol
    });
    Spectrum::from_rgb(color.map(|channel| (channel.max(0.0) * solid_angle) as f32))
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
    fn the_sun_reddens_and_pales_as_it_sets() {
        let [high, low] = [60.0, 5.0].map(|elevation| sun_irradiance(&sky(elevation)).to_rgb());
        assert!(low[0] < high[0] && low[2] / low[0] < 0.5 * high[2] / high[0], "{high:?} {low:?}");
    }

    #[test]
    fn haze_beyond_the_models_range_has_no_sky() {
        assert!(sky_picture(&Sky { turbidity: 11.0, ..sky(30.0) }).is_none());
    }
}
