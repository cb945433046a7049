//! Textures: a picture, how it is sampled, and which part of it is taken.

use glam::{Mat4, Vec2, Vec3};

use super::Importer;
use super::document::{Sampler, TextureInfo};
use super::extensions::TextureTransform;
use super::source::{Resource, missing, resolve};
use crate::error::Result;
use crate::scene::description::{Channel, Color, Paint, TextureDescription, TextureFilter, Transform, Wrap};

impl Importer<'_> {
    /// The name in the description of `channel` of a texture that stands at `path`; nothing if it has no picture that
    /// we can read. Colours are decoded from sRGB, single channels but alpha are raw numbers.
    pub(super) fn texture(
        &mut self,
        info: &TextureInfo,
        channel: Channel,
        raw: bool,
        path: &str,
    ) -> Result<Option<String>> {
        let textures = &self.document.textures;
        let Some(texture) = textures.get(info.index) else {
            let place = format!("textures[{}]", info.index);
            let error = missing(&self.spots, &place, textures.len());
            let message = format!("{path}: {}", error.message);
            return Err(self.spots.placed(path, crate::error::Error { message, place: None, ..error }));
        };
        let place = format!("textures[{}]", info.index);
        let Some(source) = texture.source else {
            self.warn(&place, "a texture without a picture in PNG or JPEG is left out");
            return Ok(None);
        };
        let file = self.image(source)?;
        let samplers = &self.document.samplers;
        let default = Sampler::default();
        let sampler = match texture.sampler {
            Some(index) => samplers
                .get(index)
                .ok_or_else(|| missing(&self.spots, &format!("samplers[{index}]"), samplers.len()))?,
            None => &default,
        };
        let (wrap, wrap_v) = (wrap(sampler.wrap_s), wrap(sampler.wrap_t));
        let to_uv = info.extensions.transform.as_ref().map_or(Transform::default(), to_uv);
        let description = TextureDescription::Bitmap {
            file,
            raw,
            channel,
            filter: filter(sampler),
            wrap,
            wrap_v: (wrap_v != wrap).then_some(wrap_v),
            to_uv,
        };
        let suffix = match channel {
            Channel::Color if raw => "-raw",
            Channel::Color => "",
            Channel::Red => "-red",
            Channel::Green => "-green",
            Channel::Blue => "-blue",
            Channel::Alpha => "-alpha",
        };
        Ok(Some(self.named_texture(format!("texture{}{suffix}", info.index), description, &place)))
    }

    /// A paint that is two multiplied; `name` is that of the texture that may be needed, `path` where it comes from.
    pub(super) fn product(&mut self, first: Paint, second: Paint, name: &str, path: &str) -> Paint {
        match (first, second) {
            (Paint::Color(Color(a)), Paint::Color(Color(b))) => {
                Paint::Color(Color([a[0] * b[0], a[1] * b[1], a[2] * b[2]]))
            }
            (Paint::Color(Color([1.0, 1.0, 1.0])), other) | (other, Paint::Color(Color([1.0, 1.0, 1.0]))) => other,
            (black @ Paint::Color(Color([0.0, 0.0, 0.0])), _) | (_, black @ Paint::Color(Color([0.0, 0.0, 0.0]))) => {
                black
            }
            (first, second) => {
                let product = TextureDescription::Product { first, second };
                Paint::Texture(self.named_texture(name.to_string(), product, path))
            }
        }
    }

    /// Puts a texture into the description, under `name` or one like it; equal ones are there once.
    pub(super) fn named_texture(&mut self, name: String, texture: TextureDescription, path: &str) -> String {
        let mut free = name.clone();
        let mut number = 1;
        while let Some(other) = self.imported.description.textures.get(&free) {
            if *other == texture {
                return free;
            }
            number += 1;
            free = format!("{name}-{number}");
        }
        self.note(format!("textures.{free}"), path);
        self.imported.description.textures.insert(free.clone(), texture);
        free
    }

    /// The file of a picture, or the name of one that lies in ours.
    fn image(&mut self, index: usize) -> Result<String> {
        let path = format!("images[{index}]");
        let images = &self.document.images;
        let image = images.get(index).ok_or_else(|| missing(&self.spots, &path, images.len()))?;
        let name = format!("{}#image{index}", self.file_name);
        if self.imported.embedded.contains_key(&name) {
            return Ok(name);
        }
        let bytes = match (&image.uri, image.buffer_view) {
            (Some(uri), _) => match resolve(uri).map_err(|message| self.spots.fault(&path, message))? {
                Resource::File(file) => return Ok(file),
                Resource::Bytes(bytes) => bytes,
            },
            (None, Some(view)) => self.buffers.view(view, &self.spots)?.0.to_vec(),
            (None, None) => return Err(self.spots.fault(&path, "it has neither 'uri' nor 'bufferView'")),
        };
        self.imported.embedded.insert(name.clone(), bytes.into());
        Ok(name)
    }
}

/// Which texture coordinates a texture is looked up with.
pub(super) fn uv_set(info: &TextureInfo) -> u32 {
    info.extensions.transform.as_ref().and_then(|transform| transform.tex_coord).unwrap_or(info.tex_coord)
}

fn wrap(code: Option<u32>) -> Wrap {
    match code {
        Some(33071) => Wrap::Clamp,
        Some(33648) => Wrap::Mirror,
        _ => Wrap::Repeat,
    }
}

/// Nearest pixels where they are asked for in what is enlarged, as for pixel art; smaller pictures for what is
/// further away unless the file says that there are none.
fn filter(sampler: &Sampler) -> TextureFilter {
    match (sampler.mag_filter, sampler.min_filter) {
        (Some(9728), _) => TextureFilter::Nearest,
        (_, Some(9728 | 9729)) => TextureFilter::Bilinear,
        _ => TextureFilter::Mip,
    }
}

/// `KHR_texture_transform` scales first, then rotates, then moves, where v runs downwards; the rotation is clockwise
/// in those axes, as the sample TextureTransformTest has it.
fn to_uv(transform: &TextureTransform) -> Transform {
    let upside_down = Mat4::from_translation(Vec3::Y) * Mat4::from_scale(Vec3::new(1.0, -1.0, 1.0));
    let theirs = Mat4::from_translation(Vec2::from_array(transform.offset).extend(0.0))
        * Mat4::from_rotation_z(-transform.rotation)
        * Mat4::from_scale(Vec2::from_array(transform.scale).extend(1.0));
    Transform(upside_down * theirs * upside_down)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn transforms_turn_and_move_the_picture_as_the_sample_shows() {
        // In TextureTransformTest the arrow of the picture ends at (0.69, 0.69) from its top left corner; turned by
        // 22.5°, it points to a mark at (0.42, 1.02) from the corner of the quad, 67.5° below the edge.
        let transform = TextureTransform { rotation: 22.5_f32.to_radians(), ..TextureTransform::default() };
        let mark = Vec3::new(0.42, 1.0 - 1.02, 0.0);
        let in_picture = to_uv(&transform).0.transform_point3(mark);
        assert!((in_picture.x - (1.0 - in_picture.y)).abs() < 0.01, "{in_picture}");
        // An offset of half a picture downwards.
        let transform = TextureTransform { offset: [0.0, 0.5], ..TextureTransform::default() };
        let in_picture = to_uv(&transform).0.transform_point3(Vec3::new(0.25, 0.75, 0.0));
        assert!(in_picture.abs_diff_eq(Vec3::new(0.25, 0.25, 0.0), 1e-6), "{in_picture}");
    }

    #[test]
    fn filters_are_mip_unless_said_otherwise() {
        let of = |mag_filter, min_filter| filter(&Sampler { mag_filter, min_filter, ..Sampler::default() });
        assert_eq!(of(None, None), TextureFilter::Mip);
        assert_eq!(of(Some(9729), Some(9987)), TextureFilter::Mip);
        assert_eq!(of(Some(9729), Some(9729)), TextureFilter::Bilinear);
        assert_eq!(of(Some(9728), Some(9986)), TextureFilter::Nearest);
    }
}
