//! Materials to draw from and to look at.

use glam::{Vec2, Vec3};
use lampyris::material::Bsdf;
use lampyris::texture::Lookup;

use super::lit;

/// Every kind of material, at least once.
pub const MATERIALS: [&str; 36] = [
    "{ type = 'diffuse', reflectance = [0.2, 0.5, 0.8] }",
    "{ type = 'mirror', reflectance = 0.7 }",
    "{ type = 'glass' }",
    "{ type = 'glass', ior = 1.1, exterior-ior = 1.7, reflectance = 0.5, transmittance = [0.1, 0.9, 0.2] }",
    "{ type = 'thin-glass', ior = 1.8, transmittance = 0.4 }",
    "{ type = 'conductor', eta = [0.2, 0.9, 1.5], k = [3.9, 2.4, 1.9] }",
    "{ type = 'plastic', reflectance = [0.9, 0.2, 0.1] }",
    "{ type = 'plastic', reflectance = 0.8, specular = 0.3, ior = 1.9, nonlinear = true }",
    "{ type = 'coefficients', kd = [0.1, 0.4, 0.2], ks = 0.2, kt = [0.4, 0.1, 0.2] }",
    "{ type = 'coefficients', kd = 0.3, kt = 0.7, fresnel = false }",
    "{ type = 'two-sided', front = { type = 'plastic' }, back = { type = 'coefficients', kd = 0.4, ks = 0.4 } }",
    "{ type = 'mask', opacity = 0.3, material = { type = 'diffuse' } }",
    "{ type = 'mask', opacity = 0.6, material = { type = 'plastic' } }",
    "{ type = 'blend', weight = 0.3, first = { type = 'diffuse' }, second = { type = 'mirror' } }",
    "{ type = 'blend', weight = 0.7, first = { type = 'plastic' }, second = { type = 'glass' } }",
    "{ type = 'blend', weight = 0.5, first = { type = 'diffuse', reflectance = [1, 0, 0] },
       second = { type = 'diffuse', reflectance = [0, 0, 1] } }",
    "{ type = 'two-sided', front = { type = 'mask', opacity = 0.5, material = { type = 'glass' } } }",
    "{ type = 'conductor', metal = 'Au', roughness = { alpha = 0.001 } }",
    "{ type = 'conductor', metal = 'Cu', roughness = { alpha = 0.02, alpha-v = 0.4 } }",
    "{ type = 'conductor', metal = 'Al', roughness = { alpha = 1, multiple-scattering = true } }",
    "{ type = 'conductor', metal = 'Ag', roughness = { alpha = 0.3, distribution = 'beckmann' } }",
    "{ type = 'conductor', metal = 'W', roughness = { alpha = 0.9, alpha-v = 0.05, distribution = 'beckmann' } }",
    "{ type = 'glass', roughness = { alpha = 0.005 } }",
    "{ type = 'glass', ior = 1.2, reflectance = 0.2, roughness = { alpha = 0.3, alpha-v = 0.8 } }",
    "{ type = 'glass', ior = 2, roughness = { alpha = 0.7, multiple-scattering = true } }",
    "{ type = 'glass', ior = 1, exterior-ior = 1.5, roughness = { alpha = 0.2, distribution = 'beckmann' } }",
    "{ type = 'plastic', reflectance = [0.9, 0.2, 0.1], roughness = { alpha = 0.05 } }",
    "{ type = 'two-sided', front = { type = 'plastic', roughness = { alpha = 0.4, distribution = 'beckmann' } } }",
    "{ type = 'rough-diffuse', alpha = 0.7 }",
    "{ type = 'diffuse-transmission', reflectance = 0.6, transmittance = [0.1, 0.2, 0.3] }",
    "{ type = 'phong', exponent = 200 }",
    "{ type = 'ward', alpha-u = 0.05, alpha-v = 0.3 }",
    "{ type = 'principled', metallic = 0.3, roughness = 0.3, anisotropic = 0.7, clearcoat = 1, clearcoat-gloss = 0.5 }",
    "{ type = 'principled', spec-trans = 0.7, roughness = 0.4, clearcoat = 0.5, sheen = 1, flatness = 0.5 }",
    "{ type = 'principled-thin', spec-trans = 0.6, roughness = 0.3, diff-trans = 0.8, anisotropic = 0.5 }",
    "{ type = 'blend', weight = 0.4, first = { type = 'conductor', metal = 'Au', roughness = { alpha = 0.1 } },
       second = { type = 'glass', roughness = { alpha = 0.2 } } }",
];

/// The scattering function of a material, seen from the side of the normal or the other one.
pub fn bsdf(material: &str, front: bool) -> Bsdf<'static> {
    let text = "camera = { origin = [0, 0, 3], target = [0, 0, 0] }
        lights = [{ type = 'constant' }]
        shapes = [{ type = 'quad', corner = [-1, -1, 0], u = [2, 0, 0], v = [0, 2, 0], material = MATERIAL }]";
    let lit = Box::leak(Box::new(lit(&text.replace("MATERIAL", &material.replace('\n', " ")), "")));
    let at = Lookup::point(Vec2::new(0.55, 0.6));
    lit.scene.materials().bsdf(lit.scene.shapes()[0].material, &at, front)
}

/// By its cosine to +z and its azimuth.
pub fn direction(z: f32, around: f32) -> Vec3 {
    ((1.0 - z * z).sqrt() * Vec2::from_angle(around)).extend(z)
}
