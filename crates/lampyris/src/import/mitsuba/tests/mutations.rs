use proptest::prelude::*;

use super::*;

const VALID: &str = r##"<scene version="0.6.0">
<default name="n" value="3"/><path value="."/>
<integrator type="moment"><integrator type="path"><integer name="maxDepth" value="$n"/></integrator></integrator>
<sensor type="thinlens"><float name="fov" value="40"/><float name="apertureRadius" value="0.1"/>
 <transform name="toWorld"><lookat origin="0 0 -3" target="0,0,0" up="0 1 0"/></transform>
 <film type="hdrfilm"><integer name="width" value="64"/><integer name="cropWidth" value="16"/>
 <integer name="cropOffsetX" value="8"/><rfilter type="tent"/></film></sensor>
<bsdf type="twosided" id="a"><bsdf type="blendbsdf"><float name="weight" value="0.5"/>
 <bsdf type="diffuse"><spectrum name="reflectance" value="400:0.1, 500:0.2"/></bsdf><bsdf type="conductor"/></bsdf></bsdf>
<alias id="a" as="b"/>
<shape type="disk"><ref id="b"/><transform name="toWorld"><matrix value="1 0 0 0 2 0 0 0 1"/><rotate x="1" angle="9"/></transform>
 <emitter type="area"><blackbody name="radiance" temperature="3000K"/></emitter></shape>
<shape type="obj"><string name="filename" value="m.obj"/><bsdf type="mask"><texture name="opacity" type="bitmap">
 <string name="filename" value="t.png"/></texture><bsdf type="roughplastic"/></bsdf></shape>
<texture type="scale" id="t"><float name="scale" value="0.5"/><texture type="checkerboard"><rgb name="color0" value="1"/>
 <float name="uscale" value="2"/></texture></texture>
<shape type="shapegroup" id="g"><shape type="cube"><bsdf type="bumpmap"><ref id="t"/><bsdf type="coating"><bsdf type="roughdiffuse"/>
 </bsdf></bsdf></shape></shape><shape type="instance"><ref id="g"/></shape>
<shape type="sphere"><bsdf type="normalmap"><string name="filename" value="n.png"/><bsdf type="hk"/></bsdf>
 <sensor type="irradiancemeter"/></shape>
<emitter type="sunsky"><integer name="month" value="5"/><float name="hour" value="9"/></emitter>
<emitter type="projector"><ref name="irradiance" id="t"/></emitter><emitter type="collimated"/>
<emitter type="envmap"><string name="filename" value="e.exr"/></emitter>
<emitter type="spot"><srgb name="intensity" value="#ff8800"/></emitter><!-- comment -- -->
<include filename="a.xml"/></scene>"##;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn a_damaged_file_never_panics(
        edits in proptest::collection::vec((any::<prop::sample::Index>(), 0usize..12, "[ -~]{0,4}|\"|<|\\$|9e9|-1|é"), 1..4),
    ) {
        let mut text = VALID.replace("<include filename=\"a.xml\"/>", "");
        for (at, removed, inserted) in &edits {
            let from = at.index(text.len());
            let to = (from + removed).min(text.len());
            if text.is_char_boundary(from) && text.is_char_boundary(to) {
                text.replace_range(from..to, inserted);
            }
        }
        if let Err(error) = read_files(&[("a.xml", &text)], &[]) {
            prop_assert!(!error.to_string().is_empty());
        }
    }

    #[test]
    fn shuffled_pieces_never_panic(order in proptest::collection::vec(any::<prop::sample::Index>(), 1..40)) {
        let pieces: Vec<&str> = VALID.split_inclusive('>').collect();
        let text: String = order.iter().map(|index| *index.get(&pieces)).collect();
        let _ = read_files(&[("a.xml", &format!("<scene version='3'>{text}</scene>"))], &[]);
    }

    #[test]
    fn arbitrary_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        let files = HashMap::from([(PathBuf::from("a.xml"), bytes)]);
        let _ = read_from(&Memory(files), Path::new("a.xml"), &Options::default());
    }
}

#[test]
fn the_file_they_damage_is_valid_but_for_its_cycle() {
    let error = read_files(&[("a.xml", VALID)], &[]).expect_err("a cycle");
    assert!(error.message.contains("includes itself"), "{error}");
    read_files(&[("a.xml", &VALID.replace("<include filename=\"a.xml\"/>", ""))], &[]).expect("valid");
}
