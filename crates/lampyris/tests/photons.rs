//! Where photons lie and what they know of their way.

mod common;

use std::sync::Mutex;

use common::statistics::assert_mean;
use common::{Lit, lit, slab, square};
use glam::Vec3;
use lampyris::integrator::{Observer, Pass, PhotonMapping, Silent, Work};
use lampyris::material::{Event, Lobes, Scattered};
use lampyris::sampler::{Sampler, purpose};
use lampyris::scene::SurfacePoint;
use lampyris::scene::description::IntegratorDescription;
use lampyris::transport::{Limits, Origin, PathState, Visitor, walk};

/// A box of all that scatters, lit by a small lamp.
const ROOM: &str = "
    camera = { origin = [0, 0, -0.9], target = [0, 0, 0] }
    film = { size = [8, 8] }
    lights = [{ type = 'point', position = [0, 0.8, 0], intensity = 1 }]
    [[shapes]]
    type = 'cube'
    flip-normal = true
    material = { type = 'diffuse', reflectance = [0.7, 0.5, 0.6] }
    [[shapes]]
    name = 'glass'
    type = 'sphere'
    center = [-0.4, -0.6, 0]
    radius = 0.3
    material = { type = 'glass' }
    [[shapes]]
    name = 'mirror'
    type = 'sphere'
    center = [0.4, -0.6, 0.3]
    radius = 0.3
    material = { type = 'mirror' }
    [[shapes]]
    name = 'pane'
    type = 'quad'
    corner = [-0.5, 0, 0.5]
    u = [1, 0, 0]
    v = [0, 0.5, 0.1]
    material = { type = 'thin-glass' }
    [[shapes]]
    name = 'metal'
    type = 'sphere'
    center = [0.7, 0.2, 0]
    radius = 0.15
    material = { type = 'conductor', eta = 0.2, k = 3 }
    [[shapes]]
    name = 'clear'
    type = 'sphere'
    center = [-0.7, 0.2, 0]
    radius = 0.15
    material = { type = 'coefficients', ks = 0.4, kt = 0.6 }
    [[shapes]]
    name = 'plastic'
    type = 'sphere'
    center = [0, -0.7, -0.5]
    radius = 0.2
    material = { type = 'plastic', reflectance = 0.6 }
    [[shapes]]
    name = 'shiny'
    type = 'sphere'
    center = [0, 0, 0]
    radius = 0.1
    material = { type = 'coefficients', kd = 0.5, ks = 0.3, kt = 0.2 }
    [[shapes]]
    name = 'holes'
    type = 'sphere'
    center = [0, 0.4, 0.4]
    radius = 0.2
    material = { type = 'mask', opacity = 0.5, material = { type = 'diffuse' } }";

fn room(direct: &str) -> Lit {
    lit(ROOM, &format!("integrator=photon-map photons=50000 bandwidth=fixed radius=0.1 direct={direct} max_bounces=12"))
}

/// How many photons lie on a ball.
fn on_ball(lit: &Lit, center: [f32; 3], radius: f32) -> usize {
    let near = |position: Vec3| (position.distance(center.into()) - radius).abs() < 1e-3 * radius;
    lit.map(0).photons().iter().filter(|photon| near(photon.position)).count()
}

#[test]
fn photons_lie_where_light_is_scattered_and_nowhere_else() {
    for direct in ["photons", "next-event"] {
        let room = room(direct);
        for (name, center, radius) in [
            ("glass", [-0.4, -0.6, 0.0], 0.3),
            ("mirror", [0.4, -0.6, 0.3], 0.3),
            ("metal", [0.7, 0.2, 0.0], 0.15),
            ("clear", [-0.7, 0.2, 0.0], 0.15),
        ] {
            assert_eq!(on_ball(&room, center, radius), 0, "{name}, {direct}");
        }
        for (name, center, radius) in
            [("plastic", [0.0, -0.7, -0.5], 0.2), ("shiny", [0.0; 3], 0.1), ("holes", [0.0, 0.4, 0.4], 0.2)]
        {
            assert!(on_ball(&room, center, radius) > 100, "{name}, {direct}");
        }
        let pane = (room.map(0).photons().iter())
            .filter(|photon| {
                (photon.normal - Vec3::new(0.0, 0.1, -0.5).normalize()).length() < 1e-3
                    || (photon.normal + Vec3::new(0.0, 0.1, -0.5).normalize()).length() < 1e-3
            })
            .count();
        assert_eq!(pane, 0, "thin pane, {direct}");
    }
}

/// Follows the same walks and keeps the list of events of each, which a photon knows only the sum of.
#[derive(Default)]
struct Diary {
    events: Vec<Event>,
    length: f64,
    /// Position, events before, geometric length of the way.
    landings: Vec<(Vec3, Vec<Event>, f64)>,
}

impl Visitor for Diary {
    fn vertex(&mut self, point: &SurfacePoint, path: &PathState, _: &mut Sampler) -> Lobes {
        self.length += f64::from(point.distance);
        if path.bounce >= 12 {
            return Lobes::NONE;
        }
        if point.bsdf.lobes().meets(Lobes::SMOOTH) {
            self.landings.push((point.surface.position, self.events.clone(), self.length));
        }
        Lobes::ALL
    }

    fn scattered(&mut self, scattered: &Scattered, _: &SurfacePoint, _: &PathState) {
        self.events.push(scattered.event);
    }
}

/// All landings of a pass, in the order of the map's photons before they are sorted.
fn landings(lit: &Lit, paths: u64) -> Vec<(Vec3, Vec<Event>, f64)> {
    let limits = Limits { max_bounces: 12, roulette_from: 0 };
    let mut all = Vec::new();
    for index in 0..paths {
        let mut sampler = Sampler::new(0, 0, purpose::LIGHT, index);
        let (_, emission) = lit.scene.emit(&mut sampler).expect("a photon");
        let mut diary = Diary::default();
        walk(&lit.scene, PathState::new(emission.ray, emission.flux), Origin::Light, &limits, &mut sampler, &mut diary);
        all.extend(diary.landings);
    }
    all
}

#[test]
fn a_photon_is_a_caustic_one_exactly_if_it_met_something_and_nothing_but_mirrors_and_glass() {
    let room = room("photons");
    let key = |position: Vec3| position.to_array().map(f32::to_bits);
    let mut expected: Vec<_> = landings(&room, 50_000)
        .iter()
        .map(|(position, events, _)| {
            let caustic = !events.is_empty() && events.iter().all(|event| Lobes::DELTA.contains(*event));
            (key(*position), events.len() as u16, caustic)
        })
        .collect();
    let mut found: Vec<_> = (room.map(0).photons().iter())
        .map(|photon| (key(photon.position), photon.bounce, photon.is_caustic()))
        .collect();
    expected.sort_unstable();
    found.sort_unstable();
    assert_eq!(expected.len(), found.len());
    assert!(expected == found, "the same photons");
    let caustic = found.iter().filter(|photon| photon.2).count();
    assert!(caustic > 1000 && caustic < found.len() / 2, "{caustic} of {}", found.len());
}

/// With direct light by shadow rays, the photons that come straight from the lamp are left out, and no others.
#[test]
fn photons_straight_from_the_lamp_are_stored_only_if_they_give_the_direct_light() {
    let (all, indirect) = (room("photons").map(0), room("next-event").map(0));
    let later = all.photons().iter().filter(|photon| photon.bounce > 0).count();
    assert!(all.photons().len() > later + 10_000);
    assert_eq!(indirect.photons().len(), later);
    assert!(indirect.photons().iter().all(|photon| photon.bounce > 0));
}

/// In a closed room of albedo 0.6, full of things that absorb nothing, the walls must absorb what the lamp emits: 0.4 of
/// all that lands on them. What the limit on bounces cuts off is told, and belongs to it.
#[test]
fn the_ledger_of_energy_closes() {
    struct Ledger(Mutex<Work>);
    impl Observer for Ledger {
        fn work(&self, work: &Work) {
            let mut sum = self.0.lock().expect("no panic");
            sum.flux_emitted += work.flux_emitted;
            sum.flux_cut += work.flux_cut;
        }
    }
    let room = "camera = { origin = [0, 0, -0.9], target = [0, 0, 0] }
        film = { size = [1, 1] }
        lights = [{ type = 'point', position = [0, 0.8, 0], power = 3 }]
        [[shapes]]
        type = 'cube'
        flip-normal = true
        material = { type = 'diffuse', reflectance = 0.6 }
        [[shapes]]
        type = 'sphere'
        center = [-0.4, -0.5, 0]
        radius = 0.3
        material = { type = 'glass', ior = 1.8 }
        [[shapes]]
        type = 'sphere'
        center = [0.4, 0.3, 0.3]
        radius = 0.4
        material = { type = 'mirror' }";
    for max_bounces in [4, 64] {
        let lit = lit(
            room,
            &format!(
                "integrator=photon-map photons=4000 bandwidth=fixed radius=1 direct=photons max_bounces={max_bounces}"
            ),
        );
        let IntegratorDescription::PhotonMap(settings) = &lit.description.integrator else {
            panic!("not a photon map")
        };
        let mapping = PhotonMapping::new(&lit.scene, &lit.description.film, settings.clone(), 0, &Silent);
        let mut lost = Vec::new();
        for index in 0..60 {
            let ledger = Ledger(Mutex::default());
            let map = mapping.map(&lit.scene, &Pass { index, seed: 0 }, &ledger);
            let landed: f64 = map.photons().iter().map(|photon| f64::from(photon.flux.mean())).sum::<f64>() / 4000.0;
            let Work { flux_emitted, flux_cut, .. } = ledger.0.into_inner().expect("no panic");
            assert!((flux_emitted - 3.0).abs() < 1e-5);
            assert!((flux_cut > 0.0) == (max_bounces == 4));
            lost.push(0.4 * landed + flux_cut);
        }
        assert_mean(&format!("{max_bounces} bounces"), &lost, 3.0, 0.0, 0.02);
    }
}

/// Every photon of a white path carries the same flux, that of its lamp: roulette, not weight, does the absorbing.
#[test]
fn photons_of_grey_things_all_carry_the_same_flux() {
    let text = ROOM.replace("[0.7, 0.5, 0.6]", "0.6");
    let settings = "integrator=photon-map photons=20000 bandwidth=fixed radius=0.1 direct=photons";
    let power = 4.0 * std::f32::consts::PI;
    for photon in lit(&text, settings).map(0).photons() {
        // Plastic is chosen by an estimate of its albedo, and so has weights near 1 only.
        if !photon.history.contains(Event::Diffuse) {
            assert!((photon.flux.mean() / power - 1.0).abs() < 1e-4, "{photon:?}");
        }
    }
}

#[test]
fn light_arrives_after_the_shortest_way_and_no_sooner() {
    let lamp = Vec3::new(0.0, 0.8, 0.0);
    let room = room("photons");
    let mut longer = 0;
    for photon in room.map(0).photons() {
        let straight = photon.position.distance(lamp);
        assert!(photon.optical_length > straight * (1.0 - 1e-5), "{photon:?}");
        if photon.bounce == 0 {
            assert!(photon.optical_length < straight * (1.0 + 1e-5), "{photon:?}");
        } else {
            longer += u32::from(photon.optical_length > straight * 1.001);
        }
    }
    assert!(longer > 10_000);
}

/// Straight through a slab of thickness d light is late by (n - 1) d; after k inner reflections by 2nd more for each
/// two of them.
#[test]
fn a_slab_delays_light_by_its_thickness_times_index_less_one() {
    let text = "camera = { origin = [9, 9, 9], target = [0, 0, 0] }
        film = { size = [1, 1] }
        lights = [{ type = 'directional', direction = [0, -1, 0] }]\n"
        .to_string()
        + &slab(1.0, 0.75, 1.0, "{ type = 'glass', ior = 1.6 }")
        + &square(0.0, 2.0, false, "{ type = 'diffuse', reflectance = 0 }");
    let map = lit(&text, "integrator=photon-map photons=20000 bandwidth=fixed radius=1 direct=photons").map(0);
    let beside =
        (map.photons().iter()).find(|photon| photon.bounce == 0).expect("a photon past the slab").optical_length;
    let mut seen = [0, 0];
    for photon in map.photons().iter().filter(|photon| photon.bounce == 2 || photon.bounce == 4) {
        let inner = (photon.bounce - 2) / 2;
        let late = 0.6 * 0.25 + 2.0 * 1.6 * 0.25 * inner as f32;
        // Rays start off their surface by a millionth of its coordinates, four in the index.
        assert!((photon.optical_length - beside - late).abs() < 2e-5, "{photon:?} later than {beside} by {late}");
        seen[inner as usize] += 1;
    }
    assert!(seen[0] > 1000 && seen[1] > 5, "{seen:?}");
}

/// The settings that [`room`] leaves alone do not move a photon: the map of a pass depends on scene, seed and pass.
#[test]
fn passes_and_seeds_have_photons_of_their_own() {
    let room = room("photons");
    let IntegratorDescription::PhotonMap(settings) = &room.description.integrator else { panic!("not a photon map") };
    let mapping = PhotonMapping::new(&room.scene, &room.description.film, settings.clone(), 0, &Silent);
    let first = |index, seed| mapping.map(&room.scene, &Pass { index, seed }, &Silent).photons()[0];
    assert_eq!(first(0, 0), first(0, 0));
    assert_ne!(first(0, 0), first(1, 0));
    assert_ne!(first(0, 0), first(0, 1));
}
