//! The weight of a photon by its distance (theory §5.2).

use std::f32::consts::{FRAC_PI_2, PI, TAU};

pub use crate::scene::description::KernelName as Kernel;

/// The Gaussian's standard deviation is the radius over this.
const GAUSSIAN_CUT: f32 = 2.0;

impl Kernel {
    /// All kernels, for tests and tables.
    pub const ALL: [Kernel; 6] =
        [Kernel::Box, Kernel::Cone, Kernel::Gaussian, Kernel::Epanechnikov, Kernel::Biweight, Kernel::Cosine];

    /// The kernel at a squared distance, in 1/(scene units)^D. It vanishes from `radius` on and integrates to 1 over
    /// the ball of D dimensions: 1 for beams, 2 for surfaces, 3 for volumes.
    ///
    /// In this form it serves the k-nearest estimate as well: given the distance of the k-th photon, the k - 1 nearer
    /// ones are uniform in the ball, so that their kernels sum to (k - 1) / volume on average, which is the density
    /// without bias [García et al. 2012]. The k-th itself must not be counted.
    pub fn density<const D: usize>(self, distance_squared: f32, radius: f32) -> f32 {
        self.weight::<D>(radius)(distance_squared)
    }

    /// [`Kernel::density`] as a function of the squared distance alone, for many photons within one radius.
    #[inline]
    pub fn weight<const D: usize>(self, radius: f32) -> impl Fn(f32) -> f32 {
        let scale = Kernel::normalisation::<D>(self) / radius.powi(D as i32);
        let radius_squared = radius * radius;
        move |distance_squared| {
            let s2 = distance_squared / radius_squared;
            if s2 >= 1.0 { 0.0 } else { self.profile(s2) * scale }
        }
    }

    /// Replaces squared distances by [`Kernel::weight`] of them.
    pub fn weigh<const D: usize>(self, radius: f32, distances_squared: &mut [f32]) {
        let weight = self.weight::<D>(radius);
        distances_squared.iter_mut().for_each(|value| *value = weight(*value));
    }

    /// The shape, 1 in the middle, by the squared relative distance.
    #[inline]
    fn profile(self, s2: f32) -> f32 {
        match self {
            Kernel::Box => 1.0,
            Kernel::Cone => 1.0 - s2.sqrt(),
            Kernel::Gaussian => (-0.5 * GAUSSIAN_CUT * GAUSSIAN_CUT * s2).exp(),
            Kernel::Epanechnikov => 1.0 - s2,
            Kernel::Biweight => (1.0 - s2) * (1.0 - s2),
            Kernel::Cosine => (FRAC_PI_2 * s2.sqrt()).cos(),
        }
    }

    /// One over the integral of the profile over the unit ball: 2, π or 4π/3 for the box.
    #[inline]
    fn normalisation<const D: usize>(self) -> f32 {
        const { assert!(D >= 1 && D <= 3, "kernels exist in 1, 2 and 3 dimensions") };
        // Each row: the integral of profile × surface of the unit sphere in 1, 2, 3 dimensions.
        let integrals = match self {
            Kernel::Box => [2.0, PI, 4.0 * PI / 3.0],
            Kernel::Cone => [1.0, PI / 3.0, PI / 3.0],
            // σ = 1/2: √(2π)σ erf(√2), 2πσ²(1 - e⁻²), (2π)^{3/2}σ³ erf(√2) - 4πσ² e⁻².
            Kernel::Gaussian => {
                const ERF_SQRT_2: f32 = 0.954_499_7;
                const E_2: f32 = 0.135_335_28;
                let sigma = 1.0 / GAUSSIAN_CUT;
                let gauss = (TAU).sqrt() * sigma;
                [
                    gauss * ERF_SQRT_2,
                    TAU * sigma * sigma * (1.0 - E_2),
                    gauss * gauss * gauss * ERF_SQRT_2 - 2.0 * TAU * sigma * sigma * E_2,
                ]
            }
            Kernel::Epanechnikov => [4.0 / 3.0, FRAC_PI_2, 8.0 * PI / 15.0],
            Kernel::Biweight => [16.0 / 15.0, PI / 3.0, 32.0 * PI / 105.0],
            Kernel::Cosine => [4.0 / PI, 4.0 - 8.0 / PI, 8.0 - 64.0 / (PI * PI)],
        };
        1.0 / integrals[D - 1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ∫ density over the ball of radius 2.5 in D dimensions, by the midpoint rule in shells.
    fn integral<const D: usize>(kernel: Kernel) -> f64 {
        let (radius, shells) = (2.5, 200_000);
        let surface = |r: f64| match D {
            1 => 2.0,
            2 => std::f64::consts::TAU * r,
            _ => 2.0 * std::f64::consts::TAU * r * r,
        };
        let dr = radius / f64::from(shells);
        let shell = |i: i32| {
            let r = (f64::from(i) + 0.5) * dr;
            f64::from(kernel.density::<D>((r * r) as f32, radius as f32)) * surface(r) * dr
        };
        (0..shells).map(shell).sum()
    }

    #[test]
    fn every_kernel_integrates_to_one_in_one_two_and_three_dimensions() {
        for kernel in Kernel::ALL {
            for (dimension, value) in
                [(1, integral::<1>(kernel)), (2, integral::<2>(kernel)), (3, integral::<3>(kernel))]
            {
                assert!((value - 1.0).abs() < 1e-5, "{kernel:?} in {dimension}: {value}");
            }
        }
    }

    #[test]
    fn many_weights_are_those_of_each_to_the_bit() {
        for kernel in Kernel::ALL {
            let mut values: Vec<f32> = (0..37).map(|number| 0.3 * number as f32).collect();
            let expected: Vec<f32> = values.iter().map(|&value| kernel.density::<2>(value, 3.0)).collect();
            kernel.weigh::<2>(3.0, &mut values);
            assert_eq!(values, expected, "{kernel:?}");
        }
    }

    #[test]
    fn no_kernel_has_weight_at_the_radius_or_beyond() {
        for kernel in Kernel::ALL {
            assert_eq!(kernel.density::<2>(1.0, 1.0), 0.0);
        }
    }
}
