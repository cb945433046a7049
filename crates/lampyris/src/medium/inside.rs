//! Which media a path is in, where they lie in one another.

use super::MediumId;

/// What a closed shape holds, as a path that crosses its surface needs to know.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Interior {
    /// The medium inside; none for clear space, which displaces what is around the shape.
    pub medium: Option<MediumId>,
    /// Where shapes overlap, the one of the highest priority counts; among equals, the one that was entered last.
    pub priority: u16,
}

/// How many shapes with media can lie in one another. A path that enters still more forgets the least important.
const DEEPEST: usize = 6;

const CLEAR: Interior = Interior { medium: None, priority: 0 };

/// The shapes with media that a path is in, the one that counts last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Inside {
    interiors: [Interior; DEEPEST],
    count: u8,
}

impl Default for Inside {
    fn default() -> Inside {
        Inside::NOTHING
    }
}

impl Inside {
    /// Outside of all shapes that hold anything.
    pub const NOTHING: Inside = Inside { interiors: [CLEAR; DEEPEST], count: 0 };

    /// What the path is in; none outside of all shapes.
    #[inline]
    pub fn top(&self) -> Option<&Interior> {
        self.interiors[..usize::from(self.count)].last()
    }

    /// The path has gone through the surface of a shape, inwards or outwards.
    pub fn cross(&mut self, interior: Interior, inwards: bool) {
        if inwards { self.enter(interior) } else { self.leave(interior) }
    }

    fn enter(&mut self, interior: Interior) {
        let mut count = usize::from(self.count);
        if count == DEEPEST {
            self.interiors.copy_within(1.., 0);
            count -= 1;
        }
        let at = self.interiors[..count].partition_point(|other| other.priority <= interior.priority);
        self.interiors.copy_within(at..count, at + 1);
        self.interiors[at] = interior;
        self.count = count as u8 + 1;
    }

    /// Leaving what was never entered, by rounding at an edge, changes nothing.
    fn leave(&mut self, interior: Interior) {
        let count = usize::from(self.count);
        if let Some(at) = self.interiors[..count].iter().rposition(|other| *other == interior) {
            self.interiors.copy_within(at + 1..count, at);
            // Two ways into the same media are the same state.
            self.interiors[count - 1] = CLEAR;
            self.count -= 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn interior(medium: MediumId, priority: u16) -> Interior {
        Interior { medium: Some(medium), priority }
    }

    #[test]
    fn the_highest_priority_counts_and_among_equals_the_last() {
        let mut inside = Inside::NOTHING;
        assert_eq!(inside.top(), None);
        for (enters, counts) in [(interior(1, 0), 1), (interior(2, 0), 2), (interior(3, 5), 3), (interior(4, 1), 3)] {
            inside.cross(enters, true);
            assert_eq!(inside.top().and_then(|top| top.medium), Some(counts));
        }
        inside.cross(interior(3, 5), false);
        assert_eq!(inside.top(), Some(&interior(4, 1)));
        // Out of the middle one, as shapes that overlap are left in any order.
        inside.cross(interior(1, 0), false);
        inside.cross(interior(4, 1), false);
        assert_eq!(inside.top(), Some(&interior(2, 0)));
        inside.cross(interior(2, 0), false);
        assert_eq!(inside, Inside::NOTHING);
    }

    #[test]
    fn leaving_what_was_not_entered_and_entering_too_much_do_no_harm() {
        let mut inside = Inside::NOTHING;
        inside.cross(interior(1, 0), false);
        assert_eq!(inside, Inside::NOTHING);
        (0..20).for_each(|medium| inside.cross(interior(medium, 0), true));
        assert_eq!(inside.top(), Some(&interior(19, 0)));
    }
}
