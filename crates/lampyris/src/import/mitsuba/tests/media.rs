use super::*;
use crate::scene::description::{Color, MediumDescription, PhaseDescription};

const FOG: &str = "<medium type='homogeneous' id='fog'><rgb name='albedo' value='0.9, 0.5, 0.1'/>
    <float name='sigma_t' value='3'/><float name='scale' value='2'/><phase type='hg'><float name='g' value='0.5'/></phase></medium>";

fn media(content: &str) -> crate::scene::SceneDescription {
    let imported = scene(content).expect("valid");
    assert_eq!(messages(&imported), [""; 0]);
    imported.description
}

#[test]
fn a_homogeneous_medium_keeps_its_coefficients_and_phase() {
    let description =
        media(&format!("{FOG}<shape type='cube'><ref name='interior' id='fog'/><bsdf type='null'/></shape>"));
    let expected = MediumDescription::Homogeneous {
        sigma_t: Some(Color::grey(3.0)),
        albedo: Some(Color([0.9, 0.5, 0.1])),
        sigma_s: None,
        sigma_a: None,
        scale: 2.0,
        phase: PhaseDescription::HenyeyGreenstein { g: 0.5 },
        delay: 0.0,
        delay_seconds: None,
    };
    assert_eq!(description.media.get("fog"), Some(&expected));
    assert_eq!(description.shapes[0].interior.as_deref(), Some("fog"));
    assert_eq!(description.medium, None);
}

#[test]
fn a_medium_in_place_and_one_of_0_6_are_read() {
    let description = media(
        "<shape type='sphere'><medium type='homogeneous' name='interior'><rgb name='sigmaS' value='1, 2, 3'/>
         <spectrum name='sigmaA' value='0.5'/><phase type='blendphase'><float name='weight' value='0.25'/>
         <phase type='rayleigh'/><phase type='tabphase'><string name='values' value='1, 2, 3'/></phase></phase></medium></shape>",
    );
    let name = description.shapes[0].interior.clone().expect("a medium");
    let MediumDescription::Homogeneous { sigma_s, sigma_a, sigma_t, phase, .. } = &description.media[&name] else {
        panic!("not homogeneous");
    };
    assert_eq!((*sigma_s, *sigma_a, *sigma_t), (Some(Color([1.0, 2.0, 3.0])), Some(Color::grey(0.5)), None));
    let second = PhaseDescription::Tabulated { values: vec![1.0, 2.0, 3.0] };
    let (first, second) = (Box::new(PhaseDescription::Rayleigh {}), Box::new(second));
    assert_eq!(*phase, PhaseDescription::Blend { weight: 0.25, first, second });
}

#[test]
fn what_the_sensor_stands_in_is_around_everything_unless_a_shape_holds_it() {
    let sensor = "<sensor type='perspective'><ref id='fog'/></sensor>";
    assert_eq!(media(&format!("{FOG}{sensor}")).medium.as_deref(), Some("fog"));
    let held = "<shape type='cube'><ref name='interior' id='fog'/></shape>";
    assert_eq!(media(&format!("{FOG}{sensor}{held}")).medium, None);
    let floor = "<shape type='rectangle'><ref name='exterior' id='fog'/></shape>";
    assert_eq!(media(&format!("{FOG}{floor}")).medium.as_deref(), Some("fog"));
}

#[test]
fn a_medium_without_a_name_does_not_take_that_of_another() {
    let medium = |id: &str, scale: u32| {
        let inner =
            format!("<medium type='homogeneous' name='interior' {id}><float name='scale' value='{scale}'/></medium>");
        format!("<shape type='sphere'>{inner}</shape>")
    };
    // The names that media without one have are those of their numbers.
    let shapes = [medium("id='medium-2'", 1), medium("", 2), medium("", 3), medium("id='medium-4'", 4)].concat();
    let description = media(&shapes);
    assert_eq!(description.media.len(), 4, "{:?}", description.media.keys());
    for (shape, expected) in description.shapes.iter().zip([1.0, 2.0, 3.0, 4.0]) {
        let name = shape.interior.as_deref().expect("a medium");
        let MediumDescription::Homogeneous { scale, .. } = description.media[name] else { panic!("not homogeneous") };
        assert_eq!(scale, expected, "{name}");
    }
}

#[test]
fn faults_in_media_have_a_place() {
    for content in [
        "<shape type='cube'><medium type='homogeneous' name='interior'><phase type='hg'><float name='g' value='1'/></phase></medium></shape>",
        "<shape type='cube'><medium type='homogeneous' name='interior'><phase type='tabphase'/></medium></shape>",
        "<shape type='cube'><medium type='homogeneous' name='interior'><phase type='blendphase'><phase type='hg'/></phase></medium></shape>",
    ] {
        let error = scene(content).expect_err("a fault");
        assert!(error.place.is_some(), "{error}");
    }
}
