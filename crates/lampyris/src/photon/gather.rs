//! Density estimation: radiance from the photons around a point (theory §5.1).

use glam::Vec3;

use super::{Kernel, Nearest, Photon, PhotonMap, Radius};
use crate::scene::SurfacePoint;
use crate::spectrum::Spectrum;

/// How radiance is estimated from photons.
#[derive(Debug)]
pub struct Estimate<'m> {
    /// The photons.
    pub map: &'m PhotonMap,
    /// Their weight by distance.
    pub kernel: Kernel,
    /// How far to look.
    pub radius: Radius,
}

/// Photons whose normal is turned away by more than this (cosine of 96°) lie on another surface: the back of a thin wall.
/// Those of the next wall of a corner do count: they stand in for the part of the disk that the corner cuts off, where
/// otherwise a dark line would follow every inner edge until the radius is small.
const SAME_WAY: f32 = -0.1;

/// From this on (cosine of 60°) photons are those of another wall. What lights it need not light this one: the sill of a
/// window and the wall below it. They count by the cosine with which their light would fall on this, over that with which it
/// fell on theirs, but no more than so many times; and not at all if their light began behind this wall, as what goes back and
/// forth in a niche that ends at it, or if one of the two lies before the other and the other behind the one.
const SAME_WALL: f32 = 0.5;
const MOST_TURNED: f32 = 4.0;

/// Of two sheets that lie one on the other and face the same way, such as the inside of a lamp's back and the wall behind it,
/// each sees the other from another side. On one surface, hollow or round, both see each other's front or both the back;
/// where it swings from one to the other, they are nearly in a plane: within this share of their distance.
const SLACK: f32 = 0.1;

/// How much of the light of `photon` stands for light at the point `center`, whose side towards the gatherer is `normal` and lets
/// no light through.
fn stands_for(photon: &Photon, center: Vec3, normal: Vec3) -> f32 {
    let facing = photon.normal.dot(normal);
    if facing <= SAME_WAY {
        return 0.0;
    }
    let offset = photon.position - center;
    let (above, sees) = (offset.dot(normal), -offset.dot(photon.normal));
    let apart = above * sees < 0.0;
    if facing > SAME_WALL {
        let stacked = apart && above.abs().min(sees.abs()) > SLACK * offset.length();
        return if stacked { 0.0 } else { 1.0 };
    }
    let began_behind = above <= photon.reach * photon.direction.dot(normal);
    if apart || began_behind { 0.0 } else { turned(photon, normal) }
}

/// How much of the light of `photon` would fall on a surface of this normal.
fn turned(photon: &Photon, normal: Vec3) -> f32 {
    if photon.normal.dot(normal) > SAME_WALL {
        return 1.0;
    }
    let cos = |normal: Vec3| normal.dot(photon.direction).abs();
    // Not 0 / 0: no photon falls along its surface but by rounding.
    (cos(normal) / cos(photon.normal).max(f32::MIN_POSITIVE)).min(MOST_TURNED)
}

impl Estimate<'_> {
    /// Radiance that the smooth lobes at `point` reflect back along the path, of light whose photons have had at most
    /// `max_bounces` scattering events: Σ f Φ K / paths [Jensen 2001, eq. 7.6, with a kernel].
    pub fn radiance(&self, point: &SurfacePoint, max_bounces: u32, found: &mut Nearest) -> Spectrum {
        let radius = self.find(point, found);
        let weights = |photon: &Photon| [f32::from(u32::from(photon.bounce) <= max_bounces)];
        let ([radiance], _) = self.weighted(point, radius, found, weights, |_, _| {});
        radiance
    }

    /// Leaves in `found` the photons around `point`, and returns how far they were looked for, in scene units.
    #[inline]
    pub fn find(&self, point: &SurfacePoint, found: &mut Nearest) -> f32 {
        self.map.search(point.surface.position, self.radius, found)
    }

    /// [`Estimate::radiance`] of what was found within a radius, for several weights of photons at once. Tells of each
    /// photon that has a weight, with the light that it brings to the first of these; returns the unit of that light, too.
    pub fn weighted<const SETS: usize>(
        &self,
        point: &SurfacePoint,
        radius: f32,
        found: &mut Nearest,
        weights: impl Fn(&Photon) -> [f32; SETS],
        mut tell: impl FnMut(&Photon, Spectrum),
    ) -> ([Spectrum; SETS], Spectrum) {
        let mut sums = [Spectrum::ZERO; SETS];
        let unit = self.each(point, radius, found, weights, |photon, light, weights| {
            for (sum, weight) in sums.iter_mut().zip(weights) {
                *sum += light * weight;
            }
            tell(photon, light * weights[0]);
        });
        (sums.map(|sum| sum * unit), unit)
    }

    /// Tells of each photon within a radius that has a weight, with the light that it brings and its weights; returns the
    /// unit of that light.
    #[inline]
    fn each<const SETS: usize>(
        &self,
        point: &SurfacePoint,
        radius: f32,
        found: &mut Nearest,
        weights: impl Fn(&Photon) -> [f32; SETS],
        mut tell: impl FnMut(&Photon, Spectrum, [f32; SETS]),
    ) -> Spectrum {
        let center = point.surface.position;
        let normal = if point.surface.normal.dot(point.to_previous) < 0.0 {
            -point.surface.normal
        } else {
            point.surface.normal
        };
        let (even, transmits) = (point.even(), point.bsdf.transmits());
        let mut add = |photon: &Photon, kernel: f32| {
            let to_light = -photon.direction;
            let stands = if transmits { turned(photon, normal) } else { stands_for(photon, center, normal) };
            if stands == 0.0 {
                return;
            }
            let weights = weights(photon);
            if weights != [0.0; SETS] {
                // A photon is flux per area of the geometry, the BSDF wants it per area of the shading normal's. By the photon's
                // own: how many of them there are goes with the cosine where they land, and has no limit over that here.
                let light = photon.flux * (kernel * photon.shading * stands);
                let light = match even {
                    Some(_) if point.same_side(to_light) => light,
                    Some(_) => Spectrum::ZERO,
                    None => point.eval_radiance(to_light) * light,
                };
                tell(photon, light, weights);
            }
        };
        self.kernel.weigh::<2>(radius, found.hits.distances_squared_mut());
        let photons = self.map.photons();
        for (&index, &weight) in found.hits.indices().iter().zip(found.hits.distances_squared()) {
            // Radii shrink after they were found: beyond them a photon weighs nothing.
            if weight > 0.0 {
                add(&photons[index as usize], weight);
            }
        }
        even.unwrap_or(Spectrum::ONE) / self.map.paths_emitted() as f32
    }
}

#[cfg(test)]
mod tests {
    use std::f32::consts::PI;
    use std::sync::Arc;

    use super::*;
    use crate::geometry::{MeshData, Ray};
    use crate::import::toml::read_str;
    use crate::material::{Bsdf, Lobes};
    use crate::photon::Deposit;
    use crate::sampler::Sampler;
    use crate::scene::description::{GeometryDescription, ShapeDescription, Transform};
    use crate::scene::{NoAssets, Scene, build};
    use crate::transport::{PathState, Visitor};

    /// Two sides of a roof along the y axis, diffuse 0.5, whose smooth normals all point up.
    fn roof() -> Scene {
        let text = "camera = { origin = [0, 0, 3], target = [0, 0, 0], up = [0, 1, 0], fov = 40 }
            lights = [{ type = 'constant', radiance = 1 }]";
        let mut description = read_str("a.toml".as_ref(), text).expect("a scene").description;
        let mesh = MeshData {
            positions: vec![[0.0, -1.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, -0.3], [1.0, 0.0, -0.3]],
            normals: vec![[0.0, 0.0, 1.0]; 4],
            triangles: vec![[0, 1, 2], [1, 0, 3]],
            ..MeshData::default()
        };
        description.shapes.push(ShapeDescription {
            geometry: GeometryDescription::Triangles(Arc::new(mesh)),
            material: None,
            interior: None,
            priority: 0,
            emission: None,
            transform: Transform::default(),
            flip_normal: false,
            name: None,
        });
        build(&description, &NoAssets).expect("a scene").scene
    }

    /// Light lands on the right side, almost along the plane of the left one, on which it would be 61 times as bright by the
    /// normals there.
    #[test]
    fn a_photon_of_the_next_triangle_counts_as_where_it_landed() {
        let (scene, mut bsdf) = (roof(), Bsdf::default());
        let (here, along) = (Vec3::new(0.05, 0.0, -0.015), Vec3::new(-1.0, 0.0, -0.31).normalize());
        let ray = Ray { origin: here - along, direction: along };
        let mut deposit = Deposit { direct: true, ..Deposit::on_surfaces(8, None) };
        let point = scene.closest(&ray, &mut bsdf).expect("the right side");
        deposit.vertex(&point, &PathState::new(ray, Spectrum::ONE), &mut Sampler::new(1, 0, 0, 0));
        assert!((deposit.photons[0].position - here).length() < 1e-5);

        let (radius, mut found) = (0.5, Nearest::default());
        let map = PhotonMap::from_blocks(&[deposit.photons], 1, Radius::Fixed(radius));
        let estimate = Estimate { map: &map, kernel: Kernel::Box, radius: Radius::Fixed(radius) };
        let [cos_shading, cos] = [Vec3::Z, Vec3::new(0.3, 0.0, 1.0).normalize()].map(|normal| -normal.dot(along));
        let expected = 0.5 / PI * (cos_shading / cos) / (PI * radius * radius);
        for x in [-0.05, 0.05] {
            let ray = Ray { origin: Vec3::new(x, 0.0, 1.0), direction: Vec3::NEG_Z };
            let point = scene.closest(&ray, &mut bsdf).expect("the roof");
            let radiance = estimate.radiance(&point, 8, &mut found).mean();
            assert!((radiance / expected - 1.0).abs() < 1e-4, "{radiance} instead of {expected} at {x}");
        }
    }

    fn photon(position: Vec3, normal: Vec3, direction: Vec3) -> Photon {
        Photon {
            position,
            direction,
            normal,
            optical_length: 0.0,
            reach: 1.0,
            slowness: 1.0,
            flux: Spectrum::ONE,
            bounce: 0,
            history: Lobes::NONE,
            shading: 1.0,
            rivals: 0.0,
            path: 0,
        }
    }

    /// Whether a photon there counts for the origin of a floor seen from above, if its light comes from far above, too.
    fn counts(position: Vec3, normal: Vec3) -> bool {
        let slanting = (-normal - 0.5 * Vec3::Z).normalize();
        stands_for(&Photon { reach: 10.0, ..photon(position, normal, slanting) }, Vec3::ZERO, Vec3::Z) > 0.0
    }

    #[test]
    fn photons_of_another_wall_count_by_how_their_light_would_fall_on_this() {
        let falls = |normal: Vec3, direction: Vec3| {
            let turned = turned(&photon(Vec3::X, normal, direction.normalize()), Vec3::Z);
            (turned * 1e5).round() / 1e5
        };
        let slanting = Vec3::new(1.0, 0.0, -3.0);
        assert_eq!(falls(Vec3::NEG_X, Vec3::X), 0.0, "along the floor, straight on the wall");
        assert_eq!(falls(Vec3::NEG_X, slanting), 3.0);
        assert_eq!(falls(Vec3::NEG_X, Vec3::new(0.01, 0.0, -1.0)), MOST_TURNED, "along the wall");
        assert_eq!(falls(Vec3::Z, slanting), 1.0, "the floor itself");
        assert_eq!(falls(Vec3::new(0.6, 0.0, 0.8), slanting), 1.0, "the next triangle of something round");
        assert_eq!(falls(Vec3::NEG_Z, slanting), 1.0, "the other side, through which the floor lets light");
    }

    #[test]
    fn photons_of_a_sheet_above_or_below_do_not_count() {
        assert!(counts(Vec3::X, Vec3::Z));
        for height in [0.2, -0.2, 5.0, -5.0] {
            assert!(!counts(Vec3::new(1.0, 0.0, height), Vec3::Z), "{height}");
        }
        assert!(!counts(Vec3::X, Vec3::NEG_Z), "the back of the floor");
    }

    #[test]
    fn photons_beyond_an_edge_and_around_a_ball_count() {
        assert!(counts(Vec3::new(0.5, 0.0, 2.0), Vec3::NEG_X), "a wall that stands on the floor");
        assert!(counts(Vec3::new(0.5, 0.0, -2.0), Vec3::X), "the side of a block that the floor is the top of");
        let around = Vec3::new(1.0, 0.0, 1.0).normalize();
        assert!(counts(around - Vec3::Z, around), "a ball from outside");
        assert!(counts(Vec3::Z - around, around), "a ball from inside");
    }

    #[test]
    fn photons_of_a_wall_that_stands_before_this_one_and_turns_its_back_do_not_count() {
        assert!(!counts(Vec3::new(1.0, 0.0, 0.01), Vec3::X), "a step up");
        assert!(!counts(Vec3::new(1.0, 0.0, -0.01), Vec3::NEG_X), "a groove, seen from its farther edge");
    }

    #[test]
    fn light_that_began_behind_a_wall_does_not_count_there() {
        // Below the floor, on the side of the block that it is the top of: the light comes down to it from there or farther.
        let down = Vec3::new(-1.0, 0.0, -1.0).normalize();
        let at = |reach: f32| {
            let photon = Photon { reach, ..photon(Vec3::new(0.5, 0.0, -1.0), Vec3::X, down) };
            stands_for(&photon, Vec3::ZERO, Vec3::Z)
        };
        assert_eq!([at(1.4), at(1.42), at(f32::INFINITY)], [0.0, 1.0, 1.0]);
    }
}
