use super::*;
use crate::scene::description::{Channel, Color, TextureDescription, TextureFilter, Wrap};

/// The textures of a diffuse surface of this reflectance, and the reflectance.
fn of(imported: &Imported) -> (Paint, Vec<TextureDescription>) {
    let shape = imported.description.shapes[0].material.as_ref().expect("a material");
    let MaterialDescription::TwoSided { front, .. } = inner(shape) else { panic!("not black from behind") };
    let MaterialDescription::Diffuse { reflectance } = inner(front) else { panic!("not diffuse") };
    (reflectance.clone(), imported.description.textures.values().cloned().collect())
}

fn surface(reflectance: &str) -> String {
    format!("<shape type='cube'><bsdf type='diffuse'>{reflectance}</bsdf></shape>")
}

fn bitmap(version: &str, more: &str) -> TextureDescription {
    let picture =
        format!("<texture name='reflectance' type='bitmap'><string name='filename' value='t.png'/>{more}</texture>");
    let text = format!("<scene version='{version}'>{}</scene>", surface(&picture));
    let imported = read_files(&[("a.xml", &text)], &[]).expect("valid");
    assert_eq!(messages(&imported), Vec::<String>::new());
    of(&imported).1.remove(0)
}

#[test]
fn the_old_version_blurs_what_is_far_away_and_the_new_one_does_not() {
    let filter = |version: &str, more: &str| match bitmap(version, more) {
        TextureDescription::Bitmap { filter, .. } => filter,
        other => panic!("{other:?} is no picture"),
    };
    assert_eq!(filter("3.0.0", ""), TextureFilter::Bilinear);
    assert_eq!(filter("0.6.0", ""), TextureFilter::Mip);
    assert_eq!(filter("0.6.0", "<string name='filterType' value='nearest'/>"), TextureFilter::Nearest);
    assert_eq!(filter("3.0.0", "<string name='filter_type' value='trilinear'/>"), TextureFilter::Mip);
}

#[test]
fn each_axis_may_have_its_own_rule_outside_the_picture() {
    let wraps = |version: &str, more: &str| match bitmap(version, more) {
        TextureDescription::Bitmap { wrap, wrap_v, .. } => (wrap, wrap_v),
        other => panic!("{other:?} is no picture"),
    };
    assert_eq!(wraps("3.0.0", "<string name='wrap_mode' value='mirror'/>"), (Wrap::Mirror, None));
    let both = "<string name='wrapModeU' value='clamp'/><string name='wrapModeV' value='zero'/>";
    assert_eq!(wraps("0.6.0", both), (Wrap::Clamp, Some(Wrap::Black)));
    assert_eq!(wraps("0.6.0", "<string name='wrapModeV' value='one'/>"), (Wrap::Repeat, Some(Wrap::White)));
}

#[test]
fn one_channel_of_a_picture_may_be_taken() {
    let channel = |name: &str| match bitmap("0.6.0", &format!("<string name='channel' value='{name}'/>")) {
        TextureDescription::Bitmap { channel, .. } => channel,
        other => panic!("{other:?} is no picture"),
    };
    assert_eq!(["r", "g", "b", "a"].map(channel), [Channel::Red, Channel::Green, Channel::Blue, Channel::Alpha]);
}

#[test]
fn a_gamma_of_one_means_linear_numbers() {
    let raw = |more: &str| match bitmap("0.6.0", more) {
        TextureDescription::Bitmap { raw, .. } => raw,
        other => panic!("{other:?} is no picture"),
    };
    assert!(raw("<float name='gamma' value='1'/>") && !raw("<float name='gamma' value='-1'/>") && !raw(""));
}

#[test]
fn scales_and_offsets_of_the_old_version_move_the_coordinates() {
    let TextureDescription::Bitmap { to_uv, .. } =
        bitmap("0.6.0", "<float name='uscale' value='3'/><float name='voffset' value='0.25'/>")
    else {
        panic!("no picture")
    };
    // Ours has v run upwards.
    let at = to_uv.0.transform_point3(glam::Vec3::new(1.0, 0.5, 0.0));
    close(at.to_array(), [3.0, 0.25, 0.0]);
}

#[test]
fn a_scaled_texture_is_a_product_and_a_scaled_colour_a_colour() {
    let picture = "<texture type='bitmap'><string name='filename' value='t.png'/></texture>";
    let scaled =
        format!("<texture name='reflectance' type='scale'><float name='scale' value='0.5'/>{picture}</texture>");
    let (paint, textures) = of(&clean(&surface(&scaled)));
    assert_eq!(paint, Paint::Texture("texture-2".into()));
    let product = TextureDescription::Product { first: Paint::Texture("texture-1".into()), second: Paint::grey(0.5) };
    assert_eq!(textures[1], product);
    let flat = "<texture name='reflectance' type='scale'><rgb name='value' value='0.2 0.4 0.6'/><float name='scale' value='0.5'/></texture>";
    let (paint, textures) = of(&clean(&surface(flat)));
    assert_eq!((paint, textures.len()), (Color([0.1, 0.2, 0.3]).into(), 0));
}

#[test]
fn a_checkerboard_may_be_made_of_textures() {
    let picture = "<texture name='color1' type='bitmap'><string name='filename' value='t.png'/></texture>";
    let board = format!("<texture name='reflectance' type='checkerboard'>{picture}</texture>");
    let imported = clean(&surface(&board));
    let Paint::Texture(name) = of(&imported).0 else { panic!("no texture") };
    let TextureDescription::Checkerboard { color0, color1, .. } = &imported.description.textures[&name] else {
        panic!("no checkerboard")
    };
    assert_eq!((color0, color1), (&Paint::grey(0.4), &Paint::Texture("texture-1".into())));
}

#[test]
fn the_vertices_may_give_the_colour() {
    for texture in
        ["type='mesh_attribute'><string name='name' value='vertex_color'/></texture>", "type='vertexcolors'></texture>"]
    {
        let (paint, textures) = of(&clean(&surface(&format!("<texture name='reflectance' {texture}"))));
        assert_eq!((paint, textures), (Paint::Texture("texture-1".into()), vec![TextureDescription::VertexColor {}]));
    }
    let of_faces =
        surface("<texture name='reflectance' type='mesh_attribute'><string name='name' value='face_color'/></texture>");
    assert!(messages(&scene(&of_faces).expect("valid"))[0].contains("face_color"));
}

#[test]
fn a_raw_constant_is_a_colour() {
    let (paint, _) = of(&clean(&surface(
        "<texture name='reflectance' type='rawconstant'><vector name='value' value='0.1 0.2 0.3'/></texture>",
    )));
    assert_eq!(paint, Color([0.1, 0.2, 0.3]).into());
}

#[test]
fn textures_we_lack_are_flat_with_a_word() {
    let flat = |texture: &str| {
        let imported = scene(&surface(&format!("<texture name='reflectance' {texture}</texture>"))).expect("valid");
        assert_eq!(imported.warnings.len(), 1);
        of(&imported).0
    };
    assert_eq!(flat("type='gridtexture'><rgb name='color0' value='0.7'/>"), Paint::grey(0.7));
    assert_eq!(flat("type='wireframe'>"), Paint::grey(0.5));
    assert_eq!(flat("type='curvature'>"), Paint::grey(0.5));
    assert_eq!(flat("type='volume'>"), Paint::grey(0.5));
}

#[test]
fn a_texture_that_contains_itself_is_refused() {
    let ring = "<texture type='checkerboard' id='a'><ref name='color0' id='a'/></texture>";
    let used = surface("<ref name='reflectance' id='a'/>");
    assert!(fault(&format!("{ring}{used}")).message.contains("contains itself"));
    let bump = "<shape type='cube'><bsdf type='bumpmap'><bsdf type='diffuse'/><ref id='a'/></bsdf></shape>";
    let ring = "<texture type='scale' id='a'><ref id='a'/></texture>";
    assert!(fault(&format!("{ring}{bump}")).message.contains("contains itself"));
}

#[test]
fn daylight_may_be_scaled_and_coloured() {
    let (paint, _) =
        of(&clean(&surface("<spectrum name='reflectance' type='d65'><float name='scale' value='0.25'/></spectrum>")));
    assert_eq!(paint, Paint::grey(0.25));
}
