//! Smoothing and differencing of one channel, a row and a column at a time.

use rayon::prelude::*;

/// One channel of a picture, row by row.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Plane {
    pub width: usize,
    pub values: Vec<f32>,
}

impl Plane {
    /// The plane convolved with `across` along rows and `down` along columns, two kernels of odd length whose
    /// middle lies on the pixel. Beyond its edge the plane continues with the values at the edge.
    pub fn convolved(&self, across: &[f32], down: &[f32]) -> Plane {
        assert!(across.len() % 2 == 1 && down.len() % 2 == 1, "a kernel has a middle");
        self.convolved_across(across).convolved_down(down)
    }

    fn convolved_across(&self, kernel: &[f32]) -> Plane {
        let radius = kernel.len() / 2;
        let mut values = vec![0.0; self.values.len()];
        let rows = values.par_chunks_mut(self.width.max(1)).zip(self.values.par_chunks(self.width.max(1)));
        rows.for_each(|(output, row)| {
            let (first, last) = (row[0], row[row.len() - 1]);
            let mut padded = vec![first; radius];
            padded.extend_from_slice(row);
            padded.resize(row.len() + 2 * radius, last);
            for (value, window) in output.iter_mut().zip(padded.windows(kernel.len())) {
                *value = window.iter().zip(kernel.iter().rev()).map(|(v, k)| v * k).sum();
            }
        });
        Plane { width: self.width, values }
    }

    fn convolved_down(&self, kernel: &[f32]) -> Plane {
        let radius = kernel.len() / 2;
        let width = self.width.max(1);
        let height = self.values.len() / width;
        let mut values = vec![0.0; self.values.len()];
        values.par_chunks_mut(width).enumerate().for_each(|(y, output)| {
            for (step, weight) in kernel.iter().rev().enumerate() {
                let source = (y + step).saturating_sub(radius).min(height - 1);
                let row = &self.values[source * width..][..width];
                output.iter_mut().zip(row).for_each(|(value, v)| *value += v * weight);
            }
        });
        Plane { width: self.width, values }
    }
}

/// The values of `profile` at −radius..=radius, divided by their sum.
pub(crate) fn normalized_kernel(radius: usize, profile: impl Fn(f64) -> f64) -> Vec<f32> {
    let values: Vec<f64> = (0..=2 * radius).map(|i| profile(i as f64 - radius as f64)).collect();
    let sum: f64 = values.iter().sum();
    values.iter().map(|v| (v / sum) as f32).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shifted_impulse_moves_along_its_axis_only() {
        let mut values = vec![0.0; 15];
        values[5 + 2] = 1.0; // The middle of 5 columns, 3 rows.
        let plane = Plane { width: 5, values };
        // Convolution: weight at +1 carries light to the right (or down).
        let right = plane.convolved(&[0.0, 0.0, 1.0], &[1.0]);
        assert_eq!(right.values.iter().position(|&v| v == 1.0), Some(5 + 3));
        let below = plane.convolved(&[1.0], &[0.0, 0.0, 1.0]);
        assert_eq!(below.values.iter().position(|&v| v == 1.0), Some(10 + 2));
    }

    #[test]
    fn a_normalized_kernel_leaves_a_constant_plane_alone() {
        let plane = Plane { width: 4, values: vec![3.0; 12] };
        let kernel = normalized_kernel(5, |x| (-x * x / 4.0).exp());
        for value in plane.convolved(&kernel, &kernel).values {
            assert!((value - 3.0).abs() < 1e-5);
        }
    }
}
