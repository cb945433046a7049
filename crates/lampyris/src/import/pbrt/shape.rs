//! Shapes: geometry, placed at once; material and light wait for the end of the file.
//!
//! In pbrt a mirroring transform keeps the outside of a shape outside, and vertex normals decide which side of a
//! triangle is its front. Ours follows the order of the corners in the world.

use std::rc::Rc;

use glam::{DMat4, DVec3};

use super::super::source::Spot;
use super::super::spectrum::Role;
use super::material::{Resolved, Use};
use super::medium::Sides;
use super::statement::Statement;
use super::{Importer, Opened};
use crate::error::{Result, did_you_mean};
use crate::scene::description::{
    EmissionDescription, GeometryDescription, MaterialDescription, MaterialRef, Paint, ShapeDescription, Transform,
};

/// Sorts of shapes, to propose them for wrong ones.
const SORTS: [&str; 10] = [
    "bilinearmesh",
    "curve",
    "cylinder",
    "disk",
    "loopsubdiv",
    "plymesh",
    "sphere",
    "trianglemesh",
    "cone",
    "paraboloid",
];

/// A shape without its material.
pub(super) struct Pending {
    statement: Rc<Statement>,
    geometry: GeometryDescription,
    transform: DMat4,
    flip_normal: bool,
    material: Use,
    area_light: Option<Rc<Statement>>,
    media: Sides,
    /// The object that it belongs to.
    group: Option<String>,
}

/// A geometry and what is left of its placement.
pub(super) struct Placed {
    pub geometry: GeometryDescription,
    pub transform: DMat4,
    pub flip: bool,
}

impl Importer<'_> {
    pub(super) fn shape(&mut self, statement: Statement) -> Result<()> {
        let placed = match statement.sort() {
            "sphere" => self.sphere(&statement)?,
            "disk" => self.disk(&statement)?,
            "cylinder" => self.cylinder(&statement)?,
            "trianglemesh" => self.triangle_mesh(&statement)?,
            "plymesh" => self.ply_mesh(&statement)?,
            "bilinearmesh" => self.bilinear_mesh(&statement)?,
            "loopsubdiv" => self.subdivision(&statement)?,
            sort => {
                let message = format!("shape '{sort}' is not supported: it is left out");
                match did_you_mean(sort, SORTS).filter(|near| *near != sort) {
                    Some(near) => self.warn_with(statement.spot, message, &format!("did you mean '{near}'?")),
                    None => self.warn(statement.spot, message),
                }
                return Ok(());
            }
        };
        let Some(Placed { geometry, transform, flip }) = placed else { return Ok(()) };
        statement.ignore(&["alpha", "shadowalpha"]);
        self.leftovers(&statement);
        self.push(statement, geometry, transform, flip);
        Ok(())
    }

    fn push(&mut self, statement: Statement, geometry: GeometryDescription, transform: DMat4, flip_normal: bool) {
        self.pending.push(Pending {
            geometry,
            transform,
            flip_normal,
            material: self.state.material.clone(),
            area_light: self.state.area_light.clone(),
            media: self.state.media.clone(),
            group: self.group.clone(),
            statement: Rc::new(statement),
        });
    }

    pub(super) fn object_begin(&mut self, statement: &Statement) -> Result<()> {
        let (name, spot) = (statement.sort().to_string(), statement.spot);
        if self.group.is_some() {
            return Err(self.reader.fault(spot, "an object cannot be defined inside another"));
        }
        self.save(Opened::Object, spot)?;
        if self.groups.insert(name.clone(), spot).is_some() {
            return Err(self.reader.fault(spot, format!("the object '{name}' is defined twice")));
        }
        self.group = Some(name);
        Ok(())
    }

    pub(super) fn instance(&mut self, statement: &Statement) -> Result<()> {
        if self.group.is_some() {
            return Err(self.reader.fault(statement.spot, "an object cannot hold instances of others"));
        }
        let group = statement.sort().to_string();
        let transform = self.state.ctm;
        self.push(statement.clone(), GeometryDescription::Instance { group }, transform, false);
        Ok(())
    }

    fn sphere(&mut self, statement: &Statement) -> Result<Option<Placed>> {
        let radius = self.placed(statement.number("radius", 1.0))?;
        let default = [-radius, radius, 360.0];
        for (name, whole) in ["zmin", "zmax", "phimax"].into_iter().zip(default) {
            let value = self.placed(statement.number(name, whole))?;
            if (value - whole).abs() > 1e-6 * whole.abs() {
                let spot = statement.spot_of(name);
                self.warn(spot, "a part of a sphere is not supported: the whole sphere is drawn");
            }
        }
        let matrix = self.state.ctm;
        let geometry = if is_similarity(matrix) {
            let scale = matrix.transform_vector3(DVec3::X).length();
            let center = matrix.transform_point3(DVec3::ZERO).as_vec3().to_array();
            let geometry = GeometryDescription::Sphere { center, radius: (radius * scale) as f32 };
            return Ok(Some(Placed { geometry, transform: DMat4::IDENTITY, flip: self.state.reverse }));
        } else {
            super::meshes::ellipsoid(radius)
        };
        Ok(Some(self.outwards(geometry)))
    }

    fn disk(&mut self, statement: &Statement) -> Result<Option<Placed>> {
        let height = self.placed(statement.number("height", 0.0))?;
        let radius = self.placed(statement.number("radius", 1.0))?;
        for (name, whole) in [("innerradius", 0.0), ("phimax", 360.0)] {
            if self.placed(statement.number(name, whole))? != whole {
                self.warn(statement.spot_of(name), "a part of a disk is not supported: the whole disk is drawn");
            }
        }
        let geometry = GeometryDescription::Disk {
            center: [0.0, 0.0, height as f32],
            normal: [0.0, 0.0, 1.0],
            radius: radius as f32,
        };
        Ok(Some(self.outwards(geometry)))
    }

    fn cylinder(&mut self, statement: &Statement) -> Result<Option<Placed>> {
        let radius = self.placed(statement.number("radius", 1.0))?;
        let low = self.placed(statement.number("zmin", -1.0))?;
        let high = self.placed(statement.number("zmax", 1.0))?;
        if self.placed(statement.number("phimax", 360.0))? != 360.0 {
            let spot = statement.spot_of("phimax");
            self.warn(spot, "a part of a cylinder is not supported: the whole cylinder is drawn");
        }
        let matrix = self.state.ctm;
        if !is_similarity(matrix) {
            return Ok(Some(self.outwards(super::meshes::tube(radius, low, high))));
        }
        let scale = matrix.transform_vector3(DVec3::X).length();
        let end = |z: f64| matrix.transform_point3(DVec3::new(0.0, 0.0, z)).as_vec3().to_array();
        let radius = (radius * scale) as f32;
        let geometry = GeometryDescription::Cylinder { from: end(low), to: end(high), radius };
        Ok(Some(Placed { geometry, transform: DMat4::IDENTITY, flip: self.state.reverse }))
    }

    /// A geometry in its own coordinates whose front stays its front under a mirroring transform.
    pub(super) fn outwards(&self, geometry: GeometryDescription) -> Placed {
        let transform = self.state.ctm;
        Placed { geometry, transform, flip: self.state.reverse != (transform.determinant() < 0.0) }
    }

    /// Gives all shapes their materials and lights.
    pub(super) fn finish_shapes(&mut self) -> Result<()> {
        let pending = std::mem::take(&mut self.pending);
        let filled: Vec<bool> = pending.iter().map(|shape| self.is_there(shape)).collect();
        for (shape, _) in pending.into_iter().zip(filled).filter(|(_, filled)| *filled) {
            self.finish_shape(shape)?;
        }
        let groups = &self.imported.description.groups;
        let empty = |geometry: &GeometryDescription| match geometry {
            GeometryDescription::Instance { group } => !groups.contains_key(group),
            _ => false,
        };
        // An instance of an object that turned out to hold nothing.
        let drop: Vec<bool> = self.imported.description.shapes.iter().map(|shape| empty(&shape.geometry)).collect();
        if drop.contains(&true) {
            let mut drop = drop.into_iter();
            self.imported.description.shapes.retain(|_| !drop.next().unwrap_or(false));
        }
        Ok(())
    }

    fn finish_shape(&mut self, shape: Pending) -> Result<()> {
        let Pending { statement, geometry, transform, flip_normal, material, area_light, media, group } = shape;
        let interior = self.interior(&media);
        let is_instance = matches!(geometry, GeometryDescription::Instance { .. });
        let (material, emission) = if is_instance {
            (None, None)
        } else {
            let material = match self.resolve(&material)? {
                Resolved::Material(material) => self.masked(&statement, material)?,
                // The border of a medium and nothing else; without one it is nothing.
                Resolved::Interface if interior.is_some() => {
                    MaterialRef::Inline(Box::new(MaterialDescription::None {}))
                }
                Resolved::Interface => return Ok(()),
            };
            let emission = match (&area_light, &group) {
                (Some(light), Some(_)) => {
                    self.warn(light.spot, "an object that is instanced cannot emit light: its light is left out");
                    None
                }
                (Some(light), None) => self.emission(light, &geometry)?,
                (None, _) => None,
            };
            (Some(material), emission)
        };
        let shape = ShapeDescription {
            interior: interior.filter(|_| !is_instance),
            priority: 0,
            geometry,
            material,
            emission,
            transform: Transform(transform.as_mat4()),
            flip_normal,
            name: None,
        };
        let key = match group {
            Some(name) => {
                let shapes = self.description().groups.entry(name.clone()).or_default();
                shapes.push(shape);
                format!("groups.{name}[{}]", shapes.len() - 1)
            }
            None => {
                self.description().shapes.push(shape);
                format!("shapes[{}]", self.description().shapes.len() - 1)
            }
        };
        self.note_shape(&key, &statement, area_light.as_deref().map(|light| light.spot));
        Ok(())
    }

    fn note_shape(&mut self, key: &str, statement: &Statement, light: Option<Spot>) {
        self.note(key, statement.spot);
        for name in ["radius", "filename"] {
            if statement.has(name) {
                let ours = if name == "filename" { "file" } else { name };
                self.note(format!("{key}.{ours}"), statement.spot_of(name));
            }
        }
        if let Some(spot) = light {
            self.note(format!("{key}.emission"), spot);
        }
    }
}

/// Whether a matrix keeps spheres round, as far as one written with few digits can.
fn is_similarity(matrix: DMat4) -> bool {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| matrix.transform_vector3(axis));
    let [x, y, z] = axes;
    let size = x.length_squared().max(f64::MIN_POSITIVE);
    let alike = |other: DVec3| (other.length_squared() - size).abs() <= 2e-3 * size;
    alike(y) && alike(z) && [x.dot(y), y.dot(z), z.dot(x)].iter().all(|cosine| cosine.abs() <= 1e-3 * size)
}

impl Importer<'_> {
    /// Whether the shape is to be drawn; warns or fails for an instance of nothing.
    fn is_there(&mut self, shape: &Pending) -> bool {
        let GeometryDescription::Instance { group } = &shape.geometry else { return true };
        if self.groups.contains_key(group) {
            return true;
        }
        if !super::super::has_room(&self.imported.warnings) {
            return false;
        }
        let message = format!("there is no object '{group}': this instance is left out");
        match did_you_mean(group, self.groups.keys().map(String::as_str)).map(str::to_string) {
            Some(near) => self.warn_with(shape.statement.spot, message, &format!("did you mean '{near}'?")),
            None => self.warn(shape.statement.spot, message),
        }
        false
    }

    /// The material with the holes that the shape's `alpha` makes.
    fn masked(&mut self, statement: &Statement, material: MaterialRef) -> Result<MaterialRef> {
        if !statement.has("alpha") {
            return Ok(material);
        }
        let opacity = self.weight(statement, "alpha", 1.0)?;
        if opacity == Paint::grey(1.0) {
            return Ok(material);
        }
        Ok(MaterialRef::Inline(Box::new(MaterialDescription::Mask { opacity, material })))
    }

    /// What a shape with this area light emits.
    fn emission(&mut self, light: &Statement, geometry: &GeometryDescription) -> Result<Option<EmissionDescription>> {
        if !matches!(light.sort(), "diffuse" | "area") {
            self.warn(light.spot, format!("area light '{}' is not known: a diffuse one is used", light.sort()));
        }
        let scale = self.placed(light.number("scale", 1.0))? * self.exposure;
        let two_sided = self.placed(light.boolean("twosided", false))?;
        let power = self.placed(light.optional_number("power"))?.filter(|power| *power > 0.0);
        light.ignore(&["nsamples", "samples"]);
        let color = self.color(light, "L", Role::Light)?.unwrap_or([1.0; 3]);
        let file = self.placed(light.text("filename"))?.filter(|file| !file.is_empty()).map(str::to_string);
        self.leftovers(light);
        if let Some(file) = file {
            if power.is_some() {
                self.warn(
                    light.spot_of("power"),
                    "the power of a light with a picture is not supported: it is ignored",
                );
            }
            let radiance = Some(Paint::Texture(self.picture(&file, light.spot)));
            return Ok(Some(EmissionDescription { radiance, power: None, scale: scale as f32, two_sided }));
        }
        let shaded = |factor: f64| super::material::color(color.map(|channel| channel * factor));
        if scale <= 0.0 || color.iter().all(|channel| *channel <= 0.0) {
            return Ok(None);
        }
        Ok(Some(match power {
            Some(power) => {
                if matches!(geometry, GeometryDescription::Triangles(mesh) if mesh.triangles.len() > 1) {
                    let message = "in pbrt every triangle has this power; here the whole mesh has it";
                    self.warn(light.spot_of("power"), message);
                }
                let power = Some(shaded(power * scale));
                EmissionDescription { radiance: None, power, scale: 1.0, two_sided }
            }
            None => EmissionDescription { radiance: Some(shaded(scale).into()), power: None, scale: 1.0, two_sided },
        }))
    }
}
