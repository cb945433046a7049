//! The index of refraction of a boundary, which may depend on the wavelength.

use crate::math::ONE_MINUS_EPSILON;
use crate::spectrum::{Dispersion, FRAUNHOFER_D, Spectrum};
use crate::texture::Lookup;
use crate::transient::IndexMode;

/// Index of refraction below the normal over that above it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ior {
    below: Dispersion,
    above: Dispersion,
    at_d: f32,
    /// Which index makes lengths optical.
    index: IndexMode,
    /// This one at Fraunhofer's line d.
    slowness_at_d: f32,
}

impl Ior {
    /// Between these two substances.
    pub fn new(below: Dispersion, above: Dispersion) -> Ior {
        let at_d = (below.at_d() / above.at_d()) as f32;
        Ior { below, above, at_d, index: IndexMode::Phase, slowness_at_d: at_d }
    }

    /// The same, where this index makes lengths optical.
    #[must_use]
    pub fn with_index(self, index: IndexMode) -> Ior {
        let with = Ior { index, ..self };
        let slowness_at_d = if self.disperses() { with.slowness(FRAUNHOFER_D) } else { self.at_d };
        Ior { slowness_at_d, ..with }
    }

    /// How much slower light of this wavelength in nm is below than above.
    fn slowness(&self, nanometres: f64) -> f32 {
        let ratio = match self.index {
            IndexMode::Phase => self.below.at(nanometres) / self.above.at(nanometres),
            IndexMode::Group => self.below.group_at(nanometres) / self.above.group_at(nanometres),
        };
        ratio as f32
    }

    /// How much slower light is below than above at Fraunhofer's line d.
    pub(super) fn slowness_at_d(&self) -> f32 {
        self.slowness_at_d
    }

    /// At Fraunhofer's line d: for passes without wavelengths.
    pub fn at_d(&self) -> f32 {
        self.at_d
    }

    /// Whether the boundary separates wavelengths.
    pub fn disperses(&self) -> bool {
        self.below.disperses() || self.above.disperses()
    }

    /// The index, and that of each lane in a pass whose wavelengths the boundary separates.
    #[inline]
    pub(super) fn at(&self, at: &Lookup) -> (f32, Option<Fan>) {
        match at.basis.nanometres() {
            Some(nanometres) if self.disperses() => self.fan(nanometres, *at.carried),
            _ => (self.at_d, None),
        }
    }

    #[inline(never)]
    fn fan(&self, nanometres: [f32; 4], carried: Spectrum) -> (f32, Option<Fan>) {
        let iors = nanometres.map(|nanometres| {
            let nanometres = f64::from(nanometres);
            (self.below.at(nanometres) / self.above.at(nanometres)) as f32
        });
        let slowness = match self.index {
            IndexMode::Phase => iors,
            IndexMode::Group => nanometres.map(|nanometres| self.slowness(nanometres.into())),
        };
        let carried = carried.lanes().map(f32::abs);
        let sum: f32 = carried.iter().sum();
        let chances = if sum > 0.0 { carried.map(|lane| lane / sum) } else { [0.25; 4] };
        (self.at_d, Some(Fan { iors, slowness, chances }))
    }
}

impl From<f32> for Ior {
    /// The same for all wavelengths.
    fn from(ratio: f32) -> Ior {
        let (below, above) = (Dispersion::None(ratio.into()), Dispersion::None(1.0));
        Ior { below, above, at_d: ratio, index: IndexMode::Phase, slowness_at_d: ratio }
    }
}

/// The indices of the four lanes at a boundary that separates them (theory §7.3).
///
/// What leads all of them the same way, reflection, they take together, each with its own share. Where their ways part, one
/// is drawn by how much the path carries of each: whatever the path carries, as a sum over the lanes, it keeps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fan {
    /// Index below the normal over that above it, by lane.
    pub iors: [f32; 4],
    /// How much slower light is below than above, by lane: the same, or the ratio of group indices.
    pub slowness: [f32; 4],
    /// The probability of each lane to be the one that is followed; they add up to 1.
    pub chances: [f32; 4],
}

impl Fan {
    /// The lane that is followed, from a number uniform in 0..1, and what is left of that number, uniform again.
    #[inline]
    pub fn choose(&self, u: f32) -> (usize, f32) {
        let mut left = u;
        let mut chosen = (0, 0.0);
        for (lane, &chance) in self.chances.iter().enumerate() {
            if chance > 0.0 {
                chosen = (lane, left / chance);
                if left < chance {
                    break;
                }
                left -= chance;
            }
        }
        (chosen.0, chosen.1.clamp(0.0, ONE_MINUS_EPSILON))
    }

    /// A function of the index, by lane.
    #[inline]
    pub fn lanes(&self, of: impl Fn(f32) -> f32) -> Spectrum {
        Spectrum::from_lanes(self.iors.map(of))
    }

    /// The lane that is followed, and nothing in the others, over its probability.
    #[inline]
    pub fn followed(&self, value: Spectrum, lane: usize) -> Spectrum {
        value.only(lane) / self.chances[lane]
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec2;

    use super::*;
    use crate::spectrum::Basis;

    fn glass() -> Ior {
        Ior::new(Dispersion::of_substance("sf11").expect("sf11"), Dispersion::None(1.0))
    }

    #[test]
    fn without_wavelengths_and_without_dispersion_there_is_one_index() {
        let rgb = Lookup::point(Vec2::ZERO);
        let (ior, fan) = glass().at(&rgb);
        assert!((ior - 1.784_72).abs() < 1e-5 && fan.is_none());
        let basis = Basis::wavelengths_at(0.5);
        assert_eq!(Ior::from(1.5).at(&Lookup { basis: &basis, ..rgb }), (1.5, None));
    }

    #[test]
    fn a_path_of_one_wavelength_follows_it_alone() {
        let basis = Basis::wavelengths_at(0.5);
        let Some(nanometres) = basis.nanometres() else { panic!("four wavelengths") };
        for (lane, nanometres) in nanometres.into_iter().enumerate() {
            let at = Lookup { basis: &basis, carried: &(Spectrum::ONE * 0.3).only(lane), ..Lookup::point(Vec2::ZERO) };
            let exact = Dispersion::of_substance("sf11").expect("sf11").at(nanometres.into()) as f32;
            let (_, fan) = glass().at(&at);
            let fan = fan.expect("the glass disperses");
            assert_eq!((fan.iors[lane], fan.chances[lane]), (exact, 1.0));
            assert!([0.0, 0.3, 0.999].iter().all(|&u| fan.choose(u).0 == lane));
        }
    }

    #[test]
    fn lanes_are_chosen_as_often_as_they_are_carried() {
        let carried = &Spectrum::from_lanes([0.1, 0.0, 0.3, 0.6]);
        let basis = Basis::wavelengths_at(0.5);
        let (_, fan) = glass().at(&Lookup { basis: &basis, carried, ..Lookup::point(Vec2::ZERO) });
        let fan = fan.expect("several lanes");
        let mut counts = [0; 4];
        for index in 0..1000 {
            let (lane, rest) = fan.choose((index as f32 + 0.5) / 1000.0);
            assert!((0.0..1.0).contains(&rest));
            counts[lane] += 1;
        }
        assert_eq!(counts, [100, 0, 300, 600]);
    }
}
