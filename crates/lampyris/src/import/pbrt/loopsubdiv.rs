//! Loop's subdivision of triangle meshes, with Warren's weights, as pbrt does it.

use std::collections::HashMap;
use std::sync::Arc;

use glam::DVec3;

use super::Importer;
use super::shape::Placed;
use super::statement::Statement;
use crate::error::Result;
use crate::geometry::MeshData;

/// The most triangles that subdivision may make of a file, all meshes together.
const MOST_TRIANGLES: usize = 1 << 21;

impl Importer<'_> {
    pub(super) fn subdivision(&mut self, statement: &Statement) -> Result<Option<Placed>> {
        let name = if statement.has("nlevels") { "nlevels" } else { "levels" };
        let levels = self.placed(statement.count(name))?.unwrap_or(3);
        statement.ignore(&["scheme", "levels"]);
        let vertices = self.vertices(statement)?;
        let indices = self.indices(statement, vertices.positions.len(), 3)?;
        let position = |p: &[f32; 3]| DVec3::from(p.map(f64::from));
        let mut net = Net {
            positions: vertices.positions.iter().map(position).collect(),
            triangles: indices.as_chunks().0.to_vec(),
        };
        for level in 0..levels {
            if 4 * net.triangles.len() > MOST_TRIANGLES.saturating_sub(self.subdivided) {
                let message =
                    format!("only {level} of {levels} levels of subdivision are done: the mesh gets too large");
                self.warn(statement.spot_of(name), message);
                break;
            }
            net = net.subdivided();
        }
        if levels > 0 {
            self.subdivided += net.triangles.len();
        }
        net.positions = net.moved(limit_weight, 0.2);
        let positions = net.positions.iter().map(|p| p.as_vec3().to_array()).collect();
        let mut mesh = MeshData { positions, triangles: net.triangles, ..MeshData::default() };
        if mesh.fault().is_none() {
            mesh.compute_normals();
        }
        self.placed_mesh(statement, Arc::new(mesh))
    }
}

/// A net of triangles.
struct Net {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
}

/// What lies around an edge: the sum of the corners opposite to it, and how many they are.
type Edges = HashMap<[u32; 2], (DVec3, u32)>;

/// The weight of each of `valence` neighbours of an inner vertex.
fn step_weight(valence: f64) -> f64 {
    if valence == 3.0 { 3.0 / 16.0 } else { 3.0 / (8.0 * valence) }
}

/// The same for the surface after endlessly many steps.
fn limit_weight(valence: f64) -> f64 {
    1.0 / (valence + 3.0 / (8.0 * step_weight(valence)))
}

fn edge(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

impl Net {
    fn edges(&self) -> Edges {
        let mut edges = Edges::new();
        for &[a, b, c] in &self.triangles {
            for (from, to, opposite) in [(a, b, c), (b, c, a), (c, a, b)] {
                let around = edges.entry(edge(from, to)).or_insert((DVec3::ZERO, 0));
                *around = (around.0 + self.positions[opposite as usize], around.1 + 1);
            }
        }
        edges
    }

    /// All vertices moved towards the mean of their neighbours; on a border, of those on the border.
    fn moved(&self, weight: fn(f64) -> f64, border_weight: f64) -> Vec<DVec3> {
        let mut all = vec![(DVec3::ZERO, 0.0); self.positions.len()];
        let mut border = all.clone();
        for ([a, b], (_, count)) in self.edges() {
            for (vertex, neighbour) in [(a, b), (b, a)] {
                let neighbour = self.positions[neighbour as usize];
                let add = |sum: &mut (DVec3, f64)| *sum = (sum.0 + neighbour, sum.1 + 1.0);
                add(&mut all[vertex as usize]);
                if count != 2 {
                    add(&mut border[vertex as usize]);
                }
            }
        }
        let around = all.iter().zip(&border).map(|(all, border)| match border.1 {
            0.0 if all.1 > 0.0 => (all.0, all.1, weight(all.1)),
            _ => (border.0, border.1, border_weight),
        });
        let moved = self.positions.iter().zip(around);
        moved.map(|(&here, (sum, count, weight))| here * (1.0 - count * weight) + sum * weight).collect()
    }

    /// Four triangles for each.
    fn subdivided(&self) -> Net {
        let mut positions = self.moved(step_weight, 1.0 / 8.0);
        let mut middles: HashMap<[u32; 2], u32> = HashMap::new();
        let edges = self.edges();
        let mut triangles = Vec::with_capacity(4 * self.triangles.len());
        for &[a, b, c] in &self.triangles {
            let [ab, bc, ca] = [edge(a, b), edge(b, c), edge(c, a)].map(|ends| {
                *middles.entry(ends).or_insert_with(|| {
                    let [from, to] = ends.map(|end| self.positions[end as usize]);
                    positions.push(match edges.get(&ends) {
                        Some(&(opposite, 2)) => (from + to) * 0.375 + opposite * 0.125,
                        _ => (from + to) * 0.5,
                    });
                    positions.len() as u32 - 1
                })
            });
            triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        Net { positions, triangles }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_octahedron_becomes_round_and_keeps_its_middle() {
        let axes = [DVec3::X, DVec3::Y, DVec3::Z];
        let positions = axes.into_iter().chain(axes.map(|axis| -axis)).collect();
        let triangles = vec![[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]];
        let mut net = Net { positions, triangles };
        for _ in 0..3 {
            net = net.subdivided();
        }
        net.positions = net.moved(limit_weight, 0.2);
        assert_eq!(net.triangles.len(), 8 * 64);
        let lengths: Vec<f64> = net.positions.iter().map(|p| p.length()).collect();
        let (least, most) = lengths.iter().fold((f64::MAX, 0.0f64), |(a, b), &x| (a.min(x), b.max(x)));
        assert!(most / least < 1.2, "{least} to {most}");
        assert!(net.positions.iter().sum::<DVec3>().length() < 1e-9);
    }

    #[test]
    fn the_border_of_a_flat_square_stays_flat() {
        let corner = |x: f64, y: f64| DVec3::new(x, y, 0.0);
        let positions = vec![corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)];
        let net = Net { positions, triangles: vec![[0, 1, 2], [0, 2, 3]] }.subdivided().subdivided();
        assert_eq!((net.triangles.len(), net.positions.len()), (32, 25));
        assert!(net.positions.iter().all(|p| p.z == 0.0 && p.x >= 0.0 && p.x <= 1.0));
    }
}
