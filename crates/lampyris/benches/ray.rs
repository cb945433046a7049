//! Closest hit: incoherent rays in a mesh of 786,432 triangles (a displaced sphere in a box) and in the course's box.

#![allow(missing_docs)]

mod scenes;

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::Vec3;
use lampyris::geometry::Ray;
use lampyris::math::warp;
use lampyris::sampler::Sampler;
use lampyris::scene::Scene;

const RAYS: u64 = 100_000;

/// Half from anywhere to anywhere, half bounces off surfaces.
fn incoherent_rays(scene: &Scene, half: f32) -> Vec<Ray> {
    let mut sampler = Sampler::new(1, 0, 0, 0);
    let mut rays = Vec::new();
    while rays.len() < RAYS as usize {
        let mut coordinate = || (2.0 * sampler.uniform() - 1.0) * half;
        let origin = Vec3::new(coordinate(), coordinate(), coordinate());
        let ray = Ray { origin, direction: warp::sphere(sampler.square()) };
        rays.push(ray);
        if let Some(point) = scene.closest(&ray) {
            let up = point.frame.to_world(warp::cosine_hemisphere(sampler.square()));
            rays.push(point.surface.spawn(up));
        }
    }
    rays.truncate(RAYS as usize);
    rays
}

fn closest_hit(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("closest hit");
    group.throughput(Throughput::Elements(RAYS));
    for (name, scene, half) in
        [("blob, 786 k triangles", scenes::blob(), 1.4), ("course's box", scenes::cornell_box(), 0.9)]
    {
        let rays = incoherent_rays(&scene, half);
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                rays.iter().filter(|ray| scene.surfaces().closest(black_box(ray), f32::INFINITY).is_some()).count()
            });
        });
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20);
    targets = closest_hit
}
criterion_main!(benches);
