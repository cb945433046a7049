//! The photon map: a million photons on the surfaces of a mesh, sorted, then asked at random points of these surfaces
//! with a radius that holds 50 photons on average, and for the 50 nearest.

#![allow(missing_docs)]

mod scenes;

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use glam::Vec3;
use lampyris::material::Lobes;
use lampyris::photon::{Nearest, Photon, PhotonMap, Radius};
use lampyris::sampler::Sampler;
use lampyris::spectrum::Spectrum;

const PHOTONS: usize = 1_000_000;
const QUERIES: u64 = 200_000;
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
        flux: Spectrum::ONE,
        bounce: 0,
        history: Lobes::NONE,
    };
    points(PHOTONS, 1).into_iter().map(photon).collect()
}

/// The radius within which 50 photons lie on average: measured, not computed, since the surface is bumpy.
fn radius(photons: &[Photon], queries: &[Vec3]) -> f32 {
    let map = PhotonMap::build(photons.to_vec(), 1, Radius::Nearest { count: INSIDE, max_radius: f32::INFINITY });
    let mut found = Nearest::default();
    let mut radii: Vec<f32> =
        queries.iter().take(500).map(|&at| map.nearest(at, INSIDE, f32::INFINITY, &mut found).0).collect();
    radii.sort_by(f32::total_cmp);
    radii[radii.len() / 2]
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

fn photon_map(criterion: &mut Criterion) {
    let (photons, queries) = (photons(), coherent(points(QUERIES as usize, 2)));
    let radius = radius(&photons, &queries);
    let fixed = Radius::Fixed(radius);

    let mut group = criterion.benchmark_group("photon map");
    group.throughput(Throughput::Elements(PHOTONS as u64));
    group.bench_function("build, 1 M photons", |bencher| {
        bencher.iter_batched(|| photons.clone(), |photons| PhotonMap::build(photons, 1, fixed), BatchSize::LargeInput);
    });

    group.throughput(Throughput::Elements(QUERIES));
    let map = PhotonMap::build(photons.clone(), 1, fixed);
    group.bench_function("gather within a radius, 50 photons", |bencher| {
        bencher.iter(|| {
            let mut sum = 0.0;
            for &at in &queries {
                map.within(at, radius, |photon, distance| sum += photon.flux.max() * distance);
            }
            sum
        });
    });
    let nearest = Radius::Nearest { count: INSIDE, max_radius: 2.0 * radius };
    let map = PhotonMap::build(photons, 1, nearest);
    let mut found = Nearest::default();
    group.bench_function("gather the 50 nearest", |bencher| {
        bencher.iter(|| {
            let mut sum = 0.0;
            for &at in &queries {
                sum += map
                    .nearest(at, INSIDE, 2.0 * radius, &mut found)
                    .1
                    .map(|(photon, d)| photon.flux.max() * d)
                    .sum::<f32>();
            }
            sum
        });
    });
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20);
    targets = photon_map
}
criterion_main!(benches);
