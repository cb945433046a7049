//! Clear substances whose index of refraction was measured over the wavelength.

use super::Dispersion;

/// A substance.
pub(super) struct Substance {
    /// What people call it, the name of scene files first.
    pub(super) names: &'static [&'static str],
    /// Bᵢ and Cᵢ (µm²) of [`Dispersion::Sellmeier`].
    terms: &'static [[f64; 2]],
}

impl Substance {
    pub(super) fn dispersion(&self) -> Dispersion {
        let mut terms = [[0.0; 2]; 4];
        terms.iter_mut().zip(self.terms).for_each(|(term, known)| *term = *known);
        Dispersion::Sellmeier(terms)
    }
}

/// The square of a resonance that a publication gives as a wavelength in µm.
const fn resonance(b: f64, wavelength: f64) -> [f64; 2] {
    [b, wavelength * wavelength]
}

/// Glasses: Schott's catalogue of January 2017. The others: as their publications have it, by way of refractiveindex.info,
/// whose data are in the public domain.
#[rustfmt::skip]
pub(super) const SUBSTANCES: &[Substance] = &[
    Substance { names: &["bk7", "n-bk7"], terms: &[[1.03961212, 0.00600069867], [0.231792344, 0.0200179144], [1.01046945, 103.560653]] },
    Substance { names: &["k7"], terms: &[[1.1273555, 0.00720341707], [0.124412303, 0.0269835916], [0.827100531, 100.384588]] },
    Substance { names: &["baf10", "n-baf10"], terms: &[[1.5851495, 0.00926681282], [0.143559385, 0.0424489805], [1.08521269, 105.613573]] },
    Substance { names: &["bak4", "n-bak4"], terms: &[[1.28834642, 0.00779980626], [0.132817724, 0.0315631177], [0.945395373, 105.965875]] },
    Substance { names: &["fk51a", "n-fk51a"], terms: &[[0.971247817, 0.00472301995], [0.216901417, 0.0153575612], [0.904651666, 168.68133]] },
    Substance { names: &["f2"], terms: &[[1.34533359, 0.00997743871], [0.209073176, 0.0470450767], [0.937357162, 111.886764]] },
    Substance { names: &["f5"], terms: &[[1.3104463, 0.00958633048], [0.19603426, 0.0457627627], [0.96612977, 115.011883]] },
    Substance { names: &["lasf9", "n-lasf9"], terms: &[[2.00029547, 0.0121426017], [0.298926886, 0.0538736236], [1.80691843, 156.530829]] },
    Substance { names: &["sf5"], terms: &[[1.46141885, 0.0111826126], [0.247713019, 0.0508594669], [0.949995832, 112.041888]] },
    Substance { names: &["sf6"], terms: &[[1.72448482, 0.0134871947], [0.390104889, 0.0569318095], [1.04572858, 118.557185]] },
    Substance { names: &["sf10"], terms: &[[1.61625977, 0.0127534559], [0.259229334, 0.0581983954], [1.07762317, 116.60768]] },
    Substance { names: &["sf11"], terms: &[[1.73848403, 0.0136068604], [0.311168974, 0.0615960463], [1.17490871, 121.922711]] },
    Substance { names: &["n-sf11"], terms: &[[1.73759695, 0.013188707], [0.313747346, 0.0623068142], [1.89878101, 155.23629]] },
    Substance { names: &["n-sf66"], terms: &[[2.0245976, 0.0147053225], [0.470187196, 0.0692998276], [2.59970433, 161.817601]] },
    // [Malitson 1965].
    Substance { names: &["fused-silica", "silica", "quartz-glass"], terms: &[resonance(0.6961663, 0.0684043), resonance(0.4079426, 0.1162414), resonance(0.8974794, 9.896161)] },
    // The ordinary ray, 20 °C [Malitson & Dodge 1972].
    Substance { names: &["sapphire"], terms: &[resonance(1.4313493, 0.0726631), resonance(0.65054713, 0.1193242), resonance(5.3414021, 18.028251)] },
    // [Peter 1923].
    Substance { names: &["diamond"], terms: &[resonance(0.3306, 0.1750), resonance(4.3356, 0.1060)] },
    // 20 °C [Daimon & Masumura 2007].
    Substance { names: &["water"], terms: &[[0.5684027565, 0.005101829712], [0.1726177391, 0.01821153936], [0.02086189578, 0.02620722293], [0.1130748688, 10.69792721]] },
    // 20 °C, fits to [Sultanova et al. 2009].
    Substance { names: &["pmma", "acrylic"], terms: &[[1.1819, 0.011313]] },
    Substance { names: &["polycarbonate"], terms: &[[1.4182, 0.021304]] },
];
