//! Dialogs, which block the window until they are answered or closed.

mod about;
mod help;
mod outcome;
mod palette;
mod path_box;
mod purpose;
mod sky;

pub use help::Keys;
pub use palette::Palette;
pub use path_box::PathBox;
pub use purpose::Purpose;

use super::answers::Answers;
use super::command::Command;
use super::facts::Facts;
use super::model::edit::Edit;
use eframe::egui::{Context, Id, Modal, PointerState, Ui};
use outcome::Outcome;
use path_box::Chosen;
use std::path::PathBuf;

/// The dialog that is open.
pub enum Dialog {
    /// All commands by name.
    Palette(Palette),
    /// Keys and mouse.
    Help(Keys),
    /// The colours of the sky.
    Sky,
    /// Version and licences.
    About,
    /// The entry of a file's name.
    Path(PathBox),
}

/// The open dialog, if any, and the system's file dialog.
#[derive(Default)]
pub struct Dialogs {
    open: Option<Dialog>,
    /// The pointer, while what is behind a dialog is drawn.
    pointer: Option<PointerState>,
    browsed: Answers<(Purpose, Chosen)>,
    /// The commands that were used, the last one first.
    used: Vec<Command>,
}

impl Dialogs {
    /// Whether a dialog is open.
    pub fn is_open(&self) -> bool {
        self.open.is_some()
    }

    /// Notes that a command was used, to offer it again.
    pub fn note_used(&mut self, command: Command) {
        if command.row().is_some_and(|row| row.is_listed) && command != Command::Palette {
            self.used.retain(|other| *other != command);
            self.used.insert(0, command);
        }
    }

    /// Opens a dialog. It replaces an open one.
    pub fn open(&mut self, dialog: Dialog) {
        self.open = Some(dialog);
    }

    /// Hides the pointer from what is drawn behind a dialog: a tip that was shown there would stay above the dialog as long as
    /// the pointer rests.
    pub fn begin(&mut self, context: &Context) {
        if self.is_open() {
            self.pointer = Some(context.input_mut(|input| std::mem::take(&mut input.pointer)));
        }
    }

    /// Draws the dialog. Returns the chosen file and its purpose, if one was chosen.
    pub fn ui(
        &mut self,
        ui: &mut Ui,
        facts: &Facts,
        (edits, commands): (&mut Vec<Edit>, &mut Vec<Command>),
    ) -> Option<(Purpose, PathBuf)> {
        if let Some(pointer) = self.pointer.take() {
            ui.ctx().input_mut(|input| input.pointer = pointer);
        }
        let dialog = self.open.as_mut()?;
        let room = ui.ctx().content_rect().size();
        let modal = Modal::new(Id::unique("dialog")).show(ui.ctx(), |ui| {
            ui.set_max_width((room.x - 64.0).min(512.0));
            match dialog {
                Dialog::Palette(palette) => {
                    palette.ui(ui, (room.y - 180.0).clamp(100.0, 360.0), (facts, &self.used), commands)
                }
                Dialog::Help(keys) => keys.ui(ui, (room.y - 240.0).clamp(100.0, 560.0)),
                Dialog::Sky => sky::ui(ui, facts, edits),
                Dialog::About => about::ui(ui, facts),
                Dialog::Path(path_box) => path_box.ui(ui, &self.browsed),
            }
        });
        if modal.should_close() || !matches!(modal.inner, Outcome::Stay) {
            self.open = None;
        }
        match modal.inner {
            Outcome::Named(purpose, path) => Some((purpose, path)),
            Outcome::Stay | Outcome::Close => None,
        }
    }

    /// The result of the system's file dialog: a file and its purpose, or a message that no dialog is available.
    pub fn browsed(&mut self) -> Option<Result<(Purpose, PathBuf), &'static str>> {
        match self.browsed.take()? {
            (_, Chosen::NoDialog) => {
                Some(Err("The system's file dialog cannot be shown; type the file's name in the box"))
            }
            (purpose, Chosen::Path(path)) => {
                if matches!(self.open, Some(Dialog::Path(_))) {
                    self.open = None;
                }
                match PathBox::chosen(purpose, path) {
                    Ok(path) => Some(Ok((purpose, path))),
                    Err(asks) => {
                        self.open(Dialog::Path(asks));
                        None
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::tests::{facts_of, part, rest_at};
    use crate::job::output::OutputFormat;
    use eframe::egui;

    const PNG: Purpose = Purpose::Save(OutputFormat::Png);

    #[test]
    fn without_a_dialog_of_the_system_the_box_stays_and_the_user_is_told() {
        let mut dialogs = Dialogs::default();
        dialogs.open(Dialog::Path(PathBox::new(PNG, "a", None)));
        assert_eq!(dialogs.browsed(), None, "there is no answer yet");
        dialogs.browsed.answer(&Context::default()).give((PNG, Chosen::NoDialog));
        let told = dialogs.browsed().unwrap().unwrap_err();
        assert!(told.contains("cannot be shown") && dialogs.is_open(), "{told}");
        assert_eq!(dialogs.browsed(), None, "it is told once");
    }

    #[test]
    fn what_is_behind_a_dialog_does_not_see_the_pointer() {
        let facts = facts_of("--stage metal --size 32x18");
        let mut dialogs = Dialogs::default();
        for is_open in [false, true] {
            if is_open {
                dialogs.open(Dialog::Help(Keys::default()));
            }
            let mut seen = Vec::new();
            let mut harness = part([800.0, 600.0], |ui| {
                dialogs.begin(ui.ctx());
                let behind = ui.ctx().input(|input| input.pointer.hover_pos());
                assert_eq!(dialogs.ui(ui, &facts, (&mut Vec::new(), &mut Vec::new())), None);
                seen.push([behind, ui.ctx().input(|input| input.pointer.hover_pos())].map(|at| at.is_some()));
            });
            rest_at(&mut harness, egui::pos2(400.0, 300.0));
            drop(harness);
            assert_eq!(seen.last(), Some(&[!is_open, true]));
        }
    }
}
