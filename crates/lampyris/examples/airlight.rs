//! A flash in fog over a floor, by formulas instead of paths: `cargo run -p lampyris --example airlight -- airlight.npz`.
//!
//! Light that fog scatters once towards the camera has a closed form in time. Along a camera ray that passes a lamp of
//! intensity I at the distance h, z0 from the camera on, it is 2 σs p I exp(-σt s) / ((s - z0)² + h²) by path length s.

use glam::Vec3;
use lampyris::error::{Error, Result};
use lampyris::output::write_transient;
use lampyris::transient::{Timing, Transient};

const SIZE: (usize, usize, usize) = (160, 120, 120);
const CAMERA: Vec3 = Vec3::new(0.0, 1.2, -5.0);
const LAMP: Vec3 = Vec3::new(0.7, 1.6, 0.0);
const INTENSITY: f64 = 10.0;
const SCATTERING: f64 = 0.2;
const EXTINCTION: f64 = 0.25;
const ALBEDO: f64 = 0.6;
/// Rays that meet no floor end here.
const FAR: f64 = 30.0;

fn main() -> Result<()> {
    let path = std::env::args_os().nth(1).ok_or_else(|| Error::new("give the file to write, such as airlight.npz"))?;
    let (width, height, bins) = SIZE;
    let mut transient = Transient::new(width, height, bins, Timing::new(4.8, 0.06))?;
    let axis = *transient.axis();
    for (pixel, profile) in transient.profiles_mut().enumerate() {
        let (x, y) = ((pixel % width) as f32 + 0.5, (pixel / width) as f32 + 0.5);
        let scale = 0.9 / height as f32;
        let toward = Vec3::new((x - width as f32 / 2.0) * scale, (height as f32 / 2.0 - y) * scale, 1.0).normalize();
        let edges: Vec<f64> = (0..=bins).map(|bin| axis.edge(bin)).collect();
        let floor = if toward.y < 0.0 { f64::from(CAMERA.y / -toward.y) } else { FAR };
        for (value, edge) in profile.iter_mut().zip(edges.windows(2)) {
            *value = [0.8, 0.9, 1.0].map(|tint| (tint * fog(toward, floor, [edge[0], edge[1]])) as f32);
        }
        if let Some((length, radiance)) = surface(toward, floor) {
            let bin = axis.place(length).floor();
            if bin >= 0.0 && bin < bins as f64 {
                profile[bin as usize] = profile[bin as usize].map(|value| value + radiance as f32);
            }
        }
    }
    write_transient(path.as_ref(), &transient)
}

/// What the fog scatters into a camera ray as far as `end`, within path lengths.
fn fog(toward: Vec3, end: f64, [from, to]: [f64; 2]) -> f64 {
    let along = f64::from((LAMP - CAMERA).dot(toward));
    let aside = f64::from((LAMP - CAMERA - along as f32 * toward).length());
    let lamp_from = |t: f64| (aside * aside + (t - along) * (t - along)).sqrt();
    let (from, to) = (from.max(aside.hypot(along)), to.min(end + lamp_from(end)));
    if from >= to {
        return 0.0;
    }
    let phase = 1.0 / (4.0 * std::f64::consts::PI);
    let seen = ((to - along) / aside).atan() - ((from - along) / aside).atan();
    2.0 * SCATTERING * phase * INTENSITY * (-EXTINCTION * (from + to) / 2.0).exp() * seen / aside
}

/// What the floor reflects into a camera ray, with its path length.
fn surface(toward: Vec3, end: f64) -> Option<(f64, f64)> {
    let to_lamp = LAMP - (CAMERA + end as f32 * toward);
    let distance = f64::from(to_lamp.length());
    let cosine = f64::from(to_lamp.y) / distance;
    let radiance = ALBEDO / std::f64::consts::PI * INTENSITY * cosine / (distance * distance);
    (end < FAR).then(|| (distance + end, radiance * (-EXTINCTION * (distance + end)).exp()))
}
