//! Textures as scenes show them: from afar, from near, and by the vertices.

mod common;

use std::sync::Arc;

use common::{built, described, lit_with};
use glam::{Mat4, Vec3};
use lampyris::geometry::MeshData;
use lampyris::image::Image;
use lampyris::scene::description::{
    GeometryDescription, MaterialDescription, MaterialRef, Paint, ShapeDescription, Transform,
};
use lampyris::texture::{Curve, Raster, Texels};

/// A checkerboard of 64 × 64 texels.
fn checkerboard() -> [(&'static str, Raster); 1] {
    let texel = |index: usize| if (index + index / 64).is_multiple_of(2) { 255 } else { 0 };
    let texels = Texels::Bytes((0..64 * 64).map(texel).collect());
    [("checks", Raster::new(64, 64, 1, texels, Curve::Srgb).expect("texels"))]
}

/// A wall with 8 × 8 checkerboards, seen from so far that the picture shows so much of its width. The light has no
/// noise: what varies is the texture.
fn wall(filter: &str, paint: &str, width: f32) -> String {
    let across = 2.0 * (0.5 * width).atan().to_degrees();
    format!(
        "film = {{ size = [16, 16] }}
         camera = {{ origin = [0.01, 0.02, 1], target = [0.01, 0.02, 0], fov = {across} }}
         lights = [{{ type = 'directional', direction = [0, 0, -1], irradiance = 3.14159265 }}]
         [textures.checks]
         type = 'bitmap'
         file = 'checks'
         filter = '{filter}'
         to-uv = [{{ scale = 8 }}]
         [[shapes]]
         type = 'quad'
         corner = [-2, -2, 0]
         u = [4, 0, 0]
         v = [0, 4, 0]
         {paint}"
    )
}

const PAINTS: [&str; 2] = [
    "material = { type = 'diffuse', reflectance = 'checks' }",
    "emission = { radiance = 'checks', scale = 4 }\nmaterial = { type = 'diffuse', reflectance = 0 }",
];

fn passes(text: &str) -> Vec<Image> {
    lit_with(text, "integrator=path samples=1 max-bounces=1", &checkerboard()).passes(16)
}

/// The mean over pixels of the variance over passes, and the mean of all.
fn statistics(images: &[Image]) -> (f64, f64) {
    let pixels = images[0].pixels().len();
    let variance = |pixel: usize| {
        let values: Vec<f64> = images.iter().map(|image| f64::from(image.pixels()[pixel][0])).collect();
        common::statistics::Sample::of(&values).variance
    };
    let mean = images.iter().map(Image::mean).sum::<f64>() / images.len() as f64;
    ((0..pixels).map(variance).sum::<f64>() / pixels as f64, mean)
}

#[test]
fn a_fine_pattern_from_afar_has_no_noise_and_the_same_mean() {
    for (paint, expected) in PAINTS.into_iter().zip([0.5, 2.0]) {
        // Four texels and more to a pixel.
        let [(noise, mean), (filtered_noise, filtered_mean)] =
            ["bilinear", "mip"].map(|filter| statistics(&passes(&wall(filter, paint, 1.0))));
        assert!(filtered_noise < 1e-3 * noise, "{paint}: {filtered_noise} of {noise}");
        // Sixteen passes of 256 pixels: five standard errors of the noisy one.
        let error = (noise / 4096.0).sqrt();
        assert!((mean - expected).abs() < 5.5 * error, "{paint}: {mean} ± {error}");
        assert!((filtered_mean - expected).abs() < 2e-3 * expected, "{paint}: {filtered_mean}");
    }
}

/// The camera looks away from the wall, into a mirror behind it: eight texels to a pixel in the end.
#[test]
fn in_a_mirror_a_pattern_is_as_far_as_the_whole_way_to_it() {
    let mirrored = |filter: &str| {
        let away = wall(filter, PAINTS[1], 0.5).replace("[0.01, 0.02, 0], fov", "[0.01, 0.02, 2], fov");
        away + "
            [[shapes]]
            type = 'quad'
            corner = [-1, -1, 1.5]
            u = [0, 2, 0]
            v = [2, 0, 0]
            material = { type = 'mirror' }"
    };
    let [(noise, _), (filtered_noise, filtered_mean)] =
        ["bilinear", "mip"].map(|filter| statistics(&passes(&mirrored(filter))));
    assert!(filtered_noise < 1e-3 * noise, "{filtered_noise} of {noise}");
    assert!((filtered_mean - 2.0).abs() < 4e-3, "{filtered_mean}");
}

#[test]
fn from_near_a_mip_is_bilinear_to_the_bit() {
    for paint in PAINTS {
        let [bilinear, mip] = ["bilinear", "mip"].map(|filter| passes(&wall(filter, paint, 0.05)));
        assert!(bilinear == mip, "{paint}");
    }
}

/// A triangle with a red, a green and a blue corner.
#[test]
fn the_colours_of_vertices_are_mixed_between_them() {
    let data = MeshData {
        positions: vec![[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]],
        triangles: vec![[0, 1, 2]],
        colors: vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 7.0]],
        ..MeshData::default()
    };
    let shape = |data: MeshData| ShapeDescription {
        interior: None,
        priority: 0,
        geometry: GeometryDescription::Triangles(Arc::new(data)),
        material: Some(MaterialRef::Inline(Box::new(MaterialDescription::Diffuse {
            reflectance: Paint::Texture("corners".into()),
        }))),
        emission: None,
        transform: Transform(Mat4::from_scale(Vec3::splat(2.0))),
        flip_normal: false,
        name: None,
    };
    let seen = |data: MeshData| {
        let mut description = described(
            "film = { size = [1, 1] }
             camera = { origin = [0, 0, 5], target = [0, 0, 0], fov = 0.01 }
             lights = [{ type = 'directional', direction = [0, 0, -1], irradiance = 3.14159265 }]
             textures = { corners = { type = 'vertex-color' } }",
        );
        description.shapes.push(shape(data));
        built(description, "integrator=path max-bounces=1").image(1).pixel(0, 0)
    };
    let close = |a: [f32; 3], b: [f32; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-3);
    // A quarter of the two lower corners each, half of the upper one; what reflects is cut at 1.
    let mixed = seen(data.clone());
    assert!(close(mixed, [0.25, 0.25, 1.0]), "{mixed:?}");
    let without = seen(MeshData { colors: vec![], ..data });
    assert!(close(without, [1.0; 3]), "{without:?}");
}
