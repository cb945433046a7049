//! What the mesh readers share: faces become triangles, and a mesh is checked before anyone sees it.

use glam::{DVec2, DVec3};

use crate::error::{Error, Result};
use crate::geometry::MeshData;

/// Containment tests per corner that [`triangulate`] may spend: any polygon of up to this many corners is done
/// properly, and no file can make us work longer than in proportion to its size.
const TESTS_PER_CORNER: usize = 4096;

/// Why the file `name` is of no use, where no line of it can be pointed at.
pub(super) fn unreadable(name: &str, reason: impl std::fmt::Display) -> Error {
    Error::new(format!("cannot read '{name}': {reason}"))
}

/// The mesh as a reader hands it out: triangles that name a vertex twice left out, normals of unit length, texture
/// coordinates finite.
///
/// # Errors
/// If nothing is left to draw, or [`MeshData::fault`] finds one.
pub(super) fn finish(name: &str, mut mesh: MeshData) -> Result<MeshData> {
    mesh.triangles.retain(|[a, b, c]| a != b && b != c && c != a);
    if mesh.triangles.is_empty() {
        return Err(unreadable(name, "it has no faces").with_hint("points and lines alone cannot be rendered"));
    }
    if let Some(fault) = mesh.fault() {
        return Err(unreadable(name, fault));
    }
    mesh.normalize_normals();
    for uv in mesh.uvs.as_flattened_mut() {
        if !uv.is_finite() {
            *uv = 0.0;
        }
    }
    Ok(mesh)
}

/// Adds the triangles of a polygon to `triangles`, as corner numbers from 0 in the order of the polygon.
///
/// Convex polygons become a fan around the first corner, as in Mitsuba 3; concave ones lose one ear after the other
/// [Meisters 1975], seen along the normal by Newell's method. What crosses itself becomes a fan too, and so does
/// the rest of a concave polygon of more than about 4096 corners on which ears are too hard to find.
pub(super) fn triangulate(polygon: &[[f32; 3]], triangles: &mut Vec<[u32; 3]>) {
    let mut rest: Vec<u32> = (0..polygon.len() as u32).collect();
    if rest.len() > 3 {
        let flat = flatten(polygon);
        if !is_convex(&flat) {
            cut_ears(&flat, &mut rest, triangles);
        }
    }
    for pair in rest.get(1..).unwrap_or(&[]).windows(2) {
        triangles.push([rest[0], pair[0], pair[1]]);
    }
}

/// The polygon seen from where it runs counterclockwise; all zero if it has no area.
fn flatten(polygon: &[[f32; 3]]) -> Vec<DVec2> {
    let first = polygon.first().map_or(DVec3::ZERO, |&p| DVec3::from(p.map(f64::from)));
    let corners: Vec<DVec3> = polygon.iter().map(|&p| DVec3::from(p.map(f64::from)) - first).collect();
    let around = corners.iter().zip(corners.iter().cycle().skip(1));
    let normal = around.map(|(a, b)| a.cross(*b)).sum::<DVec3>().normalize_or_zero();
    let (x, y) = if normal == DVec3::ZERO { (normal, normal) } else { normal.any_orthonormal_pair() };
    corners.iter().map(|corner| DVec2::new(corner.dot(x), corner.dot(y))).collect()
}

/// Twice the signed area of a triangle, positive if it runs counterclockwise.
fn area(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

/// Whether no corner turns right.
fn is_convex(polygon: &[DVec2]) -> bool {
    let count = polygon.len();
    (0..count).all(|i| area(polygon[i], polygon[(i + 1) % count], polygon[(i + 2) % count]) >= 0.0)
}

/// Moves ears from `rest` (corners of `polygon` in order) to `triangles` until three corners are left, no ear is
/// found, or the time is up.
fn cut_ears(polygon: &[DVec2], rest: &mut Vec<u32>, triangles: &mut Vec<[u32; 3]>) {
    let mut tests_left = rest.len().saturating_mul(TESTS_PER_CORNER);
    let mut tip = 0;
    let mut failures = 0;
    while rest.len() > 3 && failures < rest.len() {
        let count = rest.len();
        tip %= count;
        let ear = [rest[(tip + count - 1) % count], rest[tip], rest[(tip + 1) % count]];
        match tests_left.checked_sub(count) {
            Some(left) => tests_left = left,
            None => return,
        }
        if is_ear(polygon, ear, rest) {
            triangles.push(ear);
            rest.remove(tip);
            // The next corner is passed over, so that not all triangles meet in one point.
            tip += 1;
            failures = 0;
        } else {
            tip += 1;
            failures += 1;
        }
    }
}

/// Whether the triangle turns left and holds no other corner of what is left.
fn is_ear(polygon: &[DVec2], ear: [u32; 3], rest: &[u32]) -> bool {
    let [a, b, c] = ear.map(|corner| polygon[corner as usize]);
    let holds = |p: DVec2| area(a, b, p) >= 0.0 && area(b, c, p) >= 0.0 && area(c, a, p) >= 0.0;
    // A hole joined to the outline by a bridge visits places twice: a corner at the same place is no obstacle.
    let hinders = |p: DVec2| p != a && p != b && p != c && holds(p);
    area(a, b, c) > 0.0 && !rest.iter().any(|&corner| !ear.contains(&corner) && hinders(polygon[corner as usize]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cut(polygon: &[[f32; 3]]) -> Vec<[u32; 3]> {
        let mut triangles = Vec::new();
        triangulate(polygon, &mut triangles);
        triangles
    }

    /// The areas of the triangles of a polygon in the plane z = 0, negative where they are turned over.
    fn areas(polygon: &[[f32; 3]]) -> Vec<f64> {
        let corner = |i: u32| DVec2::new(polygon[i as usize][0].into(), polygon[i as usize][1].into());
        cut(polygon).into_iter().map(|[a, b, c]| area(corner(a), corner(b), corner(c)) / 2.0).collect()
    }

    /// A gear of `teeth` teeth: every other corner is reflex.
    fn gear(teeth: usize) -> Vec<[f32; 3]> {
        let corner = |i: usize| {
            let (sin, cos) = (i as f32 / (2 * teeth) as f32 * std::f32::consts::TAU).sin_cos();
            let radius = [1.0, 0.5][i % 2];
            [radius * cos, radius * sin, 0.0]
        };
        (0..2 * teeth).map(corner).collect()
    }

    #[test]
    fn convex_polygons_become_a_fan() {
        assert_eq!(cut(&[[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]]), [[0, 1, 2]]);
        let house = [[0., 0., 7.], [2., 0., 7.], [2., 1., 7.], [1., 2., 7.], [0., 1., 7.]];
        assert_eq!(cut(&house), [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
    }

    #[test]
    fn concave_polygons_are_cut_without_turned_over_triangles() {
        let arrow = [[2., 1., 0.], [0., 2., 0.], [1., 1., 0.], [0., 0., 0.]];
        for turn in 0..4 {
            let mut arrow = arrow;
            arrow.rotate_left(turn);
            let areas = areas(&arrow);
            assert!(areas.iter().all(|&area| area > 0.0), "{areas:?}");
            assert!((areas.iter().sum::<f64>() - 1.0).abs() < 1e-9, "{areas:?}");
        }
    }

    #[test]
    fn a_gear_keeps_its_area() {
        let gear = gear(500);
        let areas = areas(&gear);
        let sector = 0.5 * 0.5 * (std::f64::consts::TAU / 1000.0).sin();
        assert_eq!(areas.len(), 998);
        assert!(areas.iter().all(|&area| area > 0.0));
        assert!((areas.iter().sum::<f64>() - 1000.0 * sector).abs() < 1e-6);
    }

    #[test]
    fn the_side_that_a_polygon_shows_is_kept() {
        // The same arrow standing upright, once each way round.
        let mut arrow = vec![[5., 2., 1.], [5., 0., 2.], [5., 1., 1.], [5., 0., 0.]];
        for side in [1.0, -1.0] {
            for triangle in cut(&arrow) {
                let [a, b, c] = triangle.map(|i| DVec3::from(arrow[i as usize].map(f64::from)));
                assert!((b - a).cross(c - a).x * side > 0.0);
            }
            arrow.reverse();
        }
    }

    #[test]
    fn polygons_without_area_or_that_cross_themselves_still_give_two_triangles_fewer_than_corners() {
        assert_eq!(cut(&[[1., 1., 1.]; 6]).len(), 4);
        assert_eq!(cut(&[[0., 0., 0.], [1., 1., 0.], [1., 0., 0.], [0., 1., 0.]]).len(), 2);
        assert_eq!(cut(&[[f32::NAN; 3]; 5]).len(), 3);
        for few in 0..3 {
            assert_eq!(cut(&[[0.; 3]].repeat(few)), Vec::<[u32; 3]>::new());
        }
    }

    #[test]
    fn a_polygon_of_very_many_corners_takes_no_time_out_of_proportion() {
        assert_eq!(cut(&gear(20_000)).len(), 39_998);
    }
}
