//! Materials and textures.

use super::*;
use crate::scene::description::{Color, Ior, IorFormula, Paint, TextureDescription, TextureFilter, Wrap};

fn roughness(material: &MaterialDescription) -> Option<(Paint, Option<Paint>)> {
    let roughness = match material {
        MaterialDescription::Conductor { roughness, .. }
        | MaterialDescription::Glass { roughness, .. }
        | MaterialDescription::Plastic { roughness, .. } => roughness,
        other => panic!("{other:?} has no roughness"),
    };
    roughness.clone().map(|roughness| (roughness.alpha, roughness.alpha_v))
}

/// The material, of which nothing may be said.
fn quiet(text: &str) -> MaterialDescription {
    let (material, messages) = material(text);
    assert_eq!(messages, Vec::<String>::new());
    material
}

#[test]
fn a_shape_without_material_is_grey_and_one_with_keeps_its_own() {
    assert_eq!(quiet(""), MaterialDescription::Diffuse { reflectance: Paint::grey(0.5) });
    let red = Paint::Color(Color([1.0, 0.0, 0.0]));
    let text = "Material \"diffuse\" \"rgb reflectance\" [1 0 0]";
    assert_eq!(quiet(text), MaterialDescription::Diffuse { reflectance: red.clone() });
    let later = "NamedMaterial \"a\" MakeNamedMaterial \"a\" \"string type\" \"diffuse\" \"rgb reflectance\" [1 0 0]";
    assert_eq!(quiet(later), MaterialDescription::Diffuse { reflectance: red });
}

#[test]
fn an_unknown_material_is_told_with_what_may_be_meant() {
    let error =
        fault("MakeNamedMaterial \"wood\" \"string type\" \"diffuse\" NamedMaterial \"woood\" Shape \"sphere\"");
    assert!(error.to_string().ends_with("there is no material named 'woood'; did you mean 'wood'?"), "{error}");
    let (_, messages) = material("Material \"difuse\"");
    assert!(messages[0].ends_with("reflectance 0.5 is used; did you mean 'diffuse'?"), "{messages:?}");
}

#[test]
fn a_coated_diffuse_is_plastic_on_both_sides() {
    let MaterialDescription::TwoSided { front, back: None } =
        quiet("Material \"coateddiffuse\" \"float roughness\" 0.04")
    else {
        panic!("two-sided")
    };
    let MaterialDescription::Plastic { ior, nonlinear, .. } = inner(&front) else { panic!("plastic") };
    assert_eq!((*ior, *nonlinear), (1.5, true));
    assert_eq!(roughness(inner(&front)), Some((Paint::grey(0.2), None)));
}

#[test]
fn roughness_is_a_square_unless_said_otherwise_and_may_differ_by_direction() {
    let glass = |text: &str| roughness(&quiet(&format!("Material \"dielectric\" {text}")));
    assert_eq!(glass(""), None);
    assert_eq!(glass("\"float roughness\" 0.25"), Some((Paint::grey(0.5), None)));
    assert_eq!(glass("\"float roughness\" 0.25 \"bool remaproughness\" false"), Some((Paint::grey(0.25), None)));
    let both = glass("\"float uroughness\" 0.25 \"float vroughness\" 0.09");
    assert_eq!(both, Some((Paint::grey(0.5), Some(Paint::grey(0.3)))));
    assert_eq!(glass("\"float roughness\" 0.001 \"bool remaproughness\" \"false\""), None);
}

#[test]
fn metals_go_by_name_number_or_reflectance() {
    let index = |text: &str| match quiet(&format!("Material \"conductor\" {text}")) {
        MaterialDescription::Conductor { eta: Some(eta), k: Some(k), .. } => (eta.0, k.0),
        other => panic!("{other:?}"),
    };
    let (copper_eta, copper_k) = crate::import::named::conductor("Cu").expect("copper");
    assert_eq!(index(""), (copper_eta, copper_k));
    let (silver_eta, silver_k) = crate::import::named::conductor("Ag").expect("silver");
    let silver = "\"spectrum eta\" [\"metal-Ag-eta\"] \"spectrum k\" \"metal-Ag-k\"";
    assert_eq!(index(silver), (silver_eta, silver_k));
    assert_eq!(index("\"rgb eta\" [1 2 3] \"rgb k\" [4 5 6]"), ([1.0, 2.0, 3.0], [4.0, 5.0, 6.0]));
    // An index of 1 and k = 2 reflect 1/2 at normal incidence: k² / (4 + k²).
    assert_eq!(index("\"rgb reflectance\" [0.5 0.5 0.5]"), ([1.0; 3], [2.0; 3]));
    // The same brass by every other number that was measured [Querry 1985].
    let eta = "300 1.388 400 1.445 420 1.35 440 1.191 460 .994 480 .816 500 .686 520 .602 540 .549 560 .505 580 .468 \
               600 .45 620 .449 640 .444 660 .445 680 .444 700 .446 900 .523";
    let k = "300 1.731 400 1.805 420 1.786 440 1.797 460 1.883 480 2.046 500 2.25 520 2.464 540 2.668 560 2.86 \
             580 3.059 600 3.253 620 3.434 640 3.609 660 3.778 680 3.943 700 4.106 900 5.65";
    let measured = index(&format!("\"spectrum eta\" [{eta}] \"spectrum k\" [{k}]"));
    let named = index("\"spectrum eta\" \"metal-CuZn-eta\" \"spectrum k\" \"metal-CuZn-k\"");
    let close = |a: [f32; 3], b: [f32; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 0.01);
    assert!(close(named.0, measured.0) && close(named.1, measured.1), "{named:?} is not {measured:?}");
    let error = fault("Material \"conductor\" \"spectrum eta\" \"metal-Ah-eta\" Shape \"sphere\"");
    assert!(error.hint.expect("a hint").contains("did you mean 'metal-"));
}

#[test]
fn glasses_go_by_name_and_disperse() {
    let ior = |text: &str| match quiet(&format!("Material \"dielectric\" \"spectrum eta\" {text}")) {
        MaterialDescription::Glass { ior, .. } => ior,
        other => panic!("{other:?}"),
    };
    assert_eq!(ior("\"glass-BK7\""), Ior::Substance("bk7".into()));
    assert_eq!(ior("\"glass-F11\""), Ior::Substance("sf11".into()));
    let Ior::Formula(IorFormula::Abbe([d, number])) = ior("[400 1.54 500 1.53 600 1.52 700 1.51]") else {
        panic!("a formula")
    };
    assert!((d - 1.521_244).abs() < 1e-5 && (number - 0.521_244 / 0.017_014).abs() < 0.01, "{d} {number}");
    let (plastic, messages) = material("Material \"coateddiffuse\" \"spectrum eta\" \"glass-BK7\"");
    let MaterialDescription::TwoSided { front, .. } = &plastic else { panic!("{plastic:?}") };
    assert!(matches!(inner(front), MaterialDescription::Plastic { ior, .. } if (ior - 1.5168).abs() < 1e-4));
    assert!(messages[0].contains("disperses nothing"), "{messages:?}");
    let thin = quiet("Material \"thindielectric\" \"float eta\" 1.3");
    assert!(matches!(thin, MaterialDescription::ThinGlass { ior, .. } if ior == 1.3));
}

#[test]
fn spectra_come_as_pairs_or_from_files() {
    let pairs = quiet("Material \"diffuse\" \"spectrum reflectance\" [300 0.25 800 0.25]");
    let MaterialDescription::Diffuse { reflectance: Paint::Color(Color(grey)) } = pairs else { panic!("a colour") };
    assert!(grey.iter().all(|channel| (channel - 0.25).abs() < 1e-4));
    let main: &[u8] = b"Material \"diffuse\" \"spectrum reflectance\" \"a.spd\" Shape \"sphere\"";
    let imported = read_files(&[("a.pbrt", main), ("a.spd", b"# nm\n300 0.25\n800 0.25\n")]).expect("valid");
    assert_eq!(imported.warnings.len(), 0);
    assert!(
        fault("Material \"diffuse\" \"spectrum reflectance\" [400 1 300 1] Shape \"sphere\"")
            .message
            .contains("must rise")
    );
}

#[test]
fn mixes_blend_named_materials_by_their_amount() {
    let named =
        "MakeNamedMaterial \"a\" \"string type\" \"diffuse\" MakeNamedMaterial \"b\" \"string type\" \"conductor\"";
    let mix = quiet(&format!("{named} Material \"mix\" \"string materials\" [\"a\" \"b\"] \"float amount\" 0.3"));
    let blend = MaterialDescription::Blend {
        weight: Paint::grey(0.3),
        first: MaterialRef::Named("a".into()),
        second: MaterialRef::Named("b".into()),
    };
    assert_eq!(mix, blend);
    assert!(
        fault("Material \"mix\" \"string materials\" [\"a\" \"b\"] Shape \"sphere\"")
            .message
            .contains("no material named 'a'")
    );
}

#[test]
fn shapes_that_only_bound_media_are_left_out() {
    let text = "Material \"interface\" Shape \"sphere\" Material \"\" Shape \"sphere\"
        MakeNamedMaterial \"air\" \"string type\" \"interface\" NamedMaterial \"air\" Shape \"sphere\"";
    assert_eq!(clean(text).description.shapes.len(), 0);
}

#[test]
fn what_is_only_like_it_is_said_to_be() {
    for (sort, words) in [
        ("hair", "a diffuse surface"),
        ("measured", "a diffuse surface"),
        ("subsurface", "a diffuse surface"),
        ("coatedconductor", "the metal under it"),
    ] {
        let (_, messages) = material(&format!("Material \"{sort}\""));
        assert!(messages.len() == 1 && messages[0].contains(words), "{sort}: {messages:?}");
    }
}

#[test]
fn alpha_makes_holes_and_displacement_bumps() {
    let holes = "Texture \"leaf\" \"float\" \"imagemap\" \"string filename\" \"leaf.png\" Shape \"sphere\" \"texture alpha\" \"leaf\"";
    let material = shape(holes).material.expect("a material");
    let MaterialDescription::Mask { opacity, .. } = inner(&material) else { panic!("a mask") };
    assert_eq!(*opacity, Paint::Texture("leaf".into()));
    let bumps = "Texture \"b\" \"float\" \"imagemap\" \"string filename\" \"b.png\" \"float scale\" 3
        Material \"diffuse\" \"texture displacement\" \"b\" \"string normalmap\" \"n.png\"";
    let MaterialDescription::NormalMap { normals, material, .. } = quiet(bumps) else { panic!("a normal map") };
    assert_eq!(normals, "n.png");
    let MaterialDescription::BumpMap { height, scale, .. } = inner(&material) else { panic!("a bump map") };
    assert_eq!((height.as_str(), *scale), ("b", 3.0));
}

/// The texture `t` of a diffuse material, with all textures of the scene and what is said.
fn texture(text: &str) -> (Paint, Imported) {
    let text = format!("{text} Material \"diffuse\" \"texture reflectance\" \"t\" Shape \"sphere\"");
    let imported = scene(&text).expect("the scene is valid");
    let MaterialDescription::Diffuse { reflectance } = imported.description.materials.values().next().expect("one")
    else {
        panic!("diffuse")
    };
    (reflectance.clone(), imported)
}

fn named((paint, imported): &(Paint, Imported)) -> &TextureDescription {
    let Paint::Texture(name) = paint else { panic!("{paint:?} is no texture") };
    &imported.description.textures[name]
}

#[test]
fn an_image_map_has_its_file_wrapping_filter_and_mapping() {
    let found = texture(
        "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"a.png\" \"string wrap\" \"clamp\"
        \"string filter\" \"ewa\" \"string encoding\" \"linear\" \"float uscale\" 2 \"float vdelta\" 0.5",
    );
    let TextureDescription::Bitmap { file, raw, filter, wrap, to_uv, .. } = named(&found) else { panic!("a picture") };
    assert_eq!((file.as_str(), *raw, *filter, *wrap), ("a.png", true, TextureFilter::Mip, Wrap::Clamp));
    let uv = to_uv.0.transform_point3(glam::Vec3::new(1.0, 1.0, 0.0));
    assert_eq!((uv.x, uv.y), (2.0, 1.5));
    assert_eq!(messages(&found.1), Vec::<String>::new());
}

#[test]
fn constants_and_scales_of_constants_are_colours() {
    let text = "Texture \"half\" \"float\" \"constant\" \"float value\" 0.5
        Texture \"c\" \"spectrum\" \"constant\" \"rgb value\" [0.2 0.4 0.6]
        Texture \"t\" \"spectrum\" \"scale\" \"texture tex\" \"c\" \"texture scale\" \"half\"";
    assert_eq!(texture(text).0, Paint::Color(Color([0.1, 0.2, 0.3])));
}

#[test]
fn a_scaled_picture_is_a_product() {
    let found = texture("Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"a.png\" \"float scale\" 0.5");
    let TextureDescription::Product { first, second } = named(&found) else { panic!("a product") };
    assert_eq!((first, second), (&Paint::Texture("t".into()), &Paint::grey(0.5)));
}

#[test]
fn a_checkerboard_has_squares_of_one_unit() {
    let found = texture("Texture \"t\" \"spectrum\" \"checkerboard\" \"float uscale\" 4 \"rgb tex1\" [1 0 0]");
    let TextureDescription::Checkerboard { color0, color1, to_uv } = named(&found) else { panic!("a checkerboard") };
    assert_eq!((color0, color1), (&Paint::Color(Color([1.0, 0.0, 0.0])), &Paint::grey(0.0)));
    // Ours changes every half unit.
    assert_eq!(to_uv.0.transform_point3(glam::Vec3::X).x, 2.0);
}

#[test]
fn mixes_and_inversions_are_mixes() {
    let found = texture("Texture \"t\" \"spectrum\" \"mix\" \"rgb tex2\" [1 0 1] \"float amount\" 0.25");
    let TextureDescription::Mix { weight, second, .. } = named(&found) else { panic!("a mix") };
    assert_eq!((weight, second), (&Paint::grey(0.25), &Paint::Color(Color([1.0, 0.0, 1.0]))));
    let found = texture("Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"a\" \"bool invert\" true");
    let TextureDescription::Mix { weight, first, second } = named(&found) else { panic!("a mix") };
    assert_eq!((weight, first, second), (&Paint::Texture("t".into()), &Paint::grey(1.0), &Paint::grey(0.0)));
}

#[test]
fn patterns_that_we_lack_are_grey_and_circles_refused() {
    let (paint, imported) = texture("Texture \"t\" \"spectrum\" \"marble\"");
    assert_eq!(paint, Paint::grey(0.5));
    assert!(messages(&imported)[0].contains("texture 'marble' is not supported"));
    let circle = "Texture \"t\" \"spectrum\" \"scale\" \"texture tex\" \"t\"";
    let error = fault(&format!("{circle} Material \"diffuse\" \"texture reflectance\" \"t\" Shape \"sphere\""));
    assert!(error.message.contains("contains itself"), "{error}");
    let error = fault("Material \"diffuse\" \"texture reflectance\" \"t\" Shape \"sphere\"");
    assert!(error.message.contains("there is no texture named 't'"), "{error}");
}

#[test]
fn materials_of_version_3_are_read_with_a_word() {
    for (text, is_right) in [
        (
            "matte\" \"rgb Kd\" [1 0 0]",
            (|m| matches!(m, MaterialDescription::Diffuse { .. })) as fn(&MaterialDescription) -> bool,
        ),
        ("matte\" \"float sigma\" 20", |m| matches!(m, MaterialDescription::RoughDiffuse { .. })),
        ("mirror", |m| matches!(m, MaterialDescription::Mirror { .. })),
        ("glass\" \"float index\" 1.3", |m| matches!(m, MaterialDescription::Glass { ior, .. } if *ior == 1.3)),
        ("metal", |m| matches!(m, MaterialDescription::Conductor { roughness: Some(_), .. })),
        ("plastic", |m| matches!(m, MaterialDescription::TwoSided { .. })),
        ("substrate", |m| matches!(m, MaterialDescription::TwoSided { .. })),
        ("uber\" \"rgb opacity\" [0.5 0.5 0.5]", |m| matches!(m, MaterialDescription::Mask { .. })),
        ("uber\" \"rgb Kt\" [1 1 1]", |m| matches!(m, MaterialDescription::Glass { .. })),
        ("translucent", |m| matches!(m, MaterialDescription::DiffuseTransmission { .. })),
        ("disney\" \"float metallic\" 1", |m| matches!(m, MaterialDescription::Principled(_))),
    ] {
        let (material, messages) =
            material(&format!("Material \"{text}{}", if text.contains('"') { "" } else { "\"" }));
        assert!(is_right(&material), "{text}: {material:?}");
        assert!(messages.len() == 1 && messages[0].contains("pbrt-v3"), "{text}: {messages:?}");
    }
}
