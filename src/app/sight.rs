//! "Show me": what the window showed before a sight, to return to it.

use super::model::document::Document;
use super::model::origin::Origin;
use super::model::show::Show;
use super::model::view::{Mode, ViewState, With};
use super::viewport::Placement;
use crate::scene::Camera;
use crate::stages::{Means, Stage};
use std::sync::Arc;

/// A sight that is shown, and what was shown before.
pub struct Sighted {
    origin: Arc<Origin>,
    looks: (Show, Option<Mode>),
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
            looks: (view.show(), view.mode()),
            view: view.clone(),
            placement: placement.clone(),
            camera: (document.camera != home).then_some(document.camera),
        };
        document.camera = home;
        view.look(None);
        view.choose(Show::of_means(stage.sight.means));
        match stage.sight.means {
            Means::Luminance(range) => view.tone.range = range,
            Means::Wipe(divider) => {
                view.is_with_next = false;
                view.toggle(Mode::Wipe, With::Stage);
                (view.divider, view.is_divider_unplaced) = (divider, false);
            }
            _ => {}
        }
        match stage.sight.part {
            Some(part) => placement.show_part(part),
            None => placement.fit(),
        }
        before.looks = (view.show(), view.mode());
        before
    }

    /// Whether the window still shows it.
    pub fn lasts(&self, document: &Document, view: &ViewState) -> bool {
        Arc::ptr_eq(&self.origin, &document.origin)
            && self.looks == (view.show(), view.mode())
            && view.slots.looked().is_none()
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
        let (exposure, reference) = (view.tone.exposure, view.reference.take());
        let slots = std::mem::take(&mut view.slots);
        *view = self.view;
        (view.slots, view.reference, view.tone.exposure) = (slots, reference, exposure);
        *placement = self.placement;
    }

    /// Whether the camera was brought back to the stage's.
    pub fn has_moved_camera(&self) -> bool {
        self.camera.is_some()
    }
}
