//! Sums that have the same bits in whatever order, and in however many parts, the values came.
//!
//! A sum in floating point rounds after every value, so that its last bits tell the order. Here a value is cut where
//! multiples of 40 binary places lie, into *limbs* at fixed places, and each limb is summed as an integer of its own.
//! Kept are the two highest limbs that any value so far has touched; those below are dropped whole. Both which limbs these
//! are and what is in them depend on the set of values alone. What is dropped is less than 2⁻⁴⁰ of the largest value, for
//! each value. [Demmel & Nguyen 2015] sum likewise; their bins carry, ours are wide enough not to.

use std::hint::black_box;
use std::io::{self, Read, Write};

use rayon::prelude::*;

use super::storage::{Numbers, Storage};
use crate::error::Result;

/// Binary places of a limb.
const WIDTH: i32 = 40;
const MASK: u64 = (1 << WIDTH) - 1;

/// Place 0 is the lowest bit of the smallest double.
const LOWEST: i32 = -1074;

/// How many values can be added: each moves a limb by less than 2⁴⁰, and there are 2⁶³.
pub(super) const MOST_VALUES: u32 = 1 << 23;

/// Bits of [`ExactSums::top`]: the number of the higher limb, and what cannot be summed.
const LIMB: u8 = 0x3f;
const POSITIVE_INFINITY: u8 = 0x40;
const NEGATIVE_INFINITY: u8 = 0x80;
const NOT_A_NUMBER: u8 = POSITIVE_INFINITY | NEGATIVE_INFINITY;

/// The number of the highest limb that a finite double can touch.
const LAST_LIMB: u8 = ((1023 - LOWEST) / WIDTH) as u8;

/// Many such sums, at 17 bytes each. Infinite values and those that are no numbers make a sum what they would make it in
/// floating point, in any order.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ExactSums {
    /// Sums of the limb that `top` numbers, and of the one below it.
    high: Numbers<i64>,
    low: Numbers<i64>,
    top: Numbers<u8>,
}

/// One of them.
struct Sum<'a> {
    high: &'a mut i64,
    low: &'a mut i64,
    top: &'a mut u8,
}

/// How many sums a thread takes at a time.
const CHUNK: usize = 1 << 14;

/// How many items it looks ahead.
const AHEAD: usize = 32;

impl ExactSums {
    /// So many sums of nothing, in memory.
    pub(super) fn new(count: usize) -> ExactSums {
        ExactSums { high: Numbers::new(count), low: Numbers::new(count), top: Numbers::new(count) }
    }

    /// So many sums of nothing.
    ///
    /// # Errors
    /// Files for which there is no room.
    pub(super) fn new_in(storage: &Storage, count: usize) -> Result<ExactSums> {
        Ok(ExactSums { high: storage.zeros(count)?, low: storage.zeros(count)?, top: storage.zeros(count)? })
    }

    /// How many they are.
    pub(super) fn len(&self) -> usize {
        self.top.len()
    }

    /// Adds to each sum the value of its number.
    pub(super) fn add_each(&mut self, value: impl Fn(usize) -> f64 + Sync) {
        self.each(|index, mut sum| sum.add(value(index)));
    }

    /// Adds to some of the sums. They are groups of so many, one after the other; each item has values for the group of
    /// its number, and the items come in the order of these.
    pub(super) fn add_some<T: Sync>(
        &mut self,
        group: usize,
        items: &[T],
        number: impl Fn(&T) -> usize + Sync,
        value: impl Fn(&T, usize) -> f64 + Sync,
    ) {
        let chunk = group * CHUNK;
        let (Some(first), Some(last)) = (items.first(), items.last()) else { return };
        // Those chunks alone that have items.
        let [first, last] = [first, last].map(|item| number(item) / CHUNK);
        let range = first * chunk..((last + 1) * chunk).min(self.top.len());
        let add = |number_of_chunk: usize, high: &mut [i64], low: &mut [i64], top: &mut [u8]| {
            let first = number_of_chunk * CHUNK;
            let from = items.partition_point(|item| number(item) < first);
            let to = from + items[from..].partition_point(|item| number(item) < first + CHUNK);
            for some in items[from..to].chunks(AHEAD) {
                let at = |item: &T| group * (number(item) - first);
                // Waits for the memory of all of them at once, and not for that of one after the other.
                black_box(some.iter().map(at).fold(0, |any, at| any ^ high[at] ^ low[at] ^ i64::from(top[at])));
                for item in some {
                    for (index, at) in (at(item)..at(item) + group).enumerate() {
                        Sum { high: &mut high[at], low: &mut low[at], top: &mut top[at] }.add(value(item, index));
                    }
                }
            }
        };
        let (high, low, top) = (&mut self.high[range.clone()], &mut self.low[range.clone()], &mut self.top[range]);
        let chunks = high.par_chunks_mut(chunk).zip(low.par_chunks_mut(chunk)).zip(top.par_chunks_mut(chunk));
        chunks.enumerate().for_each(|(number, ((high, low), top))| add(first + number, high, low, top));
    }

    /// Adds what was added to others: the same as adding it here.
    ///
    /// # Panics
    /// If there are not as many.
    pub(super) fn merge(&mut self, others: &ExactSums) {
        assert_eq!(self.top.len(), others.top.len(), "as many sums");
        self.each(|index, mut sum| sum.merge(others.high[index], others.low[index], others.top[index]));
    }

    fn each(&mut self, change: impl Fn(usize, Sum) + Sync) {
        let change_all = |chunk: usize, high: &mut [i64], low: &mut [i64], top: &mut [u8]| {
            let sums = high.iter_mut().zip(low).zip(top);
            (chunk * CHUNK..).zip(sums).for_each(|(index, ((high, low), top))| change(index, Sum { high, low, top }));
        };
        if self.top.len() <= CHUNK {
            // To wake other threads would take longer.
            return change_all(0, &mut self.high, &mut self.low, &mut self.top);
        }
        let chunks = self.high.par_chunks_mut(CHUNK).zip(self.low.par_chunks_mut(CHUNK));
        let chunks = chunks.zip(self.top.par_chunks_mut(CHUNK)).enumerate();
        chunks.for_each(|(chunk, ((high, low), top))| change_all(chunk, high, low, top));
    }

    /// A sum, rounded once.
    pub(super) fn value(&self, index: usize) -> f64 {
        let top = self.top[index];
        match top & !LIMB {
            POSITIVE_INFINITY => return f64::INFINITY,
            NEGATIVE_INFINITY => return f64::NEG_INFINITY,
            NOT_A_NUMBER => return f64::NAN,
            _ => {}
        }
        let units = (i128::from(self.high[index]) << WIDTH) + i128::from(self.low[index]);
        let exponent = (i32::from(top & LIMB) - 1) * WIDTH + LOWEST;
        // In two steps, for the power alone may be too small for a double.
        units as f64 * power_of_two(exponent / 2) * power_of_two(exponent - exponent / 2)
    }

    /// Bytes that so many sums take.
    pub(super) const BYTES: usize = 2 * size_of::<i64>() + 1;

    /// All that they are, for [`ExactSums::read`].
    pub(super) fn write(&self, to: &mut dyn Write) -> io::Result<()> {
        let mut bytes = Vec::with_capacity(size_of::<i64>() * CHUNK);
        for limbs in [&self.high, &self.low] {
            for limbs in limbs.chunks(CHUNK) {
                bytes.clear();
                bytes.extend(limbs.iter().flat_map(|limb| limb.to_le_bytes()));
                to.write_all(&bytes)?;
            }
        }
        to.write_all(&self.top)
    }

    /// Makes these sums, which are as many, what [`ExactSums::write`] wrote.
    ///
    /// # Errors
    /// If there are not as many, or none that values can make ([`io::ErrorKind::InvalidData`]).
    pub(super) fn read(&mut self, from: &mut dyn Read) -> io::Result<()> {
        for limbs in [&mut self.high, &mut self.low] {
            from.read_exact(bytemuck::cast_slice_mut(limbs))?;
            limbs.iter_mut().for_each(|limb| *limb = i64::from_le(*limb));
        }
        from.read_exact(&mut self.top)?;
        let is_limb = |top: &u8| top & LIMB <= LAST_LIMB;
        if self.top.iter().all(is_limb) { Ok(()) } else { Err(io::ErrorKind::InvalidData.into()) }
    }
}

impl Sum<'_> {
    #[inline]
    fn add(&mut self, value: f64) {
        let bits = value.to_bits();
        let (exponent, fraction) = ((bits >> 52 & 0x7ff) as i32, bits & ((1 << 52) - 1));
        if exponent == 0 || exponent == 0x7ff {
            return self.add_special(value);
        }
        // The value is mantissa × 2^(place + LOWEST), and its highest bit is number 52 of the mantissa.
        let (mantissa, place) = (fraction | 1 << 52, exponent - 1);
        let own = (place + 52) / WIDTH;
        self.reach(own);
        // What it has in the limb of its highest bit, which begins within the mantissa, and in the one below.
        let down = own * WIDTH - place;
        let first = mantissa >> down;
        let second = if down < WIDTH { mantissa << (WIDTH - down) } else { mantissa >> (down - WIDTH) } & MASK;
        let sign = if bits >> 63 == 1 { -1 } else { 1 };
        let (high, low) = match i32::from(*self.top & LIMB) - own {
            0 => (first, second),
            1 => (0, first),
            _ => (0, 0),
        };
        *self.high = self.high.wrapping_add(sign * high as i64);
        *self.low = self.low.wrapping_add(sign * low as i64);
    }

    /// Adds a zero, something infinite, no number, or one so small that its mantissa does not begin with a one.
    #[cold]
    fn add_special(&mut self, value: f64) {
        let (is_negative, fraction) = (value.is_sign_negative(), value.to_bits() & ((1 << 52) - 1));
        if !value.is_finite() {
            *self.top |= match (value.is_nan(), is_negative) {
                (false, false) => POSITIVE_INFINITY,
                (false, true) => NEGATIVE_INFINITY,
                _ => NOT_A_NUMBER,
            };
        } else if fraction > 0 {
            self.reach((63 - fraction.leading_zeros() as i32) / WIDTH);
            let top = i32::from(*self.top & LIMB);
            let sign = if is_negative { -1 } else { 1 };
            let in_limb = |limb: i32| match limb {
                0 => (fraction & MASK) as i64,
                1 => (fraction >> WIDTH) as i64,
                _ => 0,
            };
            *self.high = self.high.wrapping_add(sign * in_limb(top));
            *self.low = self.low.wrapping_add(sign * in_limb(top - 1));
        }
    }

    fn merge(&mut self, high: i64, low: i64, top: u8) {
        *self.top |= top & !LIMB;
        let others = i32::from(top & LIMB);
        self.reach(others);
        // Limbs of files may be any numbers; those of values are far from overflowing.
        match i32::from(*self.top & LIMB) - others {
            0 => {
                *self.high = self.high.wrapping_add(high);
                *self.low = self.low.wrapping_add(low);
            }
            1 => *self.low = self.low.wrapping_add(high),
            _ => {}
        }
    }

    /// Keeps this limb, and all above it that are kept already.
    #[inline]
    fn reach(&mut self, limb: i32) {
        let above = limb - i32::from(*self.top & LIMB);
        if above > 0 {
            *self.low = if above == 1 { *self.high } else { 0 };
            *self.high = 0;
            *self.top = *self.top & !LIMB | limb as u8;
        }
    }
}

/// 2 to a power that a double can be.
fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((exponent + 1023) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::collection::vec;
    use proptest::prelude::*;

    fn sum(values: &[f64]) -> ExactSums {
        let mut sums = ExactSums::new(1);
        values.iter().for_each(|&value| sums.add_each(|_| value));
        sums
    }

    /// Every double that is finite, with many near each other; zeros of both signs.
    fn doubles() -> impl Strategy<Value = f64> {
        prop_oneof![
            4 => (-1.0..1.0f64, -38..38).prop_map(|(value, power)| value * 10f64.powi(power)),
            4 => (-1.0..1.0f64).prop_map(|value| 1e-12 * value),
            2 => -1e3..1e3f32.into(),
            1 => any::<f32>().prop_filter("finite", |value| value.is_finite()).prop_map(f64::from),
            1 => any::<f64>().prop_filter("finite", |value| value.is_finite() && value.abs() < 1e300),
            1 => prop_oneof![Just(0.0), Just(-0.0), Just(f64::from_bits(1)), Just(f64::MIN_POSITIVE)],
        ]
    }

    fn anything() -> impl Strategy<Value = f64> {
        prop_oneof![
            8 => doubles(),
            1 => prop_oneof![Just(f64::INFINITY), Just(f64::NEG_INFINITY), Just(f64::NAN)],
        ]
    }

    proptest! {
        #[test]
        fn any_order_gives_the_same_bits(
            (values, shuffled) in vec(anything(), 0..40).prop_flat_map(|values| (Just(values.clone()), Just(values).prop_shuffle()))
        ) {
            prop_assert_eq!(sum(&values), sum(&shuffled));
        }

        #[test]
        fn any_split_gives_the_same_bits(values in vec(anything(), 0..40), owners in vec(0..4usize, 40)) {
            let mut parts = vec![ExactSums::new(1); 4];
            for (value, owner) in values.iter().zip(owners) {
                parts[owner].add_each(|_| *value);
            }
            for order in [[0, 1, 2, 3], [3, 1, 0, 2]] {
                let mut merged = ExactSums::new(1);
                order.iter().for_each(|&part| merged.merge(&parts[part]));
                prop_assert_eq!(&merged, &sum(&values));
            }
        }

        #[test]
        fn what_is_lost_is_less_than_a_part_in_a_million_million_of_the_largest(values in vec(-1_000_000_000_000_i64..1_000_000_000_000, 1..200)) {
            // Powers that are far apart, so that limbs come and go.
            let scaled: Vec<i128> = values.iter().zip(0..).map(|(&value, i)| i128::from(value) << (7 * (i % 9))).collect();
            let largest = scaled.iter().map(|value| value.abs()).max().unwrap_or(0) as f64;
            let exact = scaled.iter().sum::<i128>() as f64;
            let doubles: Vec<f64> = scaled.iter().map(|&value| value as f64).collect();
            prop_assert!(scaled.iter().zip(&doubles).all(|(&value, &double)| double as i128 == value));
            let found = sum(&doubles).value(0);
            let allowed = values.len() as f64 * largest * 2f64.powi(-40) + 1e-15 * exact.abs();
            prop_assert!((found - exact).abs() <= allowed, "{} is not {} ± {}", found, exact, allowed);
        }

        #[test]
        fn bytes_keep_all_of_it(values in vec(anything(), 0..20)) {
            let sums = sum(&values);
            let mut bytes = Vec::new();
            sums.write(&mut bytes).expect("memory");
            prop_assert_eq!(bytes.len(), ExactSums::BYTES);
            let mut read = ExactSums::new(1);
            read.read(&mut bytes.as_slice()).expect("as many");
            prop_assert_eq!(&read, &sums);
            prop_assert!(read.read(&mut &bytes[1..]).is_err());
        }

        #[test]
        fn bytes_of_others_do_no_harm(bytes in vec(any::<u8>(), 2 * ExactSums::BYTES), value in anything()) {
            let mut sums = ExactSums::new(2);
            if sums.read(&mut bytes.as_slice()).is_ok() {
                sums.add_each(|_| value);
                sums.merge(&sums.clone());
                let _ = (sums.value(0), sums.value(1));
            }
        }
    }

    #[test]
    fn some_sums_are_added_to_as_all_are() {
        let count = 5 * CHUNK;
        let value = |index: usize| if index % 6 < 2 { 0.1 * index as f64 } else { 0.0 };
        let items: Vec<usize> = (0..count).filter(|index| index % 6 == 0).map(|index| index / 2).collect();
        let (mut all, mut some) = (ExactSums::new(count), ExactSums::new(count));
        for _ in 0..2 {
            all.add_each(value);
            some.add_some(2, &items, |&item| item, |&item, index| value(2 * item + index));
        }
        assert_eq!(all, some);
    }

    #[test]
    fn one_value_is_itself() {
        for value in
            [0.0, 1.0, -2.5, 1e-45_f32.into(), f32::MAX.into(), (-3.3e38_f32).into(), 0.1_f32.into(), 2f64.powi(-1000)]
        {
            assert_eq!(sum(&[value]).value(0), value);
        }
        // Doubles of more bits than the limbs keep are rounded down at the 41st bit or later.
        assert!((sum(&[0.1]).value(0) / 0.1 - 1.0).abs() < 1e-12);
    }

    #[test]
    fn what_is_no_number_makes_the_sum_what_floating_point_does() {
        assert_eq!(sum(&[1.0, f64::INFINITY, -5.0]).value(0), f64::INFINITY);
        assert_eq!(sum(&[f64::NEG_INFINITY, 1.0]).value(0), f64::NEG_INFINITY);
        assert!(sum(&[f64::NEG_INFINITY, 1.0, f64::INFINITY]).value(0).is_nan());
        assert!(sum(&[f64::NAN, 1.0]).value(0).is_nan());
    }

    #[test]
    fn as_many_values_as_are_allowed_do_not_overflow() {
        // All bits of the highest limb, so many times.
        let value = (2f64.powi(40) - 1.0) * 2f64.powi(6);
        let mut sums = sum(&[value]);
        for _ in 0..23 {
            sums.merge(&sums.clone());
        }
        assert_eq!(sums.value(0), f64::from(MOST_VALUES) * value);
    }
}
