//! Photons through glass and over mirrors against ray optics done by hand.

mod common;

use std::f64::consts::PI;
use std::sync::Arc;

use common::statistics::{assert_distribution, assert_frequency, assert_mean};
use common::{Lit, built, described, lit, slab, square};
use lampyris::geometry::MeshData;
use lampyris::material::{Event, Lobes};
use lampyris::photon::Photon;
use lampyris::scene::description::{GeometryDescription, MaterialDescription, MaterialRef, Paint, ShapeDescription};

const REFRACTED: Lobes = Lobes::DELTA;

/// A scene for photons alone: nobody looks at what the camera sees.
fn photons(paths: u32, rest: &str) -> Lit {
    let text = "camera = { origin = [9, 9, 9], target = [0, 0, 0] }
        film = { size = [1, 1] }\n"
        .to_string()
        + rest;
    lit(&text, &format!("integrator=photon-map photons={paths} bandwidth=fixed radius=1 direct=photons max_bounces=64"))
}

/// The photons of a pass that lie at height `y` and have been through this many mirrors and boundaries.
fn landed(lit: &Lit, y: f32, bounces: std::ops::Range<u16>) -> Vec<Photon> {
    let map = lit.map(0);
    let wanted = |photon: &&Photon| {
        (photon.position.y - y).abs() < 1e-4
            && bounces.contains(&photon.bounce)
            && !photon.history.meets(Lobes::SMOOTH)
            && (photon.history.is_none() || REFRACTED.meets(photon.history))
    };
    map.photons().iter().filter(wanted).copied().collect()
}

/// Light from straight above; its photons start on a disk of this radius around the bounds, W of it falls on 1 m².
fn emitted_area(lit: &Lit) -> f64 {
    f64::from(lit.scene.power().mean())
}

const FROM_ABOVE: &str = "lights = [{ type = 'directional', direction = [0, -1, 0] }]\n";

/// All inner reflections of a slab under normal incidence add up to T = 2n/(n² + 1).
#[test]
fn a_slab_of_glass_lets_through_all_that_geometry_allows() {
    let paths = 200_000;
    for n in [1.5_f64, 2.4] {
        let glass = format!("{{ type = 'glass', ior = {n} }}");
        let black = "{ type = 'diffuse', reflectance = 0 }";
        let text = FROM_ABOVE.to_string() + &slab(1.0, 0.5, 2.0, &glass) + &square(0.0, 1.0, false, black);
        let lit = photons(paths, &text);
        let expected = 2.0 * n / (n * n + 1.0) * 4.0 / emitted_area(&lit);
        let through = landed(&lit, 0.0, 2..65).len() as f64;
        assert_frequency(&format!("n = {n}"), through, f64::from(paths), expected);
    }
}

/// The same from the other end: a lamp seen straight through the slab.
#[test]
fn a_lamp_behind_a_slab_is_dimmed_by_what_the_slab_reflects() {
    let glass = "{ type = 'glass', ior = 1.5 }";
    let text = "camera = { origin = [0, 3, 0], target = [0, 0, 0], up = [1, 0, 0], fov = 0.01 }
        film = { size = [8, 8] }\n"
        .to_string()
        + &slab(1.0, 0.5, 2.0, glass)
        + &square(0.0, 1.0, false, "{ type = 'diffuse', reflectance = 0 }")
        + "emission = { radiance = 1 }";
    for way in ["integrator=path samples=16", "integrator=photon-map photons=1 radius=1 samples=16"] {
        assert_mean(way, &lit(&text, way).means(50)[0], 3.0 / 3.25, 0.0, 0.02);
    }
}

fn fresnel_by_hand(sin: f64, n: f64) -> f64 {
    let (cos, cos_t) = ((1.0 - sin * sin).sqrt(), (1.0 - (sin / n).powi(2)).sqrt());
    let parallel = (n * cos - cos_t) / (n * cos + cos_t);
    let perpendicular = (cos - n * cos_t) / (cos + n * cos_t);
    0.5 * (parallel * parallel + perpendicular * perpendicular)
}

#[test]
fn still_water_lets_one_minus_fresnel_through() {
    let (paths, sin, n) = (100_000, 0.8_f64, 1.33);
    // The floor is so large that the slanted light of the water's square falls on it whole.
    let text = "lights = [{ type = 'directional', direction = [0.8, -0.6, 0] }]\n".to_string()
        + &square(0.5, 1.0, false, &format!("{{ type = 'glass', ior = {n} }}"))
        + &square(0.0, 3.0, false, "{ type = 'diffuse', reflectance = 0 }");
    let lit = photons(paths, &text);
    let on_water = 4.0 * 0.6 / emitted_area(&lit);
    let refracted = landed(&lit, 0.0, 1..2).len() as f64;
    assert_frequency("refracted", refracted, f64::from(paths), on_water * (1.0 - fresnel_by_hand(sin, n)));
}

/// Where a ray that enters a ball of index n at the height b (radius 1) crosses the plane at the distance `behind` its
/// middle, and the share of its light that gets there after two refractions.
fn through_ball(b: f64, n: f64, behind: f64) -> (f64, f64) {
    let (outside, inside) = (b.asin(), (b / n).asin());
    // Every refraction turns the ray by outside - inside towards the axis; it leaves at this angle around the ball.
    let around = 2.0 * inside - outside;
    let slope = 2.0 * (outside - inside);
    let (x, y) = (around.cos(), around.sin());
    let transmitted = (1.0 - fresnel_by_hand(b, n)).powi(2);
    // `around` is measured from the axis on the ray's own side.
    (y - (behind - x) * slope.tan(), transmitted)
}

/// Photons behind a ball lens by their distance from the axis, against a ray trace in one dimension: a chi-square test
/// over 40 rings in front of, in and behind the focus at n/(2(n - 1)) = 1.5.
#[test]
fn a_ball_lens_spreads_photons_as_a_ray_trace_in_one_dimension_says() {
    let (n, paths, rings) = (1.5, 400_000, 40);
    for behind in [1.1_f64, 1.5, 2.5] {
        let text = FROM_ABOVE.to_string()
            + "[[shapes]]\ntype = 'sphere'\nmaterial = { type = 'glass', ior = 1.5 }\n"
            + &square(-behind as f32, 3.0, false, "{ type = 'diffuse', reflectance = 0 }");
        let lit = photons(paths, &text);
        let widest = 1.2 / f64::from(rings);
        let add = |counts: &mut Vec<f64>, rho: f64, count: f64| {
            if let Some(ring) = counts.get_mut((rho / widest) as usize) {
                *ring += count;
            }
        };
        let mut observed = vec![0.0; rings as usize];
        for photon in landed(&lit, -behind as f32, 2..3) {
            add(&mut observed, f64::from(photon.position.x.hypot(photon.position.z)), 1.0);
        }
        let mut expected = vec![0.0; rings as usize];
        let steps = 400_000;
        for step in 0..steps {
            let b = (f64::from(step) + 0.5) / f64::from(steps);
            let (at, transmitted) = through_ball(b, n, behind);
            let flux = transmitted * 2.0 * PI * b / f64::from(steps);
            add(&mut expected, at.abs(), flux / emitted_area(&lit) * f64::from(paths));
        }
        assert_distribution(&format!("{behind} behind"), &observed, &expected, f64::from(paths));
    }
}

/// A paraboloid y = r²/(4f) of triangles with its exact normals.
fn parabola(focus: f32, radius: f32, rings: u32, around: u32) -> MeshData {
    let mut data = MeshData::default();
    for ring in 0..=rings {
        for step in 0..around {
            let r = radius * ring as f32 / rings as f32;
            let (sin, cos) = (std::f32::consts::TAU * step as f32 / around as f32).sin_cos();
            data.positions.push([r * cos, r * r / (4.0 * focus), r * sin]);
            let normal = glam::Vec3::new(-r * cos / (2.0 * focus), 1.0, -r * sin / (2.0 * focus)).normalize();
            data.normals.push(normal.to_array());
            if ring < rings {
                let corner = |ring: u32, step: u32| ring * around + step % around;
                let [a, b, c, d] =
                    [corner(ring, step), corner(ring, step + 1), corner(ring + 1, step), corner(ring + 1, step + 1)];
                data.triangles.extend([[a, b, c], [b, d, c]]);
            }
        }
    }
    data
}

/// A shape of triangles.
fn mesh(data: MeshData, material: MaterialDescription) -> ShapeDescription {
    ShapeDescription {
        interior: None,
        priority: 0,
        geometry: GeometryDescription::Triangles(Arc::new(data)),
        material: Some(MaterialRef::Inline(Box::new(material))),
        emission: None,
        transform: Default::default(),
        flip_normal: false,
        name: None,
    }
}

/// Behind a thin lens of focal length f, parallel light converges: it is (1 - F)² (f / (f - z))² times as bright at the
/// distance z. The lens is a paraboloid of vertex radius R = 4 on a flat disk, so that f = R/(n - 1) = 8; what is thick
/// about it moves the answer by less than 0.3 %.
#[test]
fn a_thin_lens_concentrates_light_by_its_focal_length() {
    let (paths, n, focal, behind, spot) = (400_000, 1.5, 8.0_f64, 2.0, 0.15_f64);
    let mut description = described(
        "camera = { origin = [9, 9, 9], target = [0, 0, 0] }
         lights = [{ type = 'directional', direction = [0, -1, 0] }]
         [[shapes]]
         type = 'disk'
         center = [0, -2, 0]
         normal = [0, 1, 0]
         radius = 0.15
         material = { type = 'diffuse', reflectance = 0 }
         [[shapes]]
         type = 'disk'
         center = [0, -0.009, 0]
         normal = [0, -1, 0]
         radius = 0.25
         material = { type = 'glass', ior = 1.5 }",
    );
    // The paraboloid upside down: a dome, whose normals point out of the glass.
    let mut dome = parabola(2.0, 0.25, 64, 256);
    dome.positions.iter_mut().for_each(|[_, y, _]| *y = -*y);
    dome.normals.iter_mut().for_each(|[x, _, z]| (*x, *z) = (-*x, -*z));
    let one = Paint::grey(1.0);
    let glass = MaterialDescription::Glass {
        ior: 1.5.into(),
        exterior_ior: 1.0.into(),
        reflectance: one.clone(),
        transmittance: one,
        roughness: None,
    };
    description.shapes.push(mesh(dome, glass));
    let lit =
        built(description, &format!("integrator=photon-map photons={paths} bandwidth=fixed radius=1 direct=photons"));
    let gathered_from = spot * focal / (focal - behind);
    let transmitted = (1.0 - fresnel_by_hand(0.0, n)).powi(2);
    let expected = transmitted * PI * gathered_from * gathered_from / emitted_area(&lit);
    assert_frequency("behind the lens", landed(&lit, -2.0, 2..3).len() as f64, f64::from(paths), expected);
}

#[test]
fn a_parabolic_mirror_sends_all_its_light_to_the_focus() {
    let (paths, radius, around) = (100_000, 1.0, 256);
    let mut description = described(
        "camera = { origin = [9, 9, 9], target = [0, 0, 0] }
         lights = [{ type = 'directional', direction = [0, -1, 0] }]
         [[shapes]]
         type = 'disk'
         center = [0, 0.5, 0]
         normal = [0, -1, 0]
         radius = 0.02
         material = { type = 'diffuse', reflectance = 0 }",
    );
    let mirror = MaterialDescription::Mirror { reflectance: Paint::grey(1.0) };
    description.shapes.push(mesh(parabola(0.5, radius, 128, around), mirror));
    let lit =
        built(description, &format!("integrator=photon-map photons={paths} bandwidth=fixed radius=1 direct=photons"));
    let focused: f64 = (lit.map(0).photons().iter())
        .filter(|photon| photon.bounce == 1 && photon.history == Event::Specular.into())
        .map(|photon| f64::from(photon.flux.mean()) / f64::from(paths))
        .sum();
    let polygon = 0.5 * f64::from(around) * (2.0 * PI / f64::from(around)).sin();
    let expected = polygon - PI * 0.02 * 0.02;
    // Standard error of the count: 1/√(paths · share); 5.5 of them have odds of 4e-8.
    let share = expected / emitted_area(&lit);
    let error = 5.5 * ((1.0 - share) / (f64::from(paths) * share)).sqrt();
    assert!((focused / expected - 1.0).abs() < error, "{focused} instead of {expected} W, ± {error}");
}

/// The bright line in a ring on the table is a nephroid; its cusp lies half way between axis and wall.
#[test]
fn the_cusp_in_a_mirrored_cylinder_lies_at_half_its_radius() {
    let text = "lights = [{ type = 'directional', direction = [1, -1, 0] }]
        [[shapes]]
        type = 'cylinder'
        from = [0, 0, 0]
        to = [0, 1.5, 0]
        material = { type = 'mirror' }
        [[shapes]]
        type = 'disk'
        normal = [0, 1, 0]
        radius = 0.99
        material = { type = 'diffuse', reflectance = 0 }";
    let lit = photons(2_000_000, text);
    let mut along = [0_u32; 40];
    for photon in landed(&lit, 0.0, 1..2) {
        if photon.position.z.abs() < 0.002 && photon.position.x > 0.0 {
            along[(photon.position.x * 40.0) as usize] += 1;
        }
    }
    let brightest = (0..40).max_by_key(|&bin| along[bin]).expect("bins");
    // Off the axis the two branches part as the 2/3rd power of the distance, which moves the peak outwards by 0.006.
    assert_eq!(brightest, 20, "{along:?}");
    // Towards the axis from the cusp there is only half-light: the edge of a caustic is sharp.
    assert!(along[brightest] > 2 * along[brightest - 3] && along[brightest] > 200, "{along:?}");
}
