//! The mouse on the picture, and what the picture shows.

use crate::harness::{choose_from_menu, drag, has_samples, open, send, until};
use crate::objects::{on_screen, spheres};
use crate::questions::Ask as _;
use eframe::egui::{Key, Modifiers, PointerButton};
use weekender::app::{Command, Show, Window};
use weekender::stages::Stage;

#[test]
fn drags_move_the_camera_or_the_picture() {
    let mut harness = open("--stage view-distant");
    until(&mut harness, "a picture", has_samples(1));
    let camera = |harness: &egui_kittest::Harness<'_, Window>| harness.state().shown_document().camera;
    let before = camera(&harness);
    drag(&mut harness, PointerButton::Primary, Modifiers::NONE);
    let orbited = camera(&harness);
    assert_ne!(orbited.look_from, before.look_from);
    until(&mut harness, "the full size", has_samples(1));
    drag(&mut harness, PointerButton::Secondary, Modifiers::NONE);
    let looked = camera(&harness);
    assert!(looked.look_from == orbited.look_from && looked.look_at != orbited.look_at);
    harness.key_press(Key::Home);
    harness.run_steps(2);
    assert_eq!(camera(&harness), before);
    let still = camera(&harness);
    drag(&mut harness, PointerButton::Primary, Modifiers::SHIFT);
    assert_eq!(camera(&harness), still, "the picture moves, not the camera");
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
    // A stage that sends no rays does not have these views: it says so and shows its picture.
    send(&mut harness, Command::Stage(&Stage::ALL[0]));
    harness.run_steps(2);
    assert_eq!(harness.state().show(), Show::Picture);
    assert!(!harness.state().messages().is_empty());
}

#[test]
fn context_menu_acts_on_what_is_there() {
    let mut harness = open("--stage glass-schlick --size 64x36");
    until(&mut harness, "a picture", has_samples(1));
    let count = spheres(&harness).len();
    let at = on_screen(&harness, glam::DVec3::new(0.0, 0.0, -1.2));
    choose_from_menu(&mut harness, at, "Paths of this pixel");
    assert_eq!(harness.state().performed(), Some(Command::ListPaths));
    until(&mut harness, "paths", |window| window.listed_paths() > 0);
    let at = on_screen(&harness, glam::DVec3::new(0.0, 0.0, -1.2));
    choose_from_menu(&mut harness, at, "Delete the sphere");
    assert_eq!(spheres(&harness).len(), count - 1);
}
