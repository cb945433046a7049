//! The sky and the sun, whose axes differ: +y is up in 0.x, +z in 3.

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::{DMat4, DVec3};

use crate::error::Result;
use crate::import::mitsuba::query::Query;
use crate::import::mitsuba::spectrum::Role;
use crate::import::mitsuba::{Importer, single};
use crate::scene::description::{LightDescription, Transform};

/// Angle across the sun in degrees.
const SUN: f64 = 0.5358;
/// Half of it at which 0.x makes a directional light of the sun, to us a very small one.
const SMALLEST: f64 = 1e-3;

impl Importer<'_> {
    /// `sunsky`, or of 0.x `sky` and `sun` alone.
    pub(super) fn sky(&mut self, query: Query, matrix: DMat4, plugin: &str) -> Result<LightDescription> {
        let old = query.object.old;
        let to_local = matrix.inverse();
        let sun = match query.vector("sun_direction")? {
            // In the world, also where the sky is turned.
            Some(direction) => upright(to_local.transform_vector3(direction), old),
            None => self.sun_at(query)?,
        };
        if sun.try_normalize().is_none() {
            return Err(query.fault("sun_direction", "the direction of the sun must not be zero"));
        }
        let scale = query.float("scale", 1.0)?;
        let factor = |name: &str, only: &str| match plugin {
            "sunsky" => query.float(name, scale),
            _ if plugin == only => Ok(scale),
            _ => Ok(0.0),
        };
        let (sun_scale, sky_scale) = (factor("sun_scale", "sun")?, factor("sky_scale", "sky")?);
        let sun_angle = match query.optional_float("sun_aperture")? {
            Some(angle) => angle,
            None => SUN * query.float("sun_radius_scale", 1.0)?,
        };
        if query.float("stretch", 1.0)? != 1.0 {
            self.warn(query.spot("stretch"), "'stretch' is not supported: the sky ends at the horizon");
        }
        if query.boolean("extend", false)? {
            self.warn(query.spot("extend"), "'extend' is not supported: the sky ends at the horizon");
        }
        query.ignore(&["resolution", "complex_sun"]);
        let z_up = DMat4::from_rotation_x(FRAC_PI_2);
        let transform = if old { matrix } else { matrix * z_up };
        Ok(LightDescription::Sky {
            sun_direction: single(sun),
            turbidity: query.float("turbidity", 3.0)? as f32,
            albedo: self.color(query, "albedo", Role::Surface, if old { 0.15 } else { 0.3 })?,
            sky_scale: sky_scale as f32,
            sun_scale: sun_scale as f32,
            sun_angle: sun_angle.max(SMALLEST) as f32,
            transform: Transform(transform.as_mat4()),
        })
    }

    /// Where the sun stands at a place and time, +y up, by the formulas of Blanco-Muriel et al. [2001]; Tokyo on a
    /// summer afternoon by default.
    fn sun_at(&mut self, query: Query) -> Result<DVec3> {
        let whole = |name: &str, default: i64| -> Result<i64> { Ok(query.integer(name)?.unwrap_or(default)) };
        let (year, month, day) = (whole("year", 2010)?, whole("month", 7)?, whole("day", 10)?);
        if !(1..=12).contains(&month) || !(1..=31).contains(&day) || !(-4000..=9999).contains(&year) {
            return Err(query.fault("day", format!("{year}-{month}-{day} is not a date")));
        }
        let timezone = query.float("timezone", 9.0)?;
        let minutes = query.float("minute", 0.0)? + query.float("second", 0.0)? / 60.0;
        // Of universal time.
        let hour = query.float("hour", 15.0)? - timezone + minutes / 60.0;
        let latitude = query.float("latitude", 35.6894)?.to_radians();
        let longitude = query.float("longitude", 139.6917)?;
        let position = sun_position(days_since_2000(year, month, day) + hour / 24.0, hour, latitude, longitude);
        // The same place in the sky, also in 3, where the azimuth of the sun is counted otherwise.
        Ok(if query.object.old { from_north(position) } else { upright(as_in_3(from_north(position)), false) })
    }
}

/// Days from noon of 1 January 2000 to the beginning of this day.
fn days_since_2000(year: i64, month: i64, day: i64) -> f64 {
    // Fliegel and Van Flandern's formula for the Julian day; divisions round towards zero.
    let winter = (month - 14) / 12;
    let julian = 1461 * (year + 4800 + winter) / 4 + 367 * (month - 2 - 12 * winter) / 12
        - 3 * ((year + 4900 + winter) / 100) / 4
        + day
        - 32075;
    julian as f64 - 0.5 - 2_451_545.0
}

/// Angle from the zenith, and azimuth from north over east, in radians.
fn sun_position(days: f64, hour: f64, latitude: f64, longitude: f64) -> [f64; 2] {
    let omega = 2.1429 - 0.0010394594 * days;
    let mean_longitude = 4.8950630 + 0.017202791698 * days;
    let anomaly = 6.2400600 + 0.0172019699 * days;
    let ecliptic = mean_longitude + 0.03341607 * anomaly.sin() + 0.00034894 * (2.0 * anomaly).sin()
        - 0.0001134
        - 0.0000203 * omega.sin();
    let obliquity = 0.4090928 - 6.2140e-9 * days + 0.0000396 * omega.cos();
    let ascension = (obliquity.cos() * ecliptic.sin()).atan2(ecliptic.cos()).rem_euclid(TAU);
    let declination = (obliquity.sin() * ecliptic.sin()).asin();

    let sidereal = 6.6974243242 + 0.0657098283 * days + hour;
    let hour_angle = (sidereal * 15.0 + longitude).to_radians() - ascension;
    let cos_zenith = latitude.cos() * hour_angle.cos() * declination.cos() + declination.sin() * latitude.sin();
    let zenith = cos_zenith.clamp(-1.0, 1.0).acos();
    let azimuth = (-hour_angle.sin()).atan2(declination.tan() * latitude.cos() - latitude.sin() * hour_angle.cos());
    // The earth's radius over the distance of the sun.
    let parallax = 6371.01 / 149_597_890.0 * zenith.sin();
    [zenith + parallax, azimuth]
}

/// 0.x: +y up, -z north, +x east.
fn from_north([zenith, azimuth]: [f64; 2]) -> DVec3 {
    DVec3::new(azimuth.sin() * zenith.sin(), zenith.cos(), -azimuth.cos() * zenith.sin())
}

/// 3: +z up, +x south, -y east.
fn as_in_3(old: DVec3) -> DVec3 {
    DVec3::new(old.z, -old.x, old.y)
}

/// A direction of Mitsuba's sky in ours, whose +y is up.
fn upright(direction: DVec3, old: bool) -> DVec3 {
    if old { direction } else { DVec3::new(direction.x, direction.z, -direction.y) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In the axes of Mitsuba 3.
    fn sun(hour: f64, [year, month, day]: [i64; 3], [latitude, longitude, timezone]: [f64; 3]) -> DVec3 {
        let hour = hour - timezone;
        let days = days_since_2000(year, month, day) + hour / 24.0;
        as_in_3(from_north(sun_position(days, hour, latitude.to_radians(), longitude)))
    }

    #[test]
    fn the_sun_stands_where_mitsuba_sees_it() {
        // The numbers are those of Mitsuba 3.9.1.
        let tokyo = [35.6894, 139.6917, 9.0];
        for (found, wanted) in [
            (sun(15.0, [2010, 7, 10], tokyo), DVec3::new(0.0513854, 0.691748, 0.720308)),
            (sun(9.0, [2010, 7, 10], tokyo), DVec3::new(0.0956952, -0.614786, 0.782867)),
            (sun(12.0, [2020, 12, 1], [40.0, -3.7, 1.0]), DVec3::new(0.859161, -0.255665, 0.443258)),
        ] {
            assert!(found.distance(wanted) < 1e-3, "{found} is not {wanted}");
        }
    }
}
