//! The photon map: photons sorted into a grid whose rows are contiguous.
//!
//! On this kind of data (photons on surfaces, coherent queries) that beats a kd-tree (the book, "Performance").

use glam::Vec3;
use rayon::prelude::*;

use super::grid::Grid;
use super::nearest::kth_smallest;
use super::search::{GROUP, Hits, Lanes, Positions};
use super::sort::{Place, sort, typical_distance};
use super::{Photon, Radius};

/// The photons of one pass, ready for queries. Immutable.
#[derive(Debug)]
pub struct PhotonMap {
    photons: Vec<Photon>,
    /// Positions of `photons` once more, for the search.
    positions: Positions,
    grid: Grid,
    lanes: Lanes,
    paths_emitted: u64,
}

/// What a search has found, and its working space; to be used again from query to query.
#[derive(Debug, Default)]
pub struct Nearest {
    pub(super) hits: Hits,
    few: Vec<f32>,
    /// How far the last search for nearest photons had to go: the next is often beside it. Infinite if there were not enough as
    /// far as it was allowed to go.
    last: f32,
}

impl Nearest {
    /// How many photons the last search has found.
    pub fn len(&self) -> usize {
        self.hits.len()
    }

    /// Whether it has found none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

impl PhotonMap {
    /// Sorts the photons of `paths_emitted` light paths for queries with about this radius. Equal photons in equal
    /// order give an equal map, on any number of threads.
    pub fn build(photons: Vec<Photon>, paths_emitted: u64, radius: Radius) -> PhotonMap {
        PhotonMap::from_blocks(&[photons], paths_emitted, radius)
    }

    /// [`PhotonMap::build`] of photons that lie in several blocks, one after the other.
    pub fn from_blocks(blocks: &[Vec<Photon>], paths_emitted: u64, radius: Radius) -> PhotonMap {
        let radius = match radius {
            Radius::Fixed(radius) => radius,
            Radius::Nearest { count, max_radius } => typical_distance(blocks, count).min(max_radius),
        };
        let (grid, order) = sort(blocks, radius);
        let photon = |place: &Place| blocks[place.block as usize][place.index as usize];
        let photons: Vec<Photon> = order.par_iter().map(photon).collect();
        PhotonMap { positions: positions(&photons), photons, grid, lanes: Lanes::detect(), paths_emitted }
    }

    /// All photons, sorted by cell.
    pub fn photons(&self) -> &[Photon] {
        &self.photons
    }

    /// How many light paths were emitted for it.
    pub fn paths_emitted(&self) -> u64 {
        self.paths_emitted
    }

    /// All photons nearer to `center` than `radius`, each with its squared distance, in an order that is the map's.
    #[inline]
    pub fn within<'m>(
        &'m self,
        center: Vec3,
        radius: f32,
        found: &'m mut Nearest,
    ) -> impl Iterator<Item = (&'m Photon, f32)> {
        self.search(center, Radius::Fixed(radius), found);
        self.found(found)
    }

    /// Finds the radius of an estimate from the `count` nearest photons: the distance of the last of them, or
    /// `max_radius` if there are fewer up to there; where that is infinite, the distance of the farthest of all. With
    /// it come all photons that are nearer, as from [`PhotonMap::within`].
    #[inline]
    pub fn nearest<'m>(
        &'m self,
        center: Vec3,
        count: usize,
        max_radius: f32,
        found: &'m mut Nearest,
    ) -> (f32, impl Iterator<Item = (&'m Photon, f32)>) {
        let radius = self.search(center, Radius::Nearest { count, max_radius }, found);
        (radius, self.found(found))
    }

    #[inline]
    fn found<'m>(&'m self, found: &'m Nearest) -> impl Iterator<Item = (&'m Photon, f32)> {
        let numbers = found.hits.indices().iter().zip(found.hits.distances_squared());
        numbers.map(|(&index, &distance_squared)| (&self.photons[index as usize], distance_squared))
    }

    /// Leaves in `found` all photons nearer than this radius, which it returns in scene units.
    pub(super) fn search(&self, center: Vec3, radius: Radius, found: &mut Nearest) -> f32 {
        let (count, max_radius) = match radius {
            Radius::Fixed(radius) => {
                self.lanes.search(&self.grid, &self.positions, center, radius, &mut found.hits);
                return radius;
            }
            Radius::Nearest { count, max_radius } => (count, max_radius),
        };
        let guess = if found.last > 0.0 { found.last } else { self.grid.radius() };
        let mut reach = (MARGIN * guess).min(max_radius);
        let (radius_squared, enough) = loop {
            self.lanes.search(&self.grid, &self.positions, center, reach, &mut found.hits);
            let hits = &found.hits;
            if hits.len() >= count {
                break (kth_smallest(hits.distances_squared(), count, reach * reach, &mut found.few), true);
            }
            if reach >= max_radius || hits.len() == self.photons.len() {
                let all = || hits.distances_squared().iter().copied().fold(0.0, f32::max);
                break (if max_radius.is_finite() { max_radius * max_radius } else { all() }, false);
            }
            reach = (reach * GROWTH).min(max_radius);
        };
        found.hits.keep_below(radius_squared);
        let radius = radius_squared.sqrt();
        found.last = if enough { radius } else { f32::INFINITY };
        radius
    }
}

/// The nearest photons are looked for a little farther than they are expected, that there be enough at once; and if there
/// are not, still farther.
const MARGIN: f32 = 1.2;
const GROWTH: f32 = 1.5;

fn positions(photons: &[Photon]) -> Positions {
    const CHUNK: usize = 4096;
    let mut axes = [(); 3].map(|()| vec![0.0; photons.len() + GROUP]);
    let [xs, ys, zs] = &mut axes;
    let chunks = xs.par_chunks_mut(CHUNK).zip(ys.par_chunks_mut(CHUNK)).zip(zs.par_chunks_mut(CHUNK));
    chunks.zip(photons.par_chunks(CHUNK)).for_each(|(((xs, ys), zs), photons)| {
        for (((x, y), z), photon) in xs.iter_mut().zip(ys).zip(zs).zip(photons) {
            [*x, *y, *z] = photon.position.to_array();
        }
    });
    Positions { axes }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::material::Lobes;
    use crate::photon::Kernel;
    use crate::sampler::Sampler;
    use crate::spectrum::Spectrum;

    /// Photons on a square and a few far away, as on an infinite plane.
    fn photons(count: usize) -> Vec<Photon> {
        let mut sampler = Sampler::new(11, 0, 0, 0);
        let photon = |index: usize| {
            let stretch = if index.is_multiple_of(100) { 1e4 } else { 1.0 };
            Photon {
                position: (sampler.square() * stretch).extend(0.01 * sampler.uniform()),
                direction: Vec3::NEG_Z,
                normal: Vec3::Z,
                optical_length: index as f32,
                reach: 1.0,
                slowness: 1.0,
                flux: Spectrum::ONE,
                bounce: 0,
                shading: 1.0,
                rivals: 0.0,
                path: 0,
                history: Lobes::NONE,
            }
        };
        (0..count).map(photon).collect()
    }

    /// What the photons are recognised by, sorted.
    fn numbers<'p>(found: impl Iterator<Item = &'p Photon>) -> Vec<u32> {
        let mut numbers: Vec<u32> = found.map(|photon| photon.optical_length as u32).collect();
        numbers.sort_unstable();
        numbers
    }

    fn by_force(photons: &[Photon], center: Vec3, radius: f32) -> Vec<u32> {
        numbers(photons.iter().filter(|photon| photon.position.distance_squared(center) < radius * radius))
    }

    #[test]
    fn a_search_within_a_radius_finds_what_trying_all_finds() {
        let photons = photons(5_000);
        let map = PhotonMap::build(photons.clone(), 1, Radius::Fixed(0.05));
        let far = photons[100].position;
        for (center, radius) in [(Vec3::new(0.5, 0.5, 0.0), 0.05), (Vec3::ZERO, 0.2), (far, 500.0), (far, 0.0)] {
            let found = numbers(map.within(center, radius, &mut Nearest::default()).map(|(photon, _)| photon));
            assert_eq!(found, by_force(&photons, center, radius), "at {center}");
        }
    }

    #[test]
    fn the_nearest_are_those_nearer_than_the_last_of_them() {
        let photons = photons(5_000);
        let mut found = Nearest::default();
        for max_radius in [f32::INFINITY, 0.02] {
            let map = PhotonMap::build(photons.clone(), 1, Radius::Nearest { count: 40, max_radius });
            for center in [Vec3::new(0.3, 0.6, 0.0), photons[200].position, Vec3::new(-50.0, 3.0, 1.0)] {
                let mut distances: Vec<f32> = photons.iter().map(|photon| photon.position.distance(center)).collect();
                distances.sort_by(f32::total_cmp);
                let (radius, nearest) = map.nearest(center, 40, max_radius, &mut found);
                let expected = distances[39].min(max_radius);
                assert!((radius - expected).abs() <= 1e-6 * expected, "{radius} is not {expected}");
                assert_eq!(numbers(nearest.map(|(photon, _)| photon)), by_force(&photons, center, radius));
            }
        }
    }

    /// Sets of photons that a grid may stumble over: on the borders of cells, in one cell, far from the origin, tiny.
    fn lumps() -> impl Strategy<Value = Vec<Photon>> {
        let lattice = (-8i8..8, -8i8..8, -2i8..2).prop_map(|(x, y, z)| Vec3::new(x.into(), y.into(), z.into()));
        let anywhere = (-1.0f32..1.0, -1.0f32..1.0, -0.1f32..0.1).prop_map(Vec3::from);
        let position = prop_oneof![lattice, anywhere, Just(Vec3::new(0.3, 0.2, 0.1))];
        let scale = prop_oneof![Just(1e-6), Just(1.0), Just(1e6)];
        let offset = prop_oneof![Just(0.0), Just(1.0), Just(1e3)];
        (prop::collection::vec(position, 0..300), scale, offset).prop_map(|(positions, scale, offset)| {
            let photon = photons(1)[0];
            let placed = positions.into_iter().zip(0_u8..=u8::MAX).map(|(at, number)| (at + offset, number));
            placed.map(|(at, n)| Photon { position: at * scale, optical_length: n.into(), ..photon }).collect()
        })
    }

    fn hits(map: &PhotonMap, center: Vec3, radius: Radius) -> (u32, Vec<(u32, u32)>) {
        let mut found = Nearest::default();
        let radius = map.search(center, radius, &mut found);
        let hits = found.hits.indices().iter().zip(found.hits.distances_squared());
        (radius.to_bits(), hits.map(|(&index, &distance)| (index, distance.to_bits())).collect())
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(500))]

        #[test]
        fn every_processor_finds_the_same_to_the_bit_and_what_trying_all_finds(
            photons in lumps(), at in any::<prop::sample::Index>(), aside in 0.0f32..2.0, radius in 0.001f32..30.0,
            cell in 0.001f32..30.0, count in 1usize..40,
        ) {
            // In the unit of the photons: what is far apart in one is far apart in all.
            let unit = photons.iter().map(|photon| photon.position.abs().max_element()).fold(0.0, f32::max).max(1e-9);
            let (radius, cell) = (radius * unit * 0.1, cell * unit * 0.1);
            let near = photons.get(at.index(photons.len().max(1))).map_or(Vec3::ZERO, |photon| photon.position);
            let map = PhotonMap::build(photons.clone(), 1, Radius::Fixed(cell));
            let portable = PhotonMap { lanes: Lanes::PORTABLE, ..PhotonMap::build(photons.clone(), 1, Radius::Fixed(cell)) };
            for center in [near, near + aside * unit, near * 3.0] {
                let mut all: Vec<f32> = photons.iter().map(|photon| photon.position.distance_squared(center)).collect();
                all.sort_by(f32::total_cmp);
                for limit in [radius, f32::INFINITY] {
                    let nearest = Radius::Nearest { count, max_radius: limit };
                    for search in [Radius::Fixed(limit), nearest] {
                        prop_assert_eq!(hits(&map, center, search), hits(&portable, center, search));
                    }
                    let inside = all.partition_point(|&distance| distance < limit * limit);
                    prop_assert_eq!(hits(&map, center, Radius::Fixed(limit)).1.len(), inside);
                    let last = match all.get(count - 1) {
                        Some(&kth) if kth < limit * limit => kth,
                        _ if limit.is_finite() => limit * limit,
                        _ => all.last().copied().unwrap_or(0.0),
                    };
                    let (radius, nearer) = hits(&map, center, nearest);
                    prop_assert_eq!(f32::from_bits(radius), last.sqrt());
                    prop_assert_eq!(nearer.len(), all.partition_point(|&distance| distance < last));
                }
            }
        }

        #[test]
        fn the_order_is_that_of_the_cells_and_then_of_the_photons_whatever_the_blocks(
            photons in lumps(), cell in 0.01f32..9.0, cuts in prop::collection::vec(any::<prop::sample::Index>(), 0..4),
        ) {
            let map = PhotonMap::build(photons.clone(), 1, Radius::Fixed(cell));
            let mut cuts: Vec<usize> = cuts.iter().map(|cut| cut.index(photons.len() + 1)).collect();
            cuts.sort_unstable();
            let begins = std::iter::once(0).chain(cuts.iter().copied());
            let ends = cuts.iter().copied().chain([photons.len()]);
            let blocks: Vec<Vec<Photon>> = begins.zip(ends).map(|(begin, end)| photons[begin..end].to_vec()).collect();
            let joined = PhotonMap::from_blocks(&blocks, 1, Radius::Fixed(cell));
            prop_assert_eq!(joined.photons(), map.photons());
            let mut expected = photons;
            expected.sort_by_key(|photon| map.grid.cell_of(photon.position));
            prop_assert_eq!(map.photons(), expected);
        }
    }

    #[test]
    fn many_photons_have_the_same_order_on_any_number_of_threads() {
        let photons = photons(100_000);
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| PhotonMap::build(photons.clone(), 1, Radius::Fixed(0.01)))
        };
        let mut expected = photons.clone();
        let one = on(1);
        expected.sort_by_key(|photon| one.grid.cell_of(photon.position));
        assert_eq!(one.photons(), expected);
        assert_eq!(on(3).photons(), expected);
    }

    #[test]
    fn sums_are_those_of_trying_all() {
        let photons = photons(20_000);
        let map = PhotonMap::build(photons.clone(), 1, Radius::Fixed(0.03));
        let weight = Kernel::Epanechnikov.weight::<2>(0.03);
        let mut found = Nearest::default();
        for center in (0..100).map(|number| photons[number * 199].position) {
            let sum: f32 =
                map.within(center, 0.03, &mut found).map(|(_, distance_squared)| weight(distance_squared)).sum();
            let all = map.photons().iter().map(|photon| photon.position.distance_squared(center));
            // In the same order, hence the same to the bit.
            assert_eq!(sum, all.filter(|&distance_squared| distance_squared < 0.03 * 0.03).map(&weight).sum::<f32>());
        }
    }

    #[test]
    fn photons_that_are_nowhere_are_not_found_and_disturb_none() {
        let mut photons = photons(1000);
        for (photon, bad) in
            photons.iter_mut().step_by(7).zip([f32::NAN, f32::INFINITY, f32::MAX, -f32::MAX].iter().cycle())
        {
            photon.position.y = *bad;
        }
        let center = photons[1].position;
        for radius in [Radius::Fixed(0.1), Radius::Nearest { count: 5, max_radius: f32::INFINITY }] {
            let map = PhotonMap::build(photons.clone(), 1, radius);
            let found = numbers(map.within(center, 0.1, &mut Nearest::default()).map(|(photon, _)| photon));
            assert_eq!(found, by_force(&photons, center, 0.1));
            assert!(map.nearest(center, 2000, f32::INFINITY, &mut Nearest::default()).0 < 1e6);
            assert_eq!(map.within(Vec3::NAN, 1.0, &mut Nearest::default()).count(), 0);
        }
    }

    #[test]
    fn a_map_of_nothing_or_of_one_place_can_be_asked() {
        let mut found = Nearest::default();
        for photons in [Vec::new(), vec![photons(1)[0]; 100]] {
            for radius in [Radius::Fixed(0.1), Radius::Nearest { count: 5, max_radius: f32::INFINITY }] {
                let map = PhotonMap::build(photons.clone(), 1, radius);
                assert_eq!(map.within(Vec3::ZERO, 1e6, &mut found).count(), photons.len());
                // There are fewer than a thousand: the farthest sets the radius, and is not counted itself.
                let farthest = photons.first().map_or(0.0, |photon| photon.position.length());
                let (radius, nearer) = map.nearest(Vec3::ZERO, 1000, f32::INFINITY, &mut found);
                assert!((radius - farthest).abs() <= 1e-6 * farthest, "{radius} is not {farthest}");
                assert_eq!(nearer.count(), 0);
            }
        }
    }
}
