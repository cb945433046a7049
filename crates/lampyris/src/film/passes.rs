//! Which passes a film holds.

use std::fmt;
use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::error::{Error, Result};

/// A set of pass numbers, as ranges that neither touch nor overlap, in order.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "Vec<Range<u32>>")]
pub struct PassSet(Vec<Range<u32>>);

impl PassSet {
    /// None.
    pub fn new() -> PassSet {
        PassSet::default()
    }

    /// How many there are.
    pub fn count(&self) -> u64 {
        self.0.iter().map(|range| u64::from(range.end - range.start)).sum()
    }

    /// Whether this one is among them.
    pub fn contains(&self, pass: u32) -> bool {
        self.0.iter().any(|range| range.contains(&pass))
    }

    /// The first of these that is not among them.
    pub fn first_missing(&self, wanted: &Range<u32>) -> Option<u32> {
        let after = |pass: u32, range: &Range<u32>| if range.contains(&pass) { range.end } else { pass };
        let first = self.0.iter().fold(wanted.start, after);
        (first < wanted.end).then_some(first)
    }

    /// How many of these are not among them.
    pub fn missing(&self, wanted: &Range<u32>) -> u32 {
        let held = |range: &Range<u32>| range.end.min(wanted.end).saturating_sub(range.start.max(wanted.start));
        wanted.end.saturating_sub(wanted.start) - self.0.iter().map(held).sum::<u32>()
    }

    /// Adds one.
    pub fn insert(&mut self, pass: u32) {
        if !self.contains(pass) && pass < u32::MAX {
            self.0.push(pass..pass + 1);
            self.join();
        }
    }

    /// Adds those of another set.
    ///
    /// # Errors
    /// If both have a pass: its light would count twice.
    pub fn add(&mut self, other: &PassSet) -> Result<()> {
        for range in &other.0 {
            if let Some(own) = self.0.iter().find(|own| own.start < range.end && range.start < own.end) {
                let both = own.start.max(range.start)..own.end.min(range.end);
                return Err(Error::new(format!("both have {}", named(&both))));
            }
        }
        self.0.extend(other.0.iter().cloned());
        self.join();
        Ok(())
    }

    /// Puts disjoint ranges in order, and those that touch together.
    fn join(&mut self) {
        self.0.sort_by_key(|range| range.start);
        self.0.dedup_by(|next, range| {
            let touches = range.end == next.start;
            if touches {
                range.end = next.end;
            }
            touches
        });
    }
}

fn named(range: &Range<u32>) -> String {
    match range.end - range.start {
        1 => format!("pass {}", range.start),
        _ => format!("passes {}..{}", range.start, range.end),
    }
}

/// `0..3, 5..8`.
impl fmt::Display for PassSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ranges: Vec<String> = self.0.iter().map(|range| format!("{}..{}", range.start, range.end)).collect();
        f.write_str(&ranges.join(", "))
    }
}

impl TryFrom<Vec<Range<u32>>> for PassSet {
    type Error = &'static str;

    fn try_from(ranges: Vec<Range<u32>>) -> Result<PassSet, &'static str> {
        let in_order = ranges.windows(2).all(|pair| pair[0].end < pair[1].start);
        match in_order && ranges.iter().all(|range| range.start < range.end) {
            true => Ok(PassSet(ranges)),
            false => Err("ranges of passes must be in order and apart"),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use proptest::collection::btree_set;
    use proptest::prelude::*;

    fn set(passes: &BTreeSet<u32>) -> PassSet {
        let mut set = PassSet::new();
        passes.iter().rev().for_each(|&pass| set.insert(pass));
        set
    }

    proptest! {
        #[test]
        fn it_is_a_set(a in btree_set(0..30u32, 0..20), b in btree_set(0..30u32, 0..20), from in 0..30u32, more in 0..30u32) {
            let (mut sum, wanted) = (set(&a), from..from + more);
            prop_assert_eq!(sum.count(), a.len() as u64);
            prop_assert!((0..31).all(|pass| sum.contains(pass) == a.contains(&pass)));
            let missing: Vec<u32> = wanted.clone().filter(|pass| !a.contains(pass)).collect();
            prop_assert_eq!(sum.first_missing(&wanted), missing.first().copied());
            prop_assert_eq!(sum.missing(&wanted) as usize, missing.len());
            prop_assert_eq!(sum.add(&set(&b)).is_ok(), a.is_disjoint(&b));
            if a.is_disjoint(&b) {
                prop_assert_eq!(sum, set(&a.union(&b).copied().collect()));
            }
        }
    }

    #[test]
    fn what_two_have_in_common_is_named() {
        let (mut a, b) = (set(&(0..5).collect()), set(&(3..8).collect()));
        assert_eq!(a.add(&b).expect_err("overlap").message, "both have passes 3..5");
        assert_eq!(set(&[0, 1, 2, 5, 6, 9].into()).to_string(), "0..3, 5..7, 9..10");
    }
}
