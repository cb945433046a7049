//! Files that ask for more than they give. Where one of them were read in time that grows with the square of its length,
//! its test would not end.

use super::*;

#[test]
fn a_long_parameter_used_often_is_refused() {
    let long = "0123456789".repeat(1000);
    let uses = "<string name='a' value='$long'/>".repeat(10_000);
    let error = fault(&format!("<default name='long' value='{long}'/><shape type='sphere'>{uses}</shape>"));
    assert!(error.message.contains("parameters make the values too long") && error.place.is_some(), "{error}");
}

#[test]
fn an_endless_name_of_a_parameter_has_no_value() {
    let name = "a".repeat(1 << 20);
    let error = fault(&format!("<default name='b{name}' value='1'/><shape type='sphere' id='${name}'/>"));
    assert!(error.message.contains("has no value"));
}

#[test]
fn of_very_many_warnings_a_thousand_are_told() {
    let imported = scene(&"<a/>".repeat(200_000)).expect("nothing but warnings");
    let messages = messages(&imported);
    assert_eq!(messages.len(), 1001);
    assert_eq!(messages[1000], "only the first 1000 warnings are shown");
}

#[test]
fn a_file_that_is_included_again_and_again_is_refused() {
    let part = format!("<scene version='3.0.0'><!-- {} --></scene>", " ".repeat(1 << 20));
    let main = format!("<scene version='3.0.0'>{}</scene>", "<include filename='b.xml'/>".repeat(1000));
    let error = read_files(&[("a.xml", &main), ("b.xml", &part)], &[]).expect_err("a thousand times a megabyte");
    assert!(error.message.contains("include each other too often") && error.place.is_some(), "{error}");
}

#[test]
fn files_are_not_looked_for_in_any_number_of_folders() {
    let error = fault(&"<path value='a'/>".repeat(1000));
    assert!(error.message.contains("more than 64 <path>") && error.place.is_some(), "{error}");
}

#[test]
fn an_element_of_very_many_attributes_is_refused() {
    let attributes: String = (0..200_000).map(|number| format!(" a{number}='1'")).collect();
    let error = fault(&format!("<![CDATA[ <x \" ]]><shape type='sphere'/><shape{attributes}/>"));
    assert!(error.to_string().starts_with("a.xml:2:41: this element has more than 1000 attributes"), "{error}");
}
