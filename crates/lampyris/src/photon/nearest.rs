//! The k-th smallest of some numbers.

/// The `count`-th smallest, from 1, of at least that many values that lie in `0..=limit`.
///
/// Squared distances of points on a surface are about uniform. So a first guess divides the interval in proportion, a
/// count tells on which side the wanted one lies, and after a few rounds only some values are left to be sorted. The
/// result is one of the values: however it is found, it is the same.
pub(super) fn kth_smallest(values: &[f32], count: usize, limit: f32, few: &mut Vec<f32>) -> f32 {
    const FEW: usize = 8;
    const ROUNDS: usize = 6;
    let count = count.clamp(1, values.len().max(1));
    let below = |bound: f32| values.iter().map(|&value| u32::from(value < bound)).sum::<u32>() as usize;
    // `low_count` values are below `low`, fewer than wanted; `high_count` below `high`, enough.
    let (mut low, mut low_count) = (0.0, 0);
    let (mut high, mut high_count) = (f32::INFINITY, values.len());
    let mut top = limit;
    for _ in 0..ROUNDS {
        if high_count - low_count <= FEW || !top.is_finite() {
            break;
        }
        // A little beyond the wanted one on the side where more are left, so that the other side is cut off as well.
        let wanted = (count - low_count) as f32;
        let total = (high_count - low_count) as f32;
        let margin = if wanted < 0.5 * total { 2.0 } else { -3.0 };
        let share = ((wanted + margin) / total).clamp(0.02, 0.98);
        let guess = low + (top - low) * share;
        let guess_count = below(guess);
        if guess_count >= count {
            (high, high_count, top) = (guess, guess_count, guess);
        } else {
            (low, low_count) = (guess, guess_count);
        }
    }
    few.resize(values.len() + 1, 0.0);
    let mut kept = 0;
    for &value in values {
        few[kept] = value;
        kept += usize::from(value >= low && value < high);
    }
    let few = &mut few[..kept];
    if few.is_empty() {
        return limit;
    }
    let last = (count - 1 - low_count).min(kept - 1);
    *few.select_nth_unstable_by(last, f32::total_cmp).1
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(500))]

        #[test]
        fn it_is_the_one_at_that_place_when_all_are_sorted(
            values in prop::collection::vec(prop_oneof![0.0f32..1.0, Just(0.5), 0.0f32..1e-20, 0.99f32..1.0], 1..200),
            at in any::<prop::sample::Index>(), limit in prop_oneof![Just(1.0), Just(1e9), Just(f32::INFINITY)],
        ) {
            let place = at.index(values.len());
            let mut sorted = values.clone();
            sorted.sort_by(f32::total_cmp);
            prop_assert_eq!(kth_smallest(&values, place + 1, limit, &mut Vec::new()), sorted[place]);
        }
    }
}
