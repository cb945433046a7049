//! What the tree over triangles is built from: boxes of one triangle, or of two that lie side by side.

use glam::{Vec3, Vec3A};

use super::Bounds;
use super::bvh::{Reference, References};

/// Two triangles whose numbers follow on each other, as those of the halves of a square often do, have one box if its
/// area is less than this share of theirs. Half the references make a tree in half the time, and not a worse one.
const WORTH_PAIRING: f32 = 0.8;

/// References to so many triangles, by number and corners.
pub(super) fn references(count: u32, corners: impl Fn(u32) -> [[f32; 3]; 3] + Sync) -> References {
    References::new(count as usize, |first, places| {
        let (mut used, end) = (0, first + places.len() as u32);
        let mut push = |number, is_pair, bounds| {
            places[used] = Reference::new(number, is_pair, bounds);
            used += 1;
        };
        let mut single: Option<Bounds> = None;
        for number in first..end {
            let own = box_of(corners(number));
            let Some(before) = single.replace(own) else { continue };
            let both = before.union(own);
            let is_pair = both.half_area() < WORTH_PAIRING * (before.half_area() + own.half_area());
            push(number - 1, is_pair, if is_pair { both } else { before });
            if is_pair {
                single = None;
            }
        }
        if let Some(own) = single {
            push(end - 1, false, own);
        }
        used
    })
}

/// The box around a triangle and the points that rounding may take for it: two units in the last place of its size, and
/// the next number or the one after it, as the size may vanish beside the coordinates.
#[inline]
fn box_of(corners: [[f32; 3]; 3]) -> Bounds {
    let [a, b, c] = corners.map(Vec3A::from_array);
    let (min, max) = (a.min(b).min(c), a.max(b).max(c));
    let pad = Vec3A::splat((max - min).max_element() * (2.0 * f32::EPSILON));
    // The least normal number is for those around zero.
    let beside = |x: Vec3A| x.abs() * f32::EPSILON + f32::MIN_POSITIVE;
    let (min, max) = (min - pad, max + pad);
    Bounds { min: Vec3::from(min - beside(min)), max: Vec3::from(max + beside(max)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square's halves, a triangle far away, and two squares.
    fn triangle(number: u32) -> [[f32; 3]; 3] {
        let [a, b, c, d] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.3], [0.0, 1.0, 0.3]];
        let (from, corners) = [
            (0.0, [a, b, c]),
            (0.0, [a, c, d]),
            (50.0, [a, b, c]),
            (1.0, [a, b, c]),
            (1.0, [a, c, d]),
            (2.0, [b, c, a]),
            (2.0, [d, a, c]),
        ][number as usize];
        corners.map(|[x, y, z]| [x + from, y, z])
    }

    #[test]
    fn the_halves_of_squares_are_one_reference() {
        let references = references(7, triangle);
        let found = references.rows().concat();
        let found: Vec<(u32, bool)> = found.iter().map(|found| (found.number(), found.is_pair())).collect();
        assert_eq!(found, [(0, true), (2, false), (3, true), (5, true)]);
    }

    #[test]
    fn boxes_are_beyond_the_next_number_from_their_corners() {
        for x in [0.0, -0.0, 1e-45, f32::MIN_POSITIVE, 0.1, 1.0, 1.0_f32.next_down(), 3e7, f32::MAX] {
            for x in [x, -x] {
                let bounds = box_of([[x; 3]; 3]);
                assert!(bounds.min.x < x && x < bounds.max.x, "{x} {bounds:?}");
                assert!(bounds.max.x <= x.next_up().next_up() || x.abs() <= f32::MIN_POSITIVE, "{x} {bounds:?}");
            }
        }
    }
}
