//! What a scene file says: names unresolved, numbers unchecked. Every importer ends in a
//! [`SceneDescription`]; [`build`](crate::scene::build) turns it into a [`Scene`](crate::scene::Scene) or an error.
//!
//! Enums here are written in TOML as a table with a `type`; `import::toml` rewrites that to serde's
//! external tags, which keep the place of every value.

mod color;
mod integrator;
mod transform;

use std::collections::BTreeMap;
use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::geometry::MeshData;
pub use color::{Color, Paint};
pub use integrator::{
    BandwidthRule, Direct, IntegratorDescription, KernelName, LightSettings, PathSettings, PhotonMapSettings, Show,
};
pub use transform::Transform;

pub use crate::texture::Wrap;

/// A whole scene.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct SceneDescription {
    /// Where we look from. A scene must have one.
    pub camera: Option<CameraDescription>,
    /// Size and filter of the picture.
    #[serde(default)]
    pub film: FilmDescription,
    /// How the light is computed; photon mapping by default.
    #[serde(default)]
    pub integrator: IntegratorDescription,
    /// How much work and which random numbers.
    #[serde(default)]
    pub render: RenderDescription,
    /// Textures by name.
    #[serde(default)]
    pub textures: BTreeMap<String, TextureDescription>,
    /// Materials by name.
    #[serde(default)]
    pub materials: BTreeMap<String, MaterialDescription>,
    /// All surfaces.
    #[serde(default)]
    pub shapes: Vec<ShapeDescription>,
    /// All lights that are not the emission of a shape.
    #[serde(default)]
    pub lights: Vec<LightDescription>,
}

/// The camera, a pinhole or a thin lens, in one of two forms:
///
/// - the course's: `origin`, `left`, `up` and `forward` span the picture, whose left edge lies at
///   `origin + forward + left`, top edge at `origin + forward + up`;
/// - `origin`, `target`, `fov`, and `up` (+y by default) for the upright direction.
///
/// With `fov` beside `left`, `up` and `forward`, these three give directions only (made orthogonal is
/// up to their author) and the field of view gives the size.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct CameraDescription {
    /// Where the pinhole or the centre of the lens is.
    pub origin: [f32; 3],
    /// From the centre of the picture to its left edge.
    pub left: Option<[f32; 3]>,
    /// From the centre of the picture to its top edge; with `target`, the upright direction.
    pub up: Option<[f32; 3]>,
    /// From the origin to the centre of the picture.
    pub forward: Option<[f32; 3]>,
    /// A point in the middle of the picture.
    pub target: Option<[f32; 3]>,
    /// Field of view in degrees, between 0 and 180, across `fov-axis`; 40 by default with `target`.
    pub fov: Option<f32>,
    /// The side of the picture that `fov` spans.
    #[serde(default)]
    pub fov_axis: FovAxis,
    /// Radius of the lens in scene units; 0, the default, is a pinhole.
    #[serde(default)]
    pub aperture_radius: f32,
    /// Distance, along the viewing direction, of the plane in focus; of `target` by default.
    pub focus_distance: Option<f32>,
}

/// Which side of the picture a field of view spans.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum FovAxis {
    /// The width.
    #[default]
    X,
    /// The height.
    Y,
    /// The shorter side.
    Smaller,
    /// The longer side.
    Larger,
    /// From corner to corner.
    Diagonal,
}

/// The size of the picture and how samples become pixels.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case", default)]
pub struct FilmDescription {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// The reconstruction filter.
    pub filter: FilterDescription,
}

impl Default for FilmDescription {
    fn default() -> FilmDescription {
        FilmDescription { size: [512, 512], filter: FilterDescription::default() }
    }
}

/// A reconstruction filter; sizes in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(tag = "type")]
pub enum FilterDescription {
    /// The mean over a square of this half width (default 0.5: the pixel itself).
    Box {
        /// Half the width of the square.
        #[serde(default = "half")]
        radius: f32,
    },
    /// A tent that falls to zero at this distance (default 1).
    Tent {
        /// Where the tent ends.
        #[serde(default = "one")]
        radius: f32,
    },
    /// A Gaussian of this standard deviation (default 0.5), cut at four of them.
    Gaussian {
        /// Standard deviation.
        #[serde(default = "half")]
        stddev: f32,
    },
}

impl Default for FilterDescription {
    fn default() -> FilterDescription {
        FilterDescription::Box { radius: 0.5 }
    }
}

fn half() -> f32 {
    0.5
}

fn one() -> f32 {
    1.0
}

/// The budget that the file asks for, and the seed.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case", default)]
pub struct RenderDescription {
    /// Number of passes; a good quick picture by default.
    pub passes: Option<u32>,
    /// Seed of all random numbers; 0 by default.
    pub seed: u64,
}

/// A material written in place or the name of one in `materials`.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum MaterialRef {
    /// A name in `materials`.
    Named(String),
    /// A material of this place alone.
    Inline(Box<MaterialDescription>),
}

/// How a surface scatters light.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(tag = "type")]
pub enum MaterialDescription {
    /// Reflects equally in all directions (Lambert), on both sides unless wrapped otherwise.
    #[serde(rename_all = "kebab-case")]
    Diffuse {
        /// Share of the light that is reflected, 0 to 1 (default 0.5).
        #[serde(default = "Paint::half")]
        reflectance: Paint,
    },
    /// Reflects perfectly, without Fresnel, on both sides.
    #[serde(rename_all = "kebab-case")]
    Mirror {
        /// Share of the light that is reflected, 0 to 1 (default 1).
        #[serde(default = "Paint::one")]
        reflectance: Paint,
    },
    /// A smooth boundary between two clear substances, with Fresnel; the normal points to the outside.
    #[serde(rename_all = "kebab-case")]
    Glass {
        /// Index of refraction inside (default 1.5).
        #[serde(default = "glass_ior")]
        ior: f32,
        /// Index of refraction outside (default 1).
        #[serde(default = "one")]
        exterior_ior: f32,
        /// Tint of the reflected light (default 1).
        #[serde(default = "Paint::one")]
        reflectance: Paint,
        /// Tint of the refracted light (default 1).
        #[serde(default = "Paint::one")]
        transmittance: Paint,
    },
    /// A thin pane: both surfaces and all reflections between them at once; light goes straight through.
    #[serde(rename_all = "kebab-case")]
    ThinGlass {
        /// Index of refraction of the pane (default 1.5).
        #[serde(default = "glass_ior")]
        ior: f32,
        /// Index of refraction around it (default 1).
        #[serde(default = "one")]
        exterior_ior: f32,
        /// Tint of the reflected light (default 1).
        #[serde(default = "Paint::one")]
        reflectance: Paint,
        /// Tint of the transmitted light (default 1).
        #[serde(default = "Paint::one")]
        transmittance: Paint,
    },
    /// A smooth metal, by its complex index of refraction per channel.
    #[serde(rename_all = "kebab-case")]
    Conductor {
        /// Real part of the index of refraction.
        eta: Color,
        /// Imaginary part of the index of refraction.
        k: Color,
        /// Tint (default 1).
        #[serde(default = "Paint::one")]
        reflectance: Paint,
    },
    /// A diffuse base under a smooth clear coat, with Fresnel and the light that the coat sends back
    /// down; seen from the front only.
    #[serde(rename_all = "kebab-case")]
    Plastic {
        /// Colour of the base (default 0.5).
        #[serde(default = "Paint::half")]
        reflectance: Paint,
        /// Tint of the reflection on the coat (default 1).
        #[serde(default = "Paint::one")]
        specular: Paint,
        /// Index of refraction of the coat (default 1.5).
        #[serde(default = "glass_ior")]
        ior: f32,
        /// Index of refraction outside (default 1).
        #[serde(default = "one")]
        exterior_ior: f32,
        /// Whether repeated reflection under the coat saturates the colour (default false).
        #[serde(default)]
        nonlinear: bool,
    },
    /// The course's mix of three coefficients, whose sum must not exceed 1 in any channel.
    #[serde(rename_all = "kebab-case")]
    Coefficients {
        /// Share that is reflected diffusely (default 0).
        #[serde(default)]
        kd: Color,
        /// Share that is mirrored (default 0).
        #[serde(default)]
        ks: Color,
        /// Share that meets a refractive boundary (default 0).
        #[serde(default)]
        kt: Color,
        /// Index of refraction inside (default 1.5).
        #[serde(default = "glass_ior")]
        ior: f32,
        /// With Fresnel (the default) the share `kt` is split by angle into reflection and refraction; without,
        /// all of it is refracted, and mirrored only under total internal reflection.
        #[serde(default = "yes")]
        fresnel: bool,
    },
    /// The material on both sides of a surface, or another one on its back.
    #[serde(rename_all = "kebab-case")]
    TwoSided {
        /// On the side of the normal.
        front: MaterialRef,
        /// On the other side; the same by default.
        back: Option<MaterialRef>,
    },
    /// A material with holes.
    #[serde(rename_all = "kebab-case")]
    Mask {
        /// 1 where the material is, 0 where light passes straight through (default 0.5).
        #[serde(default = "Paint::half")]
        opacity: Paint,
        /// What is not hole.
        material: MaterialRef,
    },
    /// A linear mix of two materials.
    #[serde(rename_all = "kebab-case")]
    Blend {
        /// Share of the second, 0 to 1.
        weight: Paint,
        /// The material at weight 0.
        first: MaterialRef,
        /// The material at weight 1.
        second: MaterialRef,
    },
}

fn glass_ior() -> f32 {
    1.5
}

fn yes() -> bool {
    true
}

/// A texture: a colour that varies over a surface.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(tag = "type")]
pub enum TextureDescription {
    /// A picture. 8-bit and 16-bit files are decoded from sRGB unless `raw`.
    #[serde(rename_all = "kebab-case")]
    Bitmap {
        /// The picture's file, relative to the scene's folder.
        file: String,
        /// Take the numbers as linear, as for a map of weights (default false).
        #[serde(default)]
        raw: bool,
        /// Nearest pixel instead of bilinear interpolation (default false).
        #[serde(default)]
        nearest: bool,
        /// What happens outside 0..1 (default repeat).
        #[serde(default)]
        wrap: Wrap,
        /// Maps the surface's (u, v, 0) before the look-up.
        #[serde(default)]
        to_uv: Transform,
    },
    /// Two colours in squares: `color0` where floor(u) + floor(v) is even after `to-uv` and a doubling of
    /// (u, v), as Mitsuba has it.
    #[serde(rename_all = "kebab-case")]
    Checkerboard {
        /// Colour of the even squares (default 0.4).
        #[serde(default = "Color::dark")]
        color0: Color,
        /// Colour of the odd squares (default 0.2).
        #[serde(default = "Color::darker")]
        color1: Color,
        /// Maps the surface's (u, v, 0) before the look-up.
        #[serde(default)]
        to_uv: Transform,
    },
}

/// A surface: a geometry with its material and emission.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct ShapeDescription {
    /// The geometry; in TOML its keys stand beside those of the shape.
    #[schemars(flatten)]
    pub geometry: GeometryDescription,
    /// The material; diffuse 0.5 by default, black for a shape that emits.
    pub material: Option<MaterialRef>,
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
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct EmissionDescription {
    /// Radiance in W/(m² sr).
    pub radiance: Option<Color>,
    /// Flux of the whole surface in W.
    pub power: Option<Color>,
}

/// The geometry of a shape in its own coordinates.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
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
    /// Triangles from an OBJ, PLY or Mitsuba `.serialized` file.
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
    /// Triangles that an importer holds already.
    #[serde(skip)]
    Triangles(Arc<MeshData>),
}

fn plus_z() -> [f32; 3] {
    [0.0, 0.0, 1.0]
}

/// A light that is not a surface. Where both `intensity` and `power` may stand, give one.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[schemars(tag = "type")]
pub enum LightDescription {
    /// A point that shines equally in all directions.
    #[serde(rename_all = "kebab-case")]
    Point {
        /// Where it is.
        position: [f32; 3],
        /// Radiant intensity in W/sr.
        intensity: Option<Color>,
        /// Flux in W: 4π times the intensity.
        power: Option<Color>,
    },
    /// A point that shines into a cone: fully within `beam-width` of the axis, then linearly in the angle
    /// down to nothing at `cutoff`.
    #[serde(rename_all = "kebab-case")]
    Spot {
        /// Where it is.
        position: [f32; 3],
        /// A point on the axis of the cone.
        target: [f32; 3],
        /// Radiant intensity on the axis in W/sr.
        intensity: Option<Color>,
        /// Flux of the cone in W.
        power: Option<Color>,
        /// Angle between axis and edge in degrees (default 20).
        #[serde(default = "cutoff")]
        cutoff: f32,
        /// Angle of full intensity in degrees (default three quarters of `cutoff`).
        beam_width: Option<f32>,
    },
    /// Parallel light from infinitely far away.
    #[serde(rename_all = "kebab-case")]
    Directional {
        /// Where the light goes.
        direction: [f32; 3],
        /// Irradiance on a surface that faces it, in W/m² (default 1).
        #[serde(default = "Color::one")]
        irradiance: Color,
    },
    /// The same radiance from everywhere infinitely far away.
    #[serde(rename_all = "kebab-case")]
    Constant {
        /// Radiance in W/(m² sr) (default 1).
        #[serde(default = "Color::one")]
        radiance: Color,
    },
}

fn cutoff() -> f32 {
    20.0
}
