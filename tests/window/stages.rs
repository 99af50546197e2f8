//! Every stage of the book.

use crate::common::{has_samples, open, open_sized, send, until};
use eframe::egui::{Event, Key, Modifiers, MouseWheelSource, MouseWheelUnit, Role, Shape, TouchPhase, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use weekender::app::{Command, Window};
use weekender::stages::Stage;

#[test]
fn every_stage_is_shown_with_its_text() {
    let mut harness = open("--stage ppm-tiny");
    for stage in Stage::ALL {
        send(&mut harness, Command::Stage(stage));
        until(&mut harness, stage.id, |window| {
            window.document().stage() == Some(stage) && has_samples(1)(window)
        });
        assert!(harness.query_by_label(stage.what_is_new).is_some(), "{}", stage.id);
        assert!(harness.query_by_label(stage.look_for).is_some(), "{}", stage.id);
    }
    harness.key_press(Key::PageUp);
    harness.run_steps(2);
    assert_eq!(harness.state().document().stage(), Stage::ALL.iter().rev().nth(1));
}

/// The top of the text about a stage, which is scrolled.
#[test]
fn the_text_about_another_stage_begins_at_its_top() {
    let mut harness = open_sized("--stage defocus --size 32x18", [1280.0, 360.0]);
    harness.run_steps(3);
    let top = |harness: &Harness<'_, Window>| harness.get_by_label("What is new").rect().top();
    assert!(top(&harness) > 40.0);
    let pos = harness.get_by_label("What is new").rect().center();
    harness.event(Event::PointerMoved(pos));
    let (unit, delta, modifiers) = (MouseWheelUnit::Line, vec2(0.0, -90.0), Modifiers::NONE);
    let (phase, source) = (TouchPhase::Move, MouseWheelSource::Wheel);
    harness.event(Event::MouseWheel { unit, delta, phase, source, modifiers });
    harness.run_steps(60);
    assert!(top(&harness) < 0.0, "{}", top(&harness));
    send(&mut harness, Command::Stage(Stage::find("sky").unwrap()));
    assert!(top(&harness) > 40.0, "{}", top(&harness));
}

#[test]
fn every_stage_is_compared_with_another() {
    let mut harness = open("--stage sky --size 32x18");
    harness.key_press(Key::C);
    for stage in Stage::ALL {
        send(&mut harness, Command::Stage(stage));
        harness.state_mut().document_mut().give_size([32, 18]);
        until(&mut harness, stage.id, |window| window.has_other_picture());
        assert!(harness.state().is_comparing());
    }
    harness.key_press(Key::X);
    harness.run_steps(5);
    harness.key_press(Key::X);
    harness.run_steps(2);
    assert!(!harness.state().is_comparing());
}

#[test]
fn a_stage_with_a_pair_can_be_compared_with_the_next_one_instead() {
    let (stage, pair, next) = Stage::ALL
        .iter()
        .filter_map(|stage| Some((stage, Stage::find(stage.pair?).ok()?, stage.next()?)))
        .find(|(_, pair, next)| pair != next)
        .unwrap();
    let mut harness = open(&format!("--stage {} --size 32x18", stage.id));
    harness.key_press(Key::C);
    until(&mut harness, "a wipe", |window| window.has_other_picture());
    let seen = |harness: &mut Harness<'_, Window>| {
        harness.run_steps(5);
        let picture = harness.state().picture_rect();
        [pair, next].map(|other| {
            harness.output().shapes.iter().any(|clipped| match &clipped.shape {
                Shape::Text(text) => picture.contains(text.pos) && text.galley.text().contains(other.title),
                _ => false,
            })
        })
    };
    assert_eq!(seen(&mut harness), [true, false]);
    harness.get_by_role_and_label(Role::CheckBox, "Next stage").click();
    harness.run_steps(3);
    until(&mut harness, "the next stage", |window| window.has_other_picture());
    assert_eq!(seen(&mut harness), [false, true]);
}

#[test]
fn the_list_of_stages_opens_where_one_is() {
    let stage = Stage::find("defocus").unwrap();
    let mut harness = open_sized("--stage defocus", [1280.0, 800.0]);
    harness.run_steps(2);
    for _ in 0..2 {
        harness.get_by_label("Choose a stage").click();
        harness.run_steps(10);
        let name = Command::Stage(stage).name();
        let list = harness.query_all_by_label(&name).last().unwrap().rect();
        assert!(list.top() > 40.0 && list.bottom() < 780.0, "{list:?}");
        harness.key_press(Key::Escape);
        harness.run_steps(10);
    }
}
