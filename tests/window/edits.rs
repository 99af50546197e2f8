//! The spheres of the scene: editing them, and what becomes of a changed scene.

use crate::harness::{control, has_samples, send, until};
use crate::objects::{material, metal_sphere, middle_sphere, on_screen, opened, select, spheres};
use crate::questions::Ask as _;
use eframe::egui::{self, Key, Modifiers};
use weekender::app::Command;
use weekender::stages::Stage;

#[test]
fn spheres_are_added_copied_deleted_and_brought_back() {
    let mut harness = opened();
    let first = spheres(&harness);
    // On the sphere under the pointer.
    let metal = metal_sphere(&harness);
    let at = on_screen(&harness, first[metal].center);
    harness.event(egui::Event::PointerMoved(at));
    harness.run_steps(2);
    harness.key_press(Key::Insert);
    harness.run_steps(3);
    let added = *spheres(&harness).last().unwrap();
    assert_eq!((spheres(&harness).len(), harness.state().selected()), (first.len() + 1, Some(first.len())));
    let gap = added.center.distance(first[metal].center) - first[metal].radius - added.radius;
    assert!(gap.abs() < 1e-9, "it touches the sphere under the pointer: {gap}");

    harness.run_steps(90);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::D);
    harness.run_steps(3);
    let copied = *spheres(&harness).last().unwrap();
    assert_eq!(
        (spheres(&harness).len(), harness.state().selected()),
        (first.len() + 2, Some(first.len() + 1))
    );
    let places = [first.len(), first.len() + 1];
    let [one, other] = places.map(|sphere| material(&harness, sphere));
    assert_eq!((copied.radius, other), (added.radius, one));
    assert!(copied.center.distance(added.center) > 2.0 * added.radius, "beside it");

    harness.run_steps(90);
    let middle = middle_sphere(&harness);
    select(&mut harness, middle);
    harness.key_press(Key::Delete);
    harness.run_steps(3);
    assert_eq!((spheres(&harness).len(), harness.state().selected()), (first.len() + 1, None));
    until(&mut harness, "its picture", has_samples(1));
    send(&mut harness, Command::Undo);
    assert_eq!(spheres(&harness).len(), first.len() + 2);
    send(&mut harness, Command::Undo);
    send(&mut harness, Command::Undo);
    assert_eq!(spheres(&harness), first);
    assert!(!harness.state().shown_document().has_changed_scene());
}

#[test]
fn a_changed_stage_is_reset_to_its_bits() {
    let stage = Stage::find("glass-schlick").unwrap();
    let mut harness = opened();
    let before = harness.state().shown_document().job(1).unwrap();
    let metal = metal_sphere(&harness);
    select(&mut harness, metal);
    let fuzz = material(&harness, metal).effective_fuzz();
    for value in [0.5, fuzz] {
        control(&harness, "Fuzz").set_value_accesskit(value);
        harness.run_steps(3);
        // A value that is typed back is not a change.
        assert_eq!(harness.state().shown_document().has_changed_scene(), value != fuzz);
    }
    control(&harness, "Fuzz").set_value_accesskit(0.5);
    harness.run_steps(3);
    assert_eq!(harness.state().shown_document().stage(), Some(stage));
    assert_ne!(harness.state().shown_document().job(1).unwrap(), before);
    send(&mut harness, Command::ResetAll);
    assert_eq!(harness.state().shown_document().job(1).unwrap().scene(), before.scene());
    assert!(!harness.state().shown_document().has_changed_scene());
}
