//! Shapes as a file gives them.

use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Color, MaterialRef, Paint, Transform, one};
use crate::geometry::MeshData;

/// A surface: a geometry with its material and emission.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct ShapeDescription {
    /// The geometry; in TOML its keys stand beside those of the shape.
    #[schemars(flatten)]
    pub geometry: GeometryDescription,
    /// The material; diffuse 0.5 by default, black for a shape that emits, and `none` for one with an interior.
    pub material: Option<MaterialRef>,
    /// The name of the medium inside of this closed shape, on the side against the normal; or "clear" for empty space, such
    /// as that of clear glass in fog. By default the shape changes nothing about what it stands in.
    pub interior: Option<String>,
    /// Where shapes with interiors overlap, the one of the highest priority counts; among equals, the one that a path has
    /// entered last (default 0).
    #[serde(default)]
    pub priority: u16,
    /// Light that the surface emits, on the side of its normal.
    pub emission: Option<EmissionDescription>,
    /// Moves the geometry from its own coordinates to the world.
    #[serde(default)]
    pub transform: Transform,
    /// Turns the normal round (default false).
    #[serde(default)]
    pub flip_normal: bool,
    /// A name for messages and `lampyris info`.
    pub name: Option<String>,
}

/// The emission of a surface, equal in all directions on the side of the normal: give one of the two.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct EmissionDescription {
    /// Radiance in W/(m² sr); a texture gives it point by point.
    pub radiance: Option<Paint>,
    /// Flux of the whole surface in W, of both sides together where both shine.
    pub power: Option<Color>,
    /// Factor of the radiance, for textures, which know no more than 1 (default 1).
    #[serde(default = "one")]
    pub scale: f32,
    /// Whether the back shines as the front does (default false).
    #[serde(default)]
    pub two_sided: bool,
}

/// The geometry of a shape in its own coordinates.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(tag = "type")]
pub enum GeometryDescription {
    /// An infinite plane of the points with n · x + distance = 0, as the course writes it.
    #[serde(rename_all = "kebab-case")]
    Plane {
        /// The normal n, of any length but 0.
        normal: [f32; 3],
        /// Distance of the origin from the plane, along the normal.
        distance: f32,
    },
    /// A sphere, its normal pointing out.
    #[serde(rename_all = "kebab-case")]
    Sphere {
        /// The centre (default the origin).
        #[serde(default)]
        center: [f32; 3],
        /// The radius (default 1).
        #[serde(default = "one")]
        radius: f32,
    },
    /// A parallelogram of the points corner + a·u + b·v, a and b from 0 to 1; its normal is u × v.
    #[serde(rename_all = "kebab-case")]
    Quad {
        /// One corner.
        corner: [f32; 3],
        /// The edge along the first texture coordinate.
        u: [f32; 3],
        /// The edge along the second texture coordinate.
        v: [f32; 3],
    },
    /// A flat round disk.
    #[serde(rename_all = "kebab-case")]
    Disk {
        /// The centre (default the origin).
        #[serde(default)]
        center: [f32; 3],
        /// The normal, of any length but 0 (default +z).
        #[serde(default = "plus_z")]
        normal: [f32; 3],
        /// The radius (default 1).
        #[serde(default = "one")]
        radius: f32,
    },
    /// The side of a round cylinder, open at both ends, its normal pointing out.
    #[serde(rename_all = "kebab-case")]
    Cylinder {
        /// Middle of one end.
        from: [f32; 3],
        /// Middle of the other end.
        to: [f32; 3],
        /// The radius (default 1).
        #[serde(default = "one")]
        radius: f32,
    },
    /// The cube from (-1, -1, -1) to (1, 1, 1), to be placed by `transform`.
    #[serde(rename_all = "kebab-case")]
    Cube {},
    /// Triangles from an OBJ, PLY, STL or Mitsuba `.serialized` file.
    #[serde(rename_all = "kebab-case")]
    Mesh {
        /// The mesh's file, relative to the scene's folder.
        file: String,
        /// Which mesh of the file, for formats that hold several (default 0).
        #[serde(default)]
        index: u32,
        /// Leave the file's smooth normals out, so that every triangle is flat (default false).
        #[serde(default)]
        face_normals: bool,
        /// Compute smooth normals where the file has none (default false: flat triangles).
        #[serde(default)]
        smooth: bool,
        /// Turn the second texture coordinate upside down (default false).
        #[serde(default)]
        flip_v: bool,
    },
    /// All shapes of one of the scene's `groups`, placed by `transform`; they keep their own materials.
    #[serde(rename_all = "kebab-case")]
    Instance {
        /// Name of the group.
        group: String,
    },
    /// Triangles that an importer holds already.
    #[serde(skip)]
    Triangles(Arc<MeshData>),
}

fn plus_z() -> [f32; 3] {
    [0.0, 0.0, 1.0]
}
