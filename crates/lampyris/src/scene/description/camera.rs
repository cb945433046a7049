//! The camera as a file gives it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The camera, a pinhole or a thin lens, in one of two forms:
///
/// - the course's: `origin`, `left`, `up` and `forward` span the picture, whose left edge lies at
///   `origin + forward + left`, top edge at `origin + forward + up`;
/// - `origin`, `target`, `fov`, and `up` (+y by default) for the upright direction.
///
/// With `fov` beside `left`, `up` and `forward`, these three give directions only (made orthogonal is
/// up to their author) and the field of view gives the size.
///
/// With `projection = "orthographic"` all rays are parallel to `forward`; the picture's half sides are `left` and `up`
/// themselves, or with `target` it is `width` wide.
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
    /// Whether rays meet in the eye or run in parallel (default perspective).
    #[serde(default)]
    pub projection: Projection,
    /// Width of the picture of an orthographic camera with `target`, in scene units (default 2).
    pub width: Option<f32>,
    /// The name of a shape whose mean irradiance, in W/m², every pixel measures instead of a picture: light that
    /// arrives on the side of its normal. No other key but `origin` matters then.
    pub irradiance_of: Option<String>,
    /// Single points of a wall instead of a picture, as for seeing around corners. Of the other keys `origin` alone matters
    /// then: where the sensor is.
    pub capture: Option<CaptureDescription>,
    /// Radius of the lens in scene units; 0, the default, is a pinhole.
    #[serde(default)]
    pub aperture_radius: f32,
    /// Distance, along the viewing direction, of the plane in focus; of `target` by default.
    pub focus_distance: Option<f32>,
    /// Distance, along the viewing direction, of a plane before which nothing is seen, and from which on the way to the camera
    /// counts as time (default 0).
    #[serde(default)]
    pub near_distance: f32,
}

/// A relay wall, lit by a laser and looked at by a sensor. The pixels are points of the wall in the middles of the cells of
/// a grid, row 0 at the wall's v = 0. Needs a light of the type `laser`.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct CaptureDescription {
    /// The name of the wall: a shape of the type `quad`.
    pub wall: String,
    /// Which points of the wall the laser lights (default single).
    #[serde(default)]
    pub mode: CaptureMode,
    /// With the mode `exhaustive`, columns and rows of points that the laser lights. The film has as many copies of the
    /// sensor's grid beside and above each other.
    pub laser_grid: Option<[u32; 2]>,
    /// Whether the ways from the laser to the wall and from the wall to the sensor count as time (default false).
    #[serde(default)]
    pub legs: bool,
    /// Whether half of the paths that leave the wall are aimed at other shapes (default false): for what is hidden and small.
    /// Needs the integrator `path`.
    #[serde(default)]
    pub hidden_geometry: bool,
}

/// Which points of a relay wall a laser lights.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum CaptureMode {
    /// One: its target.
    #[default]
    Single,
    /// The point that the pixel looks at.
    Confocal,
    /// Those of a grid, each for every pixel.
    Exhaustive,
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

/// How a camera maps the scene to its picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Projection {
    /// All rays meet in the eye.
    #[default]
    Perspective,
    /// All rays are parallel.
    Orthographic,
}
