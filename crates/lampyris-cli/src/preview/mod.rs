//! The picture while it grows: in tev, in the terminal. Whoever looks slows nobody down: the render leaves its rows on a
//! canvas, and threads of their own take them from there.

mod canvas;
mod terminal;
mod tev;

use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use lampyris::error::Warning;
use lampyris::film::Film;

pub use canvas::Canvas;
pub use terminal::Terminal;

use crate::args::PreviewTarget;
use crate::progress::Display;
use crate::report::say;

/// Everything that shows the picture.
pub struct Preview {
    canvas: Arc<Canvas>,
    viewers: Vec<Viewer>,
    terminal: Option<Arc<Terminal>>,
}

/// A thread that sends the picture somewhere.
struct Viewer {
    /// Dropped when there is nothing more to come.
    #[expect(dead_code, reason = "it is what the thread listens to")]
    more: Sender<()>,
    thread: JoinHandle<()>,
}

/// How long the end of a render waits for viewers.
const PATIENCE: Duration = Duration::from_secs(2);

impl Preview {
    /// Begins to show a picture of this size under `name`; none if nobody wants to see it. Whatever goes wrong with a
    /// viewer is told once by `display`, and the render goes on without it.
    pub fn start(targets: &[PreviewTarget], name: &str, size: [u32; 2], display: &Display) -> Option<Preview> {
        let canvas = Arc::new(Canvas::new(size));
        let (mut viewers, mut terminal) = (Vec::new(), None);
        for target in targets {
            match target {
                PreviewTarget::Tev(address) => {
                    let (canvas, address, name) = (Arc::clone(&canvas), address.clone(), name.to_string());
                    let display = display.clone();
                    viewers.push(Viewer::start(move |more| {
                        if let Err(error) = tev::show(&canvas, &address, &name, more) {
                            display.warn(&error);
                        }
                    }));
                }
                PreviewTarget::Terminal => match display {
                    Display::Quiet => {}
                    Display::Bar(_) => {
                        let own = terminal.insert(Arc::new(Terminal::new(Arc::clone(&canvas))));
                        display.attach(Arc::clone(own));
                    }
                    Display::Lines => display.warn(
                        &Warning::new("there is no terminal to show the picture in")
                            .with_hint("leave --preview terminal out, or let the standard error go to a terminal"),
                    ),
                },
            }
        }
        (!targets.is_empty()).then_some(Preview { canvas, viewers, terminal })
    }

    /// A row of the pass under way is done.
    pub fn row(&self, y: usize, pixels: &[[f32; 3]]) {
        self.canvas.row(y, pixels);
    }

    /// A pass is done.
    pub fn passed(&self, film: &Film) {
        self.canvas.passed(film.image(), film.passes());
    }

    /// There is nothing more to come: leaves the picture in the terminal, and waits a moment for what is still on its
    /// way elsewhere.
    pub fn finish(self) {
        if let Some(lines) = self.terminal.and_then(|terminal| terminal.draw()) {
            say(lines.trim_end_matches('\n'));
        }
        let until = Instant::now() + PATIENCE;
        let threads: Vec<JoinHandle<()>> = self.viewers.into_iter().map(|viewer| viewer.thread).collect();
        while !threads.iter().all(JoinHandle::is_finished) && Instant::now() < until {
            std::thread::sleep(Duration::from_millis(5));
        }
    }
}

impl Viewer {
    fn start(show: impl FnOnce(&Receiver<()>) + Send + 'static) -> Viewer {
        let (more, wanted) = channel();
        Viewer { more, thread: std::thread::spawn(move || show(&wanted)) }
    }
}
