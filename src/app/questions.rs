//! What `tests/window` asks of a window, from outside.

use super::command::Command;
use super::model::document::Document;
use super::model::remembered::Remembered;
use super::model::show::Show;
use super::window::Window;
use crate::progressive::Status;
use eframe::egui;

#[doc(hidden)]
impl Window {
    pub fn shown_document(&self) -> &Document {
        &self.model.document
    }

    pub fn document_mut(&mut self) -> &mut Document {
        &mut self.model.document
    }

    pub fn status(&self) -> &Status {
        self.tracing.main.status()
    }

    pub fn remembered_mut(&mut self) -> &mut Remembered {
        &mut self.model.remembered
    }

    /// Writes the companion to this folder.
    pub fn write_companion_to(&mut self, folder: &std::path::Path) {
        self.files.companion = Some(folder.to_owned());
    }

    /// The messages on the screen, oldest first.
    pub fn messages(&self) -> Vec<String> {
        self.shell.toasts.texts().map(str::to_owned).collect()
    }

    pub fn show(&self) -> Show {
        self.model.view.show()
    }

    /// Samples per pixel of the picture on the screen, and its divisor.
    pub fn shown(&self) -> Option<(u64, u32)> {
        self.tracing.main.shown().map(|shown| (shown.samples, shown.divisor))
    }

    /// A pixel as it is on the screen.
    pub fn shown_pixel(&self, at: [u32; 2]) -> Option<[u8; 3]> {
        self.display.shown(&self.model, &self.tracing).and_then(|shown| shown.texture.colour(at))
    }

    /// The picture on the screen shows the document.
    pub fn is_up_to_date(&self) -> bool {
        self.tracing.main.shown().is_some_and(|shown| shown.document.has_same_film(self.document()))
    }

    /// The kept pictures by name, with their samples per pixel.
    pub fn kept(&self) -> Vec<(&str, u64)> {
        self.model.view.kept.iter().map(|named| (named.name.as_str(), named.kept.samples())).collect()
    }

    /// The place of the kept picture that is shown.
    pub fn looked(&self) -> Option<usize> {
        self.model.view.kept.looked()
    }

    /// The two sentences of the answer to "Only noise?".
    pub fn only_noise(&self) -> Option<Result<(&str, &str), &str>> {
        self.display.kept.verdict.words()
    }

    pub fn disabled_reason(&self, command: Command) -> Option<String> {
        self.facts().disabled_reason(command)
    }

    pub fn performed(&self) -> Option<Command> {
        self.shell.performed
    }

    pub fn has_dialog(&self) -> bool {
        self.shell.dialogs.is_open()
    }

    pub fn is_comparing(&self) -> bool {
        self.model.view.mode().is_some()
    }

    pub fn has_other_picture(&self) -> bool {
        self.tracing.second.has_picture(self.document(), &self.model.view)
    }

    pub fn divider(&self) -> f32 {
        self.model.view.divider
    }

    pub fn selected(&self) -> Option<usize> {
        self.model.selected
    }

    /// Samples per pixel of the layer that is shown.
    pub fn layer_samples(&self) -> u64 {
        self.show().layer().map_or(0, |layer| self.display.layers.samples(layer))
    }

    pub fn picture_rect(&self) -> egui::Rect {
        self.display.viewport.placement.rect()
    }

    /// The pixel that the panel describes, and its linear radiance.
    pub fn inspected(&self) -> Option<([u32; 2], [f64; 3])> {
        self.tools.inspector.pixel().map(|pixel| (pixel.at, pixel.mean))
    }

    pub fn is_presenting(&self) -> bool {
        self.model.presentation.is_some()
    }

    pub fn has_sight(&self) -> bool {
        self.display.sight.is_some()
    }

    /// The path and the point of it that are explained, counted from 1, and how many points it has.
    pub fn explained_point(&self) -> Option<[usize; 3]> {
        self.tools.paths.position()
    }

    /// Steps that the lanes take without and with refill.
    pub fn lane_steps(&self) -> Option<[usize; 2]> {
        self.tools.lanes.steps()
    }

    pub fn listed_paths(&self) -> usize {
        self.tools.paths.len()
    }

    /// The verdict about the picture that was checked.
    pub fn checked(&self) -> Option<&str> {
        self.tools.check.answer().map(|answer| answer.title.as_str())
    }

    pub fn is_paused(&self) -> bool {
        self.model.is_paused
    }
}
