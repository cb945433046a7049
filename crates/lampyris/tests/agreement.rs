//! Path tracing, light tracing and photon mapping share little but the walk: where all can, they must give one picture.
//!
//! Two-sample t-tests on the means over the whole picture, for each channel, and over 16 blocks of it (Šidák). The
//! photon map has a bias of its own, that of its kernel: the cameras see no edge within a radius but those of shadows,
//! and the radius is 0.04 or less in rooms of size 2, which blurs by about 0.1 %; half a percent is allowed for it.

mod common;

use std::sync::Arc;

use common::lit;
use common::statistics::assert_same_mean;
use glam::{Mat4, Vec3};
use lampyris::geometry::MeshData;
use lampyris::image::Image;
use lampyris::scene::description::{
    GeometryDescription, MaterialDescription, MaterialRef, Paint, ShapeDescription, Transform,
};

const KERNEL_BIAS: f64 = 0.005;

/// A scene of size 2 whose camera sees part of the floor at y = -1 and what floats above it.
fn room(lights: &str, shapes: &[&str]) -> String {
    format!(
        "film = {{ size = [16, 16] }}
         camera = {{ origin = [0.1, 0.6, -0.9], target = [0, -1, 0.1], fov = 40 }}
         lights = [{lights}]
         {}",
        shapes.concat()
    )
}

const WALLS: &str = "
    [[shapes]]
    type = 'cube'
    flip-normal = true
    material = { type = 'diffuse', reflectance = [0.7, 0.5, 0.3] }\n";

const BALL: &str = "
    [[shapes]]
    type = 'sphere'
    center = [0.15, -0.5, 0.1]
    radius = 0.2\n";

const FLOOR: &str = "
    [[shapes]]
    type = 'quad'
    corner = [-1, -1, -1]
    u = [0, 0, 2]
    v = [2, 0, 0]\n";

const WHITE: &str = "material = { type = 'diffuse', reflectance = 0.8 }\n";

const POINT: &str = "{ type = 'point', position = [-0.4, 0.7, 0.3], intensity = [1, 1.5, 2] }";

/// Means of each pass over the picture and its 4 × 4 blocks, green.
fn blocks(images: &[Image]) -> Vec<Vec<f64>> {
    let block = |number: usize| {
        let (left, top) = (number % 4 * 4, number / 4 * 4);
        let mean = |image: &Image| {
            let pixels = (0..16).map(|i| f64::from(image.pixel(left + i % 4, top + i / 4)[1]));
            pixels.sum::<f64>() / 16.0
        };
        images.iter().map(mean).collect()
    };
    (0..16).map(block).collect()
}

/// Renders the scene in all ways and compares each with the path tracer.
#[track_caller]
fn assert_agreement(name: &str, text: &str) {
    let passes = 40;
    let reference = lit(text, "integrator=path samples=32").passes(passes);
    let ways = [
        ("integrator=light photons=16384", 0.0),
        ("integrator=photon-map photons=16384 bandwidth=fixed radius=0.04 direct=next-event samples=8", KERNEL_BIAS),
        (
            "integrator=photon-map photons=16384 bandwidth=nearest k=20 radius=0.04 direct=photons samples=2",
            KERNEL_BIAS,
        ),
        ("integrator=auto photons=16384 samples=8 radius=0.6", KERNEL_BIAS),
    ];
    for (way, bias) in ways {
        let images = lit(text, &format!("{way} seed=1")).passes(passes);
        for channel in 0..3 {
            let means = |images: &[Image]| -> Vec<f64> {
                images.iter().map(|image| common::channel_mean(image, channel)).collect()
            };
            let name = format!("{name}, {way}, channel {channel}");
            assert_same_mean(&name, &means(&reference), &means(&images), 3, bias);
        }
        for (number, (a, b)) in blocks(&reference).iter().zip(blocks(&images)).enumerate() {
            // Shadows' edges move a little light between neighbouring blocks.
            assert_same_mean(&format!("{name}, {way}, block {number}"), a, &b, 16, 3.0 * bias);
        }
    }
}

#[test]
fn on_a_diffuse_box_with_a_point_light() {
    assert_agreement("point", &room(POINT, &[WALLS, BALL]));
}

#[test]
fn on_a_box_lit_by_a_square_lamp() {
    let lamp = "
        [[shapes]]
        type = 'quad'
        corner = [-0.3, 0.9, -0.3]
        u = [0.6, 0, 0]
        v = [0, 0, 0.6]
        emission = { radiance = [3, 4, 5] }\n";
    assert_agreement("area", &room("", &[WALLS, BALL, lamp]));
}

/// A lamp that shines up and down, in squares.
#[test]
fn on_a_box_lit_by_a_textured_lamp_of_two_sides() {
    let lamp = "
        [textures.squares]
        type = 'checkerboard'
        color0 = [1, 0.2, 0]
        color1 = [0, 0.3, 0.9]
        to-uv = [{ scale = 1.5 }]
        [[shapes]]
        type = 'quad'
        corner = [-0.3, 0.5, -0.3]
        u = [0.6, 0, 0]
        v = [0, 0, 0.6]
        emission = { radiance = 'squares', scale = 9, two-sided = true }\n";
    assert_agreement("textured lamp", &room("", &[WALLS, BALL, lamp]));
}

#[test]
fn on_a_box_lit_by_a_ball_and_a_cylinder() {
    let lamps = "
        [[shapes]]
        type = 'sphere'
        center = [-0.5, 0.5, 0.4]
        radius = 0.2
        emission = { power = 6 }
        [[shapes]]
        type = 'cylinder'
        from = [-0.8, 0.8, 0.8]
        to = [0.8, 0.8, 0.8]
        radius = 0.05
        material = { type = 'diffuse', reflectance = 0.5 }
        emission = { power = [1, 2, 3] }\n";
    assert_agreement("lamps", &room("", &[WALLS, BALL, lamps]));
}

/// Plastic is gathered on, and mirrors: photons under the coat and rays reflected by it.
#[test]
fn on_a_floor_of_plastic_under_a_ball_of_plastic() {
    let plastic = "material = { type = 'plastic', reflectance = [0.9, 0.5, 0.2] }\n";
    // Light tracing cannot see what is mirrored in the coat: a black world but for the floor leaves nothing to see.
    assert_agreement("plastic floor", &room(POINT, &[FLOOR, plastic]));
    let rough = "material = { type = 'plastic', reflectance = [0.9, 0.5, 0.2], roughness = { alpha = 0.4 } }\n";
    assert_agreement("rough plastic floor", &room(POINT, &[FLOOR, rough, BALL]));
    let text = room(POINT, &[WALLS, BALL, plastic]);
    let passes = 40;
    let mean = |way: &str| lit(&text, way).means(passes)[0].clone();
    let reference = mean("integrator=path samples=32");
    for way in [
        "integrator=photon-map photons=32768 bandwidth=fixed radius=0.03 samples=8 direct=photons seed=2",
        "integrator=photon-map photons=32768 bandwidth=fixed radius=0.03 samples=8 direct=next-event seed=2",
        "integrator=auto photons=32768 samples=8 seed=2",
    ] {
        assert_same_mean(&format!("plastic ball, {way}"), &reference, &mean(way), 1, KERNEL_BIAS);
    }
}

/// Shadow rays find it past the pane alone.
#[test]
fn on_a_box_lit_by_a_lamp_behind_a_pane_of_glass() {
    let behind = |glass: &str| {
        format!(
            "[[shapes]]
             type = 'quad'
             corner = [-0.4, 0.97, -0.4]
             u = [0.8, 0, 0]
             v = [0, 0, 0.8]
             emission = {{ radiance = [3, 4, 5] }}
             [[shapes]]
             type = 'cube'
             transform = [{{ scale = [0.6, 0.04, 0.6] }}, {{ translate = [0, 0.85, 0] }}]
             material = {glass}\n"
        )
    };
    for glass in ["{ type = 'glass' }", "{ type = 'glass', ior = 1.4, roughness = { alpha = 0.3 } }"] {
        assert_agreement(&format!("lamp behind {glass}"), &room("", &[WALLS, BALL, &behind(glass)]));
    }
}

/// No shadow ray finds it.
#[test]
fn on_a_box_lit_by_a_lamp_in_a_ball_of_glass() {
    let inside = "
        [[shapes]]
        type = 'sphere'
        center = [-0.5, 0.5, 0.4]
        radius = 0.15
        emission = { radiance = [10, 20, 30] }
        [[shapes]]
        type = 'sphere'
        center = [-0.5, 0.5, 0.4]
        radius = 0.25
        material = { type = 'glass' }\n";
    assert_agreement("lamp in glass", &room("", &[WALLS, BALL, inside]));
}

#[test]
fn on_a_box_with_a_spot() {
    let spot = "{ type = 'spot', position = [-0.4, 0.7, 0.3], target = [0.1, -1, 0], intensity = 4,
                cutoff = 40, beam-width = 10 }";
    assert_agreement("spot", &room(spot, &[WALLS, BALL]));
}

/// A floor without walls, since parallel light would not come in.
#[test]
fn on_a_floor_in_parallel_light() {
    let sun = "{ type = 'directional', direction = [0.5, -1, 0.3], irradiance = [3, 2, 1] }";
    assert_agreement("directional", &room(sun, &[FLOOR, WHITE, BALL]));
}

#[test]
fn on_a_floor_under_the_sky() {
    let sky = "{ type = 'constant', radiance = [1, 2, 3] }";
    assert_agreement("sky", &room(sky, &[FLOOR, WHITE, BALL]));
}

#[test]
fn on_a_floor_under_a_picture_of_the_sky() {
    for (file, turn) in
        [("oblong", "{ rotate = { axis = [1, 0, 0], degrees = 30 } }"), ("square", "{ scale = [1, 1, -1] }")]
    {
        let mapping = if file == "square" { "equal-area" } else { "lat-long" };
        let sky = format!("{{ type = 'environment', file = '{file}', mapping = '{mapping}', transform = [{turn}] }}");
        assert_agreement(file, &room(&sky, &[FLOOR, WHITE, BALL]));
    }
}

#[test]
fn on_a_floor_in_the_afternoon() {
    let sky = "{ type = 'sky', sun-direction = [1, 1, -0.5], sun-scale = 0.1, sun-angle = 20 }";
    assert_agreement("sky and sun", &room(sky, &[FLOOR, WHITE, BALL]));
}

/// Photons from infinitely far away reach an infinite floor only near what is finite. `auto` must find by paths what they do
/// not bring, and not count on them where a shadow ray or chance finds light that they never bring.
#[test]
fn on_an_endless_floor() {
    let floor = "[[shapes]]\ntype = 'plane'\nnormal = [0, 1, 0]\ndistance = 1\n";
    for light in [
        "{ type = 'constant', radiance = [1, 2, 3] }",
        "{ type = 'directional', direction = [0.5, -1, 0.2], angle = 40 }",
        "{ type = 'directional', direction = [0.5, -1, 0.2] }",
    ] {
        let text = room(light, &[floor, WHITE, BALL, "material = { type = 'diffuse', reflectance = 0.9 }\n"])
            .replace("fov = 40", "fov = 120");
        let way = |settings: &str| blocks(&lit(&text, settings).passes(40));
        let (path, auto) = (way("integrator=path samples=32"), way("integrator=auto photons=16384 samples=8 seed=1"));
        for (block, (path, auto)) in path.iter().zip(&auto).enumerate() {
            assert_same_mean(&format!("{light}, block {block}"), path, auto, 48, KERNEL_BIAS);
        }
    }
}

#[test]
fn on_a_box_with_a_projector() {
    let board = "textures = { board = { type = 'checkerboard', color0 = [1, 0.5, 0.2], color1 = 0.1 } }\n";
    let projector = "{ type = 'projector', position = [-0.4, 0.7, 0.3], target = [0.1, -1, 0], up = [1, 0.2, 0],
                      texture = 'board', aspect = 1.5, fov = 70, scale = [3, 2, 4] }";
    assert_agreement("projector", &(board.to_string() + &room(projector, &[WALLS, BALL])));
}

#[test]
fn on_a_box_with_a_wide_beam() {
    let beam = "{ type = 'beam', position = [-0.4, 0.7, 0.3], direction = [0.5, -1.7, -0.3], radius = 0.25, power = [1, 2, 3] }";
    // Its edges are sharp, which the kernel blurs, and light tracing too, by up to a pixel: the whole picture must agree.
    let text = room(beam, &[WALLS, BALL]);
    let reference = lit(&text, "integrator=path samples=32").means(40);
    for (way, bias) in [
        ("integrator=light photons=65536 seed=1", 0.003),
        ("integrator=photon-map photons=65536 bandwidth=fixed radius=0.03 direct=photons seed=1", 2.0 * KERNEL_BIAS),
    ] {
        for (channel, (a, b)) in reference.iter().zip(lit(&text, way).means(40)).enumerate() {
            assert_same_mean(&format!("beam, {way}, channel {channel}"), a, &b, 3, bias);
        }
    }
}

#[test]
fn through_an_orthographic_camera() {
    let text = room(POINT, &[WALLS, BALL]);
    assert_agreement("orthographic", &text.replace("fov = 40", "projection = 'orthographic', width = 1.1"));
}

#[test]
fn through_a_lens() {
    let text = room(POINT, &[WALLS, BALL]);
    let text = text.replace("fov = 40", "fov = 30, aperture-radius = 0.1, focus-distance = 1.2");
    assert_agreement("lens", &text);
}

/// Smooth normals are where a path from the lamp and one from the camera differ by a correction [Veach 1997, eq. 5.19]:
/// a coarse ball in a spot's light, and the floor, which is lit by nothing but it. Without the correction the floor
/// differs by 5 %.
#[test]
fn on_a_ball_of_few_triangles_with_smooth_normals() {
    let corners =
        [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]];
    let octahedron = MeshData {
        positions: corners.to_vec(),
        triangles: vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]],
        ..MeshData::default()
    };
    let ball = ShapeDescription {
        geometry: GeometryDescription::Triangles(Arc::new(finer(&octahedron, 0.3))),
        material: Some(MaterialRef::Inline(Box::new(MaterialDescription::Diffuse { reflectance: Paint::grey(1.0) }))),
        emission: None,
        transform: Transform(Mat4::from_translation(Vec3::new(0.1, -0.4, 0.6))),
        flip_normal: false,
        name: None,
    };
    // From in front of the ball, so that the light goes back to the floor that the camera sees.
    let spot = "{ type = 'spot', position = [-0.3, -0.2, -1], target = [0.1, -0.4, 0.6], intensity = 9, cutoff = 9,
                beam-width = 9 }";
    let render = |way: &str, view: &str| {
        let text = room(spot, &[FLOOR, WHITE]).replace("[0, -1, 0.1], fov = 40", view);
        let mut description = common::described(&text);
        description.shapes.push(ball.clone());
        common::built(description, way).means(60)[0].clone()
    };
    for view in ["[0, -1, -0.2], fov = 20", "[0.1, -0.3, 0.6], fov = 10"] {
        let reference = render("integrator=path samples=128", view);
        for way in [
            "integrator=light photons=16384 seed=1",
            "integrator=photon-map photons=32768 bandwidth=fixed radius=0.03 samples=4 direct=next-event seed=1",
            "integrator=photon-map photons=32768 bandwidth=fixed radius=0.03 samples=4 direct=photons seed=1",
            "integrator=auto photons=32768 samples=4 radius=0.6 seed=1",
        ] {
            assert_same_mean(&format!("{way}, {view}"), &reference, &render(way, view), 1, KERNEL_BIAS);
        }
    }
}

/// Each triangle cut into four, all corners moved to the sphere of this radius, with the sphere's normals.
fn finer(mesh: &MeshData, radius: f32) -> MeshData {
    let mut finer = MeshData::default();
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|corner| Vec3::from_array(mesh.positions[corner as usize]));
        let (ab, bc, ca) = (a + b, b + c, c + a);
        for corners in [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]] {
            let first = finer.positions.len() as u32;
            for corner in corners {
                finer.positions.push((corner.normalize() * radius).to_array());
                finer.normals.push(corner.normalize().to_array());
            }
            finer.triangles.push([first, first + 1, first + 2]);
        }
    }
    finer
}
