//! What can be asked of a window: by the program, and by the tests in `tests/window`, which use it from outside.

use super::command::Command;
use super::model::document::Document;
use super::model::remembered::Remembered;
use super::model::show::Show;
use super::model::slots::SlotNumber;
use super::tracer::Shown;
use super::window::Window;
use crate::progressive::Status;
use eframe::egui;

impl Window {
    /// The current view.
    pub fn show(&self) -> Show {
        self.model.view.show()
    }

    /// Why a command is disabled, in words; `None` if it is enabled.
    pub fn disabled_reason(&self, command: Command) -> Option<String> {
        self.facts().disabled_reason(command)
    }
}

/// For tests only.
#[doc(hidden)]
impl Window {
    /// The document that is shown, to be edited like a panel does.
    pub fn document_mut(&mut self) -> &mut Document {
        &mut self.model.document
    }

    /// The status of the render.
    pub fn status(&self) -> &Status {
        self.main.status()
    }

    /// The settings that are kept for the next run.
    pub fn remembered_mut(&mut self) -> &mut Remembered {
        &mut self.model.remembered
    }

    /// The messages that are visible.
    pub fn messages(&self) -> Vec<String> {
        self.toasts.texts().map(str::to_owned).collect()
    }

    /// Samples per pixel of the displayed picture, and the factor by which it is smaller than requested.
    pub fn shown(&self) -> Option<(u64, u32)> {
        self.main.shown().map(|shown| (shown.samples, shown.divisor))
    }

    /// The colour of a pixel of the displayed picture, which may be that of a slot.
    pub fn shown_pixel(&self, at: [u32; 2]) -> Option<[u8; 3]> {
        self.on_screen().and_then(|shown| shown.texture.colour(at))
    }

    fn on_screen(&self) -> Option<&Shown> {
        match self.model.view.slots.shown() {
            Some(kept) => self.slot_actions.picture.shown(kept),
            None => self.main.shown(),
        }
    }

    /// The slot that is shown instead of the live picture.
    pub fn looked(&self) -> Option<SlotNumber> {
        self.model.view.slots.looked()
    }

    /// The name of a slot in use, and the samples per pixel of its picture.
    pub fn slot(&self, number: SlotNumber) -> Option<(&str, u64)> {
        self.model.view.slots.get(number).map(|slot| (slot.name.as_str(), slot.kept.samples()))
    }

    /// Whether a slot waits for a picture that is still being read.
    pub fn is_coming(&self, number: SlotNumber) -> bool {
        self.model.view.slots.coming(number).is_some()
    }

    /// Whether the last two pictures that were compared differ only by noise: the verdict in a few words, and the text of
    /// `weekender compare`. `None` while it is awaited.
    pub fn only_noise(&self) -> Option<Result<(&str, &str), &str>> {
        self.slot_actions.verdict.words()
    }

    /// The part of the picture that is marked: its first column and row, and its size.
    pub fn crop(&self) -> Option<[[u32; 2]; 2]> {
        self.model.view.crop.flatten().map(|crop| [crop.first, crop.size])
    }

    /// Whether the displayed picture is of the current document.
    pub fn is_up_to_date(&self) -> bool {
        self.main.shown().is_some_and(|shown| shown.document.has_same_film(self.document()))
    }

    /// The last command that was carried out.
    pub fn performed(&self) -> Option<Command> {
        self.performed
    }

    /// Whether something is offered that another window left.
    pub fn has_offer(&self) -> bool {
        self.model.has_recovered
    }

    /// Whether a dialog is open.
    pub fn has_dialog(&self) -> bool {
        self.dialogs.is_open()
    }

    /// Whether two pictures are being compared.
    pub fn is_comparing(&self) -> bool {
        self.model.view.mode().is_some()
    }

    /// Whether a second picture of the current comparison is available.
    pub fn has_other_picture(&self) -> bool {
        self.second.has_picture(self.document(), &self.model.view)
    }

    /// Where the divider of a wipe is, `0..=1` of the picture's width.
    pub fn divider(&self) -> f32 {
        self.model.view.divider
    }

    /// The selected sphere, by its index in the scene.
    pub fn selected(&self) -> Option<usize> {
        self.model.selected
    }

    /// Samples per pixel of the displayed layer at full size.
    pub fn layer_samples(&self) -> u64 {
        self.show().layer().map_or(0, |layer| self.layers.samples(layer))
    }

    /// Where the picture is drawn, in points.
    pub fn picture_rect(&self) -> egui::Rect {
        self.viewport.placement.rect()
    }

    /// The last pixel under the pointer and its linear radiance, as of the film's last answer.
    pub fn inspected(&self) -> Option<([u32; 2], [f64; 3])> {
        self.inspector.pixel().map(|pixel| (pixel.at, pixel.mean))
    }

    /// Whether the window is in full-screen mode.
    pub fn is_full_screen(&self) -> bool {
        self.model.is_full_screen
    }

    /// Whether there is a presentation.
    pub fn is_presenting(&self) -> bool {
        self.model.presentation.is_some()
    }

    /// Whether the screen of a presentation is black.
    pub fn is_blank(&self) -> bool {
        self.model.presentation.is_some_and(|presentation| presentation.is_blank)
    }

    /// Whether the stage's sight is shown.
    pub fn has_sight(&self) -> bool {
        self.sight.is_some()
    }

    /// How many small pictures of stages are at hand.
    pub fn thumbnail_count(&self) -> usize {
        self.thumbnails.count()
    }

    /// The ray of the highlighted path that is explained, counted from 1, and the number of its rays.
    pub fn explained_ray(&self) -> Option<[usize; 2]> {
        self.paths.position()
    }

    /// The steps of the shown packet without and with refill, once they are recorded.
    pub fn packet_steps(&self) -> Option<[usize; 2]> {
        self.packet.steps()
    }

    /// What was found about the reader's picture that is shown.
    pub fn finding(&self) -> Option<&str> {
        self.check.words()
    }

    /// The number of listed paths.
    pub fn listed_paths(&self) -> usize {
        self.paths.len()
    }

    /// Whether tracing is paused.
    pub fn is_paused(&self) -> bool {
        self.model.is_paused
    }
}
