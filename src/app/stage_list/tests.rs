//! Tests of the list of stages.

use super::*;
use crate::app::tests::{dressed, facts_of};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

struct List {
    facts: Facts,
    thumbnails: Thumbnails,
    commands: Vec<Command>,
    /// The room that the list takes.
    room: Rect,
    is_open: bool,
}

fn list(words: &str, height: f32) -> Harness<'static, List> {
    let (thumbnails, commands, room) = (Thumbnails::default(), Vec::new(), Rect::NOTHING);
    let list = List { facts: facts_of(words), thumbnails, commands, room, is_open: true };
    let draw = |ui: &mut Ui, List { facts, thumbnails, commands, room, is_open }: &mut List| {
        if !*is_open {
            return;
        }
        ui.set_width(WIDTH);
        super::ui(ui, thumbnails, facts, commands);
        *room = ui.min_rect();
    };
    dressed([400.0, height]).build_ui_state(draw, list)
}

/// Types letter by letter.
fn type_in(harness: &mut Harness<'_, List>, text: &str) {
    for letter in text.chars() {
        harness.event(Event::Text(letter.to_string()));
        harness.run_steps(1);
    }
    harness.run_steps(2);
}

/// The stages whose rows are there.
fn listed(harness: &Harness<'_, List>) -> Vec<&'static str> {
    let is_there = |stage: &&'static Stage| harness.query_by_label(&Command::Stage(stage).name()).is_some();
    Stage::ALL.iter().filter(is_there).map(|stage| stage.id).collect()
}

#[test]
fn typing_leaves_the_stages_with_these_words() {
    let mut harness = list("--stage sky --size 32x18", 700.0);
    harness.run_steps(4);
    type_in(&mut harness, "schl");
    assert_eq!(listed(&harness), ["glass-schlick"]);
    assert!(harness.query_by_label_contains("\"schl\"").is_some());
    (0..4).for_each(|_| harness.key_press(Key::Backspace));
    harness.run_steps(3);
    assert!(listed(&harness).len() > 1);
    // A space is no choice, and arrows stay among what was found.
    type_in(&mut harness, "glass 11");
    harness.key_press(Key::Space);
    harness.run_steps(3);
    let (few, expected) = (listed(&harness), found("glass 11"));
    assert_eq!(few, expected.iter().map(|stage| stage.id).collect::<Vec<_>>());
    assert!(few.len() > 1 && harness.state().commands.is_empty(), "{few:?}");
    for key in [Key::PageDown, Key::PageUp, Key::ArrowDown] {
        harness.key_press(key);
        harness.run_steps(3);
    }
    harness.key_press(Key::Enter);
    harness.run_steps(3);
    assert_eq!(harness.state().commands, [Command::Stage(expected[1])]);
}

#[test]
fn arrows_go_through_the_list_as_far_as_it_goes_and_enter_chooses() {
    let last = Stage::ALL.len() - 1;
    for (words, keys, expected) in [
        ("--stage glass-schlick --size 32x18", [(Key::ArrowDown, 2), (Key::ArrowUp, 1)], 1),
        ("--stage ppm-tiny", [(Key::ArrowUp, 3), (Key::ArrowDown, 0)], 0),
        ("--stage book", [(Key::ArrowDown, 3), (Key::ArrowUp, 0)], 0),
    ] {
        let mut harness = list(words, 500.0);
        harness.run_steps(4);
        let here = harness.state().facts.document().stage().unwrap().index();
        for (key, count) in keys {
            for _ in 0..count {
                harness.key_press(key);
                harness.run_steps(3);
            }
        }
        harness.key_press(Key::Enter);
        harness.run_steps(3);
        let chosen = &Stage::ALL[(here + expected).min(last)];
        assert_eq!(harness.state().commands, [Command::Stage(chosen)], "{words}");
    }
}
