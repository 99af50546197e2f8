//! What stands before the window until it is answered or closed.

mod help;
mod palette;
mod path_box;

pub use palette::Palette;
pub use path_box::{Chosen, PathBox, Purpose};

use super::window::Window;
use eframe::egui::{Id, Modal, Ui};

/// The dialog that is open.
pub enum Dialog {
    /// All commands by name.
    Palette(Palette),
    /// Keys and mouse.
    Help,
    /// A file's name.
    Path(PathBox),
}

/// What a dialog wants after a frame.
pub(super) enum Outcome {
    Stay,
    Close,
}

impl Window {
    pub(super) fn dialogs(&mut self, ui: &mut Ui) {
        let Some(mut dialog) = self.dialog.take() else { return };
        let room = ui.ctx().content_rect().size();
        let modal = Modal::new(Id::unique("dialog")).show(ui.ctx(), |ui| {
            let width = if matches!(dialog, Dialog::Help) { 700.0 } else { 560.0 };
            ui.set_max_width((room.x - 40.0).min(width));
            match &mut dialog {
                Dialog::Palette(palette) => palette.ui(self, ui),
                Dialog::Help => help::ui(ui, (room.y - 140.0).max(100.0)),
                Dialog::Path(path_box) => path_box.ui(self, ui),
            }
        });
        // Another dialog may have been asked for in this one.
        let is_open = matches!(modal.inner, Outcome::Stay) && !modal.should_close();
        if is_open && self.dialog.is_none() {
            self.dialog = Some(dialog);
        }
    }
}
