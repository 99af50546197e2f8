//! The mouse on the picture, and what the picture shows.

use crate::common::{SMALL, drag, has_samples, open, send, until};
use eframe::egui::{self, Key, Modifiers, PointerButton};
use weekender::app::{Command, Show, Window};
use weekender::stages::Stage;

#[test]
fn drags_move_the_camera_and_undo_brings_it_back() {
    let mut harness = open("--stage view-distant");
    until(&mut harness, "a picture", has_samples(1));
    let before = harness.state().document().camera;
    // Undo returns only to states that have lasted for a moment.
    harness.run_steps(90);

    drag(&mut harness, PointerButton::Primary, Modifiers::NONE);
    let orbited = harness.state().document().camera;
    assert_ne!(orbited.look_from, before.look_from);
    until(&mut harness, "the full size", has_samples(1));

    drag(&mut harness, PointerButton::Secondary, Modifiers::NONE);
    let looked = harness.state().document().camera;
    assert_eq!(looked.look_from, orbited.look_from);
    assert_ne!(looked.look_at, orbited.look_at);

    harness.key_press(Key::Home);
    harness.run_steps(2);
    assert_eq!(harness.state().document().camera, before);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    harness.run_steps(2);
    assert_ne!(harness.state().document().camera, before);

    let camera = harness.state().document().camera;
    drag(&mut harness, PointerButton::Primary, Modifiers::SHIFT);
    assert_eq!(harness.state().document().camera, camera, "the picture moves, not the camera");
}

#[test]
fn keys_fly_where_they_say() {
    let mut harness = open("--stage view-distant --size 64x36");
    until(&mut harness, "a picture", has_samples(1));
    for (key, expected) in [
        (Key::D, [1, 0, 0]),
        (Key::A, [-1, 0, 0]),
        (Key::E, [0, 1, 0]),
        (Key::Q, [0, -1, 0]),
        (Key::W, [0, 0, 1]),
        (Key::S, [0, 0, -1]),
    ] {
        let before = harness.state().document().camera;
        harness.key_down(key);
        harness.run_steps(3);
        harness.key_up(key);
        harness.run_steps(2);
        let after = harness.state().document().camera;
        let (basis, moved) = (before.basis(), after.look_from - before.look_from);
        let [right, up, ahead] = [moved.dot(basis.u), moved.dot(basis.v), -moved.dot(basis.w)];
        let sign = |along: f64| if along.abs() < 1e-9 { 0 } else { along.signum() as i32 };
        assert_eq!([right, up, ahead].map(sign), expected, "{key:?}");
        assert!((after.look_at - before.look_at).distance(moved) < 1e-9, "{key:?} looks the same way");
    }
}

#[test]
fn ctrl_and_the_wheel_zoom_at_the_pointer() {
    let mut harness = open("--stage view-distant --size 64x36");
    until(&mut harness, "a picture", has_samples(1));
    let before = harness.state().picture_rect();
    for share in [0.2, 0.7] {
        let rect = harness.state().picture_rect();
        let at = before.lerp_inside(egui::vec2(share, 0.3));
        harness.event(egui::Event::PointerMoved(at));
        harness.step();
        harness.event_modifiers(
            egui::Event::MouseWheel {
                unit: egui::MouseWheelUnit::Line,
                delta: egui::vec2(0.0, 2.0),
                phase: egui::TouchPhase::Move,
                source: egui::MouseWheelSource::Wheel,
                modifiers: Modifiers::COMMAND,
            },
            Modifiers::COMMAND,
        );
        harness.run_steps(20);
        let zoomed = harness.state().picture_rect();
        assert!(zoomed.width() > 1.05 * rect.width(), "{rect:?} {zoomed:?}");
        let [old, new] = [rect, zoomed].map(|rect| (at - rect.min) / rect.size());
        let off = (new - old) * zoomed.size();
        // Each frame rounds the corner to a whole pixel.
        assert!(off.length() < 8.0, "off by {off} points, {rect:?} {zoomed:?}");
    }
}

#[test]
fn views_are_shown_and_follow_the_camera() {
    let mut harness = open("--stage defocus --size 64x36");
    until(&mut harness, "a picture", has_samples(2));
    for show in [Show::Normals, Show::Albedo, Show::Bounces] {
        send(&mut harness, Command::Show(show));
        until(&mut harness, "sixteen samples", |window| window.layer_samples() == 16);
        harness.state_mut().document_mut().camera.vfov_degrees += 1.0;
        harness.run_steps(2);
        until(&mut harness, "the moved layer", |window| window.layer_samples() == 16);
        assert_eq!(harness.state().show(), show);
    }
    for show in [Show::Occupancy, Show::Error] {
        send(&mut harness, Command::Show(show));
        assert_eq!((harness.state().show(), harness.state().layer_samples()), (show, 0));
    }
    // A stage that sends no rays does not have these views: it says so and shows its picture.
    send(&mut harness, Command::Show(Show::Albedo));
    send(&mut harness, Command::Stage(&Stage::ALL[0]));
    harness.run_steps(2);
    assert_eq!(harness.state().show(), Show::Picture);
    assert!(harness.state().messages().iter().any(|text| text.starts_with("No albedo here")));
    send(&mut harness, Command::Show(Show::Bounces));
    assert_eq!(harness.state().show(), Show::Picture);
}

#[test]
fn escape_leaves_a_comparison_and_a_view() {
    let mut harness = open(SMALL);
    until(&mut harness, "a picture", has_samples(1));
    for command in [Command::WipeDifference, Command::Wipe, Command::Show(Show::Error)] {
        send(&mut harness, command);
        harness.run_steps(5);
        let is_other = |window: &Window| window.is_comparing() || window.show() != Show::Picture;
        assert!(is_other(harness.state()), "{command:?}");
        harness.key_press(Key::Escape);
        harness.run_steps(3);
        assert!(!is_other(harness.state()), "{command:?}");
    }
}
