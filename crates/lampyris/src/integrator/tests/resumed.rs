//! What comes with a film from elsewhere is looked at before it is believed.

use crate::import::toml::read_str;
use crate::integrator::{Silent, integrator, resumed};
use crate::scene::description::SceneDescription;
use crate::scene::{NoAssets, Scene, build};

/// With a ball of glass so small that photons are guided to it.
fn scene() -> (SceneDescription, Scene) {
    let text = "film = { size = [16, 16] }
        camera = { origin = [0, 0.2, -0.5], target = [0, 0, 0], fov = 40 }
        integrator = { type = 'auto', photons = 20000 }
        lights = [{ type = 'point', position = [0, 3, 0], intensity = 1 }]
        [[shapes]]
        type = 'disk'
        center = [0, 0, 0]
        radius = 5
        material = { type = 'diffuse' }
        [[shapes]]
        type = 'sphere'
        center = [0, 0.07, 0]
        radius = 0.05
        material = { type = 'glass' }";
    let description = read_str("a.toml".as_ref(), text).expect("a scene").description;
    let scene = build(&description, &NoAssets).expect("a scene").scene;
    (description, scene)
}

#[test]
fn a_pilot_comes_back_as_it_was_and_no_byte_of_it_can_do_harm() {
    let (description, scene) = scene();
    let (film, settings) = (&description.film, &description.integrator);
    let pilot = integrator(&scene, film, settings, 1, &Silent).pilot();
    assert!(pilot.len() > 2000, "it guides no photons: {} bytes", pilot.len());
    let back = |bytes: &[u8]| resumed(&scene, settings, bytes);
    assert_eq!(back(&pilot).expect("its own").pilot(), pilot);
    let mut refused = 0;
    for (place, change) in (0..pilot.len()).flat_map(|place| [0x01, 0x40, 0x80, 0xff].map(|change| (place, change))) {
        let mut damaged = pilot.clone();
        damaged[place] ^= change;
        // Most digits of most numbers may be others.
        refused += usize::from(back(&damaged).is_err());
    }
    assert!(refused > pilot.len() / 10, "{refused} of {}", pilot.len());
    let shorter = (0..pilot.len()).step_by(13);
    shorter.for_each(|length| assert!(back(&pilot[..length]).is_err(), "{length} bytes"));
}
