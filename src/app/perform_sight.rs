//! Shows what there is to look for in a stage, and returns from it.

use super::sight::Sighted;
use super::window::Window;
use crate::stages::{Means, Stage};

impl Window {
    /// Shows the stage's sight and tells what was done, or returns to what was shown before.
    pub(super) fn toggle_sight(&mut self) {
        if self.sight.is_some() {
            self.end_sight();
            return;
        }
        let Some(stage) = self.document().stage() else { return };
        let (document, view) = (&mut self.model.document, &mut self.model.view);
        let sight = Sighted::begin(stage, document, view, &mut self.viewport.placement);
        let camera = if sight.has_moved_camera() { ", seen by the stage's camera" } else { "" };
        // In a presentation the caption tells it.
        if self.model.presentation.is_none() {
            let other = self.model.view.other_of(stage);
            self.toasts.good(format!("{}{camera}. Escape returns", words(stage, other)));
        }
        self.sight = Some(sight);
    }

    /// Returns from a sight, if one is shown.
    pub(super) fn end_sight(&mut self) {
        if let Some(sight) = self.sight.take() {
            let (document, view) = (&mut self.model.document, &mut self.model.view);
            sight.end(document, view, &mut self.viewport.placement);
        }
    }

    /// Ends a sight that is no longer shown: of another picture it does not stay, and another view stays as it is.
    pub(super) fn follow_sight(&mut self) {
        let Some(sight) = &self.sight else { return };
        let document = &self.model.document;
        if sight.is_of_another(document) {
            self.end_sight();
        } else if !sight.lasts(document, &self.model.view) {
            self.sight = None;
        }
    }
}

/// What was done to show a sight.
fn words(stage: &Stage, other: Option<&Stage>) -> String {
    let sight = &stage.sight;
    let enlarged = if sight.part.is_some() { ", enlarged" } else { "" };
    match (sight.means, other) {
        (Means::Picture, _) => "A part of the picture, enlarged".to_owned(),
        (Means::Albedo, _) => format!("The albedo{enlarged}"),
        (Means::RaysPerPath, _) => format!("Rays per path{enlarged}"),
        (Means::StandardError, _) => format!("The standard error{enlarged}"),
        (Means::Luminance(_), _) => format!("Luminance in false colours{enlarged}"),
        (Means::Wipe(_), Some(other)) => {
            format!("A wipe against {} {}{enlarged}", other.section, other.title)
        }
        (Means::Wipe(_), None) => format!("A wipe{enlarged}"),
    }
}
