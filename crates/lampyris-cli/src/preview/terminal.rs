//! A small picture in the terminal.
//!
//! It is text, as the progress bar below it is, so that both are drawn again in place by the same hand: half blocks, of which
//! each cell shows two pixels in 24-bit colour; characters of growing darkness where colours are not wanted. kitty shows
//! real pixels in place of certain characters, its Unicode placeholders
//! <https://sw.kovidgoyal.net/kitty/graphics-protocol/#unicode-placeholders>.

use std::env;
use std::fmt::Write as _;
use std::io::Write as _;
use std::sync::Arc;

use lampyris::image::{Image, luminance};
use lampyris::spectrum::linear_to_srgb;

use super::Canvas;

/// Cells that the picture fills at most.
const MOST_COLUMNS: usize = 64;
const MOST_ROWS: usize = 24;

/// The height of a cell over its width, about, on all terminals.
const CELL: f64 = 2.0;

/// From black to white.
const SHADES: &[u8] = b" .:-=+*#%@";

/// Pixels of kitty's pictures along a cell's width; the terminal scales them to what its cells really have.
const PIXELS: usize = 8;

/// kitty's characters that stand for the number of a row.
const ROW_MARKS: [char; MOST_ROWS] = [
    '\u{305}', '\u{30d}', '\u{30e}', '\u{310}', '\u{312}', '\u{33d}', '\u{33e}', '\u{33f}', '\u{346}', '\u{34a}',
    '\u{34b}', '\u{34c}', '\u{350}', '\u{351}', '\u{352}', '\u{357}', '\u{35b}', '\u{363}', '\u{364}', '\u{365}',
    '\u{366}', '\u{367}', '\u{368}', '\u{369}',
];

/// How the terminal shows pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drawing {
    /// Two pixels in a cell, in 24-bit colour.
    HalfBlocks,
    /// A character for each shade of grey.
    Shades,
    /// By kitty's graphics protocol, under this number.
    Kitty(u8),
}

/// A terminal that shows a canvas.
#[derive(Debug)]
pub struct Terminal {
    canvas: Arc<Canvas>,
    drawing: Drawing,
}

impl Terminal {
    /// The terminal of the standard error.
    pub fn new(canvas: Arc<Canvas>) -> Terminal {
        let is_set = |name: &str| env::var_os(name).is_some_and(|value| !value.is_empty());
        let is_kitty = is_set("KITTY_WINDOW_ID") || env::var("TERM").is_ok_and(|name| name.contains("kitty"));
        let drawing = Drawing::choose(is_set("NO_COLOR"), is_kitty, std::process::id());
        Terminal { canvas, drawing }
    }

    /// The canvas as lines, each with its end; nothing as long as there is nothing to see. What the terminal must know
    /// beforehand is written to it, which does not move the cursor.
    pub fn draw(&self) -> Option<String> {
        let (rows, columns) = console::Term::stderr().size();
        // The bar needs its lines, and the prompt before it is good to see.
        let most = (usize::from(columns).min(MOST_COLUMNS), usize::from(rows).saturating_sub(4).min(MOST_ROWS));
        let (before, lines) = self.drawing.draw(&self.canvas.image()?, most)?;
        // If it cannot be written, nobody looks.
        let _ = std::io::stderr().write_all(before.as_bytes());
        Some(lines)
    }
}

impl Drawing {
    fn choose(no_colour: bool, is_kitty: bool, process: u32) -> Drawing {
        match (no_colour, is_kitty) {
            (true, _) => Drawing::Shades,
            // Each program its own picture; 0 is none.
            (false, true) => Drawing::Kitty((process % 255) as u8 + 1),
            (false, false) => Drawing::HalfBlocks,
        }
    }

    /// The picture in at most so many columns and rows: what must be written before its lines, and these.
    fn draw(self, image: &Image, most: (usize, usize)) -> Option<(String, String)> {
        let (columns, rows) = fit((image.width(), image.height()), most)?;
        let (mut before, mut lines) = (String::new(), String::new());
        match self {
            Drawing::HalfBlocks => {
                let small = Small::new(image, columns, 2 * rows);
                for row in 0..rows {
                    for column in 0..columns {
                        let [r, g, b] = small.code(column, 2 * row);
                        let _ = write!(lines, "\u{1b}[38;2;{r};{g};{b}");
                        let [r, g, b] = small.code(column, 2 * row + 1);
                        let _ = write!(lines, ";48;2;{r};{g};{b}m▀");
                    }
                    lines.push_str("\u{1b}[0m\n");
                }
            }
            Drawing::Shades => {
                let small = Small::new(image, columns, rows);
                for row in 0..rows {
                    lines.extend((0..columns).map(|column| small.shade(column, row)));
                    lines.push('\n');
                }
            }
            Drawing::Kitty(number) => {
                let small = Small::new(image, PIXELS * columns, PIXELS * CELL as usize * rows);
                before = small.transmission(number, columns, rows);
                for mark in &ROW_MARKS[..rows] {
                    // The first cell says its row and column (the mark of 0); those behind it count on.
                    let _ = write!(lines, "\u{1b}[38;5;{number}m\u{10eeee}{mark}{}", ROW_MARKS[0]);
                    lines.extend(std::iter::repeat_n('\u{10eeee}', columns - 1));
                    lines.push_str("\u{1b}[39m\n");
                }
            }
        }
        Some((before, lines))
    }
}

/// Columns and rows, at most so many, in which a picture of this size keeps its shape.
fn fit((width, height): (usize, usize), (most_columns, most_rows): (usize, usize)) -> Option<(usize, usize)> {
    if width == 0 || height == 0 || most_columns == 0 || most_rows == 0 {
        return None;
    }
    let rows_of_column = height as f64 / width as f64 / CELL;
    let columns = (most_rows as f64 / rows_of_column).min(most_columns as f64);
    let cells = |count: f64, most: usize| (count.round() as usize).clamp(1, most);
    Some((cells(columns, most_columns), cells(columns * rows_of_column, most_rows)))
}

/// A picture made smaller: means of linear light.
struct Small(Image);

impl Small {
    fn new(image: &Image, width: usize, height: usize) -> Small {
        let range = |index: usize, count: usize, of: usize| {
            let first = index * of / count;
            first..((index + 1) * of / count).max(first + 1)
        };
        let mut small = Image::new(width, height);
        for (index, pixel) in small.pixels_mut().iter_mut().enumerate() {
            let (columns, rows) =
                (range(index % width, width, image.width()), range(index / width, height, image.height()));
            let count = (columns.len() * rows.len()) as f32;
            let all = rows.flat_map(|y| columns.clone().map(move |x| (x, y)));
            for [r, g, b] in all.map(|(x, y)| image.pixel(x, y)) {
                *pixel = [pixel[0] + r / count, pixel[1] + g / count, pixel[2] + b / count];
            }
        }
        Small(small)
    }

    /// As a PNG would have it.
    fn code(&self, x: usize, y: usize) -> [u8; 3] {
        self.0.pixel(x, y).map(display)
    }

    fn shade(&self, x: usize, y: usize) -> char {
        let value = usize::from(display(luminance(self.0.pixel(x, y))));
        char::from(SHADES[value * SHADES.len() / 256])
    }

    /// The picture for kitty, to be shown in so many cells wherever their characters stand.
    fn transmission(&self, number: u8, columns: usize, rows: usize) -> String {
        let Small(image) = self;
        let bytes: Vec<u8> = image.pixels().iter().flat_map(|pixel| pixel.map(display)).collect();
        let encoded = base64(&bytes);
        let chunks = encoded.as_bytes().chunks(4096);
        let last = chunks.len().saturating_sub(1);
        let mut all = String::new();
        for (index, chunk) in chunks.enumerate() {
            let more = u8::from(index < last);
            let _ = match index {
                0 => write!(
                    all,
                    "\u{1b}_Ga=T,U=1,q=2,f=24,i={number},s={},v={},c={columns},r={rows},m={more};",
                    image.width(),
                    image.height()
                ),
                _ => write!(all, "\u{1b}_Gm={more},q=2;"),
            };
            all.push_str(&String::from_utf8_lossy(chunk));
            all.push_str("\u{1b}\\");
        }
        all
    }
}

/// The code value of a display.
fn display(radiance: f32) -> u8 {
    // What is no number becomes 0.
    (linear_to_srgb(radiance.clamp(0.0, 1.0)) * 255.0).round() as u8
}

/// RFC 4648.
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let byte = |index: usize| u32::from(group.get(index).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for digit in 0..4 {
            let value = (bits >> (18 - 6 * digit) & 63) as usize;
            text.push(if digit <= group.len() { char::from(DIGITS[value]) } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Black, white; red, and what is no number.
    fn four() -> Image {
        let pixels = vec![[0.0; 3], [2.0; 3], [1.0, 0.0, 0.0], [f32::NAN; 3]];
        Image::from_pixels(2, 2, pixels).expect("four pixels")
    }

    #[test]
    fn half_blocks_show_two_pixels_in_a_cell() {
        let (before, lines) = Drawing::HalfBlocks.draw(&four(), (2, 9)).expect("there is room");
        assert!(before.is_empty());
        let expected = "\u{1b}[38;2;0;0;0;48;2;255;0;0m▀\u{1b}[38;2;255;255;255;48;2;0;0;0m▀\u{1b}[0m\n";
        assert_eq!(lines, expected);
    }

    #[test]
    fn shades_are_characters_without_colour() {
        let grey = Image::from_pixels(4, 2, [0.0, 0.02, 0.2, 1.0].repeat(2).iter().map(|&v| [v; 3]).collect());
        let (before, lines) = Drawing::Shades.draw(&grey.expect("eight pixels"), (4, 9)).expect("there is room");
        assert_eq!((before.as_str(), lines.as_str()), ("", " .=@\n"));
    }

    #[test]
    fn kitty_gets_the_pixels_and_the_places_for_them() {
        let (before, lines) = Drawing::Kitty(7).draw(&four(), (4, 2)).expect("there is room");
        assert!(before.starts_with("\u{1b}_Ga=T,U=1,q=2,f=24,i=7,s=32,v=32,c=4,r=2,m=0;AAAA"), "{before:?}");
        assert!(before.ends_with("\u{1b}\\") && !before.contains('\n'), "the cursor stays where it is");
        let cell = '\u{10eeee}';
        let row = |mark: char| format!("\u{1b}[38;5;7m{cell}{mark}\u{305}{cell}{cell}{cell}\u{1b}[39m\n");
        assert_eq!(lines, row('\u{305}') + &row('\u{30d}'));
    }

    #[test]
    fn long_transmissions_are_cut_into_chunks() {
        let (before, _) = Drawing::Kitty(7).draw(&Image::new(640, 480), (64, 24)).expect("there is room");
        let chunks: Vec<&str> = before.split_terminator("\u{1b}\\").collect();
        assert!(chunks.len() > 2 && chunks.iter().all(|chunk| chunk.len() < 4096 + 80), "{}", chunks.len());
        let (last, others) = chunks.split_last().expect("several");
        assert!(others.iter().all(|chunk| chunk.contains("m=1")) && last.starts_with("\u{1b}_Gm=0,q=2;"));
    }

    #[test]
    fn pictures_keep_their_shape_and_stay_within_the_terminal() {
        assert_eq!(fit((512, 512), (64, 24)), Some((48, 24)));
        assert_eq!(fit((1920, 1080), (64, 24)), Some((64, 18)));
        assert_eq!(fit((10, 4000), (64, 24)), Some((1, 24)));
        assert_eq!(fit((4000, 1), (64, 24)), Some((64, 1)));
        assert_eq!(fit((10, 10), (80, 0)), None);
    }

    #[test]
    fn who_wants_no_colour_gets_none() {
        assert_eq!(Drawing::choose(true, true, 9), Drawing::Shades);
        assert_eq!(Drawing::choose(false, true, 254), Drawing::Kitty(255));
        assert_eq!(Drawing::choose(false, false, 9), Drawing::HalfBlocks);
    }

    #[test]
    fn base64_is_that_of_the_rfc() {
        let encoded = ["", "f", "fo", "foo", "foob", "fooba", "foobar"].map(|text| base64(text.as_bytes()));
        assert_eq!(encoded, ["", "Zg==", "Zm8=", "Zm9v", "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy"]);
    }
}
