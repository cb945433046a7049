//! Directions of every material are drawn with the density that is claimed, and events with their probabilities: chi-square
//! tests.

mod common;

use std::collections::HashMap;
use std::f64::consts::TAU;

use common::lit;
use common::materials::{MATERIALS, bsdf, direction};
use common::statistics::assert_distribution;
use glam::{DVec2, Vec3};
use lampyris::geometry::Ray;
use lampyris::material::{Bsdf, Event, Lobes, Scattered, choose_event};
use lampyris::sampler::Sampler;
use lampyris::scene::SurfacePoint;
use lampyris::spectrum::Spectrum;
use lampyris::transport::{End, Limits, Origin, PathState, Visitor, walk};

/// A part of all directions, by (z + 1) / 2 and the azimuth over 2π, which are uniform in solid angle.
#[derive(Clone, Copy)]
struct Cell {
    low: DVec2,
    side: DVec2,
}

impl Cell {
    const ALL: Cell = Cell { low: DVec2::ZERO, side: DVec2::ONE };

    fn quarters(&self) -> [Cell; 4] {
        let side = self.side / 2.0;
        [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]].map(|at| Cell { low: self.low + side * DVec2::from(at), side })
    }

    fn contains(&self, at: DVec2) -> bool {
        at.cmpge(self.low).all() && at.cmplt(self.low + self.side).all()
    }

    /// Where a direction lies.
    fn place(direction: Vec3) -> DVec2 {
        let around = f64::from(direction.y).atan2(f64::from(direction.x)) / TAU;
        DVec2::new(0.5 + 0.5 * f64::from(direction.z), around + if around < 0.0 { 1.0 } else { 0.0 })
    }

    /// The integral of a density over it; as many points as it takes.
    fn integral(&self, density: &dyn Fn(Vec3) -> f64, depth: u32) -> f64 {
        let coarse = self.midpoints(density);
        let quarters = self.quarters();
        let fine: f64 = quarters.iter().map(|quarter| quarter.midpoints(density)).sum();
        if depth == 0 || (fine - coarse).abs() < 2e-5 + 2e-3 * fine {
            return fine;
        }
        quarters.iter().map(|quarter| quarter.integral(density, depth - 1)).sum()
    }

    fn midpoints(&self, density: &dyn Fn(Vec3) -> f64) -> f64 {
        let mut sum = 0.0;
        for (i, j) in (0..6).flat_map(|i| (0..6).map(move |j| (i, j))) {
            let at = self.low + self.side * (DVec2::new(f64::from(i), f64::from(j)) + 0.5) / 6.0;
            let (z, (sin, cos)) = (2.0 * at.x - 1.0, (TAU * at.y).sin_cos());
            let radius = (1.0 - z * z).sqrt();
            sum += density(Vec3::new((radius * cos) as f32, (radius * sin) as f32, z as f32));
        }
        sum / 36.0 * 2.0 * TAU * self.side.x * self.side.y
    }

    /// Cells with some hundred of these directions each.
    fn around(places: Vec<DVec2>, cell: Cell, found: &mut Vec<Cell>) {
        if places.len() < 400 && cell.side.x <= 1.0 / 8.0 || cell.side.x < 1e-6 {
            return found.push(cell);
        }
        for quarter in cell.quarters() {
            let inside = places.iter().copied().filter(|&place| quarter.contains(place)).collect();
            Cell::around(inside, quarter, found);
        }
    }
}

/// Draws many directions and sorts them: those of smooth events by cells, delta events by what they are, and what leads
/// nowhere.
fn assert_sampled_as_claimed(name: &str, bsdf: &Bsdf, to_previous: Vec3, follow: Lobes) {
    const DRAWS: u32 = 60_000;
    let mut sampler = Sampler::new(5, 0, 0, 0);
    let mut smooth = Vec::new();
    let mut deltas: HashMap<(usize, [u32; 3], u32), (f64, Scattered)> = HashMap::new();
    for _ in 0..DRAWS {
        let Some(scattered) = bsdf.sample(to_previous, follow, &mut sampler) else { continue };
        assert!(follow.contains(scattered.event), "{name}: {scattered:?}");
        assert!((scattered.to_next.length() - 1.0).abs() < 1e-5, "{name}: {scattered:?}");
        assert!(scattered.weight.is_finite(), "{name}: {scattered:?}");
        if Lobes::DELTA.contains(scattered.event) {
            let weight = scattered.weight.to_rgb().map(f32::to_bits);
            let key = (scattered.event.index(), weight, scattered.pdf.to_bits());
            deltas.entry(key).or_insert((0.0, scattered)).0 += 1.0;
            continue;
        }
        let pdf = bsdf.pdf(to_previous, scattered.to_next, follow);
        assert!((scattered.pdf / pdf - 1.0).abs() < 1e-4, "{name}: {scattered:?} has the density {pdf}");
        let value = bsdf.eval(to_previous, scattered.to_next) * scattered.to_next.z.abs();
        let off = (scattered.weight * pdf).to_rgb().iter().zip(value.to_rgb()).any(|(a, b)| (a - b).abs() > 1e-4 * b);
        assert!(!off, "{name}: {scattered:?} is not the value {value:?} over the density");
        smooth.push(Cell::place(scattered.to_next));
    }
    let density = |to_next: Vec3| f64::from(bsdf.pdf(to_previous, to_next, follow));
    let mut cells = Vec::new();
    // The cells come from other draws than those they count, or each would hold as many as it was made for.
    Cell::around(smooth.iter().copied().step_by(4).collect(), Cell::ALL, &mut cells);
    let counted: Vec<DVec2> =
        smooth.iter().copied().enumerate().filter(|(i, _)| i % 4 != 0).map(|(_, at)| at).collect();
    let share = if smooth.is_empty() { 1.0 } else { counted.len() as f64 / smooth.len() as f64 };
    let mut expected: Vec<f64> = cells.iter().map(|cell| cell.integral(&density, 6)).collect();
    let mut observed = vec![0.0; cells.len()];
    for place in counted {
        observed[cells.iter().position(|cell| cell.contains(place)).expect("a cell")] += 1.0 / share;
    }
    for (count, scattered) in deltas.values() {
        observed.push(*count);
        expected.push(f64::from(scattered.pdf));
    }
    let drawn = f64::from(DRAWS);
    let total: f64 = expected.iter().sum();
    assert!(total < 1.003, "{name}: Σ = {total}");
    if smooth.is_empty() && deltas.is_empty() {
        assert!(total < 1e-6, "{name}: nothing is drawn where something should be");
        return;
    }
    if expected.iter().any(|&due| due > 0.999) {
        return; // One possible event: nothing is random.
    }
    // Three quarters of the smooth draws are counted, which widens their spread: trials are those that were counted.
    let expected: Vec<f64> = expected.iter().map(|due| due * drawn * share).collect();
    let observed: Vec<f64> = observed.iter().map(|count| count * share).collect();
    assert_distribution(name, &observed, &expected, drawn * share);
}

/// 36 materials × 3 angles × 2 sides × 3 sets of lobes at most: together, false alarms have odds of 7e-5.
#[test]
fn every_material_is_sampled_as_it_claims() {
    for material in MATERIALS {
        for front in [true, false] {
            let bsdf = bsdf(material, front);
            for z in [0.95_f32, 0.5, 0.1] {
                let to_previous = direction(if front { z } else { -z }, 0.7);
                let name = format!("{material} from {to_previous}");
                assert_sampled_as_claimed(&name, &bsdf, to_previous, Lobes::ALL);
                assert_sampled_as_claimed(&name, &bsdf, to_previous, Lobes::DELTA);
                assert_sampled_as_claimed(&name, &bsdf, to_previous, Event::Glossy.into());
            }
        }
    }
}

#[test]
fn the_choice_follows_the_weights_for_every_number_drawn() {
    let weights = [0.0, 0.3, 0.0, 0.5, 0.2, 0.0];
    let mut counts = [0_u32; 6];
    for step in 0..1_000_000 {
        let (slot, probability, total, _) = choose_event(&weights, (step as f32 + 0.5) / 1e6).expect("some");
        assert!((probability - weights[slot]).abs() < 1e-6 && (total - 1.0).abs() < 1e-6);
        counts[slot] += 1;
    }
    for (count, weight) in counts.iter().zip(weights) {
        assert!((*count as f32 * 1e-6 - weight).abs() < 1e-5, "{counts:?}");
    }
    assert_eq!(choose_event(&[0.0, 0.4, 0.0], 1.0 - f32::EPSILON / 2.0).map(|choice| choice.0), Some(1));
    assert!(choose_event(&[0.0; 4], 0.5).is_none());
}

/// The course's roulette: a white path is scattered diffusely with probability k_d, mirrored with k_s, refracted with
/// k_t and absorbed with 1 - Σ. Measured on the walk itself.
#[test]
fn a_white_path_meets_each_event_with_the_probability_of_its_coefficient() {
    struct Follow;
    impl Visitor for Follow {
        fn vertex(&mut self, _: &SurfacePoint, _: &PathState, _: &mut Sampler) -> Lobes {
            Lobes::ALL
        }
    }
    for (fresnel, reflected) in [(false, 0.0_f64), (true, 0.04)] {
        let text = format!(
            "camera = {{ origin = [0, 0, 3], target = [0, 0, 0] }}
             lights = [{{ type = 'constant' }}]
             [[shapes]]
             type = 'quad'
             corner = [-1, -1, 0]
             u = [2, 0, 0]
             v = [0, 2, 0]
             material = {{ type = 'coefficients', kd = 0.35, ks = 0.2, kt = 0.3, fresnel = {fresnel} }}"
        );
        let lit = lit(&text, "");
        let limits = Limits { max_bounces: 9, roulette_from: 0 };
        let trials = 200_000;
        let mut counts = [0.0; 4];
        for index in 0..trials {
            let ray = Ray { origin: Vec3::Z, direction: Vec3::NEG_Z };
            let mut sampler = Sampler::new(3, 0, 0, index);
            let path = PathState::new(ray, Spectrum::ONE);
            let walked = walk(&lit.scene, path, Origin::Light, &limits, &mut sampler, &mut Follow);
            let event = Event::ALL.into_iter().find(|&event| walked.path.history == event.into());
            match (walked.end, event) {
                (End::Absorbed, _) => counts[3] += 1.0,
                (End::Escaped, Some(Event::Diffuse)) => counts[0] += 1.0,
                (End::Escaped, Some(Event::Specular)) => counts[1] += 1.0,
                (End::Escaped, Some(Event::Refraction)) => counts[2] += 1.0,
                other => panic!("{other:?}"),
            }
        }
        let expected = [0.35, 0.2 + 0.3 * reflected, 0.3 * (1.0 - reflected), 0.15].map(|p| p * trials as f64);
        assert_distribution(&format!("fresnel = {fresnel}"), &counts, &expected, trials as f64);
    }
}
