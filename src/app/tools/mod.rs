//! Tools that explain the picture: pixel, paths, code, and the check of the user's own picture.

pub mod check;
pub mod code;
pub mod dock;
pub mod inspector;
pub mod paths;
mod quoted;

use crate::app::tracing::subject::Subject;
use check::Check;
use code::Code;
use eframe::egui::Context;
use inspector::Inspector;
use paths::Paths;

#[derive(Default)]
pub struct Tools {
    pub inspector: Inspector,
    pub paths: Paths,
    pub code: Code,
    pub check: Check,
}

impl Tools {
    /// Asks background threads for what is to be explained.
    pub fn follow(&mut self, context: &Context, subject: &Subject<'_>) {
        self.inspector.follow(subject, context);
        self.paths.follow(subject.document(), context);
    }

    /// Forgets what belonged to the picture that was shown before.
    pub fn forget(&mut self) {
        self.inspector.forget();
        self.paths.forget();
    }
}
