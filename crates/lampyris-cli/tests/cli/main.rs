//! The program as a user runs it: files and arguments in, files, words and an exit code out.

#![allow(clippy::expect_used, reason = "tests")]

mod convert;
mod denoising;
mod films;
mod interrupt;
mod odd_files;
mod pictures;
mod previews;
mod refusals;
mod transient;

use std::path::{Path, PathBuf};

use assert_cmd::Command;

/// A floor and a glass ball under a point light, small enough for milliseconds.
pub(crate) const SCENE: &str = r#"[camera]
origin = [0, 1, -4]
target = [0, 0.5, 0]

[film]
size = [8, 6]

[integrator]
type = "photon-map"
photons = 300
k = 10

[render]
passes = 2

[[shapes]]
type = "quad"
corner = [-3, 0, -3]
u = [0, 0, 6]
v = [6, 0, 0]
material = { type = "diffuse", reflectance = 0.7 }

[[shapes]]
type = "sphere"
center = [0, 1, 0]
radius = 0.5
material = { type = "glass" }

[[lights]]
type = "point"
position = [0, 3, 0]
power = 100
"#;

/// A ball before a wall, of which a laser lights a point.
pub(crate) const WALL: &str = "camera = { origin = [0, 0, 1], capture = { wall = 'wall', mode = 'single' } }
film = { size = [4, 3], time = { bins = 5, start = 1, bin-width = 0.5, layers = ['direct'] } }
integrator = { type = 'path' }
lights = [{ type = 'laser', position = [1, 0, 1], target = [0.3, 0.2, 0] }]
shapes = [
    { type = 'quad', corner = [-1, -1, 0], u = [2, 0, 0], v = [0, 2, 0], name = 'wall' },
    { type = 'sphere', center = [0, 0, 1.5] },
]
";

/// A folder of its own for a test, with the program run inside it.
pub(crate) struct Folder(tempfile::TempDir);

impl Folder {
    /// With `scene.toml` in it.
    pub(crate) fn with_scene(scene: &str) -> Folder {
        let folder = Folder(tempfile::tempdir().expect("a folder"));
        folder.write("scene.toml", scene);
        folder
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), content).expect("a file");
    }

    pub(crate) fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// The names of the files in it, hidden ones too.
    pub(crate) fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.path()).expect("a folder");
        let mut names: Vec<String> =
            entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    /// The program with these arguments, split at spaces.
    pub(crate) fn lampyris(&self, arguments: &str) -> Command {
        let mut command = Command::new(program());
        command.current_dir(self.0.path()).args(arguments.split_whitespace());
        command
    }

    /// Runs it, which must succeed, and returns what it says on the standard output and the standard error.
    pub(crate) fn run(&self, arguments: &str) -> (String, String) {
        let output = self.lampyris(arguments).output().expect("it runs");
        let [stdout, stderr] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).expect("text"));
        assert_eq!(output.status.code(), Some(0), "{arguments}: {stderr}");
        (stdout, stderr)
    }

    /// Runs it, which must be refused: exit code 2, one error, and no file that was not there before. Returns the
    /// message.
    pub(crate) fn refuse(&self, arguments: &str) -> String {
        let before = self.names();
        let output = self.lampyris(arguments).output().expect("it runs");
        let stderr = String::from_utf8(output.stderr).expect("text");
        assert_eq!(output.status.code(), Some(2), "{arguments}: {stderr}");
        assert_eq!(stderr.lines().filter(|line| line.starts_with("error: ")).count(), 1, "{arguments}: {stderr}");
        assert!(output.stdout.is_empty(), "{arguments}: an error on the standard output");
        assert_eq!(self.names(), before, "{arguments} left something behind");
        stderr
    }
}

pub(crate) fn program() -> &'static Path {
    Path::new(env!("CARGO_BIN_EXE_lampyris"))
}
