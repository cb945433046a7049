use super::*;
use crate::scene::description::GeometryDescription;

const GROUP: &str = "<shape type='shapegroup' id='tree'><shape type='sphere'><bsdf type='dielectric'/></shape>
    <shape type='cube'><transform name='to_world'><translate x='1'/></transform></shape></shape>";

fn instance(step: &str) -> String {
    format!("<shape type='instance'><ref id='tree'/><transform name='to_world'>{step}</transform></shape>")
}

#[test]
fn a_group_stands_once_and_its_instances_name_it() {
    let imported = clean(&format!("{GROUP}{}{}", instance("<translate y='2'/>"), instance("<scale value='3'/>")));
    let description = &imported.description;
    assert_eq!((description.groups.len(), description.groups["tree"].len(), description.shapes.len()), (1, 2, 2));
    assert_eq!(description.groups["tree"][1].transform.0.w_axis.x, 1.0);
    let shape = &description.shapes[0];
    assert!(matches!(&shape.geometry, GeometryDescription::Instance { group } if group == "tree"));
    assert_eq!(shape.transform.0.w_axis.y, 2.0);
    assert!(imported.places.find("groups.tree[1]").is_some());
}

#[test]
fn a_group_without_instances_is_not_seen() {
    let imported = clean(GROUP);
    assert!(imported.description.shapes.is_empty());
}

#[test]
fn the_lamps_of_a_group_are_copied() {
    let lamp = GROUP.replace("<bsdf type='dielectric'/>", "<emitter type='area'/>");
    let imported = clean(&format!("{lamp}{}", instance("<translate y='2'/>")));
    let shapes = &imported.description.shapes;
    assert_eq!((imported.description.groups.len(), shapes.len()), (0, 2));
    let GeometryDescription::Sphere { center, .. } = shapes[0].geometry else { panic!("not a sphere") };
    close(center, [0.0, 2.0, 0.0]);
    assert!(shapes[0].emission.is_some());
    assert_eq!(shapes[1].transform.0.w_axis.truncate().to_array(), [1.0, 2.0, 0.0]);
}

#[test]
fn an_instance_in_a_group_is_copied_into_it() {
    let forest = format!("<shape type='shapegroup' id='forest'>{}</shape>", instance("<translate z='5'/>"));
    let imported = clean(&format!("{GROUP}{forest}<shape type='instance'><ref id='forest'/></shape>"));
    let forest = &imported.description.groups["forest"];
    assert_eq!(forest.len(), 2);
    assert_eq!(forest[1].transform.0.w_axis.truncate().to_array(), [1.0, 0.0, 5.0]);
}

#[test]
fn an_instance_of_nothing_is_an_error() {
    assert!(fault("<shape type='instance'/>").message.contains("shapegroup"));
    let other = "<shape type='cube' id='c'/><shape type='instance'><ref id='c'/></shape>";
    assert!(fault(other).message.contains("shapegroup"));
}

#[test]
fn a_group_that_contains_itself_is_refused() {
    let ring = "<shape type='shapegroup' id='tree'><shape type='instance'><ref id='tree'/></shape></shape>";
    assert!(fault(&format!("{ring}{}", instance(""))).message.contains("nested too deeply"));
}
