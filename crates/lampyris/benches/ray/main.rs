//! The nearest surfaces along incoherent rays, and what shadow rays ask: Lampyris, the crate obvhs that it traced with
//! before, and Embree if the feature `embree` is on and its library is found, on one thread, in turns.
//!
//! ```text
//! cargo bench -p lampyris --bench ray [--features embree] -- [ROUNDS]
//! LAMPYRIS_EMBREE=/path/to/libembree4.so.4    where the library is, if the system does not know
//! ```

#![allow(missing_docs, clippy::print_stdout, clippy::disallowed_methods)]

#[cfg(feature = "embree")]
mod embree;
mod meshes;
mod obvhs_tree;

use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::{Mat4, Vec3};
use lampyris::geometry::{Mesh, MeshData, Ray, Shape, Surfaces, SurfacesBuilder};
use lampyris::math::{Frame, warp};
use lampyris::sampler::Sampler;

const RAYS: usize = 300_000;

/// Distances are computed from coordinates of up to 1.5, in single precision.
const ROUNDING: f64 = 1e-6;

/// Something that finds triangles.
trait Tracer {
    fn name(&self) -> &'static str;
    /// Distance to the nearest triangle.
    fn closest(&self, ray: &Ray) -> Option<f32>;
    /// Whether there is a triangle before `max`.
    fn blocked(&self, ray: &Ray, max: f32) -> bool;
}

impl Tracer for Surfaces {
    fn name(&self) -> &'static str {
        "lampyris"
    }

    fn closest(&self, ray: &Ray) -> Option<f32> {
        Some(Surfaces::closest(self, ray, f32::INFINITY)?.distance)
    }

    fn blocked(&self, ray: &Ray, max: f32) -> bool {
        Surfaces::blocked(self, ray, max)
    }
}

fn main() {
    let rounds = std::env::args().filter_map(|argument| argument.parse().ok()).next().unwrap_or(5);
    for (name, mesh) in [("blob", meshes::blob()), ("cloud", meshes::cloud())] {
        println!("{name}: {} triangles", mesh.triangles.len());
        let own = |mesh: &Arc<MeshData>| {
            let mut builder = SurfacesBuilder::default();
            builder.add(Shape::Mesh(Mesh::new(mesh, &Mat4::IDENTITY)), false);
            builder.build()
        };
        let surfaces = timed("lampyris", &mesh, || own(&mesh));
        let halves = meshes::halves_apart(&mesh);
        timed("halves", &halves, || own(&halves));
        println!("  {:?}", surfaces.statistics());
        let obvhs = timed("obvhs", &mesh, || obvhs_tree::ObvhsTree::new(&mesh));
        let rays = incoherent_rays(&surfaces);
        let mut tracers: Vec<Box<dyn Tracer>> = vec![Box::new(surfaces), Box::new(obvhs)];
        tracers.extend(embree(&mesh));
        compare("closest", rounds, &tracers, |tracer| count(&rays, |ray| tracer.closest(ray).is_some()));
        compare("blocked", rounds, &tracers, |tracer| count(&rays, |ray| tracer.blocked(ray, 1.0)));
        differences(&rays, &mesh, &tracers);
    }
}

#[cfg(feature = "embree")]
fn embree(mesh: &Arc<MeshData>) -> Option<Box<dyn Tracer>> {
    let path = std::env::var("LAMPYRIS_EMBREE").unwrap_or("libembree4.so.4".to_string());
    match embree::Library::open(&path) {
        Ok(library) => Some(Box::new(timed("embree", mesh, || library.scene(mesh)))),
        Err(error) => {
            println!("  without Embree, whose library was not found (set LAMPYRIS_EMBREE): {error}");
            None
        }
    }
}

#[cfg(not(feature = "embree"))]
fn embree(_: &Arc<MeshData>) -> Option<Box<dyn Tracer>> {
    println!("  without Embree (add --features embree)");
    None
}

/// Half from anywhere in the box around all to anywhere, half bounces off surfaces.
fn incoherent_rays(surfaces: &Surfaces) -> Vec<Ray> {
    let bounds = surfaces.bounds();
    let mut sampler = Sampler::new(1, 0, 0, 0);
    let mut rays = Vec::new();
    while rays.len() < RAYS {
        let within = Vec3::new(sampler.uniform(), sampler.uniform(), sampler.uniform());
        let origin = bounds.min + within * (bounds.max - bounds.min);
        let ray = Ray { origin, direction: warp::sphere(sampler.square()) };
        rays.push(ray);
        if let Some(hit) = surfaces.closest(&ray, f32::INFINITY) {
            let surface = surfaces.surface(&ray, &hit);
            let towards = if surface.normal.dot(ray.direction) < 0.0 { surface.normal } else { -surface.normal };
            let up = Frame::around(towards).to_world(warp::cosine_hemisphere(sampler.square()));
            rays.push(surface.spawn(up));
        }
    }
    rays.truncate(RAYS);
    rays
}

fn count(rays: &[Ray], is_met: impl Fn(&Ray) -> bool) -> usize {
    rays.iter().filter(|ray| is_met(ray)).count()
}

/// Builds something, and says how fast.
fn timed<T>(name: &str, mesh: &MeshData, build: impl Fn() -> T) -> T {
    let timed_build = |_| {
        let (start, threads) = (Instant::now(), time_of_threads());
        (build(), start.elapsed(), time_of_threads() - threads)
    };
    let mut built: Vec<(T, Duration, Duration)> = (0..5).map(timed_build).collect();
    let count = mesh.triangles.len() as f64;
    let rates = built.iter().map(|(_, time, _)| count / time.as_secs_f64() / 1e6);
    let rates: Vec<String> = rates.map(|rate| format!("{rate:.2}")).collect();
    let each = median(built.iter().map(|(_, _, time)| time.as_secs_f64() / count * 1e9).collect());
    println!("  {name:9} built at {} M triangles/s, {each:.0} ns of all threads a triangle", rates.join(", "));
    built.swap_remove(0).0
}

/// Lets the tracers do the same work in turns, and prints the median of their speeds with its ratio to the last one's.
fn compare(what: &str, rounds: usize, tracers: &[Box<dyn Tracer>], work: impl Fn(&dyn Tracer) -> usize) {
    let mut speeds = vec![Vec::new(); tracers.len()];
    let mut met = vec![0; tracers.len()];
    for _ in 0..=rounds {
        for (index, tracer) in tracers.iter().enumerate() {
            let start = thread_time();
            met[index] = work(tracer.as_ref());
            speeds[index].push(RAYS as f64 / (thread_time() - start).as_secs_f64() / 1e6);
        }
    }
    let last = tracers.len() - 1;
    for (index, tracer) in tracers.iter().enumerate() {
        // The first round only warms up.
        let ratios = speeds[index].iter().zip(&speeds[last]).skip(1).map(|(speed, other)| speed / other).collect();
        println!(
            "  {what} {:9} {:.3} M/s, {:.3} of {} ({} met)",
            tracer.name(),
            median(speeds[index][1..].to_vec()),
            median(ratios),
            tracers[last].name(),
            met[index]
        );
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Counts the rays for which the tracers disagree, and who is right.
fn differences(rays: &[Ray], mesh: &MeshData, tracers: &[Box<dyn Tracer>]) {
    let own = &tracers[0];
    let same = |a: Option<f64>, b: Option<f64>| match (a, b) {
        (None, None) => true,
        (Some(a), Some(b)) => (a - b).abs() <= 1e-4 * a.max(b) + ROUNDING,
        _ => false,
    };
    for other in &tracers[1..] {
        let (mut differ, mut right) = (0, [0, 0]);
        for ray in rays {
            let found = [own, other].map(|tracer| tracer.closest(ray).map(f64::from));
            if !same(found[0], found[1]) {
                let exact = exact(mesh, ray);
                differ += 1;
                right.iter_mut().zip(found).for_each(|(right, found)| *right += u32::from(same(found, exact)));
            }
        }
        let [name, other] = [own, other].map(|tracer| tracer.name());
        println!("  {differ} of {RAYS} rays meet something else in {name} than in {other}: by all triangles in");
        println!("    double precision {name} is right for {}, {other} for {}", right[0], right[1]);
    }
}

/// Distance to the nearest of all triangles [Möller & Trumbore 1997].
fn exact(mesh: &MeshData, ray: &Ray) -> Option<f64> {
    let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let distance = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|corner| Vec3::from_array(mesh.positions[corner as usize]).as_dvec3());
        let (e1, e2, from) = (b - a, c - a, origin - a);
        let across = direction.cross(e2);
        let (scale, turned) = (1.0 / e1.dot(across), from.cross(e1));
        let (u, v, distance) = (from.dot(across) * scale, direction.dot(turned) * scale, e2.dot(turned) * scale);
        (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 0.0).then_some(distance)
    };
    mesh.triangles.iter().filter_map(distance).min_by(f64::total_cmp)
}

/// The processor time of this thread, so that other programs do not count.
fn thread_time() -> Duration {
    // Elsewhere than on Linux, the time on the wall.
    static START: std::sync::OnceLock<Instant> = std::sync::OnceLock::new();
    running_time(Path::new("/proc/thread-self")).unwrap_or_else(|| START.get_or_init(Instant::now).elapsed())
}

/// The processor time of all threads; nothing elsewhere than on Linux.
fn time_of_threads() -> Duration {
    let threads = std::fs::read_dir("/proc/self/task").into_iter().flatten().flatten();
    threads.filter_map(|thread| running_time(&thread.path())).sum()
}

fn running_time(thread: &Path) -> Option<Duration> {
    let text = std::fs::read_to_string(thread.join("schedstat")).ok()?;
    Some(Duration::from_nanos(text.split_whitespace().next()?.parse().ok()?))
}
