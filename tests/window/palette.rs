//! The palette: what it finds first, and what it says about switches.

use crate::common::{SMALL, has_samples, open, send, until};
use eframe::egui::accesskit::Toggled;
use eframe::egui::{Key, Modifiers, Role};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use weekender::app::{Command, Window};

fn opened() -> Harness<'static, Window> {
    let mut harness = open(SMALL);
    until(&mut harness, "a picture", has_samples(1));
    harness
}

/// Types into a new palette.
fn type_into_palette(harness: &mut Harness<'_, Window>, text: &str) {
    harness.key_press_modifiers(Modifiers::COMMAND, Key::P);
    harness.run_steps(3);
    harness.get_by_label("Command").type_text(text);
    harness.run_steps(3);
}

/// The names of the commands that a text finds, from the top.
fn found(harness: &mut Harness<'_, Window>, text: &str) -> Vec<String> {
    type_into_palette(harness, text);
    let edit = harness.get_by_label("Command").rect();
    let names: Vec<String> = Command::all().into_iter().map(Command::name).collect();
    let mut rows: Vec<(i32, String)> = harness
        .get_all_by_role(Role::Button)
        .filter(|node| node.rect().top() > edit.bottom() && node.rect().width() > 300.0)
        .filter_map(|node| Some((node.rect().top() as i32, node.accesskit_node().label()?)))
        .filter_map(|(top, label)| Some((top, names.iter().find(|name| label.starts_with(*name))?.clone())))
        .collect();
    rows.sort();
    harness.key_press(Key::Escape);
    harness.run_steps(3);
    rows.into_iter().map(|(_, name)| name).collect()
}

#[test]
fn the_palette_says_whether_a_switch_is_on() {
    let mut harness = opened();
    let is_on = |harness: &mut Harness<'_, Window>, name: &str| {
        type_into_palette(harness, name);
        let edit = harness.get_by_label("Command").rect();
        let mut rows = harness.query_all_by_label_contains(name);
        let row = rows
            .find(|node| node.accesskit_node().role() == Role::Button && node.rect().top() > edit.bottom());
        let toggled = row.and_then(|row| row.accesskit_node().toggled());
        drop(rows);
        harness.key_press(Key::Escape);
        harness.run_steps(3);
        toggled.map(|toggled| toggled == Toggled::True)
    };
    for (command, before) in [
        (Command::Flights, true),
        (Command::Gizmo, true),
        (Command::Plot, false),
        (Command::Controls, true),
        (Command::Panels, true),
        (Command::Wipe, false),
    ] {
        let name = command.name();
        assert_eq!(is_on(&mut harness, &name), Some(before), "{name}");
        send(&mut harness, command);
        assert_eq!(is_on(&mut harness, &name), Some(!before), "{name}");
        send(&mut harness, command);
    }
}

#[test]
fn the_arrow_keys_choose_a_row() {
    let mut harness = opened();
    let names = found(&mut harness, "theme");
    let (up, down) = (Key::ArrowUp, Key::ArrowDown);
    assert_eq!(names.len(), 3, "{names:?}");
    for (keys, expected) in
        [(vec![down], 1), (vec![down, down, up], 1), (vec![up], 0), (vec![down, down, down, down], 2)]
    {
        type_into_palette(&mut harness, "theme");
        keys.iter().for_each(|key| harness.key_press(*key));
        harness.key_press(Key::Enter);
        harness.run_steps(3);
        let performed = harness.state().performed().map(Command::name);
        assert_eq!(performed.as_ref(), Some(&names[expected]), "{keys:?}");
        assert!(!harness.state().has_dialog());
    }
}
