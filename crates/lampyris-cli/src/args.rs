//! The command line as typed: what can be said, and which values make sense on their own. Whether they fit the
//! scene is for the library to tell.

mod transient;
mod values;

use std::num::{NonZeroU32, NonZeroUsize};
use std::ops::Range;
use std::path::PathBuf;
use std::time::Duration;

use clap::{Args, Parser, Subcommand};
use clap_complete::Shell;
use lampyris::film::Layers;

pub use transient::{Length, PulseShape, TransientArguments, length};
use values::{duration, finite, layers, memory, pair, pass_range, positive_count, preview, share, size, threads};

/// A photon-mapping renderer: caustics, colour bleeding, and a picture that converges.
#[derive(Debug, Parser)]
#[command(name = "lampyris", version, subcommand_required = true, arg_required_else_help = true)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Render a scene.
    Render(RenderArguments),
    /// Add up films of one render with different passes.
    Merge(MergeArguments),
    /// Write the photon map of a scene as a coloured point cloud.
    Photons(PhotonsArguments),
    /// Take the noise out of a picture or film.
    Denoise(DenoiseArguments),
    /// Tell what is in a scene: shapes, triangles, materials, lights, warnings.
    Info(SceneArguments),
    /// Check a scene without rendering it.
    Check(SceneArguments),
    /// Write a scene of any format as a scene file of our own.
    Convert(ConvertArguments),
    /// Bring a picture into the range of a display.
    Tonemap(TonemapArguments),
    /// Measure how far two pictures are apart.
    Compare(CompareArguments),
    /// Make films, pictures, tables and measurements of light by time.
    Transient(TransientArguments),
    /// Print completions for a shell, to be put where it looks for them.
    Completions(CompletionsArguments),
    /// Write man pages.
    Man(ManArguments),
    /// Print the JSON Schema of scene files.
    #[command(hide = true)]
    Schema,
}

/// A scene file and how to read it.
#[derive(Args, Debug)]
pub struct SceneArguments {
    /// The scene file: .toml, .xml of Mitsuba, .pbrt, .gltf, .glb, .obj, .ply or .stl
    pub scene: PathBuf,

    /// Give a parameter of a Mitsuba scene (its <default>) another value
    #[arg(short = 'D', long = "define", value_name = "NAME=VALUE", value_parser = pair)]
    pub defines: Vec<(String, String)>,

    /// Fail on warnings, such as a feature of the file that is not supported
    #[arg(long)]
    pub strict: bool,
}

/// What to write instead of a scene file.
#[derive(Args, Debug)]
pub struct ConvertArguments {
    #[command(flatten)]
    pub scene: SceneArguments,

    /// The file to write, .toml; meshes and pictures that lie inside the scene file are written beside it
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
}

/// What to change in the scene.
#[derive(Args, Debug)]
pub struct ChangeArguments {
    /// Set one parameter of the integrator, the film or the camera, such as kernel=cone; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = pair)]
    pub settings: Vec<(String, String)>,

    /// Seed of all random numbers [default: the scene's, or 0]
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
}

/// How to work.
#[derive(Args, Debug)]
pub struct WorkArguments {
    /// Threads to work with; the picture is the same for any number [default: one for each core]
    #[arg(long, value_name = "N", value_parser = threads, allow_negative_numbers = true)]
    pub threads: Option<NonZeroUsize>,

    /// Say nothing but errors
    #[arg(short, long)]
    pub quiet: bool,
}

/// `lampyris render`.
#[derive(Args, Debug)]
pub struct RenderArguments {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArguments,

    /// Where to write the picture: .png .ppm .pfm .hdr .exr or .npy; may be repeated [default: the scene's name
    /// with .png]
    #[arg(short, long = "output", value_name = "FILE")]
    pub outputs: Vec<PathBuf>,

    /// auto, photon-map, path or light [default: the scene's, or auto]
    #[arg(long, value_name = "NAME")]
    pub integrator: Option<String>,

    /// Number of passes [default: the scene's, or enough for a good quick picture]
    #[arg(long, value_name = "N", value_parser = positive_count, allow_negative_numbers = true, conflicts_with = "time")]
    pub passes: Option<NonZeroU32>,

    /// Render for this time, such as 60s, 1.5m or 500ms, and to the end of the pass under way then
    #[arg(long, value_name = "TIME", value_parser = duration, allow_hyphen_values = true)]
    pub time: Option<Duration>,

    /// Render until the picture's relative standard error is no more than this, such as 1% or 0.01
    #[arg(long, value_name = "ERROR", value_parser = share, allow_hyphen_values = true)]
    pub target_error: Option<f64>,

    /// Render these passes, from A to before B, counted from 0; to be merged with others
    #[arg(long, value_name = "A..B", value_parser = pass_range, allow_hyphen_values = true, conflicts_with = "passes")]
    pub pass_range: Option<Range<u32>>,

    /// Keep the film in this file, from time to time, at the end and at Ctrl-C
    #[arg(long, value_name = "FILE.film")]
    pub checkpoint: Option<PathBuf>,

    /// How often to write it [default: 60s]
    #[arg(long, value_name = "TIME", value_parser = duration, allow_hyphen_values = true)]
    pub checkpoint_every: Option<Duration>,

    /// Go on with the film in this file, and keep it there unless --checkpoint names another
    #[arg(long, value_name = "FILE.film")]
    pub resume: Option<PathBuf>,

    /// Memory that a film with time may take, such as 4GB; what takes more is kept in a file beside the first FILE while it is
    /// rendered, or beside the film [default: half of what is free]
    #[arg(long, value_name = "SIZE", value_parser = memory, allow_hyphen_values = true)]
    pub memory: Option<u64>,

    /// Width and height of the picture in pixels
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = size, allow_hyphen_values = true)]
    pub size: Option<[u32; 2]>,

    /// Show the picture as it grows: in a running tev, here or at HOST:PORT, or in the terminal; may be repeated
    #[arg(long, visible_alias = "display-server", value_name = "tev|HOST:PORT|terminal", value_parser = preview,
        num_args = 0..=1, default_missing_value = "tev")]
    pub preview: Vec<PreviewTarget>,

    /// Write the picture so far after 1, 2, 4, 8 ... passes, too, beside the first FILE as NAME.pass0001.png and so on
    #[arg(long)]
    pub snapshots: bool,

    /// Layers of .exr files: all, none, or some of
    /// albedo,normal,depth,position,direct,indirect,caustic,emission,variance,samples
    /// [default: all]
    #[arg(long, value_name = "NAMES", value_parser = layers)]
    pub layers: Option<Layers>,

    /// Take the noise out of the finished picture, by its layers albedo and normal; an .exr file keeps the layer noisy.
    /// Needs a build with the feature denoise
    #[arg(long)]
    pub denoise: bool,

    /// Write what the render did (passes, rays, photons, seconds, memory) to this file, as JSON
    #[arg(long, value_name = "FILE")]
    pub stats: Option<PathBuf>,

    /// Changes to the scene.
    #[command(flatten)]
    pub changes: ChangeArguments,

    /// How to work.
    #[command(flatten)]
    pub work: WorkArguments,
}

/// Where a picture is shown as it grows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PreviewTarget {
    /// In tev, at this address.
    Tev(String),
    /// In the terminal.
    Terminal,
}

/// `lampyris merge`.
#[derive(Args, Debug)]
pub struct MergeArguments {
    /// The films, each with other passes of the same render
    #[arg(required = true, value_name = "FILE.film")]
    pub films: Vec<PathBuf>,

    /// Where to write the sum: .film, or a picture: .png .ppm .pfm .hdr .exr or .npy; may be repeated
    #[arg(short, long = "output", value_name = "FILE", required = true)]
    pub outputs: Vec<PathBuf>,

    /// Memory that a film with time may take, such as 4GB; what takes more is kept in a file beside the first FILE
    /// [default: half of what is free]
    #[arg(long, value_name = "SIZE", value_parser = memory, allow_hyphen_values = true)]
    pub memory: Option<u64>,
}

/// `lampyris denoise`.
#[derive(Args, Debug)]
pub struct DenoiseArguments {
    /// The film, or a picture; its layers albedo and normal help where it has them
    pub input: PathBuf,

    /// Where to write the result: .png .ppm .pfm .hdr .exr or .npy; may be repeated
    #[arg(short, long = "output", value_name = "FILE", required = true)]
    pub outputs: Vec<PathBuf>,
}

/// `lampyris completions`.
#[derive(Args, Debug)]
pub struct CompletionsArguments {
    /// The shell
    pub shell: Shell,
}

/// `lampyris man`.
#[derive(Args, Debug)]
pub struct ManArguments {
    /// The folder to write them to
    #[arg(short, long, value_name = "FOLDER")]
    pub output: PathBuf,
}

/// `lampyris photons`.
#[derive(Args, Debug)]
pub struct PhotonsArguments {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArguments,

    /// Where to write the photons: .ply or .csv
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,

    /// Changes to the scene.
    #[command(flatten)]
    pub changes: ChangeArguments,

    /// How to work.
    #[command(flatten)]
    pub work: WorkArguments,
}

/// `lampyris tonemap`.
#[derive(Args, Debug)]
pub struct TonemapArguments {
    /// The picture, in any format that `render` writes, or a film
    pub input: PathBuf,

    /// Where to write the result
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,

    /// Take this layer of an .exr file or a film, such as albedo, instead of the picture
    #[arg(long, value_name = "NAME")]
    pub layer: Option<String>,

    /// clamp, equalize, equalize-clamp, gamma, gamma-clamp, reinhard, reinhard-local or filmic
    #[arg(long, value_name = "NAME", default_value = "reinhard")]
    pub operator: String,

    /// Stops by which to brighten the picture: each doubles the light
    #[arg(long, value_name = "STOPS", value_parser = finite, default_value = "0", allow_negative_numbers = true)]
    pub exposure: f32,

    /// gamma, gamma-clamp: the exponent's inverse
    #[arg(long, value_parser = finite, allow_negative_numbers = true)]
    pub gamma: Option<f32>,

    /// equalize-clamp, gamma-clamp: the radiance that becomes white
    #[arg(long, value_parser = finite, allow_negative_numbers = true)]
    pub value: Option<f32>,

    /// reinhard, reinhard-local: what the average becomes, 0.18 for middle grey
    #[arg(long, value_parser = finite, allow_negative_numbers = true)]
    pub key: Option<f32>,

    /// reinhard: the scaled luminance that becomes white
    #[arg(long, value_parser = finite, allow_negative_numbers = true)]
    pub white: Option<f32>,

    /// reinhard-local: the sharpening
    #[arg(long, value_parser = finite, allow_negative_numbers = true)]
    pub phi: Option<f32>,

    /// reinhard-local: the contrast that ends a pixel's surroundings
    #[arg(long, value_parser = finite, allow_negative_numbers = true)]
    pub epsilon: Option<f32>,
}

/// `lampyris compare`.
#[derive(Args, Debug)]
pub struct CompareArguments {
    /// The picture
    pub image: PathBuf,

    /// What it should be
    pub reference: PathBuf,

    /// Where to write the difference as a picture
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

#[cfg(test)]
mod tests;
