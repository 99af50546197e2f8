//! Every control of the panels.

use crate::common::{SMALL, control, has_samples, open, send, until};
use eframe::egui::{self, Key};
use egui_kittest::kittest::{NodeT, Queryable};
use egui_kittest::{Harness, Node};
use weekender::app::{Command, Device, Window};
use weekender::job::render::RenderSettings;

#[test]
fn sliders_change_the_picture_and_reset_brings_it_back() {
    let mut harness = open("--stage defocus --size 32x18");
    let before = harness.state().shown_document().clone();
    control(&harness, "Field of view").set_value_accesskit(50.0);
    control(&harness, "Defocus angle").set_value_accesskit(3.0);
    control(&harness, "Focus distance").set_value_accesskit(2.0);
    harness.run_steps(2);
    let camera = harness.state().shown_document().camera;
    assert_eq!(
        (camera.vfov_degrees, camera.defocus_angle_degrees, camera.focus_distance),
        (50.0, 3.0, Some(2.0))
    );
    for label in ["Look from x", "Look at y", "Up z", "Width", "Height", "Depth", "Seed"] {
        let value = control(&harness, label).accesskit_node().numeric_value().unwrap();
        control(&harness, label).set_value_accesskit(value + 1.0);
        harness.run_steps(2);
    }
    let document = harness.state().shown_document();
    assert_eq!(document.camera.look_from.x, before.camera.look_from.x + 1.0);
    assert_eq!(document.camera.look_at.y, before.camera.look_at.y + 1.0);
    assert_eq!(document.camera.vup.z, before.camera.vup.z + 1.0);
    assert_eq!((document.settings.width, document.settings.height), (33, 19));
    assert_eq!(document.settings.max_depth, before.settings.max_depth + 1);
    assert_eq!(document.settings.seed, before.settings.seed + 1);
    for group in ["camera", "lens", "render", "output"] {
        harness.get_by_label(&format!("Reset {group}")).click();
        harness.run_steps(2);
    }
    let origin = &harness.state().shown_document().origin;
    assert_eq!(harness.state().shown_document().camera, origin.recipe.camera);
    let in_the_book = RenderSettings { width: 400, height: 225, ..origin.recipe.settings };
    assert_eq!(harness.state().shown_document().settings, in_the_book);
}

#[test]
fn check_boxes_and_lists_do_what_they_say() {
    let mut harness = open("--stage defocus --size 32x18");
    harness.get_by_label("Estimate error").click();
    harness.run_steps(2);
    assert!(!harness.state().shown_document().settings.estimate_error);
    harness.get_by_label("Estimate error").click();
    harness.get_by_label("Focus on Look at").click();
    harness.run_steps(2);
    assert_eq!(harness.state().shown_document().camera.focus_distance, None);
    for (label, choice) in [("Sampler", "independent"), ("Lanes", "1"), ("Threads", "1"), ("Device", "f64")] {
        control(&harness, label).click();
        harness.run_steps(3);
        harness.get_all_by_label(choice).last().unwrap().click();
        harness.run_steps(3);
    }
    assert_eq!(harness.state().shown_document().settings.sampler.name(), "independent");
    let remembered = harness.state_mut().remembered_mut();
    assert_eq!(
        (remembered.lanes, remembered.threads, remembered.device),
        (Some(1), Some(1), Device::Reference)
    );
    for label in ["Samples", "Time", "Error"] {
        control(&harness, label).click();
        harness.run_steps(2);
    }
    let stop = harness.state().shown_document().stop;
    assert!(stop.samples.is_some() && stop.seconds.is_some() && stop.noise.is_none(), "{stop:?}");
    harness.get_by_label("Reset stop").click();
    harness.run_steps(2);
    assert!(harness.state().shown_document().stop.noise.is_some());
}

#[test]
fn what_has_no_effect_is_disabled() {
    let harness = open("--stage ppm-tiny");
    for label in ["Field of view", "Defocus angle", "Focus distance", "Depth", "Sampler", "Seed"] {
        assert!(control(&harness, label).accesskit_node().is_disabled(), "{label}");
    }
    let harness = open("--stage glass-schlick --size 32x18");
    assert!(control(&harness, "Focus distance").accesskit_node().is_disabled());
    assert!(!control(&harness, "Field of view").accesskit_node().is_disabled());
    for device in Device::ALL {
        let is_disabled =
            harness.get_by_label(&Command::Device(device).name()).accesskit_node().is_disabled();
        assert_eq!(is_disabled, device.unavailable().is_some(), "{device:?}");
    }
}

#[test]
fn bookmarks_bring_the_camera_back() {
    let mut harness = open(SMALL);
    let before = harness.state().shown_document().camera;
    send(&mut harness, Command::AddBookmark);
    harness.state_mut().document_mut().camera.vfov_degrees = 12.0;
    harness.run_steps(2);
    harness.get_by_label("Go to 11.4 view 1").click();
    harness.run_steps(60);
    assert_eq!(harness.state().shown_document().camera, before);
}

#[test]
fn tab_hides_the_panels_and_they_fold_one_by_one() {
    let mut harness = open(SMALL);
    assert!(harness.query_all_by_label("Field of view").next().is_some());
    harness.key_press(Key::Tab);
    harness.run_steps(3);
    assert!(
        harness.query_all_by_label("Field of view").next().is_none()
            && harness.query_by_label("File").is_none()
    );
    harness.key_press(Key::Tab);
    harness.run_steps(3);
    assert!(harness.query_all_by_label("Field of view").next().is_some());
    harness.key_press(Key::L);
    harness.run_steps(3);
    assert!(
        harness.query_all_by_label("Field of view").next().is_none()
            && harness.query_by_label("Pixel").is_some()
    );
    harness.key_press(Key::I);
    harness.run_steps(3);
    assert!(harness.query_by_label("Pixel").is_none());
}

/// Everything that a command or a control can change.
fn state_of(harness: &mut Harness<'_, Window>) -> String {
    let nodes: Vec<_> =
        harness.root().children_recursive().map(|node| node.accesskit_node().toggled()).collect();
    let window = harness.state_mut();
    let remembered = format!("{:?}", window.remembered_mut());
    let document = window.shown_document();
    let stage = document.stage().map(|stage| stage.id);
    format!(
        "{stage:?} {:?} {:?} {:?} {remembered} {:?} {:?} {:?} {:?} {nodes:?}",
        document.camera,
        document.settings,
        document.stop,
        (window.show(), window.disabled_reason(Command::NoExposure)),
        window.is_comparing(),
        window.is_paused(),
        window.has_dialog(),
    )
}

#[test]
fn every_control_changes_something() {
    use egui::accesskit::Role;
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
    assert!(controls.len() > 45, "{controls:?}");
    let mut harness = opened();
    for (name, role) in controls {
        assert!(!name.is_empty(), "a {role:?} without a name");
        // Choosing the option that is already chosen changes nothing.
        if name == Command::Device(Device::Cpu).name() || name == "Own size" {
            continue;
        }
        // Commands that only write to the clipboard or to disk are tested elsewhere.
        if name == "Copy as command" {
            continue;
        }
        let before = state_of(&mut harness);
        let is_it = |node: &Node<'_>| {
            let node = node.accesskit_node();
            node.role() == role && node.label().unwrap_or_default() == name
        };
        let node =
            harness.root().children_recursive().find(is_it).unwrap_or_else(|| panic!("{name} has gone"));
        match role {
            Role::Slider | Role::SpinButton => {
                let value = node.accesskit_node().numeric_value().unwrap_or_default();
                node.set_value_accesskit(value + 1.0);
            }
            _ => node.click_accesskit(),
        }
        harness.run_steps(4);
        assert_ne!(state_of(&mut harness), before, "{role:?} {name}");
        harness = opened();
    }
}
