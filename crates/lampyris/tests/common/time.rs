//! Films with time, as tests ask for them and read them.

use lampyris::film::{Film, Layers};
use lampyris::image::luminance;
use lampyris::integrator::{Pass, Silent, integrator};
use lampyris::render::Render;

use super::Lit;

/// A point light above a floor of reflectance 0.7, 2.5 wide of the eye and 1.25 high, where the one pixel sees the point (1, 0, 0).
pub const POINT_OVER_FLOOR: &str = "
    camera = { origin = [0, 2, 0], target = [1, 0, 0], up = [0, 0, 1], fov = 0.02 }
    film = { size = [1, 1] }
    lights = [{ type = 'point', position = [2.5, 1.25, 0], intensity = 3 }]
    [[shapes]]
    type = 'plane'
    normal = [0, 1, 0]
    distance = 0
    material = { type = 'diffuse', reflectance = 0.7 }";

/// Settings of a film with these bins.
pub fn bins(bins: u32, start: f64, width: f64) -> String {
    format!(" time.bins={bins} time.start={start:?} time.bin-width={width:?}")
}

pub fn film(lit: &Lit, passes: u32, layers: Layers) -> Film {
    let mut render = Render::with_layers(&lit.scene, &lit.description, layers, &Silent);
    (0..passes).for_each(|_| render.step(&Silent));
    render.film().clone()
}

/// The mean over the picture of the luminance in each slot, before the first bin and after the last too, of each pass.
pub fn slots(lit: &Lit, passes: u32) -> Vec<Vec<f64>> {
    let Lit { description, scene } = lit;
    let (film, seed) = (&description.film, description.render.seed);
    let integrator = integrator(scene, film, &description.integrator, seed, &Silent);
    let slots = film.time.as_ref().expect("a film with time").bins as usize + 2;
    let pixels = f64::from(film.size[0] * film.size[1]);
    let mut each = vec![Vec::new(); slots];
    for index in 0..passes {
        let pass = Pass { index, seed };
        let exposure = integrator.expose(&scene.of_pass(seed, index), film, &pass, Layers::NONE, &Silent);
        let mut sums = vec![0.0; slots];
        for arrival in exposure.arrivals {
            sums[arrival.slot as usize] += f64::from(luminance(arrival.light)) / pixels;
        }
        each.iter_mut().zip(sums).for_each(|(values, sum)| values.push(sum));
    }
    each
}

/// The time at which each of these slots begins that have light, at the only pixel.
pub fn lit_bins(film: &Film) -> Vec<f64> {
    let clock = film.clock().expect("time");
    let bins = film.bins(0).into_iter().zip(0..);
    bins.filter(|(light, _)| light[1] > 0.0)
        .map(|(_, bin)| clock.start() + clock.bin_width() * f64::from(bin))
        .collect()
}
