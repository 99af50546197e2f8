//! Tests of numbers.

use super::*;
use crate::app::tests::dressed;
use eframe::egui::{Event, Key, Modifiers, PointerButton, pos2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

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
