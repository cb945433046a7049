//! Guided photons: they leave for elsewhere, and bring the same light.

mod common;

use common::statistics::{Sample, assert_same_mean};
use common::{Lit, lit};
use glam::Vec3;
use lampyris::integrator::{Silent, integrator};
use lampyris::light::{Focus, Guide, Lesson};
use lampyris::sampler::Sampler;
use lampyris::scene::Scene;
use std::sync::Arc;

/// What the camera sees: ball and floor, or the caustic alone.
const ALL: &str = "target = [0.3, 0.1, 0.2]\nfov = 24";
const CAUSTIC: &str = "target = [0.33, 0, 0.08]\nfov = 7";

/// A glass ball over a floor of this half width, with these lights, seen so.
fn hall(half: f32, lights: &str, view: &str) -> String {
    format!(
        "[camera]
         origin = [0.5, 1.6, 3]
         {view}
         [film]
         size = [12, 10]
         [materials]
         glass = {{ type = 'glass', ior = 1.2 }}
         floor = {{ type = 'diffuse', reflectance = [0.7, 0.5, 0.3] }}
         {lights}
         [[shapes]]
         type = 'quad'
         corner = [-{half}, 0, -{half}]
         u = [0, 0, {width}]
         v = [{width}, 0, 0]
         material = 'floor'
         [[shapes]]
         type = 'sphere'
         center = [0, 0.35, 0]
         radius = 0.25
         material = 'glass'\n",
        width = 2.0 * half
    )
}

/// A light of each kind whose photons can be aimed; all shine on the ball from the same side.
const LIGHTS: [(&str, &str); 8] = [
    ("point", "[[lights]]\ntype = 'point'\nposition = [-2, 2.5, -0.5]\npower = 90"),
    ("spot", "[[lights]]\ntype = 'spot'\nposition = [-2, 2.5, -0.5]\ntarget = [0.5, 0, 0]\ncutoff = 60\npower = 40"),
    ("directional", "[[lights]]\ntype = 'directional'\ndirection = [2, -2, 0.5]\nirradiance = 3"),
    ("sun", "[[lights]]\ntype = 'directional'\ndirection = [2, -2, 0.5]\nirradiance = 3\nangle = 4"),
    ("constant", "[[lights]]\ntype = 'constant'\nradiance = 1"),
    ("environment", "[[lights]]\ntype = 'environment'\nfile = 'picture'"),
    (
        "area",
        "[[shapes]]\ntype = 'quad'\ncorner = [-2, 2.5, -0.5]\nu = [0.3, 0, 0]\nv = [0, 0, 0.3]\nemission = { radiance = 90 }",
    ),
    (
        "two-sided area",
        "[[shapes]]\ntype = 'sphere'\ncenter = [-2, 2.5, -0.5]\nradius = 0.2\nemission = { radiance = 90, two-sided = true }",
    ),
];

/// Aims at the ball, at what is beside it and nowhere in particular, with more photons here than there in each.
fn guide(scene: &Scene) -> Guide {
    let foci = [
        Focus { center: Vec3::new(0.0, 0.35, 0.0), radius: 0.25 },
        Focus { center: Vec3::new(0.8, 0.0, 0.3), radius: 0.8 },
    ];
    let cells = |odd: usize| (0..Lesson::CELLS).map(|cell| (1 + cell * odd % 7) as f32).collect();
    let lesson = |light, focus, share, odd| Lesson { light, focus, share, cells: cells(odd) };
    let lessons: Vec<Lesson> = scene
        .aimed_lights()
        .flat_map(|(light, _)| {
            [lesson(light, Some(0), 2.0, 3), lesson(light, Some(1), 1.0, 5), lesson(light, None, 1.0, 11)]
        })
        .collect();
    Guide::new(&foci, 1.0, &lessons)
}

/// Cells a side of the floor in which light is counted.
const SIDE: usize = 6;

/// The flux of photons that would cross the plane of the floor in each cell of its middle, in two classes by direction:
/// for each of many batches.
fn flux(scene: &Scene, purpose: u32) -> Vec<Vec<f64>> {
    const BATCHES: u64 = 64;
    const BATCH: u64 = 4096;
    let mut flux = vec![vec![0.0; BATCHES as usize]; 2 * SIDE * SIDE];
    for index in 0..BATCHES * BATCH {
        let Some((_, emission)) = scene.emit(&mut Sampler::new(3, 0, purpose, index)) else { continue };
        let ray = emission.ray;
        let at = ray.origin - ray.direction * (ray.origin.y / ray.direction.y);
        let [x, z] = [at.x, at.z].map(|at| ((at / 2.4 + 0.5) * SIDE as f32).floor());
        let inside = [x, z].iter().all(|&cell| (0.0..SIDE as f32).contains(&cell));
        if ray.direction.y < 0.0 && inside {
            let class = usize::from(ray.direction.z > 0.3 * ray.direction.x);
            let cell = (z as usize * SIDE + x as usize) * 2 + class;
            flux[cell][(index / BATCH) as usize] += f64::from(emission.flux.mean()) / BATCH as f64;
        }
    }
    flux
}

#[test]
fn guided_photons_carry_the_flux_of_the_others_wherever_they_go() {
    for (name, light) in LIGHTS {
        let even = lit(&hall(2.0, light, ALL), "").scene;
        let guided = even.guided(Arc::new(guide(&even)));
        let (a, b) = (flux(&even, 1), flux(&guided, 2));
        let seen: Vec<usize> = (0..a.len()).filter(|&cell| Sample::of(&a[cell]).mean > 0.0).collect();
        assert!(seen.len() > SIDE * SIDE / 2, "{name}: {}", seen.len());
        for &cell in &seen {
            assert_same_mean(&format!("{name}, cell {cell}"), &a[cell], &b[cell], LIGHTS.len() * seen.len(), 0.0);
        }
        // They do leave for elsewhere: the errors are others.
        let error = |flux: &[Vec<f64>], cell: usize| Sample::of(&flux[cell]).error2();
        assert!(seen.iter().any(|&cell| error(&a, cell) > 1.5 * error(&b, cell)), "{name}: not guided");
    }
}

/// Whether the pilot has learned where photons should leave for, and found it worth while.
fn is_guided(lit: &Lit) -> bool {
    let Lit { description, scene } = lit;
    let pilot = integrator(scene, &description.film, &description.integrator, 0, &Silent).pilot();
    pilot.len() > 4 * Lesson::CELLS
}

#[test]
fn guiding_changes_variance_and_never_the_mean() {
    for (name, light) in LIGHTS {
        let text = hall(2.0, light, ALL);
        let [guided, even] = [true, false].map(|guiding| {
            lit(&text, &format!("integrator=auto photons=8000 guiding={guiding} radius=3 filter=box max-bounces=8"))
        });
        assert!(!is_guided(&even), "{name}");
        // Light from everywhere makes no caustics that photons would be needed for.
        assert!(is_guided(&guided) || ["constant", "environment"].contains(&name), "{name}");
        let (guided, even) = (guided.means(48), even.means(48));
        for (guided, even) in guided.iter().zip(&even) {
            assert_same_mean(name, guided, even, 3 * LIGHTS.len(), 0.0);
        }
    }
}

/// A caustic of a quarter of a metre in a hall of three hundred.
#[test]
fn a_caustic_in_a_stadium_is_that_of_a_small_room() {
    for (name, light) in LIGHTS.into_iter().filter(|(name, _)| !["constant", "environment"].contains(name)) {
        let [room, stadium] = [2.0, 150.0].map(|half| {
            // Refracted twice, and then on the floor; more would see how large it is.
            lit(
                &hall(half, light, CAUSTIC),
                "integrator=auto photons=8000 samples=16 radius=1 filter=box max-bounces=3",
            )
        });
        assert!(is_guided(&stadium), "{name}");
        let (room, stadium) = (room.means(48), stadium.means(48));
        for (room, stadium) in room.iter().zip(&stadium) {
            assert_same_mean(name, room, stadium, 3 * LIGHTS.len(), 0.0);
            let sample = Sample::of(stadium);
            assert!(sample.error2().sqrt() < 0.02 * sample.mean, "{name}: too weak, {sample:?}");
        }
    }
}
