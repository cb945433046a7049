//! Every reader under a name, fed with bytes from memory: what the fuzz targets in `fuzz/` and the test of their corpus
//! share. Whatever the bytes are, nothing may panic, hang, or take memory out of proportion to them.

use std::fs;
use std::path::{Path, PathBuf};

use lampyris::checkpoint::Checkpoint;
use lampyris::compare::{compare, difference_image};
use lampyris::error::{Error, Result};
use lampyris::film::Layer;
use lampyris::image::Image;
use lampyris::import::load::{LoadOptions, load};
use lampyris::import::{Files, Imported};
use lampyris::integrator::Silent;
use lampyris::output::{
    Format, decode, decode_texture, encode, encode_tal, profile_csv, profile_svg, read_layer, read_transient,
};
use lampyris::render::Render;
use lampyris::scene::build;
use lampyris::scene::description::{CameraDescription, FilterDescription, IntegratorDescription, SceneDescription};
use lampyris::tonemap::ToneMap;
use lampyris::transient::{Pulse, Spad, TimeLayer, TimeOfFlight, Timing};

/// The readers, by the names of their fuzz targets and of the folders of their corpora.
pub const READERS: [&str; 15] = [
    "toml",
    "mitsuba",
    "pbrt",
    "gltf",
    "obj",
    "ply",
    "stl",
    "serialized",
    "vol",
    "texture",
    "picture",
    "film",
    "spectrum",
    "settings",
    "transient",
];

/// A folder with the files that hostile ones may name, and into which they are written themselves.
pub struct Workbench {
    folder: PathBuf,
}

impl Workbench {
    /// Lays out the companions of scene files in `folder`: a mesh and a picture in each format that a few bytes hold.
    ///
    /// # Errors
    /// What the operating system says.
    pub fn new(folder: &Path) -> std::io::Result<Workbench> {
        let bench = Workbench { folder: folder.to_path_buf() };
        bench.write("m.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n")?;
        bench.write("m.ply", PLY.as_bytes())?;
        bench.write(
            "m.stl",
            b"solid a\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n",
        )?;
        bench.write("t.ppm", b"P3 2 2 255 255 0 0 0 255 0 0 0 255 9 99 200\n")?;
        bench.write("t.pfm", b"Pf\n2 1\n-1.0\n\0\0\0\x3f\0\0\x80\x40")?;
        bench.write("s.spd", b"400 0.1\n500 0.7\n600 0.3\n")?;
        Ok(bench)
    }

    /// Feeds `bytes` to `reader`, and what it makes of them to all that comes after: a scene is built and rendered at
    /// a small size, a picture mapped, compared and written.
    ///
    /// # Errors
    /// What is wrong with the bytes, as a user would be told.
    ///
    /// # Panics
    /// Where something is wrong with the reader, or `reader` is not one of [`READERS`].
    pub fn feed(&self, reader: &str, bytes: &[u8]) -> Result<()> {
        match reader {
            "toml" => self.scene("a.toml", bytes),
            "mitsuba" => self.scene_with("a.xml", "b.xml", bytes),
            "pbrt" => self.scene_with("a.pbrt", "b.pbrt", bytes),
            "gltf" if bytes.starts_with(b"glTF") => self.scene("a.glb", bytes),
            "gltf" => self.scene_with("a.gltf", "b.bin", bytes),
            "obj" => self.scene_with("a.obj", "a.mtl", bytes),
            "ply" => self.scene("a.ply", bytes),
            "stl" => self.scene("a.stl", bytes),
            "serialized" => self.used("a.serialized", bytes, SERIALIZED_USER),
            "vol" => self.used("a.vol", bytes, VOL_USER),
            "spectrum" => self.used("a.spd", bytes, SPECTRUM_USER),
            "texture" => self.texture(bytes),
            "picture" => self.picture(bytes),
            "film" => film(bytes),
            "settings" => settings(bytes),
            "transient" => self.transient(bytes),
            other => panic!("there is no reader '{other}'"),
        }
    }

    /// Two files in one, parted by a byte 0, which text has nowhere: the second is for the first to name.
    fn scene_with(&self, first: &str, second: &str, bytes: &[u8]) -> Result<()> {
        let mut parts = bytes.splitn(2, |&byte| byte == 0);
        let (one, two) = (parts.next().unwrap_or_default(), parts.next().unwrap_or_default());
        self.put(second, two)?;
        self.scene(first, one)
    }

    fn scene(&self, name: &str, bytes: &[u8]) -> Result<()> {
        self.put(name, bytes)?;
        self.render(load(&self.folder.join(name), &LoadOptions::default())?)
    }

    /// A file that a sound scene names.
    fn used(&self, name: &str, bytes: &[u8], user: &str) -> Result<()> {
        self.put(name, bytes)?;
        self.scene("user.xml", user.as_bytes())
    }

    /// As bitmap, map of normals and roughness, opacity and surroundings of a scene.
    fn texture(&self, bytes: &[u8]) -> Result<()> {
        // Only the ending tells a TGA file.
        decode_texture("a.tga", bytes, true)?;
        self.used("a.tga", bytes, TEXTURE_USER)
    }

    fn picture(&self, bytes: &[u8]) -> Result<()> {
        let image = decode("a.tga", bytes)?;
        self.put("a.exr", bytes)?;
        for layer in ["albedo", "normal", "depth"] {
            let _ = read_layer(&self.folder.join("a.exr"), layer);
        }
        if image.pixels().len() > 1 << 12 {
            return Ok(());
        }
        ToneMap::ALL.iter().for_each(|(_, operator)| drop(operator.apply(&image, 1.0)));
        for format in [Format::Exr, Format::Hdr, Format::Npy, Format::Pfm, Format::Png, Format::Ppm] {
            let _ = encode(format, &image).and_then(|bytes| decode("a", &bytes));
        }
        let black = Image::new(image.width(), image.height());
        for (one, other) in [(&image, &image), (&image, &black), (&black, &image)] {
            let _ = compare(one, other);
            let _ = difference_image(one, other);
        }
        Ok(())
    }

    /// Light by time: an archive, what stands beside an array (of three pixels by two with four bins), or an array.
    fn transient(&self, bytes: &[u8]) -> Result<()> {
        let array = self.folder.join("a.npy");
        let transient = match bytes {
            [b'P', b'K', ..] => {
                self.put("a.npz", bytes)?;
                let archive = self.folder.join("a.npz");
                read_transient(&archive, None, None)
                    .or_else(|_| read_transient(&archive, None, Some(Timing::new(0.0, 1.0))))?
            }
            [b'{', ..] => {
                self.put("a.npy", LIGHT_BY_TIME)?;
                self.put("a.json", bytes)?;
                read_transient(&array, None, None)?
            }
            _ => {
                let _ = fs::remove_file(self.folder.join("a.json"));
                self.put("a.npy", bytes)?;
                read_transient(&array, None, Some(Timing::new(-1.0, 0.1)))?
            }
        };
        if transient.values().len() > 1 << 12 {
            return Ok(());
        }
        let _ = (transient.steady(), transient.gated(0.1, 0.35), transient.rainbow(transient.quantile(0.5)));
        let _ = (transient.streak_of_row(0), transient.streak_of_column(0), transient.peak_lengths());
        let _ = (profile_csv(&transient, 0, 0), profile_svg(&transient, 0, 0), encode_tal(&transient));
        let _ = TimeOfFlight { wavelength: 1.0, contrast: 1.0 }.depths(&transient);
        let _ = transient.convolved(&Pulse::ModifiedGaussian { sigma: 0.2, tail: 0.1 });
        let _ = transient.phasors(&[0.0, 2.5]);
        let _ = Spad::default().estimate(&transient);
        Spad::default().count(&transient, 0).map(drop)
    }

    /// Builds the scene and renders a little of it with two integrators.
    fn render(&self, mut imported: Imported) -> Result<()> {
        let files = Files::beside(&self.folder.join("a")).with_embedded(std::mem::take(&mut imported.embedded));
        imported.description.check_settings()?;
        make_small(&mut imported.description);
        let built = build(&imported.description, &files).map_err(|error| imported.places.locate(error))?;
        let path = IntegratorDescription::Path(Default::default());
        let given = std::mem::replace(&mut imported.description.integrator, path);
        Render::new(&built.scene, &imported.description, &Silent).step(&Silent);
        imported.description.integrator = given;
        make_small(&mut imported.description);
        Render::new(&built.scene, &imported.description, &Silent).step(&Silent);
        Ok(())
    }

    fn put(&self, name: &str, bytes: &[u8]) -> Result<()> {
        self.write(name, bytes).map_err(|error| Error::io(self.folder.join(name), "write", &error))
    }

    fn write(&self, name: &str, bytes: &[u8]) -> std::io::Result<()> {
        fs::write(self.folder.join(name), bytes)
    }
}

/// An array of NumPy of shape (2, 3, 4), dark.
const LIGHT_BY_TIME: &[u8] = &{
    let header = *b"\x93NUMPY\x01\x00\x42\x00{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3, 4), }   \n";
    let mut bytes = [0; 76 + 96];
    let mut at = 0;
    while at < header.len() {
        bytes[at] = header[at];
        at += 1;
    }
    bytes
};

/// A film without its checksum, which would keep most changes out.
fn film(bytes: &[u8]) -> Result<()> {
    let sealed = [bytes, &crc32fast::hash(bytes).to_le_bytes()].concat();
    let mut film = Checkpoint::decode(&sealed)?;
    let read = film.film();
    let _ = (read.image(), read.relative_error(), Layer::ALL.map(|layer| read.layer(layer)));
    let _ = (read.bins(0), read.outside_bins(0), read.variance_of_bins(0), read.share_outside_bins());
    for layer in [None, Some(TimeLayer::MoreBounces)] {
        let _ = (read.transient(layer), read.phasors(layer));
    }
    Checkpoint::read_picture(&mut sealed.as_slice(), sealed.len() as u64)?;
    let _ = film.merge(&film.clone());
    Checkpoint::decode(&film.encode()).map(drop)
}

/// One `key = value` a line, as `--set` gives them.
fn settings(bytes: &[u8]) -> Result<()> {
    let text = String::from_utf8_lossy(bytes);
    let camera = CameraDescription { target: Some([0.0; 3]), origin: [0.0, 0.0, 4.0], ..CameraDescription::default() };
    let mut description = SceneDescription { camera: Some(camera), ..SceneDescription::default() };
    for line in text.lines() {
        if let Some((key, value)) = line.split_once('=') {
            description.set(key.trim(), value.trim())?;
        }
    }
    description.check_settings()
}

/// How much work a file asks for is its author's business; what is tested is what it says of the scene.
fn make_small(description: &mut SceneDescription) {
    description.film.size = [4, 4];
    description.film.filter = FilterDescription::default();
    if let Some(time) = &mut description.film.time {
        time.bins = time.bins.min(64);
        time.bounces = time.bounces.map(|bounces| bounces.min(16));
        time.frequencies.truncate(64);
    }
    match &mut description.integrator {
        IntegratorDescription::Auto(settings) => {
            settings.photons = Some(settings.photons.unwrap_or(64).min(64));
            settings.samples = settings.samples.min(2);
            settings.max_bounces = settings.max_bounces.min(16);
        }
        IntegratorDescription::PhotonMap(settings) => {
            settings.photons = settings.photons.min(64);
            settings.samples = settings.samples.min(2);
            settings.k = settings.k.min(16);
            settings.max_bounces = settings.max_bounces.min(16);
        }
        IntegratorDescription::Path(settings) => {
            settings.samples = settings.samples.min(2);
            settings.max_bounces = settings.max_bounces.min(16);
        }
        IntegratorDescription::Light(settings) => {
            settings.photons = settings.photons.map(|photons| photons.min(64));
            settings.max_bounces = settings.max_bounces.min(16);
        }
    }
}

const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z
element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

const SERIALIZED_USER: &str = r#"<scene version="3.0.0"><emitter type="constant"/>
<sensor type="perspective"><transform name="to_world"><lookat origin="0, 0, 4" target="0, 0, 0" up="0, 1, 0"/></transform></sensor>
<shape type="serialized"><string name="filename" value="a.serialized"/></shape>
<shape type="serialized"><string name="filename" value="a.serialized"/><integer name="shape_index" value="1"/></shape>
</scene>"#;

const VOL_USER: &str = r#"<scene version="3.0.0"><emitter type="constant"/>
<sensor type="perspective"><transform name="to_world"><lookat origin="0, 0, 4" target="0, 0, 0" up="0, 1, 0"/></transform></sensor>
<shape type="sphere"><bsdf type="null"/><medium name="interior" type="heterogeneous">
 <volume name="sigma_t" type="gridvolume"><string name="filename" value="a.vol"/></volume>
 <volume name="albedo" type="gridvolume"><string name="filename" value="a.vol"/></volume></medium></shape>
<shape type="cube"><bsdf type="null"/><medium name="interior" type="heterogeneous">
 <volume name="sigma_t" type="gridvolume"><string name="filename" value="a.vol"/><boolean name="use_grid_bbox" value="true"/>
  <string name="filter_type" value="nearest"/></volume></medium></shape>
</scene>"#;

const SPECTRUM_USER: &str = r#"<scene version="3.0.0">
<sensor type="perspective"><transform name="to_world"><lookat origin="0, 0, 4" target="0, 0, 0" up="0, 1, 0"/></transform></sensor>
<emitter type="constant"><spectrum name="radiance" filename="a.spd"/></emitter>
<shape type="sphere"><bsdf type="conductor"><spectrum name="eta" filename="a.spd"/></bsdf></shape>
<shape type="disk"><bsdf type="diffuse"><spectrum name="reflectance" filename="a.spd"/></bsdf></shape>
</scene>"#;

const TEXTURE_USER: &str = r#"<scene version="3.0.0">
<sensor type="perspective"><transform name="to_world"><lookat origin="0, 0, 3" target="0, 0, 0" up="0, 1, 0"/></transform></sensor>
<emitter type="envmap"><string name="filename" value="a.tga"/></emitter>
<shape type="rectangle"><bsdf type="normalmap"><texture type="bitmap"><string name="filename" value="a.tga"/><boolean name="raw" value="true"/></texture>
 <bsdf type="mask"><texture name="opacity" type="bitmap"><string name="filename" value="a.tga"/></texture>
 <bsdf type="diffuse"><texture name="reflectance" type="bitmap"><string name="filename" value="a.tga"/></texture></bsdf></bsdf></bsdf></shape>
<shape type="sphere"><bsdf type="bumpmap"><texture type="bitmap"><string name="filename" value="a.tga"/></texture>
 <bsdf type="roughconductor"><texture name="alpha" type="bitmap"><string name="filename" value="a.tga"/></texture></bsdf></bsdf></shape>
<shape type="disk"><emitter type="area"><texture name="radiance" type="bitmap"><string name="filename" value="a.tga"/></texture></emitter></shape>
</scene>"#;
