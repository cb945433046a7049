//! Shapes, rays and hits.
mod mesh_data;
pub use mesh_data::MeshData;
