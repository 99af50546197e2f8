//! Tests of the strip of slots.

use super::*;
use crate::app::model::document::Document;
use crate::app::model::kept::Kept;
use crate::app::model::view::{Mode, With};
use crate::app::tests::{dressed, facts_of, leave, rest_at};
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
fn a_long_name_gets_more_room_and_an_ellipsis_where_it_is_cut() {
    let mut harness = strip();
    let width = |harness: &Harness<'_, Shown>| harness.get_by_label("Name of slot 1").rect().width();
    let short = width(&harness);
    let very_long = "a picture of glass ".repeat(9);
    for (name, is_cut) in [("13.2 A lens instead of a pinhole, 36 spp", false), (very_long.as_str(), true)] {
        *harness.state_mut().slots().name_mut(ONE).unwrap() = name.to_owned();
        harness.run_steps(3);
        assert!(width(&harness) > short + 20.0, "{name}");
        let is_ellipsis =
            |shape: &egui::Shape| matches!(shape, egui::Shape::Text(text) if text.galley.text() == "…");
        let has_it = harness.output().shapes.iter().any(|clipped| is_ellipsis(&clipped.shape));
        assert_eq!(has_it, is_cut, "{name}");
    }
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

#[test]
fn the_slot_that_is_looked_at_returns_to_the_live_picture() {
    let mut harness = strip();
    harness.state_mut().facts.model.view.look(Some(TWO));
    harness.run_steps(2);
    harness.get_by_label("Slot 2").click();
    harness.run_steps(2);
    harness.get_by_label("Live").click();
    harness.run_steps(2);
    assert_eq!(harness.state().commands, [Command::Slot(SlotCommand::LookLive); 2]);
}

#[test]
fn a_thumbnail_is_that_of_the_picture_that_is_in_the_slot_now() {
    let mut harness = strip();
    let shown = |harness: &Harness<'_, Shown>| {
        let (_, texture) = harness.state().strip.textures[ONE.index()].as_ref().unwrap();
        texture.colour([0, 0]).unwrap()
    };
    let of_slot = |harness: &mut Harness<'_, Shown>| {
        let rgb8 = harness.state_mut().slots().get(ONE).unwrap().kept.thumbnail.rgb8.clone();
        [rgb8[0], rgb8[1], rgb8[2]]
    };
    let document = harness.state().facts.model.document.clone();
    let mut seen = vec![of_slot(&mut harness)];
    assert_eq!(shown(&harness), seen[0]);
    let changes: [fn(&mut Slots, Slot); 3] = [
        |slots, slot| slots.put(ONE, slot),
        |slots, slot| {
            slots.delete(ONE);
            slots.put(ONE, slot);
        },
        |slots, _| slots.bring_back(),
    ];
    for (change, shift) in changes.into_iter().zip([24, 22, 0]) {
        let picture = slot_of(&document, [8, 6], "another", 1 << shift);
        change(harness.state_mut().slots(), picture);
        harness.run_steps(2);
        let expected = of_slot(&mut harness);
        assert_eq!(shown(&harness), expected);
        assert_ne!(seen.last(), Some(&expected));
        seen.push(expected);
    }
}
