use super::*;
use crate::scene::description::{Channel, Color, Ior, IorFormula, Paint, TextureDescription, TextureFilter, Wrap};

/// The triangle with this material, and a texture of a picture beside it.
fn with_material(material: Value) -> Imported {
    good(&[
        ("/images", json!([{ "uri": "a%20b.png" }])),
        ("/samplers", json!([{ "magFilter": 9729, "minFilter": 9729, "wrapS": 33071 }])),
        ("/textures", json!([{ "source": 0, "sampler": 0 }])),
        ("/materials", json!([material])),
        ("/meshes/0/primitives/0/material", json!(0)),
    ])
}

fn principled(imported: &Imported) -> &crate::scene::description::Principled {
    match front(material(imported)) {
        MaterialDescription::Principled(principled) => principled,
        other => panic!("not principled: {other:?}"),
    }
}

#[test]
fn factors_and_textures_become_paints() {
    let imported = with_material(json!({
        "name": "wood",
        "pbrMetallicRoughness": {
            "baseColorFactor": [0.5, 1, 1, 1], "baseColorTexture": { "index": 0 },
            "metallicFactor": 0, "metallicRoughnessTexture": { "index": 0 }
        }
    }));
    let textures = &imported.description.textures;
    let principled = principled(&imported);
    assert_eq!(principled.base_color, Paint::Texture("wood-base-color".into()));
    assert_eq!(principled.metallic, Paint::grey(0.0));
    assert_eq!(principled.roughness, Paint::Texture("texture0-green".into()));
    let first = Paint::Color(Color([0.5, 1.0, 1.0]));
    let product = TextureDescription::Product { first, second: Paint::Texture("texture0".into()) };
    assert_eq!(textures["wood-base-color"], product);
    let bitmap = TextureDescription::Bitmap {
        file: "a b.png".into(),
        raw: true,
        channel: Channel::Green,
        filter: TextureFilter::Bilinear,
        wrap: Wrap::Clamp,
        wrap_v: Some(Wrap::Repeat),
        to_uv: Default::default(),
    };
    assert_eq!(textures["texture0-green"], bitmap);
    assert_eq!(messages(&imported)[..0], [""; 0]);
}

#[test]
fn the_default_material_is_the_formats_own() {
    let imported = good(&[]);
    let principled = principled(&imported);
    assert_eq!((&principled.metallic, &principled.roughness), (&Paint::grey(1.0), &Paint::grey(1.0)));
    assert_eq!(principled.base_color, Paint::grey(1.0));
}

#[test]
fn a_normal_texture_turns_the_normal_of_both_sides() {
    let imported = with_material(json!({ "normalTexture": { "index": 0, "scale": 0.5 } }));
    let MaterialDescription::NormalMap { normals, strength, .. } = front(material(&imported)) else {
        panic!("{:?}", material(&imported))
    };
    assert_eq!((normals.as_str(), *strength), ("texture0-raw", 0.5));
}

#[test]
fn a_smooth_clear_body_is_glass_tinted_for_its_thickness() {
    let imported = with_material(json!({
        "pbrMetallicRoughness": { "metallicFactor": 0, "roughnessFactor": 0 },
        "extensions": {
            "KHR_materials_transmission": { "transmissionFactor": 1 },
            "KHR_materials_ior": { "ior": 1.33 },
            "KHR_materials_volume": {
                "thicknessFactor": 2, "attenuationDistance": 1, "attenuationColor": [0.25, 1, 1] }
        }
    }));
    let MaterialDescription::Glass { ior, transmittance, roughness: None, .. } = material(&imported) else {
        panic!("{:?}", material(&imported))
    };
    assert_eq!(*ior, 1.33);
    // Over a way of 2, 0.25²; half of the way is told of at each of two boundaries.
    assert_eq!(*transmittance, Paint::Color(Color([0.25, 1.0, 1.0])));
    assert!(messages(&imported)[0].contains("absorption"), "{:?}", messages(&imported));
}

#[test]
fn a_clear_body_disperses_by_its_abbe_number() {
    let imported = with_material(json!({
        "pbrMetallicRoughness": { "metallicFactor": 0, "roughnessFactor": 0 },
        "extensions": {
            "KHR_materials_transmission": { "transmissionFactor": 1 },
            "KHR_materials_ior": { "ior": 2.42 },
            "KHR_materials_volume": { "thicknessFactor": 1 },
            "KHR_materials_dispersion": { "dispersion": 0.36 }
        }
    }));
    let MaterialDescription::Glass { ior, .. } = material(&imported) else { panic!("{:?}", material(&imported)) };
    assert_eq!(*ior, Ior::Formula(IorFormula::Abbe([2.42, 20.0 / 0.36])));
    assert!(messages(&imported).iter().all(|message| !message.contains("dispersion")), "{:?}", messages(&imported));
}

#[test]
fn the_alpha_of_rough_glass_is_the_square_of_the_roughness() {
    let imported = with_material(json!({
        "pbrMetallicRoughness": { "metallicFactor": 0, "roughnessFactor": 0.5 },
        "extensions": {
            "KHR_materials_transmission": { "transmissionFactor": 1 },
            "KHR_materials_volume": { "thicknessFactor": 1 }
        }
    }));
    let MaterialDescription::Glass { roughness: Some(roughness), .. } = material(&imported) else {
        panic!("{:?}", material(&imported))
    };
    assert_eq!(roughness.alpha, Paint::grey(0.25));
}

#[test]
fn transmission_without_thickness_is_a_thin_sheet() {
    let of = |roughness: f32| {
        with_material(json!({
            "pbrMetallicRoughness": { "metallicFactor": 0, "roughnessFactor": roughness },
            "extensions": { "KHR_materials_transmission": { "transmissionFactor": 1 } }
        }))
    };
    assert!(matches!(material(&of(0.0)), MaterialDescription::ThinGlass { .. }));
    assert!(matches!(material(&of(0.5)), MaterialDescription::PrincipledThin(_)));
}

#[test]
fn emission_has_its_strength_and_is_the_light_of_the_scene_unless_it_is_a_picture() {
    let strong = with_material(json!({
        "emissiveFactor": [1, 0.5, 0],
        "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": 4 } }
    }));
    let emission = strong.description.shapes[0].emission.as_ref().expect("it emits");
    assert_eq!(emission.radiance, Some(Paint::Color(Color([1.0, 0.5, 0.0]))));
    assert_eq!((emission.scale, emission.two_sided), (4.0, false));
    assert!(strong.description.lights.is_empty());
    let picture = with_material(json!({ "emissiveFactor": [1, 1, 1], "emissiveTexture": { "index": 0 } }));
    assert!(picture.description.shapes[0].emission.is_some());
    assert_eq!(picture.description.lights.len(), 1);
}

#[test]
fn alpha_makes_holes_where_the_mode_says_so() {
    let of = |mode: &str, alpha: f32| {
        let imported = with_material(json!({
            "alphaMode": mode, "pbrMetallicRoughness": { "baseColorFactor": [1, 1, 1, alpha] } }));
        match material(&imported) {
            MaterialDescription::Mask { opacity, .. } => Some(opacity.clone()),
            _ => None,
        }
    };
    assert_eq!(of("OPAQUE", 0.3), None);
    assert_eq!(of("BLEND", 0.3), Some(Paint::grey(0.3)));
    assert_eq!(of("MASK", 0.3), Some(Paint::grey(0.0)));
    assert_eq!(of("MASK", 0.6), None);
}

#[test]
fn a_masks_picture_is_cut_off() {
    let imported = with_material(json!({
        "alphaMode": "MASK", "alphaCutoff": 0.25,
        "pbrMetallicRoughness": { "baseColorFactor": [1, 1, 1, 0.5], "baseColorTexture": { "index": 0 } } }));
    let MaterialDescription::Mask { opacity: Paint::Texture(holes), .. } = material(&imported) else {
        panic!("a mask")
    };
    let TextureDescription::Threshold { texture: Paint::Texture(product), least } =
        &imported.description.textures[holes]
    else {
        panic!("a threshold")
    };
    assert_eq!(*least, 0.25);
    let TextureDescription::Product { first, .. } = &imported.description.textures[product] else {
        panic!("a product")
    };
    assert_eq!(*first, Paint::grey(0.5));
}

#[test]
fn what_is_approximated_is_said() {
    for (name, extension) in [
        ("KHR_materials_clearcoat", json!({ "clearcoatFactor": 1 })),
        ("KHR_materials_specular", json!({ "specularFactor": 0.5 })),
        ("KHR_materials_sheen", json!({ "sheenColorFactor": [1, 0, 0] })),
        ("KHR_materials_iridescence", json!({ "iridescenceFactor": 1 })),
        ("KHR_materials_dispersion", json!({ "dispersion": 0.1 })),
        ("KHR_materials_anisotropy", json!({ "anisotropyStrength": 0.5 })),
        ("KHR_materials_unlit", json!({})),
        ("KHR_materials_pbrSpecularGlossiness", json!({ "glossinessFactor": 0.5 })),
    ] {
        let imported = with_material(json!({ "extensions": { name: extension } }));
        assert!(messages(&imported)[0].contains(name), "{name}: {:?}", messages(&imported));
    }
}

#[test]
fn the_second_texture_coordinates_are_used_where_all_textures_ask_for_them() {
    let imported = good(&[
        ("/images", json!([{ "uri": "a.png" }])),
        ("/textures", json!([{ "source": 0 }])),
        ("/materials", json!([{ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0, "texCoord": 1 } } }])),
        ("/meshes/0/primitives/0", json!({ "attributes": { "POSITION": 0, "TEXCOORD_1": 1 }, "material": 0 })),
    ]);
    assert_eq!(mesh(&imported, 0).uvs.len(), 3);
}

#[test]
fn pictures_in_the_file_are_embedded() {
    let imported = good(&[
        ("/images", json!([{ "bufferView": 1, "mimeType": "image/png" }])),
        ("/textures", json!([{ "source": 0 }])),
        ("/materials", json!([{ "emissiveFactor": [1, 1, 1], "emissiveTexture": { "index": 0 } }])),
        ("/meshes/0/primitives/0/material", json!(0)),
    ]);
    assert_eq!(imported.embedded["a.gltf#image0"].len(), 24);
    let TextureDescription::Bitmap { file, .. } = &imported.description.textures["texture0"] else {
        panic!("a bitmap")
    };
    assert_eq!(file, "a.gltf#image0");
}
