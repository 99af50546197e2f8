//! Tests of the left panel.

use super::*;
use crate::app::tests::{dressed, snapshot_of};
use eframe::egui::{self, Key, Role};
use egui_kittest::kittest::{NodeT, Queryable};
use egui_kittest::{Harness, Node};

/// The panel of a window of this command line, as wide as in the window.
fn panel(words: &str) -> Harness<'static, PanelContext> {
    let draw = |ui: &mut Ui, cx: &mut PanelContext| {
        let (mut document, mut remembered) = (cx.model.document.clone(), cx.model.remembered.clone());
        egui::Frame::new().inner_margin(egui::Margin::symmetric(16, 8)).show(ui, |ui| {
            ui.set_min_width(200.0);
            super::ui(ui, &mut document, &mut remembered, cx);
        });
        (cx.snapshot.model.document, cx.snapshot.model.remembered) = (document, remembered);
    };
    let mut harness = dressed([232.0, 720.0]).build_ui_state(draw, PanelContext::new(snapshot_of(words)));
    harness.run_steps(3);
    harness
}

fn field<'h>(harness: &'h Harness<'_, PanelContext>, name: &'h str) -> Node<'h> {
    let mut named = harness.get_all_by_label(name);
    named.find(|node| [Role::SpinButton, Role::TextInput].contains(&node.accesskit_node().role())).unwrap()
}

/// Types a text into a field and presses Enter.
fn set(harness: &mut Harness<'_, PanelContext>, name: &str, text: &str) {
    field(harness, name).click();
    harness.run_steps(3);
    field(harness, name).type_text(text);
    harness.run_steps(3);
    harness.key_press(Key::Enter);
    harness.run_steps(3);
}

#[test]
fn typed_numbers_apply_once_within_limits() {
    let mut harness = panel("--stage book");
    let vfov = |harness: &Harness<'_, PanelContext>| harness.state().document().camera.vfov_degrees;
    field(&harness, "Field of view").click();
    harness.run_steps(3);
    field(&harness, "Field of view").type_text("45");
    harness.run_steps(3);
    assert_eq!(vfov(&harness), 20.0, "nothing is applied while the user types");
    harness.key_press(Key::Enter);
    harness.run_steps(3);
    assert_eq!(vfov(&harness), 45.0);
    for (text, expected, is_refused) in [
        ("200", 45.0, true),
        ("NaN", 45.0, true),
        ("44", 44.0, false),
        ("-3", 44.0, true),
        ("45", 45.0, false),
    ] {
        harness.run_steps(200);
        set(&mut harness, "Field of view", text);
        let told = harness.query_all_by_label_contains(" to 179").next().is_some();
        assert_eq!((vfov(&harness), told), (expected, is_refused), "{text}");
    }
    // Escape takes back what was typed.
    field(&harness, "Field of view").click();
    harness.run_steps(3);
    field(&harness, "Field of view").type_text("60");
    harness.key_press(Key::Escape);
    harness.run_steps(4);
    assert_eq!(vfov(&harness), 45.0);
}

#[test]
fn another_kind_of_material_keeps_the_colour() {
    let mut harness = panel("--stage glass-schlick");
    harness.state_mut().snapshot.model.selected = Some(1);
    harness.run_steps(3);
    harness.get_by_label("Metal").click();
    harness.run_steps(2);
    let edit = harness.state_mut().requests.get_mut().pop();
    let body = Body::of(harness.state().document().scene(), 1).unwrap();
    let material = Material::Metal { albedo: body.material.albedo().unwrap(), fuzz: 0.0 };
    assert_eq!(edit, Some(Command::Edit(Edit::Change(1, Body { material, ..body }))));
}

#[test]
fn one_limit_at_a_time_ends_the_render() {
    let mut harness = panel("--stage book");
    harness.get_by_label("Render, folded").click();
    harness.run_steps(20);
    for (name, expected) in [
        ("Samples", Stop::at_samples(500)),
        ("Never", Stop::default()),
        ("Time", Stop { seconds: Some(60.0), ..Stop::default() }),
        ("Error", Stop { noise: Some(Stop::NOISE), ..Stop::default() }),
    ] {
        harness.get_by_role_and_label(Role::ComboBox, "Stop at").click();
        harness.run_steps(3);
        harness.get_all_by_label(name).last().unwrap().click();
        harness.run_steps(3);
        assert_eq!(harness.state().document().stop, expected, "{name}");
    }
}

#[test]
fn the_other_side_follows_as_far_as_its_limits_allow() {
    for (before, size, expected) in [
        ([400, 225], [800, 225], [800, 450]),
        ([400, 225], [400, 450], [800, 450]),
        ([225, 400], [16384, 400], [9216, 16384]),
        ([400, 4], [10, 4], [10, 1]),
    ] {
        assert_eq!(in_shape(before, before, size), expected, "{before:?} {size:?}");
    }
}
