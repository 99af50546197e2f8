//! What drags, clicks and the wheel over the picture change.

use super::golden::{Golden, changes};
use super::{Harnessed, busy, button, finished, give, known, point};
use crate::common::{middle, until};
use eframe::egui::{self, Modifiers, MouseWheelUnit, PointerButton, TouchPhase, Vec2, vec2};
use weekender::app::{Command, SlotCommand, SlotNumber, Window};

const HELD: [(&str, Modifiers); 4] = [
    ("", Modifiers::NONE),
    ("Shift ", Modifiers::SHIFT),
    ("Ctrl ", Modifiers::COMMAND),
    ("Alt ", Modifiers::ALT),
];

/// Presses at an offset from the middle of the picture, moves in steps and releases.
fn drag(harness: &mut Harnessed, from: Vec2, by: Vec2, pointer: PointerButton, modifiers: Modifiers) {
    let start = middle(harness) + from;
    point(harness, start);
    button(harness, start, pointer, true, modifiers);
    for step in 1..=6 {
        harness.event_modifiers(egui::Event::PointerMoved(start + by * (step as f32 / 6.0)), modifiers);
        harness.step();
    }
    button(harness, start + by, pointer, false, modifiers);
    harness.run_steps(3);
}

fn click(harness: &mut Harnessed, from: Vec2, pointer: PointerButton, modifiers: Modifiers, times: usize) {
    let at = middle(harness) + from;
    point(harness, at);
    for _ in 0..times {
        button(harness, at, pointer, true, modifiers);
        button(harness, at, pointer, false, modifiers);
    }
    harness.run_steps(3);
}

/// The window, and what was to be seen before.
type Setting = (&'static str, fn() -> Harnessed);

fn with(new: fn() -> Harnessed, commands: &[Command]) -> Harnessed {
    let mut harness = new();
    for command in commands {
        give(&mut harness, *command);
    }
    harness.run_steps(3);
    harness
}

const SETTINGS: [Setting; 6] = [
    ("picture", || finished("defocus")),
    ("selected", busy),
    ("wipe", || {
        let mut harness = with(busy, &[Command::Slot(SlotCommand::Wipe)]);
        let is_placed = |window: &Window| format!("{window:?}").contains("is_divider_unplaced: false");
        until(&mut harness, "a divider in its place", is_placed);
        harness
    }),
    ("crop", || with(|| finished("defocus"), &[Command::Crop])),
    ("slot", || with(busy, &[Command::Slot(SlotCommand::Look(SlotNumber::ALL[0]))])),
    ("no rays", || finished("ppm-tiny")),
];

#[test]
#[ignore = "for an idle machine: it waits until the window is at rest"]
fn drags_change_what_is_stored() {
    let mut golden = Golden::open("gestures.txt");
    for (setting, new) in SETTINGS {
        let before = known(&mut new());
        let mut tried = |title: String, act: &dyn Fn(&mut Harnessed)| {
            let mut harness = new();
            act(&mut harness);
            golden.expect(&format!("{setting}: {title}"), || changes(&before, &known(&mut harness), 12));
        };
        let held = if ["picture", "selected"].contains(&setting) { &HELD[..] } else { &HELD[..1] };
        for pointer in [PointerButton::Primary, PointerButton::Middle, PointerButton::Secondary] {
            for &(held, modifiers) in held {
                tried(format!("{held}{pointer:?} drag"), &|harness| {
                    drag(harness, vec2(0.0, 40.0), vec2(60.0, 24.0), pointer, modifiers);
                });
            }
        }
        tried("drag upper left".to_owned(), &|harness| {
            drag(harness, vec2(-200.0, -100.0), vec2(-40.0, -20.0), PointerButton::Primary, Modifiers::NONE);
        });
        for &(held, modifiers) in held {
            for (where_to, from) in [("middle", Vec2::ZERO), ("upper left", vec2(-260.0, -140.0))] {
                tried(format!("{held}click {where_to}"), &|harness| {
                    click(harness, from, PointerButton::Primary, modifiers, 1);
                });
            }
            for up in [1.0, -1.0] {
                tried(format!("{held}wheel {up}"), &|harness| {
                    let at = middle(harness) + vec2(50.0, 30.0);
                    point(harness, at);
                    harness.event_modifiers(
                        egui::Event::MouseWheel {
                            source: egui::MouseWheelSource::Wheel,
                            unit: MouseWheelUnit::Line,
                            delta: vec2(0.0, up),
                            phase: TouchPhase::Move,
                            modifiers,
                        },
                        modifiers,
                    );
                    harness.run_steps(12);
                });
            }
        }
        tried("double click".to_owned(), &|harness| {
            click(harness, vec2(40.0, 20.0), PointerButton::Primary, Modifiers::NONE, 2);
        });
        tried("pinch".to_owned(), &|harness| {
            let at = middle(harness) + vec2(50.0, 30.0);
            point(harness, at);
            harness.event(egui::Event::Zoom(1.3));
            harness.run_steps(3);
        });
    }
    golden.finish();
}
