//! Whole walks: passes of each integrator on the course's box, on one thread.

#![allow(missing_docs)]

mod scenes;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use lampyris::film::Layers;
use lampyris::integrator::{Pass, PhotonMapping, Silent, integrator};
use lampyris::scene::description::{
    FilmDescription, IntegratorDescription, LightSettings, PathSettings, PhotonMapSettings,
};

fn walks(criterion: &mut Criterion) {
    let scene = scenes::cornell_box();
    let film = FilmDescription { size: [64, 64], ..FilmDescription::default() };
    let pass = Pass { index: 0, seed: 0 };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("one thread");
    let mut group = criterion.benchmark_group("walk");

    let settings = PhotonMapSettings { radius: Some(0.02), ..PhotonMapSettings::default() };
    group.throughput(Throughput::Elements(u64::from(settings.photons)));
    let mapping = PhotonMapping::new(&scene, &film, settings.clone(), 0, &Silent);
    group.bench_function("100 k light paths with their photon map", |bencher| {
        bencher.iter(|| pool.install(|| mapping.map(&scene, &pass, &Silent)));
    });

    group.throughput(Throughput::Elements(64 * 64));
    for description in [
        IntegratorDescription::PhotonMap(PhotonMapSettings { photons: 10_000, ..settings }),
        IntegratorDescription::Path(PathSettings::default()),
        IntegratorDescription::Light(LightSettings::default()),
    ] {
        let integrator = integrator(&scene, &film, &description, 0, &Silent);
        group.bench_function(format!("a pass of {}, 64×64", integrator.name()), |bencher| {
            bencher.iter(|| pool.install(|| integrator.expose(&scene, &film, &pass, Layers::NONE, &Silent)));
        });
    }
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20);
    targets = walks
}
criterion_main!(benches);
