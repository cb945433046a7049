//! Light by frequency: the Fourier transform of what arrives at each pixel.

use rayon::prelude::*;

use super::Transient;
use crate::error::{Error, Result};
use crate::image::luminance;

/// Values of waves, at all bins, that are kept at a time.
const WAVES: usize = 1 << 20;

/// Complex amplitudes by pixel and frequency.
#[derive(Clone, Debug, PartialEq)]
pub struct Phasors {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Cycles per scene unit of optical path length.
    pub frequencies: Vec<f64>,
    /// Where all phases are 0: optical path length in scene units.
    pub start: f64,
    /// `(height, width, frequencies, 2)`, row-major: real and imaginary parts.
    pub values: Vec<f32>,
}

impl Transient {
    /// Σ h_k exp(-2πi f (s_k - start)) over the bins h_k of the luminance with their middles s_k, for each frequency f in
    /// cycles per scene unit: what mitransient's phasor film gathers, which takes the path lengths themselves for s_k. The two
    /// agree as far as the bins are narrow beside 1/f.
    ///
    /// # Errors
    /// No frequency, or one that is not finite.
    pub fn phasors(&self, frequencies: &[f64]) -> Result<Phasors> {
        if let Some(broken) = frequencies.iter().find(|frequency| !frequency.is_finite()) {
            return Err(Error::new(format!("{broken} is no frequency")));
        }
        if frequencies.is_empty() {
            return Err(Error::new("there must be at least one frequency"));
        }
        let width = self.axis().bin_width;
        let mut values = vec![0.0; 2 * frequencies.len() * self.width() * self.height()];
        // A few waves at a time: all of them could take far more memory than the light.
        let few = (WAVES / self.bins()).max(1);
        for (some, first) in frequencies.chunks(few).zip((0..).step_by(few)) {
            let at = |frequency: f64| (0..self.bins()).map(move |bin| phase(frequency, width * (bin as f64 + 0.5)));
            let waves: Vec<Vec<[f64; 2]>> = some.iter().map(|&frequency| at(frequency).collect()).collect();
            let pixels = values.par_chunks_exact_mut(2 * frequencies.len());
            pixels.zip(self.values().par_chunks_exact(3 * self.bins())).for_each(|(out, profile)| {
                let light: Vec<f64> = profile.chunks_exact(3).map(|v| luminance([v[0], v[1], v[2]]).into()).collect();
                for (out, wave) in out[2 * first..].chunks_exact_mut(2).zip(&waves) {
                    let sum = |part: usize| wave.iter().zip(&light).map(|(w, l)| w[part] * l).sum::<f64>() as f32;
                    out.copy_from_slice(&[0, 1].map(sum));
                }
            });
        }
        let (start, frequencies) = (self.axis().start, frequencies.to_vec());
        Ok(Phasors { width: self.width(), height: self.height(), frequencies, start, values })
    }

    /// The frequencies that mitransient's `phasor_hdr_film` takes for `wl_mean` and `wl_sigma`, in scene units, and bins like
    /// these: multiples of 1/(bins × bin width) about 1/`wl_mean`.
    ///
    /// # Errors
    /// Wavelengths that are not positive numbers, or frequencies above what the bins can tell.
    pub fn phasor_frequencies(&self, wl_mean: f64, wl_sigma: f64) -> Result<Vec<f64>> {
        phasor_frequencies(self.bins(), self.axis().bin_width, wl_mean, wl_sigma)
    }
}

/// exp(-2πi f s) for a frequency f in cycles per scene unit and a path length s: real and imaginary part.
#[inline]
pub(crate) fn phase(frequency: f64, length: f64) -> [f64; 2] {
    // Whole turns are taken away while the number is exact enough to tell.
    let turns = frequency * length;
    let angle = -2.0 * std::f64::consts::PI * (turns - turns.round());
    [angle.cos(), angle.sin()]
}

/// The frequencies that mitransient's `phasor_hdr_film` takes for `wl_mean` and `wl_sigma`, in scene units, and these bins:
/// those of the discrete transform, multiples of 1/(bins × bin width), from mean - 3σ rounded down to mean + 3σ rounded up,
/// where the mean is 1/`wl_mean` and σ is 1/(6 `wl_sigma`).
///
/// # Errors
/// Wavelengths that are not positive numbers, or frequencies above what the bins can tell.
pub(crate) fn phasor_frequencies(bins: usize, bin_width: f64, wl_mean: f64, wl_sigma: f64) -> Result<Vec<f64>> {
    if ![wl_mean, wl_sigma].into_iter().all(|length| length.is_finite() && length > 0.0) {
        return Err(Error::new(format!("wavelengths must be numbers above 0, not {wl_mean} and {wl_sigma}")));
    }
    let range = bins as f64 * bin_width;
    let (mean, sigma) = (range / wl_mean, range / (6.0 * wl_sigma));
    let first = (mean - 3.0 * sigma).floor().max(0.0);
    let last = (mean + 3.0 * sigma).ceil().min((bins / 2) as f64);
    if first > last {
        let shortest = 2.0 * bin_width;
        return Err(Error::new(format!("bins of {bin_width} cannot tell waves of {wl_mean}"))
            .with_hint(format!("the shortest wavelength is two bins, {shortest}")));
    }
    Ok((first as usize..=last as usize).map(|index| index as f64 / range).collect())
}

#[cfg(test)]
mod tests {
    use super::super::Timing;
    use super::*;

    fn pulse_in(bin: usize, bins: usize) -> Transient {
        let mut values = vec![0.0; 3 * bins];
        values[3 * bin..3 * bin + 3].fill(2.0);
        Transient::from_values((1, 1, bins), Timing::new(5.0, 0.1), values).expect("a pixel")
    }

    #[test]
    fn a_pulse_has_all_frequencies_with_a_phase_by_its_time() {
        let frequencies = [0.0, 0.5, 1.0];
        let phasors = pulse_in(7, 20).phasors(&frequencies).expect("finite");
        for (frequency, value) in frequencies.iter().zip(phasors.values.chunks(2)) {
            let angle = -2.0 * std::f64::consts::PI * frequency * 0.75;
            let expected = [angle.cos(), angle.sin()].map(|part| 2.0 * part as f32);
            assert!(
                value.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-5),
                "{frequency}: {value:?} {expected:?}"
            );
        }
    }

    #[test]
    fn more_frequencies_than_are_taken_at_a_time_make_no_difference() {
        let transient = pulse_in(700_000, 800_000);
        let [several, alone] = [&[0.001, 0.2, 3.0][..], &[3.0]].map(|some| transient.phasors(some).expect("finite"));
        assert_eq!(several.values[4..], alone.values[..]);
    }

    #[test]
    fn frequencies_are_mitransients() {
        // mean 2.0 / 0.4 = 5, sigma 2.0 / 6 / 0.5 = 0.667: indices 3 to 7.
        let found = pulse_in(0, 20).phasor_frequencies(0.4, 0.5).expect("some");
        assert_eq!(found, [1.5, 2.0, 2.5, 3.0, 3.5]);
        // Cut at 0 and at the highest that the bins can tell.
        let all = pulse_in(0, 20).phasor_frequencies(0.4, 0.01).expect("some");
        assert_eq!((all[0], all.len()), (0.0, 11));
        assert!(pulse_in(0, 20).phasor_frequencies(0.01, 9.0).is_err());
        assert!(pulse_in(0, 20).phasor_frequencies(-1.0, 9.0).is_err());
    }

    #[test]
    fn the_transform_of_all_frequencies_keeps_the_energy() {
        let values: Vec<f32> = (0..48).map(|i| ((i / 3) as f32 * 1.7).sin() + 1.0).collect();
        let light: f32 = values.iter().step_by(3).map(|v| v * v).sum();
        let transient = Transient::from_values((1, 1, 16), Timing::new(0.0, 0.5), values).expect("a pixel");
        let frequencies: Vec<f64> = (0..16).map(|i| f64::from(i) / 8.0).collect();
        let phasors = transient.phasors(&frequencies).expect("finite");
        let energy: f32 = phasors.values.iter().map(|v| v * v).sum();
        assert!((energy / 16.0 / light - 1.0).abs() < 1e-4, "{energy} {light}"); // Parseval
        assert!(transient.phasors(&[]).is_err() && transient.phasors(&[f64::NAN]).is_err());
    }
}
