//! Moving about: orbits and the wheel at what is under the pointer.

use crate::harness::{drag_from, has_samples, hold, open, scroll, send, until};
use crate::objects::on_screen;
use crate::questions::Ask as _;
use eframe::egui::{self, Pos2, vec2};
use egui_kittest::Harness;
use glam::DVec3;
use weekender::app::{Command, Window};
use weekender::scene::Camera;

fn opened(stage: &str) -> Harness<'static, Window> {
    let mut harness = open(&format!("--stage {stage} --size 64x36"));
    until(&mut harness, "a picture", has_samples(1));
    // Undo returns only to states that have lasted for a moment.
    harness.run_steps(90);
    harness
}

fn camera(harness: &Harness<'_, Window>) -> Camera {
    harness.state().shown_document().camera
}

/// The point of the scene that is visible at a point of the screen.
fn under(harness: &Harness<'_, Window>, at: Pos2) -> Option<DVec3> {
    let document = harness.state().shown_document();
    let along = (at - harness.state().picture_rect().min) / harness.state().picture_rect().size();
    let place = [f64::from(along.x), f64::from(along.y)];
    let direction = document.camera.direction_through(place, document.aspect());
    document.scene().pick(document.camera.look_from, direction).map(|pick| pick.point)
}

/// A point of the screen on the edge of a sphere that is not in the middle of the picture.
fn aside(harness: &Harness<'_, Window>) -> Pos2 {
    on_screen(harness, DVec3::new(-1.0, 0.2, -1.0))
}

#[test]
fn a_drag_turns_about_what_was_under_the_pointer() {
    let mut harness = opened("view-distant");
    let (start, before) = (aside(&harness), camera(&harness));
    let pivot = under(&harness, start).expect("a sphere");
    hold(&mut harness, start, true);
    for step in 1..=12 {
        harness.event(egui::Event::PointerMoved(start + vec2(9.0, 4.0) * step as f32));
        harness.step();
        let now = on_screen(&harness, pivot);
        assert!(now.distance(start) < 1.0, "step {step}: the pivot went from {start} to {now}");
    }
    let after = camera(&harness);
    assert!(after.look_from.distance(before.look_from) > 0.3 && after.look_at != before.look_at);
    let ahead = |camera: &Camera| camera.look_from.distance(camera.look_at);
    assert!((ahead(&after) / ahead(&before) - 1.0).abs() < 1e-9, "look_at keeps its distance");
    hold(&mut harness, start + vec2(108.0, 48.0), false);
    harness.step();
    send(&mut harness, Command::Undo);
    assert_eq!(camera(&harness), before);
}

#[test]
fn the_wheel_stops_before_the_surface_under_the_pointer() {
    let mut harness = opened("view-distant");
    let (at, before) = (aside(&harness), camera(&harness));
    let point = under(&harness, at).expect("a sphere");
    let far = before.look_from.distance(point);
    scroll(&mut harness, at, 3.0);
    let near = camera(&harness).look_from.distance(point);
    assert!(near < 0.9 * far, "from {far} to {near}");
    assert!(on_screen(&harness, point).distance(at) < 1.0);
    for _ in 0..12 {
        scroll(&mut harness, at, 10.0);
    }
    let document = harness.state().shown_document();
    let eye = document.camera.look_from;
    let clearance = document.scene().spheres.iter().map(|sphere| eye.distance(sphere.center) - sphere.radius);
    let clearance = clearance.fold(f64::INFINITY, f64::min);
    assert!(clearance > 0.0 && eye.distance(point) < 0.1, "{clearance}, {eye}");
    assert!(on_screen(&harness, point).distance(at) < 1.0);
    // And back: the same point stays under the pointer.
    scroll(&mut harness, at, -10.0);
    assert!(camera(&harness).look_from.distance(point) > eye.distance(point));
    assert!(on_screen(&harness, point).distance(at) < 1.0);
}

/// The first drag of a new user, a little upwards: not into the ground.
#[test]
fn a_drag_upwards_leaves_the_eye_above_the_ground() {
    let mut harness = open("--stage book --size 64x36 --device cpu");
    until(&mut harness, "a picture", has_samples(1));
    let at = harness.state().picture_rect().lerp_inside(vec2(0.5, 0.4));
    drag_from(&mut harness, at, vec2(120.0, -45.0));
    assert!(camera(&harness).look_from.y > 0.5, "{:?}", camera(&harness));
    for _ in 0..3 {
        drag_from(&mut harness, at, vec2(0.0, -300.0));
    }
    assert!(camera(&harness).look_from.y > 0.1, "{:?}", camera(&harness));
    assert!(camera(&harness).look_from.length() < 60.0, "{:?}", camera(&harness));
}
