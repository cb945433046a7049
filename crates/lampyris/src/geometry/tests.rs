//! Whatever the tree, the instructions and the placement, a ray meets the same.

use std::sync::Arc;

use glam::{EulerRot, Mat3, Mat4, Quat, Vec2, Vec3};
use proptest::prelude::*;

use super::bvh::{Best, Packet, Portable, TriangleRay};
use super::*;

fn mesh(positions: Vec<[f32; 3]>, triangles: Vec<[u32; 3]>) -> Shape {
    let data = MeshData { positions, triangles, ..MeshData::default() };
    Shape::Mesh(Mesh::new(&Arc::new(data), &Mat4::IDENTITY))
}

fn surfaces(shapes: impl IntoIterator<Item = Shape>) -> Surfaces {
    let mut builder = SurfacesBuilder::default();
    shapes.into_iter().for_each(|shape| _ = builder.add(shape, false));
    builder.build()
}

/// The nearest triangle of all, tried one after the other.
fn brute_force(mesh: &Mesh, ray: &Ray, max: f32) -> Option<(f32, u32)> {
    let mut best = Best { distance: max.next_down(), number: u32::MAX, barycentric: Vec2::ZERO };
    for index in 0..mesh.len() {
        let packet = Packet::new([(index as u32, mesh.corners(index))].into_iter());
        packet.closest(Portable, &TriangleRay::new(ray), &mut best);
    }
    (best.number != u32::MAX).then_some((best.distance, best.number))
}

/// Coordinates that often coincide.
fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![-1.0_f32..1.0, prop::sample::select(vec![-1.0_f32, -0.5, 0.0, 0.5, 1.0])]
}

fn point() -> impl Strategy<Value = [f32; 3]> {
    [coordinate(), coordinate(), coordinate()]
}

proptest! {
    /// Triangles large and small, slivers and points, in any unit; rays from their corners, too, and along the axes.
    #[test]
    fn a_ray_meets_the_nearest_triangle_of_all_on_every_processor(
        points in prop::collection::vec((point(), 0.0_f32..0.3), 3..60),
        triangles in prop::collection::vec((0_u32..60, 0_u32..60, 0_u32..60), 1..150),
        rays in prop::collection::vec((point(), point(), any::<Option<prop::sample::Index>>()), 20),
        exponent in prop::sample::select(vec![-40, -10, 0, 10, 40]),
    ) {
        let scale = 2.0_f32.powi(exponent);
        let count = points.len() as u32;
        let triangles: Vec<[u32; 3]> = triangles.into_iter().map(|(a, b, c)| [a % count, b % count, c % count]).collect();
        let positions: Vec<[f32; 3]> = points.iter().map(|(p, _)| p.map(|x| x * scale)).collect();
        let shape = mesh(positions.clone(), triangles.clone());
        let Shape::Mesh(all) = shape.clone() else { unreachable!() };
        let (own, portable) = (surfaces([shape.clone()]), surfaces([shape]).portable());
        for (origin, direction, corner) in rays {
            let direction = Vec3::from(direction).normalize_or(Vec3::Y);
            let origin = corner.map_or(Vec3::from(origin) * scale, |index| Vec3::from(*index.get(&positions)));
            let ray = Ray { origin, direction };
            let hit = own.closest(&ray, f32::INFINITY);
            prop_assert_eq!(hit, portable.closest(&ray, f32::INFINITY));
            prop_assert_eq!(hit.map(|hit| (hit.distance, hit.triangle)), brute_force(&all, &ray, f32::INFINITY));
            for max in [0.1 * scale, 0.5 * scale, f32::INFINITY] {
                let blocked = brute_force(&all, &ray, max).is_some();
                prop_assert_eq!(own.blocked(&ray, max), blocked);
                prop_assert_eq!(portable.blocked(&ray, max), blocked);
            }
        }
    }

    /// Two triangles have an edge in common; rays at that edge meet one of them.
    #[test]
    fn no_ray_passes_between_two_triangles(
        corners in [point(), point(), point(), point()],
        along in 0.01_f32..0.99,
        origin in point(),
        exponent in -30..30,
    ) {
        let scale = 2.0_f32.powi(exponent);
        let [a, b, c, d] = corners.map(|corner| Vec3::from(corner) * scale);
        let (target, origin) = (a.lerp(b, along), 4.0 * scale * Vec3::from(origin));
        // Not along either triangle, and on both sides of the edge.
        let seen = (target - origin).normalize_or_zero();
        let side = |corner: Vec3| (b - a).cross(corner - a).normalize_or_zero().dot(seen);
        prop_assume!(side(c) * side(d) < 0.0 && side(c).abs().min(side(d).abs()) > 0.01);
        let both = surfaces([mesh([a, b, c, d].map(|p| p.to_array()).to_vec(), vec![[0, 1, 2], [1, 0, 3]])]);
        let ray = Ray { origin, direction: seen };
        prop_assert!(both.closest(&ray, f32::INFINITY).is_some());
    }

    /// No ray does harm.
    #[test]
    fn rays_that_are_none_meet_nothing(numbers in prop::array::uniform6(prop::sample::select(vec![
        0.0_f32, -0.0, 1.0, -1.0, f32::MAX, f32::MIN_POSITIVE, 1e-42, f32::INFINITY, f32::NEG_INFINITY, f32::NAN,
    ]))) {
        let [x, y, z, dx, dy, dz] = numbers;
        let own = surfaces([soup(50, 1.0)]);
        let portable = surfaces([soup(50, 1.0)]).portable();
        let ray = Ray { origin: Vec3::new(x, y, z), direction: Vec3::new(dx, dy, dz) };
        let hit = own.closest(&ray, f32::INFINITY);
        prop_assert_eq!(hit, portable.closest(&ray, f32::INFINITY));
        prop_assert!(hit.is_none() || ray.origin.is_finite() && ray.direction.is_finite());
        prop_assert_eq!(own.blocked(&ray, f32::INFINITY), portable.blocked(&ray, f32::INFINITY));
    }
}

/// Small triangles spread over a cube, always the same.
fn soup(count: u32, scale: f32) -> Shape {
    let fraction = |index: u32, by: f64| (f64::from(index) * by).fract() as f32;
    let mut positions = Vec::new();
    for index in 0..count {
        let center = [0.618_033_988, 0.754_877_666, 0.569_840_291].map(|by| fraction(index + 1, by) - 0.5);
        for corner in 1..4 {
            let off = [0.324_7, 0.871_3, 0.145_7].map(|by| 0.1 * (fraction(3 * index + corner, by) - 0.5));
            positions.push([0, 1, 2].map(|axis| scale * (center[axis] + off[axis])));
        }
    }
    mesh(positions, (0..count).map(|index| [3 * index, 3 * index + 1, 3 * index + 2]).collect())
}

#[test]
fn the_tree_is_the_same_on_any_number_of_threads() {
    let build = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        format!("{:?}", pool.install(|| surfaces([soup(20_000, 1.0), soup(10_000, 2.0)])))
    };
    let one = build(1);
    assert!(one == build(2) && one == build(5));
}

/// A triangle in each octave: a tree as deep as there are.
#[test]
fn what_is_met_in_a_deep_tree_is_right() {
    let octaves = -40..40_i32;
    let corners = octaves.clone().flat_map(|octave| {
        let x = 2.0_f32.powi(octave);
        (0..8).flat_map(move |step| {
            let x = x * (1.0 + 0.1 * step as f32);
            [[x, -x, -x], [x, x, -x], [x, 0.0, 2.0 * x]]
        })
    });
    let corners: Vec<[f32; 3]> = corners.collect();
    let all = surfaces([mesh(corners, (0..640).map(|index| [3 * index, 3 * index + 1, 3 * index + 2]).collect())]);
    for octave in octaves {
        let x = 2.0_f32.powi(octave);
        let ray = Ray { origin: Vec3::new(0.95 * x, 0.0, 0.0), direction: Vec3::X };
        let hit = all.closest(&ray, f32::INFINITY).expect("a triangle");
        assert_eq!(hit.triangle as i32, 8 * (octave + 40));
    }
}

/// One shape of each kind, in a group.
fn shapes() -> Vec<Shape> {
    let uvs = vec![[0.1, 0.2], [0.9, 0.1], [0.4, 0.8]];
    let data = MeshData {
        positions: vec![[-0.5, 0.5, 0.2], [0.4, 0.6, 0.1], [0.0, 0.9, 0.7]],
        normals: vec![[0.0, 0.6, 0.8], [0.0, 0.0, 1.0], [0.6, 0.0, 0.8]],
        uvs,
        triangles: vec![[0, 1, 2]],
        ..MeshData::default()
    };
    let turned = Mat3::from_euler(EulerRot::XYZ, 0.3, 0.7, 1.1);
    vec![
        Shape::Sphere(Sphere::new(Vec3::new(0.2, -0.3, 0.4), 0.3, turned)),
        Shape::Quad(Quad::new(Vec3::new(-0.9, -0.9, -0.5), Vec3::new(0.6, 0.1, 0.0), Vec3::new(0.2, 0.7, 0.3))),
        Shape::Disk(Disk::new(Vec3::new(0.5, 0.5, -0.5), Vec3::new(0.3, 0.0, 0.1), Vec3::new(0.0, 0.4, 0.0))),
        Shape::Cylinder(Cylinder::new(Vec3::new(-0.7, 0.3, 0.5), Vec3::new(-0.3, 0.2, 0.9), 0.2)),
        Shape::Mesh(Mesh::new(&Arc::new(data), &Mat4::IDENTITY)),
    ]
}

/// Rays through a cube.
fn rays(count: u32) -> impl Iterator<Item = Ray> {
    let number = |index: u32, by: f64| 2.0 * (f64::from(index) * by).fract() as f32 - 1.0;
    (1..=count).map(move |index| {
        let [a, b] = [[0.618_033_988, 0.754_877_666, 0.569_840_291], [0.819_172_513, 0.671_043_606, 0.549_700_478]]
            .map(|bys| Vec3::from_array(bys.map(|by| number(index, by))));
        Ray { origin: 2.0 * a, direction: (b - 2.0 * a).normalize() }
    })
}

fn placements() -> Vec<Mat4> {
    let turned = Quat::from_euler(EulerRot::XYZ, 0.4, -0.8, 1.9);
    vec![
        Mat4::from_scale_rotation_translation(Vec3::splat(0.5), turned, Vec3::new(0.3, 0.2, -0.1)),
        Mat4::from_scale_rotation_translation(Vec3::new(-0.7, 0.4, 1.3), turned.inverse(), Vec3::new(-0.4, 0.1, 0.2)),
        Mat4::from_scale_rotation_translation(Vec3::splat(1e-3), turned, Vec3::new(0.9, 0.9, 0.9)),
    ]
}

/// Triangles can be moved to the world by any transform: there the instance is compared with them.
#[test]
fn instances_are_what_their_flattened_meshes_are() {
    let Shape::Mesh(soup) = soup(400, 1.8) else { unreachable!() };
    let corners: Vec<[f32; 3]> = (0..soup.len()).flat_map(|index| soup.corners(index)).collect();
    let normals = corners.iter().map(|&p| (Vec3::from(p) + 2.0).normalize().to_array()).collect();
    let triangles = (0..400).map(|index| [3 * index, 3 * index + 1, 3 * index + 2]).collect();
    let data = Arc::new(MeshData { positions: corners, normals, triangles, ..MeshData::default() });
    let (mut placed, mut flat) = (SurfacesBuilder::default(), SurfacesBuilder::default());
    let group = placed.add_group([(Shape::Mesh(Mesh::new(&data, &Mat4::IDENTITY)), false)]);
    for placement in placements() {
        placed.add_instance(group, &placement);
        flat.add(Shape::Mesh(Mesh::new(&data, &placement)), false);
    }
    let (placed, flat) = (placed.build(), flat.build());
    let (mut met, mut differ) = (0, 0);
    for ray in rays(8000) {
        let (hit, expected) = (placed.closest(&ray, f32::INFINITY), flat.closest(&ray, f32::INFINITY));
        assert_eq!(placed.blocked(&ray, f32::INFINITY), hit.is_some());
        let (Some(hit), Some(expected)) = (hit, expected) else {
            differ += u32::from(hit.is_some() != expected.is_some());
            continue;
        };
        if (hit.instance, hit.triangle) != (Some(expected.shape), expected.triangle) {
            differ += 1;
            continue;
        }
        met += 1;
        assert_eq!(hit.shape, 0);
        assert!((hit.distance - expected.distance).abs() < 1e-5);
        let (a, b) = (placed.surface(&ray, &hit), flat.surface(&ray, &expected));
        assert!(a.position.distance(b.position) <= a.error + b.error, "{a:?} {b:?}");
        // Scaled by different factors before or after they are mixed, normals differ a little.
        assert!(a.shading_normal.distance(b.shading_normal) < 0.05);
        // A mirror turns the corners of a flattened triangle round, but not the inside out.
        assert!(a.normal.dot(b.normal).abs() > 0.9999);
        // At an edge seen from the side, barycentric coordinates are worth less.
        assert!(a.uv.distance(b.uv) < 1e-2);
        assert!(a.error < 1e-4);
    }
    assert!(met > 1000 && differ < 5, "{met} the same, {differ} not");
}

#[test]
fn what_stands_on_an_instance_does_not_see_it_again() {
    let mut builder = SurfacesBuilder::default();
    let group = builder.add_group(shapes().into_iter().map(|shape| (shape, false)));
    placements().iter().for_each(|placement| builder.add_instance(group, placement));
    let all = builder.build();
    let mut kinds = [0; 5];
    for ray in rays(20_000) {
        let Some(hit) = all.closest(&ray, f32::INFINITY) else { continue };
        kinds[hit.shape as usize] += 1;
        let surface = all.surface(&ray, &hit);
        let back = surface.spawn(-ray.direction);
        let again = all.closest(&back, 0.5 * hit.distance);
        assert!(again.is_none(), "{hit:?} {again:?}");
        assert!(!all.occluded(back.origin, ray.origin));
    }
    assert!(kinds.iter().all(|&count| count > 50), "{kinds:?}");
}

#[test]
fn instances_in_a_tree_are_met_as_those_tried_in_turn() {
    let mut builder = SurfacesBuilder::default();
    let group = builder.add_group(shapes().into_iter().map(|shape| (shape, false)));
    let step = |index: i32| Mat4::from_translation(3.0 * Vec3::new(index as f32, 0.0, 0.0)) * placements()[0];
    (0..40).for_each(|index| builder.add_instance(group, &step(index)));
    let many = builder.build();
    for index in 0..40 {
        let mut builder = SurfacesBuilder::default();
        let group = builder.add_group(shapes().into_iter().map(|shape| (shape, false)));
        builder.add_instance(group, &step(index));
        let one = builder.build();
        for ray in rays(200) {
            // Across the row, so that no other instance is in the way.
            let ray = Ray { origin: ray.origin + step(index).transform_point3(Vec3::ZERO), ..ray };
            let (Some(hit), Some(expected)) = (many.closest(&ray, 1.5), one.closest(&ray, 1.5)) else { continue };
            if hit.instance == Some(index as u32) {
                assert_eq!(Hit { instance: Some(0), ..hit }, expected);
            }
        }
        assert!(
            rays(200).any(|ray| one.blocked(&Ray { origin: ray.origin + step(index).w_axis.truncate(), ..ray }, 9.0))
        );
    }
}

#[test]
fn partials_are_the_differences_of_positions_by_texture_coordinates() {
    let mut builder = SurfacesBuilder::default();
    shapes().into_iter().for_each(|shape| _ = builder.add(shape, false));
    builder.add(Shape::Plane(Plane::new(Vec3::new(0.3, 1.0, 0.2), 0.8)), false);
    builder.add(mesh(vec![[-0.3, -0.2, 0.9], [0.5, -0.3, 0.8], [0.1, 0.4, 1.0]], vec![[0, 1, 2]]), false);
    let group = builder.add_group(shapes().into_iter().map(|shape| (shape, false)));
    builder.add_instance(group, &placements()[1]);
    let all = builder.build();
    let mut kinds = [0; 12];
    for ray in rays(20_000) {
        let Some(hit) = all.closest(&ray, f32::INFINITY) else { continue };
        let surface = all.surface(&ray, &hit);
        let aside = surface.normal.any_orthonormal_vector();
        let (along_u, along_v) = all.partials(&hit, &surface);
        for (step, along) in [(3e-4, aside), (3e-4, aside.cross(surface.normal))] {
            let near =
                Ray { origin: ray.origin, direction: (surface.position + along * step - ray.origin).normalize() };
            let Some(other) = all.closest(&near, f32::INFINITY) else { continue };
            if (other.shape, other.instance) != (hit.shape, hit.instance)
                || ray.direction.dot(surface.normal).abs() < 0.2
            {
                continue;
            }
            let beside = all.surface(&near, &other);
            let by = beside.uv - surface.uv;
            // Neither over the seam nor at a pole.
            if by.abs().max_element() > 0.005 {
                continue;
            }
            let moved = beside.position - surface.position;
            let predicted = along_u * by.x + along_v * by.y;
            assert!(moved.distance(predicted) < 0.03 * step + 0.03 * moved.length(), "{hit:?} {moved} {predicted}");
            kinds[hit.shape as usize] += 1;
        }
    }
    assert!(kinds.iter().all(|&count| count > 20), "{kinds:?}");
}
