//! "Show me": what the window showed before a sight, to return to it.

use super::model::{Document, Mode, Origin, Show, ViewState, With};
use super::viewport::Placement;
use crate::scene::Camera;
use crate::stages::{Means, Stage};
use std::sync::Arc;

/// A sight that is shown, and what was shown before.
pub struct Sighted {
    origin: Arc<Origin>,
    looks: (Show, Option<Mode>, With),
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
            looks: (view.show(), view.mode(), view.with()),
            view: view.clone(),
            placement: placement.clone(),
            camera: (document.camera != home).then_some(document.camera),
        };
        document.camera = home;
        view.choose(Show::of_means(stage.sight.means));
        match stage.sight.means {
            Means::Luminance(range) => view.tone.range = range,
            Means::Wipe(divider) => {
                view.toggle(Mode::Wipe, With::Stage);
                view.divider = divider;
            }
            _ => {}
        }
        match stage.sight.part {
            Some(part) => placement.show_part(part),
            None => placement.fit(),
        }
        before.looks = (view.show(), view.mode(), view.with());
        before
    }

    /// Whether the window still shows it.
    pub fn lasts(&self, document: &Document, view: &ViewState) -> bool {
        Arc::ptr_eq(&self.origin, &document.origin) && self.looks == (view.show(), view.mode(), view.with())
    }

    /// Whether another picture is shown.
    pub fn is_of_another(&self, document: &Document) -> bool {
        !Arc::ptr_eq(&self.origin, &document.origin)
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
    use crate::app::model::Tone;

    fn stage(id: &str) -> (&'static Stage, Document) {
        let stage = Stage::find(id).unwrap();
        (stage, Document::new(Origin::of_stage(stage)))
    }

    /// A stage whose sight has these means.
    fn with_means(is_it: fn(&Means) -> bool) -> (&'static Stage, Document) {
        let found = Stage::ALL.iter().find(|stage| is_it(&stage.sight.means)).unwrap();
        stage(found.id)
    }

    #[test]
    fn a_sight_shows_its_means_from_the_stages_own_camera_and_returns() {
        let cases: [fn(&Means) -> bool; 3] = [
            |means| matches!(means, Means::Luminance(_)),
            |means| matches!(means, Means::Wipe(_)),
            |means| matches!(means, Means::StandardError),
        ];
        for is_it in cases {
            if !Stage::ALL.iter().any(|stage| is_it(&stage.sight.means)) {
                continue;
            }
            let (stage, mut document) = with_means(is_it);
            let home = document.camera;
            document.camera.vfov_degrees = 33.0;
            let moved = document.camera;
            let mut view = ViewState::default();
            view.tone.expose(1.0);
            let (range, mut placement) = (view.tone.range, Placement::default());
            placement.actual_size();
            let before = placement.zoom;
            let sight = Sighted::begin(stage, &mut document, &mut view, &mut placement);
            assert!(document.camera == home && sight.lasts(&document, &view));
            assert_eq!(view.show(), Show::of_means(stage.sight.means));
            match stage.sight.means {
                Means::Luminance(wanted) => assert_eq!(view.tone.range, wanted),
                Means::Wipe(divider) => {
                    assert_eq!((view.mode(), view.divider), (Some(Mode::Wipe), divider));
                }
                _ => {}
            }
            assert_ne!(placement.zoom, before);
            view.tone.expose(1.0);
            sight.end(&mut document, &mut view, &mut placement);
            assert_eq!((document.camera, placement.zoom), (moved, before));
            assert_eq!((view.show(), view.mode()), (Show::Picture, None));
            assert_eq!(
                view.tone,
                Tone { exposure: 2.0, range, ..Tone::default() },
                "the exposure stays as it was chosen"
            );
        }
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
        other.toggle(Mode::Difference, With::Kept(0));
        assert!(!sight.lasts(&document, &other));
        let mut other = view.clone();
        other.look(0);
        assert!(!sight.lasts(&document, &other));
        let again = Document::new(Origin::of_stage(stage));
        assert!(!sight.lasts(&again, &view) && sight.is_of_another(&again));
    }
}
