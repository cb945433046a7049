//! Materials of any parameters send light back the way it came, and scatter no more than they get.

mod common;

use common::materials::{MATERIALS, bsdf, direction};
use glam::{Vec2, Vec3};
use lampyris::material::{Bsdf, Event, Lobes, Material, Materials, Plastic};
use lampyris::sampler::Sampler;
use lampyris::spectrum::Spectrum;
use lampyris::texture::{Lookup, Texture};
use proptest::prelude::*;

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
