//! Paths from the camera that lend each other what they find (theory §4.7), after [Bekaert et al. 2002].

use glam::Vec3;

use crate::film::Sink;
use crate::geometry::{Cone, Hit, Ray, Surface};
use crate::material::{Breadth, Bsdf, Event, Lobes, Scattered};
use crate::scene::{Scene, SurfacePoint};
use crate::spectrum::Spectrum;
use crate::transport::PathState;

/// Paths that lend each other what they find, and their light.
pub(super) struct Group<S> {
    /// Of how many paths it has room for, these are used.
    used: usize,
    /// What each keeps.
    sinks: Vec<S>,
    /// What each lends: light that leaves the first point of its suffix.
    lent: Vec<S>,
    /// What each found beyond that point: a part is lent, too.
    beyond: Vec<S>,
    tracks: Vec<Track>,
}

/// Where a path has been, as far as that matters to others.
#[derive(Clone, Copy, Debug, Default)]
struct Track {
    station: Option<Station>,
    suffix: Option<Suffix>,
    stage: Stage,
}

/// How far a path has come.
#[derive(Clone, Copy, Debug, Default)]
enum Stage {
    /// To no station.
    #[default]
    Before,
    /// To its station.
    Station,
    /// It has left that with this throughput, in a direction of this density per solid angle.
    Between(Spectrum, f32),
    /// To the first point of its suffix.
    Suffix,
    /// As far as matters.
    Done,
}

/// How a point was met.
#[derive(Clone, Copy, Debug)]
struct Meeting {
    ray: Ray,
    /// Of the ray, from where it begins.
    cone: Cone,
    hit: Hit,
    throughput: Spectrum,
}

/// The first point of a path that scatters light in many directions: others may be led there from what other paths found.
#[derive(Clone, Copy, Debug)]
struct Station {
    meeting: Meeting,
    /// As the path came there.
    path: PathState,
}

/// What a path found after the smooth event at its station, from the next point on, which sends light to all stations.
#[derive(Clone, Copy, Debug)]
struct Suffix {
    meeting: Meeting,
    surface: Surface,
    /// Of shading, as maps have turned it.
    normal: Vec3,
    breadth: Breadth,
    /// With which the path chose to go there, per solid angle.
    pdf: f32,
    /// What part of the light from beyond the point is lent.
    share: Spectrum,
}

impl<S: Sink> Group<S> {
    /// Of at most so many paths with sinks like this one.
    pub(super) fn new(empty: &S, most: usize) -> Group<S> {
        let apart = vec![empty.apart(); most];
        Group {
            used: 0,
            sinks: vec![empty.clone(); most],
            lent: apart.clone(),
            beyond: apart,
            tracks: vec![Track::default(); most],
        }
    }

    /// Forgets all paths.
    pub(super) fn clear(&mut self) {
        for sinks in [&mut self.sinks, &mut self.lent, &mut self.beyond] {
            sinks[..self.used].iter_mut().for_each(Sink::clear);
        }
        self.tracks.fill(Track::default());
        self.used = 0;
    }

    /// The sink for the next path, and what notes which of its light is lent.
    pub(super) fn next(&mut self) -> (&mut S, Lending<'_, S>) {
        let member = self.used;
        self.used += 1;
        let lending =
            Lending { track: &mut self.tracks[member], lent: &mut self.lent[member], beyond: &mut self.beyond[member] };
        (&mut self.sinks[member], lending)
    }

    /// The light of each path.
    pub(super) fn sinks(&mut self) -> impl Iterator<Item = &mut S> {
        self.sinks[..self.used].iter_mut()
    }

    /// Gives all paths what they lend each other: each suffix to all stations that see it, as one that any of these could have
    /// chosen, weighted by the balance heuristic [Veach & Guibas 1995].
    pub(super) fn share(&mut self, scene: &Scene) {
        self.part();
        if self.lent[..self.used].iter().any(|lent| !lent.radiance().is_zero()) {
            self.lend(scene);
        }
    }

    /// The light of the first path that is its own, and that which it lends.
    pub(super) fn kept_and_lent(&mut self) -> [Spectrum; 2] {
        self.part();
        [self.sinks[0].radiance(), self.lent[0].radiance()]
    }

    /// Parts the light from beyond suffixes into what is lent and what is not.
    fn part(&mut self) {
        for (member, track) in self.tracks[..self.used].iter().enumerate() {
            let Some(Suffix { share, .. }) = track.suffix else { continue };
            let beyond = &self.beyond[member];
            self.lent[member].borrow(beyond, share, 0.0);
            self.sinks[member].borrow(beyond, Spectrum::ONE + share * -1.0, 0.0);
        }
    }

    fn lend(&mut self, scene: &Scene) {
        let Group { used, sinks, lent, tracks, .. } = self;
        let mut bsdfs = vec![Bsdf::default(); *used];
        let stations = tracks[..*used].iter().zip(&mut bsdfs).enumerate().filter_map(|(member, (track, bsdf))| {
            let station = track.station.as_ref()?;
            Some((member, station, station.meeting.point(scene, bsdf)))
        });
        let stations: Vec<(usize, &Station, SurfacePoint)> = stations.collect();
        let mut borrowers: Vec<Borrower> = Vec::with_capacity(*used);
        for &(own, home, _) in &stations {
            let (Some(suffix), false) = (&tracks[own].suffix, lent[own].radiance().is_zero()) else { continue };
            let mut bsdf = Bsdf::default();
            let outward = suffix.outward(scene, &mut bsdf);
            let mut density = suffix.pdf;
            borrowers.clear();
            borrowers.push((own, suffix.meeting.throughput * suffix.pdf, 0.0));
            for (other, station, point) in &stations {
                if *other == own || !station.is_like(home) {
                    continue;
                }
                let Some(Sight { to_suffix, distance, extent }) = suffix.seen_from(&point.surface) else { continue };
                let pdf = scene.scattering_pdf(point, to_suffix) * extent;
                if !pdf.is_finite() || pdf <= 0.0 || !suffix.is_visible(scene, &point.surface, to_suffix) {
                    continue;
                }
                density += pdf;
                let light = point.eval_radiance(to_suffix) * (point.cos(to_suffix) * extent * outward(-to_suffix));
                let longer = station.optical_length(distance) - home.optical_length(suffix.meeting.hit.distance);
                borrowers.push((*other, station.path.throughput * light, longer));
            }
            for &(other, carried, longer) in &borrowers {
                let share = (carried / density).divided(suffix.meeting.throughput);
                sinks[other].borrow(&lent[own], share, longer);
            }
        }
    }
}

/// How a path notes what it lends.
pub(super) struct Lending<'a, S> {
    track: &'a mut Track,
    lent: &'a mut S,
    beyond: &'a mut S,
}

impl<'a, S: Sink> Lending<'a, S> {
    /// The path has come to a surface, and has added what that emits.
    pub(super) fn vertex(&mut self, point: &SurfacePoint, path: &PathState) {
        let track = &mut *self.track;
        track.stage = match track.stage {
            Stage::Before if point.bsdf.lobes().meets(Lobes::SMOOTH) => {
                track.station = Station::new(point, path);
                if track.station.is_some() { Stage::Station } else { Stage::Done }
            }
            Stage::Between(throughput, pdf) => {
                track.suffix = Suffix::new(point, path, throughput, pdf);
                if track.suffix.is_some() { Stage::Suffix } else { Stage::Done }
            }
            // It has gone through a hole.
            Stage::Station => Stage::Done,
            stage => stage,
        };
    }

    /// The sink for light that comes to this point from this direction (world), and what part of it belongs there, if the point
    /// is the first of a suffix.
    pub(super) fn from(&mut self, to_light: Vec3, point: &SurfacePoint) -> Option<(&mut S, Spectrum)> {
        matches!(self.track.stage, Stage::Suffix).then(|| (&mut *self.lent, point.broad_share(to_light)))
    }

    /// The path has chosen where to go on, if anywhere. What it finds there may belong to another sink.
    pub(super) fn scattered(
        &mut self,
        chosen: Option<&Scattered>,
        point: &SurfacePoint,
        path: &PathState,
        sink: &mut &'a mut S,
    ) {
        let smooth = chosen.filter(|chosen| Lobes::SMOOTH.contains(chosen.event));
        self.track.stage = match (self.track.stage, smooth) {
            (Stage::Before, _) => Stage::Before,
            (Stage::Station, Some(chosen)) => {
                let unshadowed = point.unshadowed(chosen.to_next);
                Stage::Between(path.throughput * chosen.weight * unshadowed, chosen.pdf)
            }
            (Stage::Suffix, Some(chosen)) => {
                if let Some(suffix) = &mut self.track.suffix {
                    suffix.share = point.broad_share(chosen.to_next);
                }
                std::mem::swap(sink, &mut self.beyond);
                Stage::Done
            }
            _ => Stage::Done,
        };
    }
}

impl Meeting {
    fn new(point: &SurfacePoint, path: &PathState, throughput: Spectrum) -> Meeting {
        Meeting { ray: path.ray, cone: path.cone.before(point.distance), hit: point.hit, throughput }
    }

    fn point<'s, 'b>(&self, scene: &'s Scene, bsdf: &'b mut Bsdf<'s>) -> SurfacePoint<'b> {
        scene.point(&self.ray, &self.hit, self.cone, &self.throughput, bsdf)
    }
}

/// A station that lets much less of one lane go on than of another lends nothing: what it carries there is too little to tell
/// what others would carry.
const LEAST_LANE: f32 = 1e-3;

impl Station {
    fn new(point: &SurfacePoint, path: &PathState) -> Option<Station> {
        if !point.bsdf.lobes().contains(Event::Diffuse) || point.bsdf.transmits() {
            return None;
        }
        let goes_on = path.throughput * point.albedo();
        let least = goes_on.lanes().into_iter().fold(f32::INFINITY, f32::min);
        let meeting = Meeting::new(point, path, path.throughput);
        (least > LEAST_LANE * goes_on.max()).then_some(Station { meeting, path: *path })
    }

    /// Whether paths go on from both in the same matter, and to the same number of events.
    fn is_like(&self, other: &Station) -> bool {
        let of = |path: &PathState| (path.bounce, path.ior, path.slowness);
        of(&self.path) == of(&other.path)
    }

    /// Optical length of a path that goes so much further.
    fn optical_length(&self, distance: f32) -> f64 {
        self.path.optical_length + f64::from(self.path.slowness * distance)
    }
}

/// Whether paths of such a scene can be led from one to the other's end: not through media, and not where walls are seen point
/// by point, each with a scene of its own.
pub(super) fn is_possible(scene: &Scene) -> bool {
    !scene.has_media() && scene.camera().wall().is_none()
}

/// What a station sees of a suffix.
struct Sight {
    /// Unit length.
    to_suffix: Vec3,
    /// Scene units.
    distance: f32,
    /// The solid angle of its surface, over that from its own station.
    extent: f32,
}

impl Suffix {
    fn new(point: &SurfacePoint, path: &PathState, throughput: Spectrum, pdf: f32) -> Option<Suffix> {
        let breadth = point.bsdf.breadth();
        let meeting = Meeting::new(point, path, throughput);
        let (surface, normal, share) = (point.surface, point.frame.normal, Spectrum::ONE);
        (breadth != Breadth::None).then_some(Suffix { meeting, surface, normal, breadth, pdf, share })
    }

    /// How it is seen from a surface; none if that is on its other side.
    fn seen_from(&self, station: &Surface) -> Option<Sight> {
        let between = self.surface.position - station.position;
        let distance = between.length();
        let to_suffix = between / distance;
        let Meeting { ray, hit, .. } = &self.meeting;
        let is_same_side = |normal: Vec3| normal.dot(ray.direction) * normal.dot(to_suffix) > 0.0;
        let Surface { normal, shading_normal, .. } = self.surface;
        if !(is_same_side(normal) && is_same_side(shading_normal) && is_same_side(self.normal)) {
            return None;
        }
        // In ratios, which are the same in any unit of length.
        let (cosines, nearness) = (normal.dot(to_suffix) / normal.dot(ray.direction), hit.distance / distance);
        Some(Sight { to_suffix, distance, extent: cosines * nearness * nearness })
    }

    /// How much of what is lent leaves for a station in this direction (world), over what leaves for its own one.
    fn outward<'s: 'b, 'b>(&self, scene: &'s Scene, bsdf: &'b mut Bsdf<'s>) -> impl Fn(Vec3) -> f32 + use<'b> {
        let coated = (self.breadth == Breadth::Coated).then(|| {
            let point = self.meeting.point(scene, bsdf);
            let home = point.outward(point.to_previous);
            (point, home)
        });
        move |to_station| coated.as_ref().map_or(1.0, |(point, home)| point.outward(to_station) / home)
    }

    /// Whether nothing stands between it and a surface from which it lies in this direction.
    fn is_visible(&self, scene: &Scene, station: &Surface, to_suffix: Vec3) -> bool {
        !scene.surfaces().occluded(station.offset(to_suffix), self.surface.offset(-to_suffix))
    }
}

/// A path that a suffix is lent to: its number, what it would carry to the suffix, in the density's unit, and by how
/// much longer its way is.
type Borrower = (usize, Spectrum, f64);
