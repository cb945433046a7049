//! Directions of every phase function are drawn with the density that is claimed: chi-square tests.

mod common;

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use common::statistics::assert_distribution;
use glam::Vec3;
use lampyris::math::Frame;
use lampyris::medium::{Phase, Table};
use lampyris::sampler::Sampler;

fn phases() -> Vec<(&'static str, Phase)> {
    let table = |values: &[f32]| Phase::Tabulated(Arc::new(Table::new(values).expect("a table")));
    let forward = || Phase::HenyeyGreenstein { g: 0.8 };
    let blend = |weight, first, second| Phase::Blend { weight, of: Arc::new([first, second]) };
    vec![
        ("isotropic", Phase::Isotropic),
        ("forward", forward()),
        ("backward", Phase::HenyeyGreenstein { g: -0.6 }),
        ("nearly even", Phase::HenyeyGreenstein { g: 5e-4 }),
        ("a little forward", Phase::HenyeyGreenstein { g: 2e-3 }),
        ("rayleigh", Phase::Rayleigh),
        ("table", table(&[0.1, 0.0, 0.0, 2.0, 1.0, 5.0])),
        ("two values", table(&[3.0, 1.0])),
        ("blend", blend(0.3, forward(), table(&[1.0, 0.0, 1.0]))),
        ("blend of blends", blend(0.6, blend(0.2, forward(), Phase::Isotropic), Phase::Rayleigh)),
    ]
}

const CELLS: usize = 64;
const AROUND: usize = 8;

/// The integral of the density over a cell of cosines, Simpson's rule on many pieces.
fn integral(phase: &Phase, cell: usize) -> f64 {
    const PIECES: usize = 200;
    let step = 2.0 / (CELLS * PIECES) as f64;
    let value = |place: f64| f64::from(phase.value((-1.0 + 2.0 * cell as f64 / CELLS as f64 + place * step) as f32));
    let piece = |i: usize| (value(i as f64) + 4.0 * value(i as f64 + 0.5) + value(i as f64 + 1.0)) / 6.0;
    TAU * step * (0..PIECES).map(piece).sum::<f64>()
}

#[test]
fn every_phase_function_is_normalised() {
    for (name, phase) in phases() {
        let whole: f64 = (0..CELLS).map(|cell| integral(&phase, cell)).sum();
        assert!((whole - 1.0).abs() < 2e-4, "{name}: {whole}");
    }
}

#[test]
fn directions_are_drawn_with_the_density_of_the_value() {
    const DRAWS: u32 = 200_000;
    let travel = Vec3::new(0.3, -0.5, 0.4).normalize();
    let frame = Frame::around(travel);
    for (name, phase) in phases() {
        let mut sampler = Sampler::new(17, 0, 0, 0);
        let mut observed = vec![0.0; CELLS * AROUND];
        for _ in 0..DRAWS {
            let choice = sampler.uniform();
            let direction = phase.sample(travel, choice, sampler.square());
            assert!((direction.length() - 1.0).abs() < 1e-5, "{name}");
            let local = frame.to_local(direction);
            let cell = ((0.5 * (f64::from(local.z) + 1.0) * CELLS as f64) as usize).min(CELLS - 1);
            let around = (0.5 + 0.5 * f64::from(local.y).atan2(f64::from(local.x)) / PI) * AROUND as f64;
            observed[cell * AROUND + (around as usize).min(AROUND - 1)] += 1.0;
        }
        let expected: Vec<f64> = (0..CELLS * AROUND)
            .map(|index| integral(&phase, index / AROUND) / AROUND as f64 * f64::from(DRAWS))
            .collect();
        assert_distribution(name, &observed, &expected, f64::from(DRAWS));
    }
}

#[test]
fn the_mean_cosine_of_henyey_and_greenstein_is_g() {
    for g in [-0.9_f32, -0.3, 0.0, 5e-4, 0.5, 0.95] {
        let phase = Phase::HenyeyGreenstein { g };
        let mut sampler = Sampler::new(18, 0, 0, 0);
        let draws = 100_000;
        let sum: f64 = (0..draws).map(|_| f64::from(phase.sample(Vec3::Z, 0.5, sampler.square()).z)).sum();
        // The standard deviation of a cosine is at most 1: six standard errors, odds 2e-9.
        assert!((sum / f64::from(draws) - f64::from(g)).abs() < 6.0 / f64::from(draws).sqrt(), "{g}");
    }
}
