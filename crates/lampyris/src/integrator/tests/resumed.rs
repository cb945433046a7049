//! What comes with a film from elsewhere is looked at before it is believed.

use super::built;
use crate::integrator::{Silent, integrator, resumed};

/// With a ball of glass so small that photons are guided to it.
const BALL: &str = "film = { size = [16, 16] }
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

/// A floor below a ceiling with a slot, through which shadow rays are guided.
const SLOT: &str = "film = { size = [16, 16] }
        camera = { origin = [0, 0.2, 0.9], target = [0, 0, 0], fov = 60 }
        integrator = { type = 'path', max-bounces = 2 }
        lights = [{ type = 'constant', radiance = 1 }]
        [[shapes]]
        type = 'quad'
        corner = [-1, 0, -1]
        u = [0, 0, 2]
        v = [2, 0, 0]
        [[shapes]]
        type = 'quad'
        corner = [-9, 0.3, -9]
        u = [9, 0, 0]
        v = [0, 0, 18]
        [[shapes]]
        type = 'quad'
        corner = [0.2, 0.3, -9]
        u = [9, 0, 0]
        v = [0, 0, 18]";

/// What was measured, unless damage makes it something else. Returns how large it is, and how often damage was told.
#[track_caller]
fn assert_careful(text: &str, step: usize) -> (usize, usize) {
    let (description, scene) = built(text);
    let (film, settings) = (&description.film, &description.integrator);
    let pilot = integrator(&scene, film, settings, 1, &Silent).pilot();
    let back = |bytes: &[u8]| resumed(&scene, settings, bytes);
    assert_eq!(back(&pilot).expect("its own").pilot(), pilot);
    let changes = (0..pilot.len()).step_by(step).flat_map(|place| [0x01, 0x40, 0x80, 0xff].map(|bit| (place, bit)));
    let refused = changes.filter(|&(place, change)| {
        let mut damaged = pilot.clone();
        damaged[place] ^= change;
        // Most digits of most numbers may be others.
        back(&damaged).is_err()
    });
    let refused = refused.count();
    let shorter = (0..pilot.len()).step_by(13 * step);
    shorter.for_each(|length| assert!(back(&pilot[..length]).is_err(), "{length} bytes"));
    (pilot.len(), refused)
}

#[test]
fn a_pilot_comes_back_as_it_was_and_no_byte_of_it_can_do_harm() {
    let (bytes, refused) = assert_careful(BALL, 1);
    assert!(bytes > 2000, "it guides no photons: {bytes} bytes");
    assert!(refused > bytes / 10, "{refused} of {bytes}");
}

#[test]
fn what_is_seen_of_the_lights_comes_back_and_no_byte_of_it_can_do_harm() {
    let step = 997;
    let (bytes, refused) = assert_careful(SLOT, step);
    assert!(bytes > 5000, "it guides no shadow rays: {bytes} bytes");
    assert!(refused > bytes / step / 10, "{refused} of {}", bytes / step);
}
