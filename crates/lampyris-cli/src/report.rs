//! Errors and warnings as people read them, and results on the standard output.

use std::io::{ErrorKind, Write};
use std::path::Path;

use annotate_snippets::renderer::DEFAULT_TERM_WIDTH;
use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};
use lampyris::error::{Error, Place, Result, Warning};

/// What kept a command from its end: one error, or under `--strict` each of the warnings.
#[derive(Debug)]
pub struct Failure(Vec<Error>);

impl From<Error> for Failure {
    fn from(error: Error) -> Failure {
        Failure(vec![error])
    }
}

impl Failure {
    /// Fails if there are any errors.
    pub fn if_any(errors: Vec<Error>) -> Result<(), Failure> {
        if errors.is_empty() { Ok(()) } else { Err(Failure(errors)) }
    }

    /// Tells the user.
    pub fn report(&self) {
        for error in &self.0 {
            say(&rendered(error, &Level::ERROR));
        }
    }
}

/// Tells the user of a warning.
pub fn warn(warning: &Warning) {
    say(&rendered(warning, &Level::WARNING));
}

/// Writes a line to the standard error. If nobody reads that, there is nobody to tell.
pub fn say(line: &str) {
    let _ = writeln!(anstream::stderr(), "{line}");
}

/// Writes `text` to the standard output. A reader who has seen enough, as `head` has, is no fault.
///
/// # Errors
/// Any other reason why it cannot be written.
pub fn print(text: &str) -> Result<()> {
    let mut stdout = std::io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(Error::new(format!("cannot write to the standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// The message with the line of the file that it is about where we know it, and the hint; in colours, which
/// [`anstream`] takes out where they are not wanted.
fn rendered(error: &Error, level: &Level<'static>) -> String {
    let source = error.place.as_deref().and_then(Source::find);
    let title = level.clone().primary_title(headline(error, source.is_some()));
    let group = match &source {
        Some(source) => title.element(
            Snippet::source(&*source.line)
                .path(source.path.clone())
                .line_start(source.number)
                .annotation(AnnotationKind::Primary.span(source.span.clone())),
        ),
        None => Group::with_title(title),
    };
    let hint = error.hint.as_ref().map(|hint| Group::with_title(Level::HELP.with_name("hint").primary_title(hint)));
    let renderer = Renderer::styled().term_width(DEFAULT_TERM_WIDTH);
    // Apart, for in one report an empty line would come between the two.
    let parts: Vec<String> = [group].into_iter().chain(hint).map(|part| renderer.render(&[part])).collect();
    parts.join("\n")
}

/// What is wrong, and where unless the lines below tell.
fn headline(error: &Error, is_shown: bool) -> String {
    let Error { message, file, place, .. } = error;
    match (place, file) {
        (Some(place), None) if !is_shown => format!("{place}: {message}"),
        // The fault lies in a file that the place names, such as a mesh.
        (Some(place), Some(file)) if *file != place.file => match is_shown {
            true => format!("{}: {message}", file.display()),
            false => format!("{place}: {}: {message}", file.display()),
        },
        (Some(place), Some(_)) if !is_shown => format!("{place}: {message}"),
        (None, Some(file)) => format!("{}: {message}", file.display()),
        _ => message.clone(),
    }
}

/// The line of a file that an error is about.
struct Source {
    path: String,
    line: String,
    number: usize,
    /// The bytes of the line to underline.
    span: std::ops::Range<usize>,
}

/// Larger files are not read again for the sake of a message.
const LARGEST_FILE: u64 = 64 << 20;

/// Longer lines are not shown: they were not written by hand.
const LONGEST_LINE: usize = 2000;

impl Source {
    fn find(place: &Place) -> Option<Source> {
        let bytes = read(&place.file)?;
        let line = bytes.split(|&byte| byte == b'\n').nth(place.line.checked_sub(1)?)?;
        let line = String::from_utf8_lossy(line).trim_end_matches('\r').to_string();
        if line.len() > LONGEST_LINE {
            return None;
        }
        // Found by characters and not by the bytes of the place: the text may have been mended on its way.
        let start = line.char_indices().nth(place.column.checked_sub(1)?).map_or(line.len(), |(at, _)| at);
        let mut end = (start + place.span.len()).min(line.len());
        while !line.is_char_boundary(end) {
            end += 1;
        }
        Some(Source { path: place.file.display().to_string(), number: place.line, line, span: start..end })
    }
}

fn read(file: &Path) -> Option<Vec<u8>> {
    let metadata = std::fs::metadata(file).ok()?;
    (metadata.is_file() && metadata.len() <= LARGEST_FILE).then(|| std::fs::read(file).ok())?
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a terminal without colours shows.
    fn plain(error: &Error) -> String {
        anstream::adapter::strip_str(&rendered(error, &Level::ERROR)).to_string()
    }

    fn file(content: &str) -> (tempfile::TempDir, std::path::PathBuf) {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.toml");
        std::fs::write(&path, content).expect("written");
        (folder, path)
    }

    #[test]
    fn a_place_is_shown_with_its_line_and_underlined() {
        let (_folder, path) = file("x = 1\r\nä = [0, 0]\r\n");
        let place = Place { file: path.clone(), line: 2, column: 5, span: 12..18 };
        let shown = plain(&Error::new("wrong").with_place(place).with_hint("try 3"));
        let expected =
            format!("error: wrong\n --> {}:2:5\n  |\n2 | ä = [0, 0]\n  |     ^^^^^^\nhint: try 3", path.display());
        assert_eq!(shown, expected);
    }

    #[test]
    fn a_place_in_a_file_that_is_gone_is_named() {
        let place = Place { file: "gone.toml".into(), line: 2, column: 5, span: 0..0 };
        assert_eq!(plain(&Error::new("wrong").with_place(place)), "error: gone.toml:2:5: wrong");
    }

    #[test]
    fn a_broken_mesh_is_named_where_the_scene_asks_for_it() {
        let (_folder, path) = file("file = \"a.ply\"\n");
        let place = Place::of(&path, "file = \"a.ply\"\n", 7..14);
        let shown = plain(&Error::new("cut short").with_file("a.ply").with_place(place));
        assert!(shown.starts_with("error: a.ply: cut short\n --> "), "{shown}");
    }

    #[test]
    fn control_characters_do_not_reach_the_terminal() {
        let shown = plain(&Error::new("no '\u{1b}[2J'"));
        assert!(!shown.contains('\u{1b}'), "{shown:?}");
    }

    #[test]
    fn lines_that_no_one_wrote_by_hand_are_left_out() {
        let (_folder, path) = file(&"0 ".repeat(5000));
        let place = Place { file: path.clone(), line: 1, column: 9000, span: 8999..9000 };
        assert_eq!(plain(&Error::new("wrong").with_place(place)), format!("error: {}:1:9000: wrong", path.display()));
    }
}
