//! Primitives of meshes, as triangles.

use std::sync::Arc;

use super::Importer;
use super::accessor::{Elements, elements};
use super::document::{Attributes, Primitive};
use crate::error::Result;
use crate::geometry::MeshData;

/// What of a primitive becomes a geometry; equal ones are the same.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct GeometryKey {
    attributes: Attributes,
    indices: Option<usize>,
    mode: u32,
    /// Morph targets with the bits of their weights.
    targets: Vec<(Attributes, u32)>,
    /// Whether the triangles are turned round, as a mirror does.
    pub mirrored: bool,
}

impl GeometryKey {
    /// `uv_set` chooses the texture coordinates; `weights` are those of the morph targets.
    pub(super) fn new(primitive: &Primitive, uv_set: u32, weights: &[f32], mirrored: bool) -> GeometryKey {
        let mut attributes = primitive.attributes.clone();
        attributes.texcoord_0 = if uv_set == 1 { attributes.texcoord_1 } else { attributes.texcoord_0 };
        attributes.texcoord_1 = None;
        let weighted = primitive.targets.iter().zip(weights).filter(|(_, weight)| **weight != 0.0);
        let targets = weighted.map(|(target, weight)| (target.clone(), weight.to_bits())).collect();
        GeometryKey { attributes, indices: primitive.indices, mode: primitive.mode, targets, mirrored }
    }
}

impl Importer<'_> {
    /// The triangles of a primitive, which stands at `path`; nothing where there are none.
    pub(super) fn geometry(&mut self, key: GeometryKey, path: &str) -> Result<Option<Arc<MeshData>>> {
        if let Some(known) = self.geometries.get(&key) {
            return Ok(known.clone());
        }
        let data = self.triangles(&key, path)?.map(Arc::new);
        self.geometries.insert(key, data.clone());
        Ok(data)
    }

    fn triangles(&mut self, key: &GeometryKey, path: &str) -> Result<Option<MeshData>> {
        match key.mode {
            0..=3 => {
                self.warn(path, "points and lines are left out");
                return Ok(None);
            }
            4..=6 => {}
            mode => return Err(self.spots.fault(path, format!("there is no mode {mode}"))),
        }
        let Some(positions) = key.attributes.position else {
            self.warn(path, "a mesh without positions is left out");
            return Ok(None);
        };
        let count = self.elements(positions, &[3])?.count;
        let indices = self.indices(key, path, count)?;
        self.spend(indices.len(), path)?;
        if key.mode == 4 && !indices.len().is_multiple_of(3) {
            self.warn(path, "vertices at the end of a list that do not make a triangle are left out");
        }
        let triangles = triangles(key.mode, &indices);
        if triangles.is_empty() {
            self.warn(path, "a mesh without triangles is left out");
            return Ok(None);
        }
        let mut data = MeshData { triangles, ..MeshData::default() };
        let vertices = keep_used(&mut data.triangles, count);
        self.vertices(key, path, count, &vertices, &mut data)?;
        if key.mirrored {
            data.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        }
        match data.fault() {
            Some(fault) => Err(self.spots.fault(path, fault)),
            None => {
                data.normalize_normals();
                Ok(Some(data))
            }
        }
    }

    fn indices(&self, key: &GeometryKey, path: &str, count: usize) -> Result<Vec<u32>> {
        let too_many = || self.spots.fault(path, format!("{count} vertices are too many"));
        let Some(accessor) = key.indices else {
            return Ok((0..u32::try_from(count).map_err(|_| too_many())?).collect());
        };
        let elements = self.elements(accessor, &[1])?;
        if !elements.are_indices() {
            return Err(self.spots.fault(&format!("accessors[{accessor}]"), "indices must be whole numbers"));
        }
        let indices: Vec<u32> = (0..elements.count).map(|at| elements.index(at)).collect();
        match indices.iter().position(|&index| index as usize >= count) {
            Some(at) => Err(self.spots.fault(
                path,
                format!("index {at} names vertex {}, but there are only {count} (numbered from 0)", indices[at]),
            )),
            None => Ok(indices),
        }
    }

    /// Reads what is known of `vertices`.
    fn vertices(
        &self,
        key: &GeometryKey,
        path: &str,
        count: usize,
        vertices: &[u32],
        data: &mut MeshData,
    ) -> Result<()> {
        let open = |accessor: Option<usize>, widths: &[usize]| -> Result<Option<Elements<'_>>> {
            let Some(accessor) = accessor else { return Ok(None) };
            let elements = self.elements(accessor, widths)?;
            if elements.count != count {
                let message = format!("{count} positions, but {} elements in accessors[{accessor}]", elements.count);
                return Err(self.spots.fault(path, message));
            }
            Ok(Some(elements))
        };
        let vectors = |elements: Option<Elements>| -> Vec<[f32; 3]> {
            let elements = elements.as_ref();
            elements.map_or(Vec::new(), |list| vertices.iter().map(|&vertex| list.get(vertex as usize)).collect())
        };
        data.positions = vectors(open(key.attributes.position, &[3])?);
        data.normals = vectors(open(key.attributes.normal, &[3])?);
        data.colors = vectors(open(key.attributes.color_0, &[3, 4])?);
        data.colors.as_flattened_mut().iter_mut().for_each(|value| *value = value.clamp(0.0, 1.0));
        if let Some(uvs) = open(key.attributes.texcoord_0, &[2])? {
            // In glTF v runs downwards.
            data.uvs = vertices.iter().map(|&vertex| uvs.get(vertex as usize)).map(|[u, v]| [u, 1.0 - v]).collect();
        }
        for (target, weight) in &key.targets {
            let weight = f32::from_bits(*weight);
            for (list, accessor) in [(&mut data.positions, target.position), (&mut data.normals, target.normal)] {
                let change = vectors(open(accessor, &[3])?);
                for (value, change) in list.as_flattened_mut().iter_mut().zip(change.as_flattened()) {
                    *value += weight * change;
                }
            }
        }
        Ok(())
    }

    fn elements(&self, accessor: usize, widths: &[usize]) -> Result<Elements<'_>> {
        elements(self.document, &self.buffers, &self.spots, accessor, widths)
    }

    /// Vectors of an accessor, one an element.
    pub(super) fn vectors<const N: usize>(&self, accessor: usize) -> Result<Vec<[f32; N]>> {
        let elements = self.elements(accessor, &[N])?;
        Ok((0..elements.count).map(|index| elements.get(index)).collect())
    }

    /// Counts what the meshes hold. Accessors may lie on top of each other, so that a small file could speak of more
    /// than any memory holds.
    pub(super) fn spend(&mut self, elements: usize, path: &str) -> Result<()> {
        self.spent += elements;
        if self.spent > 64 * self.buffers.size() + 4096 {
            let message = "the meshes use the same bytes over and over, far more often than a real file would";
            return Err(self.spots.fault(path, message));
        }
        Ok(())
    }
}

/// Cuts a list, strip or fan of vertices into triangles; those that name a vertex twice are left out, as is a rest.
fn triangles(mode: u32, indices: &[u32]) -> Vec<[u32; 3]> {
    let is_proper = |[a, b, c]: &[u32; 3]| a != b && b != c && c != a;
    let in_threes = |window: &[u32]| [window[0], window[1], window[2]];
    match mode {
        // Every other triangle of a strip is turned round.
        5 => (indices.windows(3).enumerate())
            .map(|(number, window)| match number % 2 {
                0 => in_threes(window),
                _ => [window[0], window[2], window[1]],
            })
            .filter(is_proper)
            .collect(),
        6 => match indices.split_first() {
            Some((&center, rim)) => rim.windows(2).map(|edge| [edge[0], edge[1], center]).filter(is_proper).collect(),
            None => Vec::new(),
        },
        _ => indices.chunks_exact(3).map(in_threes).filter(is_proper).collect(),
    }
}

/// The vertices that triangles use of `count`, to which they are renumbered. Primitives often share one list of
/// vertices, of which each uses a part.
fn keep_used(triangles: &mut [[u32; 3]], count: usize) -> Vec<u32> {
    if 3 * triangles.len() >= count {
        return (0..count as u32).collect();
    }
    let mut used = triangles.as_flattened().to_vec();
    used.sort_unstable();
    used.dedup();
    for vertex in triangles.as_flattened_mut() {
        *vertex = used.binary_search(vertex).map_or(0, |at| at as u32);
    }
    used
}
