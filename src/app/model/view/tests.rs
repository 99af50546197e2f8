//! Tests of what the viewport shows.

use super::*;
use crate::app::model::origin::Source;
use crate::app::model::slots::Slot;
use crate::film::Film;
use crate::measure::stress::shown_cases;

fn by_the_book(mine: &Document) -> Other {
    Other::ByTheBook(Arc::clone(&mine.origin), Arc::clone(&mine.checked))
}

#[test]
fn what_is_no_stage_is_compared_with_the_books_arithmetic() {
    let mut view = ViewState::default();
    for case in shown_cases() {
        let mine = Document::new(Origin::of_case(case));
        assert_eq!(view.other(&mine), Some(by_the_book(&mine)));
    }
    let stage = Document::new(Origin::of_stage(Stage::find("metal").unwrap()));
    assert!(matches!(view.other(&stage), Some(Other::Stage(_))));
    view.toggle(Mode::Wipe, With::Book);
    assert!(matches!(view.other(&stage), Some(Other::ByTheBook(..))));
    let no_rays = Document::new(Origin::of_stage(Stage::find("ppm-tiny").unwrap()));
    assert_eq!(view.other(&no_rays), None);
}

#[test]
fn every_stage_has_something_to_be_compared_with() {
    let mut view = ViewState::default();
    for stage in Stage::ALL {
        view.is_with_next = false;
        assert!(view.other_of(stage).is_some_and(|other| other != stage));
        view.is_with_next = true;
        assert!(view.other_of(stage).is_some_and(|other| other != stage));
    }
}

#[test]
fn one_thing_at_a_time_is_looked_at() {
    let film = Arc::new(ReferenceMeans { width: 1, height: 1, means: vec![[0.0; 3]], identity: None });
    let mut view = ViewState { reference: Some(Arc::clone(&film)), ..ViewState::default() };
    view.choose(Show::Error);
    assert_eq!((view.show(), view.of_film(None)), (Show::Error, View::StandardError));
    view.toggle(Mode::Difference, With::Stage);
    assert_eq!((view.show(), view.mode()), (Show::Picture, Some(Mode::Difference)));
    assert_eq!(view.of_film(None), View::Picture, "until there is a second picture");
    assert_eq!(view.of_film(Some(&film)), View::Difference(Arc::clone(&film)));
    view.toggle(Mode::Wipe, With::Stage);
    assert_eq!(view.of_film(Some(&film)), View::Picture);
    view.toggle(Mode::Wipe, With::Stage);
    assert_eq!(view.mode(), None);
    view.toggle(Mode::Wipe, With::Book);
    view.choose(Show::Difference);
    assert_eq!((view.mode(), view.of_film(None)), (None, View::Difference(film)));
}

/// However a comparison ends, the next one is with the stage.
#[test]
fn a_comparison_that_has_ended_leaves_nothing_behind() {
    let ends: [fn(&mut ViewState); 4] = [
        |view| view.choose(Show::Picture),
        |view| view.toggle(Mode::Wipe, With::Book),
        |view| view.look(Some(ONE)),
        ViewState::end_comparison,
    ];
    for (index, end) in ends.into_iter().enumerate() {
        let (mut view, document) = with_slots();
        view.toggle(Mode::Wipe, With::Book);
        assert!(matches!(view.compared(&document), Some(Other::ByTheBook(..))), "{index}");
        end(&mut view);
        assert_eq!((view.mode(), view.with()), (None, With::Stage), "{index}");
    }
}

/// A view with two slots in use, of a picture of 4 by 2 pixels and one of 8 by 8.
fn with_slots() -> (ViewState, Document) {
    let mut document = Document::new(Origin::of_stage(Stage::find("metal").unwrap()));
    document.give_size([4, 2]);
    let mut view = ViewState::default();
    for (number, size) in [(ONE, [4, 2]), (TWO, [8, 8])] {
        let mut film = Film::new(size[0], size[1], 1);
        film.record(0..1, 0).unwrap();
        let kept = Arc::new(Kept::new(document.clone(), film, Arc::default(), None));
        view.slots.put(number, Slot { name: String::new(), kept });
    }
    (view, document)
}

const ONE: SlotNumber = SlotNumber::ALL[0];
const TWO: SlotNumber = SlotNumber::ALL[1];

#[test]
fn no_picture_is_compared_with_itself() {
    let (mut view, _) = with_slots();
    let state = |view: &ViewState| (view.mode(), view.compared_slot(), view.slots.looked());
    view.look(Some(ONE));
    view.toggle(Mode::Wipe, With::Slot(ONE));
    assert_eq!(state(&view), (Some(Mode::Wipe), Some(ONE), None));
    assert_eq!((view.divider, view.is_divider_unplaced), (0.5, true));
    (view.divider, view.is_divider_unplaced) = (0.25, false);
    view.toggle(Mode::Difference, With::Slot(ONE));
    assert_eq!((view.mode(), view.divider, view.is_divider_unplaced), (Some(Mode::Difference), 0.5, false));
    view.toggle(Mode::Difference, With::Slot(ONE));
    assert_eq!(state(&view), (None, None, None));
    view.look(Some(TWO));
    view.toggle(Mode::Wipe, With::Slot(ONE));
    assert_eq!(state(&view), (Some(Mode::Wipe), Some(ONE), Some(TWO)), "two slots");
    view.look(Some(ONE));
    assert_eq!(state(&view), (None, None, Some(ONE)), "it is the compared one");
    view.toggle(Mode::Wipe, With::Stage);
    assert_eq!(state(&view), (Some(Mode::Wipe), None, None), "the live picture is compared");
    view.swap();
    assert_eq!(state(&view), (None, None, Some(ONE)), "a slot is not compared with a stage");
}

#[test]
fn a_slot_of_another_size_is_wiped_but_not_subtracted() {
    let (mut view, document) = with_slots();
    for (mode, number, is_possible) in [
        (Mode::Wipe, ONE, true),
        (Mode::Wipe, TWO, true),
        (Mode::Difference, ONE, true),
        (Mode::Difference, TWO, false),
        (Mode::Wipe, SlotNumber::ALL[2], false),
    ] {
        view.end_comparison();
        assert!(view.compared(&document).is_none() && view.wiped(&document).is_none());
        view.toggle(mode, With::Slot(number));
        assert_eq!(view.compared(&document).is_some(), is_possible, "{mode:?} {number}");
        assert_eq!(view.is_other_earlier(&document), is_possible, "a slot is at the left");
        let wiped = view.wiped(&document).map(|(kept, fitted)| (kept.size(), fitted.part()));
        let expected = match (mode, number) {
            (Mode::Wipe, ONE) => Some(([4, 2], [0.0, 0.0, 1.0, 1.0])),
            (Mode::Wipe, TWO) => Some(([8, 8], [0.25, 0.0, 0.75, 1.0])),
            _ => None,
        };
        assert_eq!(wiped, expected, "{mode:?} {number}");
    }
}

#[test]
fn the_earlier_stage_is_at_the_left_and_cameras_that_differ_stay() {
    let stage = |id| Document::new(Origin::of_stage(Stage::find(id).unwrap()));
    let mut view = ViewState { is_with_next: true, ..ViewState::default() };
    assert!(!view.is_other_earlier(&stage("book")), "nothing is compared");
    view.toggle(Mode::Wipe, With::Stage);
    assert_eq!(
        ["ppm-tiny", "metal", "book"].map(|id| view.is_other_earlier(&stage(id))),
        [false, false, true]
    );
    view.is_with_next = false;
    let has_other =
        |view: &ViewState| ["view-distant", "glass-schlick"].map(|id| view.has_other_camera(&stage(id)));
    assert_eq!(has_other(&view), [true, false]);
    view.toggle(Mode::Wipe, With::Book);
    assert_eq!(has_other(&view), [false, false]);
    let (mut moved, book) = (stage("book").recipe(), stage("book").recipe());
    assert!(!differ_in_camera(&moved, &book));
    moved.camera.vfov_degrees += 1.0;
    assert!(differ_in_camera(&moved, &book));
    moved.rules.antialiasing = !moved.rules.antialiasing;
    assert!(!differ_in_camera(&moved, &book), "in more than that");
}

#[test]
fn what_is_subtracted_is_the_film_of_the_shown_difference() {
    let film = || Arc::new(ReferenceMeans { width: 1, height: 1, means: vec![[0.0; 3]], identity: None });
    let (loaded, other) = (film(), film());
    let mut view = ViewState { reference: Some(Arc::clone(&loaded)), ..ViewState::default() };
    let is = |view: &ViewState, expected: &Arc<ReferenceMeans>| {
        view.subtracted(Some(&other)).is_some_and(|film| Arc::ptr_eq(film, expected))
    };
    assert!(view.subtracted(Some(&other)).is_none());
    view.choose(Show::Difference);
    assert!(is(&view, &loaded));
    view.toggle(Mode::Difference, With::Stage);
    assert!(is(&view, &other) && view.subtracted(None).is_none());
    view.toggle(Mode::Wipe, With::Stage);
    assert!(view.subtracted(Some(&other)).is_none());
}

/// A view with three slots in use, whose pictures have these sizes.
fn with_sizes(sizes: [[u32; 2]; 3]) -> ViewState {
    let mut view = ViewState::default();
    for (number, size) in SlotNumber::ALL.into_iter().zip(sizes) {
        let mut document = Document::new(Origin::of_stage(Stage::find("metal").unwrap()));
        document.give_size(size);
        let mut film = Film::new(size[0], size[1], 1);
        film.record(0..1, 0).unwrap();
        let kept = Arc::new(Kept::new(document, film, Arc::default(), None));
        view.slots.put(number, Slot { name: String::new(), kept });
    }
    view
}

#[test]
fn two_slots_are_compared_by_their_own_sizes() {
    let mut live = Document::new(Origin::of_stage(Stage::find("metal").unwrap()));
    live.give_size([4, 2]);
    let three = SlotNumber::ALL[2];
    let mut view = with_sizes([[4, 2], [8, 8], [8, 8]]);
    for (looked, with, is_possible) in
        [(None, ONE, true), (None, TWO, false), (Some(TWO), three, true), (Some(TWO), ONE, false)]
    {
        view.end_comparison();
        view.look(looked);
        assert_eq!(view.shown_document(&live).size(), looked.map_or([4, 2], |_| [8, 8]));
        view.toggle(Mode::Difference, With::Slot(with));
        assert_eq!(view.compared(&live).is_some(), is_possible, "{looked:?} and {with}");
    }
    view.toggle(Mode::Wipe, With::Slot(ONE));
    let wiped = view.wiped(&live).map(|(kept, fitted)| (kept.size(), fitted.part()));
    assert_eq!(wiped, Some(([4, 2], [0.0, 0.25, 1.0, 0.75])), "in the place of the slot that is shown");
}

#[test]
fn looking_again_at_what_is_shown_keeps_the_comparison() {
    let (mut view, _) = with_slots();
    view.look(Some(TWO));
    view.toggle(Mode::Wipe, With::Slot(ONE));
    (view.divider, view.is_divider_unplaced) = (0.25, false);
    view.look(Some(TWO));
    assert_eq!(
        (view.mode(), view.compared_slot(), view.slots.looked()),
        (Some(Mode::Wipe), Some(ONE), Some(TWO))
    );
    assert_eq!((view.divider, view.is_divider_unplaced), (0.25, false));
}

#[test]
fn a_stage_is_compared_with_its_pair_or_with_its_neighbour() {
    let others = |is_with_next| {
        let view = ViewState { is_with_next, ..ViewState::default() };
        let other = |id| view.other_of(Stage::find(id).unwrap()).map_or("", |stage| stage.id);
        ["ppm-tiny", "gamut", "metal-fuzzy", "glass-schlick", "book"].map(other)
    };
    assert_eq!(others(false), ["ppm-gradient", "metal", "metal", "glass-refract", "defocus"]);
    assert_eq!(others(true), ["ppm-gradient", "metal", "glass-refract", "hollow-glass", "defocus"]);
}

/// Where it is another one, it is traced anew.
#[test]
fn the_other_picture_is_another_one_if_it_has_other_spheres_or_comes_from_elsewhere() {
    let mine = Document::new(Origin::of_stage(Stage::find("metal").unwrap()));
    let scene = CheckedScene::new(Arc::clone(mine.checked.scene()), *mine.rules());
    let edited = Document { checked: Arc::new(scene), ..mine.clone() };
    let origin = Arc::new(mine.origin.with_recipe(mine.origin.recipe.clone()));
    let elsewhere = Document { origin, ..mine.clone() };
    let stage = |id| Other::Stage(Stage::find(id).unwrap());
    let (view, _) = with_slots();
    let kept = |number| Other::Kept(Arc::clone(&view.slots.get(number).unwrap().kept));
    let all = || {
        let [mine, edited, elsewhere] = [&mine, &edited, &elsewhere].map(by_the_book);
        [mine, edited, elsewhere, stage("metal"), stage("book"), kept(ONE), kept(TWO)]
    };
    for (row, a) in all().iter().enumerate() {
        for (column, b) in all().iter().enumerate() {
            assert_eq!(a == b, row == column, "{row} and {column}");
        }
    }
    // Each is traced, or was, as its origin says.
    assert_eq!(stage("book").origin().source, Source::Stage(Stage::find("book").unwrap()));
    assert_eq!(by_the_book(&mine).origin().source, Source::ByTheBook);
    assert!(Arc::ptr_eq(by_the_book(&edited).origin().scene.scene(), edited.checked.scene()));
    let document = &view.slots.get(TWO).unwrap().kept.document;
    assert!(Arc::ptr_eq(&kept(TWO).origin(), &document.origin));
}
