//! Material libraries of Wavefront OBJ.

use crate::error::{Place, Warning};

use super::obj::{Source, decode};
use super::warn;

/// A picture that replaces or scales a number of a material.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Map {
    pub file: String,
    /// `-s`, `-o`: factor and offset of the texture coordinates.
    pub scale: [f32; 2],
    pub offset: [f32; 2],
    /// `-clamp on`: nothing outside the unit square.
    pub clamp: bool,
    /// `-bm`: factor of a bump map.
    pub strength: f32,
    /// `-imfchan m`: the opacity is meant.
    pub alpha: bool,
}

/// A material as the file gives it.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Material {
    pub name: String,
    pub place: Option<Place>,
    pub diffuse: Option<[f32; 3]>,
    pub specular: Option<[f32; 3]>,
    pub emission: Option<[f32; 3]>,
    pub filter: Option<[f32; 3]>,
    pub exponent: Option<f32>,
    pub ior: Option<f32>,
    pub opacity: Option<f32>,
    pub illumination: Option<u32>,
    /// Of the extension for physically based rendering.
    pub roughness: Option<f32>,
    pub metallic: Option<f32>,
    pub map_diffuse: Option<Map>,
    pub map_specular: Option<Map>,
    pub map_emission: Option<Map>,
    pub map_opacity: Option<Map>,
    pub bump: Option<Map>,
    pub normal: Option<Map>,
}

/// Reads the library `name`, whose content is `bytes`. What cannot be read is a warning, as there is always a way to
/// go on.
pub(super) fn read(name: &str, bytes: &[u8]) -> (Vec<Material>, Vec<Warning>) {
    let text = decode(bytes);
    let source = Source::new(name, &text);
    let mut materials: Vec<Material> = Vec::new();
    let mut warnings = Vec::new();
    let visited = source.statements(|words| {
        let key = words[0];
        if key == "newmtl" {
            let place = Some(source.place(key));
            materials.push(Material { name: words[1..].join(" "), place, ..Material::default() });
            return Ok(());
        }
        let Some(material) = materials.last_mut() else {
            let message = format!("'{key}' stands before the first 'newmtl' and is ignored");
            warn(&mut warnings, || source.error(key, message));
            return Ok(());
        };
        if let Err(message) = material.set(key, &words[1..]) {
            warn(&mut warnings, || source.error(key, message));
        }
        Ok(())
    });
    warnings.extend(visited.err());
    (materials, warnings)
}

impl Material {
    /// Takes one statement, or says what is wrong with it.
    fn set(&mut self, key: &str, words: &[&str]) -> Result<(), String> {
        match key.to_ascii_lowercase().as_str() {
            "kd" => self.diffuse = Some(color(key, words)?),
            "ks" => self.specular = Some(color(key, words)?),
            "ke" => self.emission = Some(color(key, words)?),
            "tf" => self.filter = Some(color(key, words)?),
            "ns" => self.exponent = Some(number(key, words)?),
            "ni" => self.ior = Some(number(key, words)?),
            "d" => self.opacity = Some(number(key, words.strip_prefix(&["-halo"]).unwrap_or(words))?),
            // The same the other way round; `d` wins where both stand.
            "tr" => {
                let transparency = number(key, words)?;
                self.opacity.get_or_insert(1.0 - transparency);
            }
            "illum" => self.illumination = Some(number(key, words)?.max(0.0) as u32),
            "pr" => self.roughness = Some(number(key, words)?),
            "pm" => self.metallic = Some(number(key, words)?),
            "map_kd" => self.map_diffuse = Some(map(key, words)?),
            "map_ks" => self.map_specular = Some(map(key, words)?),
            "map_ke" => self.map_emission = Some(map(key, words)?),
            "map_d" => self.map_opacity = Some(map(key, words)?),
            "map_bump" | "bump" => self.bump = Some(map(key, words)?),
            "norm" | "map_kn" => self.normal = Some(map(key, words)?),
            // Ambient light, which we compute; sharpness; what renderers of other times needed.
            "ka" | "km" | "sharpness" | "map_ka" | "map_aat" | "map_ns" | "ps" | "pc" | "pcr" | "aniso" | "anisor" => {}
            _ => return Err(format!("'{key}' is not supported and is ignored")),
        }
        Ok(())
    }
}

fn number(key: &str, words: &[&str]) -> Result<f32, String> {
    let word = words.first().ok_or_else(|| format!("'{key}' has no value"))?;
    match word.parse::<f32>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(format!("'{word}' of '{key}' is not a number: it is ignored")),
    }
}

/// One number for all channels, or three.
fn color(key: &str, words: &[&str]) -> Result<[f32; 3], String> {
    if matches!(words.first(), Some(&"spectral" | &"xyz")) {
        return Err(format!("'{key} {}' is not supported and is ignored", words[0]));
    }
    let first = number(key, words)?;
    match words.len() {
        1 | 2 => Ok([first; 3]),
        _ => Ok([first, number(key, &words[1..])?, number(key, &words[2..])?]),
    }
}

/// A file name, perhaps with blanks, after options.
fn map(key: &str, mut words: &[&str]) -> Result<Map, String> {
    let mut map = Map { scale: [1.0; 2], strength: 1.0, ..Map::default() };
    while let [option, rest @ ..] = words
        && option.starts_with('-')
        && rest.len() > 1
    {
        // How many words belong to an option: numbers may be left out at the end of a triple.
        let numbers = rest.iter().take(3).take_while(|word| word.parse::<f32>().is_ok()).count().min(rest.len() - 1);
        let value = |index: usize, default: f32| match rest[..numbers].get(index) {
            Some(word) => word.parse().ok().filter(|value: &f32| value.is_finite()).unwrap_or(default),
            None => default,
        };
        let taken = match *option {
            "-s" => {
                map.scale = [value(0, 1.0), value(1, 1.0)];
                numbers
            }
            "-o" => {
                map.offset = [value(0, 0.0), value(1, 0.0)];
                numbers
            }
            "-t" => numbers,
            "-mm" => numbers.min(2),
            "-bm" => {
                map.strength = value(0, 1.0);
                1
            }
            "-clamp" => {
                map.clamp = rest[0] == "on";
                1
            }
            "-imfchan" => {
                map.alpha = rest[0] == "m";
                1
            }
            _ => 1,
        };
        words = &rest[taken..];
    }
    match words.is_empty() {
        true => Err(format!("'{key}' has no file")),
        false => Ok(Map { file: words.join(" ").replace('\\', "/"), ..map }),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const TEXT: &str = "# a library\nnewmtl red wall\n\tKd 1 0 .5\n  Ks 0.5\nNs 32\nd 0.25\nTr 0.9\nillum 7\nTf 1 1 0.5\n\
        map_Kd -s 2 3 1 -o 0.5 -clamp on tex\\my wall.png\nbump -bm 0.2 b.png\nNi x\nfrobnicate 3\nKe spectral a.rfl\n";

    #[test]
    fn a_material_is_read_with_its_maps() {
        let (materials, warnings) = read("a.mtl", TEXT.as_bytes());
        let [material] = &materials[..] else { panic!("one material") };
        assert_eq!((material.name.as_str(), material.diffuse), ("red wall", Some([1.0, 0.0, 0.5])));
        assert_eq!((material.specular, material.exponent), (Some([0.5; 3]), Some(32.0)));
        assert_eq!((material.opacity, material.illumination), (Some(0.25), Some(7)));
        let map = material.map_diffuse.clone().expect("a map");
        assert_eq!((map.file.as_str(), map.scale, map.offset), ("tex/my wall.png", [2.0, 3.0], [0.5, 0.0]));
        assert!(map.clamp);
        assert_eq!(material.bump.as_ref().map(|map| map.strength), Some(0.2));
        let messages: Vec<String> = warnings.iter().map(ToString::to_string).collect();
        assert_eq!(
            messages,
            [
                "a.mtl:12:1: 'x' of 'Ni' is not a number: it is ignored",
                "a.mtl:13:1: 'frobnicate' is not supported and is ignored",
                "a.mtl:14:1: 'Ke spectral' is not supported and is ignored"
            ]
        );
    }

    proptest! {
        #[test]
        fn damaged_libraries_never_panic(at in any::<prop::sample::Index>(), text in "[ -~]{0,6}|\\\\|-s|\n") {
            let mut damaged = TEXT.to_string();
            damaged.insert_str(at.index(TEXT.len()), &text);
            read("a.mtl", damaged.as_bytes());
        }
    }
}
