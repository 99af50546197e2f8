//! The panels in the whole window.

use crate::harness::{SMALL, drag, has_samples, open, open_sized, send, until};
use crate::questions::Ask as _;
use eframe::egui::{Key, Modifiers, PointerButton, accesskit::Role};
use egui_kittest::kittest::{NodeT, Queryable};
use egui_kittest::{Harness, Node};
use weekender::app::{Command, Device, Window};

#[test]
fn a_drag_on_the_picture_takes_the_keys_from_a_field() {
    let mut harness = open("--stage metal --size 32x18 --device cpu");
    until(&mut harness, "a picture", has_samples(1));
    let field = harness.get_all_by_label("Field of view").find(|node| node.rect().width() < 80.0).unwrap();
    field.click();
    harness.run_steps(3);
    drag(&mut harness, PointerButton::Primary, Modifiers::NONE);
    harness.key_press(Key::H);
    harness.run_steps(3);
    assert_eq!(harness.state().performed(), Some(Command::ShowMe));
}

#[test]
fn stages_without_rays_have_no_camera() {
    let harness = open("--stage ppm-tiny");
    assert!(harness.query_all_by_label("Field of view").next().is_none());
    for device in [Device::Cpu, Device::Gpu] {
        assert_eq!(harness.query_by_label(device.label()).is_some(), device.is_shown(), "{device:?}");
    }
}

#[test]
fn a_bookmark_brings_the_camera_back() {
    let mut harness = open(SMALL);
    let before = harness.state().shown_document().camera;
    send(&mut harness, Command::AddBookmark);
    harness.state_mut().document_mut().camera.vfov_degrees = 12.0;
    harness.run_steps(2);
    send(&mut harness, Command::Bookmark(0));
    harness.run_steps(2);
    assert_eq!(harness.state().shown_document().camera, before);
    // It is there when one comes back to the stage, and can be deleted.
    send(&mut harness, Command::NextStage);
    assert!(harness.state().shown_document().keyframes.is_empty());
    send(&mut harness, Command::PreviousStage);
    assert_eq!(harness.state().shown_document().keyframes.len(), 1);
    send(&mut harness, Command::DeleteBookmark);
    assert!(harness.state().shown_document().keyframes.is_empty());
    send(&mut harness, Command::Undo);
    assert_eq!(harness.state().shown_document().keyframes.len(), 1);
}

#[test]
fn panels_are_hidden_together_and_one_by_one() {
    let mut harness = open(SMALL);
    let shown = |harness: &Harness<'_, Window>| {
        ["Field of view", "Pixel", "File"].map(|name| harness.query_all_by_label(name).next().is_some())
    };
    for (key, expected) in [
        (Key::Tab, [false, false, false]),
        (Key::Tab, [true, true, true]),
        (Key::L, [false, true, true]),
        (Key::I, [false, false, true]),
    ] {
        harness.key_press(key);
        harness.run_steps(3);
        assert_eq!(shown(&harness), expected, "{key:?}");
    }
}

#[test]
fn f6_goes_from_panel_to_panel() {
    let mut harness = open_sized(SMALL, [1280.0, 800.0]);
    send(&mut harness, Command::ErrorDock);
    harness.state_mut().shell.toasts.bad("Not opened: on purpose");
    harness.run_steps(3);
    let mut focused = || {
        harness.key_press(Key::F6);
        harness.run_steps(3);
        let nodes = harness.root().children_recursive();
        let node = nodes.map(|node| node.accesskit_node()).find(|node| node.is_focused());
        node.and_then(|node| node.label())
    };
    let names = [(); 6].map(|()| focused().unwrap_or_default());
    let expected = ["File", "Camera, open", "Compare with", "Error", "Close this message", "File"];
    assert_eq!(names, expected);
}

/// Everything that a command or a control can change.
fn state_of(harness: &mut Harness<'_, Window>) -> String {
    let nodes: Vec<_> = harness
        .root()
        .children_recursive()
        .map(|node| (node.accesskit_node().label(), node.accesskit_node().toggled()))
        .collect();
    let window = harness.state_mut();
    let remembered = format!("{:?}", window.remembered_mut());
    let document = window.shown_document();
    format!(
        "{:?} {:?} {:?} {:?} {remembered} {:?} {:?} {:?} {:?} {nodes:?}",
        document.stage().map(|stage| stage.id),
        document.camera,
        document.settings,
        document.stop,
        window.show(),
        window.is_comparing(),
        window.is_paused(),
        window.has_dialog(),
    )
}

fn control_of<'h>(harness: &'h Harness<'_, Window>, role: Role, name: &str) -> Node<'h> {
    let is_it = |node: &Node<'_>| {
        let node = node.accesskit_node();
        node.role() == role && node.label().unwrap_or_default() == name
    };
    harness.root().children_recursive().find(is_it).unwrap_or_else(|| panic!("{name} has gone"))
}

#[test]
fn every_control_has_a_name_and_changes_something() {
    let opened = || {
        let mut harness = open("--stage defocus --size 32x18 --samples 4000000000");
        until(&mut harness, "a picture", has_samples(1));
        harness.run_steps(3);
        harness
    };
    let is_control = |role| {
        matches!(role, Role::Button | Role::Slider | Role::SpinButton | Role::CheckBox | Role::ComboBox)
    };
    let harness = opened();
    let controls: Vec<(String, Role)> = harness
        .root()
        .children_recursive()
        .map(|node| node.accesskit_node())
        .filter(|node| is_control(node.role()) && !node.is_disabled())
        .map(|node| (node.label().unwrap_or_default(), node.role()))
        .collect();
    assert!(controls.len() > 15, "{controls:?}");
    let mut harness = opened();
    for (name, role) in controls {
        assert!(!name.is_empty(), "a {role:?} without a name");
        let before = state_of(&mut harness);
        let node = control_of(&harness, role, &name);
        // Choosing what is chosen already changes nothing.
        if node.accesskit_node().toggled().is_some() {
            continue;
        }
        match role {
            Role::Slider | Role::SpinButton => {
                let value = node.accesskit_node().numeric_value().unwrap_or_default();
                // At the end of a slider there is only the way back.
                for other in [value + 1.0, 0.5 * value] {
                    control_of(&harness, role, &name).set_value_accesskit(other);
                    harness.run_steps(4);
                    if state_of(&mut harness) != before {
                        break;
                    }
                }
            }
            _ => node.click_accesskit(),
        }
        harness.run_steps(4);
        assert_ne!(state_of(&mut harness), before, "{role:?} {name}");
        harness = opened();
    }
}
