//! Settings from outside the scene file: one key of the integrator, the film, the camera or the budget at a time.

mod ranges;

use std::borrow::Cow;

use serde::{Deserialize, Serialize};
use serde_json::Value;
use toml::Spanned;
use toml::de::DeValue;

use super::SceneDescription;
use super::description::{
    AutoSettings, CameraDescription, FilmDescription, IntegratorDescription, LightSettings, PathSettings,
    PhotonMapSettings, RenderDescription,
};
use super::notation;
use super::schema::{Fields, Form, Node, Schema};
use crate::error::{Error, Result, did_you_mean};

/// Names that [`SceneDescription::use_integrator`] knows.
pub const INTEGRATORS: [&str; 4] = ["auto", "photon-map", "path", "light"];

/// The parts of a scene that can be set, in the order in which a bare key is looked for.
const SECTIONS: [&str; 4] = ["integrator", "film", "camera", "render"];

impl SceneDescription {
    /// Sets one key of the integrator, the film, the camera or `render`, written bare (`k`, `size`, `fov`) or with
    /// its table (`integrator.k`, `film.filter.radius`), with `-` or `_` in its name. The value is written as in a
    /// scene file, where quotes and the brackets of a list may be left out: `cone`, `640, 480`.
    ///
    /// # Errors
    /// A key that the scene's integrator does not have, or a value of another form or range than the key asks
    /// for; the scene is unchanged then. The errors have no place: it is not the file that is wrong.
    pub fn set(&mut self, key: &str, value: &str) -> Result<()> {
        let key = key.trim().replace('_', "-");
        if key == "integrator" && !value.trim_start().starts_with('{') {
            return self.use_integrator(value.trim());
        }
        let schema = Schema::of_scenes();
        let mut tree = serde_json::to_value(Settings::of(self)).map_err(|error| broken(&key, &error))?;
        let path = full_path(&schema, &tree, &key)?;
        let keys: Vec<&str> = path.split('.').collect();
        let (node, slot) = enter(schema.scene(), &mut tree, &keys, &path)?;
        *slot = parse(node, &path, value.trim())?;
        let settings: Settings = serde_json::from_value(tree).map_err(|error| broken(&key, &error))?;
        match settings.check() {
            Err(Error { key: Some(bad), message, .. }) if bad.starts_with(&path) => return Err(Error::new(message)),
            _ => settings.give_to(self),
        }
        Ok(())
    }

    /// Changes the integrator to `auto`, `photon-map`, `path` or `light` with its default settings, but the `max-bounces`
    /// that the scene asks for and, where both have them, its `samples`. Keeps everything where the scene names
    /// this integrator already.
    ///
    /// # Errors
    /// A name that is not one of [`INTEGRATORS`].
    pub fn use_integrator(&mut self, name: &str) -> Result<()> {
        if name == self.integrator.name() {
            return Ok(());
        }
        let max_bounces = self.integrator.max_bounces();
        let samples = match &self.integrator {
            IntegratorDescription::Auto(settings) => settings.samples,
            IntegratorDescription::PhotonMap(settings) => settings.samples,
            IntegratorDescription::Path(settings) => settings.samples,
            IntegratorDescription::Light(_) => PathSettings::default().samples,
        };
        self.integrator = match name {
            "auto" => IntegratorDescription::Auto(AutoSettings { samples, max_bounces, ..Default::default() }),
            "photon-map" => {
                IntegratorDescription::PhotonMap(PhotonMapSettings { samples, max_bounces, ..Default::default() })
            }
            "path" => IntegratorDescription::Path(PathSettings { samples, max_bounces, ..Default::default() }),
            "light" => IntegratorDescription::Light(LightSettings { max_bounces, ..Default::default() }),
            other => {
                let error = Error::new(format!("unknown integrator '{other}'"));
                return Err(match did_you_mean(other, INTEGRATORS) {
                    Some(near) => error.with_hint(format!("did you mean '{near}'?")),
                    None => error.with_hint(format!("the integrators are {}", INTEGRATORS.join(", "))),
                });
            }
        };
        Ok(())
    }
}

impl IntegratorDescription {
    /// The name of the integrator, as files write it.
    pub fn name(&self) -> &'static str {
        match self {
            IntegratorDescription::Auto(_) => "auto",
            IntegratorDescription::PhotonMap(_) => "photon-map",
            IntegratorDescription::Path(_) => "path",
            IntegratorDescription::Light(_) => "light",
        }
    }

    /// The longest path, counted in scattering events.
    pub fn max_bounces(&self) -> u32 {
        match self {
            IntegratorDescription::Auto(settings) => settings.max_bounces,
            IntegratorDescription::PhotonMap(settings) => settings.max_bounces,
            IntegratorDescription::Path(settings) => settings.max_bounces,
            IntegratorDescription::Light(settings) => settings.max_bounces,
        }
    }
}

/// What can be set.
#[derive(Serialize, Deserialize)]
struct Settings {
    integrator: IntegratorDescription,
    film: FilmDescription,
    camera: Option<CameraDescription>,
    render: RenderDescription,
}

impl Settings {
    fn of(scene: &SceneDescription) -> Settings {
        Settings {
            integrator: scene.integrator.clone(),
            film: scene.film.clone(),
            camera: scene.camera.clone(),
            render: scene.render.clone(),
        }
    }

    fn give_to(self, scene: &mut SceneDescription) {
        scene.integrator = self.integrator;
        scene.film = self.film;
        scene.camera = self.camera;
        scene.render = self.render;
    }
}

/// A number of the scene itself is such that the settings cannot be read back: infinity or NaN.
fn broken(key: &str, error: &serde_json::Error) -> Error {
    Error::new(format!("cannot set '{key}' in this scene: {error}"))
}

/// The keys of the table in `tree` at `node`, whose type the tree has as the name of its only entry.
fn fields<'s>(node: Node<'s>, tree: &Value) -> Option<(Option<&'s str>, Fields<'s>)> {
    match node.form() {
        Form::Table(fields) => Some((None, fields)),
        Form::Tagged(tagged) => {
            let (name, own) = tagged.variant(tree.as_object()?.keys().next()?)?;
            Some((Some(name), own))
        }
        _ => None,
    }
}

fn section<'s>(schema: &'s Schema, tree: &Value, name: &str) -> Option<Fields<'s>> {
    let Form::Table(sections) = schema.scene().form() else { return None };
    Some(fields(sections.get(name)?, &tree[name])?.1)
}

/// `key` with the section that it belongs to.
fn full_path(schema: &Schema, tree: &Value, key: &str) -> Result<String> {
    let first = key.split('.').next().unwrap_or(key);
    if SECTIONS.contains(&first) {
        return Ok(key.to_string());
    }
    let sections = || SECTIONS.iter().filter_map(|name| Some((*name, section(schema, tree, name)?)));
    match sections().find(|(_, fields)| fields.get(first).is_some()) {
        Some((section, _)) => Ok(format!("{section}.{key}")),
        None => Err(unknown(schema, tree, key, sections().flat_map(|(_, fields)| fields.keys()).collect())),
    }
}

/// The place `keys` below `node`, in the schema and in the tree; `path` is the key in full, for messages.
fn enter<'s, 't>(node: Node<'s>, tree: &'t mut Value, keys: &[&str], path: &str) -> Result<(Node<'s>, &'t mut Value)> {
    let Some((key, rest)) = keys.split_first() else { return Ok((node, tree)) };
    if tree.is_null() && path.starts_with("film.time.") {
        // Whoever sets one of its keys wants time; the other keys have defaults.
        *tree = Value::Object(serde_json::Map::new());
    }
    if tree.is_null() {
        return Err(Error::new(format!("cannot set '{path}': the scene has no camera")));
    }
    let Some((variant, fields)) = fields(node, tree) else {
        return Err(Error::new(format!("unknown setting '{path}'")));
    };
    let Some(node) = fields.get(key) else {
        let error = Error::new(format!("unknown setting '{path}'"));
        let known: Vec<&str> = fields.keys().collect();
        return Err(match did_you_mean(key, known.iter().copied()) {
            Some(near) => error.with_hint(format!("did you mean '{near}'?")),
            None => error.with_hint(format!("the keys there are {}", known.join(", "))),
        });
    };
    let table = match variant {
        Some(name) => &mut tree[name],
        None => tree,
    };
    enter(node, &mut table[*key], rest, path)
}

fn unknown(schema: &Schema, tree: &Value, key: &str, known: Vec<&str>) -> Error {
    let current = tree["integrator"].as_object().and_then(|tree| tree.keys().next()).map_or("", String::as_str);
    if let Some(other) = owner(schema, key) {
        let error = Error::new(format!("'{key}' is a setting of {other}, but the integrator is {current}"));
        return error.with_hint(format!("choose the other with --integrator {other}"));
    }
    let error = Error::new(format!("unknown setting '{key}'"));
    match did_you_mean(key, known.iter().copied()) {
        Some(near) => error.with_hint(format!("did you mean '{near}'?")),
        None => {
            let keys = |name: &str| {
                let known: Vec<&str> =
                    section(schema, tree, name).map(|fields| fields.keys().collect()).unwrap_or_default();
                known.join(", ")
            };
            error.with_hint(format!("{current} has {}; the film has {}", keys("integrator"), keys("film")))
        }
    }
}

/// The integrator that has a setting `key`.
fn owner<'s>(schema: &'s Schema, key: &str) -> Option<&'s str> {
    let Form::Table(sections) = schema.scene().form() else { return None };
    let Form::Tagged(tagged) = sections.get("integrator")?.form() else { return None };
    tagged.variants.iter().find(|(_, fields)| fields.get(key).is_some()).map(|(name, _)| *name)
}

/// The value that `text` writes for the key `path`, in serde's form.
fn parse(node: Node<'_>, path: &str, text: &str) -> Result<Value> {
    let text = completed(&node.form(), text);
    let tree = match DeValue::parse(&text) {
        Ok(tree) => tree,
        Err(_) => Spanned::new(0..text.len(), DeValue::String(Cow::Borrowed(&*text))),
    };
    notation::read(node, path, tree, &mut |_, _| {}).map_err(|fault| fault.error)
}

/// `text` with what TOML asks for and a command line can do without.
fn completed<'t>(form: &Form<'_>, text: &'t str) -> Cow<'t, str> {
    let is_word = !text.is_empty() && text.chars().all(|c| c.is_ascii_alphanumeric() || c == '-');
    match form {
        Form::List(item, _) if !text.starts_with('[') => {
            let form = item.form();
            let items: Vec<_> = text.split(',').map(|item| completed(&form, item.trim())).collect();
            match form {
                Form::Word(_) => format!("[{}]", items.join(", ")).into(),
                _ => format!("[{text}]").into(),
            }
        }
        Form::Tagged(_) if is_word => format!("{{ type = \"{text}\" }}").into(),
        Form::Word(_) | Form::Text if is_word => format!("\"{text}\"").into(),
        // TOML has neither `.5` nor `5.`.
        Form::Number if DeValue::parse(text).is_err() => match text.parse::<f64>() {
            Ok(number) => format!("{number:?}").into(),
            Err(_) => text.into(),
        },
        _ => text.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::description::{BandwidthRule, FilterDescription, FovAxis, KernelName, Show, TimeDescription};
    use crate::transient::Unwarp;

    fn scene() -> SceneDescription {
        let integrator = IntegratorDescription::PhotonMap(PhotonMapSettings::default());
        SceneDescription { camera: Some(CameraDescription::default()), integrator, ..Default::default() }
    }

    fn photon_map(scene: &SceneDescription) -> &PhotonMapSettings {
        match &scene.integrator {
            IntegratorDescription::PhotonMap(settings) => settings,
            other => panic!("the integrator became {other:?}"),
        }
    }

    /// The scene after these settings.
    fn set(settings: &[(&str, &str)]) -> SceneDescription {
        let mut scene = scene();
        for (key, value) in settings {
            scene.set(key, value).unwrap_or_else(|error| panic!("{key}={value}: {error}"));
        }
        scene
    }

    fn fails(key: &str, value: &str, expected: &str) {
        let mut scene = scene();
        let error = scene.set(key, value).expect_err("it must not be set");
        assert_eq!(error.to_string(), expected);
        assert_eq!(scene, self::scene(), "a failed setting changes nothing");
    }

    #[test]
    fn every_setting_of_the_photon_map_can_be_set() {
        let scene = set(&[
            ("photons", "5000"),
            ("samples", "2"),
            ("kernel", "cone"),
            ("bandwidth", "nearest"),
            ("k", "7"),
            ("radius", "1e-3"),
            ("alpha", ".5"),
            ("direct", "photons"),
            ("max_bounces", "9"),
            ("volume", "points"),
            ("volume_radius", "0.25"),
            ("volume_alpha", "0.75"),
            ("show", "caustics"),
        ]);
        assert_eq!(
            *photon_map(&scene),
            PhotonMapSettings {
                photons: 5000,
                samples: 2,
                kernel: KernelName::Cone,
                bandwidth: BandwidthRule::Nearest,
                k: 7,
                radius: Some(1e-3),
                alpha: 0.5,
                direct: crate::scene::description::Direct::Photons,
                max_bounces: 9,
                volume: Some(crate::scene::description::VolumeName::Points),
                volume_radius: Some(0.25),
                volume_alpha: Some(0.75),
                show: Show::Caustics,
            }
        );
    }

    #[test]
    fn a_key_of_time_makes_a_film_with_time() {
        let time =
            set(&[("time.bins", "100"), ("film.time.bin_width", "0.5"), ("time.unwarp", "last-segment")]).film.time;
        let expected =
            TimeDescription { bins: 100, bin_width: Some(0.5), unwarp: Unwarp::LastSegment, ..Default::default() };
        assert_eq!(time, Some(expected));
        let whole = set(&[("time", "{ bins = 3, start-seconds = 1e-9 }")]).film.time.expect("time");
        assert_eq!((whole.bins, whole.start_seconds), (3, Some(1e-9)));
        fails("time.bins", "0", "'bins' must be at least 1");
        fails("time.bin-width", "0", "'bin-width' must be greater than 0 and finite, not 0");
        fails("time.bin", "0", "unknown setting 'film.time.bin'; did you mean 'bins'?");
    }

    #[test]
    fn setting_one_key_keeps_the_others() {
        let scene = set(&[("k", "7"), ("integrator.kernel", "box")]);
        let expected = PhotonMapSettings { k: 7, kernel: KernelName::Box, ..Default::default() };
        assert_eq!(*photon_map(&scene), expected, "in all bits, the thirds of alpha too");
    }

    #[test]
    fn film_camera_and_seed_can_be_set() {
        let scene = set(&[
            ("film.size", "640, 480"),
            ("filter", "tent"),
            ("filter.radius", "2"),
            ("fov", "30"),
            ("camera.fov_axis", "diagonal"),
            ("origin", "[1, 2.5, 3]"),
            ("aperture-radius", "0.1"),
            ("render.seed", "18446744073709551615"),
            ("passes", "3"),
        ]);
        assert_eq!(scene.film.size, [640, 480]);
        assert_eq!(scene.film.filter, FilterDescription::Tent { radius: 2.0 });
        let camera = scene.camera.expect("a camera");
        assert_eq!((camera.fov, camera.fov_axis), (Some(30.0), FovAxis::Diagonal));
        assert_eq!((camera.origin, camera.aperture_radius), ([1.0, 2.5, 3.0], 0.1));
        assert_eq!((scene.render.seed, scene.render.passes), (u64::MAX, Some(3)));
    }

    #[test]
    fn a_filter_may_be_written_in_full() {
        let scene = set(&[("filter", "{ type = \"gaussian\", stddev = 0.7 }")]);
        assert_eq!(scene.film.filter, FilterDescription::Gaussian { stddev: 0.7 });
    }

    #[test]
    fn the_words_true_and_numbers_are_no_kernels() {
        fails(
            "kernel",
            "con",
            "'kernel' must be 'box', 'cone', 'gaussian', 'epanechnikov', 'biweight' or 'cosine', not 'con'; \
             did you mean 'cone'?",
        );
        fails("direct", "true", "'direct' must be 'next-event' or 'photons', not 'true'");
    }

    #[test]
    fn a_wrong_value_is_told_in_the_words_of_a_user() {
        fails("k", "many", "'k' must be a whole number from 0 to 4294967295, not the text \"many\"");
        fails("k", "", "'k' must be a whole number from 0 to 4294967295, not the text \"\"");
        fails("radius", "inf", "'radius' must be a number, not inf");
        fails("size", "640", "'size' must be a list of 2 whole numbers, not 1");
        fails("filter", "sinc", "unknown filter type 'sinc'; the types are box, tent and gaussian");
    }

    #[test]
    fn a_value_out_of_range_is_refused_at_once() {
        fails("k", "0", "'k' must be at least 1");
        fails("film.size", "0, 4", "the picture must be at least 1 pixel wide and high, not 0×4");
    }

    #[test]
    fn an_unknown_key_proposes_the_near_one() {
        fails("kernl", "box", "unknown setting 'kernl'; did you mean 'kernel'?");
        fails("film.sise", "1, 1", "unknown setting 'film.sise'; did you mean 'size'?");
        fails("shapes", "3", "unknown setting 'shapes'; did you mean 'samples'?");
        fails("camera.origin.x", "3", "unknown setting 'camera.origin.x'");
    }

    #[test]
    fn an_unknown_key_far_from_all_lists_them() {
        fails(
            "zzz",
            "3",
            "unknown setting 'zzz'; photon-map has alpha, bandwidth, direct, k, kernel, max-bounces, photons, radius, \
             samples, show, volume, volume-alpha, volume-radius; the film has filter, size, time",
        );
    }

    #[test]
    fn a_key_of_another_integrator_names_it() {
        let mut scene = scene();
        scene.use_integrator("path").expect("a path tracer");
        let error = scene.set("kernel", "box").expect_err("paths have no kernel");
        assert_eq!(error.message, "'kernel' is a setting of photon-map, but the integrator is path");
    }

    #[test]
    fn a_scene_without_camera_has_nothing_to_set_there() {
        let error = SceneDescription::default().set("camera.fov", "3").expect_err("no camera");
        assert_eq!(error.message, "cannot set 'camera.fov': the scene has no camera");
        SceneDescription::default().set("fov", "3").expect_err("no camera");
    }

    #[test]
    fn another_integrator_keeps_the_depth_and_the_samples() {
        let mut scene = set(&[("max-bounces", "5"), ("samples", "4"), ("k", "7")]);
        scene.use_integrator("path").expect("a path tracer");
        assert_eq!(
            scene.integrator,
            IntegratorDescription::Path(PathSettings { samples: 4, max_bounces: 5, ..Default::default() })
        );
        scene.set("integrator", "light").expect("a light tracer");
        assert_eq!(scene.integrator, IntegratorDescription::Light(LightSettings { photons: None, max_bounces: 5 }));
    }

    #[test]
    fn the_same_integrator_keeps_all_its_settings() {
        let mut scene = set(&[("k", "7")]);
        scene.use_integrator("photon-map").expect("as it was");
        assert_eq!(photon_map(&scene).k, 7);
    }

    #[test]
    fn unknown_integrators_are_errors_with_a_way_out() {
        let message = |name: &str| scene().use_integrator(name).expect_err("no such integrator").to_string();
        assert_eq!(message("pat"), "unknown integrator 'pat'; did you mean 'path'?");
        assert_eq!(message("zzz"), "unknown integrator 'zzz'; the integrators are auto, photon-map, path, light");
    }

    #[test]
    fn every_integrator_has_a_name_that_chooses_it() {
        for name in INTEGRATORS {
            let mut scene = scene();
            scene.use_integrator(name).expect("a known name");
            assert_eq!(scene.integrator.name(), name);
        }
    }
}
