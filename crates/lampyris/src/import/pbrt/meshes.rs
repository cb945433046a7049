//! Shapes made of triangles.

use std::f64::consts::{PI, TAU};
use std::path::Path;
use std::sync::Arc;

use glam::{DVec3, Vec3};

use super::super::ply;
use super::Importer;
use super::shape::Placed;
use super::statement::Statement;
use crate::error::Result;
use crate::geometry::MeshData;
use crate::scene::description::GeometryDescription;

/// Pieces along each side of a bilinear patch that is not flat.
const PIECES: usize = 8;

impl Importer<'_> {
    pub(super) fn triangle_mesh(&mut self, statement: &Statement) -> Result<Option<Placed>> {
        let mut mesh = self.vertices(statement)?;
        let triangles = self.indices(statement, mesh.positions.len(), 3)?;
        mesh.triangles = triangles.as_chunks().0.to_vec();
        statement.ignore(&["S", "faceIndices", "edgelength"]);
        self.placed_mesh(statement, Arc::new(mesh))
    }

    pub(super) fn ply_mesh(&mut self, statement: &Statement) -> Result<Option<Placed>> {
        let spot = statement.spot_of("filename");
        let Some(file) = self.placed(statement.text("filename"))?.map(str::to_string) else {
            return Err(self.reader.fault(spot, "a plymesh needs a 'filename'"));
        };
        if statement.parameter("displacement").is_some() {
            let spot = statement.spot_of("displacement");
            self.warn(spot, "displacement of meshes is not supported: the mesh stays as it is");
        }
        statement.ignore(&["displacement.edgelength", "displacement.uvscale", "edgelength"]);
        let mesh = match self.meshes.get(&file) {
            Some(mesh) => Arc::clone(mesh),
            None => {
                let bytes = self.reader.bytes(Path::new(&file), spot)?;
                let shown = self.reader.folder.shown(Path::new(&file));
                let mesh = ply::read(&shown.to_string_lossy(), &bytes)?;
                let mesh = Arc::new(mesh);
                self.meshes.insert(file, Arc::clone(&mesh));
                mesh
            }
        };
        self.placed_mesh(statement, mesh)
    }

    /// Flat patches become two triangles, others a grid of them.
    pub(super) fn bilinear_mesh(&mut self, statement: &Statement) -> Result<Option<Placed>> {
        let vertices = self.vertices(statement)?;
        let corners = self.indices(statement, vertices.positions.len(), 4)?;
        statement.ignore(&["faceIndices"]);
        if statement.has("emissionfilename") {
            statement.ignore(&["emissionfilename"]);
            self.warn(statement.spot_of("emissionfilename"), "the emission of patches by a picture is not supported");
        }
        let mut mesh = MeshData::default();
        for patch in corners.as_chunks().0 {
            add_patch(&mut mesh, &vertices, patch.map(|corner| corner as usize));
        }
        self.placed_mesh(statement, Arc::new(mesh))
    }

    /// Positions, normals and texture coordinates, which other statements index.
    pub(super) fn vertices(&mut self, statement: &Statement) -> Result<MeshData> {
        let positions = self.triples(statement, "P")?;
        if positions.is_empty() {
            return Err(self.reader.fault(statement.spot, format!("{} needs positions 'P'", statement.called())));
        }
        let mut mesh = MeshData { normals: self.triples(statement, "N")?, positions, ..MeshData::default() };
        let name = ["uv", "st"].into_iter().find(|name| statement.has(name)).unwrap_or("uv");
        let uvs = self.placed(statement.numbers(name))?.unwrap_or(&[]);
        mesh.uvs = uvs.as_chunks().0.iter().map(|pair: &[f64; 2]| pair.map(|value| value as f32)).collect();
        let count = mesh.positions.len();
        for (name, length) in [("N", mesh.normals.len()), (name, mesh.uvs.len())] {
            if length != 0 && length != count {
                let message = format!("there are {count} positions, but {length} of '{name}': these are left out");
                self.warn(statement.spot_of(name), message);
            }
        }
        if mesh.normals.len() != count {
            mesh.normals.clear();
        }
        if mesh.uvs.len() != count {
            mesh.uvs.clear();
        }
        Ok(mesh)
    }

    fn triples(&self, statement: &Statement, name: &'static str) -> Result<Vec<[f32; 3]>> {
        let numbers = self.placed(statement.numbers(name))?.unwrap_or(&[]);
        let (triples, rest) = numbers.as_chunks::<3>();
        if !rest.is_empty() {
            let message = format!("'{name}' must hold three numbers for each vertex, but has {}", numbers.len());
            return Err(self.reader.fault(statement.spot_of(name), message));
        }
        Ok(triples.iter().map(|triple| triple.map(|value| value as f32)).collect())
    }

    /// The numbers of vertices, `group` of them at a time; the first ones if the file has none.
    pub(super) fn indices(&self, statement: &Statement, count: usize, group: usize) -> Result<Vec<u32>> {
        let spot = statement.spot_of("indices");
        let Some(numbers) = self.placed(statement.numbers("indices"))? else {
            if count == group {
                return Ok((0..group as u32).collect());
            }
            let message = format!("{} needs 'indices'", statement.called());
            return Err(self.reader.fault(spot, message));
        };
        if numbers.is_empty() || !numbers.len().is_multiple_of(group) {
            let message = format!("'indices' must hold {group} numbers for each face, but has {}", numbers.len());
            return Err(self.reader.fault(spot, message));
        }
        let mut indices = Vec::with_capacity(numbers.len());
        for &number in numbers {
            if !(number >= 0.0 && number.fract() == 0.0 && number < count as f64) {
                let message = format!("'indices' names vertex {number}, but there are only {count} (numbered from 0)");
                return Err(self.reader.fault(spot, message));
            }
            indices.push(number as u32);
        }
        Ok(indices)
    }

    /// A mesh in its own coordinates, each of its triangles turned so that its front is where pbrt has it.
    pub(super) fn placed_mesh(&mut self, statement: &Statement, mut mesh: Arc<MeshData>) -> Result<Option<Placed>> {
        if let Some(fault) = mesh.fault() {
            return Err(self.reader.fault(statement.spot, format!("{}: {fault}", statement.called())));
        }
        let is_flat = |[a, b, c]: [u32; 3]| a == b || b == c || c == a;
        if mesh.triangles.iter().any(|&triangle| is_flat(triangle)) {
            Arc::make_mut(&mut mesh).triangles.retain(|&triangle| !is_flat(triangle));
        }
        if mesh.triangles.is_empty() {
            self.warn(statement.spot, "this mesh has no triangles and is left out");
            return Ok(None);
        }
        if mesh.normals.is_empty() {
            return Ok(Some(self.outwards(GeometryDescription::Triangles(mesh))));
        }
        let transform = self.state.ctm;
        let wanted = if transform.determinant() < 0.0 { -1.0 } else { 1.0 };
        let is_turned = |mesh: &MeshData, triangle: [u32; 3]| wanted * agreement(mesh, triangle) < 0.0;
        if mesh.triangles.iter().any(|&triangle| is_turned(&mesh, triangle)) {
            let turned: Vec<bool> = mesh.triangles.iter().map(|&triangle| is_turned(&mesh, triangle)).collect();
            let triangles = &mut Arc::make_mut(&mut mesh).triangles;
            triangles.iter_mut().zip(turned).filter(|(_, turned)| *turned).for_each(|(corners, _)| corners.swap(1, 2));
        }
        Arc::make_mut(&mut mesh).normalize_normals();
        let geometry = GeometryDescription::Triangles(mesh);
        Ok(Some(Placed { geometry, transform, flip: self.state.reverse }))
    }
}

/// Positive where the order of the corners and the normals there agree on the front.
fn agreement(mesh: &MeshData, triangle: [u32; 3]) -> f64 {
    let at = |list: &[[f32; 3]], corner: u32| Vec3::from_array(list[corner as usize]).as_dvec3();
    let [a, b, c] = triangle.map(|corner| at(&mesh.positions, corner));
    let normal: DVec3 = triangle.iter().map(|&corner| at(&mesh.normals, corner)).sum();
    (b - a).cross(c - a).dot(normal)
}

/// A patch of the corners (0, 0), (1, 0), (0, 1), (1, 1).
fn add_patch(mesh: &mut MeshData, vertices: &MeshData, corners: [usize; 4]) {
    let position = |corner: usize| DVec3::from(vertices.positions[corner].map(f64::from));
    let [p00, p10, p01, p11] = corners.map(position);
    let normal = (p10 - p00).cross(p01 - p00);
    let size = (p11 - p00).length().max((p10 - p01).length());
    let flat = normal.dot(p11 - p00).abs() <= 1e-5 * normal.length() * size;
    let pieces = if flat { 1 } else { PIECES };
    let first = mesh.positions.len() as u32;
    let mix = |list: &[[f32; 3]], u: f64, v: f64| {
        let [a, b, c, d] = corners.map(|corner| DVec3::from(list[corner].map(f64::from)));
        a.lerp(b, u).lerp(c.lerp(d, u), v).as_vec3().to_array()
    };
    for row in 0..=pieces {
        for column in 0..=pieces {
            let (u, v) = (column as f64 / pieces as f64, row as f64 / pieces as f64);
            mesh.positions.push(mix(&vertices.positions, u, v));
            if !vertices.normals.is_empty() {
                mesh.normals.push(mix(&vertices.normals, u, v));
            }
            mesh.uvs.push(match vertices.uvs.is_empty() {
                true => [u as f32, v as f32],
                false => {
                    let [a, b, c, d] = corners.map(|corner| glam::DVec2::from(vertices.uvs[corner].map(f64::from)));
                    a.lerp(b, u).lerp(c.lerp(d, u), v).as_vec2().to_array()
                }
            });
        }
    }
    mesh.triangles.extend(grid(first, pieces as u32, pieces as u32));
}

/// The triangles of a grid of vertices, row by row from number `first`, with `columns` and `rows` of squares.
fn grid(first: u32, columns: u32, rows: u32) -> impl Iterator<Item = [u32; 3]> {
    (0..rows * columns).flat_map(move |square| {
        let a = first + square / columns * (columns + 1) + square % columns;
        let (b, c, d) = (a + 1, a + columns + 2, a + columns + 1);
        [[a, b, c], [a, c, d]]
    })
}

/// A sphere of triangles, for transforms that stretch it.
pub(super) fn ellipsoid(radius: f64) -> GeometryDescription {
    surface(|u, v| {
        let ((sine, cosine), (height, ring)) = ((TAU * u).sin_cos(), (PI * (v - 0.5)).sin_cos());
        let normal = DVec3::new(ring * cosine, ring * sine, height);
        (radius * normal, normal)
    })
}

/// A cylinder of triangles, likewise.
pub(super) fn tube(radius: f64, low: f64, high: f64) -> GeometryDescription {
    surface(|u, v| {
        let (sine, cosine) = (TAU * u).sin_cos();
        let normal = DVec3::new(cosine, sine, 0.0);
        (radius * normal + DVec3::Z * (low + v * (high - low)), normal)
    })
}

/// A grid over the unit square, its front where u × v is.
fn surface(at: impl Fn(f64, f64) -> (DVec3, DVec3)) -> GeometryDescription {
    const COLUMNS: u32 = 128;
    const ROWS: u32 = 64;
    let mut mesh = MeshData { triangles: grid(0, COLUMNS, ROWS).collect(), ..MeshData::default() };
    for row in 0..=ROWS {
        for column in 0..=COLUMNS {
            let (u, v) = (f64::from(column) / f64::from(COLUMNS), f64::from(row) / f64::from(ROWS));
            let (position, normal) = at(u, v);
            mesh.positions.push(position.as_vec3().to_array());
            mesh.normals.push(normal.as_vec3().to_array());
            mesh.uvs.push([u as f32, v as f32]);
        }
    }
    GeometryDescription::Triangles(Arc::new(mesh))
}
