//! Russian roulette (theory §4.2).

use crate::sampler::Sampler;

/// Whether a path goes on: with probability `level / reference`, at most 1, where `level` is the largest lane of its
/// throughput and `reference` that of a path which always goes on. Returns what the throughput of a survivor is
/// multiplied by, or none for a path that is absorbed.
///
/// Together with the choice of an event this is the lab's roulette of four events: for a white path, event e happens
/// with probability k_e and absorption with 1 - Σ k_e.
#[inline]
pub fn survive(reference: f32, level: f32, sampler: &mut Sampler) -> Option<f32> {
    let probability = level / reference;
    if probability >= 1.0 {
        return Some(1.0);
    }
    (sampler.uniform() < probability).then(|| 1.0 / probability)
}
