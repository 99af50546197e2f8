//! Tests of slots.

use super::*;
use crate::app::model::document::Document;
use crate::app::model::origin::Origin;
use crate::app::model::sizing::Sizing;
use crate::film::PixelSum;
use crate::stages::Stage;

const ONE: SlotNumber = SlotNumber::ALL[0];
const TWO: SlotNumber = SlotNumber::ALL[1];

fn film(width: u32, height: u32, value: u64) -> Film {
    let mut film = Film::new(width, height, 1);
    film.halves_mut()[0].iter_mut().for_each(|sum| *sum = PixelSum([value << 16; 3]));
    film.record(0..1, 0).unwrap();
    film
}

fn slot(film: Film) -> Slot {
    let document = Document::new(Origin::of_stage(Stage::find("metal").unwrap()));
    let kept = Kept::new(document, film, Arc::default(), None);
    Slot { name: format!("{} samples", kept.samples()), kept: Arc::new(kept) }
}

fn with(numbers: &[SlotNumber]) -> Slots {
    let mut slots = Slots::default();
    numbers.iter().for_each(|number| slots.put(*number, slot(film(4, 2, 1))));
    slots
}

#[test]
fn one_key_flips_between_two_pictures() {
    let mut slots = with(&[ONE, TWO]);
    assert_eq!((slots.looked(), slots.other()), (None, Some(TWO)), "the last one that was kept");
    slots.look(Some(ONE));
    let seen: Vec<_> = (0..3).map(|_| (slots.swap(), slots.looked()).1).collect();
    assert_eq!(seen, [None, Some(ONE), None]);
    slots.look(Some(ONE));
    slots.look(Some(TWO));
    let seen: Vec<_> = (0..3).map(|_| (slots.swap(), slots.looked()).1).collect();
    assert_eq!(seen, [Some(ONE), Some(TWO), Some(ONE)], "between two slots");
    slots.look(Some(SlotNumber::ALL[6]));
    assert_eq!(slots.looked(), Some(ONE), "an empty slot has nothing to look at");
    slots.delete(ONE);
    assert_eq!((slots.looked(), slots.chosen()), (None, Some(TWO)));
}

#[test]
fn what_is_replaced_or_deleted_comes_back_once() {
    let mut slots = with(&[ONE]);
    let first = Arc::clone(&slots.get(ONE).unwrap().kept);
    slots.put(ONE, slot(film(4, 2, 2)));
    assert!(!Arc::ptr_eq(&first, &slots.get(ONE).unwrap().kept));
    slots.bring_back();
    assert!(Arc::ptr_eq(&first, &slots.get(ONE).unwrap().kept));
    slots.delete(ONE);
    assert_eq!((slots.is_used(), slots.gone(), slots.free().next()), (false, Some(ONE), Some(ONE)));
    slots.bring_back();
    assert!(Arc::ptr_eq(&first, &slots.get(ONE).unwrap().kept));
    assert_eq!((slots.gone(), slots.free().next()), (None, Some(TWO)));
}

#[test]
fn what_is_brought_back_goes_past_a_slot_that_waits_for_a_picture() {
    let mut slots = with(&[ONE]);
    let first = Arc::clone(&slots.get(ONE).unwrap().kept);
    slots.delete(ONE);
    slots.expect(ONE, coming("a", [4, 2]));
    assert_eq!((slots.gone(), slots.place_back()), (Some(ONE), Some(TWO)));
    slots.bring_back();
    assert!(Arc::ptr_eq(&first, &slots.get(TWO).unwrap().kept) && slots.get(ONE).is_none());
    let arrived = slot(film(4, 2, 2)).kept;
    slots.arrive("a", Some(Arc::clone(&arrived)));
    assert!(Arc::ptr_eq(&arrived, &slots.get(ONE).unwrap().kept), "both are there");
    assert!(Arc::ptr_eq(&first, &slots.get(TWO).unwrap().kept) && slots.gone().is_none());
}

#[test]
fn what_is_gone_stays_so_while_no_slot_is_free() {
    let mut slots = with(&SlotNumber::ALL);
    let first = Arc::clone(&slots.get(ONE).unwrap().kept);
    slots.delete(ONE);
    slots.expect(ONE, coming("a", [4, 2]));
    slots.bring_back();
    assert_eq!((slots.gone(), slots.place_back()), (Some(ONE), None));
    assert!(slots.get(ONE).is_none());
    let arrived = slot(film(4, 2, 2)).kept;
    slots.arrive("a", Some(Arc::clone(&arrived)));
    slots.bring_back();
    assert!(Arc::ptr_eq(&first, &slots.get(ONE).unwrap().kept));
    slots.bring_back();
    assert!(Arc::ptr_eq(&arrived, &slots.get(ONE).unwrap().kept), "what was in its place comes back, too");
}

#[test]
fn what_is_replaced_does_not_come_back_if_there_is_no_room_for_both() {
    let mut slots = with(&[ONE]);
    let (name, id, size) = ("large".to_owned(), "1".to_owned(), [20_000, 10_000]);
    slots.expect(TWO, Coming { name, id, size, samples: 1, has_own_size: true });
    slots.put(ONE, slot(film(4, 2, 2)));
    assert_eq!(slots.gone(), None);
}

#[test]
fn pictures_get_the_size_of_those_in_the_slots() {
    let document = Document::new(Origin::of_stage(Stage::find("metal").unwrap()));
    for size in [[1037, 583], [333, 187], [640, 360], [1, 1]] {
        let mut slots = Slots::default();
        assert_eq!(slots.room(), None);
        slots.put(ONE, slot(film(size[0], size[1], 1)));
        let found = document.fitting_size(Sizing::Viewport, slots.room().unwrap());
        assert_eq!(found, Some(size));
    }
}

#[test]
fn slots_take_no_more_than_their_limit() {
    // 8 pixels of 24 bytes.
    let mut slots = with(&[ONE, TWO]);
    assert_eq!(slots.bytes(), 384);
    let three = SlotNumber::ALL[2];
    assert!(slots.make_room(three, 192, 576).is_ok());
    let refused = slots.make_room(three, 193, 576).unwrap_err();
    assert!(refused.contains("takes 193 bytes") && refused.contains("take 384 bytes"), "{refused}");
    assert!(refused.contains("may take 576 bytes"), "{refused}");
    // A picture that could be brought back makes room first, then the one that is replaced.
    slots.delete(TWO);
    assert_eq!(slots.bytes(), 384);
    assert!(slots.make_room(three, 384, 576).is_ok());
    assert_eq!((slots.bytes(), slots.gone()), (192, None));
    assert!(slots.make_room(ONE, 576, 576).is_ok());
    assert!(slots.make_room(ONE, 577, 576).is_err());
}

fn coming(id: &str, size: [u32; 2]) -> Coming {
    Coming { name: format!("picture {id}"), id: id.to_owned(), size, samples: 7, has_own_size: false }
}

#[test]
fn a_picture_that_was_waited_for_arrives_in_its_slot() {
    let mut slots = Slots::default();
    assert_eq!((slots.title(ONE).as_str(), slots.is_listed()), ("slot 1: empty", false));
    slots.expect(ONE, coming("a", [4, 2]));
    slots.expect(TWO, coming("b", [4, 2]));
    assert!(slots.is_listed() && !slots.is_used() && slots.room() == Some([4, 3]));
    assert_eq!(slots.free().next(), Some(SlotNumber::ALL[2]));
    assert_eq!(slots.bytes(), 2 * 8 * 48, "two halves each");
    let arrived = slot(film(4, 2, 1)).kept;
    assert_eq!(slots.arrive("c", Some(Arc::clone(&arrived))), None, "nobody waits for it");
    assert_eq!(slots.arrive("a", None), Some((ONE, coming("a", [4, 2]))));
    assert_eq!(
        (slots.is_used(), slots.coming(ONE), slots.chosen()),
        (false, None, None),
        "it cannot be read"
    );
    assert_eq!(slots.arrive("b", Some(Arc::clone(&arrived))), Some((TWO, coming("b", [4, 2]))));
    assert_eq!((slots.title(TWO).as_str(), slots.chosen()), ("slot 2: picture b", Some(TWO)));
    assert_eq!((slots.coming(TWO), slots.looked(), slots.bytes()), (None, None, 192));
    slots.expect(ONE, coming("d", [4, 2]));
    slots.arrive("d", Some(arrived));
    assert_eq!(slots.chosen(), Some(TWO), "what is meant stays");
}

#[test]
fn only_slots_in_use_are_shown_and_meant() {
    let mut slots = with(&[ONE, TWO]);
    slots.choose(SlotNumber::ALL[4]);
    assert_eq!(slots.chosen(), Some(TWO));
    let [three, four] = [SlotNumber::ALL[2], SlotNumber::ALL[3]].map(Some);
    slots.set_places(Places { looked: three, before: Some(ONE), chosen: four });
    assert_eq!(slots.places(), Places { looked: None, before: Some(ONE), chosen: Some(TWO) });
    slots.set_places(Places { looked: Some(TWO), before: three, chosen: Some(ONE) });
    assert_eq!(slots.places(), Places { looked: Some(TWO), before: None, chosen: Some(ONE) });
    slots.delete(ONE);
    assert_eq!(slots.places(), Places { looked: Some(TWO), before: None, chosen: Some(TWO) });
    let other = SlotNumber::ALL[5];
    slots.put(other, slot(film(4, 2, 1)));
    assert_eq!(slots.places(), Places { looked: Some(TWO), before: None, chosen: Some(other) });
    slots.delete(SlotNumber::ALL[8]);
    assert_eq!(slots.gone(), Some(ONE), "nothing was there");
}

#[test]
fn a_picture_that_is_not_kept_for_the_next_window_is_known() {
    let mut slots = with(&[ONE, TWO]);
    let [one, two] = [ONE, TWO].map(|number| Arc::clone(&slots.get(number).unwrap().kept));
    for is_lasting in [false, false, true] {
        slots.note_lasting(&one.id, is_lasting);
        assert_eq!((slots.is_passing(&one), slots.is_passing(&two)), (!is_lasting, false));
        assert_eq!(slots.passing.len(), usize::from(!is_lasting));
    }
}

#[test]
fn the_chosen_picture_decides_the_room_unless_it_has_a_size_of_its_own() {
    let mut slots = with(&[]);
    slots.put(ONE, slot(film(40, 20, 1)));
    slots.put(TWO, slot(film(60, 30, 1)));
    assert_eq!(slots.room(), Some([60, 31]));
    let mut own = slot(film(80, 40, 1));
    let mut document = own.kept.document.clone();
    document.has_own_size = true;
    own.kept = Arc::new(Kept::new(document, film(80, 40, 1), Arc::default(), None));
    slots.put(SlotNumber::ALL[2], own);
    assert_eq!(slots.room(), Some([40, 21]), "the first one");
}

#[test]
fn looking_again_at_what_is_shown_changes_nothing() {
    let mut slots = with(&[ONE, TWO]);
    for (first, second) in [(Some(ONE), Some(TWO)), (Some(TWO), Some(ONE)), (Some(ONE), None)] {
        slots.look(first);
        slots.look(second);
        let places = slots.places();
        slots.look(second);
        assert_eq!(slots.places(), places);
        slots.swap();
        assert_eq!(slots.looked(), first);
    }
    // A picture in the slot that is shown is shown, too.
    slots.put(ONE, slot(film(4, 2, 2)));
    assert_eq!((slots.looked(), slots.other()), (Some(ONE), None), "the live picture was before");
}

#[test]
fn what_is_gone_can_be_brought_back_as_long_as_there_is_room_for_it() {
    let three = SlotNumber::ALL[2];
    let mut slots = with(&[ONE, TWO]);
    let second = Arc::clone(&slots.get(TWO).unwrap().kept);
    slots.delete(TWO);
    // 192 bytes for the picture that is left, and as many for the one that is gone.
    assert!(slots.make_room(three, 192, 576).is_ok());
    assert_eq!((slots.bytes(), slots.gone()), (384, Some(TWO)));
    slots.put(three, slot(film(4, 2, 3)));
    assert_eq!((slots.bytes(), slots.gone()), (576, Some(TWO)));
    slots.bring_back();
    assert!(Arc::ptr_eq(&second, &slots.get(TWO).unwrap().kept));
    slots.delete(TWO);
    assert!(slots.make_room(SlotNumber::ALL[3], 192, 767).is_ok());
    assert_eq!((slots.bytes(), slots.gone()), (384, None), "a byte too much");
}

#[test]
fn the_last_slot_is_meant_after_the_one_that_was() {
    let three = SlotNumber::ALL[2];
    let mut slots = with(&[ONE, TWO, three]);
    slots.choose(TWO);
    slots.delete(three);
    assert_eq!(slots.chosen(), Some(TWO), "another one");
    slots.bring_back();
    slots.choose(TWO);
    slots.delete(TWO);
    assert_eq!(slots.chosen(), Some(three));
    slots.delete(three);
    slots.delete(ONE);
    assert_eq!((slots.chosen(), slots.is_used()), (None, false));
}

#[test]
fn a_slot_in_use_can_be_named() {
    let mut slots = with(&[TWO]);
    assert!(slots.name_mut(ONE).is_none());
    "mine".clone_into(slots.name_mut(TWO).unwrap());
    assert_eq!([ONE, TWO].map(|number| slots.title(number)), ["slot 1: empty", "slot 2: mine"]);
}
