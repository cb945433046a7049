//! Materials that pbrt-v3 had and pbrt-v4 dropped.

use super::Importer;
use super::material::both_sides;
use super::statement::{Statement, Values};
use super::texture::{Sort, Varying};
use crate::error::Result;
use crate::scene::description::{MaterialDescription, MaterialRef, Paint, Principled};

/// The microfacets' α of pbrt-v3 for a roughness from 0 to 1: a polynomial in its logarithm.
pub(super) fn alpha(roughness: f64) -> f64 {
    let x = roughness.max(1e-3).ln();
    1.62142 + x * (0.819955 + x * (0.1734 + x * (0.0171201 + x * 0.000640711)))
}

impl Importer<'_> {
    /// The material `sort` of pbrt-v3; none if it had no such.
    pub(super) fn v3_material(&mut self, statement: &Statement, sort: &str) -> Result<Option<MaterialDescription>> {
        let known = [
            "disney",
            "fourier",
            "glass",
            "kdsubsurface",
            "matte",
            "metal",
            "mirror",
            "plastic",
            "substrate",
            "translucent",
            "uber",
        ];
        if !known.contains(&sort) {
            return Ok(None);
        }
        self.note_v3(statement.spot);
        statement.ignore(&["bumpmap"]);
        Ok(Some(match sort {
            "matte" => self.diffuse(statement, "Kd", 0.5)?,
            "mirror" => MaterialDescription::Mirror { reflectance: self.paint(statement, "Kr", 0.9)? },
            "glass" => MaterialDescription::Glass {
                ior: self.dispersion(statement, &["eta", "index"], 1.5)?,
                exterior_ior: 1.0.into(),
                reflectance: self.paint(statement, "Kr", 1.0)?,
                transmittance: self.paint(statement, "Kt", 1.0)?,
                roughness: self.roughness(statement, "", 0.0)?,
            },
            "metal" => {
                let mut metal = self.conductor(statement, ["eta", "k", "reflectance"], "", 1.0)?;
                if let MaterialDescription::Conductor { roughness, .. } = &mut metal {
                    *roughness = self.roughness(statement, "", 0.01)?;
                }
                metal
            }
            "plastic" => self.glossy(statement, [0.25, 0.25], 0.1)?,
            "substrate" => self.substrate(statement)?,
            "uber" => self.uber(statement)?,
            "translucent" => {
                let mut share = |colored: &'static str, part: &'static str, default: f64| -> Result<Paint> {
                    let colored =
                        self.varying(statement, colored, Sort::Color)?.unwrap_or(Varying::constant([default; 3]));
                    let part = self.varying(statement, part, Sort::Color)?.unwrap_or(Varying::constant([0.5; 3]));
                    let factor = [0, 1, 2].map(|channel| colored.factor[channel] * part.factor[channel]);
                    Ok(self.share(Varying { factor, ..colored }, statement.spot))
                };
                let material = MaterialDescription::DiffuseTransmission {
                    reflectance: share("Kd", "reflect", 0.25)?,
                    transmittance: share("Kd", "transmit", 0.25)?,
                };
                statement.ignore(&["Ks", "roughness", "remaproughness"]);
                material
            }
            "disney" => {
                let (base_color, metallic) =
                    (self.paint(statement, "color", 0.5)?, self.weight(statement, "metallic", 0.0)?);
                let (roughness, spec_trans) =
                    (self.weight(statement, "roughness", 0.5)?, self.weight(statement, "spectrans", 0.0)?);
                MaterialDescription::Principled(Box::new(Principled {
                    base_color,
                    metallic,
                    roughness,
                    spec_trans,
                    anisotropic: self.weight(statement, "anisotropic", 0.0)?,
                    spec_tint: self.weight(statement, "speculartint", 0.0)?,
                    sheen: self.weight(statement, "sheen", 0.0)?,
                    sheen_tint: self.weight(statement, "sheentint", 0.5)?,
                    clearcoat: self.weight(statement, "clearcoat", 0.0)?,
                    clearcoat_gloss: self.weight(statement, "clearcoatgloss", 1.0)?,
                    eta: Some(self.ior(statement, &["eta"], 1.5)?),
                    ..Principled::default()
                }))
            }
            _ => {
                let message = format!("material '{sort}' is not supported: a diffuse surface is used");
                self.warn(statement.spot, message);
                let material = self.diffuse(statement, "Kd", 0.5)?;
                statement.leftovers();
                material
            }
        }))
    }

    /// A diffuse base under a coat, as the nearest to a sum of diffuse and glossy.
    fn glossy(&mut self, statement: &Statement, [kd, ks]: [f64; 2], roughness: f64) -> Result<MaterialDescription> {
        Ok(both_sides(MaterialDescription::Plastic {
            reflectance: self.paint(statement, "Kd", kd)?,
            specular: self.paint(statement, "Ks", ks)?,
            ior: self.ior(statement, &["eta", "index"], 1.5)?,
            exterior_ior: 1.0,
            nonlinear: false,
            roughness: self.roughness(statement, "", roughness)?,
        }))
    }

    /// A diffuse base under a coat that reflects `Ks` of what meets it at right angles.
    fn substrate(&mut self, statement: &Statement) -> Result<MaterialDescription> {
        let specular = self.varying(statement, "Ks", Sort::Color)?.unwrap_or(Varying::constant([0.5; 3]));
        let root = (specular.factor.iter().sum::<f64>() / 3.0).clamp(0.0, 0.81).sqrt();
        Ok(both_sides(MaterialDescription::Plastic {
            reflectance: self.paint(statement, "Kd", 0.5)?,
            specular: Paint::grey(1.0),
            ior: ((1.0 + root) / (1.0 - root)) as f32,
            exterior_ior: 1.0,
            nonlinear: false,
            roughness: self.roughness(statement, "", 0.1)?,
        }))
    }

    /// Glass where it transmits, plastic where it shines, else diffuse; with holes.
    fn uber(&mut self, statement: &Statement) -> Result<MaterialDescription> {
        let is_black = |name: &str, default: bool| match statement.parameters.iter().find(|p| p.name == name) {
            Some(parameter) => matches!(&parameter.values, Values::Numbers(values) if values.iter().all(|&v| v == 0.0)),
            None => default,
        };
        let material = if !is_black("Kt", true) {
            MaterialDescription::Glass {
                ior: self.dispersion(statement, &["eta", "index"], 1.5)?,
                exterior_ior: 1.0.into(),
                reflectance: self.paint(statement, "Kr", 1.0)?,
                transmittance: self.paint(statement, "Kt", 0.0)?,
                roughness: None,
            }
        } else if !is_black("Ks", false) || !is_black("Kr", true) {
            self.glossy(statement, [0.25, 0.25], 0.1)?
        } else {
            MaterialDescription::Diffuse { reflectance: self.paint(statement, "Kd", 0.25)? }
        };
        let opacity = self.paint(statement, "opacity", 1.0)?;
        statement.ignore(&["Kd", "Ks", "Kr", "Kt", "eta", "index", "roughness", "uroughness", "vroughness"]);
        statement.ignore(&["remaproughness"]);
        if opacity == Paint::grey(1.0) {
            return Ok(material);
        }
        Ok(MaterialDescription::Mask { opacity, material: MaterialRef::Inline(Box::new(material)) })
    }
}
