//! Tests of slots.

use super::*;
use crate::app::model::document::Document;
use crate::app::model::origin::Origin;
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
