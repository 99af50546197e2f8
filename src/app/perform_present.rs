//! Begins and ends a presentation.

use super::model::presentation::Presentation;
use super::window::Window;
use eframe::egui::{Context, ViewportCommand};

impl Window {
    /// Begins a presentation, or ends it and leaves full-screen mode if it had begun that.
    pub(super) fn toggle_presentation(&mut self, context: &Context) {
        let was_full_screen = self.model.is_full_screen;
        match self.model.presentation.take() {
            Some(presentation) => self.fill_screen(context, presentation.was_full_screen),
            None => {
                let begun = Presentation { was_full_screen, has_captions: true, is_blank: false };
                self.model.presentation = Some(begun);
                self.presenter.begin(context);
                self.fill_screen(context, true);
            }
        }
    }

    fn fill_screen(&mut self, context: &Context, is_full: bool) {
        if self.model.is_full_screen != is_full {
            self.model.is_full_screen = is_full;
            context.send_viewport_cmd(ViewportCommand::Fullscreen(is_full));
        }
    }

    /// Hides the captions of a presentation, or shows them again.
    pub(super) fn toggle_captions(&mut self) {
        if let Some(presentation) = &mut self.model.presentation {
            presentation.has_captions = !presentation.has_captions;
        }
    }

    /// Makes the screen of a presentation black, or shows it again.
    pub(super) fn toggle_blank(&mut self) {
        if let Some(presentation) = &mut self.model.presentation {
            presentation.is_blank = !presentation.is_blank;
        }
    }

    /// Shows the screen of a presentation again.
    pub(super) fn end_blank(&mut self) {
        if let Some(presentation) = &mut self.model.presentation {
            presentation.is_blank = false;
        }
    }
}
