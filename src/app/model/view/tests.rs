//! Tests of what the viewport shows.

use super::*;
use crate::app::model::slots::Slot;
use crate::film::Film;

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
