//! Films with time, as tests ask for them and read them.

use lampyris::film::{Arrival, Film, Layers};
use lampyris::image::luminance;
use lampyris::integrator::{Pass, Silent, integrator};

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

/// The luminance that arrives in each of so many classes, in each pass.
pub fn arriving(lit: &Lit, passes: u32, classes: usize, class: impl Fn(&Arrival) -> usize) -> Vec<Vec<f64>> {
    let Lit { description, scene } = lit;
    let (film, seed) = (&description.film, description.render.seed);
    let integrator = integrator(scene, film, &description.integrator, seed, &Silent);
    let mut each = vec![vec![0.0; passes as usize]; classes];
    for index in 0..passes {
        let pass = Pass { index, seed };
        let exposure = integrator.expose(&scene.of_pass(seed, index), film, &pass, Layers::NONE, &Silent);
        for arrival in exposure.arrivals {
            each[class(&arrival)][index as usize] += f64::from(luminance(arrival.light));
        }
    }
    each
}

/// How many slots the bins of a pixel make, with those before the first and after the last.
pub fn slot_count(lit: &Lit) -> usize {
    lit.description.film.time.as_ref().expect("a film with time").bins as usize + 2
}

/// The mean over the picture of the luminance in each slot, before the first bin and after the last too, of each pass.
pub fn slots(lit: &Lit, passes: u32) -> Vec<Vec<f64>> {
    let [width, height] = lit.description.film.size;
    let mut each = arriving(lit, passes, slot_count(lit), |arrival| arrival.slot as usize);
    each.iter_mut().flatten().for_each(|sum| *sum /= f64::from(width * height));
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
