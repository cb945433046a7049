//! Guided emission: photons leave for where they count (theory §5.5).

use glam::{Vec2, Vec3};
use serde::{Deserialize, Serialize};

use super::{Aim, Focus, LightId, Section};
use crate::geometry::Ray;
use crate::math::{Distribution, Grid};

/// A mixture of ways for a photon to leave: by the power of the lights alone, as defence, and aimed.
#[derive(Debug)]
pub struct Guide {
    aims: Vec<Aimed>,
    /// Which aim, and before them none.
    choice: Distribution,
    /// The numbers of the aims of each light.
    of_light: Vec<Vec<u32>>,
}

/// What is known of one way for a photon to leave.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Lesson {
    /// Of which light.
    pub light: LightId,
    /// Towards which focus; none for wherever the light itself would send it.
    pub focus: Option<u32>,
    /// How many photons should leave so, in any unit.
    pub share: f32,
    /// And how many of these on which part of the way's [`Section`]: by rows: [`Lesson::CELLS`] in all.
    pub cells: Vec<f32>,
}

/// A photon that leaves a light.
#[derive(Clone, Copy)]
pub struct Leaving<'l> {
    /// Number of the light.
    pub number: LightId,
    /// The light; none if its photons cannot be aimed.
    pub light: Option<&'l dyn Aim>,
    /// The probability of choosing it by its power.
    pub probability: f32,
    /// Where it goes.
    pub ray: Ray,
    /// Normal of the light's surface where it leaves; zero if it leaves none.
    pub normal: Vec3,
}

#[derive(Debug)]
struct Aimed {
    light: LightId,
    focus: Option<Focus>,
    place: Grid,
}

/// Cells a side by which the places of a section are told apart.
const SIDE: usize = 16;

/// The share of all photons, and of those of an aim, that learning cannot take away.
const EVEN: f32 = 0.25;
const EVEN_OF_AIM: f64 = 0.1;

impl Lesson {
    /// The number of its cells.
    pub const CELLS: usize = SIDE * SIDE;

    /// To be learned.
    pub fn empty(light: LightId, focus: Option<u32>) -> Lesson {
        Lesson { light, focus, share: 0.0, cells: vec![0.0; Lesson::CELLS] }
    }

    /// So much is worth while at a place.
    fn add(&mut self, place: Vec2, worth: f32) {
        let [column, row] = (place * SIDE as f32).to_array().map(|at| (at as usize).min(SIDE - 1));
        self.share += worth;
        self.cells[row * SIDE + column] += worth;
    }

    fn place(&self) -> Grid {
        let total: f64 = self.cells.iter().map(|&cell| f64::from(cell)).sum();
        let floor = EVEN_OF_AIM * total / Lesson::CELLS as f64;
        let cell = |column, row| self.cells.get(row * SIDE + column).map_or(0.0, |&cell: &f32| f64::from(cell));
        Grid::new(SIDE, SIDE, |column, row| floor + cell(column, row))
    }
}

impl Guide {
    /// By what was learned, where `even` is how many photons should leave by the power of the lights alone, in the unit of
    /// the shares.
    pub fn new(foci: &[Focus], even: f32, lessons: &[Lesson]) -> Guide {
        let learned: f32 = lessons.iter().map(|lesson| lesson.share).sum();
        // A share of at least `EVEN` in all.
        let even = even.max(EVEN / (1.0 - EVEN) * learned);
        let shares = [even].into_iter().chain(lessons.iter().map(|lesson| lesson.share)).map(f64::from);
        let choice = Distribution::new(&shares.collect::<Vec<f64>>());
        let mut of_light: Vec<Vec<u32>> = Vec::new();
        for (number, lesson) in (0..).zip(lessons).filter(|(_, lesson)| lesson.share > 0.0) {
            let light = lesson.light as usize;
            of_light.resize_with(of_light.len().max(light + 1), Vec::new);
            of_light[light].push(number);
        }
        let focus = |number: u32| foci.get(number as usize).copied();
        let aimed =
            |lesson: &Lesson| Aimed { light: lesson.light, focus: lesson.focus.and_then(focus), place: lesson.place() };
        Guide { aims: lessons.iter().map(aimed).collect(), choice, of_light }
    }

    /// One of the ways, by a number in 0..1: a light, and what to do with its [`Start`](super::Start); none for any light
    /// by its power.
    pub fn choose(&self, u: f32) -> Option<(LightId, impl FnOnce(&Section, Vec2) -> Ray)> {
        let (way, ..) = self.choice.sample(u);
        let aim = &self.aims[way.checked_sub(1)?];
        let ray = |section: &Section, u| {
            let section = aim.focus.map_or(*section, |focus| section.toward(&focus));
            section.ray(aim.place.sample(u).0)
        };
        Some((aim.light, ray))
    }

    /// How much denser photons are than if all left by power alone.
    pub fn factor(&self, leaving: &Leaving) -> f32 {
        let mut factor = self.choice.probability(0);
        self.ways(leaving, |_, _, density| factor += density);
        factor
    }

    /// Of each way in which a photon can leave so: its number, its place in the section, and its density over that of one
    /// that leaves by power.
    fn ways(&self, leaving: &Leaving, mut tell: impl FnMut(usize, Vec2, f32)) {
        let Leaving { number, light, probability, ray, normal } = leaving;
        let (Some(aims), Some(light)) = (self.of_light.get(*number as usize), light) else { return };
        let own = light.section(ray, *normal);
        let evenly = own.density(ray) * probability;
        for way in aims.iter().map(|&way| way as usize) {
            let Aimed { focus, place, .. } = &self.aims[way];
            let section = focus.map_or(own, |focus| own.toward(&focus));
            if let Some(at) = section.place(ray).filter(|_| evenly > 0.0) {
                tell(way, at, self.choice.probability(way + 1) * place.pdf(at) * section.density(ray) / evenly);
            }
        }
    }

    /// A photon that left so was worth so much: adds it to what is to be learned, parted among all ways by which it could
    /// have left. Returns the part of no aim.
    pub fn teach(&self, lessons: &mut [Lesson], worth: f32, leaving: &Leaving) -> f32 {
        let share = worth / self.factor(leaving);
        self.ways(leaving, |way, place, density| lessons[way].add(place, share * density));
        share * self.choice.probability(0)
    }
}
