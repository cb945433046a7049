//! A picture without its noise, as a neural network guesses it: Open Image Denoise, in builds with the feature `denoise`.
//!
//! What comes out is no estimate any more: it converges with its input, but no error bar holds for it, and its last bits
//! depend on the library and the processor. Films and sums therefore never hold it.

use crate::error::{Error, Result};
use crate::image::Image;

/// The library, made ready. In builds without it there is none.
pub struct Denoiser(Device);

#[cfg(feature = "denoise")]
type Device = oidn::Device;

#[cfg(not(feature = "denoise"))]
type Device = std::convert::Infallible;

/// Layers of the same size as the picture that help to tell edges and textures from noise; they may be noisy, too.
#[derive(Clone, Copy, Debug, Default)]
pub struct Guides<'a> {
    /// Linear RGB, 0 to 1: [`Layer::Albedo`](crate::film::Layer::Albedo).
    pub albedo: Option<&'a Image>,
    /// In world coordinates, no longer than 1: [`Layer::Normal`](crate::film::Layer::Normal). Not used without albedo.
    pub normal: Option<&'a Image>,
}

#[cfg(not(feature = "denoise"))]
impl Denoiser {
    /// The feature is not there.
    ///
    /// # Errors
    /// Always.
    pub fn new() -> Result<Denoiser> {
        Err(Error::new("this build of lampyris cannot denoise").with_hint(
            "build it with Open Image Denoise: OIDN_DIR=FOLDER cargo install --path crates/lampyris-cli --features denoise",
        ))
    }

    /// There is no such denoiser.
    ///
    /// # Errors
    /// None.
    pub fn denoise(&self, _noisy: &Image, _guides: Guides<'_>) -> Result<Image> {
        match self.0 {}
    }
}

#[cfg(feature = "denoise")]
impl Denoiser {
    /// Makes the library ready. It computes on the processor, with threads of its own.
    ///
    /// # Errors
    /// What the library says, as when its modules are not beside it.
    pub fn new() -> Result<Denoiser> {
        let device = oidn::Device::cpu().map_err(|error| fail(&error));
        Ok(Denoiser(device.map_err(|error| error.with_hint("are all files of Open Image Denoise in its folder?"))?))
    }

    /// The picture, linear radiance in any unit, without its noise. Values below 0 become 0.
    ///
    /// # Errors
    /// Guides of another size than the picture; what the library says, as when memory runs out.
    pub fn denoise(&self, noisy: &Image, guides: Guides<'_>) -> Result<Image> {
        let size = |image: &Image| (image.width(), image.height());
        if [guides.albedo, guides.normal].into_iter().flatten().any(|guide| size(guide) != size(noisy)) {
            return Err(Error::new("a picture and the layers to denoise it by must have the same size"));
        }
        let mut clean = noisy.clone();
        self.filter(&mut clean, guides).map_err(|error| fail(&error))?;
        Ok(clean)
    }

    fn filter(&self, image: &mut Image, guides: Guides<'_>) -> std::result::Result<(), oidn::Error> {
        let device = &self.0;
        let buffer = |image: &Image| device.create_buffer(image.pixels().as_flattened());
        let mut filter = oidn::RayTracing::try_new(device)?;
        filter.hdr(true).image_dimensions(image.width(), image.height());
        match (guides.albedo, guides.normal) {
            (Some(albedo), Some(normal)) => _ = filter.albedo_normal_buffer(buffer(albedo)?, buffer(normal)?)?,
            (Some(albedo), None) => _ = filter.albedo_buffer(buffer(albedo)?)?,
            (None, _) => {}
        }
        filter.filter_in_place(image.pixels_mut().as_flattened_mut())
    }
}

#[cfg(feature = "denoise")]
fn fail(error: &oidn::Error) -> Error {
    let what = if error.message().is_empty() { error.kind().as_str() } else { error.message() };
    Error::new(format!("Open Image Denoise failed: {what}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(not(feature = "denoise"))]
    #[test]
    fn a_build_without_it_says_how_to_get_it() {
        let error = Denoiser::new().err().expect("not there");
        assert_eq!(error.message, "this build of lampyris cannot denoise");
        assert!(error.hint.expect("a hint").contains("--features denoise"));
    }

    #[cfg(feature = "denoise")]
    mod with_library {
        use rand_core::{Rng, SeedableRng};
        use rand_pcg::Pcg64Mcg;

        use super::*;
        use crate::compare::compare;

        /// Grey to the left, half as bright to the right, far above what a display shows; and with noise of a third.
        fn pictures() -> (Image, Image) {
            let mut random = Pcg64Mcg::seed_from_u64(1);
            let pixel = |index: usize| if index % 96 < 48 { [40.0_f32; 3] } else { [20.0, 10.0, 20.0] };
            let clean = Image::from_pixels(96, 64, (0..96 * 64).map(pixel).collect()).expect("as many pixels");
            let mut factor = || 0.5 + random.next_u32() as f32 / u32::MAX as f32;
            let noisy = clean.pixels().iter().map(|pixel| pixel.map(|value| value * factor())).collect();
            (Image::from_pixels(96, 64, noisy).expect("as many pixels"), clean)
        }

        #[test]
        fn noise_goes_and_edges_stay() {
            let (noisy, clean) = pictures();
            let (albedo, normal) = (clean.map(|pixel| pixel.map(|value| value / 50.0)), Image::new(96, 64));
            let denoiser = Denoiser::new().expect("the library is there");
            for guides in [
                Guides::default(),
                Guides { albedo: Some(&albedo), normal: None },
                Guides { albedo: Some(&albedo), normal: Some(&normal) },
            ] {
                let denoised = denoiser.denoise(&noisy, guides).expect("denoised");
                let error = |image| compare(image, &clean).expect("of one size").rel_mse;
                assert!(error(&denoised) < error(&noisy) / 50.0, "{} of {}", error(&denoised), error(&noisy));
            }
        }

        #[test]
        fn guides_of_another_size_are_an_error_and_nothing_stays_nothing() {
            let denoiser = Denoiser::new().expect("the library is there");
            let small = Image::new(2, 2);
            let guides = Guides { albedo: Some(&small), normal: None };
            denoiser.denoise(&Image::new(3, 2), guides).expect_err("of two sizes");
            let nothing = Image::new(0, 0);
            assert_eq!(denoiser.denoise(&nothing, Guides::default()).expect("nothing to do"), nothing);
        }
    }
}
