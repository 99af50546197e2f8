//! What the handle tells the render thread while that is busy.

use std::sync::atomic::{AtomicBool, Ordering};

/// Flags that end a long call of a renderer early.
#[derive(Default)]
pub(super) struct Cancel {
    /// Ends a pass, which spoils the film.
    pub pass: AtomicBool,
    /// Ends preparing, which can begin again, and a pass that can be taken away more quickly than finished.
    pub stop: AtomicBool,
}

impl Cancel {
    /// Ends whatever is going on, for good.
    pub fn abandon(&self) {
        self.pass.store(true, Ordering::Relaxed);
        self.stop.store(true, Ordering::Relaxed);
    }

    /// Ends preparing and a pass until the command to stop is obeyed.
    pub fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    /// The command to stop is obeyed: if the render is resumed, what was ended begins again.
    pub fn stop_is_obeyed(&self) {
        self.stop.store(self.is_abandoned(), Ordering::Relaxed);
    }

    pub fn is_abandoned(&self) -> bool {
        self.pass.load(Ordering::Relaxed)
    }
}
