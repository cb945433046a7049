//! Triangles as files give them, before they become part of a scene.

use glam::DVec3;

/// An indexed triangle mesh. Per-vertex lists are empty or as long as `positions`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshData {
    /// Vertex positions in scene units.
    pub positions: Vec<[f32; 3]>,
    /// Unit shading normals at the vertices, or empty.
    pub normals: Vec<[f32; 3]>,
    /// Texture coordinates at the vertices, or empty.
    pub uvs: Vec<[f32; 2]>,
    /// Linear RGB colours at the vertices, or empty.
    pub colors: Vec<[f32; 3]>,
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
        if !self.colors.is_empty() && self.colors.len() != count {
            return Some(format!("{} colours for {count} vertices", self.colors.len()));
        }
        if let Some(index) = self.positions.iter().position(|p| p.iter().any(|x| !x.is_finite())) {
            return Some(format!("vertex {index} is not finite"));
        }
        self.triangles.iter().enumerate().find_map(|(number, triangle)| {
            let index = triangle.iter().find(|&&index| index as usize >= count)?;
            Some(format!("triangle {number} names vertex {index}, but there are only {count} (numbered from 0)"))
        })
    }

    /// Replaces the normals by smooth ones: at each vertex the normals of its triangles, weighted by the angle of
    /// each triangle there [Thürmer and Wüthrich 1998], as Mitsuba 3 does for meshes without normals.
    ///
    /// A vertex without such a direction (it belongs to no triangle with an area, or its triangles cancel out)
    /// gets the x axis, so that all normals have unit length.
    ///
    /// # Panics
    /// If a triangle names a vertex that does not exist: ask [`MeshData::fault`] first.
    pub fn compute_normals(&mut self) {
        self.normals = self.smooth_normals();
    }

    /// Scales the normals to unit length and replaces those that have no direction (zero or not finite) by the ones
    /// that [`MeshData::compute_normals`] finds; a mesh without normals stays without. Normals that have unit length up
    /// to rounding stay as they are, so that a mesh that was written and read again is the same to the last bit.
    ///
    /// # Panics
    /// If a triangle names a vertex that does not exist, or the normals are neither none nor one a vertex.
    pub fn normalize_normals(&mut self) {
        let unit = |normal: [f32; 3]| DVec3::from(normal.map(f64::from)).try_normalize();
        if !self.normals.iter().all(|&normal| unit(normal).is_some()) {
            let smooth = self.smooth_normals();
            for (normal, smooth) in self.normals.iter_mut().zip(smooth) {
                if unit(*normal).is_none() {
                    *normal = smooth;
                }
            }
        }
        let is_unit = |normal: [f32; 3]| {
            // Rounding each component by half a unit in the last place moves the squared length by one ε at most.
            (DVec3::from(normal.map(f64::from)).length_squared() - 1.0).abs() < 2.0 * f64::from(f32::EPSILON)
        };
        for normal in self.normals.iter_mut().filter(|normal| !is_unit(**normal)) {
            if let Some(unit) = unit(*normal) {
                *normal = unit.as_vec3().into();
            }
        }
    }

    /// One unit normal a vertex, in `f64` so that neither tiny nor huge scenes lose their direction.
    fn smooth_normals(&self) -> Vec<[f32; 3]> {
        let position = |index: u32| DVec3::from(self.positions[index as usize].map(f64::from));
        let mut sums = vec![DVec3::ZERO; self.positions.len()];
        for &triangle in &self.triangles {
            let [a, b, c] = triangle.map(position);
            let Some(normal) = (b - a).cross(c - a).try_normalize() else { continue };
            for (index, [here, next, last]) in triangle.into_iter().zip([[a, b, c], [b, c, a], [c, a, b]]) {
                sums[index as usize] += normal * (next - here).angle_between(last - here);
            }
        }
        // What rounding leaves of sums that cancel out is no direction.
        let direction = |sum: DVec3| if sum.length() > 1e-9 { sum.normalize() } else { DVec3::X };
        sums.into_iter().map(|sum| direction(sum).as_vec3().into()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: &[[f32; 3]], b: &[[f32; 3]]) -> bool {
        a.len() == b.len() && a.as_flattened().iter().zip(b.as_flattened()).all(|(a, b)| (a - b).abs() < 1e-6)
    }

    /// Three triangles around the origin.
    fn corner() -> MeshData {
        MeshData {
            positions: vec![[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.5], [0., 0., 1.]],
            triangles: vec![[0, 1, 2], [0, 2, 3], [0, 4, 1]],
            ..MeshData::default()
        }
    }

    #[test]
    fn smooth_normals_are_those_of_mitsuba_3_9_1() {
        let mut mesh = corner();
        mesh.compute_normals();
        let expected = [
            [0.183_897_1, 0.614_647_1, 0.767_066_24],
            [0., 0.447_213_56, 0.894_427_2],
            [0.227_046_1, -0.227_046_1, 0.947_048_07],
            [0.408_248_28, -0.408_248_28, 0.816_496_55],
            [0., 1., 0.],
        ];
        assert!(close(&mesh.normals, &expected), "{:?}", mesh.normals);
    }

    #[test]
    fn smooth_normals_do_not_depend_on_the_unit() {
        let mut mesh = corner();
        mesh.compute_normals();
        for scale in [1e-15, 1e15] {
            let mut scaled = corner();
            scaled.positions.as_flattened_mut().iter_mut().for_each(|x| *x *= scale);
            scaled.compute_normals();
            assert!(close(&scaled.normals, &mesh.normals), "{scale}: {:?}", scaled.normals);
        }
    }

    #[test]
    fn a_vertex_whose_triangles_cancel_out_has_a_unit_normal() {
        let mut mesh = MeshData { triangles: vec![[0, 1, 2], [0, 2, 1], [3, 3, 3]], ..corner() };
        mesh.compute_normals();
        assert_eq!(mesh.normals, [[1., 0., 0.]; 5]);
    }

    #[test]
    fn normals_are_scaled_to_unit_length_and_missing_ones_filled_in() {
        let mut mesh = corner();
        mesh.normals = vec![[0., 0., 2.], [0., -3e-30, 0.], [0., 0., 0.], [f32::NAN, 0., 0.], [3., 4., 0.]];
        mesh.normalize_normals();
        let filled = [[0.227_046_1, -0.227_046_1, 0.947_048_07], [0.408_248_28, -0.408_248_28, 0.816_496_55]];
        let expected = [[0., 0., 1.], [0., -1., 0.], filled[0], filled[1], [0.6, 0.8, 0.]];
        assert!(close(&mesh.normals, &expected), "{:?}", mesh.normals);
    }

    #[test]
    fn faults_are_found() {
        let is_faulty = |change: fn(&mut MeshData)| {
            let mut mesh = corner();
            change(&mut mesh);
            mesh.fault().is_some()
        };
        assert!(!is_faulty(|_| {}));
        assert!(is_faulty(|mesh| mesh.normals = vec![[0., 0., 1.]; 4]));
        assert!(is_faulty(|mesh| mesh.uvs = vec![[0., 0.]; 6]));
        assert!(is_faulty(|mesh| mesh.positions[2][1] = f32::INFINITY));
        assert!(is_faulty(|mesh| mesh.triangles[1][2] = 5));
    }
}
