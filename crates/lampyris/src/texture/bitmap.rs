//! Pictures on surfaces.

use std::sync::Arc;

use glam::{Affine2, Vec2};

use super::{Channel, Lookup, Pyramid, Raster, TextureFilter, Wrap};
use crate::spectrum::Spectrum;

/// A picture over the unit square of texture coordinates, (0, 0) at its bottom left corner.
#[derive(Clone, Debug)]
pub struct Bitmap {
    /// The picture, and with [`TextureFilter::Mip`] the smaller ones made from it.
    pub pyramid: Arc<Pyramid>,
    /// What of the picture is taken.
    pub channel: Channel,
    /// What happens between texels.
    pub filter: TextureFilter,
    /// What is outside the unit square, along u and along v.
    pub wrap: [Wrap; 2],
    /// Applied to (u, v) first.
    pub to_uv: Affine2,
}

/// A texel, or what stands where there is none.
enum Wrapped {
    Inside(usize),
    Outside(f32),
}

impl Bitmap {
    /// The colour there.
    pub fn at(&self, lookup: &Lookup) -> Spectrum {
        let uv = self.to_uv.transform_point2(lookup.uv);
        if !uv.is_finite() {
            return Spectrum::ZERO;
        }
        match self.filter {
            TextureFilter::Nearest => self.nearest(uv),
            TextureFilter::Bilinear => self.bilinear(0, uv),
            TextureFilter::Mip => {
                let (level, between) = self.pyramid.level(self.texels_across(lookup.footprint));
                let fine = self.bilinear(level, uv);
                if between == 0.0 { fine } else { fine * (1.0 - between) + self.bilinear(level + 1, uv) * between }
            }
        }
    }

    /// How many texels of the picture lie across a footprint of this width in the surface's (u, v), along the axis on
    /// which they are densest.
    fn texels_across(&self, footprint: f32) -> f32 {
        let picture = self.pyramid.picture(0);
        let to_uv = self.to_uv.matrix2;
        let along_u = Vec2::new(to_uv.x_axis.x, to_uv.y_axis.x).length() * picture.width() as f32;
        let along_v = Vec2::new(to_uv.x_axis.y, to_uv.y_axis.y).length() * picture.height() as f32;
        footprint * along_u.max(along_v)
    }

    fn nearest(&self, uv: Vec2) -> Spectrum {
        let picture = self.pyramid.picture(0);
        let corner = in_texels(picture, uv).floor();
        self.texel(picture, corner.x as i64, corner.y as i64)
    }

    fn bilinear(&self, level: usize, uv: Vec2) -> Spectrum {
        let picture = self.pyramid.picture(level);
        let texel = in_texels(picture, uv) - 0.5;
        let corner = texel.floor();
        let t = texel - corner;
        let (x, y) = (corner.x as i64, corner.y as i64);
        let row = |y| self.texel(picture, x, y) * (1.0 - t.x) + self.texel(picture, x.saturating_add(1), y) * t.x;
        row(y) * (1.0 - t.y) + row(y.saturating_add(1)) * t.y
    }

    fn texel(&self, picture: &Raster, x: i64, y: i64) -> Spectrum {
        let [along_u, along_v] = self.wrap;
        let (x, y) = match (wrapped(along_u, x, picture.width()), wrapped(along_v, y, picture.height())) {
            (Wrapped::Inside(x), Wrapped::Inside(y)) => (x, y),
            (Wrapped::Outside(value), _) | (_, Wrapped::Outside(value)) => return Spectrum::grey(value),
        };
        let color = match self.channel {
            Channel::Color => picture.color(x, y),
            Channel::Red => [picture.color(x, y)[0]; 3],
            Channel::Green => [picture.color(x, y)[1]; 3],
            Channel::Blue => [picture.color(x, y)[2]; 3],
            Channel::Alpha => [picture.opacity(x, y); 3],
        };
        Spectrum::from_rgb(color.map(|value| self.pyramid.bounded(value)))
    }
}

fn in_texels(picture: &Raster, uv: Vec2) -> Vec2 {
    Vec2::new(uv.x, 1.0 - uv.y) * Vec2::new(picture.width() as f32, picture.height() as f32)
}

fn wrapped(wrap: Wrap, index: i64, size: usize) -> Wrapped {
    let size = size as i64;
    let inside = match wrap {
        Wrap::Repeat => index.rem_euclid(size),
        Wrap::Mirror => {
            let index = index.rem_euclid(2 * size);
            index.min(2 * size - 1 - index)
        }
        Wrap::Black if !(0..size).contains(&index) => return Wrapped::Outside(0.0),
        Wrap::White if !(0..size).contains(&index) => return Wrapped::Outside(1.0),
        Wrap::Clamp | Wrap::Black | Wrap::White => index.clamp(0, size - 1),
    };
    Wrapped::Inside(inside as usize)
}

#[cfg(test)]
mod tests {
    use super::super::{Curve, Texels};
    use super::*;

    fn two_by_one(wrap: Wrap, filter: TextureFilter) -> Bitmap {
        bitmap(2, vec![0, 255], wrap, filter)
    }

    /// A grey picture of this width.
    fn bitmap(width: usize, texels: Vec<u8>, wrap: Wrap, filter: TextureFilter) -> Bitmap {
        let height = texels.len() / width;
        let picture = Raster::new(width, height, 1, Texels::Bytes(texels), Curve::Linear).expect("texels");
        let pyramid = Arc::new(Pyramid::new(Arc::new(picture), filter == TextureFilter::Mip, [0.0, 1.0]));
        Bitmap { pyramid, channel: Channel::Color, filter, wrap: [wrap; 2], to_uv: Affine2::IDENTITY }
    }

    fn grey(bitmap: &Bitmap, u: f32) -> f32 {
        bitmap.at(&Lookup::point(Vec2::new(u, 0.5))).to_rgb()[0]
    }

    #[test]
    fn pixel_centres_have_their_own_colour_and_the_middle_the_mean() {
        let bitmap = two_by_one(Wrap::Clamp, TextureFilter::Bilinear);
        assert_eq!([0.25, 0.5, 0.75].map(|u| grey(&bitmap, u)), [0.0, 0.5, 1.0]);
    }

    #[test]
    fn outside_the_square_the_picture_repeats_clamps_mirrors_or_is_black_or_white() {
        let nearest = |wrap, u| grey(&two_by_one(wrap, TextureFilter::Nearest), u);
        assert_eq!(nearest(Wrap::Repeat, 1.25), 0.0);
        assert_eq!(nearest(Wrap::Clamp, 1.25), 1.0);
        assert_eq!(nearest(Wrap::Mirror, 1.25), 1.0);
        assert_eq!(nearest(Wrap::Mirror, 1.75), 0.0);
        assert_eq!(nearest(Wrap::Black, 1.25), 0.0);
        assert_eq!(nearest(Wrap::White, -0.25), 1.0);
        assert_eq!(nearest(Wrap::White, 0.25), 0.0);
    }

    #[test]
    fn each_axis_has_a_rule_of_its_own() {
        let mut bitmap = bitmap(1, vec![255], Wrap::Black, TextureFilter::Nearest);
        bitmap.wrap[1] = Wrap::Repeat;
        let at = |u, v| bitmap.at(&Lookup::point(Vec2::new(u, v))).to_rgb()[0];
        assert_eq!([at(0.5, 7.5), at(1.5, 0.5)], [1.0, 0.0]);
    }

    #[test]
    fn a_channel_stands_for_all_three_and_alpha_is_one_without_opacity() {
        let texels = Texels::Bytes(vec![51, 102, 153, 204]);
        let picture = |channels: usize| {
            let Texels::Bytes(bytes) = &texels else { unreachable!() };
            Raster::new(1, 1, channels, Texels::Bytes(bytes[..channels].to_vec()), Curve::Linear).expect("a texel")
        };
        let of = |channels, channel| {
            let pyramid = Arc::new(Pyramid::new(Arc::new(picture(channels)), false, [0.0, 1.0]));
            let bitmap = Bitmap { pyramid, channel, ..two_by_one(Wrap::Repeat, TextureFilter::Bilinear) };
            grey(&bitmap, 0.5)
        };
        let channels = [Channel::Red, Channel::Green, Channel::Blue, Channel::Alpha];
        assert_eq!(channels.map(|channel| of(4, channel)), [0.2, 0.4, 0.6, 0.8]);
        assert_eq!(channels.map(|channel| of(3, channel)), [0.2, 0.4, 0.6, 1.0]);
        assert_eq!(channels.map(|channel| of(2, channel)), [0.2, 0.2, 0.2, 0.4]);
    }

    #[test]
    fn values_are_cut_where_a_share_of_light_ends_and_nothing_else_is() {
        let texels = vec![-1.0, f32::NAN, 3.0, f32::INFINITY];
        let picture = Arc::new(Raster::new(4, 1, 1, Texels::Floats(texels), Curve::Linear).expect("texels"));
        let of = |bounds| {
            let pyramid = Arc::new(Pyramid::new(Arc::clone(&picture), false, bounds));
            let bitmap = Bitmap { pyramid, ..two_by_one(Wrap::Repeat, TextureFilter::Nearest) };
            [0.1, 0.3, 0.6, 0.9].map(|u| grey(&bitmap, u))
        };
        assert_eq!(of([0.0, 1.0]), [0.0, 0.0, 1.0, 1.0]);
        assert_eq!(of([0.0, f32::MAX]), [0.0, 0.0, 3.0, f32::MAX]);
        assert_eq!(of([-2.0, 2.0]), [-1.0, -2.0, 2.0, 2.0]);
    }

    /// 8 × 8 squares of one texel.
    fn fine_checkerboard(filter: TextureFilter) -> Bitmap {
        let texel = |index: usize| if (index + index / 8).is_multiple_of(2) { 255 } else { 0 };
        bitmap(8, (0..64).map(texel).collect(), Wrap::Repeat, filter)
    }

    #[test]
    fn magnified_a_mip_is_bilinear_to_the_bit() {
        let [mip, bilinear] = [TextureFilter::Mip, TextureFilter::Bilinear].map(fine_checkerboard);
        for step in 0..1000 {
            let uv = Vec2::new(step as f32 * 0.013 - 3.0, step as f32 * 0.007);
            for footprint in [0.0, 0.01, 0.125] {
                let lookup = Lookup { footprint, ..Lookup::point(uv) };
                assert_eq!(mip.at(&lookup), bilinear.at(&lookup), "{lookup:?}");
            }
        }
    }

    #[test]
    fn a_footprint_of_two_texels_sees_the_mean_of_them() {
        let mip = fine_checkerboard(TextureFilter::Mip);
        for footprint in [0.25, 0.5, 3.0, f32::INFINITY] {
            let lookup = Lookup { footprint, ..Lookup::point(Vec2::new(0.1, 0.3)) };
            assert_eq!(mip.at(&lookup).to_rgb()[0], 0.5, "{footprint}");
        }
        // Half way between the levels, half of each.
        let lookup = Lookup { footprint: 0.125 * 2.0_f32.sqrt(), ..Lookup::point(Vec2::splat(0.0625)) };
        let (seen, texel) = (mip.at(&lookup).to_rgb()[0], mip.at(&Lookup::point(lookup.uv)).to_rgb()[0]);
        assert!((seen - 0.5 * (texel + 0.5)).abs() < 1e-6, "{seen} of {texel}");
    }
}
