//! The photon map itself as a picture, as the course's slide shows it.

use glam::Vec2;

use crate::image::Image;
use crate::photon::{Photon, PhotonMap};
use crate::scene::Scene;
use crate::scene::description::FilmDescription;

/// Every photon that is `shown` and in plain sight is a dot of its colour, of brightness 1 at the mean flux.
pub(super) fn draw(scene: &Scene, film: &FilmDescription, map: &PhotonMap, shown: impl Fn(&Photon) -> bool) -> Image {
    let mut image = Image::new(film.size[0] as usize, film.size[1] as usize);
    let count = map.photons().len().max(1) as f32;
    let mean = map.photons().iter().map(|photon| photon.flux.max() / count).sum::<f32>();
    for photon in map.photons().iter().filter(|photon| shown(photon)) {
        let Some(seen) = scene.seen_by_camera(photon.position, Vec2::splat(0.5)) else { continue };
        let Some(pixel) = film.pixel_number(seen.pixel) else { continue };
        // Off the surface by more than rounding, less than can be seen.
        let position = photon.position + photon.normal * (1e-5 * photon.position.distance(seen.lens));
        if !scene.surfaces().occluded(position, seen.lens) {
            let sum = &mut image.pixels_mut()[pixel as usize];
            let light = scene.basis().to_rgb(photon.flux / mean);
            *sum = [0, 1, 2].map(|channel| sum[channel] + light[channel]);
        }
    }
    image
}
