//! Materials: with textures and by number in the scene, and what they are at one point.

mod bsdf;
mod coefficients;
mod delta;
mod diffuse;
mod diffuse_transmission;
mod event;
mod glass;
mod ior;
mod microfacet;
mod model;
mod perturb;
mod phong;
mod plastic;
mod principled;
mod rough_conductor;
mod rough_diffuse;
mod rough_glass;
mod rough_plastic;
mod table;
mod textured;
mod ward;

pub use bsdf::{Bsdf, MAX_PARTS, Part, Scattered, choose_event};
pub use coefficients::Coefficients;
pub use delta::{Conductor, Hole, Mirror};
pub use diffuse::Diffuse;
pub use diffuse_transmission::DiffuseTransmission;
pub use event::{Event, Lobes};
pub use glass::{Glass, ThinGlass};
pub use ior::{Fan, Ior};
pub use microfacet::{MicrofacetDistribution, Microfacets};
pub use model::{Breadth, Model, Scatter, Shares};
pub use perturb::Slopes;
pub use phong::Phong;
pub use plastic::Plastic;
pub use principled::{Principled, PrincipledThin};
pub use rough_conductor::{Metal, RoughConductor};
pub use rough_diffuse::RoughDiffuse;
pub use rough_glass::{BothSides, RoughGlass};
pub use rough_plastic::RoughPlastic;
pub use table::{Coat, Row, Table, white_reflection};
pub use textured::{PrincipledTextures, PrincipledThinTextures, RoughTextures};
pub use ward::{Ward, WardVariant};

use glam::Vec2;

use crate::spectrum::Spectrum;
use crate::texture::{Lookup, Texture};

/// The number of a material in [`Materials`].
pub type MaterialId = u32;

/// How a surface scatters light, with its textures.
#[derive(Clone, Debug)]
pub enum Material {
    /// See [`Hole`].
    None,
    /// See [`Diffuse`].
    Diffuse {
        /// Share of the light that is reflected.
        reflectance: Texture,
    },
    /// See [`Mirror`].
    Mirror {
        /// Share of the light that is reflected.
        reflectance: Texture,
    },
    /// See [`Glass`].
    Glass {
        /// Index below the normal over that above it.
        ior: Ior,
        /// Tint of the reflected light.
        reflectance: Texture,
        /// Tint of the refracted light.
        transmittance: Texture,
    },
    /// See [`ThinGlass`].
    ThinGlass {
        /// Index of the pane over that around it.
        ior: f32,
        /// Tint of the reflected light.
        reflectance: Texture,
        /// Tint of the transmitted light.
        transmittance: Texture,
    },
    /// See [`Conductor`].
    Conductor {
        /// Real part of the index.
        eta: Spectrum,
        /// Imaginary part of the index.
        k: Spectrum,
        /// Tint.
        reflectance: Texture,
    },
    /// See [`Plastic`].
    Plastic {
        /// Colour of the base.
        reflectance: Texture,
        /// Tint of the mirror reflection.
        specular: Texture,
        /// Index of the coat over that outside.
        ior: f32,
        /// [`Plastic::inner_reflectance`] of `ior`.
        inner_reflectance: f32,
        /// Whether inner reflections saturate the colour.
        nonlinear: bool,
    },
    /// See [`Coefficients`].
    Coefficients(Coefficients),
    /// See [`RoughConductor`].
    RoughConductor {
        /// Of what.
        metal: Metal,
        /// Tint.
        reflectance: Texture,
        /// How rough it is.
        rough: RoughTextures,
        /// What white facets reflect at once, if what they do not is given back.
        white: Option<Table<Row>>,
    },
    /// See [`RoughGlass`].
    RoughGlass {
        /// Index below the normal over that above it.
        ior: Ior,
        /// Tint of the reflected light.
        reflectance: Texture,
        /// Tint of the refracted light.
        transmittance: Texture,
        /// How rough it is.
        rough: RoughTextures,
        /// What the facets scatter at once, if what they do not is given back.
        once: Option<Table<BothSides>>,
    },
    /// See [`RoughPlastic`].
    RoughPlastic {
        /// Colour of the base.
        reflectance: Texture,
        /// Tint of the reflection on the coat.
        specular: Texture,
        /// Index of the coat over that outside.
        ior: f32,
        /// How rough the coat is.
        rough: RoughTextures,
        /// What the coat does on average.
        coat: Table<Coat>,
        /// Whether inner reflections saturate the colour.
        nonlinear: bool,
    },
    /// See [`RoughDiffuse`].
    RoughDiffuse {
        /// Share of the light that is reflected.
        reflectance: Texture,
        /// Roughness.
        alpha: Texture,
        /// The qualitative model.
        fast: bool,
    },
    /// See [`DiffuseTransmission`].
    DiffuseTransmission {
        /// Share of the light that is reflected.
        reflectance: Texture,
        /// Share of the light that is transmitted.
        transmittance: Texture,
    },
    /// See [`Phong`].
    Phong {
        /// Share that is reflected diffusely.
        diffuse: Texture,
        /// Share that is reflected around the mirrored direction.
        specular: Texture,
        /// The power of the cosine.
        exponent: Texture,
    },
    /// See [`Ward`].
    Ward {
        /// Which normalisation.
        variant: WardVariant,
        /// Share that is reflected diffusely.
        diffuse: Texture,
        /// Share that is reflected by the Gaussian lobe.
        specular: Texture,
        /// Roughness along x and y.
        alpha: Box<[Texture; 2]>,
    },
    /// See [`Principled`].
    Principled(Box<PrincipledTextures>),
    /// See [`PrincipledThin`].
    PrincipledThin(Box<PrincipledThinTextures>),
    /// A material whose normal a picture turns.
    NormalMap {
        /// (n + 1) / 2 in the frame of tangents.
        normals: Texture,
        /// Factor of the first two coordinates of n.
        strength: f32,
        /// What is turned.
        material: MaterialId,
    },
    /// A material whose normal follows the slope of a height map.
    BumpMap {
        /// Heights.
        height: Texture,
        /// Their unit, in scene units.
        scale: f32,
        /// What is turned.
        material: MaterialId,
    },
    /// One material on the side of the normal, another on the back.
    TwoSided {
        /// Seen from the side of the normal.
        front: MaterialId,
        /// Seen from the other side.
        back: MaterialId,
    },
    /// A material with holes.
    Mask {
        /// 1 where the material is.
        opacity: Texture,
        /// What is not hole.
        material: MaterialId,
    },
    /// A mix of two materials.
    Blend {
        /// Share of the second.
        weight: Texture,
        /// At weight 0.
        first: MaterialId,
        /// At weight 1.
        second: MaterialId,
    },
}

/// All materials of a scene.
#[derive(Clone, Debug, Default)]
pub struct Materials {
    materials: Vec<Material>,
    /// Of each.
    needs: Vec<Needs>,
    /// Whether any has holes.
    holes: bool,
}

/// What a material asks of a surface besides its texture coordinates, and of a [`Bsdf`].
#[derive(Clone, Copy, Debug)]
struct Needs {
    tangents: bool,
    holes: bool,
    parts: usize,
}

impl Needs {
    /// Of a material that stands for itself.
    fn of_one(tangents: bool) -> Needs {
        Needs { tangents, holes: false, parts: 1 }
    }

    /// Of what is either one or the other.
    fn either(self, other: Needs) -> Needs {
        Needs {
            tangents: self.tangents || other.tangents,
            holes: self.holes || other.holes,
            parts: self.parts.max(other.parts),
        }
    }
}

impl Materials {
    /// Adds a material, which may name only earlier ones, and returns its number.
    pub fn add(&mut self, material: Material) -> MaterialId {
        let needs = self.needs(&material);
        self.holes |= needs.holes;
        self.materials.push(material);
        self.needs.push(needs);
        (self.materials.len() - 1) as MaterialId
    }

    fn needs(&self, material: &Material) -> Needs {
        let of = |id: &MaterialId| self.needs[*id as usize];
        match material {
            Material::TwoSided { front, back } => of(front).either(of(back)),
            Material::Blend { first, second, .. } => {
                Needs { parts: of(first).parts + of(second).parts, ..of(first).either(of(second)) }
            }
            Material::Mask { material, .. } => {
                let of = of(material);
                Needs { holes: true, parts: of.parts + 1, ..of }
            }
            Material::NormalMap { material, .. } | Material::BumpMap { material, .. } => {
                Needs { tangents: true, ..of(material) }
            }
            Material::RoughConductor { rough, .. }
            | Material::RoughGlass { rough, .. }
            | Material::RoughPlastic { rough, .. } => Needs::of_one(rough.is_anisotropic()),
            Material::Ward { .. } | Material::Principled(_) | Material::PrincipledThin(_) => Needs::of_one(true),
            Material::None => Needs { holes: true, ..Needs::of_one(false) },
            _ => Needs::of_one(false),
        }
    }

    /// Whether the directions of a surface's tangents make a difference to the material.
    #[inline]
    pub fn has_tangents(&self, id: MaterialId) -> bool {
        self.needs[id as usize].tangents
    }

    /// Whether any material separates wavelengths.
    pub fn disperse(&self) -> bool {
        self.materials.iter().any(|material| match material {
            Material::Glass { ior, .. } | Material::RoughGlass { ior, .. } => ior.disperses(),
            _ => false,
        })
    }

    /// Whether any material has holes.
    pub fn have_holes(&self) -> bool {
        self.holes
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.materials.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.materials.is_empty()
    }

    /// How many parts the [`Bsdf`] of a material has at most.
    pub fn parts(&self, id: MaterialId) -> usize {
        self.needs[id as usize].parts
    }

    /// What the material is at a point, seen from the side of the normal (`front`) or the other one. Looks all
    /// textures up.
    #[inline]
    pub fn bsdf(&self, id: MaterialId, at: &Lookup, front: bool) -> Bsdf<'_> {
        let mut bsdf = Bsdf::default();
        self.make_bsdf(id, at, front, &mut bsdf);
        bsdf
    }

    /// [`Materials::bsdf`] in place of another one.
    #[inline]
    pub fn make_bsdf<'a>(&'a self, id: MaterialId, at: &Lookup, front: bool, bsdf: &mut Bsdf<'a>) {
        bsdf.clear();
        self.collect(id, at, front, 1.0, false, bsdf);
    }

    fn collect<'a>(
        &'a self,
        id: MaterialId,
        at: &Lookup,
        front: bool,
        weight: f32,
        flipped: bool,
        bsdf: &mut Bsdf<'a>,
    ) {
        let model = match &self.materials[id as usize] {
            Material::TwoSided { front: material, .. } if front => {
                return self.collect(*material, at, true, weight, flipped, bsdf);
            }
            Material::TwoSided { back, .. } => return self.collect(*back, at, true, weight, !flipped, bsdf),
            Material::NormalMap { material, .. } | Material::BumpMap { material, .. } => {
                return self.collect(*material, at, front, weight, flipped, bsdf);
            }
            Material::Mask { opacity, material } => {
                let opacity = opacity.at(at).mean();
                self.collect(*material, at, front, weight * opacity, flipped, bsdf);
                return bsdf.push(Part { weight: weight * (1.0 - opacity), flipped, model: Model::Hole(Hole) });
            }
            Material::Blend { weight: share, first, second } => {
                let share = share.at(at).mean();
                self.collect(*first, at, front, weight * (1.0 - share), flipped, bsdf);
                return self.collect(*second, at, front, weight * share, flipped, bsdf);
            }
            Material::None => Model::Hole(Hole),
            Material::Diffuse { reflectance } => Model::Diffuse(Diffuse { reflectance: reflectance.lanes(at) }),
            Material::Mirror { reflectance } => Model::Mirror(Mirror { reflectance: reflectance.lanes(at) }),
            Material::Glass { ior, reflectance, transmittance } => {
                let slowness = ior.slowness_at_d();
                let (ior, fan) = ior.at(at);
                let (reflectance, transmittance) = (reflectance.lanes(at), transmittance.lanes(at));
                Model::Glass(Glass { ior, fan, slowness, reflectance, transmittance })
            }
            Material::ThinGlass { ior, reflectance, transmittance } => Model::ThinGlass(ThinGlass {
                ior: *ior,
                reflectance: reflectance.lanes(at),
                transmittance: transmittance.lanes(at),
            }),
            Material::Conductor { eta, k, reflectance } => {
                let (eta, k) = (at.basis.lanes(*eta), at.basis.lanes(*k));
                Model::Conductor(Conductor { eta, k, reflectance: reflectance.lanes(at) })
            }
            Material::Plastic { reflectance, specular, ior, inner_reflectance, nonlinear } => Model::Plastic(
                Plastic::new(reflectance.lanes(at), specular.lanes(at), *ior, *inner_reflectance, *nonlinear),
            ),
            Material::Coefficients(coefficients) => Model::Coefficients(coefficients.in_lanes(at.basis)),
            Material::RoughConductor { metal, reflectance, rough, white } => {
                let facets = rough.at(at);
                let white = white.as_ref().map(|table| table.row(facets.mean_alpha()));
                let metal = metal.in_lanes(at.basis);
                Model::RoughConductor(RoughConductor { facets, metal, reflectance: reflectance.lanes(at), white })
            }
            Material::RoughGlass { ior, reflectance, transmittance, rough, once } => {
                let facets = rough.at(at);
                let once = once.as_ref().map(|table| table.row(facets.mean_alpha()));
                let (reflectance, transmittance) = (reflectance.lanes(at), transmittance.lanes(at));
                let slowness = ior.slowness_at_d();
                let (ior, fan) = ior.at(at);
                Model::RoughGlass(RoughGlass { facets, ior, fan, slowness, reflectance, transmittance, once })
            }
            Material::RoughPlastic { reflectance, specular, ior, rough, coat, nonlinear } => {
                let facets = rough.at(at);
                let coat = coat.row(facets.mean_alpha());
                let (reflectance, specular) = (reflectance.lanes(at), specular.lanes(at));
                Model::RoughPlastic(RoughPlastic::new(reflectance, specular, facets, *ior, coat, *nonlinear))
            }
            Material::RoughDiffuse { reflectance, alpha, fast } => {
                Model::RoughDiffuse(RoughDiffuse::new(reflectance.lanes(at), alpha.at(at).mean(), *fast))
            }
            Material::DiffuseTransmission { reflectance, transmittance } => {
                let (reflectance, transmittance) = (reflectance.lanes(at), transmittance.lanes(at));
                Model::DiffuseTransmission(DiffuseTransmission { reflectance, transmittance })
            }
            Material::Phong { diffuse, specular, exponent } => Model::Phong(Phong {
                diffuse: diffuse.lanes(at),
                specular: specular.lanes(at),
                exponent: exponent.at(at).mean(),
            }),
            Material::Ward { variant, diffuse, specular, alpha } => Model::Ward(Ward {
                variant: *variant,
                diffuse: diffuse.lanes(at),
                specular: specular.lanes(at),
                alpha: Vec2::new(alpha[0].at(at).mean(), alpha[1].at(at).mean()).max(Vec2::splat(1e-4)),
            }),
            Material::Principled(textures) => Model::Principled(textures.at(at)),
            Material::PrincipledThin(textures) => Model::PrincipledThin(textures.at(at)),
        };
        bsdf.push(Part { weight, flipped, model });
    }
}
