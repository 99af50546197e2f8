//! The palette: what it finds first, and what it says about switches.

use crate::common::{SMALL, has_samples, hold, open, open_sized, send, until};
use eframe::egui::accesskit::Toggled;
use eframe::egui::{Event, Key, Modifiers, Rect, Role};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use weekender::app::{Command, Show, SlotCommand, Theme, Window};
use weekender::output::OutputFormat;
use weekender::stages::Stage;

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
fn a_match_at_the_start_of_a_name_or_word_comes_first() {
    let mut harness = opened();
    let glass = Command::Stage(Stage::find("glass-schlick").unwrap());
    for (text, first) in [
        // At the start of the name, before a word within it and before letters within a word.
        ("light", Command::Theme(Theme::Light)),
        ("LIGHT", Command::Theme(Theme::Light)),
        ("no", Command::NoExposure),
        ("wipe", Command::Wipe),
        ("full", Command::FullScreen),
        // At the start of a later word.
        ("film", Command::Save(OutputFormat::Exr)),
        ("plot", Command::Plot),
        ("axes", Command::Gizmo),
        ("flights", Command::Flights),
        // Words in any order, and beginnings of words.
        ("theme light", Command::Theme(Theme::Light)),
        ("stage next", Command::NextStage),
        ("sph add", Command::AddSphere),
        (
            "keep 3",
            Command::Slot(SlotCommand::all().into_iter().find(|c| c.name() == "Keep in slot 3").unwrap()),
        ),
        // The initials of the words.
        ("zi", Command::ZoomIn),
        ("rpp", Command::Show(Show::Bounces)),
        ("11.4", glass),
    ] {
        type_into_palette(&mut harness, text);
        harness.key_press(Key::Enter);
        harness.run_steps(3);
        assert_eq!(harness.state().performed(), Some(first), "{text:?}");
        harness.key_press(Key::Escape);
        harness.run_steps(3);
        if first == glass {
            break;
        }
        if harness.state().is_full_screen() {
            send(&mut harness, Command::FullScreen);
        }
    }
}

#[test]
fn matches_inside_words_and_in_the_help_come_last() {
    let mut harness = opened();
    let light = found(&mut harness, "light");
    let at = |names: &[String], name: &str| names.iter().position(|found| found == name);
    assert!(at(&light, "Light theme") < at(&light, "Smooth flights"), "{light:?}");
    assert!(at(&light, "Smooth flights").is_some(), "{light:?}");
    // "Pause or resume tracing" is in the help of another name.
    let resume = found(&mut harness, "resume");
    assert!(at(&resume, "Pause or go on").is_some(), "{resume:?}");
    assert!(found(&mut harness, "xyzzy").is_empty());
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
fn a_switch_whose_effect_is_not_seen_tells_it() {
    let mut harness = opened();
    let told =
        |harness: &Harness<'_, Window>, text: &str| harness.state().messages().iter().any(|m| m == text);
    send(&mut harness, Command::Flights);
    assert!(told(&harness, "Smooth flights off"), "{:?}", harness.state().messages());
    send(&mut harness, Command::Flights);
    assert!(told(&harness, "Smooth flights on") && !told(&harness, "Smooth flights off"));
    // The axes are seen, unless the panels are hidden.
    send(&mut harness, Command::Gizmo);
    assert!(!told(&harness, "Axes in the corner off"));
    send(&mut harness, Command::Panels);
    send(&mut harness, Command::Gizmo);
    assert!(told(&harness, "Axes in the corner on"), "{:?}", harness.state().messages());
}

/// The rows of the open palette from the top, each with its text.
fn rows(harness: &Harness<'_, Window>) -> Vec<(String, Rect)> {
    let wide = harness.get_all_by_role(Role::Button).filter(|node| node.rect().width() > 300.0);
    let mut rows: Vec<(String, Rect)> =
        wide.filter_map(|node| Some((node.accesskit_node().label()?, node.rect()))).collect();
    rows.sort_by(|(_, a), (_, b)| a.top().total_cmp(&b.top()));
    rows
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

/// A slow frame receives several presses at once.
#[test]
fn each_press_of_an_arrow_key_counts() {
    let mut harness = opened();
    let names = found(&mut harness, "theme");
    type_into_palette(&mut harness, "theme");
    let press = |key| Event::Key {
        key,
        physical_key: None,
        pressed: true,
        repeat: false,
        modifiers: Modifiers::NONE,
    };
    harness.input_mut().events.extend([Key::ArrowDown, Key::ArrowDown].map(press));
    harness.run_steps(1);
    harness.key_press(Key::Enter);
    harness.run_steps(3);
    assert_eq!(harness.state().performed().map(Command::name).as_ref(), Some(&names[2]));
}

#[test]
fn the_chosen_row_stays_in_sight() {
    let mut harness = opened();
    harness.key_press_modifiers(Modifiers::COMMAND, Key::P);
    harness.run_steps(3);
    let edit = harness.get_by_label("Command").rect();
    let is_seen = |row: &Rect| row.top() > edit.bottom() && row.bottom() < edit.bottom() + 390.0;
    let rows_at_first = rows(&harness);
    let (name, row) = &rows_at_first[30];
    assert!(!is_seen(row), "{name} {row}");
    for _ in 0..30 {
        harness.key_press(Key::ArrowDown);
    }
    harness.run_steps(90);
    let rows = rows(&harness);
    let (_, row) = rows.iter().find(|(other, _)| other == name).unwrap();
    assert!(is_seen(row), "{name} {row}");
}

#[test]
fn a_row_under_the_pointer_is_explained_and_clicked() {
    let mut harness = opened();
    type_into_palette(&mut harness, "zoom");
    let is_explained =
        |harness: &Harness<'_, Window>| harness.query_by_label(Command::ZoomOut.help()).is_some();
    assert!(!is_explained(&harness), "another row is chosen");
    let name = Command::ZoomOut.name();
    let (_, row) = rows(&harness).into_iter().find(|(text, _)| text.starts_with(&name)).unwrap();
    harness.hover_at(row.center());
    harness.run_steps(2);
    assert!(is_explained(&harness));
    for pressed in [true, false] {
        hold(&mut harness, row.center(), pressed);
    }
    harness.run_steps(2);
    assert_eq!(harness.state().performed(), Some(Command::ZoomOut));
    assert!(!harness.state().has_dialog());
}

#[test]
fn the_palette_fits_into_a_low_window() {
    let mut harness = open_sized(SMALL, [1280.0, 300.0]);
    harness.run_steps(2);
    type_into_palette(&mut harness, "light");
    let help = Command::Theme(Theme::Light).help();
    let bottoms = harness.get_all_by_label(help).map(|node| node.rect().bottom());
    let lowest = bottoms.fold(0.0, f32::max);
    assert!((200.0..300.0).contains(&lowest), "{lowest}");
}
