//! Light through rough boundaries is the same from either end.

mod common;

use common::statistics::assert_same_mean;
use common::{lit, square};

/// A floor under a pane of rough glass and beside a rough metal wall, looked at through the pane.
fn room(pane: &str) -> String {
    format!(
        "camera = {{ origin = [0, 2.5, -1.5], target = [0, 0, 0], fov = 25 }}
         film = {{ size = [8, 8] }}
         {}
         [[shapes]]
         type = 'quad'
         corner = [1, 0, -2]
         u = [0, 0, 4]
         v = [0, 2, 0]
         material = {{ type = 'conductor', metal = 'Cu', roughness = {{ alpha = 0.3, alpha-v = 0.5 }} }}
         [[shapes]]
         type = 'cube'
         transform = [{{ scale = [0.7, 0.2, 0.7] }}, {{ translate = [0, 0.8, 0] }}]
         material = {pane}
         [[shapes]]
         type = 'disk'
         center = [-0.5, 3, 0.3]
         normal = [0, -1, 0]
         radius = 0.7
         emission = {{ radiance = 5 }}",
        square(0.0, 2.0, false, "{ type = 'diffuse', reflectance = [0.8, 0.5, 0.3] }")
    )
}

/// Path tracing, light tracing and both kinds of photon maps: weights of radiance from one end, flux from the other.
#[test]
fn light_through_rough_glass_is_the_same_from_either_end() {
    for pane in [
        "{ type = 'glass', ior = 1.6, roughness = { alpha = 0.4 } }",
        "{ type = 'glass', roughness = { alpha = 0.7, distribution = 'beckmann', multiple-scattering = true } }",
        "{ type = 'principled', base-color = [0.9, 0.8, 0.7], spec-trans = 0.9, roughness = 0.7, eta = 1.3 }",
        "{ type = 'principled-thin', spec-trans = 0.5, roughness = 0.6, diff-trans = 1 }",
    ] {
        let means = |settings: &str| lit(&room(pane), settings).means(40);
        let path = means("integrator=path samples=64");
        for way in [
            "integrator=light photons=40000",
            "integrator=photon-map photons=20000 bandwidth=fixed radius=0.04 direct=next-event samples=16",
            "integrator=photon-map photons=20000 bandwidth=fixed radius=0.04 direct=photons samples=16",
            "integrator=auto photons=20000 radius=1 samples=16",
        ] {
            for (channel, (ours, other)) in path.iter().zip(means(way)).enumerate() {
                // Kernels lose a little at the edges of the pane and the foot of the wall.
                let bias = if !way.contains("light") { 0.02 } else { 0.003 };
                assert_same_mean(&format!("{pane}, {way}, {channel}"), ours, &other, 36, bias);
            }
        }
    }
}
