//! Whatever is drawn at random is drawn with the density that is claimed: chi-square tests of all materials, lights and
//! the camera; reciprocity and energy of materials of any parameters.

mod common;

use std::collections::HashMap;
use std::f64::consts::{PI, TAU};

use common::lit;
use common::statistics::{assert_distribution, assert_frequency, assert_mean};
use glam::{DVec2, Vec2, Vec3};
use lampyris::camera::Camera;
use lampyris::geometry::Ray;
use lampyris::light::Light;
use lampyris::material::{Bsdf, Event, Lobes, Material, Materials, Plastic, Scattered, choose_event};
use lampyris::math::Frame;
use lampyris::sampler::Sampler;
use lampyris::scene::{Scene, SurfacePoint};
use lampyris::spectrum::Spectrum;
use lampyris::texture::{Lookup, Texture};
use lampyris::transport::{End, Limits, Origin, PathState, Visitor, walk};
use proptest::prelude::*;

/// A grid over all directions, uniform in solid angle: `Z` bands of the cosine to +z, `AROUND` sectors.
const Z: usize = 12;
const AROUND: usize = 16;
const BIN: f64 = 2.0 * TAU / (Z * AROUND) as f64;

fn bin(direction: Vec3) -> usize {
    let z = ((0.5 + 0.5 * f64::from(direction.z)) * Z as f64) as usize;
    let around = f64::from(direction.y.atan2(direction.x)) / TAU;
    let around = ((around + if around < 0.0 { 1.0 } else { 0.0 }) * AROUND as f64) as usize;
    z.min(Z - 1) * AROUND + around.min(AROUND - 1)
}

/// The integral of a density per solid angle over each bin, by the midpoint rule with `fine`² points.
fn integrals(fine: usize, density: impl Fn(Vec3) -> f64) -> Vec<f64> {
    let at = |step: usize, within: usize, of: usize| (step as f64 + (within as f64 + 0.5) / fine as f64) / of as f64;
    let integral = |bin: usize| {
        let mut sum = 0.0;
        for (i, j) in (0..fine).flat_map(|i| (0..fine).map(move |j| (i, j))) {
            let z = 2.0 * at(bin / AROUND, i, Z) - 1.0;
            let (sin, cos) = (TAU * at(bin % AROUND, j, AROUND)).sin_cos();
            let radius = (1.0 - z * z).sqrt();
            sum += density(Vec3::new((radius * cos) as f32, (radius * sin) as f32, z as f32));
        }
        sum * BIN / (fine * fine) as f64
    };
    (0..Z * AROUND).map(integral).collect()
}

fn direction(z: f32, around: f32) -> Vec3 {
    ((1.0 - z * z).sqrt() * Vec2::from_angle(around)).extend(z)
}

const MATERIALS: [&str; 36] = [
    "{ type = 'diffuse', reflectance = [0.2, 0.5, 0.8] }",
    "{ type = 'mirror', reflectance = 0.7 }",
    "{ type = 'glass' }",
    "{ type = 'glass', ior = 1.1, exterior-ior = 1.7, reflectance = 0.5, transmittance = [0.1, 0.9, 0.2] }",
    "{ type = 'thin-glass', ior = 1.8, transmittance = 0.4 }",
    "{ type = 'conductor', eta = [0.2, 0.9, 1.5], k = [3.9, 2.4, 1.9] }",
    "{ type = 'plastic', reflectance = [0.9, 0.2, 0.1] }",
    "{ type = 'plastic', reflectance = 0.8, specular = 0.3, ior = 1.9, nonlinear = true }",
    "{ type = 'coefficients', kd = [0.1, 0.4, 0.2], ks = 0.2, kt = [0.4, 0.1, 0.2] }",
    "{ type = 'coefficients', kd = 0.3, kt = 0.7, fresnel = false }",
    "{ type = 'two-sided', front = { type = 'plastic' }, back = { type = 'coefficients', kd = 0.4, ks = 0.4 } }",
    "{ type = 'mask', opacity = 0.3, material = { type = 'diffuse' } }",
    "{ type = 'mask', opacity = 0.6, material = { type = 'plastic' } }",
    "{ type = 'blend', weight = 0.3, first = { type = 'diffuse' }, second = { type = 'mirror' } }",
    "{ type = 'blend', weight = 0.7, first = { type = 'plastic' }, second = { type = 'glass' } }",
    "{ type = 'blend', weight = 0.5, first = { type = 'diffuse', reflectance = [1, 0, 0] },
       second = { type = 'diffuse', reflectance = [0, 0, 1] } }",
    "{ type = 'two-sided', front = { type = 'mask', opacity = 0.5, material = { type = 'glass' } } }",
    "{ type = 'conductor', metal = 'Au', roughness = { alpha = 0.001 } }",
    "{ type = 'conductor', metal = 'Cu', roughness = { alpha = 0.02, alpha-v = 0.4 } }",
    "{ type = 'conductor', metal = 'Al', roughness = { alpha = 1, multiple-scattering = true } }",
    "{ type = 'conductor', metal = 'Ag', roughness = { alpha = 0.3, distribution = 'beckmann' } }",
    "{ type = 'conductor', metal = 'W', roughness = { alpha = 0.9, alpha-v = 0.05, distribution = 'beckmann' } }",
    "{ type = 'glass', roughness = { alpha = 0.005 } }",
    "{ type = 'glass', ior = 1.2, reflectance = 0.2, roughness = { alpha = 0.3, alpha-v = 0.8 } }",
    "{ type = 'glass', ior = 2, roughness = { alpha = 0.7, multiple-scattering = true } }",
    "{ type = 'glass', ior = 1, exterior-ior = 1.5, roughness = { alpha = 0.2, distribution = 'beckmann' } }",
    "{ type = 'plastic', reflectance = [0.9, 0.2, 0.1], roughness = { alpha = 0.05 } }",
    "{ type = 'two-sided', front = { type = 'plastic', roughness = { alpha = 0.4, distribution = 'beckmann' } } }",
    "{ type = 'rough-diffuse', alpha = 0.7 }",
    "{ type = 'diffuse-transmission', reflectance = 0.6, transmittance = [0.1, 0.2, 0.3] }",
    "{ type = 'phong', exponent = 200 }",
    "{ type = 'ward', alpha-u = 0.05, alpha-v = 0.3 }",
    "{ type = 'principled', metallic = 0.3, roughness = 0.3, anisotropic = 0.7, clearcoat = 1, clearcoat-gloss = 0.5 }",
    "{ type = 'principled', spec-trans = 0.7, roughness = 0.4, clearcoat = 0.5, sheen = 1, flatness = 0.5 }",
    "{ type = 'principled-thin', spec-trans = 0.6, roughness = 0.3, diff-trans = 0.8, anisotropic = 0.5 }",
    "{ type = 'blend', weight = 0.4, first = { type = 'conductor', metal = 'Au', roughness = { alpha = 0.1 } },
       second = { type = 'glass', roughness = { alpha = 0.2 } } }",
];

/// The scattering function of a material, seen from the side of the normal or the other one.
fn bsdf(material: &str, front: bool) -> Bsdf<'static> {
    let text = "camera = { origin = [0, 0, 3], target = [0, 0, 0] }
        lights = [{ type = 'constant' }]
        shapes = [{ type = 'quad', corner = [-1, -1, 0], u = [2, 0, 0], v = [0, 2, 0], material = MATERIAL }]";
    let lit = Box::leak(Box::new(lit(&text.replace("MATERIAL", &material.replace('\n', " ")), "")));
    let at = Lookup::point(Vec2::new(0.55, 0.6));
    lit.scene.materials().bsdf(lit.scene.shapes()[0].material, &at, front)
}

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

/// 36 materials × 3 angles × 2 sides × 2 sets of lobes at most: together, false alarms have odds of 5e-5.
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

/// A colour with all lanes in 0..=1.
fn color() -> impl Strategy<Value = Spectrum> {
    [0.0f32..=1.0, 0.0f32..=1.0, 0.0f32..=1.0].prop_map(Spectrum::from_rgb)
}

fn model() -> impl Strategy<Value = Material> {
    let paint = || color().prop_map(Texture::Constant);
    let ior = || 0.4f32..3.0;
    prop_oneof![
        paint().prop_map(|reflectance| Material::Diffuse { reflectance }),
        paint().prop_map(|reflectance| Material::Mirror { reflectance }),
        (ior(), paint(), paint()).prop_map(|(ior, reflectance, transmittance)| Material::Glass {
            ior: ior.into(),
            reflectance,
            transmittance
        }),
        (ior(), paint(), paint()).prop_map(|(ior, reflectance, transmittance)| Material::ThinGlass {
            ior,
            reflectance,
            transmittance
        }),
        (color(), color(), paint()).prop_map(|(eta, k, reflectance)| Material::Conductor {
            eta: eta * 3.0,
            k: k * 6.0,
            reflectance
        }),
        (paint(), paint(), ior(), any::<bool>()).prop_map(|(reflectance, specular, ior, nonlinear)| {
            let inner_reflectance = Plastic::inner_reflectance(ior);
            Material::Plastic { reflectance, specular, ior, inner_reflectance, nonlinear }
        }),
        (color(), 0.0f32..1.0, 0.0f32..1.0, ior(), any::<bool>()).prop_map(|(kd, mirrored, through, ior, fresnel)| {
            let rest = Spectrum::ONE + kd * -1.0;
            let ks = rest * mirrored;
            let kt = (rest + ks * -1.0) * through;
            Material::Coefficients(lampyris::material::Coefficients { kd, ks, kt, ior, fresnel })
        }),
    ]
}

/// One model, or two in a blend, a mask or on two sides.
fn materials() -> impl Strategy<Value = (Materials, u32)> {
    (model(), model(), 0.0f32..=1.0, 0..4).prop_map(|(first, second, share, mix)| {
        let mut materials = Materials::default();
        let (first, second) = (materials.add(first), materials.add(second));
        let share = Texture::Constant(Spectrum::grey(share));
        let id = match mix {
            0 => first,
            1 => materials.add(Material::Blend { weight: share, first, second }),
            2 => materials.add(Material::Mask { opacity: share, material: first }),
            _ => materials.add(Material::TwoSided { front: first, back: second }),
        };
        (materials, id)
    })
}

fn any_direction() -> impl Strategy<Value = Vec3> {
    (0.02f32..1.0, 0.0f32..6.0, any::<bool>()).prop_map(|(z, around, up)| direction(if up { z } else { -z }, around))
}

/// The delta events that are possible from `to_previous`, each with its share of the light.
fn deltas(bsdf: &Bsdf, to_previous: Vec3) -> Vec<(Vec3, Spectrum, f32)> {
    let mut sampler = Sampler::new(1, 0, 0, 0);
    let mut found: Vec<(Vec3, Spectrum, f32, Event)> = Vec::new();
    for _ in 0..400 {
        let Some(scattered) = bsdf.sample(to_previous, Lobes::DELTA, &mut sampler) else { break };
        let (share, to_next) = (scattered.weight * scattered.pdf, scattered.to_next);
        let near = |other: &(Vec3, Spectrum, f32, Event)| {
            other.3 == scattered.event
                && (other.1 + share * -1.0).to_rgb().iter().all(|off| off.abs() < 1e-6)
                && (other.0 - to_next).length() < 1e-6
        };
        if !found.iter().any(near) {
            found.push((to_next, share, scattered.ior_ratio.lanes()[0], scattered.event));
        }
    }
    found.into_iter().map(|(to_next, share, ratio, _)| (to_next, share, ratio)).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn smooth_scattering_is_reciprocal((materials, id) in materials(), a in any_direction(), b in any_direction()) {
        let from = |direction: Vec3| materials.bsdf(id, &Lookup::point(Vec2::ZERO), direction.z > 0.0);
        let (there, back) = (from(a).eval(a, b).to_rgb(), from(b).eval(b, a).to_rgb());
        for (there, back) in there.into_iter().zip(back) {
            prop_assert!((there - back).abs() <= 1e-5 * there.abs() + 1e-7, "{} and {}", there, back);
        }
    }

    /// Light that goes a delta event's way back has the same share of it, and arrives where it came from.
    #[test]
    fn delta_scattering_is_reciprocal(model in model(), a in any_direction()) {
        let mut materials = Materials::default();
        let id = materials.add(model);
        let from = |direction: Vec3| materials.bsdf(id, &Lookup::point(Vec2::ZERO), direction.z > 0.0);
        for (b, share, ratio) in deltas(&from(a), a) {
            // Close to grazing, a rounding of the angle is a large change of Fresnel's share.
            if b.z.abs() < 0.02 || share.max() < 0.02 {
                continue;
            }
            let back = deltas(&from(b), b);
            let near = back.iter().find(|(to, ..)| (*to - a).length() < 2e-3);
            prop_assert!(near.is_some(), "{} to {}, but back to {:?}", a, b, back);
            let (_, same, inverse) = near.expect("found");
            let off = (share + *same * -1.0).to_rgb();
            prop_assert!(off.iter().all(|off| off.abs() < 5e-3), "{:?} there, {:?} back", share, same);
            prop_assert!((ratio * inverse - 1.0).abs() < 1e-5);
        }
    }

    /// What is scattered by all events together is no more than what came, in each lane.
    #[test]
    fn nothing_scatters_more_light_than_it_gets((materials, id) in materials(), a in any_direction()) {
        let bsdf = materials.bsdf(id, &Lookup::point(Vec2::ZERO), a.z > 0.0);
        let mut all = deltas(&bsdf, a).iter().fold(Spectrum::ZERO, |sum, (_, share, _)| sum + *share);
        let (bands, sectors) = (64, 4);
        for (i, j) in (0..bands).flat_map(|i| (0..sectors).map(move |j| (i, j))) {
            let z = (i as f32 + 0.5) / bands as f32 * 2.0 - 1.0;
            let b = direction(z, std::f32::consts::TAU * (j as f32 + 0.5) / sectors as f32);
            let weight = 2.0 * std::f32::consts::TAU / (bands * sectors) as f32;
            all += bsdf.eval(a, b) * (b.z.abs() * weight);
        }
        prop_assert!(all.to_rgb().iter().all(|&lane| (0.0..=1.003).contains(&lane)), "{:?}", all);
    }
}

/// What scatters smoothly and sends light back as it came, with or without the square of an index of refraction below.
const RECIPROCAL: [(&str, f32); 13] = [
    ("{ type = 'conductor', metal = 'Cu', roughness = { alpha = 0.02, alpha-v = 0.4 } }", 1.0),
    ("{ type = 'conductor', metal = 'W', roughness = { alpha = 0.6, distribution = 'beckmann' } }", 1.0),
    ("{ type = 'conductor', metal = 'Al', roughness = { alpha = 0.8, multiple-scattering = true } }", 1.0),
    ("{ type = 'glass', ior = 1.4, roughness = { alpha = 0.2, alpha-v = 0.5 } }", 1.4),
    ("{ type = 'glass', ior = 1, exterior-ior = 2, roughness = { alpha = 0.4, distribution = 'beckmann' } }", 0.5),
    ("{ type = 'glass', ior = 1.7, roughness = { alpha = 0.7, multiple-scattering = true } }", 1.7),
    ("{ type = 'plastic', reflectance = [0.9, 0.2, 0.1], roughness = { alpha = 0.2 } }", 1.0),
    ("{ type = 'rough-diffuse', alpha = 0.7 }", 1.0),
    ("{ type = 'diffuse-transmission', reflectance = 0.6, transmittance = [0.1, 0.2, 0.3] }", 1.0),
    ("{ type = 'phong' }", 1.0),
    ("{ type = 'ward', alpha-u = 0.2, alpha-v = 0.3 }", 1.0),
    (
        "{ type = 'principled', spec-trans = 0.7, eta = 1.3, clearcoat = 0.5, sheen = 1, flatness = 0.5, metallic = 0.2 }",
        1.3,
    ),
    ("{ type = 'principled-thin', spec-trans = 0.6, roughness = 0.3, diff-trans = 0.8, anisotropic = 0.5 }", 1.0),
];

#[test]
fn rough_scattering_is_reciprocal_but_for_the_square_of_the_index() {
    for (material, ior) in RECIPROCAL {
        let (front, back) = (bsdf(material, true), bsdf(material, false));
        for index in 0..4000_u32 {
            let place = |step: f32| (index as f32 * step).fract();
            let z = |at: f32| if at < 0.5 { at * 1.8 + 0.1 } else { -(at - 0.5) * 1.8 - 0.1 };
            let a = direction(z(place(0.618_034)), 6.0 * place(0.754_878));
            // Half of the pairs near the mirrored direction, where lobes are.
            let b = direction(z(place(0.569_84)), 6.0 * place(0.324_718));
            let b = if index % 2 == 0 { b } else { (Vec3::new(-a.x, -a.y, a.z) + 0.2 * b).normalize() };
            let side = |from: Vec3| if from.z > 0.0 { &front } else { &back };
            let square = |to: Vec3| if to.z > 0.0 { 1.0 } else { ior * ior };
            let there = side(a).eval(a, b).to_rgb().map(|value| value / square(b));
            let back = side(b).eval(b, a).to_rgb().map(|value| value / square(a));
            for (there, back) in there.into_iter().zip(back) {
                assert!(
                    (there - back).abs() <= 2e-3 * there.abs() + 1e-6,
                    "{material}, {a} to {b}: {there} and {back}"
                );
            }
        }
    }
}

/// The mean over strata of what a path is multiplied by: the share of the light that goes on, with its standard error.
fn scattered_share(bsdf: &Bsdf, to_previous: Vec3) -> ([f64; 3], f64) {
    let draws = 40_000;
    let mut sampler = Sampler::new(11, 0, 0, 0);
    let (mut sum, mut squares) = ([0.0; 3], 0.0);
    for _ in 0..draws {
        let Some(scattered) = bsdf.sample(to_previous, Lobes::ALL, &mut sampler) else { continue };
        for (sum, lane) in sum.iter_mut().zip(scattered.weight.to_rgb()) {
            *sum += f64::from(lane) / f64::from(draws);
        }
        squares += f64::from(scattered.weight.max()).powi(2) / f64::from(draws);
    }
    let largest = sum.iter().copied().fold(0.0, f64::max);
    (sum, ((squares - largest * largest).max(0.0) / f64::from(draws)).sqrt())
}

/// 6 standard errors: odds of 2e-9 each, 2e-6 all together.
#[test]
fn no_rough_material_scatters_more_light_than_it_gets() {
    for material in MATERIALS.iter().filter(|material| !material.contains("sheen")) {
        for z in [1.0_f32, 0.8, 0.3, 0.05, -0.05, -0.5, -1.0] {
            let (share, error) = scattered_share(&bsdf(material, z > 0.0), direction(z, 0.4));
            let allowed = 1.002 + 6.0 * error;
            assert!(share.iter().all(|&share| share <= allowed), "{material} from {z}: {share:?} ± {error}");
        }
    }
}

/// What absorbs nothing and is given back the light that its facets lose scatters all it gets, however rough it is.
#[test]
fn with_multiple_scattering_nothing_is_lost() {
    for distribution in ["ggx", "beckmann"] {
        for alpha in [0.01, 0.1, 0.3, 0.6, 1.0] {
            let rough = format!(
                "roughness = {{ alpha = {alpha}, distribution = '{distribution}', multiple-scattering = true }}"
            );
            for material in [
                format!("{{ type = 'conductor', eta = 0, k = 1, {rough} }}"),
                format!("{{ type = 'glass', ior = 1.5, {rough} }}"),
                format!("{{ type = 'plastic', reflectance = 1, {rough} }}"),
            ] {
                for z in [1.0_f32, 0.6, 0.2, 0.05, -0.2, -0.7] {
                    if z < 0.0 && material.contains("plastic") {
                        continue;
                    }
                    let (share, error) = scattered_share(&bsdf(&material, z > 0.0), direction(z, 0.4));
                    let off = (share[1] - 1.0).abs();
                    assert!(off < 0.005 + 6.0 * error, "{material} from {z}: {share:?} ± {error}");
                }
            }
        }
    }
}

fn with_lights(lights: &str) -> Scene {
    lit(&format!("camera = {{ origin = [0, 0, 9], target = [0, 0, 0] }}\n{lights}"), "").scene
}

/// The lamps that are shapes, each seen from somewhere beside it.
const LAMPS: [(&str, [f32; 3]); 7] = [
    ("{ type = 'quad', corner = [-1, -1, 0], u = [2, 0, 0], v = [0.5, 2, 0]", [0.3, 0.2, 0.8]),
    ("{ type = 'disk', radius = 1.2", [0.6, -0.2, 0.9]),
    ("{ type = 'sphere'", [0.9, 0.9, 0.9]),
    ("{ type = 'sphere', flip-normal = true", [0.3, -0.2, 0.5]),
    ("{ type = 'cylinder', from = [0, 0, -1], to = [0, 0.2, 1], radius = 0.7", [1.2, 0.3, 0.1]),
    ("{ type = 'cube'", [1.5, 1.4, 0.3]),
    ("{ type = 'cube', flip-normal = true", [0.2, 0.1, 0.3]),
];

/// Shadow rays towards shapes: the directions' distribution against the density that the light claims for the point
/// that a ray in that direction meets, which is what multiple importance sampling asks for.
#[test]
fn every_lamp_is_sampled_with_the_density_that_it_claims() {
    for (shape, at) in LAMPS {
        let scene = with_lights(&format!("shapes = [{shape}, emission = {{ radiance = 3 }} }}]"));
        let at = Vec3::from(at);
        let density = |direction: Vec3| {
            let mut bsdf = Bsdf::default();
            let point = scene.closest(&Ray { origin: at, direction }, &mut bsdf);
            let lit = point.filter(|point| !scene.emitted(point).is_zero());
            lit.map_or(0.0, |point| f64::from(scene.emitted_pdf(at, &point)))
        };
        let draws = 40_000;
        let expected: Vec<f64> = integrals(32, density).iter().map(|p| p * f64::from(draws)).collect();
        let mut observed = vec![0.0; Z * AROUND];
        let mut sampler = Sampler::new(1, 0, 0, 0);
        for _ in 0..draws {
            let Some(light) = scene.illuminate(at, &mut sampler) else { continue };
            let (pdf, claimed) = (light.pdf.expect("a density"), density(light.to_light));
            assert!((light.irradiance * pdf).to_rgb().iter().all(|radiance| (radiance / 3.0 - 1.0).abs() < 1e-4));
            // Rays to a shape's very edge may miss it, and where they graze it a rounding is a large step.
            let off = (f64::from(pdf) / claimed - 1.0).abs();
            assert!(claimed == 0.0 || claimed > 20.0 || off < 5e-3, "{shape}: {pdf} and {claimed}");
            observed[bin(light.to_light)] += 1.0;
        }
        assert_distribution(shape, &observed, &expected, f64::from(draws));
    }
}

/// Lamps with a back and with a pattern: still even by area, from both sides.
#[test]
fn lamps_of_two_sides_are_sampled_with_the_density_that_they_claim() {
    let emission = "emission = { radiance = 'squares', scale = 3, two-sided = true }";
    for (shape, at) in LAMPS {
        for side in [1.0, -1.0] {
            let textures = "textures = { squares = { type = 'checkerboard', color0 = 0.5, color1 = 1 } }";
            let scene = with_lights(&format!("{textures}\nshapes = [{shape}, {emission} }}]"));
            let at = Vec3::from(at) * Vec3::new(1.0, 1.0, side);
            let density = |direction: Vec3| {
                let mut bsdf = Bsdf::default();
                let lit = scene.closest(&Ray { origin: at, direction }, &mut bsdf);
                lit.map_or(0.0, |point| f64::from(scene.emitted_pdf(at, &point)))
            };
            let draws = 40_000;
            // Seen from inside or from beside, a closed shape has a back that the density of the front knows nothing
            // of: what is found behind is one more class.
            let expected: Vec<f64> = integrals(32, density).iter().map(|p| p * f64::from(draws)).collect();
            let mut observed = vec![0.0; Z * AROUND];
            let mut sampler = Sampler::new(3, 0, 0, 0);
            for _ in 0..draws {
                let Some(light) = scene.illuminate(at, &mut sampler) else { continue };
                // Points behind the front do not count: a shadow ray would not reach them.
                let seen = light.target.is_some_and(|target| !scene.surfaces().occluded(at, target));
                if seen {
                    observed[bin(light.to_light)] += 1.0;
                }
            }
            assert_distribution(&format!("{shape}, {side}"), &observed, &expected, f64::from(draws));
        }
    }
}

/// Photons carry the radiance of where they start, times π, the area and two sides; half of them leave by each.
#[test]
fn photons_of_a_lamp_of_two_sides_carry_what_its_texture_says() {
    let scene = with_lights(
        "textures = { squares = { type = 'checkerboard', color0 = [1, 0, 0.5], color1 = 1 } }
         shapes = [{ type = 'quad', corner = [-1, -1, 0], u = [2, 0, 0], v = [0, 3, 0],
                     emission = { radiance = 'squares', scale = 2, two-sided = true } }]",
    );
    let draws = 10_000;
    let (mut above, mut greens) = (0.0, Vec::new());
    let mut sampler = Sampler::new(4, 0, 0, 0);
    for _ in 0..draws {
        let light = scene.lights()[0].emitter().emit(scene.surfaces(), &mut sampler).expect("a photon");
        above += f64::from(u8::from(light.ray.direction.z > 0.0));
        let uv = (light.ray.origin.truncate() + 1.0) / Vec2::new(2.0, 3.0);
        let even = (uv.x > 0.5) == (uv.y > 0.5);
        let radiance = if even { [2.0, 0.0, 1.0] } else { [2.0; 3] };
        for (flux, radiance) in light.flux.to_rgb().into_iter().zip(radiance) {
            assert!((flux - radiance * 2.0 * std::f32::consts::PI * 6.0).abs() < 1e-3, "{light:?}");
        }
        greens.push(f64::from(light.flux.to_rgb()[1]));
    }
    assert_frequency("front", above, f64::from(draws), 0.5);
    let power = scene.power().to_rgb();
    assert!((power[1] / (2.0 * std::f32::consts::PI * 6.0) - 1.0).abs() < 1e-3, "{power:?}");
    assert_mean("green", &greens, f64::from(power[1]), 0.0, 0.1);
}

/// Where photons leave a shape: strata of equal area, by the texture coordinates.
#[test]
fn photons_leave_every_lamp_evenly() {
    for (shape, _) in LAMPS {
        let scene = with_lights(&format!("shapes = [{shape}, emission = {{ radiance = 1 }} }}]"));
        let strata = |uv: Vec2, normal: Vec3| -> usize {
            // Coordinates in which the area is uniform.
            let (u, v) = match shape {
                _ if shape.contains("disk") => (uv.x * uv.x, uv.y),
                _ if shape.contains("sphere") => (uv.x, 0.5 - 0.5 * (std::f32::consts::PI * uv.y).cos()),
                _ => (uv.x, uv.y),
            };
            let face = if shape.contains("cube") {
                let axis = normal.abs().max_position();
                2 * axis + usize::from(normal[axis] > 0.0)
            } else {
                0
            };
            let cell = |x: f32| ((x * 5.0) as usize).min(4);
            25 * face + 5 * cell(u) + cell(v)
        };
        let cells = if shape.contains("cube") { 150 } else { 25 };
        let draws = 30_000;
        let (mut places, mut directions) = (vec![0.0; cells], vec![0.0; 40]);
        let mut sampler = Sampler::new(2, 0, 0, 0);
        for _ in 0..draws {
            let light = scene.lights()[0].emitter().emit(scene.surfaces(), &mut sampler).expect("a photon");
            // Look back at where it came from.
            let back = Ray { origin: light.ray.origin, direction: -light.ray.direction };
            let mut bsdf = Bsdf::default();
            let Some(point) = scene.closest(&back, &mut bsdf) else { continue };
            if point.distance > 1e-2 {
                continue;
            }
            places[strata(point.surface.uv, point.surface.normal)] += 1.0;
            // Cosine-distributed: the squared cosine is uniform.
            let local = Frame::around(point.surface.normal).to_local(light.ray.direction);
            let around = f64::from(local.y.atan2(local.x)) / TAU + 0.5;
            let cos2 = f64::from(local.z * local.z);
            directions[((cos2 * 5.0) as usize).min(4) * 8 + ((around * 8.0) as usize).min(7)] += 1.0;
            assert!(local.z > 0.0, "{shape}: a photon leaves backwards {light:?} {point:?}");
        }
        let even = |cells: usize| vec![f64::from(draws) / cells as f64; cells];
        // Of the few photons that graze the surface, some are not found again by looking back.
        assert!(places.iter().sum::<f64>() > 0.999 * f64::from(draws));
        assert_distribution(shape, &places, &even(cells), f64::from(draws));
        assert_distribution(shape, &directions, &even(40), f64::from(draws));
    }
}

/// The photons of a light, by direction and by where they start in the plane across it.
fn emissions(light: &str, draws: u32) -> (Scene, Vec<(Ray, Spectrum)>) {
    // A small ball so that the world has an extent.
    let scene = with_lights(&format!("lights = [{light}]\nshapes = [{{ type = 'sphere', center = [1, 2, 3] }}]"));
    let mut sampler = Sampler::new(4, 0, 0, 0);
    let emitter = |scene: &Scene, sampler: &mut Sampler| scene.lights()[0].emitter().emit(scene.surfaces(), sampler);
    let all = (0..draws).filter_map(|_| emitter(&scene, &mut sampler)).map(|light| (light.ray, light.flux)).collect();
    (scene, all)
}

#[test]
fn photons_of_points_and_of_the_sky_go_in_all_directions() {
    for light in
        ["{ type = 'point', position = [1, 0, 0], intensity = 2 }", "{ type = 'constant', radiance = [1, 2, 3] }"]
    {
        let (_, all) = emissions(light, 50_000);
        let mut observed = vec![0.0; Z * AROUND];
        all.iter().for_each(|(ray, _)| observed[bin(ray.direction)] += 1.0);
        assert_distribution(light, &observed, &vec![50_000.0 * BIN / (2.0 * TAU); Z * AROUND], 50_000.0);
    }
}

/// They start evenly on a disk that hides the whole scene.
#[test]
fn photons_from_far_away_start_evenly_on_a_disk() {
    for light in ["{ type = 'directional', direction = [1, 2, -2] }", "{ type = 'constant' }"] {
        let (scene, all) = emissions(light, 50_000);
        let radius = f64::from(scene.bounds().radius()) * 1.001;
        let mut observed = vec![0.0; 60];
        for (ray, flux) in &all {
            let local = Frame::around(ray.direction).to_local(ray.origin - scene.bounds().center());
            assert!(f64::from(local.z) < -0.999 * radius, "outside the scene");
            let r2 = f64::from(local.x * local.x + local.y * local.y) / (radius * radius);
            let around = f64::from(local.y.atan2(local.x)) / TAU + 0.5;
            observed[((r2 * 6.0) as usize).min(5) * 10 + ((around * 10.0) as usize).min(9)] += 1.0;
            let solid_angle = if light.contains("constant") { 4.0 * PI } else { 1.0 };
            assert!((f64::from(flux.mean()) / (solid_angle * PI * radius * radius) - 1.0).abs() < 1e-4);
        }
        assert_distribution(light, &observed, &[50_000.0 / 60.0; 60], 50_000.0);
    }
}

/// By angle to the axis: the flux in each ring of the cone is the intensity times its solid angle; shadow rays see the
/// same intensity.
#[test]
fn a_spot_sends_the_flux_that_its_intensity_promises() {
    let light =
        "{ type = 'spot', position = [0, 0, 0], target = [1, 2, 2], intensity = 5, cutoff = 50, beam-width = 20 }";
    let (scene, all) = emissions(light, 100_000);
    let axis = Vec3::new(1.0, 2.0, 2.0) / 3.0;
    let Light::Spot(_) = &scene.lights()[0] else { panic!("a spot") };
    let falloff = |angle: f64| ((50.0 - angle) / 30.0).clamp(0.0, 1.0);
    let rings = 25;
    let mut flux: Vec<Vec<f64>> = vec![Vec::new(); rings];
    for (ray, watts) in &all {
        let angle = f64::from(axis.dot(ray.direction).clamp(-1.0, 1.0)).acos().to_degrees();
        let ring = ((angle / 2.0) as usize).min(rings - 1);
        for (index, sums) in flux.iter_mut().enumerate() {
            sums.push(if index == ring { f64::from(watts.mean()) } else { 0.0 });
        }
    }
    let mut power = 0.0;
    for (ring, flux) in flux.iter().enumerate() {
        let steps = 1000;
        let expected: f64 = (0..steps)
            .map(|step| 2.0 * (ring as f64 + (f64::from(step) + 0.5) / f64::from(steps)))
            .map(|angle| {
                5.0 * falloff(angle) * TAU * angle.to_radians().sin() * 2.0_f64.to_radians() / f64::from(steps)
            })
            .sum();
        power += expected;
        assert_mean(&format!("ring {ring}"), flux, expected, 1e-4, 1.0);
        let angle = (2.0 * ring as f32 + 1.0).to_radians();
        let aside = Frame::around(axis).to_world(Vec3::new(angle.sin(), 0.0, angle.cos()));
        let light = scene.illuminate(aside * 3.0, &mut Sampler::new(0, 0, 0, 0)).expect("light");
        let intensity = f64::from(light.irradiance.mean()) * 9.0;
        assert!((intensity / (5.0 * falloff(2.0 * ring as f64 + 1.0)) - 1.0).abs() < 1e-3, "ring {ring}");
    }
    assert!((f64::from(scene.power().mean()) / power - 1.0).abs() < 1e-4);
    let all: Vec<f64> = all.iter().map(|(_, watts)| f64::from(watts.mean())).collect();
    assert_mean("all rings", &all, power, 0.0, 0.02);
}

/// The sky is asked for all directions alike.
#[test]
fn shadow_rays_to_the_sky_go_in_all_directions() {
    let scene = with_lights("lights = [{ type = 'constant' }]");
    let mut sampler = Sampler::new(6, 0, 0, 0);
    let mut observed = vec![0.0; Z * AROUND];
    for _ in 0..50_000 {
        let light = scene.illuminate(Vec3::ZERO, &mut sampler).expect("light");
        assert!((light.pdf.expect("a density") * 2.0 * TAU as f32 - 1.0).abs() < 1e-5);
        observed[bin(light.to_light)] += 1.0;
    }
    assert_distribution("sky", &observed, &vec![50_000.0 * BIN / (2.0 * TAU); Z * AROUND], 50_000.0);
}

/// One of several lights is chosen with the probability that its light is divided by.
#[test]
fn with_several_lights_each_gets_its_due() {
    let scene = with_lights(
        "lights = [{ type = 'point', position = [0, 0, 1], intensity = 1 },
                   { type = 'point', position = [0, 2, 0], intensity = [9, 0, 0] },
                   { type = 'directional', direction = [1, 0, 0], irradiance = 0.1 }]
         shapes = [{ type = 'sphere', center = [20, 20, 20] }]",
    );
    let mut sampler = Sampler::new(7, 0, 0, 0);
    let mut sums = [vec![], vec![]];
    let mut photons = vec![];
    for _ in 0..100_000 {
        let [red, green, _] = scene.illuminate(Vec3::ZERO, &mut sampler).map_or([0.0; 3], |l| l.irradiance.to_rgb());
        sums[0].push(f64::from(red));
        sums[1].push(f64::from(green));
        photons.push(f64::from(scene.emit(&mut sampler).expect("a photon").1.flux.mean()));
    }
    assert_mean("red", &sums[0], 1.0 + 9.0 / 4.0 + 0.1, 0.0, 0.1);
    assert_mean("green", &sums[1], 1.0 + 0.1, 0.0, 0.1);
    assert_mean("flux", &photons, f64::from(scene.power().mean()), 0.0, 0.05);
}

fn camera(lens: f32) -> Camera {
    // As skewed as a user may write it.
    let axes = [Vec3::new(-0.8, 0.1, 0.0), Vec3::new(0.1, 0.6, 0.1), Vec3::new(0.2, 0.1, 1.5)];
    Camera::new(Vec3::new(0.3, 0.2, -4.0), axes, [40, 30], lens, 3.0).expect("a camera")
}

/// Rays through a uniform picture, where they meet a wall, against the importance that light tracing multiplies by.
#[test]
fn the_cameras_rays_are_distributed_as_its_importance_says() {
    for lens in [0.0, 0.4] {
        let camera = camera(lens);
        let (cells, low, side) = (24, Vec2::splat(-4.5), 9.0);
        let draws = 100_000;
        let mut sampler = Sampler::new(8, 0, 0, 0);
        let mut observed = vec![0.0; cells * cells];
        for _ in 0..draws {
            let ray = camera.ray(sampler.square() * Vec2::new(40.0, 30.0), sampler.square());
            let at = ray.at(-ray.origin.z / ray.direction.z);
            let cell = ((Vec2::new(at.x, at.y) - low) / side * cells as f32).floor();
            assert!(cell.min_element() >= 0.0 && cell.max_element() < cells as f32, "the wall is large enough");
            observed[cell.y as usize * cells + cell.x as usize] += 1.0;
        }
        let fine = 24;
        let mut expected = vec![0.0; cells * cells];
        for y in 0..cells * fine {
            for x in 0..cells * fine {
                let step = side / (cells * fine) as f32;
                let at = low + step * (Vec2::new(x as f32, y as f32) + 0.5);
                let Some(seen) = camera.see(at.extend(0.0), sampler.square()) else { continue };
                if seen.pixel.cmpge(Vec2::ZERO).all() && seen.pixel.cmplt(Vec2::new(40.0, 30.0)).all() {
                    let cos = (seen.lens - at.extend(0.0)).normalize().z.abs();
                    // A pixel's value for radiance 1, by the number of pixels.
                    expected[(y / fine) * cells + x / fine] +=
                        f64::from(seen.importance * cos * step * step / 1200.0) * f64::from(draws);
                }
            }
        }
        assert_distribution(&format!("lens {lens}"), &observed, &expected, f64::from(draws));
    }
}

proptest! {
    #[test]
    fn what_a_ray_meets_is_seen_where_the_ray_started(
        x in 0.0f32..40.0, y in 0.0f32..30.0, u in 0.0f32..1.0, v in 0.0f32..1.0, distance in 0.1f32..50.0,
        lens in prop_oneof![Just(0.0f32), 0.01f32..0.5],
    ) {
        let camera = camera(lens);
        let (pixel, on_lens) = (Vec2::new(x, y), Vec2::new(u, v));
        let ray = camera.ray(pixel, on_lens);
        let seen = camera.see(ray.at(distance), on_lens).expect("in front");
        prop_assert!((seen.lens - ray.origin).length() < 1e-6);
        // Close to the lens, a rounding of the point is a larger step in the picture.
        prop_assert!((seen.pixel - pixel).length() < 2e-3 * (1.0 + 1.0 / distance), "{}", seen.pixel);
    }
}
