//! Tests of numbers.

use super::*;
use crate::app::tests::dressed;
use eframe::egui::{Event, Key, Modifiers, PointerButton, pos2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

#[test]
fn a_text_that_was_not_edited_keeps_all_digits() {
    let third = 1.0 / 3.0;
    assert_eq!(parsed(&compact(third), third), Some(third));
    assert_eq!(parsed(" 0.3334 ", third), Some(0.3334));
    assert_eq!(parsed("\u{2212}45°", 1.0), Some(-45.0));
    assert_eq!(parsed("1e30", 1.0), Some(1e30));
    for text in ["", "x", "nan"] {
        assert_eq!(parsed(text, 1.0), None, "{text}");
    }
}

#[test]
fn numbers_stay_short() {
    for (number, text) in [
        (0.0, "0"),
        (1.0, "1"),
        (-2.0, "-2"),
        (0.1, "0.1"),
        (10.126, "10.13"),
        (1000.0, "1000"),
        (123456789.0, "1.23e8"),
        (0.001, "0.001"),
        (0.00099, "9.90e-4"),
        (0.012345, "0.0123"),
        (1.23456, "1.235"),
        (99999.0, "99999"),
        (1e5, "1.00e5"),
    ] {
        assert_eq!(compact(number), text);
    }
}
/// A number that is typed into a control with these limits, and what is told about it.
fn typed(before: f64, limits: RangeInclusive<f64>, text: &str) -> (f64, Option<String>) {
    let draw = move |ui: &mut Ui, number: &mut f64| {
        super::number(ui, ("Radius", vec2(60.0, 22.0)), number, limits.clone(), |drag| drag);
    };
    let mut harness: Harness<'_, f64> = dressed([100.0, 50.0]).build_ui_state(draw, before);
    harness.get_by_label("Radius").focus();
    harness.run_steps(3);
    for letter in text.chars() {
        harness.event(Event::Text(letter.to_string()));
        harness.run_steps(2);
    }
    harness.key_press(Key::Enter);
    harness.run_steps(3);
    (*harness.state(), take_told(&harness.ctx))
}

#[test]
fn what_cannot_be_is_told_with_its_limit() {
    let radius = 1e-18..=1e18;
    for (text, expected, told) in [
        ("0", 0.5, Some("Radius must be above 0, not 0; it stays 0.5")),
        ("-3", 0.5, Some("Radius must be above 0, not -3; it stays 0.5")),
        ("1e-30", 0.5, Some("Radius must be at least 1e-18, not 1e-30; it stays 0.5")),
        ("1e-18", 1e-18, None),
        ("1e40", 1e18, Some("Radius must be at most 1e18, not 1e40; it is 1e18 now")),
        ("abc", 0.5, Some("Radius stays 0.5: \u{201c}abc\u{201d} is not a number")),
        (
            "1,5",
            0.5,
            Some("Radius stays 0.5: \u{201c}1,5\u{201d} is not a number; decimals need a point, as in 1.5"),
        ),
        ("inf", 1e18, Some("Radius must be at most 1e18, not inf; it is 1e18 now")),
        ("2.5", 2.5, None),
        ("1 000", 1000.0, None),
        (" ", 0.5, None),
    ] {
        assert_eq!(typed(0.5, radius.clone(), text), (expected, told.map(str::to_owned)), "{text}");
    }
    let (kept, told) = typed(0.5, radius, &"abcdef".repeat(7));
    let start = "Radius stays 0.5: \u{201c}abcdefabcdefabcdefabcdefabcdef\u{201d} is not a number";
    assert_eq!((kept, told.as_deref()), (0.5, Some(start)), "a long text is cut");
    let (kept, told) = typed(759.0, 1.0..=16384.0, "100000");
    assert_eq!(kept, 16384.0);
    assert_eq!(told.as_deref(), Some("Radius must be at most 16384, not 100000; it is 16384 now"));
    let (kept, told) = typed(4.0, 1.0..=9.0, "0");
    assert_eq!((kept, told.as_deref()), (1.0, Some("Radius must be at least 1, not 0; it is 1 now")));
}

#[test]
fn a_limit_that_stands_for_zero_is_not_reached_without_typing() {
    for (limits, expected) in [(1e-18..=9.0, 0.5), (0.0..=9.0, 0.0), (1e-6..=9.0, 1e-6)] {
        let draw = move |ui: &mut Ui, number: &mut f64| {
            super::number(ui, ("Radius", vec2(60.0, 22.0)), number, limits.clone(), |drag| drag);
        };
        let mut harness: Harness<'_, f64> = dressed([100.0, 50.0]).build_ui_state(draw, 0.5);
        harness.get_by_label("Radius").set_value_accesskit(0.0);
        harness.run_steps(2);
        assert_eq!(*harness.state(), expected);
    }
}

#[test]
fn numbers_in_messages_have_all_their_digits() {
    for (number, text) in [
        (100_000.0, "100000"),
        (0.1, "0.1"),
        (1e18, "1e18"),
        (-1e-12, "-1e-12"),
        (4294967295.0, "4294967295"),
    ] {
        assert_eq!(digits(number), text);
    }
}

/// What becomes of two numbers when texts are typed into the first one and those after it, and each is left in this way;
/// and what is told about it.
fn left_by(texts: &[&str], leave: fn(&mut Harness<'_, [f64; 2]>)) -> ([f64; 2], Option<String>) {
    let draw = |ui: &mut Ui, numbers: &mut [f64; 2]| {
        for (name, number) in ["First", "Second"].into_iter().zip(numbers) {
            super::number(ui, (name, vec2(60.0, 22.0)), number, 0.0..=9.0, |drag| drag);
        }
    };
    let mut harness: Harness<'_, [f64; 2]> = dressed([100.0, 90.0]).build_ui_state(draw, [1.0, 2.0]);
    harness.get_by_label("First").focus();
    harness.run_steps(3);
    for text in texts {
        for letter in text.chars() {
            harness.event(Event::Text(letter.to_string()));
            harness.run_steps(2);
        }
        leave(&mut harness);
        harness.run_steps(3);
    }
    (*harness.state(), take_told(&harness.ctx))
}

#[test]
fn a_typed_number_counts_however_its_control_is_left() {
    type Leave = fn(&mut Harness<'_, [f64; 2]>);
    let tab: Leave = |harness| harness.key_press(Key::Tab);
    let ways: [(&str, Leave); 4] = [
        ("Tab", tab),
        ("Shift+Tab", |harness| harness.key_press_modifiers(Modifiers::SHIFT, Key::Tab)),
        ("Enter", |harness| harness.key_press(Key::Enter)),
        ("a click elsewhere", |harness| {
            let (pos, button, modifiers) = (pos2(90.0, 85.0), PointerButton::Primary, Modifiers::NONE);
            harness.event(Event::PointerMoved(pos));
            for pressed in [true, false] {
                harness.event(Event::PointerButton { pos, button, pressed, modifiers });
                harness.step();
            }
        }),
    ];
    for (name, leave) in ways {
        assert_eq!(left_by(&["7.5"], leave), ([7.5, 2.0], None), "{name}");
        let told = "First stays 1: \u{201c}x\u{201d} is not a number";
        assert_eq!(left_by(&["x"], leave), ([1.0, 2.0], Some(told.to_owned())), "{name}");
        let told = "First must be at most 9, not 12; it is 9 now";
        assert_eq!(left_by(&["12"], leave), ([9.0, 2.0], Some(told.to_owned())), "{name}");
        assert_eq!(left_by(&[""], leave), ([1.0, 2.0], None), "{name}");
    }
    assert_eq!(left_by(&["7", "8"], tab), ([7.0, 8.0], None), "Tab leads to the next number");
}

/// A number, whether its control is enabled, and how often the control has said that it was changed.
struct Beyond {
    number: f64,
    is_enabled: bool,
    changes: usize,
}

#[test]
fn a_number_beyond_its_limits_stays_until_it_is_changed() {
    for (before, limits) in [(0.0, 1e-18..=9.0), (9.5, 1e-18..=9.0), (0.5, 1.0..=9.0)] {
        let draw = move |ui: &mut Ui, state: &mut Beyond| {
            ui.add_enabled_ui(state.is_enabled, |ui| {
                let place = ("Number", vec2(60.0, 22.0));
                let response = super::number(ui, place, &mut state.number, limits.clone(), |drag| drag);
                state.changes += usize::from(response.changed());
            });
        };
        let state = Beyond { number: before, is_enabled: false, changes: 0 };
        let mut harness: Harness<'_, Beyond> = dressed([100.0, 50.0]).build_ui_state(draw, state);
        harness.run_steps(3);
        harness.state_mut().is_enabled = true;
        harness.run_steps(3);
        harness.get_by_label("Number").focus();
        harness.run_steps(3);
        harness.key_press(Key::Enter);
        harness.run_steps(3);
        let Beyond { number, changes, .. } = harness.state();
        assert_eq!((*number, *changes), (before, 0), "nobody has changed it");
        assert_eq!(take_told(&harness.ctx), None);
        harness.get_by_label("Number").set_value_accesskit(20.0);
        harness.run_steps(3);
        let Beyond { number, changes, .. } = harness.state();
        assert_eq!((*number, *changes), (9.0, 1), "a change ends at the limit");
        harness.get_by_label("Number").focus();
        harness.run_steps(3);
        for _ in 0..3 {
            harness.key_press(Key::ArrowUp);
            harness.run_steps(2);
            assert_eq!(harness.state().number, 9.0, "so does an arrow key");
        }
        assert_eq!(harness.state().changes, 1);
    }
}

#[test]
fn whole_numbers_are_rounded_and_have_all_their_digits() {
    let draw = |ui: &mut Ui, count: &mut u64| {
        whole_number(ui, ("Count", vec2(90.0, 22.0)), count, 3..=5_000_000_000, |drag| drag);
    };
    let mut harness: Harness<'_, u64> = dressed([120.0, 50.0]).build_ui_state(draw, 123_456_789);
    let shown = |harness: &Harness<'_, u64>| harness.get_by_label("Count").value();
    assert_eq!(shown(&harness).as_deref(), Some("123456789"));
    for (typed, count, text) in [
        ("12.4", 12, "12"),
        ("12.6", 13, "13"),
        ("4294967297", 4_294_967_297, "4294967297"),
        ("2", 3, "3"),
        ("1e12", 5_000_000_000, "5000000000"),
    ] {
        harness.get_by_label("Count").focus();
        harness.run_steps(3);
        for letter in typed.chars() {
            harness.event(Event::Text(letter.to_string()));
            harness.run_steps(2);
        }
        harness.key_press(Key::Enter);
        harness.run_steps(3);
        assert_eq!((*harness.state(), shown(&harness).as_deref()), (count, Some(text)), "{typed}");
    }
}

#[test]
fn a_number_that_something_else_changes_is_no_longer_typed() {
    let draw = |ui: &mut Ui, number: &mut f64| {
        super::number(ui, ("Number", vec2(60.0, 22.0)), number, 0.0..=9.0, |drag| drag);
    };
    for leave in [Key::Enter, Key::Escape] {
        let mut harness: Harness<'_, f64> = dressed([100.0, 50.0]).build_ui_state(draw, 1.0);
        harness.get_by_label("Number").focus();
        harness.run_steps(3);
        harness.event(Event::Text("7".to_owned()));
        harness.run_steps(2);
        *harness.state_mut() = 3.0;
        harness.run_steps(2);
        harness.key_press(leave);
        harness.run_steps(4);
        assert_eq!(*harness.state(), 3.0, "{leave:?}");
    }
}

#[test]
fn a_typed_number_is_applied_once_and_belongs_to_one_change_as_long_as_the_control_is_edited() {
    // The number, how often it was changed, and whether it is still typed.
    let draw = |ui: &mut Ui, (number, changes, is_typed): &mut (f64, usize, bool)| {
        let response = super::number(ui, ("Number", vec2(60.0, 22.0)), number, 0.0..=9.0, |drag| drag);
        *changes += usize::from(response.changed());
        *is_typed = is_typing(ui.ctx());
    };
    let mut harness: Harness<'_, (f64, usize, bool)> =
        dressed([100.0, 50.0]).with_step_dt(0.125).build_ui_state(draw, (1.0, 0, false));
    harness.get_by_label("Number").focus();
    harness.run_steps(3);
    harness.event(Event::Text("7".to_owned()));
    harness.run_steps(4);
    assert_eq!(*harness.state(), (1.0, 0, false), "the pause is not over");
    harness.run_steps(6);
    assert_eq!(*harness.state(), (7.0, 1, true), "after a second");
    harness.run_steps(8);
    assert_eq!(*harness.state(), (7.0, 1, true), "nothing was typed since");
    harness.key_press(Key::Enter);
    harness.run_steps(4);
    assert_eq!(*harness.state(), (7.0, 1, false));
}

/// What becomes of a number of 1 that moves by 0.1 for each point of a drag to the right.
fn dragged(limits: RangeInclusive<f64>, points: f32) -> f64 {
    let draw = move |ui: &mut Ui, number: &mut f64| {
        super::number(ui, ("Number", vec2(60.0, 22.0)), number, limits.clone(), |drag| drag.speed(0.1));
    };
    let mut harness: Harness<'_, f64> = dressed([100.0, 50.0]).build_ui_state(draw, 1.0);
    let from = harness.get_by_label("Number").rect().center();
    let press = |pos, pressed| {
        let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
        Event::PointerButton { pos, button, pressed, modifiers }
    };
    harness.event(Event::PointerMoved(from));
    harness.event(press(from, true));
    harness.run_steps(2);
    for step in 1..=20 {
        harness.event(Event::PointerMoved(from + vec2(points * step as f32 / 20.0, 0.0)));
        harness.step();
    }
    harness.event(press(from + vec2(points, 0.0), false));
    harness.run_steps(3);
    assert_eq!(take_told(&harness.ctx), None, "nothing was typed");
    *harness.state()
}

#[test]
fn a_drag_moves_a_number_up_to_its_limits() {
    // The first points of a drag may still have been a click.
    let near = dragged(0.0..=9.0, 40.0);
    assert!((3.9..=5.3).contains(&near), "{near}");
    assert_eq!(dragged(0.0..=9.0, 400.0), 9.0);
    assert_eq!(dragged(0.0..=9.0, -400.0), 0.0);
    let positive = dragged(1e-18..=9.0, -400.0);
    assert!((0.1..=1.0).contains(&positive), "{positive}");
}

#[test]
fn arrow_keys_move_a_number_by_its_step() {
    let draw = |ui: &mut Ui, number: &mut f64| {
        super::number(ui, ("Number", vec2(60.0, 22.0)), number, 0.0..=9.0, |drag| drag.speed(0.1));
    };
    let mut harness: Harness<'_, f64> = dressed([100.0, 50.0]).build_ui_state(draw, 1.0);
    harness.get_by_label("Number").focus();
    harness.run_steps(3);
    for (key, expected) in [(Key::ArrowUp, 1.1), (Key::ArrowUp, 1.2), (Key::ArrowDown, 1.1)] {
        harness.key_press(key);
        harness.run_steps(2);
        assert!((*harness.state() - expected).abs() < 1e-9, "{key:?}: {}", harness.state());
    }
}
