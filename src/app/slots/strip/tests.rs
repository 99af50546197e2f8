//! Tests of the strip of slots.

use super::*;
use crate::app::model::document::Document;
use crate::app::model::kept::Kept;
use crate::app::tests::{dressed, facts_of};
use crate::film::{Film, PixelSum};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::sync::Arc;

const ONE: SlotNumber = SlotNumber::ALL[0];
const TWO: SlotNumber = SlotNumber::ALL[1];
const THREE: SlotNumber = SlotNumber::ALL[2];
const FIVE: SlotNumber = SlotNumber::ALL[4];

struct Shown {
    strip: Strip,
    facts: Facts,
    commands: Vec<Command>,
}

impl Shown {
    fn slots(&mut self) -> &mut Slots {
        &mut self.facts.model.view.slots
    }
}

fn slot(document: &Document, size: [u32; 2], name: &str) -> Slot {
    slot_of(document, size, name, 1 << 20)
}

/// A slot with a picture of one colour, which is brighter with a larger sum.
fn slot_of(document: &Document, [width, height]: [u32; 2], name: &str, sum: u64) -> Slot {
    let mut film = Film::new(width, height, 2);
    film.halves_mut().iter_mut().flatten().for_each(|pixel| *pixel = PixelSum([sum; 3]));
    film.record(0..8, 0).unwrap();
    let kept = Kept::new(document.clone(), film, Arc::default(), None);
    Slot { name: name.to_owned(), kept: Arc::new(kept) }
}

/// The strip with a picture of the live one's size, a wide one, a tall one, and one that is being read.
fn strip() -> Harness<'static, Shown> {
    let mut facts = facts_of("--stage metal --size 8x6");
    let document = facts.model.document.clone();
    let slots = &mut facts.model.view.slots;
    for (number, size, name) in
        [(ONE, [8, 6], "as large"), (TWO, [300, 50], "wide"), (THREE, [6, 60], "tall")]
    {
        slots.put(number, slot(&document, size, name));
    }
    let (name, id, size) = ("the fifth".to_owned(), "5".to_owned(), [64, 36]);
    slots.expect(FIVE, Coming { name, id, size, samples: 7, has_own_size: true });
    let draw = |ui: &mut Ui, Shown { strip, facts, commands }: &mut Shown| {
        let mut slots = facts.model.view.slots.clone();
        strip.ui(ui, &mut slots, facts, commands);
        facts.model.view.slots = slots;
    };
    let shown = Shown { strip: Strip::default(), facts, commands: Vec::new() };
    let mut harness = dressed([1700.0, 240.0]).build_ui_state(draw, shown);
    harness.run_steps(2);
    harness
}

#[test]
fn every_control_of_the_strip_gives_its_command_for_its_slot() {
    let mut harness = strip();
    let mut click = |name: &str| {
        harness.state_mut().slots().choose(THREE);
        harness.get_by_label(name).click();
        harness.run_steps(4);
        let chosen = harness.state_mut().slots().chosen().unwrap();
        (std::mem::take(&mut harness.state_mut().commands), chosen)
    };
    let of_slot = Command::Slot;
    for (name, command) in
        [("Keep", SlotCommand::Keep), ("Flip", SlotCommand::Swap), ("Slot 2", SlotCommand::Look(TWO))]
    {
        assert_eq!(click(name), (vec![of_slot(command)], THREE), "{name}");
    }
    assert_eq!(click("Live"), (vec![], THREE), "it is shown");
    for (name, command) in [
        ("Wipe against the slot 1", SlotCommand::Wipe),
        ("Difference from the slot 1", SlotCommand::Difference),
        ("Is it only noise? 1", SlotCommand::OnlyNoise),
    ] {
        assert_eq!(click(name), (vec![of_slot(command)], ONE), "{name}");
    }
    assert_eq!(click("Difference from the slot 2"), (vec![], THREE), "it has another size");
    let size = click("Set the picture to the size of slot 2");
    assert_eq!(size, (vec![of_slot(SlotCommand::TakeSize)], TWO));
    assert_eq!(click("Name of slot 1"), (vec![], ONE));
    let look = of_slot(SlotCommand::Look(TWO));
    for (command, expected) in [
        (of_slot(SlotCommand::Open), vec![of_slot(SlotCommand::Open)]),
        (Command::Save(OutputFormat::Exr), vec![look, Command::Save(OutputFormat::Exr)]),
        (Command::CopyPicture, vec![look, Command::CopyPicture]),
        (of_slot(SlotCommand::Delete), vec![of_slot(SlotCommand::Delete)]),
    ] {
        assert_eq!(click("More about slot 2"), (vec![], THREE), "the menu is open");
        assert_eq!(click(&command.name()), (expected, TWO), "{command:?}");
    }
}
