//! The partner of a comparison: the other picture.

use super::{Device, Document, KeptList, Origin};
use crate::job::recipe::Recipe;
use crate::stages::Stage;
use std::sync::Arc;

/// The other picture of a comparison.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum Partner {
    /// The stage that belongs to this one; without a stage, the book's own arithmetic.
    #[default]
    Usual,
    Stage(&'static Stage),
    /// The same picture by the book's own arithmetic.
    Book,
    /// The same picture, traced on another device.
    Device(Device),
    /// The kept picture, or picture of a file, of this number.
    Kept(u64),
    /// The picture of the user's own program, which is checked.
    Mine,
}

impl Partner {
    /// The stage or the arithmetic to compare a picture with, unless the user chooses another one.
    pub fn usual(document: &Document) -> Option<Partner> {
        let stage = document.stage().map(partner_stage);
        let book = || document.origin.is_other_by_the_book().then_some(Partner::Book);
        stage.map_or_else(book, |other| other.map(Partner::Stage))
    }

    /// Its name in menus and on the picture, and in a column of numbers.
    pub fn names(self, kept: &KeptList) -> [String; 2] {
        let both = |name: &str| [name.to_owned(), name.to_owned()];
        match self {
            Partner::Usual => both("–"),
            Partner::Stage(stage) => [format!("{} {}", stage.section, stage.title), stage.section.to_owned()],
            Partner::Book => ["The book’s arithmetic".to_owned(), "the book".to_owned()],
            Partner::Device(device) => both(device.label()),
            Partner::Kept(number) => kept.find(number).map_or_else(Default::default, |found| {
                let short = format!("kept {}", kept.place(found) + 1);
                [kept.title(found), if found.document.is_some() { short } else { found.name.clone() }]
            }),
            Partner::Mine => {
                let name = kept.mine.as_ref().map_or("", |mine| &mine.name);
                [format!("Yours: {name}"), "yours".to_owned()]
            }
        }
    }

    /// The names of the picture that is compared with it: what tells the two apart.
    pub fn names_of_mine(self, document: &Document, device: Device) -> [String; 2] {
        let both = |name: &str| [name.to_owned(), name.to_owned()];
        match self {
            Partner::Device(_) => both(device.label()),
            Partner::Mine => [format!("Ours: {}", document.title()), "ours".to_owned()],
            Partner::Usual | Partner::Stage(_) | Partner::Book | Partner::Kept(_) => {
                [document.title(), document.place()]
            }
        }
    }

    /// Whether its picture has the same samples, apart from rounding.
    pub fn has_same_samples(self) -> bool {
        matches!(self, Partner::Device(_) | Partner::Book)
    }

    /// The origin of its picture, if that is traced.
    pub fn origin(self, mine: &Document) -> Option<Arc<Origin>> {
        match self {
            Partner::Stage(stage) => Some(Arc::new(Origin::of_stage(stage))),
            Partner::Book => Some(Arc::new(mine.origin.by_the_book(&mine.checked))),
            Partner::Device(_) => Some(Arc::clone(&mine.origin)),
            Partner::Usual | Partner::Kept(_) | Partner::Mine => None,
        }
    }

    /// Its picture of this origin, in the size of `mine` and seen by the same camera, unless the two differ in that.
    pub fn document(self, origin: &Arc<Origin>, mine: &Document) -> Document {
        let (theirs, base) = (&origin.recipe, &mine.origin.recipe);
        let mut document = mine.clone();
        if matches!(self, Partner::Device(_)) {
            return document;
        }
        if theirs.settings.max_depth != base.settings.max_depth {
            document.settings.max_depth = theirs.settings.max_depth;
        }
        if origin.usual_stop() != mine.origin.usual_stop() {
            document.stop = origin.usual_stop();
        }
        if differ_in_camera(base, theirs) {
            document.camera = theirs.camera;
        }
        (document.origin, document.checked) = (Arc::clone(origin), Arc::clone(&origin.scene));
        document
    }
}

/// The stage that `stage` is compared with, if one teaches something.
fn partner_stage(stage: &Stage) -> Option<&'static Stage> {
    Stage::find(stage.pair?).ok()
}

/// Whether the recipes differ only in their cameras.
fn differ_in_camera(a: &Recipe, b: &Recipe) -> bool {
    a.camera != b.camera && a.rules == b.rules && a.scene == b.scene
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::stress::shown_cases;
    use crate::stages::SurfaceRule;

    fn of(partner: Partner, mine: &Document) -> Document {
        partner.document(&partner.origin(mine).unwrap(), mine)
    }

    #[test]
    fn the_other_stage_shares_the_camera_unless_cameras_differ() {
        let mut of_cameras = Vec::new();
        for stage in Stage::ALL {
            let mut mine = Document::new(Origin::of_stage(stage));
            mine.camera.look_from += glam::DVec3::new(0.25, 0.5, 0.125);
            let Some(other) = partner_stage(stage) else { continue };
            let theirs = of(Partner::Stage(other), &mine);
            if differ_in_camera(&stage.recipe(), &other.recipe()) {
                of_cameras.push(stage.id);
                assert_ne!(theirs.camera, mine.camera, "{}", stage.id);
            } else {
                assert_eq!(theirs.camera, mine.camera, "{}", stage.id);
            }
        }
        assert!(of_cameras.contains(&"fov-wide") && !of_cameras.contains(&"glass-schlick"), "{of_cameras:?}");
    }

    #[test]
    fn the_book_traces_the_same_picture_by_its_own_rules() {
        for case in shown_cases() {
            let mine = Document::new(Origin::of_case(case));
            let theirs = of(Partner::Book, &mine);
            assert_eq!(theirs.rules().surface, SurfaceRule::Book, "{}", case.id);
            assert_eq!(
                (theirs.camera, theirs.settings, theirs.stop),
                (mine.camera, mine.settings, mine.stop)
            );
        }
    }
}
