//! Files that are damaged.

use proptest::prelude::*;

use super::*;

const VALID: &str = r##"Option "bool wavefront" true
LookAt 0 0 -5 0 0 0 0 1 0 Rotate 30 0 1 0
Camera "perspective" "float fov" 40 "float lensradius" 0.1
Film "rgb" "integer xresolution" 32 "integer yresolution" 32 "float cropwindow" [0 1 0.5 1]
Sampler "halton" "integer pixelsamples" 8 PixelFilter "gaussian" Integrator "sppm" "integer maxdepth" 7
WorldBegin
Attribute "shape" "float radius" 2
Texture "t" "spectrum" "imagemap" "string filename" "a.png" "float scale" 0.5 "bool invert" true
Texture "c" "spectrum" "checkerboard" "texture tex1" "t" "rgb tex2" [1 0 1]
MakeNamedMaterial "m" "string type" "coateddiffuse" "texture reflectance" "c" "float roughness" .1
MakeNamedMaterial "n" "string type" "conductor" "spectrum eta" "metal-Au-eta" "spectrum k" [400 1 700 2]
LightSource "spot" "blackbody I" 4000 "float power" 10 "point3 from" [0 1 0]
LightSource "infinite" "float illuminance" 3
AttributeBegin ReverseOrientation Scale 1 2 3 AreaLightSource "diffuse" "rgb L" [1 2 3] "bool twosided" true
Material "mix" "string materials" ["m" "n"] "float amount" 0.2
Shape "trianglemesh" "point3 P" [0 0 0 1 0 0 0 1 0 1 1 0] "integer indices" [0 1 2 1 3 2] "normal N" [0 0 1 0 0 1 0 0 1 0 0 1]
AttributeEnd
ObjectBegin "o" NamedMaterial "m" Shape "disk" "texture alpha" "f" Shape "loopsubdiv" "integer levels" 2 "point3 P" [0 0 0 1 0 0 0 1 0] "integer indices" [0 1 2] ObjectEnd
Texture "f" "float" "constant" "float value" 0.5
TransformBegin Translate 1 2 3 ObjectInstance "o" TransformEnd
MakeNamedMedium "fog" "string type" "homogeneous" MediumInterface "fog" ""
Shape "bilinearmesh" "point3 P" [0 0 0 1 0 0 0 1 0 1 1 1] # the end
"##;

#[test]
fn the_file_they_damage_is_valid() {
    let imported = scene(VALID).expect("valid");
    assert_eq!(messages(&imported), [""; 0]);
    assert_eq!((imported.description.shapes.len(), imported.description.groups["o"].len()), (3, 2));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn a_damaged_file_never_panics(
        edits in proptest::collection::vec((any::<prop::sample::Index>(), 0usize..12, "[ -~]{0,4}|\"|\\[|\\]|9e9|1e38|-1|é"), 1..4),
    ) {
        let mut text = VALID.to_string();
        for (at, removed, inserted) in &edits {
            let from = at.index(text.len());
            let to = (from + removed).min(text.len());
            if text.is_char_boundary(from) && text.is_char_boundary(to) {
                text.replace_range(from..to, inserted);
            }
        }
        if let Err(error) = scene(&text) {
            prop_assert!(!error.to_string().is_empty());
        }
    }

    #[test]
    fn shuffled_pieces_never_panic(order in proptest::collection::vec(any::<prop::sample::Index>(), 1..40)) {
        let pieces: Vec<&str> = VALID.split_inclusive([' ', '\n']).collect();
        let text: String = order.iter().map(|index| *index.get(&pieces)).collect();
        let _ = scene(&text);
    }

    #[test]
    fn arbitrary_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        let _ = read_files(&[("a.pbrt", &bytes)]);
    }
}
