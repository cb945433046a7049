//! Cameras, films, lights and shapes.

use std::f32::consts::PI;
use std::sync::Arc;

use super::*;
use crate::geometry::MeshData;
use crate::scene::description::{
    EnvironmentMapping, FilterDescription, FovAxis, GeometryDescription, IntegratorDescription, LightDescription,
    Paint, Projection,
};

fn near(a: [f32; 3], b: [f32; 3]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-4 * (1.0 + b.abs()))
}

fn light(text: &str) -> LightDescription {
    let mut lights = clean(&format!("WorldBegin LightSource {text}")).description.lights;
    assert_eq!(lights.len(), 1);
    lights.remove(0)
}

fn triangles(shape: &ShapeDescription) -> Arc<MeshData> {
    match &shape.geometry {
        GeometryDescription::Triangles(mesh) => Arc::clone(mesh),
        other => panic!("a mesh and not {other:?}"),
    }
}

#[test]
fn a_camera_looks_where_look_at_says_with_x_to_the_right() {
    let camera =
        clean("LookAt 0 0 -5  0 0 0  0 1 0 Camera \"perspective\" \"float fov\" 30 WorldBegin").description.camera;
    let camera = camera.expect("a camera");
    assert!(near(camera.origin, [0.0, 0.0, -5.0]));
    assert!(near(camera.forward.expect("set"), [0.0, 0.0, 1.0]) && near(camera.up.expect("set"), [0.0, 1.0, 0.0]));
    assert!(near(camera.left.expect("set"), [-1.0, 0.0, 0.0]));
    assert_eq!((camera.fov, camera.fov_axis), (Some(30.0), FovAxis::Smaller));
}

#[test]
fn a_window_and_a_crop_move_the_picture() {
    let film = "Film \"rgb\" \"integer xresolution\" 200 \"integer yresolution\" 100";
    let camera = |text: &str| clean(&format!("{film} {text} WorldBegin")).description.camera.expect("a camera");
    let whole = camera("Camera \"perspective\" \"float fov\" 90 \"float screenwindow\" [-1 1 -1 1]");
    assert!(near(whole.left.expect("set"), [-1.0, 0.0, 0.0]) && near(whole.up.expect("set"), [0.0, 1.0, 0.0]));
    assert_eq!(whole.fov, None);
    let film = "Film \"rgb\" \"integer xresolution\" 200 \"integer yresolution\" 100 \"float cropwindow\" [0 0.5 0 1]";
    let left_half = clean(&format!("{film} Camera \"perspective\" WorldBegin")).description;
    assert_eq!(left_half.film.size, [100, 100]);
    let camera = left_half.camera.expect("a camera");
    assert!(near(camera.forward.expect("set"), [-1.0, 0.0, 1.0]) && near(camera.left.expect("set"), [-1.0, 0.0, 0.0]));
}

#[test]
fn orthographic_cameras_lenses_and_others_are_read() {
    let text = "Camera \"orthographic\" \"float screenwindow\" [-2 2 -1 1] WorldBegin";
    let camera = clean(text).description.camera.expect("a camera");
    assert_eq!(camera.projection, Projection::Orthographic);
    assert!(near(camera.left.expect("set"), [-2.0, 0.0, 0.0]));
    let text = "Scale 0.5 0.5 0.5 Camera \"perspective\" \"float lensradius\" 0.1 \"float focaldistance\" 3 WorldBegin";
    let camera = clean(text).description.camera.expect("a camera");
    assert_eq!((camera.aperture_radius, camera.focus_distance), (0.2, Some(6.0)));
    let imported = scene("Camera \"realistic\" \"string lensfile\" \"a.dat\" WorldBegin").expect("valid");
    assert!(messages(&imported)[0].contains("camera 'realistic' is not supported"));
    assert!(fault("Camera \"perspective\" \"float fov\" 180").message.contains("must lie between 0 and 180"));
}

#[test]
fn film_filter_and_sampler_are_read_with_pbrts_defaults() {
    let description = clean("WorldBegin").description;
    assert_eq!(description.film.size, [1280, 720]);
    assert_eq!(description.film.filter, FilterDescription::Gaussian { stddev: 0.5 });
    let text = "Film \"rgb\" \"integer xresolution\" 64 \"integer yresolution\" 32 PixelFilter \"triangle\"
        Sampler \"stratified\" \"integer xsamples\" 3 \"integer ysamples\" 5";
    let description = clean(text).description;
    assert_eq!((description.film.size, description.render.passes), ([64, 32], Some(15)));
    assert_eq!(description.film.filter, FilterDescription::Tent { radius: 2.0 });
    let imported = scene("PixelFilter \"mitchell\" Film \"rgb\" \"float maxcomponentvalue\" 10").expect("valid");
    assert_eq!(imported.warnings.len(), 2);
}

#[test]
fn integrators_become_the_nearest_we_have_with_the_same_depth() {
    let integrator = |text: &str| scene(text).expect("valid").description.integrator;
    assert!(matches!(integrator("WorldBegin"), IntegratorDescription::Auto(path) if path.max_bounces == 5));
    let path = integrator("Integrator \"volpath\" \"integer maxdepth\" 9");
    assert!(matches!(path, IntegratorDescription::Auto(path) if path.max_bounces == 9));
    let sppm = integrator(
        "Film \"rgb\" \"integer xresolution\" 10 \"integer yresolution\" 20 Integrator \"sppm\" \"float radius\" 0.5",
    );
    let IntegratorDescription::PhotonMap(sppm) = sppm else { panic!("a photon map") };
    assert_eq!((sppm.photons, sppm.radius, sppm.max_bounces), (200, Some(0.5), 5));
    let bdpt = scene("Integrator \"bdpt\" \"integer maxdepth\" 7").expect("valid");
    assert!(matches!(bdpt.description.integrator, IntegratorDescription::Auto(ref path) if path.max_bounces == 7));
    assert!(messages(&bdpt)[0].contains("integrator 'bdpt' is not supported: 'auto' of its depth is used"));
}

#[test]
fn rgb_light_stays_as_it_is_and_spectra_are_scaled_to_luminance_one() {
    let LightDescription::Constant { radiance } = light("\"infinite\" \"rgb L\" [1 2 3] \"float scale\" 2") else {
        panic!("a constant light")
    };
    assert!(near(radiance.0, [2.0, 4.0, 6.0]));
    for text in ["\"blackbody L\" 3000", "\"spectrum L\" [300 7 800 7]", "\"spectrum L\" \"stdillum-A\""] {
        let LightDescription::Constant { radiance } = light(&format!("\"infinite\" {text}")) else {
            panic!("a constant light")
        };
        let [r, g, b] = radiance.0;
        assert!((0.2126 * r + 0.7152 * g + 0.0722 * b - 1.0).abs() < 1e-3, "{text}: {radiance:?}");
        assert!(r > b, "{text}: {radiance:?}");
    }
    let constant = LightDescription::Constant { radiance: crate::scene::description::Color::grey(1.0) };
    assert_eq!(light("\"infinite\""), constant);
}

#[test]
fn power_and_illuminance_fix_the_strength_of_a_light() {
    let LightDescription::Point { position, intensity, .. } =
        light("\"point\" \"float power\" 100 \"point3 from\" [1 2 3]")
    else {
        panic!("a point light")
    };
    assert!(near(position, [1.0, 2.0, 3.0]) && near(intensity.expect("set").0, [100.0 / (4.0 * PI); 3]));
    let LightDescription::Constant { radiance } = light("\"infinite\" \"float illuminance\" 10") else {
        panic!("a constant light")
    };
    assert!(near(radiance.0, [10.0 / PI; 3]));
    let distant = light("\"distant\" \"float illuminance\" 10 \"point3 from\" [0 5 0] \"point3 to\" [0 0 0]");
    let LightDescription::Directional { direction, irradiance, .. } = distant else { panic!("a distant light") };
    assert!(near(direction, [0.0, -1.0, 0.0]) && near(irradiance.0, [10.0; 3]));
}

#[test]
fn a_spot_has_its_angles_and_a_film_its_exposure() {
    let LightDescription::Spot { target, intensity, cutoff, beam_width, .. } =
        light("\"spot\" \"rgb I\" [1 1 2] \"float coneangle\" 40 \"float conedeltaangle\" 10")
    else {
        panic!("a spot light")
    };
    assert!(near(target, [0.0, 0.0, 1.0]) && near(intensity.expect("set").0, [1.0, 1.0, 2.0]));
    assert_eq!((cutoff, beam_width), (40.0, Some(30.0)));
    let text = "Film \"rgb\" \"float iso\" 200 Camera \"perspective\" \"float shutterclose\" 0.25
        WorldBegin LightSource \"infinite\" AreaLightSource \"diffuse\" \"rgb L\" [4 4 4] Shape \"sphere\"";
    let description = clean(text).description;
    let LightDescription::Constant { radiance } = description.lights[0] else { panic!("a constant light") };
    assert!(near(radiance.0, [0.5; 3]));
    let emission = description.shapes[0].emission.clone().expect("it emits");
    assert_eq!(emission.radiance, Some(Paint::grey(2.0)));
}

#[test]
fn environments_are_squares_in_version_4_and_lat_long_in_version_3() {
    let LightDescription::Environment { file, mapping, scale, transform } =
        light("\"infinite\" \"string filename\" \"sky.exr\" \"float scale\" 3")
    else {
        panic!("an environment")
    };
    assert_eq!((file.as_str(), mapping), ("sky.exr", EnvironmentMapping::EqualArea));
    assert!(near(scale.0, [3.0; 3]) && transform.is_identity());
    let LightDescription::Environment { mapping, transform, .. } = light("\"infinite\" \"string mapname\" \"sky.exr\"")
    else {
        panic!("an environment")
    };
    assert_eq!(mapping, EnvironmentMapping::LatLong);
    // The middle of our picture, -z, lies at -x of theirs, and our top, +y, at their +z.
    assert!(near(transform.0.transform_vector3(-glam::Vec3::Z).to_array(), [-1.0, 0.0, 0.0]));
    assert!(near(transform.0.transform_vector3(glam::Vec3::Y).to_array(), [0.0, 0.0, 1.0]));
}

#[test]
fn a_light_may_be_unknown_but_not_negative() {
    assert!(fault("LightSource \"point\" \"rgb I\" [1 -1 1]").message.contains("must not be negative"));
    let imported = scene("LightSource \"points\" \"rgb I\" 1").expect("valid");
    assert!(messages(&imported)[0].ends_with("light 'points' is not supported: it is left out; did you mean 'point'?"));
}

#[test]
fn area_lights_shine_by_radiance_power_or_picture() {
    let emission = |text: &str| shape(&format!("AreaLightSource \"diffuse\" {text} Shape \"sphere\"")).emission;
    let plain = emission("\"rgb L\" [1 2 3] \"float scale\" 2 \"bool twosided\" true").expect("it emits");
    assert_eq!(plain.radiance, Some(Paint::Color(crate::scene::description::Color([2.0, 4.0, 6.0]))));
    assert!(plain.two_sided);
    let power = emission("\"float power\" 60").expect("it emits");
    assert_eq!((power.radiance, power.power.map(|power| power.0)), (None, Some([60.0; 3])));
    let picture = emission("\"string filename\" \"tv.png\" \"float scale\" 5").expect("it emits");
    assert_eq!((picture.radiance, picture.scale), (Some(Paint::Texture("tv.png".into())), 5.0));
    assert_eq!(emission("\"rgb L\" 0"), None);
}

#[test]
fn a_triangle_mesh_is_read_and_its_normals_turn_its_triangles() {
    let mesh = "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 2]";
    let plain = shape(mesh);
    assert_eq!(triangles(&plain).triangles, [[0, 1, 2]]);
    let turned = shape(&format!("{mesh} \"normal N\" [0 0 -1 0 0 -1 0 0 -1] \"point2 uv\" [0 0 1 0 0 1]"));
    let data = triangles(&turned);
    assert_eq!((data.triangles[0], data.uvs.len()), ([0, 2, 1], 3));
    // A mirror turns the order of the corners, but not the front.
    assert!(shape(&format!("Scale 1 1 -1 {mesh}")).flip_normal);
    assert!(!shape(&format!("ReverseOrientation Scale 1 1 -1 {mesh}")).flip_normal);
    let mirrored = shape(&format!("Scale 1 1 -1 {mesh} \"normal N\" [0 0 1 0 0 1 0 0 1]"));
    assert_eq!((triangles(&mirrored).triangles[0], mirrored.flip_normal), ([0, 2, 1], false));
}

#[test]
fn faults_of_meshes_are_told() {
    for (text, words) in [
        ("\"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 3]", "names vertex 3, but there are only 3"),
        ("\"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 1000000000]", "names vertex 1000000000"),
        ("\"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1]", "3 numbers for each face, but has 2"),
        ("\"point3 P\" [0 0 0 1] \"integer indices\" [0 0 0]", "three numbers for each vertex, but has 4"),
        ("\"integer indices\" [0 1 2]", "needs positions 'P'"),
        ("\"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 1]", "needs 'indices'"),
    ] {
        let error = fault(&format!("Shape \"trianglemesh\" {text}"));
        assert!(error.message.contains(words), "{text}: {error}");
    }
}

#[test]
fn a_ply_mesh_is_read_once_plain_or_packed() {
    let ply: &[u8] = b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
        element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    std::io::Write::write_all(&mut packed, ply).expect("memory");
    let packed = packed.finish().expect("memory");
    let main: &[u8] = b"Shape \"plymesh\" \"string filename\" \"m.ply\" Shape \"plymesh\" \"string filename\" \"m.ply\"
        Shape \"plymesh\" \"string filename\" \"m.ply.gz\"";
    let imported = read_files(&[("a.pbrt", main), ("m.ply", ply), ("m.ply.gz", &packed)]).expect("valid");
    let meshes: Vec<_> = imported.description.shapes.iter().map(triangles).collect();
    assert!(Arc::ptr_eq(&meshes[0], &meshes[1]));
    assert_eq!(meshes[2].triangles, [[0, 1, 2]]);
    let error = fault("Shape \"plymesh\" \"string filename\" \"m.ply\"");
    assert_eq!(error.to_string(), "a.pbrt:1:18: cannot read 'm.ply': no such file or folder");
}

#[test]
fn round_shapes_stay_round_or_become_meshes_where_a_matrix_stretches_them() {
    let sphere = shape("Scale 2 2 2 Shape \"sphere\" \"float radius\" 3");
    assert_eq!(sphere.geometry, GeometryDescription::Sphere { center: [0.0; 3], radius: 6.0 });
    assert!(triangles(&shape("Scale 2 1 1 Shape \"sphere\"")).triangles.len() > 1000);
    let cylinder = shape("Shape \"cylinder\" \"float zmin\" 0 \"float zmax\" 2");
    let wanted = GeometryDescription::Cylinder { from: [0.0; 3], to: [0.0, 0.0, 2.0], radius: 1.0 };
    assert_eq!(cylinder.geometry, wanted);
    let disk = shape("Shape \"disk\" \"float height\" 2 \"float radius\" 3");
    let wanted = GeometryDescription::Disk { center: [0.0, 0.0, 2.0], normal: [0.0, 0.0, 1.0], radius: 3.0 };
    assert_eq!(disk.geometry, wanted);
    for text in ["sphere\" \"float phimax\" 90", "disk\" \"float innerradius\" 0.5", "cylinder\" \"float phimax\" 9"] {
        let imported = scene(&format!("Shape \"{text}")).expect("valid");
        assert!(messages(&imported)[0].contains("a part of a "), "{text}");
    }
}

#[test]
fn stretched_meshes_have_their_fronts_outside() {
    for text in ["sphere", "cylinder"] {
        let mesh = triangles(&shape(&format!("Scale 2 1 3 Shape \"{text}\"")));
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|corner| glam::Vec3::from_array(mesh.positions[corner as usize]));
            let middle = (a + b + c) * glam::Vec3::new(1.0, 1.0, if text == "sphere" { 1.0 } else { 0.0 });
            assert!((b - a).cross(c - a).dot(middle) >= -1e-9);
        }
    }
}

#[test]
fn patches_are_two_triangles_or_a_grid() {
    let flat = shape("Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0]");
    let mesh = triangles(&flat);
    assert_eq!((mesh.triangles.len(), mesh.uvs[3]), (2, [1.0, 1.0]));
    let bent = shape("Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 1] \"integer indices\" [0 1 2 3]");
    assert_eq!(triangles(&bent).triangles.len(), 128);
}

#[test]
fn subdivision_rounds_a_tetrahedron_and_knows_its_limit() {
    let text = "Shape \"loopsubdiv\" \"point3 P\" [1 1 1 -1 -1 1 -1 1 -1 1 -1 -1] \"integer indices\" [0 2 1 0 1 3 0 3 2 1 2 3]";
    assert_eq!(triangles(&shape(text)).triangles.len(), 4 * 64);
    let imported = scene(&format!("{text} \"integer levels\" 4000000000")).expect("valid");
    assert!(messages(&imported)[0].contains("the mesh gets too large"));
}

#[test]
fn curves_are_left_out() {
    let imported = scene("Shape \"curve\" \"point3 P\" [0 0 0 1 1 1]").expect("valid");
    assert!(imported.description.shapes.is_empty());
    assert!(messages(&imported)[0].contains("shape 'curve' is not supported: it is left out"));
}
