//! Low-discrepancy numbers: Sobol' points in sets of four dimensions, each set shuffled and each dimension scrambled by
//! hashes after Owen [Burley 2020], so that any number of points in any number of dimensions costs no memory.

/// Where a sequence stands: one point, read dimension by dimension.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sequence {
    seed: u32,
    /// With its bits reversed.
    index: u32,
    set: u32,
    /// The next dimension of the set to be read.
    dimension: u32,
    point: [u32; DIMENSIONS],
}

/// Dimensions that are stratified together.
const DIMENSIONS: usize = 4;

/// Later sets are not worth their price: what many vertices have in common is little.
const SETS: u32 = 14;

impl Sequence {
    /// Point number `index` of the sequence that `seed` chooses.
    pub(super) fn new(seed: u32, index: u32) -> Sequence {
        Sequence { seed, index: index.reverse_bits(), set: 0, dimension: UNREAD, point: [0; DIMENSIONS] }
    }

    /// The same set of the point of this part of the index.
    #[inline]
    pub(super) fn part(&self, number: u32, of: u32) -> Sequence {
        let index = self.index.reverse_bits().wrapping_mul(of).wrapping_add(number);
        Sequence { index: index.reverse_bits(), dimension: UNREAD, ..*self }
    }

    /// Goes to the beginning of a set.
    #[inline]
    pub(super) fn start(&mut self, set: u32) {
        (self.set, self.dimension) = (set, UNREAD);
    }

    /// Goes to the beginning of the next set.
    #[inline]
    pub(super) fn skip(&mut self) {
        self.start(self.set + 1);
    }

    /// The next number of 32 bits; none where only independent ones are left. `together` of them belong together and
    /// come from one set.
    #[inline]
    pub(super) fn next(&mut self, together: u32) -> Option<u32> {
        if self.dimension + together > DIMENSIONS as u32 {
            self.turn();
        }
        let value = (self.set < SETS).then(|| self.point[self.dimension as usize % DIMENSIONS]);
        self.dimension += 1;
        value
    }

    /// The last number of the set, if it has not been read; none where only independent ones are left.
    #[inline]
    pub(super) fn last(&mut self) -> Option<u32> {
        if self.dimension == UNREAD {
            self.turn();
        }
        let is_left = self.set < SETS && self.dimension < DIMENSIONS as u32;
        self.dimension = DIMENSIONS as u32;
        is_left.then(|| self.point[DIMENSIONS - 1])
    }

    /// Reads the point of a set that was begun, or else of the next.
    fn turn(&mut self) {
        if self.dimension != UNREAD {
            self.set += 1;
        }
        self.dimension = 0;
        if self.set < SETS {
            let seed = hash(self.seed ^ hash(self.set));
            self.point = sobol(scramble(self.index, seed));
            for (value, dimension) in self.point.iter_mut().zip(1..) {
                *value = scramble(*value, hash(seed.wrapping_add(dimension))).reverse_bits();
            }
        }
    }
}

/// The dimension of a set of which nothing was read yet: beyond the last one.
const UNREAD: u32 = 2 * DIMENSIONS as u32;

/// Owen's scrambling of the binary digits of a number in 0..1, as a hash of the digits before each
/// [Laine & Karras 2011], with the constants of [Vegdahl 2021]. The first digit is the lowest bit.
fn scramble(mut x: u32, seed: u32) -> u32 {
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^ x.wrapping_mul(0x53a2_2864)
}

/// A bijection of 32 bits in which every bit matters to every bit [Wellons 2018].
fn hash(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x21f0_aaad);
    x ^= x >> 15;
    x = x.wrapping_mul(0xd35a_2d97);
    x ^ (x >> 15)
}

/// The point of the Sobol' sequence of this index, both with their bits reversed: the highest bit of the index is the
/// lowest one here, and so is the first binary digit of a coordinate.
fn sobol(index: u32) -> [u32; DIMENSIONS] {
    let mut point = [0; DIMENSIONS];
    for (table, byte) in BYTES.iter().zip(index.to_le_bytes()) {
        for (value, part) in point.iter_mut().zip(table[usize::from(byte)]) {
            *value ^= part;
        }
    }
    point
}

/// What each value of each byte of such an index adds to the point.
static BYTES: [[[u32; DIMENSIONS]; 256]; 4] = byte_tables();

/// Degree, coefficients and first numbers of the primitive polynomials of the dimensions after the first
/// [Joe & Kuo 2008].
const POLYNOMIALS: [(usize, u32, [u32; 3]); DIMENSIONS - 1] = [(1, 0, [1, 0, 0]), (2, 1, [1, 3, 0]), (3, 1, [1, 3, 1])];

const fn byte_tables() -> [[[u32; DIMENSIONS]; 256]; 4] {
    let directions = directions();
    let mut tables = [[[0; DIMENSIONS]; 256]; 4];
    let mut entry = 0;
    while entry < 4 * 256 {
        let (byte, value) = (entry / 256, entry % 256);
        let mut bit = 0;
        while bit < 8 * DIMENSIONS {
            let (bit_number, dimension) = (bit / DIMENSIONS, bit % DIMENSIONS);
            if value >> bit_number & 1 == 1 {
                tables[byte][value][dimension] ^= directions[dimension][31 - (8 * byte + bit_number)].reverse_bits();
            }
            bit += 1;
        }
        entry += 1;
    }
    tables
}

const fn directions() -> [[u32; 32]; DIMENSIONS] {
    let mut directions = [[0; 32]; DIMENSIONS];
    let mut bit = 0;
    while bit < 32 {
        directions[0][bit] = 1 << (31 - bit);
        let mut dimension = 1;
        while dimension < DIMENSIONS {
            let (degree, coefficients, first) = POLYNOMIALS[dimension - 1];
            let own = &mut directions[dimension];
            if bit < degree {
                own[bit] = first[bit] << (31 - bit);
            } else {
                own[bit] = own[bit - degree] ^ (own[bit - degree] >> degree);
                let mut k = 1;
                while k < degree {
                    if coefficients >> (degree - 1 - k) & 1 == 1 {
                        own[bit] ^= own[bit - k];
                    }
                    k += 1;
                }
            }
            dimension += 1;
        }
        bit += 1;
    }
    directions
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_points_are_those_that_joe_and_kuo_publish() {
        // Theirs are in the order of the Gray code.
        let published = [
            [0.0, 0.0, 0.0],
            [0.5, 0.5, 0.5],
            [0.75, 0.25, 0.25],
            [0.25, 0.75, 0.75],
            [0.375, 0.375, 0.625],
            [0.875, 0.875, 0.125],
            [0.625, 0.125, 0.875],
            [0.125, 0.625, 0.375],
            [0.1875, 0.3125, 0.9375],
            [0.6875, 0.8125, 0.4375],
        ];
        for (number, expected) in (0_u32..).zip(published) {
            let point = sobol((number ^ (number >> 1)).reverse_bits()).map(u32::reverse_bits);
            assert_eq!([0, 1, 2].map(|i| f64::from(point[i]) / 4_294_967_296.0), expected, "point {number}");
        }
    }

    /// Counts how many of the points fall into each box of `columns` × `rows`.
    fn counts(points: &[[u32; 2]], columns: u32, rows: u32) -> Vec<u32> {
        let mut counts = vec![0; (columns * rows) as usize];
        let cell = |value: u32, cells: u32| ((u64::from(value) * u64::from(cells)) >> 32) as u32;
        points.iter().for_each(|[x, y]| counts[(cell(*x, columns) * rows + cell(*y, rows)) as usize] += 1);
        counts
    }

    #[test]
    fn every_box_of_a_power_of_two_holds_one_of_as_many_points() {
        for (seed, set) in [(1, 0), (2, 5), (3, 13)] {
            let points: Vec<[u32; 2]> = (0..256)
                .map(|index| {
                    let mut sequence = Sequence::new(seed, index);
                    sequence.start(set);
                    [sequence.next(2).expect("a number"), sequence.next(1).expect("a number")]
                })
                .collect();
            for columns in [1, 2, 4, 8, 16, 32, 64, 128, 256] {
                assert_eq!(counts(&points, columns, 256 / columns), vec![1; 256], "set {set}, {columns} columns");
            }
        }
    }

    #[test]
    fn points_of_different_sets_and_seeds_do_not_correlate() {
        let number = |seed, set, index| {
            let mut sequence = Sequence::new(seed, index);
            sequence.start(set);
            f64::from(sequence.next(1).expect("a number")) / 4_294_967_296.0 - 0.5
        };
        let n = 1 << 14;
        for (a, b) in [((1, 0), (1, 1)), ((1, 2), (1, 7)), ((1, 0), (2, 0)), ((5, 3), (6, 3))] {
            let correlation: f64 =
                (0..n).map(|index| 12.0 * number(a.0, a.1, index) * number(b.0, b.1, index)).sum::<f64>()
                    / f64::from(n);
            // At most as far from 0 as independent numbers' would be: six standard deviations.
            assert!(correlation.abs() < 6.0 / f64::from(n).sqrt(), "{a:?} {b:?}: {correlation}");
        }
    }

    #[test]
    fn numbers_that_belong_together_come_from_one_set_and_later_sets_are_left_to_chance() {
        let mut sequence = Sequence::new(9, 77);
        (0..3).for_each(|_| assert!(sequence.next(1).is_some()));
        assert!(sequence.next(2).is_some());
        assert_eq!((sequence.set, sequence.dimension), (1, 1));
        sequence.start(SETS);
        assert!(sequence.next(1).is_none());
    }
}
