//! The scattering function at one point: a mix of models, without textures.

use glam::Vec3;

use super::model::EVENTS;
use super::{Breadth, Event, Hole, Lobes, Model, RoughGlass, Scatter};
use crate::math::ONE_MINUS_EPSILON;
use crate::sampler::Sampler;
use crate::spectrum::Spectrum;

/// One part of a [`Bsdf`].
#[derive(Clone, Copy, Debug)]
pub struct Part<'a> {
    /// Its share, 0 to 1.
    pub weight: f32,
    /// Whether it lies upside down: a material of the back, seen from there.
    pub flipped: bool,
    /// What it is.
    pub model: Model<'a>,
}

/// How many parts a mix can have.
pub const MAX_PARTS: usize = 4;

/// The scattering function at one point.
#[derive(Clone, Copy, Debug)]
pub struct Bsdf<'a> {
    parts: [Part<'a>; MAX_PARTS],
    count: u8,
    lobes: Lobes,
    transmits: bool,
    /// Whether a rough part separates wavelengths.
    separates: bool,
}

/// A direction in which a path goes on.
#[derive(Clone, Copy, Debug)]
pub struct Scattered {
    /// The direction: local from [`Bsdf::sample`], of unit length.
    pub to_next: Vec3,
    /// What the throughput is multiplied by: value × cosine / density.
    pub weight: Spectrum,
    /// [`Bsdf::pdf`], a density per solid angle; for delta events the probability of the event.
    pub pdf: f32,
    /// What happened.
    pub event: Event,
    /// Index of refraction on the new side over that of the old one; 1 unless refracted.
    pub ior_ratio: Spectrum,
    /// How much slower light is on the new side than on the old one: the same ratio, or that of group indices.
    pub slowness: f32,
    /// What was chosen, among all events of all parts of the mix.
    pub slot: u8,
}

impl Default for Bsdf<'_> {
    /// Without any part: black.
    fn default() -> Self {
        let nothing = Part { weight: 0.0, flipped: false, model: Model::Hole(Hole) };
        Bsdf { parts: [nothing; MAX_PARTS], count: 0, lobes: Lobes::NONE, transmits: false, separates: false }
    }
}

impl<'a> Bsdf<'a> {
    /// Of one model alone.
    pub fn of(model: Model<'a>) -> Bsdf<'a> {
        let mut bsdf = Bsdf::default();
        bsdf.push(Part { weight: 1.0, flipped: false, model });
        bsdf
    }

    /// Takes all parts away.
    pub(super) fn clear(&mut self) {
        (self.count, self.lobes) = (0, Lobes::NONE);
        (self.transmits, self.separates) = (false, false);
    }

    /// Adds a part.
    ///
    /// # Panics
    /// Beyond [`MAX_PARTS`].
    pub(super) fn push(&mut self, part: Part<'a>) {
        self.lobes = self.lobes | part.model.lobes();
        self.transmits |= part.model.transmits();
        self.separates |= matches!(part.model, Model::RoughGlass(RoughGlass { fan: Some(_), .. }));
        self.parts[usize::from(self.count)] = part;
        self.count += 1;
    }

    fn parts(&self) -> &[Part<'a>] {
        &self.parts[..usize::from(self.count)]
    }

    /// The events that can happen.
    #[inline]
    pub fn lobes(&self) -> Lobes {
        self.lobes
    }

    /// Whether smooth lobes lead through the surface.
    #[inline]
    pub fn transmits(&self) -> bool {
        self.transmits
    }

    /// Share of the light that goes through holes.
    #[inline]
    pub fn holes(&self) -> f32 {
        let holes = self.parts().iter().filter(|part| matches!(part.model, Model::Hole(_)));
        holes.map(|part| part.weight).sum()
    }

    /// How much slower light is on the side of a direction to which smooth lobes lead, than on the side of `to_previous`.
    #[inline]
    pub fn slowness(&self, to_previous: Vec3, to_next: Vec3) -> f32 {
        if !self.transmits || to_previous.z * to_next.z > 0.0 {
            return 1.0;
        }
        let ratios = self.parts().iter().map(|part| part.model.slowness(part.turned(to_previous)));
        ratios.into_iter().find(|&ratio| ratio != 1.0).unwrap_or(1.0)
    }

    /// The value of the smooth lobes in 1/sr, without a cosine, for flux that comes from `to_previous`; see
    /// [`Scatter::eval`].
    #[inline]
    pub fn eval(&self, to_previous: Vec3, to_next: Vec3) -> Spectrum {
        let mut value = Spectrum::ZERO;
        for part in self.parts() {
            value += part.eval(to_previous, to_next);
        }
        value
    }

    /// Whether there is Lambert's reflection and nothing else.
    #[inline]
    pub fn is_lambertian(&self) -> bool {
        matches!(self.parts(), [Part { model: Model::Diffuse(_), .. }])
    }

    /// The value of [`Bsdf::eval`] where it is the same for all directions on the side of `to_previous`, and zero on the
    /// other.
    #[inline]
    pub fn even(&self, to_previous: Vec3) -> Option<Spectrum> {
        self.parts().iter().try_fold(Spectrum::ZERO, |sum, part| {
            Some(sum + part.model.scatter().even(part.turned(to_previous))? * part.weight)
        })
    }

    /// The broad part of [`Bsdf::eval`]; see [`Scatter::broad`].
    pub fn broad(&self, to_previous: Vec3, to_next: Vec3) -> Spectrum {
        let broad =
            |part: &Part| part.model.scatter().broad(part.turned(to_previous), part.turned(to_next)) * part.weight;
        self.parts().iter().map(broad).fold(Spectrum::ZERO, |sum, value| sum + value)
    }

    /// What the broad part depends on; none where there are holes, or a sum of products that is none.
    pub fn breadth(&self) -> Breadth {
        if self.lobes.meets(Lobes::HOLES) {
            return Breadth::None;
        }
        let breadths = || self.parts().iter().map(|part| part.model.scatter().breadth());
        let number = |breadth| breadths().filter(|&other| other == breadth).count();
        match (number(Breadth::Even), number(Breadth::Coated)) {
            (0, 1) => Breadth::Coated,
            (1.., 0) => Breadth::Even,
            _ => Breadth::None,
        }
    }

    /// Of the broad part the factor that depends on `to_previous`.
    pub fn outward(&self, to_previous: Vec3) -> f32 {
        let coated = self.parts().iter().find(|part| part.model.scatter().breadth() == Breadth::Coated);
        coated.map_or(1.0, |part| part.model.scatter().outward(part.turned(to_previous)))
    }

    /// The share of the light towards or from `to_previous` that is not absorbed, by all events together: the
    /// directional-hemispherical reflectance, with transmittance, as far as [`Scatter::shares`] knows it.
    pub fn albedo(&self, to_previous: Vec3) -> Spectrum {
        let shares =
            |part: &Part| part.model.scatter().shares(part.turned(to_previous)).map(|share| share * part.weight);
        self.parts().iter().flat_map(shares).fold(Spectrum::ZERO, |sum, share| sum + share)
    }

    /// The density per solid angle with which [`Bsdf::sample`], allowed to `follow` these lobes, draws `to_next`
    /// through a smooth event.
    pub fn pdf(&self, to_previous: Vec3, to_next: Vec3, follow: Lobes) -> f32 {
        if let Some((part, event)) = self.only(follow) {
            return if Lobes::SMOOTH.contains(event) { part.pdf(event, to_previous, to_next) } else { 0.0 };
        }
        let weights = self.weights(to_previous, follow);
        let total: f32 = weights[..usize::from(self.count)].as_flattened().iter().sum();
        if total <= 0.0 {
            return 0.0;
        }
        self.smooth_pdf(&weights, |part, event| part.pdf(event, to_previous, to_next)) / total
    }

    /// One event out of those that may be followed, with a direction; none if nothing can be followed. What absorbs
    /// light is the roulette of the walk, not this choice.
    pub fn sample(&self, to_previous: Vec3, follow: Lobes, sampler: &mut Sampler) -> Option<Scattered> {
        if !self.separates {
            return self.draw::<false>(to_previous, follow, sampler);
        }
        let mut scattered = self.draw::<true>(to_previous, follow, sampler)?;
        if Lobes::SMOOTH.contains(scattered.event) {
            scattered.pdf = self.pdf(to_previous, scattered.to_next, follow);
        }
        Some(scattered)
    }

    /// [`Bsdf::sample`], with the density with which the direction was drawn indeed.
    #[inline]
    fn draw<const SEPARATES: bool>(
        &self,
        to_previous: Vec3,
        follow: Lobes,
        sampler: &mut Sampler,
    ) -> Option<Scattered> {
        if let Some((part, event)) = self.only(follow) {
            let rest = sampler.uniform();
            let u = numbers(rest, sampler);
            return part.follow((event.index(), 1.0), to_previous, u, |to_next| {
                (part.drawn_pdf::<SEPARATES>(event, to_previous, to_next), part.eval(to_previous, to_next))
            });
        }
        let weights = self.weights(to_previous, follow);
        let used = weights[..usize::from(self.count)].as_flattened();
        let (slot, probability, total, rest) = choose_event(used, sampler.uniform())?;
        self.parts[slot / EVENTS].follow((slot, probability), to_previous, numbers(rest, sampler), |to_next| {
            let pdf = self.smooth_pdf(&weights, |part, event| part.drawn_pdf::<SEPARATES>(event, to_previous, to_next));
            (pdf / total, self.eval(to_previous, to_next))
        })
    }

    /// Whether there is more than one event in all.
    #[inline]
    pub fn has_choice(&self) -> bool {
        self.only(Lobes::ALL).is_none()
    }

    /// Whether it is glass and nothing else, which lets all wavelengths through in one direction.
    pub fn is_clear(&self) -> bool {
        let [part] = self.parts() else { return false };
        let is_glass = self.lobes.contains(Event::Refraction) && !self.lobes.meets(Lobes::SMOOTH.with(Event::Pass));
        is_glass && self.has_choice() && !part.model.separates(Event::Refraction)
    }

    /// Where each delta event leads that has one direction for all wavelengths, with the weight of a path that always goes
    /// there. Holes are no such event.
    pub fn deltas(&self, to_previous: Vec3) -> impl Iterator<Item = Scattered> {
        self.parts().iter().enumerate().flat_map(move |(number, part)| {
            [Event::Specular, Event::Refraction].into_iter().filter_map(move |event| {
                let slot = EVENTS * number + event.index();
                let has_one = part.model.lobes().contains(event) && !part.model.separates(event);
                let scattered = || part.follow((slot, 1.0), to_previous, Vec3::ZERO, |_| (0.0, Spectrum::ZERO));
                has_one.then(scattered).flatten().filter(|scattered| !scattered.weight.is_zero())
            })
        })
    }

    /// The part whose glossy event is one of several, if there is no other such part.
    fn gloss(&self) -> Option<&Part<'a>> {
        if !self.lobes.contains(Event::Glossy) || self.separates || !self.has_choice() {
            return None;
        }
        let mut parts = self.parts().iter().filter(|part| part.model.lobes().contains(Event::Glossy));
        let part = parts.next()?;
        parts.next().is_none().then_some(part)
    }

    /// A direction of the glossy event that is one of several, from three numbers uniform in 0..1; none where there is no
    /// such event.
    pub fn sample_gloss(&self, to_previous: Vec3, u: Vec3) -> Option<Vec3> {
        let part = self.gloss()?;
        let (to_next, _) = part.model.scatter().sample(Event::Glossy, part.turned(to_previous), u)?;
        Some(part.turned(to_next))
    }

    /// The density per solid angle with which [`Bsdf::sample_gloss`] draws `to_next`.
    pub fn gloss_pdf(&self, to_previous: Vec3, to_next: Vec3) -> f32 {
        self.gloss().map_or(0.0, |part| part.pdf(Event::Glossy, to_previous, to_next))
    }

    /// The event that happens where there is nothing to choose, by far the most frequent case.
    #[inline]
    fn only(&self, follow: Lobes) -> Option<(&Part<'a>, Event)> {
        let [part] = self.parts() else { return None };
        Some((part, self.lobes.and(follow).only()?))
    }

    /// The weight of every event of every part in the choice of one.
    #[inline]
    fn weights(&self, to_previous: Vec3, follow: Lobes) -> [[f32; EVENTS]; MAX_PARTS] {
        let mut weights = [[0.0; EVENTS]; MAX_PARTS];
        for (part, weights) in self.parts().iter().zip(&mut weights) {
            let shares = part.model.scatter().shares(part.turned(to_previous));
            for event in Event::ALL {
                if follow.contains(event) {
                    weights[event.index()] = part.weight * shares[event.index()].max();
                }
            }
        }
        weights
    }

    /// The densities of all smooth events, times their unnormalised weights.
    fn smooth_pdf(&self, weights: &[[f32; EVENTS]; MAX_PARTS], of: impl Fn(&Part, Event) -> f32) -> f32 {
        let mut pdf = 0.0;
        for (part, weights) in self.parts().iter().zip(weights) {
            for event in [Event::Diffuse, Event::Glossy] {
                let weight = weights[event.index()];
                if weight > 0.0 {
                    pdf += weight * of(part, event);
                }
            }
        }
        pdf
    }
}

impl Part<'_> {
    #[inline]
    fn eval(&self, to_previous: Vec3, to_next: Vec3) -> Spectrum {
        let (to_previous, to_next) = (self.turned(to_previous), self.turned(to_next));
        let value = match &self.model {
            // Most surfaces are: worth no detour.
            Model::Diffuse(diffuse) => diffuse.eval(to_previous, to_next),
            model => model.scatter().eval(to_previous, to_next),
        };
        value * self.weight
    }

    #[inline]
    fn pdf(&self, event: Event, to_previous: Vec3, to_next: Vec3) -> f32 {
        let (to_previous, to_next) = (self.turned(to_previous), self.turned(to_next));
        match &self.model {
            Model::Diffuse(diffuse) => diffuse.pdf(event, to_previous, to_next),
            model => model.scatter().pdf(event, to_previous, to_next),
        }
    }

    /// The density with which this very path draws the direction.
    #[inline]
    fn drawn_pdf<const SEPARATES: bool>(&self, event: Event, to_previous: Vec3, to_next: Vec3) -> f32 {
        match &self.model {
            Model::RoughGlass(glass) if SEPARATES => {
                glass.drawn_pdf(event, self.turned(to_previous), self.turned(to_next))
            }
            _ => self.pdf(event, to_previous, to_next),
        }
    }

    #[inline]
    fn turned(&self, direction: Vec3) -> Vec3 {
        if self.flipped { Vec3::new(direction.x, direction.y, -direction.z) } else { direction }
    }

    /// A direction for the event of a slot that was chosen with this probability; `smooth` gives the density and the value of
    /// all that could have led there.
    #[inline]
    fn follow(
        &self,
        (slot, probability): (usize, f32),
        to_previous: Vec3,
        u: Vec3,
        smooth: impl FnOnce(Vec3) -> (f32, Spectrum),
    ) -> Option<Scattered> {
        let (event, local) = (Event::ALL[slot % EVENTS], self.turned(to_previous));
        let slot = slot as u8;
        let (to_next, ior_ratio) = self.model.scatter().sample(event, local, u)?;
        let to_next = self.turned(to_next);
        if Lobes::DELTA.contains(event) {
            let mut weight = self.model.scatter().shares(local)[event.index()] * (self.weight / probability);
            let mut slowness = ior_ratio;
            if let Model::Glass(glass) = &self.model
                && event == Event::Refraction
            {
                let mut below = glass.slowness;
                if let Some((fan, lane)) = glass.followed(event, u) {
                    weight = fan.followed(weight, lane);
                    below = fan.slowness[lane];
                }
                slowness = if local.z > 0.0 { below } else { 1.0 / below };
            }
            let ior_ratio = Spectrum::grey(ior_ratio);
            return Some(Scattered { to_next, weight, pdf: probability, event, ior_ratio, slowness, slot });
        }
        let (pdf, value) = smooth(to_next);
        let (ior_ratio, slowness) = match &self.model {
            Model::RoughGlass(glass) if ior_ratio != 1.0 => glass.ior_ratios(local, ior_ratio),
            _ => (Spectrum::grey(ior_ratio), ior_ratio),
        };
        let weight = value * (to_next.z.abs() / pdf);
        (pdf > 0.0).then_some(Scattered { to_next, weight, pdf, event, ior_ratio, slowness, slot })
    }
}

/// The numbers that choose a direction, of which what is left of the choice of the event is one.
#[inline]
fn numbers(rest: f32, sampler: &mut Sampler) -> Vec3 {
    sampler.square().extend(rest)
}

/// The one choice of an event, for both walks: a slot with a probability proportional to its weight, that
/// probability, the sum of the weights, and `u` stretched to 0..1 for use in what was chosen. None if all are zero.
#[inline]
pub fn choose_event(weights: &[f32], u: f32) -> Option<(usize, f32, f32, f32)> {
    let total: f32 = weights.iter().sum();
    let mut left = u * total;
    let mut chosen = None;
    for (slot, &weight) in weights.iter().enumerate() {
        if weight > 0.0 {
            chosen = Some((slot, left / weight));
            if left < weight {
                break;
            }
            left -= weight;
        }
    }
    let (slot, rest) = chosen?;
    Some((slot, weights[slot] / total, total, rest.clamp(0.0, ONE_MINUS_EPSILON)))
}
