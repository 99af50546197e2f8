//! The error over time, and the goal that is dragged in it.

use super::common::{open, send, until};
use eframe::egui::{self, Modifiers, PointerButton, Pos2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use weekender::app::{Command, Dock, Window};

fn goal(harness: &Harness<'_, Window>) -> f64 {
    harness.state().shown_document().stop.noise.unwrap()
}

/// The position of the goal's line.
fn line(harness: &Harness<'_, Window>) -> Pos2 {
    harness.get_by_label("Goal, as a line").rect().center()
}

/// Moves the pointer in small steps with the button held down.
fn drag(harness: &mut Harness<'_, Window>, from: Pos2, to: Pos2) {
    let button = |pos, pressed| egui::Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    harness.event(egui::Event::PointerMoved(from));
    harness.step();
    harness.event(button(from, true));
    harness.step();
    for step in 1..=10 {
        harness.event(egui::Event::PointerMoved(from.lerp(to, step as f32 / 10.0)));
        harness.step();
    }
    harness.event(button(to, false));
    harness.run_steps(2);
}

#[test]
fn the_goal_is_dragged() {
    let mut harness = open("--scene three-spheres --size 64x36 --device cpu --noise-target 0.002");
    send(&mut harness, Command::Dock(Dock::Error));
    until(&mut harness, "an estimate", |window| window.status().samples_per_pixel >= 16);
    send(&mut harness, Command::Pause);
    assert_eq!(goal(&harness), 0.002);
    // Grabbed some points away from the line, it moves as far as the pointer and does not jump.
    let beside = line(&harness) + vec2(40.0, 5.0);
    drag(&mut harness, beside, beside);
    assert_eq!(goal(&harness), 0.002);
    let from = line(&harness);
    drag(&mut harness, from + vec2(40.0, 5.0), from + vec2(60.0, -15.0));
    let moved = goal(&harness);
    assert!(moved > 0.0022 && moved < 0.2, "up is a larger error: {moved}");
    assert!(harness.state().is_paused());

    // Away from the line, nothing is grabbed.
    let away = line(&harness) + vec2(40.0, 14.0);
    drag(&mut harness, away, away - vec2(0.0, 30.0));
    assert_eq!(goal(&harness), moved);

    send(&mut harness, Command::Undo);
    assert_eq!(goal(&harness), 0.002, "a whole drag is one change");
    // Wherever it is grabbed, the same way leads to the same goal.
    for off in [-5.0, 0.0] {
        harness.run_steps(3);
        let from = line(&harness) + vec2(40.0, off);
        drag(&mut harness, from, from + vec2(20.0, -20.0));
        assert_eq!(goal(&harness), moved, "grabbed {off} points below the line");
        send(&mut harness, Command::Undo);
    }
}

#[test]
fn a_render_ends_at_the_goal_and_goes_on_to_a_lower_one() {
    let mut harness = open("--scene three-spheres --size 64x36 --device cpu --noise-target 0.01");
    send(&mut harness, Command::Dock(Dock::Error));
    until(&mut harness, "the end", |window| window.status().phase.is_over());
    let done = harness.state().status().samples_per_pixel;
    harness.run_steps(3);
    let from = line(&harness);
    drag(&mut harness, from, from + vec2(0.0, 12.0));
    assert!(goal(&harness) < 0.01, "{}", goal(&harness));
    until(&mut harness, "more samples", |window| window.status().samples_per_pixel > done);
}
