//! Renders kept in files: a film, the passes that it holds, and what it takes to go on with others.

mod file;
mod identity;
#[cfg(test)]
mod tests;

pub use identity::Identity;

pub(crate) use file::write;

use crate::error::{Error, Result};
use crate::film::{Film, Layers, PassSet};

/// A film with all that it takes to go on, or to be merged with others of the same render.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint {
    identity: Identity,
    pilot: Vec<u8>,
    passes: PassSet,
    film: Film,
}

impl Checkpoint {
    /// Adds the passes of another checkpoint of the same render.
    ///
    /// # Errors
    /// If it is of another one, or both have a pass. This one is as before then.
    pub fn merge(&mut self, other: &Checkpoint) -> Result<()> {
        if let Some(difference) = self.identity.difference(&other.identity) {
            return Err(Error::new(format!("the films do not belong together: one is {difference}")));
        }
        if self.pilot != other.pilot {
            return Err(Error::new("the films do not belong together: their pilots measured different things"));
        }
        let mut passes = self.passes.clone();
        passes.add(&other.passes)?;
        self.film.merge(&other.film)?;
        self.passes = passes;
        Ok(())
    }

    /// What it is of.
    pub fn identity(&self) -> &Identity {
        &self.identity
    }

    /// The passes that it holds.
    pub fn passes(&self) -> &PassSet {
        &self.passes
    }

    /// The layers that it holds.
    pub fn layers(&self) -> Layers {
        self.film.layers()
    }

    /// The film.
    pub fn film(&self) -> &Film {
        &self.film
    }

    /// What the integrator measured before the first pass.
    pub fn pilot(&self) -> &[u8] {
        &self.pilot
    }

    pub(crate) fn into_film(self) -> (Film, PassSet) {
        (self.film, self.passes)
    }
}
