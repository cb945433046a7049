//! Pictures without their noise, in builds that can, and one sentence in those that cannot.

use super::{Folder, SCENE};

#[cfg(not(feature = "denoise"))]
#[test]
fn a_build_that_cannot_denoise_says_so_before_it_renders() {
    let folder = Folder::with_scene(SCENE);
    folder.run("render scene.toml -q -o a.exr");
    for command in ["render scene.toml -o b.exr --denoise", "denoise a.exr -o b.exr"] {
        let message = folder.refuse(command);
        assert!(message.starts_with("error: this build of lampyris cannot denoise\nhint: "), "{message}");
        assert!(message.contains("--features denoise"), "{message}");
    }
}

#[cfg(feature = "denoise")]
#[test]
fn the_picture_is_denoised_and_what_was_rendered_is_kept() {
    let folder = Folder::with_scene(SCENE);
    let layer = |file: &str, name: &str| {
        folder.run(&format!("tonemap {file} --layer {name} -o layer.pfm --operator clamp"));
        folder.read("layer.pfm")
    };
    let picture = |file: &str| {
        folder.run(&format!("tonemap {file} -o picture.pfm --operator clamp"));
        folder.read("picture.pfm")
    };
    folder.run("render scene.toml -q -o a.exr --layers albedo,normal --checkpoint a.film");
    folder.run("render scene.toml -q -o b.exr -o b.pfm --layers none --checkpoint b.film --denoise");
    assert!(folder.read("a.film") == folder.read("b.film"), "the film is that of a render that does not denoise");
    assert_eq!(layer("b.exr", "noisy"), picture("a.exr"));
    assert_ne!(picture("b.exr"), picture("a.exr"));
    for file in ["a.film", "a.exr", "b.exr"] {
        folder.run(&format!("denoise {file} -o c.exr"));
        assert_eq!((picture("c.exr"), layer("c.exr", "noisy")), (picture("b.exr"), picture("a.exr")), "{file}");
    }
    let has_name = folder.read("b.exr").windows(18).any(|window| window == b"Open Image Denoise");
    assert!(has_name, "the file says who denoised it");
}
