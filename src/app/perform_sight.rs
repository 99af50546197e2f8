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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::presentation::Presentation;
    use crate::app::tests::window;
    use crate::stages::Sight;

    #[test]
    fn it_is_told_what_a_sight_shows() {
        let [stage, other] = ["metal", "metal-fuzzy"].map(|id| Stage::find(id).unwrap());
        let told = |means: Means, is_part: bool, other: Option<&Stage>| {
            let part = is_part.then_some([0.0, 0.0, 0.5, 0.5]);
            words(&Stage { sight: Sight { means, part, ..stage.sight }, ..*stage }, other)
        };
        for (means, name) in [
            (Means::Albedo, "The albedo"),
            (Means::RaysPerPath, "Rays per path"),
            (Means::StandardError, "The standard error"),
            (Means::Luminance([-1.0, 1.0]), "Luminance in false colours"),
        ] {
            assert_eq!(told(means, false, Some(other)), name);
            assert_eq!(told(means, true, None), format!("{name}, enlarged"));
        }
        assert_eq!(told(Means::Picture, true, Some(other)), "A part of the picture, enlarged");
        let wipe = Means::Wipe(0.5);
        assert_eq!(told(wipe, false, Some(other)), "A wipe against 10.6 Brushed metal");
        assert_eq!(told(wipe, true, Some(other)), "A wipe against 10.6 Brushed metal, enlarged");
        assert_eq!(told(wipe, false, None), "A wipe");
    }

    #[test]
    fn in_a_presentation_only_the_caption_tells_of_a_sight() {
        let presentation = Presentation { was_full_screen: false, has_captions: true, is_blank: false };
        for (presentation, count) in [(None, 1), (Some(presentation), 0)] {
            let mut window = window("weekender --stage metal --size 16x9 --device cpu");
            window.model.presentation = presentation;
            window.toggle_sight();
            assert!(window.sight.is_some());
            assert_eq!(window.messages().len(), count, "{:?}", window.messages());
            window.toggle_sight();
            assert!(window.sight.is_none());
        }
    }
}
