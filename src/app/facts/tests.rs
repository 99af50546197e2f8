//! Tests of what is told about commands.

use super::*;
use crate::app::model::device::DeviceOptions;
use crate::app::model::kept::Kept;
use crate::app::model::origin::{Origin, Source};
use crate::app::model::remembered::Remembered;
use crate::app::model::slots::Slot;
use crate::app::model::view::ViewState;
use crate::film::Film;

use crate::job::recipe::Recipe;
use crate::progressive::{EndReason, HistoryPoint, Phase, ReferenceMeans, Stop};
use crate::stages::{Rules, SurfaceRule};

/// A window with this view in which nothing has been traced yet.
fn early(document: Document, view: ViewState) -> Facts {
    let model = Model {
        document,
        selected: None,
        view,
        remembered: Remembered::default(),
        devices: DeviceOptions::default(),
        is_paused: false,
        is_full_screen: false,
        has_first_steps: false,
        presentation: None,
        has_recovered: false,
    };
    Facts {
        model,
        status: Arc::default(),
        speed: None,
        seconds_before: Some(0.0),
        can_undo: false,
        can_redo: false,
        has_pixel: false,
        has_paths: false,
        has_sight: false,
        invalid: None,
    }
}

const ONE: SlotNumber = SlotNumber::ALL[0];

fn stage(id: &str) -> Document {
    let mut document = Document::new(Origin::of_stage(Stage::find(id).unwrap()));
    document.give_size([4, 2]);
    document
}

fn reference([width, height]: [u32; 2]) -> Option<Arc<ReferenceMeans>> {
    let means = vec![[0.5; 3]; (width * height) as usize];
    Some(Arc::new(ReferenceMeans { width, height, means, identity: None }))
}

fn done(facts: &mut Facts) {
    let status = Status {
        phase: Phase::Done(EndReason::Samples),
        samples_per_pixel: 100,
        history: vec![HistoryPoint {
            backend: "cpu",
            samples_per_pixel: 4,
            trace_seconds: 1.0,
            rmse_estimate: 0.1,
            rel_mse_estimate: 0.1,
        }],
        ..Status::default()
    };
    facts.status = Arc::new(status);
    facts.model.document.stop = Stop::at_samples(100);
}

/// A slot with the picture of a document.
fn slot_of(document: &Document) -> Slot {
    let [width, height] = document.size();
    let mut film = Film::new(width, height, document.settings.half_count());
    film.record(0..2, 0).unwrap();
    let kept = Kept::new(document.clone(), film, Arc::default(), None);
    Slot { name: "mine".to_owned(), kept: Arc::new(kept) }
}

/// A window at the picture of a document, with these slots.
fn with_slots(live: Document, documents: &[Document]) -> Facts {
    let mut facts = early(live, ViewState::default());
    for (number, document) in SlotNumber::ALL.into_iter().zip(documents) {
        facts.model.view.slots.put(number, slot_of(document));
    }
    done(&mut facts);
    facts
}

#[test]
fn views_are_those_of_the_picture_on_the_screen() {
    let mut one_half = stage("metal");
    one_half.settings.estimate_error = false;
    let mut wide = stage("metal");
    wide.give_size([5, 2]);
    for (other, show, reason) in [
        (one_half, Show::Error, "The film has one half"),
        (wide, Show::Difference, "The reference film is 4x2 and the picture is 5x2"),
        (stage("normals"), Show::Bounces, "In this stage rays end at their first hit"),
        (stage("ppm-gradient"), Show::Normals, "This stage traces no rays"),
    ] {
        for is_live in [true, false] {
            // One of them is live, and the other one is in a slot.
            let (live, kept) =
                if is_live { (other.clone(), stage("metal")) } else { (stage("metal"), other.clone()) };
            let mut facts = with_slots(live, &[kept]);
            facts.model.view.reference = reference([4, 2]);
            for looked in [None, Some(ONE)] {
                facts.model.view.look(looked);
                let is_other = is_live == looked.is_none();
                let told = facts.disabled_reason(Command::Show(show));
                assert_eq!(told.is_some(), is_other, "{show:?} {is_live} {looked:?}: {told:?}");
                assert!(!is_other || told.is_some_and(|told| told.starts_with(reason)), "{show:?}");
            }
        }
    }
}

#[test]
fn pictures_by_the_books_arithmetic_have_nothing_to_be_compared_with() {
    let recipe = Recipe::builtin("two-spheres").unwrap();
    let rules = Rules { surface: SurfaceRule::Book, ..recipe.rules };
    let by_the_book = Recipe { rules, ..recipe.clone() };
    let built_in = |recipe| Document::new(Origin::new(recipe, Source::Builtin));
    for (document, has_other, has_book) in [
        (built_in(recipe), true, true),
        (built_in(by_the_book), false, false),
        (stage("metal"), true, true),
        // The stage has a neighbour, but another threshold than the book.
        (stage("shadow-acne"), true, false),
    ] {
        let facts = early(document, ViewState::default());
        let is_enabled = |command| facts.disabled_reason(command).is_none();
        let found = [Command::Wipe, Command::WipeDifference, Command::BookArithmetic].map(is_enabled);
        assert_eq!(found, [has_other, has_other, has_book], "{}", facts.title());
    }
}

#[test]
fn what_to_look_for_needs_its_view() {
    // The sight of this stage is a view of the standard error.
    let mut document = stage("three-spheres");
    let reason =
        |document: &Document| early(document.clone(), ViewState::default()).disabled_reason(Command::ShowMe);
    assert_eq!(reason(&document), None);
    document.settings.estimate_error = false;
    assert_eq!(reason(&document).as_deref(), Some("The film has one half; switch on Estimate error"));
}

#[test]
fn a_bookmark_needs_rays_and_a_reload_a_scene_file() {
    let is_enabled =
        |document, command| early(document, ViewState::default()).disabled_reason(command).is_none();
    assert!(is_enabled(stage("metal"), Command::Bookmark(0)));
    assert!(!is_enabled(stage("ppm-tiny"), Command::Bookmark(0)));
    let origin = Origin::new(stage("metal").recipe(), Source::File("a.toml".into()));
    assert!(is_enabled(Document::new(origin), Command::Reload));
}
