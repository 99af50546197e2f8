//! "Show me": what the window showed before a sight, to return to it.

use super::placement::Placement;
use crate::app::model::{Document, Mode, Origin, Partner, Show, ViewState};
use crate::scene::Camera;
use crate::stages::{Means, Stage};
use std::sync::Arc;

/// A sight that is shown, and what was shown before.
pub struct Sighted {
    origin: Arc<Origin>,
    looks: (Show, Option<Mode>, Partner),
    view: ViewState,
    placement: Placement,
    /// The camera before, if it was not the stage's.
    camera: Option<Camera>,
}

impl Sighted {
    /// Shows the sight of a stage.
    pub fn begin(
        stage: &Stage,
        document: &mut Document,
        view: &mut ViewState,
        placement: &mut Placement,
    ) -> Self {
        let home = document.origin.recipe.camera;
        let mut before = Sighted {
            origin: Arc::clone(&document.origin),
            looks: (view.show(), view.mode(), view.partner),
            view: view.clone(),
            placement: placement.clone(),
            camera: (document.camera != home).then_some(document.camera),
        };
        document.camera = home;
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
        before.looks = (view.show(), view.mode(), view.partner);
        before
    }

    /// Whether the window still shows it.
    pub fn lasts(&self, document: &Document, view: &ViewState) -> bool {
        Arc::ptr_eq(&self.origin, &document.origin) && self.looks == (view.show(), view.mode(), view.partner)
    }

    /// Whether another picture is shown.
    pub fn is_of_another(&self, document: &Document) -> bool {
        !Arc::ptr_eq(&self.origin, &document.origin)
    }

    pub fn before(&self) -> &ViewState {
        &self.view
    }

    /// Returns to what was shown before. A camera that was moved meanwhile stays.
    pub fn end(self, document: &mut Document, view: &mut ViewState, placement: &mut Placement) {
        if let Some(camera) = self.camera
            && !self.is_of_another(document)
            && document.camera == document.origin.recipe.camera
        {
            document.camera = camera;
        }
        let exposure = view.tone.exposure;
        let kept = std::mem::take(&mut view.kept);
        *view = self.view;
        (view.kept, view.tone.exposure) = (kept, exposure);
        *placement = self.placement;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stage(id: &str) -> (&'static Stage, Document) {
        let stage = Stage::find(id).unwrap();
        (stage, Document::new(Origin::of_stage(stage)))
    }

    #[test]
    fn a_camera_that_was_moved_meanwhile_stays() {
        let (stage, mut document) = stage("metal");
        let (mut view, mut placement) = (ViewState::default(), Placement::default());
        let sight = Sighted::begin(stage, &mut document, &mut view, &mut placement);
        sight.end(&mut document, &mut view, &mut placement);
        document.camera.vfov_degrees = 33.0;
        let sight = Sighted::begin(stage, &mut document, &mut view, &mut placement);
        document.camera.vfov_degrees = 44.0;
        sight.end(&mut document, &mut view, &mut placement);
        assert_eq!(document.camera.vfov_degrees, 44.0);
    }

    #[test]
    fn another_view_or_picture_ends_a_sight() {
        let (stage, mut document) = stage("metal");
        let (mut view, mut placement) = (ViewState::default(), Placement::default());
        let sight = Sighted::begin(stage, &mut document, &mut view, &mut placement);
        assert!(sight.lasts(&document, &view) && !sight.is_of_another(&document));
        let mut other = view.clone();
        other.choose(if view.show() == Show::Normals { Show::Albedo } else { Show::Normals });
        assert!(!sight.lasts(&document, &other));
        let mut other = view.clone();
        other.toggle(Mode::Difference);
        assert!(!sight.lasts(&document, &other));
        let mut other = view.clone();
        other.toggle(Mode::Flip);
        assert!(!sight.lasts(&document, &other));
        let again = Document::new(Origin::of_stage(stage));
        assert!(!sight.lasts(&again, &view) && sight.is_of_another(&again));
    }
}
