//! What can happen to light at a vertex, and sets of such events.

use std::ops::BitOr;

/// What happens to light at a vertex of its path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Event {
    /// Scattered over the whole hemisphere.
    Diffuse,
    /// Scattered around a direction.
    Glossy,
    /// Mirrored.
    Specular,
    /// Sent through the surface in one direction.
    Refraction,
    /// Not met at all: the path has gone through a hole. It counts as no event of the path.
    Pass,
    /// Scattered by a particle of a medium.
    Scatter,
}

impl Event {
    /// All events of surfaces; their order is that of [`Event::index`].
    pub const ALL: [Event; 5] = [Event::Diffuse, Event::Glossy, Event::Specular, Event::Refraction, Event::Pass];

    /// Its place in [`Event::ALL`]; beyond that, if it is no event of a surface.
    pub const fn index(self) -> usize {
        self as usize
    }
}

/// A set of events.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Lobes(u8);

impl Lobes {
    /// Nothing: the path ends.
    pub const NONE: Lobes = Lobes(0);
    /// Events that scatter into a range of directions: where photons are stored and light is gathered.
    pub const SMOOTH: Lobes = Lobes(0b10_0011);
    /// Events with one possible direction: both walks pass through them.
    pub const DELTA: Lobes = Lobes(0b1_1100);
    /// Holes: paths go through, whatever else they may do.
    pub const HOLES: Lobes = Lobes(0b1_0000);
    /// All events.
    pub const ALL: Lobes = Lobes(0b11_1111);

    /// Whether the event is in the set.
    pub const fn contains(self, event: Event) -> bool {
        self.0 & (1 << event.index()) != 0
    }

    /// Whether the sets share an event.
    pub const fn meets(self, other: Lobes) -> bool {
        self.0 & other.0 != 0
    }

    /// The same and one more.
    #[must_use]
    pub const fn with(self, event: Event) -> Lobes {
        Lobes(self.0 | 1 << event.index())
    }

    /// The events that are in both sets.
    pub const fn and(self, other: Lobes) -> Lobes {
        Lobes(self.0 & other.0)
    }

    /// The event, if there is exactly one in the set.
    #[inline]
    pub const fn only(self) -> Option<Event> {
        if self.0.is_power_of_two() { Some(Event::ALL[self.0.trailing_zeros() as usize]) } else { None }
    }

    /// Whether the set is empty.
    pub const fn is_none(self) -> bool {
        self.0 == 0
    }
}

impl From<Event> for Lobes {
    fn from(event: Event) -> Lobes {
        Lobes(1 << event.index())
    }
}

impl BitOr for Lobes {
    type Output = Lobes;
    fn bitor(self, other: Lobes) -> Lobes {
        Lobes(self.0 | other.0)
    }
}
