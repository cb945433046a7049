//! How the index of refraction of a clear substance depends on the wavelength.

use super::substances::{SUBSTANCES, Substance};

/// Fraunhofer's line F, blue light of hydrogen, in nm.
pub const FRAUNHOFER_F: f64 = 486.1327;
/// Fraunhofer's line d, yellow light of helium, in nm: an index of refraction without a wavelength is that of this line.
pub const FRAUNHOFER_D: f64 = 587.5618;
/// Fraunhofer's line C, red light of hydrogen, in nm.
pub const FRAUNHOFER_C: f64 = 656.2725;

/// A formula for the index of refraction over the wavelength in vacuum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Dispersion {
    /// The same for all wavelengths.
    None(f64),
    /// n² = 1 + Σ Bᵢ λ² / (λ² - Cᵢ), λ in µm: pairs of Bᵢ and Cᵢ (µm²) [Sellmeier 1871].
    Sellmeier([[f64; 2]; 4]),
    /// n = A + B / λ², λ in µm: A and B (µm²) [Cauchy 1836].
    Cauchy([f64; 2]),
}

impl Dispersion {
    /// Cauchy's formula with the index `d` at Fraunhofer's line d and the Abbe number (n_d - 1) / (n_F - n_C).
    pub fn of_abbe(d: f64, number: f64) -> Dispersion {
        let inverse_square = |nanometres: f64| (1000.0 / nanometres).powi(2);
        let slope = (d - 1.0) / (number * (inverse_square(FRAUNHOFER_F) - inverse_square(FRAUNHOFER_C)));
        Dispersion::Cauchy([d - slope * inverse_square(FRAUNHOFER_D), slope])
    }

    /// That of a substance, as it was measured; capitals and what is neither letter nor digit do not matter in its name.
    pub fn of_substance(name: &str) -> Option<Dispersion> {
        let bare = |name: &str| -> String {
            name.chars().filter(char::is_ascii_alphanumeric).collect::<String>().to_lowercase()
        };
        let name = bare(name);
        SUBSTANCES
            .iter()
            .find(|substance| substance.names.iter().any(|known| bare(known) == name))
            .map(Substance::dispersion)
    }

    /// The names of all substances, each with the shortest of its names.
    pub fn substances() -> impl Iterator<Item = &'static str> {
        SUBSTANCES.iter().filter_map(|substance| substance.names.first().copied())
    }

    /// The index at a wavelength in nm; not a number where the formula has none.
    pub fn at(&self, nanometres: f64) -> f64 {
        let square = (nanometres / 1000.0).powi(2);
        match self {
            Dispersion::None(index) => *index,
            Dispersion::Sellmeier(terms) => {
                let terms = terms.iter().map(|[b, c]| b * square / (square - c));
                (1.0 + terms.sum::<f64>()).sqrt()
            }
            Dispersion::Cauchy([a, b]) => a + b / square,
        }
    }

    /// The group index n - λ dn/dλ at a wavelength in nm, by which a pulse is slower than in vacuum; not a number where the
    /// formula has none.
    pub fn group_at(&self, nanometres: f64) -> f64 {
        let square = (nanometres / 1000.0).powi(2);
        match self {
            Dispersion::None(index) => *index,
            Dispersion::Sellmeier(terms) => {
                // 2 n dn/dλ is the derivative of n².
                let terms = terms.iter().map(|[b, c]| b * c * square / (square - c).powi(2));
                let index = self.at(nanometres);
                index + terms.sum::<f64>() / index
            }
            Dispersion::Cauchy([a, b]) => a + 3.0 * b / square,
        }
    }

    /// The index at Fraunhofer's line d.
    pub fn at_d(&self) -> f64 {
        self.at(FRAUNHOFER_D)
    }

    /// The Abbe number, (n_d - 1) / (n_F - n_C); infinite where all wavelengths are refracted alike.
    pub fn abbe_number(&self) -> f64 {
        (self.at_d() - 1.0) / (self.at(FRAUNHOFER_F) - self.at(FRAUNHOFER_C))
    }

    /// Whether wavelengths are refracted differently at all.
    pub fn disperses(&self) -> bool {
        match self {
            Dispersion::None(_) => false,
            Dispersion::Sellmeier(terms) => terms.iter().any(|[b, c]| *b != 0.0 && *c != 0.0),
            Dispersion::Cauchy([_, b]) => *b != 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(name: &str, nanometres: f64, published: f64, tolerance: f64) {
        let index = Dispersion::of_substance(name).expect(name).at(nanometres);
        assert!((index - published).abs() < tolerance, "{name} at {nanometres} nm: {index}, not {published}");
    }

    #[test]
    fn substances_have_their_published_indices() {
        // Schott's data sheets: n_F, n_d, n_C and V_d.
        let glasses = [
            ("bk7", [1.52238, 1.51680, 1.51432], 64.17),
            ("sf10", [1.74648, 1.72825, 1.72085], 28.41),
            ("sf11", [1.80645, 1.78472, 1.77599], 25.76),
            ("f2", [1.63208, 1.62004, 1.61503], 36.37),
        ];
        for (name, indices, number) in glasses {
            for (line, index) in [FRAUNHOFER_F, FRAUNHOFER_D, FRAUNHOFER_C].into_iter().zip(indices) {
                close(name, line, index, 1e-5);
            }
            let found = Dispersion::of_substance(name).expect(name).abbe_number();
            assert!((found - number).abs() < 0.01, "{name}: {found}");
        }
        // [Malitson 1965], table I; water at 20 °C [Daimon & Masumura 2007]; sapphire's ordinary ray, diamond at D and C.
        close("fused-silica", 486.1327, 1.463126, 1e-5);
        close("fused-silica", 587.5618, 1.458464, 1e-5);
        close("fused-silica", 656.2725, 1.456367, 1e-5);
        close("water", 589.3, 1.33336, 2e-5);
        close("sapphire", 589.3, 1.7681, 1e-4);
        close("diamond", 589.3, 2.4173, 3e-4);
        close("pmma", 587.6, 1.491, 1e-3);
        close("polycarbonate", 587.6, 1.585, 1e-3);
    }

    #[test]
    fn cauchys_formula_is_a_plus_b_over_the_square() {
        assert!((Dispersion::Cauchy([1.5, 0.004]).at(500.0) - 1.516).abs() < 1e-12);
    }

    #[test]
    fn an_abbe_number_comes_back() {
        let glass = Dispersion::of_abbe(1.5168, 64.17);
        assert!((glass.at_d() - 1.5168).abs() < 1e-12 && (glass.abbe_number() - 64.17).abs() < 1e-9);
        // KHR_materials_dispersion: n(λ) = n_d + (n_d - 1) / V_d (523655 / λ² - 1.5168).
        for nanometres in [400.0, 500.0, 700.0] {
            let khronos = 1.5168 + 0.5168 / 64.17 * (523_655.0 / (nanometres * nanometres) - 1.5168);
            assert!((glass.at(nanometres) - khronos).abs() < 2e-6, "{nanometres}");
        }
    }

    #[test]
    fn group_indices_are_the_index_less_its_slope() {
        // N-BK7: n_g of 1.58411 at 400 nm, 1.54136 at the line d and 1.53168 at 700 nm.
        let glass = Dispersion::of_substance("bk7").expect("bk7");
        for (nanometres, expected) in [(400.0, 1.58411), (587.56, 1.54136), (700.0, 1.53168)] {
            let found = glass.group_at(nanometres);
            assert!((found - expected).abs() < 1e-5, "{nanometres}: {found}");
        }
        for formula in [glass, Dispersion::of_abbe(1.6, 30.0), Dispersion::None(1.3)] {
            for nanometres in [400.0, 550.0, 720.0] {
                let slope = (formula.at(nanometres + 0.5) - formula.at(nanometres - 0.5)) / 1.0;
                let by_difference = formula.at(nanometres) - nanometres * slope;
                assert!((formula.group_at(nanometres) - by_difference).abs() < 1e-5, "{formula:?} at {nanometres}");
            }
        }
    }

    #[test]
    fn names_are_known_however_they_are_written() {
        assert_eq!(Dispersion::of_substance("N-BK7"), Dispersion::of_substance("bk7"));
        assert_eq!(Dispersion::of_substance("Fused silica"), Dispersion::of_substance("fused-silica"));
        assert_eq!(Dispersion::of_substance("butter"), None);
        assert!(Dispersion::substances().all(|name| Dispersion::of_substance(name).is_some_and(|it| it.disperses())));
    }
}
