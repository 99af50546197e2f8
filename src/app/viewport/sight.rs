//! "Show me": the sight of a stage, and what the window showed before, to return to it.

use super::placement::Placement;
use crate::app::model::{Document, Mode, Origin, Partner, Show, Tone, ViewState};
use crate::scene::Camera;
use crate::stages::{Means, Stage};
use std::sync::Arc;

/// The sight of a stage that is shown, and what was shown before.
pub struct Sight {
    before: Camera,
    pub view: ViewState,
    placement: Placement,
    /// What the sight shows.
    origin: Arc<Origin>,
    looks: (Show, Option<Mode>, Partner),
}

impl Sight {
    /// Shows the sight of a stage, with the stage's camera.
    pub fn show(
        stage: &Stage,
        document: &mut Document,
        view: &mut ViewState,
        placement: &mut Placement,
    ) -> Self {
        let (before, of_before, placed) = (document.camera, view.clone(), placement.clone());
        document.camera = document.origin.recipe.camera;
        view.choose(Show::of_means(stage.sight.means));
        match stage.sight.means {
            Means::Luminance(range) => view.tone.range = range,
            Means::Wipe(divider) => {
                view.partner = Partner::Usual;
                view.toggle(Mode::Wipe);
                view.divider = divider;
            }
            _ => {}
        }
        match stage.sight.part {
            Some(part) => placement.show_part(part),
            None => placement.fit(),
        }
        let origin = Arc::clone(&document.origin);
        Sight { before, view: of_before, placement: placed, origin, looks: looks(view) }
    }

    /// Whether the window still shows it.
    pub fn lasts(&self, document: &Document, view: &ViewState) -> bool {
        self.is_of(document) && self.looks == looks(view)
    }

    /// Whether its stage is shown, changed or not.
    pub fn is_of(&self, document: &Document) -> bool {
        Arc::ptr_eq(&self.origin, &document.origin)
    }

    /// Returns to what was shown before. A camera that was moved meanwhile stays.
    pub fn end(self, document: &mut Document, view: &mut ViewState, placement: &mut Placement) {
        if self.is_of(document) && document.camera == self.origin.recipe.camera {
            document.camera = self.before;
        }
        // Only what the sight has set; the rest is the user's.
        let user = std::mem::replace(view, self.view);
        view.tone = Tone { range: view.tone.range, ..user.tone };
        (view.kept, view.is_denoised, view.denoised) = (user.kept, user.is_denoised, user.denoised);
        *placement = self.placement;
    }
}

fn looks(view: &ViewState) -> (Show, Option<Mode>, Partner) {
    (view.show(), view.mode(), view.partner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::Origin;

    fn stage(id: &str) -> (&'static Stage, Document) {
        let stage = Stage::find(id).unwrap();
        (stage, Document::new(Origin::of_stage(stage)))
    }

    #[test]
    fn a_camera_that_was_moved_meanwhile_stays() {
        let (stage, mut document) = stage("metal");
        let (mut view, mut placement) = (ViewState::default(), Placement::default());
        let sight = Sight::show(stage, &mut document, &mut view, &mut placement);
        sight.end(&mut document, &mut view, &mut placement);
        document.camera.vfov_degrees = 33.0;
        let sight = Sight::show(stage, &mut document, &mut view, &mut placement);
        document.camera.vfov_degrees = 44.0;
        (view.is_denoised, view.tone.exposure) = (true, 1.0);
        sight.end(&mut document, &mut view, &mut placement);
        assert_eq!(document.camera.vfov_degrees, 44.0);
        assert!(view.is_denoised && view.tone.exposure == 1.0, "what was chosen meanwhile stays");
    }
}
