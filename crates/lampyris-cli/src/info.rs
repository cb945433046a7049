//! `lampyris info` and `lampyris check`.

use std::collections::BTreeMap;

use lampyris::error::Result;
use lampyris::geometry::Shape;
use lampyris::light::Light;
use lampyris::observer::Silent;
use lampyris::render::default_passes;
use lampyris::scene::Scene;
use lampyris::scene::description::{
    FilterDescription, GeometryDescription, MaterialDescription, MaterialRef, SceneDescription, TextureDescription,
};
use lampyris::spectrum::Spectrum;
use serde_json::Value;

use crate::args::SceneArguments;
use crate::format::{bytes, plural};
use crate::report::{Failure, print};
use crate::scene::{heed, read, ready, warnings};

/// Prints that a scene is good.
///
/// # Errors
/// What is wrong with it.
pub fn check(arguments: &SceneArguments) -> Result<(), Failure> {
    let imported = read(arguments)?;
    let built = ready(arguments, &imported, &[], &Silent)?;
    let warnings = warnings(arguments, &imported, &built);
    heed(&warnings, arguments.strict, false)?;
    let mut summary = vec![
        plural(built.scene.shapes().len(), "shape"),
        plural(triangles(&built.scene), "triangle"),
        plural(built.scene.lights().len(), "light"),
    ];
    summary.extend(time_bins(&imported.description));
    if !warnings.is_empty() {
        summary.push(plural(warnings.len(), "warning"));
    }
    Ok(print(&format!("ok: {}: {}\n", arguments.scene.display(), summary.join(", ")))?)
}

/// Prints what is in a scene.
///
/// # Errors
/// What is wrong with it.
pub fn info(arguments: &SceneArguments) -> Result<(), Failure> {
    let imported = read(arguments)?;
    let built = ready(arguments, &imported, &[], &Silent)?;
    let warnings = warnings(arguments, &imported, &built);
    if arguments.strict {
        heed(&warnings, true, false)?;
    }
    let (description, scene) = (&imported.description, &built.scene);
    let mut table = Table::default();
    table.row("scene", arguments.scene.display());
    settings(&mut table, description, scene);
    shapes(&mut table, description, scene);
    materials(&mut table, description);
    lights(&mut table, description, scene);
    table.row("warnings", if warnings.is_empty() { "none".to_string() } else { warnings.len().to_string() });
    warnings.iter().for_each(|warning| table.row("", warning));
    Ok(print(&table.0)?)
}

/// Lines of a name and what belongs to it.
#[derive(Default)]
struct Table(String);

impl Table {
    fn row(&mut self, name: &str, value: impl std::fmt::Display) {
        self.0 += &format!("{name:<12}  {value}\n");
    }

    /// Rows under one name, of which only the first many are shown.
    fn list(&mut self, name: &str, rows: impl ExactSizeIterator<Item = String>) {
        const MOST: usize = 20;
        let more = rows.len().saturating_sub(MOST);
        rows.take(MOST).enumerate().for_each(|(index, row)| self.row(if index == 0 { name } else { "" }, row));
        if more > 0 {
            self.row("", format!("... and {more} more"));
        }
    }
}

fn settings(table: &mut Table, description: &SceneDescription, scene: &Scene) {
    let integrator = &description.integrator;
    table.row("integrator", format!("{}: {}", integrator.name(), pairs(serde_json::to_value(integrator).ok())));
    let passes = match description.render.passes {
        Some(passes) => passes.to_string(),
        None => format!("{} (default)", default_passes(integrator)),
    };
    let wavelengths = if scene.is_spectral() { ", of four wavelengths each" } else { "" };
    table.row("passes", format!("{passes}{wavelengths}, seed {}", description.render.seed));
    let [width, height] = description.film.size;
    let filter = match description.film.filter {
        FilterDescription::Box { radius } => format!("box filter of radius {radius}"),
        FilterDescription::Tent { radius } => format!("tent filter of radius {radius}"),
        FilterDescription::Gaussian { stddev } => format!("Gaussian filter of standard deviation {stddev}"),
    };
    table.row("film", format!("{width} × {height} pixels, {filter}"));
    if let Some(bins) = time_bins(description) {
        table.row("time", bins);
    }
    let ray = scene.camera().ray([0.5 * width as f32, 0.5 * height as f32].into(), [0.5; 2].into());
    let lens = match description.camera.as_ref().map_or(0.0, |camera| camera.aperture_radius) {
        0.0 => "pinhole".to_string(),
        radius => format!("lens of radius {radius}"),
    };
    let (from, along) = (vector(scene.camera().origin().to_array()), vector(ray.direction.to_array()));
    table.row("camera", format!("{lens} at {from}, looks along {along}"));
}

/// What a film with time keeps, and how many bytes that takes while it is rendered.
fn time_bins(description: &SceneDescription) -> Option<String> {
    let film = &description.film;
    let time = film.time.as_ref()?;
    let kept = match time.amplitudes() {
        Ok(frequencies) if !frequencies.is_empty() => format!("amplitudes of {} frequencies", frequencies.len()),
        _ => plural(time.bins as usize, "time bin"),
    };
    Some(format!("{kept} that take {}", bytes(time.bytes(film.size))))
}

fn shapes(table: &mut Table, description: &SceneDescription, scene: &Scene) {
    let kinds = description.shapes.iter().map(|shape| match &shape.geometry {
        GeometryDescription::Plane { .. } => "plane",
        GeometryDescription::Sphere { .. } => "sphere",
        GeometryDescription::Quad { .. } => "quad",
        GeometryDescription::Disk { .. } => "disk",
        GeometryDescription::Cylinder { .. } => "cylinder",
        GeometryDescription::Cube {} => "cube",
        GeometryDescription::Mesh { .. } | GeometryDescription::Triangles(_) => "mesh",
        GeometryDescription::Instance { .. } => "instance",
    });
    table.row("shapes", format!("{}{}", description.shapes.len(), kinds_in_words(kinds)));
    table.row("triangles", triangles(scene));
    let bounds = scene.bounds();
    let has_plane = scene.surfaces().shapes().any(|shape| matches!(shape, Shape::Plane(_)));
    let planes = if has_plane { ", and infinite planes" } else { "" };
    match bounds.is_empty() {
        true => table.row("bounds", "nothing finite"),
        false => table.row("bounds", format!("{} to {}{planes}", vector(bounds.min.into()), vector(bounds.max.into()))),
    }
}

fn triangles(scene: &Scene) -> usize {
    scene.surfaces().shapes().map(|shape| if let Shape::Mesh(mesh) = shape { mesh.len() } else { 0 }).sum()
}

fn materials(table: &mut Table, description: &SceneDescription) {
    let inline = description.shapes.iter().filter_map(|shape| match &shape.material {
        Some(MaterialRef::Inline(material)) => Some(kind_of_material(material)),
        _ => None,
    });
    let inline: Vec<&str> = inline.collect();
    let total = description.materials.len() + inline.len();
    let kinds = description.materials.values().map(kind_of_material).chain(inline);
    table.row("materials", format!("{total}{}", kinds_in_words(kinds)));
    table.list(
        "",
        description.materials.iter().map(|(name, material)| format!("{name}: {}", kind_of_material(material))),
    );
    let textures = description.textures.iter().map(|(name, texture)| match texture {
        TextureDescription::Bitmap { file, .. } => format!("{name}: {file}"),
        TextureDescription::Checkerboard { .. } => format!("{name}: checkerboard"),
        TextureDescription::VertexColor {} => format!("{name}: vertex colours"),
        TextureDescription::Product { .. } => format!("{name}: product"),
        TextureDescription::Mix { .. } => format!("{name}: mix"),
        TextureDescription::Threshold { .. } => format!("{name}: threshold"),
    });
    table.row("textures", description.textures.len());
    table.list("", textures);
}

fn kind_of_material(material: &MaterialDescription) -> &'static str {
    match material {
        MaterialDescription::None {} => "none",
        MaterialDescription::Diffuse { .. } => "diffuse",
        MaterialDescription::Mirror { .. } => "mirror",
        MaterialDescription::Glass { .. } => "glass",
        MaterialDescription::ThinGlass { .. } => "thin-glass",
        MaterialDescription::Conductor { .. } => "conductor",
        MaterialDescription::Plastic { .. } => "plastic",
        MaterialDescription::Coefficients { .. } => "coefficients",
        MaterialDescription::TwoSided { .. } => "two-sided",
        MaterialDescription::Mask { .. } => "mask",
        MaterialDescription::Blend { .. } => "blend",
        MaterialDescription::RoughDiffuse { .. } => "rough-diffuse",
        MaterialDescription::DiffuseTransmission { .. } => "diffuse-transmission",
        MaterialDescription::Phong { .. } => "phong",
        MaterialDescription::Ward { .. } => "ward",
        MaterialDescription::Principled(_) => "principled",
        MaterialDescription::PrincipledThin(_) => "principled-thin",
        MaterialDescription::NormalMap { .. } => "normal-map",
        MaterialDescription::BumpMap { .. } => "bump-map",
    }
}

fn lights(table: &mut Table, description: &SceneDescription, scene: &Scene) {
    let watts = |power: Spectrum| format!("{} W {}", number(power.mean()), vector(power.to_rgb()));
    table.row("lights", format!("{}, {} in all", scene.lights().len(), watts(scene.power())));
    let rows = scene.lights().iter().map(|light| {
        let name = match light {
            Light::Area(area) => description.shapes.get(area.shape as usize).and_then(|shape| shape.name.clone()),
            _ => None,
        };
        let name = name.map_or_else(String::new, |name| format!(" '{name}'"));
        format!("{}{name}: {}", light.kind(), watts(light.emitter().power(scene.surfaces())))
    });
    table.list("", rows);
}

/// ` (sphere 3, quad 1)`, the most frequent first.
fn kinds_in_words<'k>(kinds: impl Iterator<Item = &'k str>) -> String {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    kinds.for_each(|kind| *counts.entry(kind).or_default() += 1);
    let mut counts: Vec<(&str, usize)> = counts.into_iter().collect();
    counts.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    let words: Vec<String> = counts.iter().map(|(kind, count)| format!("{kind} {count}")).collect();
    if words.is_empty() { String::new() } else { format!(" ({})", words.join(", ")) }
}

/// The settings in `{ "name": { key: value, ... } }`.
fn pairs(integrator: Option<Value>) -> String {
    let settings = integrator.as_ref().and_then(|tree| tree.as_object()?.values().next()?.as_object());
    let word = |value: &Value| match value {
        Value::String(text) => text.clone(),
        Value::Null => "auto".to_string(),
        // Settings are single-precision; in double they show digits that nobody wrote.
        Value::Number(value) if value.is_f64() => value.as_f64().map_or_else(String::new, |v| (v as f32).to_string()),
        other => other.to_string(),
    };
    let pairs: Vec<String> =
        settings.into_iter().flatten().map(|(key, value)| format!("{key} {}", word(value))).collect();
    pairs.join(", ")
}

fn vector(values: [f32; 3]) -> String {
    format!("({}, {}, {})", number(values[0]), number(values[1]), number(values[2]))
}

/// Four figures that count, and no zeros after them.
fn number(value: f32) -> String {
    let size = value.abs();
    if size == 0.0 {
        return "0".to_string();
    }
    if !(1e-4..1e6).contains(&size) {
        return format!("{value:.3e}");
    }
    let decimals = (3 - size.log10().floor() as i32).max(0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_string() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_four_figures() {
        let values = [0.0, -3.5, 0.1, 12.566_37, 123_456.0, 1.5e-7];
        assert_eq!(values.map(number), ["0", "-3.5", "0.1", "12.57", "123456", "1.500e-7"]);
    }

    #[test]
    fn the_most_frequent_kind_comes_first() {
        assert_eq!(kinds_in_words(["quad", "sphere", "sphere"].into_iter()), " (sphere 2, quad 1)");
        assert_eq!(kinds_in_words([].into_iter()), "");
    }

    #[test]
    fn long_lists_are_cut() {
        let mut table = Table::default();
        table.list("x", (0..25).map(|n| n.to_string()));
        assert_eq!(table.0.lines().count(), 21);
        assert!(table.0.ends_with("... and 5 more\n"));
    }
}
