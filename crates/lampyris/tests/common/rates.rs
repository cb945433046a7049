//! How fast errors fall.

use lampyris::film::{Film, Layers};
use lampyris::image::Image;
use lampyris::integrator::{Pass, Silent, integrator};

use super::Lit;

/// Mean squared error after each of these numbers of passes, over so many seeds, where that of a picture is known.
pub fn errors(lit: &Lit, seeds: u64, at: &[u32], squared_error: impl Fn(&Image) -> f64) -> Vec<f64> {
    let Lit { scene, description } = lit;
    let film = &description.film;
    let mut sums = vec![0.0; at.len()];
    for seed in 0..seeds {
        let way = integrator(scene, film, &description.integrator, seed, &Silent);
        let mut picture = Film::new(film.size);
        for (sum, &passes) in sums.iter_mut().zip(at) {
            while picture.passes() < passes {
                let pass = Pass { index: picture.passes(), seed };
                picture.add_pass(&way.expose(scene, film, &pass, Layers::NONE, &Silent));
            }
            *sum += squared_error(&picture.image()) / seeds as f64;
        }
    }
    sums
}

/// Least squares of log error over log passes.
pub fn slope(at: &[u32], errors: &[f64]) -> f64 {
    let points: Vec<(f64, f64)> = at.iter().zip(errors).map(|(&n, error)| (f64::from(n).ln(), error.ln())).collect();
    let count = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(x, y), point| (x + point.0 / count, y + point.1 / count));
    points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>() / points.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
}
