//! The photon map: a million photons on the surface of a mesh, sorted, then asked at a million points of this surface
//! with a radius that holds 50 photons on average, and for the 50 nearest; against a plain grid ([`row_grid`]).
//!
//! ```text
//! cargo bench -p lampyris --bench photon_map [-- ROUNDS]
//! ```
//!
//! The contenders take turns, on one thread, and the seconds are those that the thread was running (wall clock where the
//! system does not tell), the best of all rounds: other programs disturb them little.

// A program that measures: it reads the clock and its arguments, unlike the library.
#![allow(missing_docs, clippy::print_stdout, clippy::disallowed_methods)]

mod row_grid;
mod scenes;

use std::hint::black_box;
use std::time::Instant;

use glam::Vec3;
use lampyris::material::Lobes;
use lampyris::photon::{Kernel, Nearest, Photon, PhotonMap, Radius};
use lampyris::sampler::Sampler;
use lampyris::spectrum::Spectrum;
use row_grid::{Record, RowGrid};

const PHOTONS: usize = 1_000_000;
const QUERIES: usize = 1_000_000;
const INSIDE: usize = 50;

/// Points uniform by area on the bumpy sphere, one after the other along a random order of its triangles.
fn points(count: usize, seed: u64) -> Vec<Vec3> {
    let scene = scenes::blob();
    let mut sampler = Sampler::new(seed, 0, 0, 0);
    (0..count).filter_map(|_| scene.surfaces().sample(0, sampler.square())).map(|surface| surface.position).collect()
}

fn photons() -> Vec<Photon> {
    let photon = |position| Photon {
        position,
        direction: Vec3::NEG_Z,
        normal: Vec3::Z,
        optical_length: 0.0,
        reach: 1.0,
        slowness: 1.0,
        flux: Spectrum::ONE,
        shading: 1.0,
        rivals: 0.0,
        path: 0,
        bounce: 0,
        history: Lobes::NONE,
    };
    points(PHOTONS, 1).into_iter().map(photon).collect()
}

/// The radius within which 50 photons lie on average: measured, not computed, since the surface is bumpy.
fn radius(photons: &[Photon], queries: &[Vec3]) -> f32 {
    let some: Vec<Vec3> = queries.iter().step_by(997).copied().collect();
    let mean = |map: &PhotonMap, radius: f32| {
        let mut found = Nearest::default();
        some.iter().map(|&at| map.within(at, radius, &mut found).count()).sum::<usize>() as f32 / some.len() as f32
    };
    let mut radius = 0.01;
    for _ in 0..8 {
        let map = PhotonMap::build(photons.to_vec(), 1, Radius::Fixed(radius));
        radius *= (INSIDE as f32 / mean(&map, radius)).sqrt();
    }
    radius
}

/// In the order in which tiles of a picture would ask: along a space-filling curve.
fn coherent(mut queries: Vec<Vec3>) -> Vec<Vec3> {
    let spread = |x: f32| {
        let bits = ((x + 1.5) * 300.0) as u64;
        (0..10).fold(0u64, |code, bit| code | ((bits >> bit) & 1) << (3 * bit))
    };
    queries.sort_by_key(|at| spread(at.x) | spread(at.y) << 1 | spread(at.z) << 2);
    queries
}

/// Seconds that this thread was running.
fn seconds(start: Instant) -> f64 {
    let scheduled = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = scheduled.and_then(|text| text.split(' ').next()?.parse::<f64>().ok());
    nanoseconds.map_or_else(|| start.elapsed().as_secs_f64(), |nanoseconds| nanoseconds * 1e-9)
}

/// One way to do a task: it does it, and returns what it found, that it may be compared.
struct Contender<'a> {
    task: String,
    name: &'static str,
    run: Box<dyn FnMut() -> f64 + 'a>,
    best: f64,
    result: f64,
}

impl<'a> Contender<'a> {
    fn new(task: &str, name: &'static str, run: impl FnMut() -> f64 + 'a) -> Contender<'a> {
        Contender { task: task.to_string(), name, run: Box::new(run), best: f64::INFINITY, result: 0.0 }
    }
}

fn main() {
    let rounds = std::env::args().filter_map(|argument| argument.parse().ok()).next().unwrap_or(5);
    let (photons, random) = (photons(), points(QUERIES, 2));
    let coherent = coherent(random.clone());
    let r = radius(&photons, &coherent);
    println!("{PHOTONS} photons, {QUERIES} queries, radius {r}; one thread, best of {rounds}");

    // The plain grid has no more in its records than it needs, a position and one number; or what the map has.
    let record = |photon: &Photon| Record { position: photon.position, payload: photon.flux.max() };
    let records: Vec<Record<f32>> = photons.iter().map(record).collect();
    let whole = |photon: &Photon| Record { position: photon.position, payload: *photon };
    let whole = RowGrid::build(&photons.iter().map(whole).collect::<Vec<_>>(), r);
    let plain = [("plain grid, cell r", 1.0), ("plain grid, cell r/2", 0.5)]
        .map(|(name, share)| (name, RowGrid::build(&records, share * r)));
    let map = PhotonMap::build(photons.clone(), 1, Radius::Fixed(r));
    let reaches = [("2 r", 2.0 * r), ("1.2 r", 1.2 * r)].map(|(name, max_radius)| {
        (name, max_radius, PhotonMap::build(photons.clone(), 1, Radius::Nearest { count: INSIDE, max_radius }))
    });

    // The estimate of a query is Σ flux × kernel.
    let weight = |radius| Kernel::Epanechnikov.weight::<2>(radius);
    let mut contenders = Vec::new();
    for (order, queries) in [("coherent", &coherent), ("random", &random)] {
        let task = format!("all within r, {order}");
        let all = move |estimate: &mut dyn FnMut(Vec3) -> f32| queries.iter().map(|&at| f64::from(estimate(at))).sum();
        for (name, grid) in &plain {
            contenders.push(Contender::new(&task, name, move || {
                all(&mut |at| {
                    let (mut sum, weight) = (0.0, weight(r));
                    grid.within(at, r, |flux, d2| sum += flux * weight(d2));
                    sum
                })
            }));
        }
        let (whole, map) = (&whole, &map);
        contenders.push(Contender::new(&task, "plain grid of photons, cell r", move || {
            all(&mut |at| {
                let (mut sum, weight) = (Spectrum::ZERO, weight(r));
                whole.within(at, r, |photon, d2| sum += photon.flux * weight(d2));
                sum.max()
            })
        }));
        let mut found = Nearest::default();
        contenders.push(Contender::new(&task, "photon map", move || {
            all(&mut |at| {
                let (mut sum, weight) = (Spectrum::ZERO, weight(r));
                map.within(at, r, &mut found).for_each(|(photon, d2)| sum += photon.flux * weight(d2));
                sum.max()
            })
        }));
        for (reach, max_radius, map) in &reaches {
            let task = format!("{INSIDE} nearest within {reach}, {order}");
            for (name, grid) in &plain {
                let mut found = Vec::new();
                contenders.push(Contender::new(&task, name, move || {
                    all(&mut |at| {
                        let radius = grid.nearest(at, INSIDE, *max_radius, &mut found);
                        let weight = weight(radius);
                        found.iter().map(|(d2, flux)| flux * weight(*d2)).sum()
                    })
                }));
            }
            let mut found = Nearest::default();
            contenders.push(Contender::new(&task, "photon map", move || {
                all(&mut |at| {
                    let (radius, photons) = map.nearest(at, INSIDE, *max_radius, &mut found);
                    let weight = weight(radius);
                    photons.fold(Spectrum::ZERO, |sum, (photon, d2)| sum + photon.flux * weight(d2)).max()
                })
            }));
        }
    }
    contenders.push(Contender::new("build", "plain grid, cell r", || {
        black_box(RowGrid::build(&records, r));
        0.0
    }));

    let start = Instant::now();
    for _ in 0..rounds {
        for contender in &mut contenders {
            let begin = seconds(start);
            contender.result = black_box((contender.run)());
            contender.best = contender.best.min(seconds(start) - begin);
        }
    }
    let mut yardstick = ("", 0.0);
    for contender in &contenders {
        if contender.task != yardstick.0 {
            println!("\n{}", contender.task);
            yardstick = (&contender.task, contender.best);
        }
        let (best, speed) = (contender.best, yardstick.1 / contender.best);
        println!("  {:<30} {best:>7.3} s {speed:>6.2} x   sum {:.6e}", contender.name, contender.result);
    }
    for threads in [1, 2] {
        println!(
            "  {:<30} {:>7.3} s by the clock",
            format!("photon map, {threads} threads"),
            build(&photons, r, threads, rounds)
        );
    }
}

/// Seconds on the wall clock that a map takes, the best of so many.
fn build(photons: &[Photon], radius: f32, threads: usize, rounds: usize) -> f64 {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    let once = |_| {
        let photons = photons.to_vec();
        let begin = Instant::now();
        black_box(pool.install(|| PhotonMap::build(photons, 1, Radius::Fixed(radius))));
        begin.elapsed().as_secs_f64()
    };
    (0..rounds).map(once).fold(f64::INFINITY, f64::min)
}
