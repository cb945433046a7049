//! Ctrl-C: the first keeps the picture, the second quits.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use lampyris::error::{Error, Result};

use crate::Exit;

/// Whether the user has asked to stop.
#[derive(Clone, Debug, Default)]
pub struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Listens from now on. At the first Ctrl-C calls `on_first`, from another thread; at the second ends the process.
    ///
    /// # Errors
    /// If the operating system does not let us listen.
    pub fn listen(on_first: impl Fn() + Send + 'static) -> Result<Interrupt> {
        let interrupt = Interrupt::default();
        let heard = interrupt.clone();
        let listening = ctrlc::set_handler(move || {
            if heard.0.swap(true, Ordering::SeqCst) {
                std::process::exit(Exit::Interrupted as i32);
            }
            on_first();
        });
        listening.map_err(|error| Error::new(format!("cannot listen for Ctrl-C: {error}")))?;
        Ok(interrupt)
    }

    /// Whether there was a Ctrl-C.
    pub fn is_raised(&self) -> bool {
        self.0.load(Ordering::SeqCst)
    }
}
