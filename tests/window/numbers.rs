//! Numbers that are typed.

use crate::common::{SMALL, control, has_samples, open, send, until};
use eframe::egui::Key;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use weekender::app::{Command, Window};

/// The box beside the slider, or the only box, with this name.
fn number<'h>(harness: &'h Harness<'_, Window>, name: &'h str) -> egui_kittest::Node<'h> {
    harness.get_all_by_label(name).last().unwrap_or_else(|| panic!("no number {name}"))
}

/// Types a text in place of a number, without Enter.
fn edit(harness: &mut Harness<'_, Window>, name: &str, text: &str) {
    number(harness, name).focus();
    harness.run_steps(3);
    for letter in text.chars() {
        harness.event(eframe::egui::Event::Text(letter.to_string()));
        harness.run_steps(3);
    }
}

#[test]
fn a_typed_number_is_one_change_when_it_is_complete() {
    let mut harness = open("--stage view-distant --size 32x18");
    until(&mut harness, "a picture", has_samples(1));
    harness.run_steps(90);
    let angle = |harness: &Harness<'_, Window>| harness.state().document().camera.vfov_degrees;
    let before = angle(&harness);
    edit(&mut harness, "Field of view", "45");
    assert_eq!(angle(&harness), before, "the number is not complete");
    harness.key_press(Key::Enter);
    harness.run_steps(3);
    assert_eq!(angle(&harness), 45.0);
    send(&mut harness, Command::Undo);
    assert_eq!(angle(&harness), before, "one step back");
    assert!(harness.state().disabled_reason(Command::Undo).is_some());

    // Leaving the field is enough, and Escape forgets what was typed.
    edit(&mut harness, "Seed", "77");
    number(&harness, "Depth").focus();
    harness.run_steps(3);
    assert_eq!(harness.state().document().settings.seed, 77);
    edit(&mut harness, "Seed", "88");
    assert_eq!(harness.state().document().settings.seed, 77);
    harness.key_press(Key::Escape);
    for step in 0..3 {
        harness.step();
        assert_eq!(harness.state().document().settings.seed, 77, "{step}");
    }
}

/// Draws frames for more than the pause after which a typed number counts.
fn pause(harness: &mut Harness<'_, Window>) {
    harness.run_steps(55);
}

#[test]
fn a_typed_number_counts_after_a_pause_and_stays_one_change() {
    let mut harness = open("--stage view-distant --size 32x18");
    until(&mut harness, "a picture", has_samples(1));
    harness.run_steps(90);
    let angle = |harness: &Harness<'_, Window>| harness.state().document().camera.vfov_degrees;
    let text = |harness: &Harness<'_, Window>| number(harness, "Field of view").value();
    let before = angle(&harness);
    edit(&mut harness, "Field of view", "4");
    harness.run_steps(30);
    assert_eq!(angle(&harness), before, "half a second is no pause");
    pause(&mut harness);
    assert_eq!(angle(&harness), 4.0);
    // The text stays as it was typed, and what follows belongs to the same change.
    for (letter, expected) in [("5", 45.0), (".", 45.0), ("5", 45.5), ("0", 45.5)] {
        harness.event(eframe::egui::Event::Text(letter.to_owned()));
        pause(&mut harness);
        assert_eq!(angle(&harness), expected);
        // Longer than a state has to last to become a step of its own.
        harness.run_steps(70);
    }
    assert_eq!(text(&harness).as_deref(), Some("45.50"));
    harness.event(eframe::egui::Event::Text("1".to_owned()));
    harness.key_press(Key::Enter);
    harness.run_steps(3);
    assert_eq!(angle(&harness), 45.501);
    harness.run_steps(90);
    send(&mut harness, Command::Undo);
    assert_eq!(angle(&harness), before, "one step back");
    assert!(harness.state().disabled_reason(Command::Undo).is_some());
    send(&mut harness, Command::Redo);
    assert_eq!(angle(&harness), 45.501);
}

#[test]
fn escape_takes_back_what_a_pause_has_applied() {
    let mut harness = open("--stage view-distant --size 32x18");
    until(&mut harness, "a picture", has_samples(1));
    harness.run_steps(90);
    let angle = |harness: &Harness<'_, Window>| harness.state().document().camera.vfov_degrees;
    let before = angle(&harness);
    edit(&mut harness, "Field of view", "45");
    pause(&mut harness);
    assert_eq!(angle(&harness), 45.0);
    harness.key_press(Key::Escape);
    harness.run_steps(3);
    assert_eq!(angle(&harness), before);
    // A text that is no number changes nothing.
    edit(&mut harness, "Field of view", "4");
    harness.event(eframe::egui::Event::Text("x".to_owned()));
    pause(&mut harness);
    assert_eq!(angle(&harness), before);
    harness.key_press(Key::Escape);
    harness.run_steps(3);
    // A number that is only looked at stays as it is.
    number(&harness, "Depth").focus();
    pause(&mut harness);
    assert!(harness.state().disabled_reason(Command::Undo).is_some());
    // A sphere's number and a whole number.
    edit(&mut harness, "Seed", "77");
    pause(&mut harness);
    assert_eq!(harness.state().document().settings.seed, 77);
}

#[test]
fn a_move_while_a_number_has_the_keyboard_is_a_step_of_its_own() {
    let mut harness = open("--stage view-distant --size 32x18");
    until(&mut harness, "a picture", has_samples(1));
    harness.run_steps(90);
    let camera = |harness: &Harness<'_, Window>| harness.state().document().camera;
    edit(&mut harness, "Field of view", "45");
    pause(&mut harness);
    let typed = camera(&harness);
    harness.event(eframe::egui::Event::PointerMoved(harness.state().picture_rect().center()));
    harness.event(eframe::egui::Event::MouseWheel {
        unit: eframe::egui::MouseWheelUnit::Line,
        delta: eframe::egui::vec2(0.0, 2.0),
        phase: eframe::egui::TouchPhase::Move,
        source: eframe::egui::MouseWheelSource::Wheel,
        modifiers: eframe::egui::Modifiers::NONE,
    });
    harness.run_steps(40);
    assert_ne!(camera(&harness), typed);
    send(&mut harness, Command::Undo);
    assert_eq!(camera(&harness), typed);
}

#[test]
fn a_number_that_is_not_edited_keeps_its_digits() {
    let mut harness = open(SMALL);
    let third = 100.0 / 3.0;
    harness.state_mut().document_mut().camera.vfov_degrees = third;
    harness.run_steps(3);
    number(&harness, "Field of view").focus();
    harness.run_steps(3);
    harness.key_press(Key::Enter);
    harness.run_steps(3);
    assert_eq!(harness.state().document().camera.vfov_degrees, third);
}

#[test]
fn a_number_beyond_its_limit_is_told_and_panels_keep_their_width() {
    let mut harness = open("--stage defocus --size 32x18");
    until(&mut harness, "a picture", has_samples(1));
    let left = harness.get_by_label("Picture").rect().left();
    edit(&mut harness, "Look from x", "100000000000000000000000000000000000000000");
    assert_eq!(harness.get_by_label("Picture").rect().left(), left, "while it is typed");
    harness.key_press(Key::Enter);
    harness.run_steps(5);
    assert_eq!(harness.state().document().camera.look_from.x, 1e18);
    let told = harness.state().messages();
    assert!(
        told.iter()
            .any(|text| text.starts_with("Look from x must be at most 1e18, not 1e41; it is 1e18 now")),
        "{told:?}"
    );
    assert_eq!(harness.get_by_label("Picture").rect().left(), left, "with a huge focus distance");
    edit(&mut harness, "Field of view", "500");
    harness.key_press(Key::Enter);
    harness.run_steps(3);
    assert_eq!(harness.state().document().camera.vfov_degrees, 179.0);
    let told = harness.state().messages();
    assert!(
        told.iter().any(|text| text.starts_with("Field of view must be at most 179, not 500; it is 179 now")),
        "{told:?}"
    );
}

/// Equal positions and an up vector along the view are refused in the same way.
#[test]
fn an_up_vector_without_a_direction_is_refused() {
    let mut harness = open("--stage normals --size 32x18");
    until(&mut harness, "a picture", has_samples(1));
    control(&harness, "Up y").set_value_accesskit(0.0);
    harness.run_steps(3);
    assert!(harness.query_by_label_contains("Up is [0, 0, 0], which has no direction").is_some());
    control(&harness, "Up y").set_value_accesskit(1.0);
    harness.run_steps(3);
    assert!(harness.query_by_label_contains("which has no direction").is_none());
}

/// As in every form, Tab takes what was typed and goes on to the next number.
#[test]
fn tab_goes_through_the_numbers_of_a_panel() {
    let mut harness = open("--stage view-distant --size 32x18");
    until(&mut harness, "a picture", has_samples(1));
    edit(&mut harness, "Width", "64");
    harness.key_press(Key::Tab);
    harness.run_steps(3);
    for letter in ["3", "0"] {
        harness.event(eframe::egui::Event::Text(letter.to_owned()));
        harness.run_steps(3);
    }
    harness.key_press(Key::Tab);
    harness.run_steps(3);
    assert_eq!(harness.state().document().size(), [64, 30]);
    edit(&mut harness, "Look from y", "7.1");
    harness.key_press(Key::Tab);
    harness.run_steps(3);
    assert_eq!(harness.state().document().camera.look_from.y, 7.1);
}

/// The focus follows what is looked at, also when that goes through the eye on its way.
#[test]
fn numbers_that_nobody_touches_stay() {
    let mut harness = open("--stage metal --size 32x18 --time-limit 0.05 --noise-target 5e-8");
    until(&mut harness, "a picture", has_samples(1));
    send(&mut harness, Command::Plot);
    let before = harness.state().document().clone();
    let eye = before.camera.look_from;
    for (axis, to) in [("x", eye.x), ("y", eye.y), ("z", eye.z)] {
        control(&harness, &format!("Look at {axis}")).set_value_accesskit(to);
        harness.run_steps(3);
    }
    assert_eq!(harness.state().document().camera.effective_focus_distance(), 0.0);
    assert_eq!(harness.state().document().camera.focus_distance, None);
    for (axis, to) in
        [("x", before.camera.look_at.x), ("y", before.camera.look_at.y), ("z", before.camera.look_at.z)]
    {
        control(&harness, &format!("Look at {axis}")).set_value_accesskit(to);
        harness.run_steps(3);
    }
    assert_eq!(harness.state().document().camera, before.camera);
    assert_eq!(harness.state().document().stop, before.stop);
    assert_eq!((before.stop.seconds, before.stop.noise), (Some(0.05), Some(5e-8)));
}
