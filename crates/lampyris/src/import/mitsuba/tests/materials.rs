use super::*;
use crate::scene::description::{Color, Ior, MicrofacetDistribution, Roughness, TextureDescription, WardVariant};

fn roughness_of(material: MaterialDescription) -> Roughness {
    match material {
        MaterialDescription::Glass { roughness: Some(roughness), .. }
        | MaterialDescription::Conductor { roughness: Some(roughness), .. }
        | MaterialDescription::Plastic { roughness: Some(roughness), .. } => roughness,
        other => panic!("{other:?} is not rough"),
    }
}

/// The material of a shape whose BSDF is warned of once, and the warning.
fn approximated(bsdf: &str) -> (MaterialDescription, String) {
    let imported = scene(&format!("<shape type='sphere'>{bsdf}</shape>")).expect("valid");
    let found = messages(&imported);
    assert_eq!(found.len(), 1, "{found:?}");
    (inner(imported.description.shapes[0].material.as_ref().expect("one")).clone(), found[0].clone())
}

/// Reads the content of a scene of version 0.6.
fn old(content: &str) -> Imported {
    let text = format!("<scene version='0.6.0'>{content}</scene>");
    read_files(&[("a.xml", &text)], &[]).expect("valid")
}

#[test]
fn rough_surfaces_are_beckmanns_of_a_tenth_by_default() {
    let default = Roughness {
        alpha: Paint::grey(0.1),
        alpha_v: None,
        distribution: MicrofacetDistribution::Beckmann,
        multiple_scattering: false,
    };
    assert_eq!(roughness_of(material("<bsdf type='roughdielectric'/>")), default);
    assert_eq!(roughness_of(front("<bsdf type='roughplastic'/>")), default);
    assert_eq!(roughness_of(front("<bsdf type='roughconductor'/>")), default);
}

#[test]
fn a_rough_surface_may_have_two_roughnesses_and_another_distribution() {
    let found = roughness_of(front(
        "<bsdf type='roughconductor'><float name='alpha_u' value='0.2'/><float name='alpha_v' value='0.05'/>
         <string name='distribution' value='ggx'/><boolean name='sample_visible' value='false'/></bsdf>",
    ));
    assert_eq!((found.alpha, found.alpha_v), (Paint::grey(0.2), Some(Paint::grey(0.05))));
    assert_eq!(found.distribution, MicrofacetDistribution::Ggx);
}

#[test]
fn a_texture_may_give_the_roughness() {
    let found = roughness_of(material(
        "<bsdf type='roughdielectric'><texture name='alpha' type='bitmap'><string name='filename' value='a.png'/></texture></bsdf>",
    ));
    assert_eq!(found.alpha, Paint::Texture("texture-1".into()));
}

#[test]
fn distributions_we_lack_become_beckmanns_with_a_word() {
    for distribution in ["phong", "as"] {
        let bsdf = format!("<bsdf type='roughdielectric'><string name='distribution' value='{distribution}'/></bsdf>");
        let (material, warning) = approximated(&bsdf);
        assert_eq!(roughness_of(material).distribution, MicrofacetDistribution::Beckmann);
        assert!(warning.contains(distribution), "{warning}");
    }
}

#[test]
fn a_rough_mirror_reflects_everything() {
    let MaterialDescription::Conductor { eta, k, .. } = front("<bsdf type='roughconductor'/>") else {
        panic!("no metal")
    };
    assert_eq!((eta, k), (Some(Color::grey(0.0)), Some(Color::grey(1.0))));
}

#[test]
fn the_metal_of_the_old_version_is_copper_by_default() {
    let imported = old("<shape type='sphere'><bsdf type='conductor'/></shape>");
    let MaterialDescription::TwoSided { front, .. } =
        inner(imported.description.shapes[0].material.as_ref().expect("one")).clone()
    else {
        panic!("not black from behind")
    };
    let MaterialDescription::Conductor { eta: Some(eta), .. } = inner(&front).clone() else { panic!("no metal") };
    assert!(eta.0[0] < 0.3 && eta.0[2] > 1.0, "{eta:?}");
}

#[test]
fn the_surfaces_of_the_old_version_keep_their_defaults() {
    let rough = front("<bsdf type='roughdiffuse'/>");
    let wanted =
        MaterialDescription::RoughDiffuse { reflectance: Paint::grey(0.5), alpha: Paint::grey(0.2), fast: false };
    assert_eq!(rough, wanted);
    let phong = front("<bsdf type='phong'/>");
    let wanted = MaterialDescription::Phong {
        diffuse: Paint::grey(0.5),
        specular: Paint::grey(0.2),
        exponent: Paint::grey(30.0),
    };
    assert_eq!(phong, wanted);
    let ward = |variant| MaterialDescription::Ward {
        variant,
        diffuse: Paint::grey(0.5),
        specular: Paint::grey(0.2),
        alpha_u: Paint::grey(0.1),
        alpha_v: Paint::grey(0.1),
    };
    assert_eq!(front("<bsdf type='ward'/>"), ward(WardVariant::Balanced));
    let duer = "<bsdf type='ward'><string name='variant' value='ward-duer'/></bsdf>";
    assert_eq!(front(duer), ward(WardVariant::WardDuer));
    let wrong = "<shape type='cube'><bsdf type='ward'><string name='variant' value='x'/></bsdf></shape>";
    assert!(fault(wrong).message.contains("variant"));
}

#[test]
fn leaves_transmit_and_do_not_reflect() {
    let leaf = material("<bsdf type='difftrans'><rgb name='transmittance' value='0.1 0.2 0.3'/></bsdf>");
    let wanted = MaterialDescription::DiffuseTransmission {
        reflectance: Paint::grey(0.0),
        transmittance: Color([0.1, 0.2, 0.3]).into(),
    };
    assert_eq!(leaf, wanted);
}

#[test]
fn a_principled_material_is_black_from_behind_unless_it_transmits() {
    let MaterialDescription::Principled(found) = front(
        "<bsdf type='principled'><rgb name='base_color' value='0.1 0.2 0.3'/><float name='metallic' value='0.7'/>
         <float name='roughness' value='0.2'/><float name='specular' value='0.4'/><float name='clearcoat_sampling_rate' value='1'/></bsdf>",
    ) else {
        panic!("not principled")
    };
    assert_eq!((found.base_color.clone(), found.metallic.clone()), (Color([0.1, 0.2, 0.3]).into(), Paint::grey(0.7)));
    assert_eq!((found.roughness.clone(), found.specular, found.eta), (Paint::grey(0.2), 0.4, None));
    let clear = "<bsdf type='principled'><float name='spec_trans' value='0.9'/><float name='eta' value='1.4'/></bsdf>";
    let MaterialDescription::Principled(found) = material(clear) else { panic!("not principled") };
    assert_eq!((found.spec_trans.clone(), found.eta), (Paint::grey(0.9), Some(1.4)));
}

#[test]
fn the_principled_defaults_are_mitsubas() {
    let MaterialDescription::Principled(found) = front("<bsdf type='principled'/>") else { panic!("not principled") };
    assert_eq!(*found, Default::default());
    let MaterialDescription::PrincipledThin(found) = material("<bsdf type='principledthin'/>") else {
        panic!("not principled")
    };
    assert_eq!(*found, Default::default());
}

const NORMALS: &str = "<texture name='normalmap' type='bitmap'><boolean name='raw' value='true'/><string name='filename' value='n.png'/></texture>";

#[test]
fn a_normal_map_turns_what_it_covers() {
    let nested = format!("<bsdf type='normalmap'>{NORMALS}<bsdf type='diffuse'/></bsdf>");
    let MaterialDescription::NormalMap { normals, strength, material: covered } = front(&nested) else {
        panic!("no normal map")
    };
    assert_eq!((normals.as_str(), strength, inner(&covered)), ("texture-1", 1.0, &grey()));
    let two = format!("<bsdf type='twosided'>{nested}</bsdf>");
    let MaterialDescription::TwoSided { front: inside, back: None } = material(&two) else { panic!("not two-sided") };
    assert!(matches!(inner(&inside), MaterialDescription::NormalMap { .. }));
}

#[test]
fn a_normal_map_may_name_its_picture_itself() {
    let imported = clean(
        "<shape type='cube'><bsdf type='normalmap'><string name='filename' value='n.png'/><bsdf type='dielectric'/></bsdf></shape>",
    );
    let MaterialDescription::NormalMap { normals, .. } =
        inner(imported.description.shapes[0].material.as_ref().expect("one"))
    else {
        panic!("no normal map")
    };
    let picture = &imported.description.textures[normals];
    assert!(matches!(picture, TextureDescription::Bitmap { file, raw: true, .. } if file == "n.png"));
    let error = fault("<shape type='cube'><bsdf type='normalmap'><bsdf type='diffuse'/></bsdf></shape>");
    assert!(error.message.contains("normals"), "{error}");
}

#[test]
fn a_bump_map_has_a_factor_of_its_own_or_around_its_texture() {
    let heights = "<texture type='bitmap'><string name='filename' value='h.png'/></texture>";
    let scale_of = |bsdf: &str| match front(bsdf) {
        MaterialDescription::BumpMap { height, scale, .. } => (height, scale),
        other => panic!("{other:?} has no bumps"),
    };
    let own = format!("<bsdf type='bumpmap'>{heights}<float name='scale' value='3'/><bsdf type='diffuse'/></bsdf>");
    assert_eq!(scale_of(&own), ("texture-1".to_string(), 3.0));
    let around = format!(
        "<bsdf type='bumpmap'><texture type='scale'><float name='scale' value='5'/>{heights}</texture><bsdf type='diffuse'/></bsdf>"
    );
    assert_eq!(scale_of(&around), ("texture-1".to_string(), 5.0));
}

#[test]
fn a_coat_over_paint_is_plastic_and_over_metal_nothing() {
    let coat = |plugin: &str, base: &str| {
        approximated(&format!("<bsdf type='{plugin}'><float name='int_ior' value='1.7'/><bsdf type='{base}'/></bsdf>"))
    };
    let (material, warning) = coat("coating", "diffuse");
    let MaterialDescription::TwoSided { front, .. } = material else { panic!("not black from behind") };
    assert!(matches!(inner(&front), MaterialDescription::Plastic { ior: 1.7, roughness: None, .. }), "{front:?}");
    assert!(warning.contains("plastic of its base"), "{warning}");
    let (material, _) = coat("roughcoating", "roughdiffuse");
    let MaterialDescription::TwoSided { front, .. } = material else { panic!("not black from behind") };
    assert!(matches!(inner(&front), MaterialDescription::Plastic { roughness: Some(_), .. }));
    let (material, warning) = coat("coating", "conductor");
    let MaterialDescription::TwoSided { front, .. } = material else { panic!("not black from behind") };
    assert!(matches!(inner(&front), MaterialDescription::Mirror { .. }) && warning.contains("used alone"));
}

#[test]
fn a_scattering_slab_keeps_the_energy_of_its_albedo() {
    let slab = "<bsdf type='hk'><rgb name='sigma_s' value='3'/><rgb name='sigma_a' value='1'/><float name='thickness' value='100'/></bsdf>";
    let (material, _) = approximated(slab);
    let MaterialDescription::DiffuseTransmission { reflectance, transmittance } = material else { panic!("no slab") };
    assert_eq!((reflectance, transmittance), (Paint::grey(0.375), Paint::grey(0.375)));
}

#[test]
fn filters_of_polarised_light_let_half_or_all_pass() {
    for (plugin, opacity) in [("polarizer", 0.5), ("circular", 0.5), ("retarder", 0.0)] {
        let (material, _) = approximated(&format!("<bsdf type='{plugin}'><float name='theta' value='1'/></bsdf>"));
        let MaterialDescription::Mask { opacity: found, .. } = material else { panic!("no pane") };
        assert_eq!(found, Paint::grey(opacity), "{plugin}");
    }
}

#[test]
fn glass_and_polarised_plastic_are_taken_for_what_they_mean() {
    let (material, warning) = approximated("<bsdf type='glass'><float name='int_ior' value='1.3'/></bsdf>");
    assert!(
        matches!(material, MaterialDescription::Glass { ior: Ior::Number(1.3), .. }) && warning.contains("'glass'")
    );
    let (material, _) = approximated("<bsdf type='pplastic'><float name='alpha' value='0.3'/></bsdf>");
    let MaterialDescription::TwoSided { front, .. } = material else { panic!("not black from behind") };
    assert_eq!(roughness_of(inner(&front).clone()).alpha, Paint::grey(0.3));
}

#[test]
fn what_we_lack_is_a_diffuse_surface_of_its_colour_or_what_it_covers() {
    let (material, warning) = approximated("<bsdf type='hair'/>");
    assert_eq!(material, one_sided(grey()));
    assert!(warning.contains("bsdf 'hair' is not supported"), "{warning}");
    let (material, _) = approximated("<bsdf type='irawan'><rgb name='reflectance' value='0.1 0.2 0.3'/></bsdf>");
    assert_eq!(material, one_sided(MaterialDescription::Diffuse { reflectance: Color([0.1, 0.2, 0.3]).into() }));
    let (material, _) = approximated("<bsdf type='sssbrdf'><bsdf type='dielectric'/></bsdf>");
    assert!(matches!(material, MaterialDescription::Glass { .. }));
}
