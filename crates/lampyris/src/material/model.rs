//! What models of scattering do, and the closed set of them.

use glam::Vec3;

use super::{
    Coefficients, Conductor, Diffuse, DiffuseTransmission, Event, Glass, Hole, Lobes, Mirror, Phong, Plastic,
    Principled, PrincipledThin, RoughConductor, RoughDiffuse, RoughGlass, RoughPlastic, ThinGlass, Ward,
};
use crate::spectrum::Spectrum;

/// What the broad part of a scattering function depends on, on either side of a surface, besides where light comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Breadth {
    /// There is no such part.
    None,
    /// On nothing: it is the same for all directions to which light leaves.
    Even,
    /// On how a coat lets light out.
    Coated,
}

/// How much of the light takes part in each event, by [`Event::index`]. For delta events this is the weight of the
/// path; for smooth ones a good estimate of it, which steers the choice alone.
pub type Shares = [Spectrum; EVENTS];

pub(super) const EVENTS: usize = Event::ALL.len();

/// A model of scattering. Directions are local (normal +z), of unit length, and point away from the surface; models
/// are symmetric in their two directions but for the solid angle that refraction changes, which the walk corrects. What
/// is said of smooth lobes holds as it stands for a model that has none.
pub trait Scatter {
    /// The share of each event in the light that continues towards, or comes from, `to_previous`.
    fn shares(&self, to_previous: Vec3) -> Shares;

    /// The value of the smooth lobes in 1/sr, without a cosine, for flux that comes from `to_previous`. Radiance that
    /// comes from `to_next` has the same value with the two exchanged: what is sent through a boundary differs by the
    /// square of the ratio of the indices.
    fn eval(&self, _to_previous: Vec3, _to_next: Vec3) -> Spectrum {
        Spectrum::ZERO
    }

    /// The value of [`Scatter::eval`] where it is the same for all directions on the side of `to_previous`, and zero on
    /// the other: density estimation need not ask for every photon then.
    fn even(&self, _to_previous: Vec3) -> Option<Spectrum> {
        Some(Spectrum::ZERO)
    }

    /// The part of [`Scatter::eval`] that is broad: the product of a function of either direction, without a highlight.
    fn broad(&self, _to_previous: Vec3, _to_next: Vec3) -> Spectrum {
        Spectrum::ZERO
    }

    /// What the broad part depends on in `to_previous`.
    fn breadth(&self) -> Breadth {
        Breadth::None
    }

    /// Of the broad part the factor that depends on `to_previous`, where it is [`Breadth::Coated`].
    fn outward(&self, _to_previous: Vec3) -> f32 {
        1.0
    }

    /// The density per solid angle with which [`Scatter::sample`] draws `to_next` for this smooth event.
    fn pdf(&self, _event: Event, _to_previous: Vec3, _to_next: Vec3) -> f32 {
        0.0
    }

    /// A direction for this event, from three numbers uniform in 0..1, with the index of refraction on its side over that
    /// of `to_previous`; none if the event leads nowhere.
    fn sample(&self, event: Event, to_previous: Vec3, u: Vec3) -> Option<(Vec3, f32)>;
}

/// The closed set of models, as plain data; tables stay where the material is.
#[derive(Clone, Copy, Debug)]
pub enum Model<'a> {
    /// Lambert's.
    Diffuse(Diffuse),
    /// A perfect mirror.
    Mirror(Mirror),
    /// A smooth dielectric boundary.
    Glass(Glass),
    /// A thin dielectric pane.
    ThinGlass(ThinGlass),
    /// A smooth metal.
    Conductor(Conductor),
    /// A diffuse base under a smooth dielectric coat.
    Plastic(Plastic),
    /// The course's coefficients.
    Coefficients(Coefficients),
    /// Nothing: light passes straight through.
    Hole(Hole),
    /// A rough metal.
    RoughConductor(RoughConductor<'a>),
    /// A rough dielectric boundary.
    RoughGlass(RoughGlass<'a>),
    /// A diffuse base under a rough dielectric coat.
    RoughPlastic(RoughPlastic<'a>),
    /// Diffuse grooves.
    RoughDiffuse(RoughDiffuse),
    /// Diffuse on both sides at once.
    DiffuseTransmission(DiffuseTransmission),
    /// Phong's.
    Phong(Phong),
    /// Ward's.
    Ward(Ward),
    /// Burley's.
    Principled(Principled),
    /// Burley's for sheets.
    PrincipledThin(PrincipledThin),
}

impl Model<'_> {
    /// The model as what it does.
    #[inline]
    pub fn scatter(&self) -> &dyn Scatter {
        match self {
            Model::Diffuse(model) => model,
            Model::Mirror(model) => model,
            Model::Glass(model) => model,
            Model::ThinGlass(model) => model,
            Model::Conductor(model) => model,
            Model::Plastic(model) => model,
            Model::Coefficients(model) => model,
            Model::Hole(model) => model,
            Model::RoughConductor(model) => model,
            Model::RoughGlass(model) => model,
            Model::RoughPlastic(model) => model,
            Model::RoughDiffuse(model) => model,
            Model::DiffuseTransmission(model) => model,
            Model::Phong(model) => model,
            Model::Ward(model) => model,
            Model::Principled(model) => model,
            Model::PrincipledThin(model) => model,
        }
    }

    /// The events that can happen at all.
    #[inline]
    pub fn lobes(&self) -> Lobes {
        match self {
            Model::Diffuse(_) => Event::Diffuse.into(),
            Model::Mirror(_) | Model::Conductor(_) => Event::Specular.into(),
            Model::Glass(_) | Model::ThinGlass(_) => Lobes::from(Event::Specular) | Event::Refraction.into(),
            Model::Plastic(_) => Lobes::from(Event::Diffuse) | Event::Specular.into(),
            Model::Coefficients(model) => model.lobes(),
            Model::Hole(_) => Event::Pass.into(),
            Model::RoughDiffuse(_) | Model::DiffuseTransmission(_) => Event::Diffuse.into(),
            Model::Principled(_) | Model::PrincipledThin(_) => Event::Glossy.into(),
            Model::RoughConductor(RoughConductor { white: None, .. }) => Event::Glossy.into(),
            Model::RoughGlass(RoughGlass { once: None, .. }) => Event::Glossy.into(),
            Model::RoughConductor(_) | Model::RoughGlass(_) => Lobes::SMOOTH,
            Model::RoughPlastic(_) | Model::Phong(_) | Model::Ward(_) => Lobes::SMOOTH,
        }
    }

    /// How much slower light is on the other side of the boundary that smooth lobes lead through, than on the side of
    /// `to_previous`.
    pub(super) fn slowness(&self, to_previous: Vec3) -> f32 {
        let ior = match self {
            Model::RoughGlass(model) => model.slowness,
            Model::Principled(model) if model.transmits => model.eta,
            _ => 1.0,
        };
        if to_previous.z > 0.0 { ior } else { 1.0 / ior }
    }

    /// Whether a delta event has a direction of its own for each wavelength.
    pub(super) fn separates(&self, event: Event) -> bool {
        matches!(self, Model::Glass(glass) if glass.followed(event, Vec3::ZERO).is_some())
    }

    /// Whether smooth lobes lead through the surface.
    #[inline]
    pub fn transmits(&self) -> bool {
        match self {
            Model::RoughGlass(_) | Model::DiffuseTransmission(_) | Model::PrincipledThin(_) => true,
            Model::Principled(model) => model.transmits,
            _ => false,
        }
    }
}
