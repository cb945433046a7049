//! `lampyris photons`.

use lampyris::error::{Error, Result};
use lampyris::integrator::{Observer, Pass, PhotonMapping, Silent};
use lampyris::output::{check_photons_path, write_photons};
use lampyris::scene::SceneDescription;
use lampyris::scene::description::{BandwidthRule, IntegratorDescription, PhotonMapSettings};

use crate::args::PhotonsArguments;
use crate::format::{plural, time};
use crate::meter::{Meter, Stage};
use crate::progress::{Display, Loading};
use crate::render::pool;
use crate::report::Failure;
use crate::scene::{change, heed, read, ready, warnings};

/// Writes the photon map of a scene's first pass.
///
/// # Errors
/// Whatever is wrong with the scene or the file's place.
pub fn run(arguments: &PhotonsArguments) -> Result<(), Failure> {
    let meter = Meter::start();
    check_photons_path(&arguments.output)?;
    let mut imported = read(&arguments.scene)?;
    imported.description.use_integrator("photon-map")?;
    // The scene may get its direct light from shadow rays; a picture of its photons should have them all.
    imported.description.set("direct", "photons")?;
    change(&mut imported, &arguments.changes)?;
    let pool = pool(arguments.work.threads.map_or(0, usize::from))?;
    let display = Display::new(arguments.work.quiet, false);
    let loading = Loading::new(&meter, &arguments.scene.scene, display.clone());
    let built = pool.install(|| ready(&arguments.scene, &imported, &arguments.changes.settings, &loading));
    display.clear();
    let built = built?;
    heed(&warnings(&arguments.scene, &imported, &built), arguments.scene.strict, arguments.work.quiet)?;

    let description = &imported.description;
    let settings = without_pilot(description)?;
    let pass = Pass { index: 0, seed: description.render.seed };
    display.say(&format!("tracing {} light paths", settings.photons));
    meter.enter(Stage::Photons);
    let map = pool.install(|| {
        PhotonMapping::new(&built.scene, &description.film, settings, pass.seed, &Silent).map(
            &built.scene,
            &pass,
            &meter as &dyn Observer,
        )
    });
    meter.enter(Stage::Write);
    write_photons(&arguments.output, &map)?;
    let photons = plural(map.photons().len(), "photon");
    let caustic = map.photons().iter().filter(|photon| photon.is_caustic()).count();
    let took = time(meter.rendering());
    display.say(&format!("wrote {photons}, {caustic} of them caustic, in {took}: {}", arguments.output.display()));
    Ok(())
}

/// The settings of photon mapping, with a rule that needs no radius: which photons there are does not depend on it.
fn without_pilot(description: &SceneDescription) -> Result<PhotonMapSettings> {
    match &description.integrator {
        IntegratorDescription::PhotonMap(settings) => {
            Ok(PhotonMapSettings { bandwidth: BandwidthRule::Nearest, ..settings.clone() })
        }
        other => Err(Error::new(format!("the integrator {} has no photon map", other.name()))
            .with_hint("leave --set integrator out")),
    }
}
