//! Wavefront OBJ with its MTL as a scene, and single meshes as scenes.
//!
//! Each material becomes a shape. Such files have no camera, which is placed by the bounds, and often no lamp.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::{Mat4, Vec3};

use super::framing::{self, Up};
use super::mtl::{self, Map, Material};
use super::source::{Disk, Folder};
use super::{Imported, files, gzip, obj};
use crate::error::{Error, Place, Result, Warning, did_you_mean};
use crate::geometry::MeshData;
use crate::scene::description::{
    Channel, Color, EmissionDescription, GeometryDescription, MaterialDescription, MaterialRef, Paint, Principled,
    ShapeDescription, TextureDescription, TextureFilter, Transform, Wrap,
};

/// Reads an OBJ file as a scene, its materials from the libraries that it names, relative to its folder.
///
/// # Errors
/// Where the file cannot be read, or is broken; with the place. Missing libraries, materials and pictures are warnings.
pub fn read(path: &Path) -> Result<Imported> {
    let folder = Disk(path.parent().unwrap_or(Path::new("")).to_path_buf());
    match path.file_name() {
        Some(name) => read_from(&folder, Path::new(name)),
        None => Err(Error::new(format!("'{}' is not a file", path.display()))),
    }
}

/// Reads a single PLY or STL mesh as a scene, without material.
///
/// # Errors
/// Where the mesh cannot be read.
pub fn read_mesh(path: &Path) -> Result<Imported> {
    let mesh = Arc::new(files::read_mesh(path, 0)?);
    let up = if files::mesh_extension(path) == "stl" { Up::Z } else { Up::Y };
    let mut imported = Imported::default();
    imported.description.shapes.push(shape(Arc::clone(&mesh), None, None));
    imported.description.camera = Some(framing::frame(&framing::bounds([&*mesh]), up));
    imported.description.lights.push(framing::default_light());
    Ok(imported)
}

fn read_from(folder: &dyn Folder, main: &Path) -> Result<Imported> {
    let shown = folder.shown(main);
    let name = shown.to_string_lossy();
    let bytes = folder.read(main).map_err(|error| Error::io(&shown, "read", &error))?;
    let obj::Parts { parts, libraries } = obj::read_parts(&name, &gzip::unpacked(&name, &bytes)?)?;
    let mut importer = Importer { folder, imported: Imported::default(), done: HashMap::new() };
    let materials = importer.libraries(&libraries);
    let camera = framing::frame(&framing::bounds(parts.iter().map(|part| &part.mesh)), Up::Y);
    for part in parts {
        importer.part(part, &materials);
    }
    let mut imported = importer.imported;
    if imported.description.shapes.iter().all(|shape| shape.emission.is_none()) {
        imported.description.lights.push(framing::default_light());
    }
    imported.description.camera = Some(camera);
    Ok(imported)
}

fn shape(
    mesh: Arc<MeshData>,
    material: Option<MaterialRef>,
    emission: Option<EmissionDescription>,
) -> ShapeDescription {
    ShapeDescription {
        interior: None,
        priority: 0,
        geometry: GeometryDescription::Triangles(mesh),
        material,
        emission,
        transform: Transform::default(),
        flip_normal: false,
        name: None,
    }
}

/// A description in the making.
struct Importer<'a> {
    folder: &'a dyn Folder,
    imported: Imported,
    /// What a material emits, by its name, of those that are in the description already.
    done: HashMap<String, Option<EmissionDescription>>,
}

/// A material and the folder of its library, from which its pictures are named.
type Found = (Material, PathBuf);

impl Importer<'_> {
    fn warn(&mut self, message: impl Into<String>, place: Option<&Place>) {
        let warning = Warning::new(message);
        super::warn(&mut self.imported.warnings, || match place {
            Some(place) => warning.with_place(place.clone()),
            None => warning,
        });
    }

    /// All materials of all libraries; of two with the same name the first.
    fn libraries(&mut self, libraries: &[(String, Place)]) -> HashMap<String, Found> {
        let mut materials = HashMap::new();
        let mut read: HashSet<PathBuf> = HashSet::new();
        for (names, place) in libraries {
            // One name with blanks, or several names.
            let whole = vec![names.clone()];
            let apart = || names.split(' ').map(str::to_string).collect();
            let names: Vec<String> = if self.folder.has(Path::new(names)) { whole } else { apart() };
            for name in names {
                let path = PathBuf::from(name.replace('\\', "/"));
                if read.contains(&path) {
                    continue;
                }
                let shown = self.folder.shown(&path);
                match self.folder.read(&path) {
                    Ok(bytes) => {
                        let (found, warnings) = mtl::read(&shown.to_string_lossy(), &bytes);
                        warnings.into_iter().for_each(|one| super::warn(&mut self.imported.warnings, || one));
                        let folder = path.parent().unwrap_or(Path::new("")).to_path_buf();
                        for material in found {
                            materials.entry(material.name.clone()).or_insert((material, folder.clone()));
                        }
                    }
                    Err(error) => {
                        let missing = Error::io(&shown, "read", &error).message;
                        self.warn(format!("{missing}: its materials are grey"), Some(place));
                    }
                }
                read.insert(path);
            }
        }
        materials
    }

    fn part(&mut self, part: obj::Part, materials: &HashMap<String, Found>) {
        let name = part.material;
        let mut described = None;
        if let Some((material, folder)) = materials.get(&name) {
            if !self.done.contains_key(&name) {
                let emission = self.emission(material, folder);
                let description = self.described(material, folder);
                if let Some(place) = &material.place {
                    self.imported.places.note(format!("materials.{name}"), place.clone());
                }
                self.imported.description.materials.insert(name.clone(), description);
                self.done.insert(name.clone(), emission);
            }
            described = Some(MaterialRef::Named(name.clone()));
        } else if !name.is_empty() && !materials.is_empty() {
            super::warn(&mut self.imported.warnings, || {
                let warning = Warning::new(format!("there is no material '{name}': the surface is grey"));
                match did_you_mean(&name, materials.keys().map(String::as_str)) {
                    Some(near) => warning.with_hint(format!("did you mean '{near}'?")),
                    None => warning,
                }
            });
        }
        let emission = self.done.get(&name).cloned().flatten();
        let mut shape = shape(Arc::new(part.mesh), described, emission);
        shape.name = (!name.is_empty()).then_some(name);
        self.imported.description.shapes.push(shape);
    }

    /// `Ke` is radiance, on the front of the faces.
    fn emission(&mut self, material: &Material, folder: &Path) -> Option<EmissionDescription> {
        let color = material.emission.unwrap_or(if material.map_emission.is_some() { [1.0; 3] } else { [0.0; 3] });
        let most = color.iter().fold(0.0f32, |most, &channel| most.max(channel));
        if most <= 0.0 {
            return None;
        }
        let color = color.map(|channel| channel.max(0.0));
        let radiance = match &material.map_emission {
            Some(map) => {
                let paint = self.painted(material, map, false, color.map(|channel| channel / most), folder);
                return Some(EmissionDescription { radiance: Some(paint), power: None, scale: most, two_sided: false });
            }
            None => Paint::Color(Color(color)),
        };
        Some(EmissionDescription { radiance: Some(radiance), power: None, scale: 1.0, two_sided: false })
    }

    fn described(&mut self, material: &Material, folder: &Path) -> MaterialDescription {
        let mut described = self.surface(material, folder);
        if let Some(map) = &material.bump
            && let Some(height) = self.texture(material, map, true, folder)
        {
            let material = Box::new(described);
            described =
                MaterialDescription::BumpMap { height, scale: map.strength, material: MaterialRef::Inline(material) };
        }
        if let Some(map) = &material.normal
            && let Some(normals) = self.texture(material, map, true, folder)
        {
            let material = MaterialRef::Inline(Box::new(described));
            described = MaterialDescription::NormalMap { normals, strength: map.strength, material };
        }
        let opacity = match (&material.map_opacity, material.opacity) {
            _ if is_glass(material) => return described,
            (Some(map), opacity) => {
                let opacity = opacity.filter(|&opacity| opacity > 0.0).unwrap_or(1.0).min(1.0);
                self.painted(material, map, true, [opacity; 3], folder)
            }
            (None, Some(opacity)) if opacity < 1.0 => Paint::grey(opacity.max(0.0)),
            _ => return described,
        };
        MaterialDescription::Mask { opacity, material: MaterialRef::Inline(Box::new(described)) }
    }

    /// The surface itself, without bumps and holes.
    fn surface(&mut self, material: &Material, folder: &Path) -> MaterialDescription {
        let share = |color: [f32; 3]| color.map(|channel| channel.clamp(0.0, 1.0));
        if is_glass(material) {
            // The filter is that of the whole body, whose boundary light crosses twice.
            let filter = share(material.filter.unwrap_or([1.0; 3])).map(f32::sqrt);
            return MaterialDescription::Glass {
                ior: material.ior.filter(|&ior| ior > 1.0).unwrap_or(1.5).into(),
                exterior_ior: 1.0.into(),
                reflectance: Paint::grey(1.0),
                transmittance: Paint::Color(Color(filter)),
                roughness: None,
            };
        }
        let default = if material.map_diffuse.is_some() { [1.0; 3] } else { [0.5; 3] };
        let mut diffuse = share(material.diffuse.unwrap_or(default));
        if let (Some(_), [0.0, 0.0, 0.0]) = (&material.map_diffuse, diffuse) {
            // Written by programs that mean the picture alone.
            diffuse = [1.0; 3];
        }
        let specular_default = if material.map_specular.is_some() { [1.0; 3] } else { [0.0; 3] };
        let mut specular = share(material.specular.unwrap_or(specular_default));
        if material.roughness.is_some() || material.metallic.is_some() {
            return MaterialDescription::Principled(Box::new(Principled {
                base_color: self.tinted(material, &material.map_diffuse, diffuse, folder),
                roughness: Paint::grey(material.roughness.unwrap_or(0.5).clamp(0.0, 1.0)),
                metallic: Paint::grey(material.metallic.unwrap_or(0.0).clamp(0.0, 1.0)),
                ..Principled::default()
            }));
        }
        // The models of computer graphics' youth add up to more than what arrives.
        let sum = [0, 1, 2].map(|channel| diffuse[channel] + specular[channel]);
        let excess = sum.iter().fold(1.0f32, |most, &sum| most.max(sum));
        let shines = specular != [0.0; 3] && matches!(material.illumination, None | Some(2..));
        let mirrors = shines && matches!(material.illumination, Some(3 | 5 | 8));
        if shines && excess > 1.0 {
            // A little less than 1 by rounding, so that the sum never exceeds it.
            diffuse = diffuse.map(|channel| channel / (1.000_01 * excess));
            specular = specular.map(|channel| channel / (1.000_01 * excess));
            let message = "Kd and Ks add up to more than 1: both are scaled down";
            self.warn(message, material.place.as_ref());
        }
        if mirrors && material.map_diffuse.is_none() && material.map_specular.is_none() {
            return MaterialDescription::Coefficients {
                kd: Color(diffuse),
                ks: Color(specular),
                kt: Color::grey(0.0),
                ior: 1.5,
                fresnel: true,
            };
        }
        let reflectance = self.tinted(material, &material.map_diffuse, diffuse, folder);
        if !shines {
            return MaterialDescription::Diffuse { reflectance };
        }
        let specular = self.tinted(material, &material.map_specular, specular, folder);
        let inline = |material| MaterialRef::Inline(Box::new(material));
        if mirrors {
            // Half of each, each twice as strong, is the sum of both where the file's pictures allow it.
            self.warn("a mirror with pictures is blended half and half with its colour", material.place.as_ref());
            return MaterialDescription::Blend {
                weight: Paint::grey(0.5),
                first: inline(MaterialDescription::Diffuse { reflectance }),
                second: inline(MaterialDescription::Mirror { reflectance: specular }),
            };
        }
        let exponent = Paint::grey(material.exponent.unwrap_or(10.0).max(0.0));
        let phong = MaterialDescription::Phong { diffuse: reflectance, specular, exponent };
        MaterialDescription::TwoSided { front: inline(phong), back: None }
    }

    /// A colour, times a picture if there is one.
    fn tinted(&mut self, material: &Material, map: &Option<Map>, color: [f32; 3], folder: &Path) -> Paint {
        match map {
            Some(map) => self.painted(material, map, false, color, folder),
            None => Paint::Color(Color(color)),
        }
    }

    fn painted(&mut self, material: &Material, map: &Map, raw: bool, tint: [f32; 3], folder: &Path) -> Paint {
        let Some(texture) = self.texture(material, map, raw, folder) else { return Paint::Color(Color(tint)) };
        if tint == [1.0; 3] {
            return Paint::Texture(texture);
        }
        let product =
            TextureDescription::Product { first: Paint::Texture(texture.clone()), second: Paint::Color(Color(tint)) };
        Paint::Texture(self.add_texture(&format!("{texture}-tinted"), product))
    }

    /// The name of a picture's texture; none, with a warning, if there is no such file.
    fn texture(&mut self, material: &Material, map: &Map, raw: bool, folder: &Path) -> Option<String> {
        let path = folder.join(&map.file);
        if !self.folder.has(&path) {
            let shown = self.folder.shown(&path);
            let message = format!("the picture '{}' is not there: the colour alone is used", shown.display());
            self.warn(message, material.place.as_ref());
            return None;
        }
        let [scale, offset] = [map.scale, map.offset].map(|[u, v]| Vec3::new(u, v, 0.0));
        let to_uv = Mat4::from_translation(offset) * Mat4::from_scale(scale.with_z(1.0));
        let picture = TextureDescription::Bitmap {
            file: path.to_string_lossy().into_owned(),
            raw,
            channel: if map.alpha { Channel::Alpha } else { Channel::Color },
            filter: TextureFilter::Bilinear,
            wrap: if map.clamp { Wrap::Black } else { Wrap::Repeat },
            wrap_v: None,
            to_uv: Transform(to_uv),
        };
        Some(self.add_texture(&map.file, picture))
    }

    /// Adds a texture under this name or, if another has it, one like it.
    fn add_texture(&mut self, name: &str, texture: TextureDescription) -> String {
        let textures = &mut self.imported.description.textures;
        let numbered = (2..).map(|number| format!("{name}-{number}"));
        let mut names = std::iter::once(name.to_string()).chain(numbered);
        let free = |name: &String| textures.get(name).is_none_or(|other| *other == texture);
        let name = names.find(free).unwrap_or_default();
        textures.insert(name.clone(), texture);
        name
    }
}

/// Whether light passes through with refraction.
fn is_glass(material: &Material) -> bool {
    matches!(material.illumination, Some(4 | 6 | 7 | 9))
}

#[cfg(test)]
mod tests;
