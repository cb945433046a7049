//! Rays of the camera are drawn with the density that light tracing reckons with, and lead back to where they started.

mod common;

use common::statistics::assert_distribution;
use glam::{Vec2, Vec3};
use lampyris::camera::Camera;
use lampyris::sampler::Sampler;
use proptest::prelude::*;

fn camera(lens: f32) -> Camera {
    // As skewed as a user may write it.
    let axes = [Vec3::new(-0.8, 0.1, 0.0), Vec3::new(0.1, 0.6, 0.1), Vec3::new(0.2, 0.1, 1.5)];
    Camera::new(Vec3::new(0.3, 0.2, -4.0), axes, [40, 30], lens, 3.0).expect("a camera")
}

/// Rays through a uniform picture, where they meet a wall, against the importance that light tracing multiplies by.
#[test]
fn the_cameras_rays_are_distributed_as_its_importance_says() {
    for lens in [0.0, 0.4] {
        let camera = camera(lens);
        let (cells, low, side) = (24, Vec2::splat(-4.5), 9.0);
        let draws = 100_000;
        let mut sampler = Sampler::new(8, 0, 0, 0);
        let mut observed = vec![0.0; cells * cells];
        for _ in 0..draws {
            let ray = camera.ray(sampler.square() * Vec2::new(40.0, 30.0), sampler.square());
            let at = ray.at(-ray.origin.z / ray.direction.z);
            let cell = ((Vec2::new(at.x, at.y) - low) / side * cells as f32).floor();
            assert!(cell.min_element() >= 0.0 && cell.max_element() < cells as f32, "the wall is large enough");
            observed[cell.y as usize * cells + cell.x as usize] += 1.0;
        }
        let fine = 24;
        let mut expected = vec![0.0; cells * cells];
        for y in 0..cells * fine {
            for x in 0..cells * fine {
                let step = side / (cells * fine) as f32;
                let at = low + step * (Vec2::new(x as f32, y as f32) + 0.5);
                let Some(seen) = camera.see(at.extend(0.0), sampler.square()) else { continue };
                if seen.pixel.cmpge(Vec2::ZERO).all() && seen.pixel.cmplt(Vec2::new(40.0, 30.0)).all() {
                    let cos = (seen.lens - at.extend(0.0)).normalize().z.abs();
                    // A pixel's value for radiance 1, by the number of pixels.
                    expected[(y / fine) * cells + x / fine] +=
                        f64::from(seen.importance * cos * step * step / 1200.0) * f64::from(draws);
                }
            }
        }
        assert_distribution(&format!("lens {lens}"), &observed, &expected, f64::from(draws));
    }
}

proptest! {
    #[test]
    fn what_a_ray_meets_is_seen_where_the_ray_started(
        x in 0.0f32..40.0, y in 0.0f32..30.0, u in 0.0f32..1.0, v in 0.0f32..1.0, distance in 0.1f32..50.0,
        lens in prop_oneof![Just(0.0f32), 0.01f32..0.5],
    ) {
        let camera = camera(lens);
        let (pixel, on_lens) = (Vec2::new(x, y), Vec2::new(u, v));
        let ray = camera.ray(pixel, on_lens);
        let seen = camera.see(ray.at(distance), on_lens).expect("in front");
        prop_assert!((seen.lens - ray.origin).length() < 1e-6);
        // Close to the lens, a rounding of the point is a larger step in the picture.
        prop_assert!((seen.pixel - pixel).length() < 2e-3 * (1.0 + 1.0 / distance), "{}", seen.pixel);
    }
}
