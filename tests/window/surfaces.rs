//! A camera that meets a surface.

use crate::common::{has_samples, open, until};
use eframe::egui::{self, Modifiers, PointerButton, Shape, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use glam::DVec3;
use weekender::app::Window;

/// Whether the window has painted a text that contains this.
fn is_painted(harness: &Harness<'_, Window>, text: &str) -> bool {
    harness
        .output()
        .shapes
        .iter()
        .any(|clipped| matches!(&clipped.shape, Shape::Text(painted) if painted.galley.text().contains(text)))
}

#[test]
fn a_camera_pulled_down_does_not_enter_the_ground() {
    let mut harness = open("--stage book --size 32x18");
    until(&mut harness, "a picture", has_samples(1));
    let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
    let start = harness.get_by_label("Picture").rect().center();
    harness.event(egui::Event::PointerMoved(start));
    harness.step();
    harness.event(egui::Event::PointerButton { pos: start, button, pressed: true, modifiers });
    for step in 1..=40 {
        harness.event(egui::Event::PointerMoved(start - vec2(0.0, 6.0) * step as f32));
        harness.step();
        let document = harness.state().document();
        let at = document.camera.look_from;
        let inside =
            document.scene().spheres.iter().position(|sphere| at.distance(sphere.center) < sphere.radius);
        assert_eq!(inside, None, "step {step}: {at}");
    }
    let low = harness.state().document().camera.look_from;
    assert!(low.y < 0.3, "it came down to the ground: {low}");
    assert!(!is_painted(&harness, "the camera is inside"));
}

#[test]
fn a_camera_inside_a_sphere_is_told_so() {
    let mut harness = open("--stage glass-schlick --size 32x18");
    until(&mut harness, "a picture", has_samples(1));
    harness.run_steps(2);
    assert!(!is_painted(&harness, "the camera is inside"));
    let document = harness.state_mut().document_mut();
    let (index, sphere) = document
        .scene()
        .spheres
        .iter()
        .copied()
        .enumerate()
        .find(|(_, sphere)| sphere.radius == 0.5)
        .unwrap();
    document.camera.look_from = sphere.center + DVec3::new(0.0, 0.0, 0.45);
    harness.run_steps(3);
    assert!(is_painted(&harness, &format!("the camera is inside sphere {index} (")));
}
