use std::path::{Path, PathBuf};

use super::*;
use crate::scene::build;
use crate::shared_tests::shared;

/// Files by name.
struct Memory(HashMap<PathBuf, Vec<u8>>);

impl Folder for Memory {
    fn read(&self, file: &Path) -> std::io::Result<Vec<u8>> {
        self.0.get(file).cloned().ok_or(std::io::ErrorKind::NotFound.into())
    }

    fn has(&self, file: &Path) -> bool {
        self.0.contains_key(file)
    }

    fn shown(&self, file: &Path) -> PathBuf {
        file.to_path_buf()
    }
}

const OBJ: &str = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n";

/// The scene of one triangle with the material `m`, its library given.
fn scene(library: &str) -> Imported {
    scene_of(OBJ, &[("a.mtl", library), ("p.png", "")])
}

fn scene_of(main: &str, files: &[(&str, &str)]) -> Imported {
    let files = files.iter().copied().chain([("a.obj", main)]);
    let memory = files.map(|(name, text)| (PathBuf::from(name), text.as_bytes().to_vec())).collect();
    read_from(&Memory(memory), Path::new("a.obj")).expect("it is fine")
}

fn material(library: &str) -> MaterialDescription {
    scene(&format!("newmtl m\n{library}")).description.materials.remove("m").expect("it is there")
}

fn messages(imported: &Imported) -> Vec<String> {
    imported.warnings.iter().map(ToString::to_string).collect()
}

#[test]
fn each_material_becomes_a_shape() {
    let main = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nusemtl a b\nf 1 2 3\nusemtl c\nf 3 2 1\nusemtl a b\nf 1 3 2\n";
    let imported = scene_of(main, &[("a.mtl", "newmtl a  b\nKd 1 0 0\nnewmtl c\n")]);
    let count = |shape: &ShapeDescription| match &shape.geometry {
        GeometryDescription::Triangles(mesh) => mesh.triangles.len(),
        _ => 0,
    };
    let shapes: Vec<_> = imported
        .description
        .shapes
        .iter()
        .map(|shape| (shape.name.as_deref(), count(shape), shape.material.is_some()))
        .collect();
    assert_eq!(shapes, [(None, 1, false), (Some("a b"), 2, true), (Some("c"), 1, true)]);
    assert_eq!(messages(&imported), Vec::<String>::new());
}

#[test]
fn missing_libraries_materials_and_pictures_are_warnings() {
    let imported = scene_of(OBJ, &[]);
    assert_eq!(messages(&imported), ["a.obj:1:8: cannot read 'a.mtl': no such file or folder: its materials are grey"]);
    let imported = scene("newmtl mm\nKd 1 1 1");
    assert_eq!(messages(&imported), ["there is no material 'm': the surface is grey; did you mean 'mm'?"]);
    let imported = scene("newmtl m\nmap_Kd missing.png");
    assert_eq!(messages(&imported), ["a.mtl:1:1: the picture 'missing.png' is not there: the colour alone is used"]);
}

#[test]
fn numbers_become_the_nearest_material() {
    let diffuse = Paint::Color(Color([0.25, 0.5, 0.75]));
    assert_eq!(material("Kd 0.25 0.5 0.75"), MaterialDescription::Diffuse { reflectance: diffuse.clone() });
    assert_eq!(material("Kd 0.25 0.5 0.75\nKs 1 1 1\nillum 1"), MaterialDescription::Diffuse { reflectance: diffuse });
    let MaterialDescription::TwoSided { front: MaterialRef::Inline(front), .. } = material("Kd .5 .5 .5\nKs .2\nNs 32")
    else {
        panic!("two-sided")
    };
    assert!(matches!(*front, MaterialDescription::Phong { exponent, .. } if exponent == Paint::grey(32.0)));
    let mirror = material("Kd .01 .01 .01\nKs .95 .95 .95\nillum 5");
    assert!(matches!(mirror, MaterialDescription::Coefficients { ks, .. } if ks == Color::grey(0.95)));
    let glass = material("Ni 1.3\nTf .25 1 1\nillum 7\nd 0.1");
    let tint = Paint::Color(Color([0.5, 1.0, 1.0]));
    assert!(
        matches!(glass, MaterialDescription::Glass { ior, transmittance, .. } if ior == 1.3 && transmittance == tint)
    );
    assert!(matches!(material("Pr 0.3\nPm 1"), MaterialDescription::Principled(_)));
    assert!(matches!(material("Tr 0.75"), MaterialDescription::Mask { opacity, .. } if opacity == Paint::grey(0.25)));
}

#[test]
fn colours_that_add_up_to_more_than_all_are_scaled_down() {
    let imported = scene("newmtl m\nKd 1 1 1\nKs 1 1 1\nillum 3");
    let MaterialDescription::Coefficients { kd, ks, .. } = imported.description.materials["m"] else {
        panic!("a mirror")
    };
    assert!(kd.0[0] + ks.0[0] <= 1.0 && kd.0[0] + ks.0[0] > 0.999);
    assert!(messages(&imported)[0].contains("add up to more than 1"));
}

#[test]
fn pictures_scale_their_colours_and_have_their_place() {
    let imported = scene("newmtl m\nKd .5 .5 .5\nmap_Kd -s 2 2 2 p.png\nmap_d p.png\nmap_Bump -bm 3 p.png");
    assert_eq!(messages(&imported), Vec::<String>::new());
    let names: Vec<&str> = imported.description.textures.keys().map(String::as_str).collect();
    assert_eq!(names, ["p.png", "p.png-2", "p.png-tinted"]);
    let MaterialDescription::Mask { material: MaterialRef::Inline(inside), .. } = &imported.description.materials["m"]
    else {
        panic!("a mask")
    };
    assert!(matches!(**inside, MaterialDescription::BumpMap { scale: 3.0, .. }));
}

#[test]
fn a_scene_without_lamps_gets_light_from_everywhere() {
    assert_eq!(scene("newmtl m").description.lights.len(), 1);
    let lamp = scene("newmtl m\nKe 3 2 1");
    assert!(lamp.description.lights.is_empty());
    let emission = lamp.description.shapes[0].emission.clone().expect("it emits");
    assert_eq!(emission.radiance, Some(Paint::Color(Color([3.0, 2.0, 1.0]))));
}

#[test]
fn smoothing_groups_make_smooth_normals() {
    let normals = |main: &str| match &scene_of(main, &[]).description.shapes[0].geometry {
        GeometryDescription::Triangles(mesh) => mesh.normals.len(),
        _ => 0,
    };
    let faces = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nX\nf 1 2 3\nf 1 2 4\n";
    assert_eq!(normals(&faces.replace('X', "s 1")), 4);
    assert_eq!(normals(&faces.replace('X', "s off")), 0);
}

#[test]
fn all_files_of_others_are_read_or_refused_with_a_word() {
    let Some(folder) = shared("scenes/odd-files/OBJ") else { return };
    let (mut read_well, mut refused) = (0, Vec::new());
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.extension().is_some_and(|extension| extension == "obj") {
            match read(&path) {
                Ok(imported) => {
                    read_well += 1;
                    assert!(imported.description.camera.is_some());
                }
                Err(error) => refused.push(error.to_string()),
            }
        }
    }
    assert!(read_well >= 14, "only {read_well} are read: {refused:#?}");
    assert!(refused.iter().all(|message| message.contains("no faces") || message.contains(".obj:")), "{refused:#?}");
}

#[test]
fn the_cornell_boxes_have_their_lamp_and_their_camera() {
    for name in ["Original", "Mirror", "Sphere", "Glossy"] {
        let Some(path) = shared(&format!("scenes/obj-cornell/CornellBox-{name}.obj")) else { continue };
        let imported = read(&path).expect("it is fine");
        let lamps = imported.description.shapes.iter().filter(|shape| shape.emission.is_some()).count();
        assert_eq!((lamps, imported.description.lights.len()), (1, 0), "{name}");
        let camera = imported.description.camera.expect("it is framed");
        assert!((3.0..4.5).contains(&camera.origin[2]) && camera.origin[0].abs() < 0.1, "{name}: {camera:?}");
    }
}

#[test]
fn a_mesh_alone_is_a_scene() {
    let folder = tempfile::tempdir().expect("a folder");
    let stl = folder.path().join("a.stl");
    let text = "solid a\nvertex 0 0 0 vertex 1 0 0 vertex 0 0 1\nendsolid";
    std::fs::write(&stl, text).expect("a file");
    let imported = read_mesh(&stl).expect("it is fine");
    let camera = imported.description.camera.clone().expect("it is framed");
    assert_eq!(camera.up, Some([0.0, 0.0, 1.0]));
    build(&imported.description, &crate::scene::NoAssets).expect("it can be rendered");
}

/// Were their places counted from the beginning of the file, or their words again at each line, this would not end.
#[test]
fn very_many_bad_lines_and_names_are_read_in_time() {
    let library = "x\n".repeat(300_000);
    let materials: String = (0..50_000).map(|number| format!("newmtl a{number}\n")).collect();
    assert_eq!(scene(&library).warnings.len(), 1001);
    let unknown: String = (0..50_000).map(|number| format!("usemtl b{number}\nf 1 2 3\n")).collect();
    let continued = "a \\\n".repeat(200_000);
    let libraries: String = (0..50_000).map(|number| format!("mtllib c{number}\n")).collect();
    let main = format!("{OBJ}{unknown}{libraries}{continued}");
    assert_eq!(scene_of(&main, &[("a.mtl", &materials)]).warnings.len(), 1001);
}
