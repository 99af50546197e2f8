//! Questions of the tests to a window.

use eframe::egui;
use std::sync::Arc;
use weekender::app::{Command, Document, Partner, Remembered, Show, Window};
use weekender::progressive::{HistoryPoint, Status};

/// The pixel that is read, its bytes, whether it is the other picture's, and the means of both if they are compared.
pub type Read = ([u32; 2], [u8; 3], bool, Option<[[f64; 3]; 2]>);

pub trait Ask {
    fn shown_document(&self) -> &Document;

    fn document_mut(&mut self) -> &mut Document;

    fn status(&self) -> &Status;

    fn remembered_mut(&mut self) -> &mut Remembered;

    /// The messages on the screen, oldest first.
    fn messages(&self) -> Vec<String>;

    fn show(&self) -> Show;

    /// Samples per pixel of the picture on the screen, and its divisor.
    fn shown(&self) -> Option<(u64, u32)>;

    /// A pixel as it is on the screen.
    fn shown_pixel(&self, at: [u32; 2]) -> Option<[u8; 3]>;

    /// The picture on the screen shows the document.
    fn is_up_to_date(&self) -> bool;

    /// The kept pictures by name, with their samples per pixel.
    fn kept(&self) -> Vec<(String, u64)>;

    /// The place of the kept picture that hides the traced one.
    fn looked(&self) -> Option<usize>;

    /// The possible partners of a comparison.
    fn partners(&self) -> Vec<Partner>;

    /// What it is compared with, or would be.
    fn partner(&self) -> Option<Partner>;

    /// The status of the render that it is compared with.
    fn other_status(&self) -> Option<Arc<Status>>;

    /// The error over time of renders of the same picture that were started again.
    fn earlier_curves(&self) -> Vec<HistoryPoint>;

    /// Whether the two compared pictures are equal, and the verdict in words, once it is known.
    fn verdict(&self) -> Option<(bool, &'static str)>;

    fn disabled_reason(&self, command: Command) -> Option<String>;

    fn performed(&self) -> Option<Command>;

    fn has_dialog(&self) -> bool;

    fn is_comparing(&self) -> bool;

    fn has_other_picture(&self) -> bool;

    /// A pixel of the picture that the traced one is compared with.
    fn other_pixel(&self, at: [u32; 2]) -> Option<[u8; 3]>;

    fn divider(&self) -> f32;

    fn selected(&self) -> Option<usize>;

    /// Samples per pixel of the layer that is shown.
    fn layer_samples(&self) -> u64;

    fn picture_rect(&self) -> egui::Rect;

    /// The pixel that the panel describes, and its linear radiance.
    fn inspected(&self) -> Option<([u32; 2], [f64; 3])>;

    /// The pixel that the panel describes, its bytes, whether it is one of the other picture, and the radiance of the other
    /// picture and of this one, if they are compared.
    fn readout(&self) -> Option<Read>;

    fn is_presenting(&self) -> bool;

    fn has_sight(&self) -> bool;

    /// The path and the point of it that are explained, counted from 1, and how many points it has.
    fn explained_point(&self) -> Option<[usize; 3]>;

    fn listed_paths(&self) -> usize;

    /// The verdict about the picture that was checked.
    fn checked(&self) -> Option<&str>;

    fn is_paused(&self) -> bool;
}

impl Ask for Window {
    fn shown_document(&self) -> &Document {
        &self.model.document
    }

    fn document_mut(&mut self) -> &mut Document {
        &mut self.model.document
    }

    fn status(&self) -> &Status {
        self.tracing.main.status()
    }

    fn remembered_mut(&mut self) -> &mut Remembered {
        &mut self.model.remembered
    }

    fn messages(&self) -> Vec<String> {
        self.shell.toasts.texts().map(str::to_owned).collect()
    }

    fn show(&self) -> Show {
        self.model.view.show()
    }

    fn shown(&self) -> Option<(u64, u32)> {
        self.tracing.main.shown().map(|shown| (shown.samples, shown.divisor))
    }

    fn shown_pixel(&self, at: [u32; 2]) -> Option<[u8; 3]> {
        self.tracing.main.shown().and_then(|shown| shown.texture.colour(at))
    }

    fn is_up_to_date(&self) -> bool {
        self.tracing.main.shown().is_some_and(|shown| shown.document.has_same_film(self.shown_document()))
    }

    fn kept(&self) -> Vec<(String, u64)> {
        self.model.view.kept.iter().map(|kept| (kept.name.clone(), kept.samples())).collect()
    }

    fn looked(&self) -> Option<usize> {
        let kept = self.model.view.kept_partner().filter(|_| self.model.view.is_hidden())?;
        Some(self.model.view.kept.place(kept))
    }

    fn partners(&self) -> Vec<Partner> {
        self.model.partners()
    }

    fn partner(&self) -> Option<Partner> {
        self.model.view.partner(&self.model.document)
    }

    fn other_status(&self) -> Option<Arc<Status>> {
        self.snapshot().other
    }

    fn earlier_curves(&self) -> Vec<HistoryPoint> {
        self.snapshot().earlier
    }

    fn verdict(&self) -> Option<(bool, &'static str)> {
        self.snapshot().verdict.and_then(|verdict| Some((verdict.is_equal?, verdict.headline)))
    }

    fn disabled_reason(&self, command: Command) -> Option<String> {
        self.snapshot().disabled_reason(command)
    }

    fn performed(&self) -> Option<Command> {
        self.shell.performed
    }

    fn has_dialog(&self) -> bool {
        self.shell.dialogs.is_open()
    }

    fn is_comparing(&self) -> bool {
        self.model.view.mode().is_some()
    }

    fn has_other_picture(&self) -> bool {
        self.other_pixel([0, 0]).is_some()
    }

    fn other_pixel(&self, at: [u32; 2]) -> Option<[u8; 3]> {
        let other = self.tracing.other(&self.model)?;
        self.tracing.second.texture(&other)?.0.colour(at)
    }

    fn divider(&self) -> f32 {
        self.model.view.divider
    }

    fn selected(&self) -> Option<usize> {
        self.model.selected
    }

    fn layer_samples(&self) -> u64 {
        let shown = self.show().layer().and_then(|layer| self.display.layers.shown(layer));
        shown.filter(|shown| shown.divisor == 1).map_or(0, |shown| shown.image.samples)
    }

    fn picture_rect(&self) -> egui::Rect {
        self.display.viewport.placement.rect
    }

    fn inspected(&self) -> Option<([u32; 2], [f64; 3])> {
        self.tools.inspector.readout().map(|readout| (readout.pixel.at, readout.pixel.mean))
    }

    fn readout(&self) -> Option<Read> {
        let readout = self.tools.inspector.readout()?;
        let compared = readout.compared.as_ref().map(|[theirs, mine]| [theirs.mean, mine.mean]);
        Some((readout.pixel.at, readout.pixel.bytes, readout.is_other, compared))
    }

    fn is_presenting(&self) -> bool {
        self.model.presentation.is_some()
    }

    fn has_sight(&self) -> bool {
        self.display.sight.is_some()
    }

    fn explained_point(&self) -> Option<[usize; 3]> {
        self.tools.paths.position()
    }

    fn listed_paths(&self) -> usize {
        self.tools.paths.len()
    }

    fn checked(&self) -> Option<&str> {
        self.tools.check.shown.as_ref().map(|checked| checked.answer.title.as_str())
    }

    fn is_paused(&self) -> bool {
        self.model.is_paused
    }
}
