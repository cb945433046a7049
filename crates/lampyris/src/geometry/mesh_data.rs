//! Triangles as files give them, before they become part of a scene.

/// An indexed triangle mesh. Per-vertex lists are empty or as long as `positions`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshData {
    /// Vertex positions in scene units.
    pub positions: Vec<[f32; 3]>,
    /// Unit shading normals at the vertices, or empty.
    pub normals: Vec<[f32; 3]>,
    /// Texture coordinates at the vertices, or empty.
    pub uvs: Vec<[f32; 2]>,
    /// Three vertex numbers a triangle, each less than `positions.len()`.
    pub triangles: Vec<[u32; 3]>,
}

impl MeshData {
    /// The first fault that would break a scene: a list of the wrong length, an index out of range,
    /// a position that is not finite.
    pub fn fault(&self) -> Option<String> {
        let count = self.positions.len();
        if !self.normals.is_empty() && self.normals.len() != count {
            return Some(format!("{} normals for {count} vertices", self.normals.len()));
        }
        if !self.uvs.is_empty() && self.uvs.len() != count {
            return Some(format!("{} texture coordinates for {count} vertices", self.uvs.len()));
        }
        if let Some(index) = self.positions.iter().position(|p| p.iter().any(|x| !x.is_finite())) {
            return Some(format!("vertex {index} is not finite"));
        }
        self.triangles.iter().enumerate().find_map(|(number, triangle)| {
            let index = triangle.iter().find(|&&index| index as usize >= count)?;
            Some(format!("triangle {number} names vertex {index}, but there are only {count} (numbered from 0)"))
        })
    }
}
