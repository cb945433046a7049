//! Groups of shapes and their instances.

use std::mem;

use glam::DMat4;

use crate::error::Result;
use crate::import::mitsuba::document::Kind;
use crate::import::mitsuba::query::Query;
use crate::import::mitsuba::{Group, Importer};
use crate::scene::description::{GeometryDescription, ShapeDescription, Transform};

impl<'a> Importer<'a> {
    /// The key of the shape that comes next.
    pub(super) fn next_shape(&self) -> String {
        match &self.group {
            Some(group) => format!("groups.{}[{}]", group.name, group.shapes.len()),
            None => format!("shapes[{}]", self.imported.description.shapes.len()),
        }
    }

    pub(super) fn push_shape(&mut self, shape: ShapeDescription) {
        match &mut self.group {
            Some(group) => group.shapes.push(shape),
            None => self.imported.description.shapes.push(shape),
        }
    }

    /// A group, placed. Our groups hold neither lamps nor instances: where one has to, its shapes are copied.
    pub(super) fn instance(&mut self, query: Query<'a>, matrix: DMat4, depth: usize) -> Result<()> {
        let part = query.part(Kind::Shape).map(|part| part.object);
        let group = part.filter(|&part| self.document.objects[part].plugin == "shapegroup");
        let Some(group) = group else { return Err(query.fault("", "an instance needs a shapegroup")) };
        self.leftovers(query);
        if self.group.is_some() || self.shines(group) {
            return self.copied(group, matrix, depth);
        }
        let name = self.named_group(group, depth)?;
        let key = self.next_shape();
        self.note(&key, query.object.spot);
        self.push_shape(ShapeDescription {
            interior: None,
            priority: 0,
            geometry: GeometryDescription::Instance { group: name },
            material: None,
            emission: None,
            transform: Transform(matrix.as_mat4()),
            flip_normal: false,
            name: query.object.id.clone(),
        });
        Ok(())
    }

    /// Whether a shape right in the group emits light.
    fn shines(&self, group: usize) -> bool {
        let of_kind = |object: usize, kind: Kind| {
            let parts = self.document.objects[object].parts.iter().map(|part| part.object);
            parts.filter(move |&part| self.document.objects[part].kind == kind)
        };
        of_kind(group, Kind::Shape).any(|shape| of_kind(shape, Kind::Emitter).next().is_some())
    }

    fn copied(&mut self, group: usize, matrix: DMat4, depth: usize) -> Result<()> {
        let query = self.query(group);
        self.visit(query, depth)?;
        let parent = mem::replace(&mut self.parent, matrix);
        let parts = query.parts(Kind::Shape);
        let copied = parts.iter().try_for_each(|part| self.nested_shape(part.object, depth + 1));
        self.parent = parent;
        copied
    }

    /// The name in the description of a group.
    fn named_group(&mut self, object: usize, depth: usize) -> Result<String> {
        if let Some(name) = self.groups.get(&object) {
            return Ok(name.clone());
        }
        let query = self.query(object);
        let number = self.groups.len() + 1;
        let name = query.object.id.clone().unwrap_or_else(|| format!("group-{number}"));
        self.note(format!("groups.{name}"), query.object.spot);
        self.group = Some(Group { name: name.clone(), shapes: Vec::new() });
        let copied = self.copied(object, DMat4::IDENTITY, depth);
        let group = self.group.take();
        copied?;
        self.leftovers(query);
        self.description().groups.insert(name.clone(), group.map(|group| group.shapes).unwrap_or_default());
        self.groups.insert(object, name.clone());
        Ok(name)
    }
}
