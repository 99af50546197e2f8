//! Dialogs, which block the window until they are answered or closed.

mod about;
mod files;
mod help;
mod outcome;
mod palette;
pub mod stage_list;

pub use files::{PathField, SaveBox, default_folder, samples_to_save};
pub use outcome::{Outcome, Purpose, Wanted, What};

use crate::app::commands::PanelContext;
use crate::app::toolkit::Finder;
use eframe::egui::{self, Align2, Color32, Id, Modal, Ui, vec2};

/// The dialog that is open.
pub enum Dialog {
    /// All commands by name.
    Palette(Finder),
    /// The list of stages.
    Stages(Finder),
    /// Keys and mouse.
    Help,
    /// Version and licences.
    About,
    /// Saving the picture, the film or the scene.
    Save(SaveBox),
    /// The entry of a path.
    Path(PathField),
}

/// The open dialog, and the system's file dialog.
#[derive(Default)]
pub struct Dialogs {
    open: Option<Dialog>,
    pub system: files::System,
}

impl Dialogs {
    /// Whether a dialog is open.
    pub fn is_open(&self) -> bool {
        self.open.is_some()
    }

    /// Opens a dialog. It replaces an open one.
    pub fn open(&mut self, dialog: Dialog) {
        self.open = Some(dialog);
    }

    /// Draws the dialog. Returns how it closes.
    pub fn ui(&mut self, ui: &mut Ui, cx: &PanelContext) -> Outcome {
        let Some(dialog) = self.open.as_mut() else { return Outcome::Stay };
        let room = ui.ctx().content_rect().size();
        // Each kind has its own size.
        let id = Id::unique(("dialog", std::mem::discriminant(dialog)));
        let mut modal = Modal::new(id).frame(egui::Frame::window(ui.style()));
        if matches!(dialog, Dialog::Stages(_) | Dialog::Palette(_)) {
            // It hangs below the bar, and is as high as what is found.
            let area = Modal::default_area(id).anchor(Align2::CENTER_TOP, vec2(0.0, 48.0));
            modal = modal.area(area).frame(egui::Frame::menu(ui.style()).inner_margin(8));
            modal = modal.backdrop_color(Color32::TRANSPARENT);
        }
        let modal = modal.show(ui.ctx(), |ui| {
            let widest = if matches!(dialog, Dialog::Help) { 880.0 } else { 512.0 };
            ui.set_max_width((room.x - 64.0).min(widest));
            match dialog {
                Dialog::Palette(finder) => palette::ui(finder, ui, (room.y - 180.0).clamp(100.0, 360.0), cx),
                Dialog::Stages(finder) => {
                    stage_list::ui(finder, ui, (room.y - 140.0).clamp(160.0, 720.0), cx)
                }
                Dialog::Help => help::ui(ui, (room.y - 200.0).clamp(100.0, 560.0)),
                Dialog::About => about::ui(ui, cx),
                Dialog::Save(save) => save.ui(ui, cx, &mut self.system),
                Dialog::Path(field) => field.ui(ui),
            }
        });
        if modal.should_close() || !matches!(modal.inner, Outcome::Stay) {
            self.open = None;
        }
        modal.inner
    }

    /// Takes what was chosen in the system's dialog: a file and its purpose. If there was no dialog, opens a field
    /// for the path.
    pub fn chosen(&mut self) -> Option<Outcome> {
        let (purpose, from, path) = self.system.chosen()?;
        match (purpose, path, &mut self.open) {
            (Purpose::Folder, Some(folder), Some(Dialog::Save(save))) => save.folder = folder,
            (Purpose::Folder, None, _) => self.system.is_there = false,
            // Its dialog was closed meanwhile.
            (Purpose::Folder, ..) => {}
            (_, Some(path), _) => return Some(Outcome::Named(purpose, path)),
            (_, None, _) => self.open(Dialog::Path(PathField::new(purpose, from))),
        }
        None
    }
}
