//! Materials of pbrt-v4: each to the nearest that we have.
//!
//! pbrt's materials reflect on both sides; those of ours that have a front only are wrapped in `TwoSided`.

use std::rc::Rc;

use super::super::source::Spot;
use super::super::spectrum::Role;
use super::Importer;
use super::statement::Statement;
use super::texture::{Sort, Varying};
use crate::error::{Result, did_you_mean};
use crate::scene::description::{Color, MaterialDescription, MaterialRef, MicrofacetDistribution, Paint, Roughness};

/// Roughness at and below which pbrt, too, takes a surface for smooth.
const SMOOTH: f64 = 0.001_001;

/// All materials, to propose them for wrong names.
const SORTS: [&str; 11] = [
    "coatedconductor",
    "coateddiffuse",
    "conductor",
    "dielectric",
    "diffuse",
    "diffusetransmission",
    "hair",
    "interface",
    "measured",
    "mix",
    "thindielectric",
];

/// The material of the shapes that follow.
#[derive(Clone, Debug)]
pub(super) enum Use {
    /// Diffuse 0.5.
    Default,
    /// By name, at this place.
    Named(String, Spot),
    /// One without a name, by number.
    Own(usize),
}

/// A material that a shape asked for.
pub(super) enum Resolved {
    Material(MaterialRef),
    /// No surface at all, only a boundary between media.
    Interface,
}

/// The single precision of a description.
pub(super) fn color(rgb: [f64; 3]) -> Color {
    Color(rgb.map(|channel| channel as f32))
}

pub(super) fn inline(material: MaterialDescription) -> MaterialRef {
    MaterialRef::Inline(Box::new(material))
}

/// The material on both sides.
pub(super) fn both_sides(material: MaterialDescription) -> MaterialDescription {
    MaterialDescription::TwoSided { front: inline(material), back: None }
}

/// What lets all light pass.
fn nothing() -> MaterialDescription {
    let material = inline(MaterialDescription::Diffuse { reflectance: Paint::grey(0.0) });
    MaterialDescription::Mask { opacity: Paint::grey(0.0), material }
}

/// A material's sort: the string after `Material`, or the parameter `type` of `MakeNamedMaterial`.
fn sort_of(statement: &Statement) -> &str {
    match statement.keyword {
        "MakeNamedMaterial" => statement.text("type").ok().flatten().unwrap_or(""),
        _ => statement.sort(),
    }
}

fn is_interface(statement: &Statement) -> bool {
    matches!(sort_of(statement), "interface" | "" | "none")
}

impl Importer<'_> {
    pub(super) fn material(&mut self, statement: Statement) {
        self.own_materials.push(Rc::new(statement));
        self.state.material = Use::Own(self.own_materials.len() - 1);
    }

    pub(super) fn make_named_material(&mut self, statement: Statement) -> Result<()> {
        let name = statement.sort().to_string();
        if statement.parameter("type").is_none() {
            return Err(self.reader.fault(statement.spot, format!("the material '{name}' needs a 'type'")));
        }
        if self.named_materials.contains_key(&name) {
            let message = format!("the material '{name}' is made a second time: the first stays");
            self.warn(statement.spot, message);
            return Ok(());
        }
        self.named_materials.insert(name, Rc::new(statement));
        Ok(())
    }

    /// Describes all named materials, now that all are known.
    pub(super) fn finish_materials(&mut self) -> Result<()> {
        for (name, statement) in self.named_materials.clone() {
            let material = self.described_material(&statement)?;
            self.note(format!("materials.{name}"), statement.spot);
            self.description().materials.insert(name, material);
        }
        Ok(())
    }

    pub(super) fn resolve(&mut self, material: &Use) -> Result<Resolved> {
        match material {
            Use::Default => {
                Ok(Resolved::Material(inline(MaterialDescription::Diffuse { reflectance: Paint::grey(0.5) })))
            }
            Use::Named(name, spot) => match self.named_materials.get(name) {
                Some(statement) if is_interface(statement) => Ok(Resolved::Interface),
                Some(_) => Ok(Resolved::Material(MaterialRef::Named(name.clone()))),
                None => Err(self.no_material(name, *spot)),
            },
            Use::Own(number) => {
                let Some(statement) = self.own_materials.get(*number).cloned() else { return Ok(Resolved::Interface) };
                if is_interface(&statement) {
                    return Ok(Resolved::Interface);
                }
                let name = self.own_name(*number);
                if !self.imported.description.materials.contains_key(&name) {
                    let material = self.described_material(&statement)?;
                    self.note(format!("materials.{name}"), statement.spot);
                    self.description().materials.insert(name.clone(), material);
                }
                Ok(Resolved::Material(MaterialRef::Named(name)))
            }
        }
    }

    /// A name for the material of this number, which no named one has.
    fn own_name(&self, number: usize) -> String {
        let mut name = format!("material {}", number + 1);
        while self.named_materials.contains_key(&name) {
            name.push('\'');
        }
        name
    }

    fn no_material(&self, name: &str, spot: Spot) -> crate::error::Error {
        let error = self.reader.fault(spot, format!("there is no material named '{name}'"));
        match did_you_mean(name, self.named_materials.keys().map(String::as_str)) {
            Some(near) => error.with_hint(format!("did you mean '{near}'?")),
            None => error,
        }
    }

    fn described_material(&mut self, statement: &Statement) -> Result<MaterialDescription> {
        let sort = sort_of(statement).to_string();
        let material = match sort.as_str() {
            "diffuse" => self.diffuse(statement, "reflectance", 0.5)?,
            "coateddiffuse" => self.coated_diffuse(statement)?,
            "conductor" => self.conductor(statement, ["eta", "k", "reflectance"], "", 1.0)?,
            "coatedconductor" => self.coated_conductor(statement)?,
            "dielectric" => MaterialDescription::Glass {
                ior: self.dispersion(statement, &["eta"], 1.5)?,
                exterior_ior: 1.0.into(),
                reflectance: Paint::grey(1.0),
                transmittance: Paint::grey(1.0),
                roughness: self.roughness(statement, "", 0.0)?,
            },
            "thindielectric" => MaterialDescription::ThinGlass {
                ior: self.ior(statement, &["eta"], 1.5)?,
                exterior_ior: 1.0,
                reflectance: Paint::grey(1.0),
                transmittance: Paint::grey(1.0),
            },
            "diffusetransmission" => self.diffuse_transmission(statement)?,
            "mix" => self.mix(statement)?,
            "interface" | "" | "none" => nothing(),
            "hair" | "measured" | "subsurface" => self.approximated(statement, &sort)?,
            _ => match self.v3_material(statement, &sort)? {
                Some(material) => material,
                None => self.unknown_material(statement, &sort)?,
            },
        };
        let material = self.bumped(statement, material)?;
        statement.ignore(&["type"]);
        self.leftovers(statement);
        Ok(material)
    }

    pub(super) fn diffuse(
        &mut self,
        statement: &Statement,
        name: &'static str,
        default: f64,
    ) -> Result<MaterialDescription> {
        let reflectance = self.paint(statement, name, default)?;
        let sigma = self.varying(statement, "sigma", Sort::Number)?.unwrap_or(Varying::constant([0.0; 3]));
        if sigma.texture.is_some() {
            self.warn(statement.spot_of("sigma"), "a 'sigma' that varies is not supported: the surface is smooth");
        } else if sigma.factor[0] > 0.0 {
            // The standard deviation in degrees; ours is times √2, in radians.
            let alpha = sigma.factor[0].to_radians() * std::f64::consts::SQRT_2;
            return Ok(MaterialDescription::RoughDiffuse {
                reflectance,
                alpha: Paint::grey(alpha as f32),
                fast: false,
            });
        }
        Ok(MaterialDescription::Diffuse { reflectance })
    }

    /// Layers that pbrt walks through at random; ours are solved for a clear coat.
    fn coated_diffuse(&mut self, statement: &Statement) -> Result<MaterialDescription> {
        for name in ["albedo", "g"] {
            if statement.varied(name) {
                self.warn(statement.spot_of(name), "fog in a coat is not supported: the coat is clear");
            }
        }
        statement.ignore(&["thickness", "maxdepth", "nsamples", "twosided", "albedo", "g"]);
        Ok(both_sides(MaterialDescription::Plastic {
            reflectance: self.paint(statement, "reflectance", 0.5)?,
            specular: Paint::grey(1.0),
            ior: self.ior(statement, &["eta"], 1.5)?,
            exterior_ior: 1.0,
            nonlinear: true,
            roughness: self.roughness(statement, "", 0.0)?,
        }))
    }

    /// A metal by its index, or by its reflectance at normal incidence. `outside` is the index around it.
    pub(super) fn conductor(
        &mut self,
        statement: &Statement,
        [eta, k, reflectance]: [&'static str; 3],
        prefix: &str,
        outside: f64,
    ) -> Result<MaterialDescription> {
        let roughness = self.roughness(statement, prefix, 0.0)?;
        let metal = |eta: [f64; 3], k: [f64; 3], reflectance| MaterialDescription::Conductor {
            metal: None,
            eta: Some(color(eta)),
            k: Some(color(k)),
            reflectance,
            roughness: roughness.clone(),
        };
        if let Some(found) = self.varying(statement, reflectance, Sort::Color)? {
            if found.texture.is_some() {
                let spot = statement.spot_of(reflectance);
                self.warn(spot, "a metal whose reflectance varies does not brighten at grazing angles");
                let tint = self.share(found, spot);
                return Ok(metal([0.0; 3], [1.0; 3], tint));
            }
            // pbrt: an index of 1, and the absorption that gives this reflectance at normal incidence.
            let absorption = |share: f64| {
                let share = share.clamp(0.0, 0.9999);
                2.0 * (share / (1.0 - share)).sqrt()
            };
            return Ok(metal([1.0; 3], found.factor.map(absorption), Paint::grey(1.0)));
        }
        let (copper_eta, copper_k) = super::super::named::conductor("Cu").unwrap_or_default();
        for name in [eta, k] {
            if statement.parameter(name).is_some_and(|parameter| parameter.kind == "texture") {
                return Err(self
                    .reader
                    .fault(statement.spot_of(name), format!("'{name}' must be a spectrum or a colour")));
            }
        }
        let index = self.color(statement, eta, Role::Surface)?.unwrap_or(copper_eta.map(f64::from));
        let absorption = self.color(statement, k, Role::Surface)?.unwrap_or(copper_k.map(f64::from));
        let within = |values: [f64; 3]| values.map(|value| value / outside);
        Ok(metal(within(index), within(absorption), Paint::grey(1.0)))
    }

    fn coated_conductor(&mut self, statement: &Statement) -> Result<MaterialDescription> {
        self.warn(statement.spot, "the coat of a 'coatedconductor' is not supported: the metal under it is used alone");
        let outside = f64::from(self.ior(statement, &["interface.eta"], 1.5)?);
        statement.ignore(&["interface.roughness", "interface.uroughness", "interface.vroughness", "thickness"]);
        statement.ignore(&["maxdepth", "nsamples", "albedo", "g"]);
        let outside = if outside > 0.0 { outside } else { 1.0 };
        let names = match statement.has("reflectance") {
            true => ["conductor.eta", "conductor.k", "reflectance"],
            false => ["conductor.eta", "conductor.k", "conductor.reflectance"],
        };
        self.conductor(statement, names, "conductor.", outside)
    }

    fn diffuse_transmission(&mut self, statement: &Statement) -> Result<MaterialDescription> {
        let scale = self.placed(statement.number("scale", 1.0))?;
        statement.ignore(&["sigma", "remaproughness"]);
        let mut scaled = |name: &'static str| -> Result<Paint> {
            let found = self.varying(statement, name, Sort::Color)?.unwrap_or(Varying::constant([0.25; 3]));
            let factor = found.factor.map(|channel| channel * scale);
            Ok(self.share(Varying { factor, ..found }, statement.spot_of(name)))
        };
        let (reflectance, transmittance) = (scaled("reflectance")?, scaled("transmittance")?);
        Ok(MaterialDescription::DiffuseTransmission { reflectance, transmittance })
    }

    /// Each point has one of two materials; on the mean, a blend.
    fn mix(&mut self, statement: &Statement) -> Result<MaterialDescription> {
        let spot = statement.spot_of("materials");
        let names = match statement.parameter("materials").map(|parameter| &parameter.values) {
            Some(super::statement::Values::Texts(names)) if names.len() == 2 => names.clone(),
            _ => return Err(self.reader.fault(spot, "a mix needs the names of two 'materials'")),
        };
        let weight = self.weight(statement, "amount", 0.5)?;
        self.blend(&names, weight, spot)
    }

    /// Two named materials, blended.
    pub(super) fn blend(&mut self, names: &[String], weight: Paint, spot: Spot) -> Result<MaterialDescription> {
        if let Some(name) = names.iter().find(|name| !self.named_materials.contains_key(*name)) {
            return Err(self.no_material(name, spot));
        }
        let [first, second] = [0, 1].map(|number| MaterialRef::Named(names[number].clone()));
        Ok(MaterialDescription::Blend { weight, first, second })
    }

    fn approximated(&mut self, statement: &Statement, sort: &str) -> Result<MaterialDescription> {
        let name = if statement.has("reflectance") { "reflectance" } else { "color" };
        let instead = if statement.has(name) { "of its colour" } else { "of reflectance 0.5" };
        self.warn(statement.spot, format!("material '{sort}' is not supported: a diffuse surface {instead} is used"));
        let material = self.diffuse(statement, name, 0.5)?;
        statement.leftovers();
        Ok(material)
    }

    fn unknown_material(&mut self, statement: &Statement, sort: &str) -> Result<MaterialDescription> {
        let message = format!("material '{sort}' is not known: a diffuse surface of reflectance 0.5 is used");
        match did_you_mean(sort, SORTS) {
            Some(near) => self.warn_with(statement.spot, message, &format!("did you mean '{near}'?")),
            None => self.warn(statement.spot, message),
        }
        statement.leftovers();
        Ok(MaterialDescription::Diffuse { reflectance: Paint::grey(0.5) })
    }

    /// The microfacets' α; none for a smooth surface.
    pub(super) fn roughness(&mut self, statement: &Statement, prefix: &str, default: f64) -> Result<Option<Roughness>> {
        let [whole, u, v] = if prefix.is_empty() {
            ["roughness", "uroughness", "vroughness"]
        } else {
            ["conductor.roughness", "conductor.uroughness", "conductor.vroughness"]
        };
        let remap = self.placed(statement.boolean("remaproughness", true))?;
        let whole_value = self.varying(statement, whole, Sort::Number)?.unwrap_or(Varying::constant([default; 3]));
        let along = self.varying(statement, u, Sort::Number)?.unwrap_or(whole_value.clone());
        let across = self.varying(statement, v, Sort::Number)?.unwrap_or(whole_value);
        let spot = if statement.has(u) { statement.spot_of(u) } else { statement.spot_of(whole) };
        let alpha = self.alpha(along.clone(), remap, spot);
        if alpha == Paint::grey(0.0) && along == across {
            return Ok(None);
        }
        let alpha_v = if along == across { None } else { Some(self.alpha(across, remap, spot)) };
        if alpha == Paint::grey(0.0) && alpha_v == Some(Paint::grey(0.0)) {
            return Ok(None);
        }
        // Smooth along one direction alone: as smooth as pbrt lets it be.
        let least = |paint: Paint| if paint == Paint::grey(0.0) { Paint::grey(SMOOTH as f32) } else { paint };
        Ok(Some(Roughness {
            alpha: least(alpha),
            alpha_v: alpha_v.map(least),
            distribution: MicrofacetDistribution::Ggx,
            multiple_scattering: false,
        }))
    }

    /// α of a roughness, 0 where it is smooth.
    fn alpha(&mut self, roughness: Varying, remap: bool, spot: Spot) -> Paint {
        if roughness.texture.is_some() {
            if remap {
                let message = "a roughness that varies is taken for α itself, not for its square";
                self.warn_with(
                    spot,
                    message,
                    "set \"bool remaproughness\" false and put the square root in the picture",
                );
            }
            return self.share(roughness, spot);
        }
        let value = roughness.factor[0].clamp(0.0, 1.0);
        let alpha = match (remap, self.is_v3) {
            (false, _) => value,
            (true, false) => value.sqrt(),
            (true, true) if roughness.factor[0] <= 0.0 => 0.0,
            (true, true) => super::v3::alpha(value),
        };
        Paint::grey(if alpha <= SMOOTH { 0.0 } else { alpha as f32 })
    }

    /// The material under its bumps.
    fn bumped(&mut self, statement: &Statement, material: MaterialDescription) -> Result<MaterialDescription> {
        let mut material = material;
        let name = if statement.has("bumpmap") { "bumpmap" } else { "displacement" };
        if let Some(height) = self.varying(statement, name, Sort::Number)?
            && let Some(texture) = height.texture
        {
            let scale = height.factor[0] as f32;
            material = MaterialDescription::BumpMap { height: texture, scale, material: inline(material) };
        }
        if let Some(file) = self.placed(statement.text("normalmap"))?.map(str::to_string) {
            let normals = self.plain_picture(&file, true, statement.spot_of("normalmap"));
            material = MaterialDescription::NormalMap { normals, strength: 1.0, material: inline(material) };
        }
        Ok(material)
    }
}
