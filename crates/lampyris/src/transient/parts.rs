//! Light by time in parts: by what it met on its way, and by how often it was scattered.

use std::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What light met on its way from a lamp to the camera. Any light is of one of these kinds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum LightKind {
    /// Nothing: lamps and surroundings seen by the camera itself.
    Emission,
    /// One scattering event, on a surface.
    Direct,
    /// Mirrors and glass on its way from a lamp to a smooth surface, which the camera sees itself or by mirrors and glass.
    Caustic,
    /// Several events on surfaces otherwise.
    Indirect,
    /// Particles of a medium, whatever else.
    Volume,
}

impl LightKind {
    /// All of them.
    pub const ALL: [LightKind; 5] =
        [LightKind::Emission, LightKind::Direct, LightKind::Caustic, LightKind::Indirect, LightKind::Volume];

    /// Its name in files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            LightKind::Emission => "emission",
            LightKind::Direct => "direct",
            LightKind::Caustic => "caustic",
            LightKind::Indirect => "indirect",
            LightKind::Volume => "volume",
        }
    }
}

/// What light met on its way from a lamp to the camera, as layers need to know it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Met {
    /// Scattering events; or at least two, where no more is known.
    pub events: u32,
    /// Whether mirrors and glass alone brought it to a smooth surface or a particle, seen by the camera itself or by mirrors
    /// and glass.
    pub is_caustic: bool,
    /// Whether particles of a medium were among them.
    pub particles: bool,
}

impl Met {
    /// So many events on surfaces.
    pub fn surfaces(events: u32) -> Met {
        Met { events, is_caustic: false, particles: false }
    }

    /// The kind of light.
    pub fn kind(self) -> LightKind {
        match self {
            Met { particles: true, .. } => LightKind::Volume,
            Met { is_caustic: true, .. } => LightKind::Caustic,
            Met { events: 0, .. } => LightKind::Emission,
            Met { events: 1, .. } => LightKind::Direct,
            _ => LightKind::Indirect,
        }
    }
}

/// A part of the light by time that is kept beside all of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimeLayer {
    /// Of one kind.
    Kind(LightKind),
    /// Scattered so often.
    Bounces(u32),
    /// Scattered more often than any other layer has it.
    MoreBounces,
}

/// Its name in files and on the command line: `caustic`, `bounces-2`, `more-bounces`.
impl fmt::Display for TimeLayer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            TimeLayer::Kind(kind) => f.write_str(kind.name()),
            TimeLayer::Bounces(bounces) => write!(f, "bounces-{bounces}"),
            TimeLayer::MoreBounces => f.write_str("more-bounces"),
        }
    }
}

/// Which parts are kept.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TimeLayers {
    /// In the order of [`LightKind::ALL`], each once.
    kinds: Vec<LightKind>,
    /// A layer for each number of scattering events up to this, and one for more; none for none of these.
    bounces: Option<u32>,
}

impl TimeLayers {
    /// These kinds of light, in any order; and if `bounces` is given, one for each number of scattering events from 0 to
    /// that, and one for more.
    pub fn new(kinds: &[LightKind], bounces: Option<u32>) -> TimeLayers {
        let kinds = LightKind::ALL.into_iter().filter(|kind| kinds.contains(kind)).collect();
        TimeLayers { kinds, bounces }
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.kinds.len() + self.bounces.map_or(0, |bounces| bounces as usize + 2)
    }

    /// Each of them.
    pub fn iter(&self) -> impl Iterator<Item = TimeLayer> {
        let of_bounces = |most: u32| (0..=most).map(TimeLayer::Bounces).chain([TimeLayer::MoreBounces]);
        self.kinds.iter().copied().map(TimeLayer::Kind).chain(self.bounces.into_iter().flat_map(of_bounces))
    }

    /// The numbers of those that light belongs to, in the order of [`TimeLayers::iter`].
    #[inline]
    pub fn of(&self, met: Met) -> impl Iterator<Item = usize> {
        let kind = met.kind();
        let by_kind = self.kinds.iter().position(|&own| own == kind);
        let by_bounces = self.bounces.map(|most| self.kinds.len() + met.events.min(most.saturating_add(1)) as usize);
        by_kind.into_iter().chain(by_bounces)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_belongs_to_one_layer_of_kinds_and_to_one_of_bounces() {
        let layers = TimeLayers::new(&[LightKind::Volume, LightKind::Direct, LightKind::Volume], Some(1));
        let names: Vec<String> = layers.iter().map(|layer| layer.to_string()).collect();
        assert_eq!(names, ["direct", "volume", "bounces-0", "bounces-1", "more-bounces"]);
        assert_eq!(layers.count(), names.len());
        let of = |met| layers.of(met).map(|layer| names[layer].as_str()).collect::<Vec<_>>();
        let in_fog = |events| Met { particles: true, ..Met::surfaces(events) };
        assert_eq!(of(Met::surfaces(0)), ["bounces-0"]);
        assert_eq!(of(Met::surfaces(1)), ["direct", "bounces-1"]);
        assert_eq!(of(in_fog(1)), ["volume", "bounces-1"]);
        assert_eq!(of(in_fog(u32::MAX)), ["volume", "more-bounces"]);
        assert_eq!(of(Met { is_caustic: true, ..Met::surfaces(2) }), ["more-bounces"]);
        assert_eq!(TimeLayers::new(&[], None).of(Met::surfaces(1)).count(), 0);
    }
}
