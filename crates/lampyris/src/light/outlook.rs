//! Guided shadow rays: they are shot at what a point is likely to see of the lights (theory §4.6).

use std::ops::Range;

use glam::{Vec2, Vec3};
use serde::{Deserialize, Serialize};

use super::mosaic::{ACROSS, Mosaic};
use super::{Light, LightId};
use crate::math::Distribution;

/// What points of a scene see of its lights, by where they are and which way they face.
#[derive(Debug)]
pub struct Outlook {
    trees: [Vec<Node>; SIDES],
    /// Which light a shadow ray is shot at, by vista.
    lights: Vec<Distribution>,
    /// And at which places on it, of each light that can be seen in part, one vista after the other.
    places: Vec<Mosaic>,
    /// The number of each such light among these.
    place_of: Vec<Option<u32>>,
    /// How many of these there are.
    placed: usize,
}

/// What is likely to be seen of the lights from somewhere.
#[derive(Clone, Copy, Debug)]
pub struct Vista<'o> {
    outlook: &'o Outlook,
    number: usize,
}

/// Points that face the same way are told apart by planes between them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Node {
    /// Below `at` along an axis, 0 to 2, the first of two nodes, else the other, by their numbers.
    Split {
        /// Across the plane.
        axis: u8,
        /// Where it is.
        at: f32,
        /// On its two sides.
        children: [u32; 2],
    },
    /// The number of what is seen here.
    Vista(u32),
}

/// What was learned of a scene: for each way to face, nodes, the first of which is the root; and what is seen, as weights
/// of all [`Parts`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sightings {
    /// By way to face.
    pub trees: [Vec<Node>; SIDES],
    /// Weights, 0 to 1.
    pub vistas: Vec<Vec<f32>>,
}

/// Ways to face: along the axis to which the normal is nearest.
pub const SIDES: usize = 6;

/// The way a point with this normal faces.
#[inline]
pub fn side(normal: Vec3) -> usize {
    let axis = normal.abs().max_position();
    2 * axis + usize::from(normal[axis] < 0.0)
}

/// The parts of the lights that are told apart.
#[derive(Clone, Debug)]
pub struct Parts {
    /// The first part of each light, and behind the last light their number.
    first: Vec<usize>,
}

/// A light that can be seen in part is cut into the cells of a [`Mosaic`].
const CELLS: usize = ACROSS * ACROSS;

/// The share of shadow rays that learning cannot take away, of lights and of places on one.
const EVEN: f64 = 0.25;
const EVEN_OF_LIGHT: f32 = 0.1;

impl Parts {
    /// Of these lights.
    pub fn new(lights: &[Light]) -> Parts {
        let cells = |light: &Light| if light.far().and_then(|far| far.unsample(Vec3::Z)).is_some() { CELLS } else { 1 };
        let ends = lights.iter().map(cells).scan(0, |end, cells| {
            *end += cells;
            Some(*end)
        });
        Parts { first: [0].into_iter().chain(ends).collect() }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.first.last().copied().unwrap_or(0)
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The part of a light that lies at a place on it.
    pub fn at(&self, light: LightId, place: Option<Vec2>) -> usize {
        self.first[light as usize] + place.map_or(0, cell)
    }

    /// The parts of a light.
    pub fn of(&self, light: LightId) -> Range<usize> {
        self.first[light as usize]..self.first[light as usize + 1]
    }

    /// Numbers of all parts, where each that lies on a light among others has become the mean of those around it.
    pub fn blurred(&self, of_parts: &[f64]) -> Vec<f64> {
        let mut blurred = of_parts.to_vec();
        for light in self.first.windows(2).filter(|light| light[1] - light[0] == CELLS) {
            let cells = &of_parts[light[0]..light[1]];
            for (cell, blurred) in blurred[light[0]..light[1]].iter_mut().enumerate() {
                let near = |at: usize| at.saturating_sub(1)..(at + 2).min(ACROSS);
                let (column, row) = (cell % ACROSS, cell / ACROSS);
                let around = near(row).flat_map(|row| near(column).map(move |column| cells[row * ACROSS + column]));
                let (sum, count) = around.fold((0.0, 0.0), |(sum, count), cell| (sum + cell, count + 1.0));
                *blurred = sum / count;
            }
        }
        blurred
    }

    /// The lights.
    fn lights(&self) -> impl Iterator<Item = LightId> {
        0..self.first.len() as LightId - 1
    }

    /// How lights are chosen by these weights; `selection` is how they are where nothing is known.
    fn choice(&self, weights: &[f32], selection: &Distribution) -> Distribution {
        let total: f64 = weights.iter().copied().map(f64::from).sum();
        let share = |light: LightId| {
            let own: f64 = weights[self.of(light)].iter().copied().map(f64::from).sum();
            let even = f64::from(selection.probability(light as usize));
            if total > 0.0 { EVEN * even + (1.0 - EVEN) * own / total } else { even }
        };
        Distribution::new(&self.lights().map(share).collect::<Vec<f64>>())
    }

    /// And the places on those that can be seen in part.
    fn places(&self, weights: &[f32]) -> Vec<Mosaic> {
        let place = |light: LightId| {
            let cells: &[f32; CELLS] = weights[self.of(light)].try_into().ok()?;
            let floor = EVEN_OF_LIGHT * cells.iter().sum::<f32>() / CELLS as f32;
            Some(Mosaic::new(&cells.map(|cell| floor + cell)))
        };
        self.lights().filter_map(place).collect()
    }
}

fn cell(place: Vec2) -> usize {
    let [column, row] = (place * ACROSS as f32).to_array().map(|at| (at as usize).min(ACROSS - 1));
    row * ACROSS + column
}

impl Sightings {
    /// Whether it can have been learned of lights with so many parts.
    pub fn is_fit(&self, parts: &Parts) -> bool {
        let weight = |weight: &f32| (0.0..=1.0).contains(weight);
        let node = |number: usize, node: &Node, nodes: usize| match *node {
            // Children come later, so that every way through the tree ends.
            Node::Split { axis, at, children } => {
                axis < 3
                    && at.is_finite()
                    && children.iter().all(|&child| (number + 1..nodes).contains(&(child as usize)))
            }
            Node::Vista(vista) => (vista as usize) < self.vistas.len(),
        };
        let tree = |nodes: &Vec<Node>| {
            !nodes.is_empty() && nodes.iter().enumerate().all(|(number, of)| node(number, of, nodes.len()))
        };
        self.trees.iter().all(tree)
            && self.vistas.iter().all(|vista| vista.len() == parts.len() && vista.iter().all(weight))
    }
}

impl Outlook {
    /// By what was learned, which must be [fit](Sightings::is_fit); `selection` is how lights are chosen where nothing is
    /// known.
    pub fn new(seen: &Sightings, parts: &Parts, selection: &Distribution) -> Outlook {
        let mut placed = 0;
        let mut place_of = |light: LightId| {
            let has_places = parts.of(light).len() == CELLS;
            placed += u32::from(has_places);
            has_places.then(|| placed - 1)
        };
        let place_of = parts.lights().map(&mut place_of).collect();
        Outlook {
            trees: seen.trees.clone(),
            lights: seen.vistas.iter().map(|weights| parts.choice(weights, selection)).collect(),
            places: seen.vistas.iter().flat_map(|weights| parts.places(weights)).collect(),
            place_of,
            placed: placed as usize,
        }
    }

    /// What is seen from a point with this normal.
    #[inline]
    pub fn vista(&self, at: Vec3, normal: Vec3) -> Vista<'_> {
        let nodes = &self.trees[side(normal)];
        let mut node = nodes[0];
        loop {
            match node {
                Node::Split { axis, at: plane, children } => {
                    node = nodes[children[usize::from(at[usize::from(axis)] >= plane)] as usize];
                }
                Node::Vista(number) => return Vista { outlook: self, number: number as usize },
            }
        }
    }
}

impl<'o> Vista<'o> {
    /// Its number among all that are told apart.
    pub fn number(&self) -> usize {
        self.number
    }

    /// How lights are chosen.
    #[inline]
    pub fn lights(&self) -> &'o Distribution {
        &self.outlook.lights[self.number]
    }

    /// How places on a light are chosen, as points of the unit square; none for lights that are not seen in part.
    #[inline]
    pub fn places(&self, light: LightId) -> Option<&'o Mosaic> {
        let place = self.outlook.place_of[light as usize]?;
        Some(&self.outlook.places[self.number * self.outlook.placed + place as usize])
    }
}
