//! The weights of all ways to make a path sum to one, and are the squares of their densities over the sum of these
//! (theory §5.4).
//!
//! Along given paths from eye to lamp, what the visitors of `auto` make of the light is compared with products of densities
//! per area as the theory has them, all in double precision, which know nothing of the sums that the walks carry.
//!
//! Where an event has one direction, its probability is left out, since both walks choose it alike. What remains of its
//! density is by how much a cone of directions becomes wider there: 1 on the way from the eye, by convention, and
//! n² cos / n'² cos' on the way back, by which the law of refraction keeps n² cos dω.

mod alone;
mod chain;
mod neighbours;
mod paths;
mod resumed;

use std::sync::Arc;

use glam::Vec3;

use crate::import::toml::read_str;
use crate::light::{Focus, Guide, Lesson, Node, Sightings};
use crate::sampler::{Sampler, purpose};
use crate::scene::description::SceneDescription;
use crate::scene::{NoAssets, Scene, build};
use crate::spectrum::Spectrum;
use crate::transport::{Origin, PathState, walk};
use chain::{Chain, Way};
use paths::{LIMITS, Recorder, lit_by_glass, lit_directly};

/// How often each thing was seen, so that no test passes for want of it.
#[derive(Debug, Default)]
struct Seen {
    hits: u32,
    shadow_rays: u32,
    merges: u32,
    glimpses: u32,
    /// Shadow rays at lamps that are near.
    near: u32,
    /// Paths with mirrors or boundaries at their end, and elsewhere.
    glass: [u32; 2],
    /// Ways that made between 2 and 98 % of their path.
    shared: u32,
}

fn built(text: &str) -> (SceneDescription, Scene) {
    let description = read_str("a.toml".as_ref(), text).unwrap_or_else(|error| panic!("{error}\n{text}")).description;
    let scene = build(&description, &NoAssets).expect("a scene").scene;
    (description, scene)
}

/// Compares the weights of all ways of the paths that so many walks give.
#[track_caller]
fn assert_weights(text: &str, walks: u64) -> Seen {
    let camera = "camera = { origin = [0.1, 0.3, -0.9], target = [0, -0.4, 0.2], fov = 70 }
        film = { size = [16, 16] }\n";
    let (_, even) = built(&(camera.to_string() + text));
    let guide = Arc::new(guide(&even));
    let outlook = Arc::new(even.outlook(&sightings(&even)).expect("an outlook"));
    let scenes = [(even.guided(guide.clone()).with_outlook(outlook), Some(guide)), (even, None)];
    let mut seen = Seen::default();
    for (scene, guide) in scenes {
        compare_all(&scene, &guide, walks, &mut seen);
    }
    seen
}

/// Aims at the balls, and elsewhere, with more photons here than there.
fn guide(scene: &Scene) -> Guide {
    let foci = [(-0.4, 0.4), (0.5, 0.35)].map(|(x, radius)| Focus { center: Vec3::new(x, -0.6, 0.25), radius });
    let cells = |odd: usize| (0..Lesson::CELLS).map(|cell| (1 + cell * odd % 7) as f32).collect();
    let lesson = |light, focus, share, odd| Lesson { light, focus, share, cells: cells(odd) };
    let lessons = scene.aimed_lights().flat_map(|(light, _)| {
        [lesson(light, Some(0), 2.0, 3), lesson(light, Some(1), 1.0, 5), lesson(light, None, 1.0, 11)]
    });
    Guide::new(&foci, 1.0, &lessons.collect::<Vec<Lesson>>())
}

/// Shoots at some lights, and parts of them, more than at others, and otherwise to the left than to the right.
fn sightings(scene: &Scene) -> Sightings {
    let parts = scene.parts_of_lights().len();
    let vista = |vista: usize| (0..parts).map(|part| ((vista + 3 * part) % 7) as f32 / 6.0).collect();
    let split = |side: u32| {
        let root = Node::Split { axis: 0, at: 0.05, children: [1, 2] };
        vec![root, Node::Vista(2 * side), Node::Vista(2 * side + 1)]
    };
    Sightings {
        trees: std::array::from_fn(|side| split(side as u32)),
        vistas: (0..2 * crate::light::SIDES).map(vista).collect(),
    }
}

#[track_caller]
fn compare_all(scene: &Scene, guide: &Option<Arc<Guide>>, walks: u64, seen: &mut Seen) {
    for index in 0..walks {
        let mut sampler = Sampler::new(1, 0, purpose::CAMERA, index);
        let (ray, _) = scene.view(16.0 * sampler.square(), &mut sampler);
        let mut recorder = Recorder::default();
        walk(scene, PathState::new(ray, Spectrum::ONE), Origin::Camera, &LIMITS, &mut sampler, &mut recorder);
        let mut chains = lit_directly(scene, ray.origin, &recorder.0, &sampler);
        chains.extend(lit_by_glass(scene, ray.origin, &recorder.0, &mut sampler));
        let chains = chains.into_iter().map(|chain| Chain { guide: guide.clone(), ..chain });
        for chain in chains.filter(|chain| chain.carries(scene) && chain.leaves_evenly(scene)) {
            compare(scene, &chain, seen);
        }
    }
}

#[track_caller]
fn compare(scene: &Scene, chain: &Chain, seen: &mut Seen) {
    let Some(ways) = chain.ways(scene) else { return };
    let total: f64 = ways.iter().map(|(_, density)| density * density).sum();
    let mut sum = 0.0;
    for &(way, density) in &ways {
        // None for a shadow ray that does not get there.
        let Some(weight) = chain.weight(scene, way) else { return };
        // What is compared is densities, whose squares the weights are.
        let expected = density / total.sqrt();
        assert!(
            (weight.sqrt() - expected).abs() < 2e-3 * expected + 1e-6,
            "{way:?} has the weight {weight} instead of {}: {ways:?}, {:?}",
            expected * expected,
            chain.between
        );
        sum += weight;
        seen.shared += u32::from((0.02..0.98).contains(&weight));
    }
    assert!((sum - 1.0).abs() < 1e-3, "the weights sum to {sum}: {ways:?}, {:?}", chain.between);
    let last = chain.last();
    for (way, _) in ways {
        match way {
            Way::Hit => seen.hits += 1,
            Way::Shadow => {
                seen.shadow_rays += 1;
                seen.near += u32::from(chain.is_near(scene));
            }
            Way::Merge(_) => seen.merges += 1,
            Way::Glimpse => seen.glimpses += 1,
        }
    }
    seen.glass[0] += u32::from(!chain.is_smooth(last - 1));
    seen.glass[1] += u32::from((1..last - 1).any(|at| !chain.is_smooth(at)));
}

const WALLS: &str = "
    [[shapes]]
    type = 'cube'
    flip-normal = true
    material = { type = 'diffuse', reflectance = [0.7, 0.5, 0.3] }\n";

const FLOOR: &str = "
    [[shapes]]
    type = 'quad'
    corner = [-1, -1, -1]
    u = [0, 0, 2]
    v = [2, 0, 0]
    material = { type = 'rough-diffuse', reflectance = 0.8, alpha = 0.4 }\n";

/// One that shines down, and a weaker one that shines to both sides.
const LAMPS: &str = "
    [[shapes]]
    type = 'quad'
    corner = [-0.4, 0.9, -0.4]
    u = [0.8, 0, 0]
    v = [0, 0, 0.8]
    material = { type = 'diffuse', reflectance = 0.3 }
    emission = { radiance = [3, 4, 5] }
    [[shapes]]
    type = 'quad'
    corner = [-0.9, -0.5, -0.5]
    u = [0, 0.8, 0.1]
    v = [0, 0, 0.8]
    emission = { radiance = 2, two-sided = true }\n";

fn ball(center: &str, radius: f32, material: &str) -> String {
    format!("[[shapes]]\ntype = 'sphere'\ncenter = [{center}]\nradius = {radius}\nmaterial = {material}\n")
}

fn light(settings: &str) -> String {
    format!("lights = [{{ {settings} }}]\n")
}

const GLASS: &str = "{ type = 'glass', ior = 1.5 }";
const PLASTIC: &str = "{ type = 'plastic', reflectance = 0.7 }";
const ROUGH_PLASTIC: &str = "{ type = 'plastic', reflectance = 0.6, roughness = { alpha = 0.3 } }";
const ROUGH_GLASS: &str = "{ type = 'glass', ior = 1.4, roughness = { alpha = 0.5 } }";

/// Balls on the floor.
fn balls(left: &str, right: &str) -> String {
    ball("-0.4, -0.6, 0.3", 0.4, left) + &ball("0.5, -0.65, 0.2", 0.35, right)
}

#[test]
fn weights_sum_to_one_between_smooth_walls_under_lamps() {
    let seen = assert_weights(&(WALLS.to_string() + LAMPS + &balls(ROUGH_PLASTIC, ROUGH_GLASS)), 600);
    assert!(seen.hits > 500 && seen.shadow_rays > 500 && seen.merges > 1000 && seen.shared > 1000, "{seen:?}");
    assert!(seen.glimpses > 50, "{seen:?}");
}

/// The second lamp stands upright beside a wall here, so that both are rectangles.
#[test]
fn weights_sum_to_one_near_rectangles() {
    let lamps = LAMPS.replace("u = [0, 0.8, 0.1]", "u = [0, 0.8, 0]");
    let seen = assert_weights(&(WALLS.to_string() + &lamps + &balls(ROUGH_PLASTIC, PLASTIC)), 600);
    assert!(seen.near > 100 && seen.hits > 500 && seen.merges > 1000 && seen.shared > 1000, "{seen:?}");
}

#[test]
fn weights_sum_to_one_where_mirrors_and_glass_lie_between() {
    let pane = "[[shapes]]\ntype = 'quad'\ncorner = [-1, 0.5, -1]\nu = [0, 0, 2]\nv = [2, 0, 0]
        material = { type = 'thin-glass', ior = 1.5 }\n";
    for things in
        [balls(GLASS, PLASTIC), balls(GLASS, "{ type = 'mirror' }") + pane, balls(PLASTIC, ROUGH_GLASS) + pane]
    {
        let seen = assert_weights(&(WALLS.to_string() + LAMPS + &things), 600);
        assert!(seen.hits > 500 && seen.shadow_rays > 100 && seen.merges > 500 && seen.shared > 500, "{seen:?}");
        assert!(seen.glass.iter().all(|&paths| paths > 50), "{seen:?}");
    }
}

#[test]
fn weights_sum_to_one_around_a_lamp_in_glass() {
    let lamp = ball("0.1, -0.3, 0.3", 0.15, "{ type = 'diffuse', reflectance = 0.2 }").replace("[[shapes]]", "");
    let lamp = format!("[[shapes]]\nemission = {{ radiance = 5 }}{lamp}");
    let seen = assert_weights(&(WALLS.to_string() + &ball("0.1, -0.3, 0.3", 0.4, GLASS) + &lamp), 600);
    assert!(seen.hits > 500 && seen.merges > 500 && seen.shared > 500 && seen.glass[0] > 200, "{seen:?}");
    let point = light("type = 'point', position = [0.2, -0.3, 0.2], intensity = 1");
    let seen = assert_weights(&(point + WALLS + &ball("0.1, -0.3, 0.3", 0.4, GLASS)), 600);
    assert!(seen.hits == 0 && seen.merges > 200 && seen.shared > 50 && seen.glass[0] > 200, "{seen:?}");
}

#[test]
fn weights_sum_to_one_in_light_of_a_point() {
    let point = light("type = 'point', position = [-0.4, 0.7, 0.3], intensity = [1, 1.5, 2]");
    let seen = assert_weights(&(point + WALLS + &balls(GLASS, ROUGH_PLASTIC)), 600);
    assert!(seen.hits == 0 && seen.shadow_rays > 300 && seen.merges > 500 && seen.shared > 500, "{seen:?}");
}

#[test]
fn weights_sum_to_one_under_the_sky() {
    let sky = light("type = 'constant', radiance = [1, 2, 3]");
    for things in [balls(GLASS, ROUGH_PLASTIC), balls(PLASTIC, ROUGH_GLASS)] {
        let seen = assert_weights(&(sky.clone() + FLOOR + &things), 2000);
        assert!(seen.hits > 300 && seen.shadow_rays > 300 && seen.merges > 200 && seen.shared > 200, "{seen:?}");
    }
    let seen = assert_weights(&(sky + FLOOR + &balls(ROUGH_PLASTIC, ROUGH_PLASTIC)), 2000);
    assert!(seen.glimpses > 100, "{seen:?}");
}

#[test]
fn weights_sum_to_one_in_parallel_light() {
    let sun = light("type = 'directional', direction = [0.5, -1, 0.3], irradiance = [3, 2, 1]");
    let seen = assert_weights(&(sun + FLOOR + &balls(GLASS, ROUGH_PLASTIC)), 2000);
    assert!(seen.hits == 0 && seen.shadow_rays > 200 && seen.merges > 100 && seen.shared > 100, "{seen:?}");
}
