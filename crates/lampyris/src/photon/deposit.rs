//! The visitor that leaves photons.

use super::Photon;
use crate::material::Lobes;
use crate::sampler::Sampler;
use crate::scene::SurfacePoint;
use crate::transport::{PathState, Visitor};

/// Leaves a photon wherever a walk from a lamp meets a smooth lobe; follows all lobes.
#[derive(Debug)]
pub struct Deposit {
    /// The photons so far.
    pub photons: Vec<Photon>,
    /// Whether light that comes straight from a lamp is stored, too.
    pub direct: bool,
    /// The longest light path from lamp to eye, in scattering events.
    pub max_bounces: u32,
}

impl Visitor for Deposit {
    fn vertex(&mut self, point: &SurfacePoint, path: &PathState, _: &mut Sampler) -> Lobes {
        // The event in which the photon is read is one more. Where there is none left, the walk cuts the path.
        let wanted = self.direct || path.bounce > 0 || path.hidden_lamp;
        let readable = path.bounce < self.max_bounces && wanted;
        if readable && point.bsdf.lobes().meets(Lobes::SMOOTH) {
            let normal = point.surface.normal;
            self.photons.push(Photon {
                position: point.surface.position,
                direction: path.ray.direction,
                normal: if normal.dot(point.to_previous) < 0.0 { -normal } else { normal },
                optical_length: path.optical_length as f32,
                flux: path.throughput,
                bounce: path.bounce,
                history: path.history,
            });
        }
        Lobes::ALL
    }
}
