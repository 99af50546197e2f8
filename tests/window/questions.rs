//! Questions of the tests to a window.

use eframe::egui;
use std::sync::Arc;
use weekender::app::{Command, Document, Partner, Remembered, Show, Window};
use weekender::progressive::Status;

/// The pixel that is read, its bytes, whether it is the other picture's, and the means of both if they are compared.
pub type Read = ([u32; 2], [u8; 3], bool, Option<[[f64; 3]; 2]>);

fn colour(image: &egui::ColorImage, at: [u32; 2]) -> Option<[u8; 3]> {
    let [x, y] = at.map(|along| along as usize);
    let is_inside = x < image.width() && y < image.height();
    is_inside.then(|| [0, 1, 2].map(|channel| image[(x, y)].to_array()[channel]))
}

pub trait Ask {
    fn window(&self) -> &Window;

    fn window_mut(&mut self) -> &mut Window;

    fn shown_document(&self) -> &Document {
        &self.window().model.document
    }

    fn document_mut(&mut self) -> &mut Document {
        &mut self.window_mut().model.document
    }

    fn status(&self) -> &Status {
        self.window().tracing.main.status()
    }

    fn remembered_mut(&mut self) -> &mut Remembered {
        &mut self.window_mut().model.remembered
    }

    /// The messages on the screen, oldest first.
    fn messages(&self) -> Vec<String> {
        self.window().shell.toasts.texts().map(str::to_owned).collect()
    }

    fn show(&self) -> Show {
        self.window().model.view.show()
    }

    /// Samples per pixel of the picture on the screen, and its divisor.
    fn shown(&self) -> Option<(u64, u32)> {
        self.window().tracing.main.shown().map(|shown| (shown.samples, shown.divisor))
    }

    /// A pixel as it is on the screen.
    fn shown_pixel(&self, at: [u32; 2]) -> Option<[u8; 3]> {
        self.window().tracing.main.shown().and_then(|shown| colour(&shown.texture.image, at))
    }

    /// The picture on the screen shows the document.
    fn is_up_to_date(&self) -> bool {
        let shown = self.window().tracing.main.shown();
        shown.is_some_and(|shown| shown.document.has_same_film(self.shown_document()))
    }

    /// The kept pictures by name, with their samples per pixel.
    fn kept(&self) -> Vec<(String, u64)> {
        self.window().model.view.kept.iter().map(|kept| (kept.name.clone(), kept.samples())).collect()
    }

    /// The place of the kept picture that hides the traced one.
    fn looked(&self) -> Option<usize> {
        let view = &self.window().model.view;
        view.kept_partner().filter(|_| view.is_hidden()).map(|kept| view.kept.place(kept))
    }

    /// The possible partners of a comparison.
    fn partners(&self) -> Vec<Partner> {
        self.window().model.partners()
    }

    /// What it is compared with, or would be.
    fn partner(&self) -> Option<Partner> {
        self.window().model.view.partner(&self.window().model.document)
    }

    /// The status of the render that it is compared with.
    fn other_status(&self) -> Option<Arc<Status>> {
        self.window().snapshot().other
    }

    /// Whether the two compared pictures are equal, and the verdict in words, once it is known.
    fn verdict(&self) -> Option<(bool, &'static str)> {
        self.window().snapshot().verdict.and_then(|verdict| Some((verdict.is_equal?, verdict.headline)))
    }

    fn disabled_reason(&self, command: Command) -> Option<String> {
        self.window().snapshot().disabled_reason(command)
    }

    fn performed(&self) -> Option<Command> {
        self.window().shell.performed
    }

    fn has_dialog(&self) -> bool {
        self.window().shell.dialogs.is_open()
    }

    fn is_comparing(&self) -> bool {
        self.window().model.view.mode().is_some()
    }

    fn has_other_picture(&self) -> bool {
        self.other_pixel([0, 0]).is_some()
    }

    /// A pixel of the picture that the traced one is compared with.
    fn other_pixel(&self, at: [u32; 2]) -> Option<[u8; 3]> {
        let other = self.window().tracing.other(&self.window().model)?;
        colour(&self.window().tracing.second.texture(&other)?.0.image, at)
    }

    fn divider(&self) -> f32 {
        self.window().model.view.divider
    }

    fn selected(&self) -> Option<usize> {
        self.window().model.selected
    }

    /// Samples per pixel of the layer that is shown.
    fn layer_samples(&self) -> u64 {
        let shown = self.show().layer().and_then(|layer| self.window().display.layers.shown(layer));
        shown.filter(|shown| shown.divisor == 1).map_or(0, |shown| shown.image.samples)
    }

    fn picture_rect(&self) -> egui::Rect {
        self.window().display.viewport.placement.rect
    }

    /// The pixel that the panel describes, and its linear radiance.
    fn inspected(&self) -> Option<([u32; 2], [f64; 3])> {
        let readout = self.window().tools.inspector.readout(&self.window().model);
        readout.map(|readout| (readout.pixel.at, readout.pixel.mean))
    }

    /// The pixel that the panel describes, its bytes, whether it is one of the other picture, and the radiance of the other
    /// picture and of this one, if they are compared.
    fn readout(&self) -> Option<Read> {
        let readout = self.window().tools.inspector.readout(&self.window().model)?;
        let compared = readout.compared.as_ref().map(|[theirs, mine]| [theirs.mean, mine.mean]);
        Some((readout.pixel.at, readout.pixel.bytes, readout.is_other, compared))
    }

    fn is_presenting(&self) -> bool {
        self.window().model.presentation.is_some()
    }

    fn has_sight(&self) -> bool {
        self.window().display.sight.is_some()
    }

    /// The path and the point of it that are explained, counted from 1, and how many points it has.
    fn explained_point(&self) -> Option<[usize; 3]> {
        self.window().tools.paths.position()
    }

    fn listed_paths(&self) -> usize {
        self.window().tools.paths.len()
    }

    /// The verdict about the picture that was checked.
    fn checked(&self) -> Option<&str> {
        self.window().tools.check.shown.as_ref().map(|checked| checked.answer.title.as_str())
    }

    fn is_paused(&self) -> bool {
        self.window().model.is_paused
    }
}

impl Ask for Window {
    fn window(&self) -> &Window {
        self
    }

    fn window_mut(&mut self) -> &mut Window {
        self
    }
}
