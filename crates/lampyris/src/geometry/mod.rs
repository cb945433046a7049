//! Surfaces as geometry alone: where a ray meets them, where points on them are.

mod bounds;
mod bvh;
mod cylinder;
mod disk;
mod flat;
mod instance;
mod level;
mod mesh;
mod mesh_data;
mod pairs;
mod plane;
mod quad;
mod ray;
mod rectangle;
mod shape;
mod sphere;
mod surfaces;
#[cfg(test)]
mod tests;

pub use bounds::Bounds;
pub use cylinder::Cylinder;
pub use disk::Disk;
pub use level::TreeStatistics;
pub use mesh::Mesh;
pub use mesh_data::MeshData;
pub use plane::Plane;
pub use quad::Quad;
pub use ray::{Cone, Ray, Surface};
pub use shape::Shape;
pub use sphere::Sphere;
pub use surfaces::{GroupId, Hit, Surfaces, SurfacesBuilder};

/// How far rounding can put a computed surface point off its surface, relative to the size of the coordinates that
/// it was computed from: sixteen units in the last place. Everything that is derived from it scales with the scene.
const RELATIVE_ERROR: f32 = 1.0 / (1 << 20) as f32;
