//! Random numbers as a pure function of (seed, pass, purpose, index), so that any pass can be computed anywhere.

mod sequence;

use glam::Vec2;
use rand_core::Rng;
use rand_pcg::Pcg32;

use sequence::Sequence;

/// What the numbers are for; paths of different purposes are independent.
pub mod purpose {
    /// Walks from the lamps.
    pub const LIGHT: u32 = 1;
    /// Walks from the camera.
    pub const CAMERA: u32 = 2;
    /// The pilot that chooses a radius.
    pub const PILOT: u32 = 3;
    /// The photons that a detector counts.
    pub const DETECTOR: u32 = 4;
    /// Which pixels make a group.
    pub const GROUPS: u32 = 5;
}

/// The numbers of one path.
#[derive(Clone, Debug)]
pub struct Sampler {
    random: Pcg32,
    sequence: Option<Sequence>,
}

impl Sampler {
    /// The numbers of path `index` of a pass, independent of those of all other paths.
    pub fn new(seed: u64, pass: u32, purpose: u32, index: u64) -> Sampler {
        let key = keyed([seed, u64::from(pass) << 32 | u64::from(purpose), index]);
        Sampler { random: random(key), sequence: None }
    }

    /// The numbers of path `number` = 0, 1, 2 … of a `family` (a pixel's): those of one family fill
    /// the space of paths evenly, in the dimensions of the first vertices. The families are independent.
    pub fn even(seed: u64, purpose: u32, family: u64, number: u64) -> Sampler {
        let family = keyed([seed ^ EVEN, u64::from(purpose), family]);
        let random = random(mix(family ^ number));
        // A sequence has 2³² points; then comes another one.
        let sequence = mix(family ^ mix(number >> 32)) as u32;
        Sampler { random, sequence: Some(Sequence::new(sequence, number as u32)) }
    }

    /// Independent numbers without end, for those who take many between two steps.
    pub fn apart(&mut self) -> Sampler {
        let key = u64::from(self.random.next_u32()) << 32 | u64::from(self.random.next_u32());
        Sampler { random: random(mix(key)), sequence: None }
    }

    /// Bits without end for distributions that take as many as they please, such as those of `rand_distr`.
    pub fn bits(self) -> impl Rng {
        self.random
    }

    /// Goes to the dimensions that belong to one step of a path, so that the same step of other paths uses the same,
    /// however many numbers the steps before it took. Steps take four numbers each, or several steps are passed over.
    #[inline]
    pub fn step(&mut self, step: u32) {
        if let Some(sequence) = &mut self.sequence {
            sequence.start(step);
        }
    }

    /// The numbers of the next step, for something beside the path, which are as even as its own. Independent numbers are
    /// those that come next: what they are taken for has the right mean, but varies with what the path takes them for.
    #[inline]
    pub fn ahead(&self) -> Sampler {
        let mut ahead = self.clone();
        if let Some(sequence) = &mut ahead.sequence {
            sequence.skip();
        }
        ahead
    }

    /// The numbers of part `number` of so many, where what a step does is done in parts: as even among each other as those of
    /// as many paths.
    #[inline]
    pub fn part(&mut self, number: u32, of: u32) -> Sampler {
        let sequence = self.sequence.as_ref().map(|sequence| sequence.part(number, of));
        Sampler { sequence, ..self.apart() }
    }

    /// Uniform in [0, 1), 24 bits.
    #[inline]
    pub fn uniform(&mut self) -> f32 {
        self.number(1)
    }

    /// Uniform in the unit square.
    #[inline]
    pub fn square(&mut self) -> Vec2 {
        let x = self.number(2);
        Vec2::new(x, self.number(1))
    }

    /// Uniform in [0, 1): the last number of the step, if it is left, so that what comes next takes none of its own. For one
    /// thing more between two steps of three numbers.
    #[inline]
    pub fn spare(&mut self) -> f32 {
        match self.sequence.as_mut().and_then(Sequence::last) {
            Some(bits) => unit(bits),
            None => self.independent(),
        }
    }

    /// Uniform in [0, 1), of no step: for those who need any number of them.
    #[inline]
    pub fn independent(&mut self) -> f32 {
        unit(self.random.next_u32())
    }

    /// Numbers for a side matter of the path where it is now, which take none of its own.
    #[inline]
    pub fn aside(&self) -> Aside {
        Aside(self.random.clone().next_u64() ^ ASIDE)
    }

    #[inline]
    fn number(&mut self, together: u32) -> f32 {
        let bits = match self.sequence.as_mut().and_then(|sequence| sequence.next(together)) {
            Some(bits) => bits,
            None => self.random.next_u32(),
        };
        unit(bits)
    }
}

/// See [`Sampler::aside`].
#[derive(Clone, Copy, Debug)]
pub struct Aside(u64);

impl Aside {
    /// Uniform in [0, 1), 53 bits: one for each key, independent of all others.
    #[inline]
    pub fn uniform(self, key: [u32; 2]) -> f64 {
        let key = u64::from(key[0]) << 32 | u64::from(key[1]);
        (mix(mix(self.0) ^ mix(key)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// The first 24 bits as a number in [0, 1).
#[inline]
fn unit(bits: u32) -> f32 {
    (bits >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// The number of a pass, in [0, 1): those of all passes of a seed lie evenly, whichever of them there are so far, the radical
/// inverse in base 2 with its digits scrambled by the seed.
pub fn of_pass(seed: u64, pass: u32) -> f64 {
    f64::from(pass.reverse_bits() ^ mix(seed ^ PASS) as u32) / 4_294_967_296.0
}

/// Sets the seeds of [`of_pass`] apart from all others.
const PASS: u64 = 0xbb67_ae85_84ca_a73b;

/// Sets the numbers of [`Sampler::aside`] apart from all others.
const ASIDE: u64 = 0x3c6e_f372_fe94_f82b;

/// Sets the seeds of [`Sampler::even`] apart from those of [`Sampler::new`].
const EVEN: u64 = 0x6a09_e667_f3bc_c908;

/// PCG streams of near seeds correlate (its documentation says so): everything is hashed into the state instead.
fn random(key: u64) -> Pcg32 {
    Pcg32::new(key, 0x0a02_bdbf_7bb3_c0a7)
}

fn keyed(parts: [u64; 3]) -> u64 {
    let [first, rest @ ..] = parts;
    rest.into_iter().fold(mix(first ^ 0x9e37_79b9_7f4a_7c15), |key, part| mix(key ^ part))
}

/// A bijection of 64 bits in which every input bit changes every output bit with probability near one half
/// (the finaliser of SplitMix64, Steele et al. 2014, with Stafford's constants).
fn mix(mut x: u64) -> u64 {
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_path_gets_the_same_numbers_and_another_one_others() {
        let first = |seed, pass, purpose, index| Sampler::new(seed, pass, purpose, index).uniform();
        assert_eq!(first(1, 2, 3, 4), first(1, 2, 3, 4));
        let others = [first(2, 2, 3, 4), first(1, 3, 3, 4), first(1, 2, 4, 4), first(1, 2, 3, 5)];
        assert!(others.iter().all(|&other| other != first(1, 2, 3, 4)));
    }

    #[test]
    fn numbers_aside_are_independent_and_take_none() {
        let (mut sampler, untouched) = (Sampler::new(1, 2, 3, 4), Sampler::new(1, 2, 3, 4).uniform());
        let n = 100_000;
        let aside = sampler.aside();
        let numbers: Vec<f64> = (0..=n).map(|key| aside.uniform([7, key]) - 0.5).collect();
        assert_eq!(sampler.uniform(), untouched);
        let deviation = (1.0 / f64::from(n)).sqrt();
        let mean = numbers.iter().sum::<f64>() / f64::from(n);
        let correlation = 12.0 * numbers.windows(2).map(|pair| pair[0] * pair[1]).sum::<f64>() / f64::from(n);
        assert!(mean.abs() < 5.5 * deviation / 12_f64.sqrt(), "{mean}"); // false alarm 4e-8
        assert!(correlation.abs() < 5.5 * deviation, "{correlation}");
    }

    #[test]
    fn the_numbers_of_passes_fill_the_unit_evenly() {
        for seed in 0..20 {
            let mut places: Vec<usize> = (0..64).map(|pass| (of_pass(seed, pass) * 64.0) as usize).collect();
            places.sort_unstable();
            assert!(places.iter().copied().eq(0..64), "{places:?}");
        }
        assert!(of_pass(1, 0) != of_pass(2, 0));
    }

    #[test]
    fn neighbouring_paths_do_not_correlate() {
        // Sample correlation of the first numbers of n paths with those of their neighbours: normal, sd 1/√n.
        let n = 100_000;
        let numbers: Vec<f64> = (0..=n).map(|i| f64::from(Sampler::new(0, 0, 0, i).uniform()) - 0.5).collect();
        let correlation = 12.0 * numbers.windows(2).map(|pair| pair[0] * pair[1]).sum::<f64>() / n as f64;
        assert!(correlation.abs() < 5.5 / (n as f64).sqrt(), "{correlation}"); // false alarm 4e-8
    }
}
