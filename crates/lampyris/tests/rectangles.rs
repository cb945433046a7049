//! Rectangular lamps are seen evenly by solid angle from nearby, and give the light of closed forms.

mod common;

use std::f64::consts::TAU;

use common::statistics::{assert_distribution, assert_mean, assert_same_mean};
use common::{channel_mean, lit};
use glam::{DVec3, Quat, Vec2, Vec3};
use lampyris::geometry::{Quad, Shape, Surfaces, SurfacesBuilder};
use lampyris::sampler::Sampler;

/// A parallelogram as a lamp has it.
#[derive(Clone, Copy, Debug)]
struct Lamp {
    corner: Vec3,
    u: Vec3,
    v: Vec3,
}

impl Lamp {
    fn new(u: f32, v: f32) -> Lamp {
        Lamp { corner: Vec3::ZERO, u: u * Vec3::X, v: v * Vec3::Y }
    }

    /// Moved, turned and made larger.
    fn placed(self, to: Vec3, turn: Quat, scale: f32) -> Lamp {
        let vector = |v: Vec3| turn * v * scale;
        Lamp { corner: vector(self.corner) + to, u: vector(self.u), v: vector(self.v) }
    }

    fn surfaces(self) -> Surfaces {
        let mut builder = SurfacesBuilder::default();
        builder.add(Shape::Quad(Quad::new(self.corner, self.u, self.v)).by_solid_angle(), false);
        builder.build()
    }

    /// At shares of both edges, and so far off it.
    fn at(&self, a: f32, b: f32, height: f32) -> Vec3 {
        self.corner + a * self.u + b * self.v + height * self.u.cross(self.v).normalize()
    }

    /// The corners of a part of it, from shares of both edges to others, from a point.
    fn part(&self, from: Vec3, low: [f64; 2], high: [f64; 2]) -> [DVec3; 4] {
        let [corner, u, v] = [self.corner, self.u, self.v].map(Vec3::as_dvec3);
        [low, [high[0], low[1]], high, [low[0], high[1]]].map(|[a, b]| corner + a * u + b * v - from.as_dvec3())
    }

    fn solid_angle(&self, from: Vec3) -> f64 {
        solid_angle(self.part(from, [0.0; 2], [1.0; 2]))
    }
}

/// That of two triangles [Oosterom & Strackee 1983].
fn solid_angle([a, b, c, d]: [DVec3; 4]) -> f64 {
    let triangle = |a: DVec3, b: DVec3, c: DVec3| {
        let [a, b, c] = [a, b, c].map(DVec3::normalize);
        2.0 * a.dot(b.cross(c)).abs().atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a))
    };
    triangle(a, b, c) + triangle(a, c, d)
}

/// The irradiance of a polygon of radiance 1, all of it above the horizon [Lambert 1760].
fn irradiance(corners: [DVec3; 4], normal: DVec3) -> f64 {
    let edge = |index: usize| {
        let (a, b) = (corners[index], corners[(index + 1) % 4]);
        a.angle_between(b) * a.cross(b).normalize().dot(normal)
    };
    0.5 * (0..4).map(edge).sum::<f64>().abs()
}

fn near() -> Vec<(Lamp, Vec3)> {
    let (square, board, strip) = (Lamp::new(2.0, 2.0), Lamp::new(2.0, 0.7), Lamp::new(0.01, 10.0));
    let turn = Quat::from_axis_angle(Vec3::new(1.0, 2.0, -1.0).normalize(), 1.0);
    let turned = board.placed(Vec3::new(3.0, -1.0, 2.0), turn, 1.0);
    let (tiny, huge) = (board.placed(Vec3::ZERO, turn, 1e-3), board.placed(Vec3::ZERO, turn, 1e3));
    vec![
        (square, square.at(0.5, 0.5, 0.7)),
        (square, square.at(0.5, 0.5, -0.01)),
        (square, square.at(0.2, 0.9, 1e-3)),
        // Beside the lamp, where it is seen at a grazing angle.
        (square, square.at(1.1, 0.4, 0.01)),
        (square, square.at(-0.2, -0.1, -1e-3)),
        // Over an edge, and over a corner.
        (board, board.at(0.0, 0.3, 0.1)),
        (board, board.at(1.0, 1.0, 0.2)),
        (strip, strip.at(0.4, 0.3, 0.05)),
        (strip, strip.at(3.0, 1.01, -0.02)),
        (turned, turned.at(0.3, 0.6, 0.2)),
        (turned, turned.at(1.2, -0.2, 0.1)),
        (tiny, tiny.at(0.3, 0.6, 2e-4)),
        (huge, huge.at(0.3, 0.6, 200.0)),
    ]
}

fn cell(uv: Vec2, cells: usize) -> usize {
    let along = |x: f32| ((x * cells as f32) as usize).min(cells - 1);
    cells * along(uv.x) + along(uv.y)
}

/// How likely a point falls into each of 8 × 8 parts: their solid angles, exactly, over that of all.
#[test]
fn from_nearby_rectangles_are_sampled_evenly_by_solid_angle() {
    for (number, (lamp, from)) in near().into_iter().enumerate() {
        let (surfaces, whole) = (lamp.surfaces(), lamp.solid_angle(from));
        let draws = 40_000;
        let mut observed = vec![0.0; 64];
        let mut sampler = Sampler::new(11, 0, 0, number as u64);
        for _ in 0..draws {
            let (surface, pdf) = surfaces.sample_from(0, from, sampler.square()).expect("a point");
            assert!((f64::from(pdf) * whole - 1.0).abs() < 1e-5, "{lamp:?} from {from}: {pdf}, 1 / {whole}");
            assert_eq!(surfaces.pdf_from(0, from, &surface), Some(pdf));
            observed[cell(surface.uv, 8)] += 1.0;
        }
        let part = |number: usize| {
            let low = [(number / 8) as f64 / 8.0, (number % 8) as f64 / 8.0];
            solid_angle(lamp.part(from, low, low.map(|low| low + 0.125))) / whole * f64::from(draws)
        };
        let expected: Vec<f64> = (0..64).map(part).collect();
        assert_distribution(&format!("{lamp:?} from {from}"), &observed, &expected, f64::from(draws));
    }
}

/// From edge to edge without a jump, so that what is even in the unit square is even in the lamp.
#[test]
fn points_of_rectangles_move_on_as_their_numbers_do() {
    let steps = 200;
    for (lamp, from) in near() {
        let surfaces = lamp.surfaces();
        let uv = |x: usize, y: usize| {
            let u = Vec2::new(x as f32, y as f32) / steps as f32;
            surfaces.sample_from(0, from, u).expect("a point").0.uv
        };
        for (i, j) in (0..steps).flat_map(|i| (0..=steps).step_by(20).map(move |j| (i, j))) {
            let (here, along, across) = (uv(i, j), uv(i + 1, j), [uv(j, i), uv(j, i + 1)]);
            assert!(here.x < along.x && across[0].y < across[1].y, "{lamp:?} from {from}: {here}, {along}, {across:?}");
        }
        // Where rounding leaves little of a solid angle, its last thousandth can be an edge's.
        let ends = (uv(0, 0), uv(steps, steps));
        assert!(ends.0.abs_diff_eq(Vec2::ZERO, 1e-3) && ends.1.abs_diff_eq(Vec2::ONE, 1e-3), "{lamp:?}: {ends:?}");
    }
}

/// Also from afar, from where points are even by area, and of parallelograms.
#[test]
fn the_light_of_a_lamp_is_that_of_lambert() {
    let skewed = Lamp { v: Vec3::new(0.5, 1.0, 0.0), ..Lamp::new(1.0, 1.0) };
    let far = [(Lamp::new(2.0, 1.0), Vec3::new(4.0, 3.0, 3.0)), (skewed, Vec3::new(0.4, 0.3, 0.7))];
    for (number, (lamp, from)) in near().into_iter().chain(far).enumerate() {
        let surfaces = lamp.surfaces();
        // So that no corner is below the horizon.
        let corners = lamp.part(from, [0.0; 2], [1.0; 2]);
        let toward = corners.iter().map(|corner| corner.normalize()).sum::<DVec3>();
        let plane = (lamp.u.cross(lamp.v).as_dvec3().normalize() * corners[0]).element_sum();
        let straight = lamp.u.cross(lamp.v).as_dvec3().normalize() * plane.signum();
        let is_above = |normal: &DVec3| corners.iter().all(|corner| corner.dot(*normal) > 0.0);
        let normal = [toward.normalize(), straight].into_iter().find(is_above).expect("a normal");
        let mut sampler = Sampler::new(12, 0, 0, number as u64);
        let light = |_| {
            let (surface, pdf) = surfaces.sample_from(0, from, sampler.square()).expect("a point");
            (surface.position - from).as_dvec3().normalize().dot(normal) / f64::from(pdf)
        };
        let values: Vec<f64> = (0..100_000).map(light).collect();
        assert_mean(&format!("{lamp:?} from {from}"), &values, irradiance(corners, normal), 0.0, 0.02);
    }
}

/// Lamps of all forms and sizes from all places, many of them on edges, in the plane or nearly so.
#[test]
fn no_place_makes_a_density_that_is_no_number() {
    let mut sampler = Sampler::new(13, 0, 0, 0);
    let (mut evenly, mut not) = (0, 0);
    for _ in 0..100_000 {
        let mut number = || sampler.uniform();
        let mut power = |least: f32, most: f32| 10.0_f32.powf(least + number() * (most - least));
        let lamp = Lamp::new(power(-3.0, 0.0), power(-3.0, 0.0));
        let scale = power(-3.0, 3.0);
        let heights = [0.0, power(-9.0, 0.0), power(-3.0, 0.0), -power(-6.0, 1.0), power(0.0, 6.0)];
        let turn =
            Quat::from_axis_angle(Vec3::new(number(), number(), number() + 0.1).normalize(), TAU as f32 * number());
        let to = Vec3::new(number(), number(), number()) * (20.0 * (number() - 0.8)).max(0.0);
        let lamp = lamp.placed(to, turn, scale);
        let height = heights[(number() * 5.0) as usize] * scale;
        let mut share = || [0.0, 1.0, 0.5, number(), 3.0 * number() - 1.0][(number() * 5.0) as usize];
        let from = lamp.at(share(), share(), height);
        let u = [Vec2::ZERO, Vec2::new(0.999_999_94, 0.999_999_94), Vec2::new(number(), number())];
        let surfaces = lamp.surfaces();
        for u in u {
            let Some((surface, pdf)) = surfaces.sample_from(0, from, u) else { continue };
            let inside = surface.uv.cmpge(Vec2::ZERO).all() && surface.uv.cmple(Vec2::ONE).all();
            assert!(
                inside && pdf > 0.0 && pdf.is_finite() && surface.position.is_finite(),
                "{lamp:?} from {from}: {pdf}"
            );
            assert_eq!(surfaces.pdf_from(0, from, &surface), Some(pdf), "{lamp:?} from {from}");
            let is_even = (f64::from(pdf) * lamp.solid_angle(from) - 1.0).abs() < 1e-3;
            (evenly, not) = (evenly + u32::from(is_even), not + u32::from(!is_even));
        }
    }
    assert!(evenly > 50_000 && not > 50_000, "{evenly} even by solid angle, {not} not");
}

/// A lamp whose light is not the same everywhere is sampled by area, as are parallelograms.
#[test]
fn lamps_with_a_pattern_are_sampled_evenly_by_area() {
    let textures = "textures = { squares = { type = 'checkerboard', color0 = 0.5, color1 = 1 } }\n";
    let from = Vec3::new(0.2, 0.3, 0.1);
    let pdf = |edge: &str, radiance: &str| {
        let quad = format!("type = 'quad', corner = [-1, -1, 0], u = [2, 0, 0], v = [{edge}, 2, 0]");
        let camera = "camera = { origin = [0, 0, 9], target = [0, 0, 0] }\n";
        let text = format!("{camera}{textures}shapes = [{{ {quad}, emission = {{ radiance = {radiance} }} }}]");
        let scene = lit(&text, "").scene;
        let (surface, pdf) = scene.surfaces().sample_from(0, from, Vec2::new(0.9, 0.2)).expect("a point");
        let to = surface.position - from;
        let by_area = to.length().powi(3) / (to.dot(surface.normal).abs() * 4.0);
        (surface.uv.abs_diff_eq(Vec2::new(0.9, 0.2), 1e-6), (pdf / by_area - 1.0).abs() < 1e-4)
    };
    assert_eq!(pdf("0", "'squares'"), (true, true));
    assert_eq!(pdf("0.1", "1"), (true, true));
    assert_eq!(pdf("0", "1"), (false, false));
}

/// A floor and fog right below a lamp, by paths from the camera and by photons: t-tests of the means over passes.
#[test]
fn near_a_lamp_path_tracing_and_light_tracing_agree() {
    let floor = "
        film = { size = [8, 8] }
        camera = { origin = [0.3, 0.8, -1.5], target = [0.3, 0, 0], fov = 50 }
        [[shapes]]
        type = 'quad'
        corner = [-2, 0, -2]
        u = [0, 0, 4]
        v = [4, 0, 0]
        material = { type = 'diffuse', reflectance = 0.7 }
        [[shapes]]
        type = 'quad'
        corner = [-0.2, 0.05, -0.3]
        u = [0.5, 0, 0]
        v = [0, 0.02, 0.6]
        emission = { radiance = [3, 4, 5], two-sided = true }\n";
    let fog = "medium = 'fog'\nmedia = { fog = { type = 'homogeneous', sigma-s = 0.6, sigma-a = 0.1 } }\n";
    for (name, text) in [("clear", floor.to_string()), ("fog", fog.to_string() + floor)] {
        let settings = ["integrator=path samples=64", "integrator=light photons=32768 seed=1"];
        let [path, light] = settings.map(|settings| lit(&text, settings).passes(40));
        for row in 0..8 {
            let of_row = |image: &lampyris::image::Image| {
                (0..8).map(|column| f64::from(image.pixel(column, row)[1])).sum::<f64>() / 8.0
            };
            let means = |images: &[lampyris::image::Image]| images.iter().map(of_row).collect::<Vec<f64>>();
            assert_same_mean(&format!("{name}, row {row}"), &means(&path), &means(&light), 16, 0.0);
        }
        assert!(channel_mean(&path[0], 1) > 0.1, "{name} is dark");
    }
}
