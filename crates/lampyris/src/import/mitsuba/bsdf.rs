//! BSDFs: each to the nearest material we have.
//!
//! Mitsuba's opaque BSDFs are black from behind unless wrapped in `twosided`; ours have two sides. A
//! [`Scattering`] therefore knows whether it is one-sided, and gets a black back where it is finished.

mod principled;
mod surfaces;
mod wrappers;

use super::Importer;
use super::document::Kind;
use super::spectrum::Role;
use crate::error::Result;
use crate::scene::description::{MaterialDescription, MaterialRef, Paint};

/// A material before it is decided what its back is like.
struct Scattering {
    material: MaterialDescription,
    /// Whether nothing is reflected from behind.
    one_sided: bool,
}

impl Scattering {
    fn one_sided(material: MaterialDescription) -> Scattering {
        Scattering { material, one_sided: true }
    }

    fn complete(material: MaterialDescription) -> Scattering {
        Scattering { material, one_sided: false }
    }

    /// The same, seen through what `wrap` makes of it.
    fn wrapped(self, wrap: impl FnOnce(MaterialRef) -> MaterialDescription) -> Scattering {
        Scattering { material: wrap(inline(self.material)), one_sided: self.one_sided }
    }

    fn finished(self) -> MaterialDescription {
        match self.one_sided {
            true => MaterialDescription::TwoSided { front: inline(self.material), back: Some(inline(black())) },
            false => self.material,
        }
    }
}

fn inline(material: MaterialDescription) -> MaterialRef {
    MaterialRef::Inline(Box::new(material))
}

fn black() -> MaterialDescription {
    MaterialDescription::Diffuse { reflectance: Paint::grey(0.0) }
}

/// What Mitsuba gives a shape without a BSDF that does not emit.
pub(super) fn default_material() -> MaterialRef {
    inline(Scattering::one_sided(MaterialDescription::Diffuse { reflectance: Paint::grey(0.5) }).finished())
}

impl Importer<'_> {
    /// A BSDF of the scene itself, which stays in the description under its id; one without an id is of no use.
    pub(super) fn named_bsdf(&mut self, object: usize) -> Result<()> {
        match self.document.objects[object].id {
            Some(_) => self.material(object).map(|_| ()),
            None => Ok(()),
        }
    }

    /// The material of a shape: by name where the BSDF has an id, so that it stands in the description once.
    pub(super) fn material(&mut self, object: usize) -> Result<MaterialRef> {
        if let Some(name) = self.materials.get(&object) {
            return Ok(MaterialRef::Named(name.clone()));
        }
        let material = self.bsdf(object, 0)?.finished();
        let Some(id) = &self.document.objects[object].id else { return Ok(inline(material)) };
        self.note(format!("materials.{id}"), self.document.objects[object].spot);
        self.materials.insert(object, id.clone());
        self.description().materials.insert(id.clone(), material);
        Ok(MaterialRef::Named(id.clone()))
    }

    fn bsdf(&mut self, object: usize, depth: usize) -> Result<Scattering> {
        let query = self.query(object);
        self.visit(query, depth)?;
        let scattering = match query.object.plugin.as_str() {
            "diffuse" => Scattering::one_sided(self.diffuse(query, "reflectance")?),
            "roughdiffuse" => Scattering::one_sided(self.rough_diffuse(query)?),
            "dielectric" => Scattering::complete(self.dielectric(query, false)?),
            "glass" => {
                self.left_out(object, "it is taken for a 'dielectric'");
                Scattering::complete(self.dielectric(query, false)?)
            }
            "roughdielectric" => Scattering::complete(self.dielectric(query, true)?),
            "thindielectric" => Scattering::complete(self.thin_dielectric(query)?),
            "conductor" => Scattering::one_sided(self.conductor(query, false)?),
            "roughconductor" => Scattering::one_sided(self.conductor(query, true)?),
            "plastic" => Scattering::one_sided(self.plastic(query, false)?),
            "roughplastic" => Scattering::one_sided(self.plastic(query, true)?),
            "pplastic" => {
                self.left_out(object, "'roughplastic' without polarisation is used");
                Scattering::one_sided(self.plastic(query, true)?)
            }
            "phong" => Scattering::one_sided(self.phong(query)?),
            "ward" => Scattering::one_sided(self.ward(query)?),
            "difftrans" => Scattering::complete(self.diffuse_transmission(query)?),
            "hk" => Scattering::complete(self.hanrahan_krueger(query)?),
            "principled" => self.principled(query)?,
            "principledthin" => Scattering::complete(self.principled_thin(query)?),
            "null" => Scattering::complete(pane(Paint::grey(0.0))),
            "polarizer" | "circular" | "retarder" => Scattering::complete(self.polariser(query)?),
            "twosided" => self.two_sided(query, depth)?,
            "mask" => self.mask(query, depth)?,
            "blendbsdf" => self.blend(query, depth)?,
            "mixturebsdf" => self.mixture(query, depth)?,
            "bumpmap" | "bump" => self.bump_map(query, depth)?,
            "normalmap" => self.normal_map(query, depth)?,
            "coating" => self.coating(query, depth, false)?,
            "roughcoating" => self.coating(query, depth, true)?,
            _ => return self.unknown(object, depth),
        };
        self.leftovers(query);
        Ok(scattering)
    }

    /// A BSDF we do not have: what it covers, or a diffuse surface of its colour.
    fn unknown(&mut self, object: usize, depth: usize) -> Result<Scattering> {
        let query = self.query(object);
        if let Some(inner) = query.part(Kind::Bsdf) {
            let plugin = self.document.objects[inner.object].plugin.as_str();
            self.left_out(object, &format!("the '{plugin}' in it is used alone"));
            return self.bsdf(inner.object, depth + 1);
        }
        let names = ["reflectance", "diffuse_reflectance", "base_color"];
        let reflectance = match names.iter().find(|name| query.has(name)) {
            Some(name) => {
                self.left_out(object, "a diffuse surface of its colour is used");
                self.paint(query, name, Role::Surface, 0.5)?
            }
            None => {
                self.left_out(object, "a diffuse surface of reflectance 0.5 is used");
                Paint::grey(0.5)
            }
        };
        Ok(Scattering::one_sided(MaterialDescription::Diffuse { reflectance }))
    }
}

/// What lets light pass straight through but for this share.
fn pane(opacity: Paint) -> MaterialDescription {
    MaterialDescription::Mask { opacity, material: inline(black()) }
}
