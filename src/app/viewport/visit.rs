//! Short visits, such as "Show me" and the pictures of a check: what the window showed before, to return to it.

use super::placement::Placement;
use crate::app::model::{Document, Mode, Partner, Show, ViewState};
use crate::stages::{Means, Stage};
use std::sync::Arc;

/// Something that is shown for a while, and what was shown before.
pub struct Visit {
    before: Document,
    pub view: ViewState,
    placement: Placement,
    /// The document of the visit.
    shown: Document,
    looks: (Show, Option<Mode>, Partner),
}

impl Visit {
    /// Notes what is shown before a visit.
    pub fn from(document: &Document, view: &ViewState, placement: &Placement) -> Self {
        Visit {
            before: document.clone(),
            view: view.clone(),
            placement: placement.clone(),
            shown: document.clone(),
            looks: looks(view),
        }
    }

    /// Notes what the visit shows.
    pub fn at(self, document: &Document, view: &ViewState) -> Self {
        Visit { shown: document.clone(), looks: looks(view), ..self }
    }

    /// Shows the sight of a stage.
    pub fn sight(
        stage: &Stage,
        document: &mut Document,
        view: &mut ViewState,
        placement: &mut Placement,
    ) -> Self {
        let visit = Visit::from(document, view, placement);
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
        visit.at(document, view)
    }

    /// Whether the window still shows it.
    pub fn lasts(&self, document: &Document, view: &ViewState) -> bool {
        self.is_of(document) && self.looks == looks(view)
    }

    /// Whether its picture is shown, changed or not.
    pub fn is_of(&self, document: &Document) -> bool {
        Arc::ptr_eq(&self.shown.origin, &document.origin)
    }

    /// Returns to what was shown before. A camera that was moved meanwhile stays, and so does another picture that was
    /// edited. Returns whether another picture is shown now.
    pub fn end(self, document: &mut Document, view: &mut ViewState, placement: &mut Placement) -> bool {
        let is_unmoved = self.is_of(document) && document.camera == self.shown.camera;
        let is_same = Arc::ptr_eq(&self.before.origin, &self.shown.origin);
        let returns = !is_same && is_unmoved && Arc::ptr_eq(&document.checked, &self.shown.checked);
        if returns {
            *document = self.before;
        } else if is_same && is_unmoved {
            document.camera = self.before.camera;
        }
        let exposure = view.tone.exposure;
        let kept = std::mem::take(&mut view.kept);
        *view = self.view;
        (view.kept, view.tone.exposure) = (kept, exposure);
        *placement = self.placement;
        returns
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
        let sight = Visit::sight(stage, &mut document, &mut view, &mut placement);
        sight.end(&mut document, &mut view, &mut placement);
        document.camera.vfov_degrees = 33.0;
        let sight = Visit::sight(stage, &mut document, &mut view, &mut placement);
        document.camera.vfov_degrees = 44.0;
        sight.end(&mut document, &mut view, &mut placement);
        assert_eq!(document.camera.vfov_degrees, 44.0);
    }

    #[test]
    fn another_view_or_picture_ends_a_sight() {
        let (stage, mut document) = stage("metal");
        let (mut view, mut placement) = (ViewState::default(), Placement::default());
        let sight = Visit::sight(stage, &mut document, &mut view, &mut placement);
        assert!(sight.lasts(&document, &view) && sight.is_of(&document));
        let mut other = view.clone();
        other.choose(if view.show() == Show::Normals { Show::Albedo } else { Show::Normals });
        assert!(!sight.lasts(&document, &other));
        for mode in [Mode::Difference, Mode::Flip] {
            let mut other = view.clone();
            other.toggle(mode);
            assert!(!sight.lasts(&document, &other));
        }
        let again = Document::new(Origin::of_stage(stage));
        assert!(!sight.lasts(&again, &view) && !sight.is_of(&again));
    }

    #[test]
    fn a_visited_picture_gives_way_unless_it_was_edited() {
        let (_, own) = stage("metal");
        let (_, visited) = stage("glass-schlick");
        for is_edited in [false, true] {
            let (mut document, mut view) = (own.clone(), ViewState::default());
            let mut placement = Placement::default();
            let visit = Visit::from(&document, &view, &placement);
            document = visited.clone();
            view.toggle(Mode::Wipe);
            let visit = visit.at(&document, &view);
            if is_edited {
                document.camera.vfov_degrees = 33.0;
            }
            assert_eq!(visit.end(&mut document, &mut view, &mut placement), !is_edited);
            assert_eq!((document == own, view.mode()), (!is_edited, None));
        }
    }
}
