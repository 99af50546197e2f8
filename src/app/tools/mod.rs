//! Tools that explain the picture: pixel, paths, lanes, code, and the check of the user's own picture.

pub mod check;
pub mod code;
pub mod dock;
pub mod inspector;
pub mod lanes;
pub mod paths;
mod quoted;
pub mod tone;

use crate::app::model::{Dock, Model};
use crate::app::tracing::subject::Subject;
use check::Check;
use code::Code;
use eframe::egui::Context;
use inspector::Inspector;
use lanes::Lanes;
use paths::Paths;

#[derive(Default)]
pub struct Tools {
    pub inspector: Inspector,
    pub paths: Paths,
    pub lanes: Lanes,
    pub code: Code,
    pub check: Check,
}

impl Tools {
    /// Asks background threads for what is to be explained.
    pub fn follow(&mut self, context: &Context, model: &Model, subject: &Subject<'_>, is_moving: bool) {
        self.inspector.follow(subject, subject.tracing.other(model), &model.view, context);
        self.paths.follow(&model.document, context);
        let is_open = model.has_panels() && model.remembered.dock == Some(Dock::Lanes);
        let count = is_open.then(|| model.remembered.lanes_in_use());
        self.lanes.follow(context, &model.document, count, is_moving);
    }

    /// Forgets what belonged to the picture that was shown before.
    pub fn forget(&mut self) {
        self.inspector.forget();
        self.paths.forget();
    }
}
