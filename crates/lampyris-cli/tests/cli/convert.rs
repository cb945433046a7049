//! Scenes of other formats as our own: the same picture, to the last bit.

use super::{Folder, SCENE};

/// A quad under a point light with a picture on it, in the way of Mitsuba; `shape` is added.
fn mitsuba(shape: &str) -> String {
    format!(
        "<scene version=\"3.0.0\">
            <default name=\"power\" value=\"20\"/>
            <integrator type=\"path\"/>
            <sensor type=\"perspective\">
                <transform name=\"to_world\"><lookat origin=\"0, 1, 3\" target=\"0, 0, 0\" up=\"0, 1, 0\"/></transform>
                <sampler type=\"independent\"><integer name=\"sample_count\" value=\"2\"/></sampler>
                <film type=\"hdrfilm\"><integer name=\"width\" value=\"9\"/><integer name=\"height\" value=\"7\"/></film>
            </sensor>
            <emitter type=\"point\"><point name=\"position\" value=\"0, 2, 2\"/><rgb name=\"intensity\" value=\"$power\"/></emitter>
            {shape}
        </scene>"
    )
}

const QUAD: &str = "<shape type=\"rectangle\"><bsdf type=\"diffuse\">
    <texture type=\"bitmap\" name=\"reflectance\"><string name=\"filename\" value=\"wood.png\"/></texture></bsdf></shape>";

/// One triangle with normals that are not of unit length.
const MESH: &str = "v -1 0 0\nv 1 0 0\nv 0 1 0.3\nvn 0.1 0.2 1\nf 1//1 2//1 3//1\n";

/// A folder with a picture `wood.png` and the folder `elsewhere`.
fn folder() -> Folder {
    let folder = Folder::with_scene(SCENE);
    folder.run("render scene.toml -o wood.png --size 4x4 --passes 1");
    std::fs::create_dir(folder.path("elsewhere")).expect("a folder");
    folder
}

/// The pixels of a file that was rendered.
fn pixels(folder: &Folder, scene: &str) -> Vec<u8> {
    folder.run(&format!("render {scene} -o a.npy --size 9x7 --passes 2 -q"));
    folder.read("a.npy")
}

#[test]
fn a_scene_with_files_beside_it_gives_the_same_picture_from_another_folder() {
    let folder = folder();
    folder.write("mesh.obj", MESH);
    let mesh = "<shape type=\"obj\"><string name=\"filename\" value=\"mesh.obj\"/></shape>";
    folder.write("room.xml", mitsuba(&format!("{QUAD}{mesh}")));
    let (stdout, stderr) = folder.run("convert room.xml -o elsewhere/room.toml");
    assert_eq!((stdout.as_str(), stderr.as_str()), ("elsewhere/room.toml\n", ""));
    let text = String::from_utf8(folder.read("elsewhere/room.toml")).expect("text");
    assert!(text.contains("\"../wood.png\"") && text.contains("\"../mesh.obj\""), "{text}");
    assert_eq!(pixels(&folder, "elsewhere/room.toml"), pixels(&folder, "room.xml"));
}

#[test]
fn meshes_inside_a_file_become_files_beside_the_new_one() {
    let folder = folder();
    folder.write("model.obj", MESH);
    let (stdout, _) = folder.run("convert model.obj -o elsewhere/m.toml");
    assert_eq!(stdout, "elsewhere/m-mesh0.ply\nelsewhere/m.toml\n");
    assert_eq!(pixels(&folder, "elsewhere/m.toml"), pixels(&folder, "model.obj"));
}

#[test]
fn a_parameter_is_as_the_command_line_says() {
    let folder = folder();
    folder.write("room.xml", mitsuba(QUAD));
    folder.run("convert room.xml -o room.toml -D power=5");
    let text = String::from_utf8(folder.read("room.toml")).expect("text");
    assert!(text.contains("intensity = 5.0\n"), "{text}");
}

#[test]
fn converting_twice_changes_nothing() {
    let folder = folder();
    folder.run("convert scene.toml -o once.toml");
    folder.run("convert once.toml -o twice.toml");
    assert_eq!(folder.read("once.toml"), folder.read("twice.toml"));
}

#[test]
fn what_a_scene_is_read_from_stays() {
    let folder = folder();
    let message = folder.refuse("convert scene.toml -o scene.toml");
    assert!(message.starts_with("error: cannot write 'scene.toml': the scene is read from it\nhint: "), "{message}");
    // The mesh would become a file of the name that the picture has.
    folder.write("m-mesh0.ply", folder.read("wood.png"));
    folder.write("m.mtl", "newmtl wood\nmap_Kd m-mesh0.ply\n");
    folder.write("m.obj", format!("mtllib m.mtl\nusemtl wood\n{MESH}"));
    let message = folder.refuse("convert m.obj -o m.toml");
    assert!(message.contains("cannot write './m-mesh0.ply': the scene is read from it"), "{message}");
    assert_eq!(folder.read("m-mesh0.ply"), folder.read("wood.png"));
}

#[test]
fn a_scene_that_makes_no_sense_is_not_converted() {
    let folder = Folder::with_scene(&SCENE.replace("radius = 0.5", "radius = 0"));
    let message = folder.refuse("convert scene.toml -o new.toml");
    assert!(message.contains("radius must be greater than 0") && message.contains("scene.toml:26:10"), "{message}");
}

#[test]
fn another_ending_is_refused() {
    let folder = Folder::with_scene(SCENE);
    let message = folder.refuse("convert scene.toml -o new.xml");
    assert_eq!(
        message,
        "error: cannot write a scene to 'new.xml': unknown format\nhint: scenes can be written as .toml\n"
    );
    assert!(folder.refuse("convert scene.toml -o no/new.toml").contains("there is no folder 'no'"));
}

#[test]
fn what_is_left_out_is_told() {
    let folder = folder();
    folder.write("room.xml", mitsuba(&format!("{QUAD}<shape type=\"sdfgrid\"/>")));
    let (_, stderr) = folder.run("convert room.xml -o room.toml");
    assert!(stderr.starts_with("warning: ") && stderr.contains("sdfgrid"), "{stderr}");
    let message = folder.refuse("convert room.xml -o strict.toml --strict");
    assert!(message.contains("sdfgrid"), "{message}");
}
