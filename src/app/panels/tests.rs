//! Tests of the left panel.

use super::*;
use crate::app::model::Model;
use crate::app::model::device::Device;
use crate::app::model::origin::Origin;
use crate::app::model::remembered::Bookmark;
use crate::app::model::sizing::Sizing;
use crate::app::model::viewpoint::Viewpoint;
use crate::app::spheres::Spheres;
use crate::app::tests::{dressed, facts_of, leave};
use crate::output::OutputFormat;
use crate::progressive::Stop;
use crate::render::{DEPTH_LIMIT, SAMPLE_LIMIT, SIZE_LIMIT};
use crate::stages::Stage;
use egui_kittest::kittest::{NodeT, Queryable};
use egui_kittest::{Harness, Node};
use glam::DVec3;

struct Panel {
    facts: Facts,
    is_new: bool,
    edits: Vec<Edit>,
    commands: Vec<Command>,
}

/// The panel of a window of this command line.
fn panel(words: &str) -> Harness<'static, Panel> {
    panel_of(words, false)
}

fn panel_of(words: &str, is_new: bool) -> Harness<'static, Panel> {
    let panel = Panel { facts: facts_of(words), is_new, edits: Vec::new(), commands: Vec::new() };
    dressed([260.0, 1700.0]).build_ui_state(
        |ui, Panel { facts, is_new, edits, commands }: &mut Panel| {
            let (mut document, mut remembered) =
                (facts.model.document.clone(), facts.model.remembered.clone());
            let selected = Spheres::default().selected(&facts.model);
            let chosen = (&mut document, selected.as_ref());
            super::ui(ui, chosen, &mut remembered, (&*facts, *is_new), (edits, commands));
            (facts.model.document, facts.model.remembered) = (document, remembered);
        },
        panel,
    )
}

/// The control with this name, not a text that contains the name.
fn control<'h>(harness: &'h Harness<'_, Panel>, name: &'h str) -> Node<'h> {
    let mut named = harness.get_all_by_label(name);
    named.find(|node| node.accesskit_node().role() != egui::Role::Label).unwrap()
}

fn press(harness: &mut Harness<'_, Panel>, name: &str) {
    control(harness, name).click();
    harness.run_steps(3);
}

#[test]
fn buttons_give_their_commands() {
    let mut harness = panel("--stage metal-fuzzy --size 32x18");
    harness.state_mut().facts.model.selected = Some(1);
    let camera = harness.state().facts.document().camera;
    let bookmarks = ["a", "b"].map(|name| Bookmark::new(name.to_owned(), &camera));
    harness.state_mut().facts.model.remembered.bookmarks = bookmarks.to_vec();
    harness.run_steps(2);
    for command in [
        Command::PreviousSphere,
        Command::NextSphere,
        Command::AddSphere,
        Command::DuplicateSphere,
        Command::DeleteSphere,
        Command::FocusSphere,
        Command::LookAtSphere,
        Command::AddBookmark,
        Command::FlyBookmarks,
        Command::SaveFlight,
        Command::Size(Sizing::Viewport),
        Command::Size(Sizing::Book),
        Command::CopyCommand,
    ] {
        press(&mut harness, &command.name());
        assert_eq!(std::mem::take(&mut harness.state_mut().commands), [command]);
    }
    for (name, command) in [
        ("Save PNG", Command::Save(OutputFormat::Png)),
        ("Save PPM", Command::Save(OutputFormat::P6)),
        ("Save EXR film", Command::Save(OutputFormat::Exr)),
        ("Save Scene", Command::SaveScene),
    ] {
        press(&mut harness, name);
        assert_eq!(std::mem::take(&mut harness.state_mut().commands), [command]);
    }
    press(&mut harness, "Go to b");
    assert_eq!(std::mem::take(&mut harness.state_mut().commands), [Command::Bookmark(1)]);
    assert!(harness.state().edits.is_empty());
}

#[test]
fn a_click_on_a_heading_or_beside_it_folds_the_group() {
    let mut harness = panel("--stage defocus --size 32x18");
    for (name, inside) in [("Camera", "Field of view"), ("Output", "Width")] {
        for (beside, is_open) in [(0.0, false), (60.0, true)] {
            let pos = harness.get_by_label(name).rect().center() + egui::vec2(beside, 0.0);
            let (button, modifiers) = (egui::PointerButton::Primary, egui::Modifiers::NONE);
            harness.event(egui::Event::PointerMoved(pos));
            for pressed in [true, false] {
                harness.event(egui::Event::PointerButton { pos, button, pressed, modifiers });
                harness.run_steps(1);
            }
            harness.run_steps(10);
            let is_seen = harness.query_all_by_label(inside).next().is_some();
            assert_eq!(is_seen, is_open, "{name}, {beside} points beside it");
        }
    }
    assert!(harness.state().facts.document().camera == facts_of("--stage defocus").document().camera);
}

#[test]
fn numbers_have_their_limits() {
    let mut harness = panel("--stage metal-fuzzy --size 32x18");
    harness.state_mut().facts.model.document.stop =
        Stop { samples: Some(9), seconds: Some(9.0), noise: Some(0.1) };
    harness.run_steps(2);
    let mut set = |name: &str, value: f64| {
        control(&harness, name).set_value_accesskit(value);
        harness.run_steps(3);
        harness.state().facts.model.document.clone()
    };
    assert_eq!(set("Time limit", 1e9).stop.seconds, Some(1e6));
    assert_eq!(set("Time limit", 0.0).stop.seconds, Some(0.1));
    assert_eq!(set("Error limit", 9.0).stop.noise, Some(1.0));
    assert_eq!(set("Error limit", 0.0).stop.noise, Some(1e-6));
    assert_eq!(set("Samples limit", 0.0).stop.samples, Some(1));
    assert_eq!(set("Depth", 0.0).settings.max_depth, 1);
    assert_eq!(set("Width", 0.0).size(), [1, 18]);
    assert_eq!(set("Seed", -1.0).settings.seed, 0);
    assert_eq!(set("Seed", 1e12).settings.seed, u32::MAX);
    let largest = *camera::POSITIONS.end();
    assert_eq!(set("Look from y", 1e300).camera.look_from.y, largest);
    assert_eq!(set("Up z", -1e300).camera.vup.z, -largest);
}

/// The box in which the number of this name is typed, not the slider beside it.
fn number<'h>(harness: &'h Harness<'_, Panel>, name: &'h str) -> Node<'h> {
    let mut named = harness.get_all_by_label(name);
    named.find(|node| node.accesskit_node().role() == egui::Role::SpinButton).unwrap()
}

/// Compares the limits of numbers and how far an arrow key or a drag over one point changes them.
fn assert_numbers(harness: &mut Harness<'_, Panel>, expected: &[(&str, [f64; 2], f64)]) {
    harness.run_steps(3);
    for (name, [least, most], step) in expected {
        let node = number(harness, name).accesskit_node();
        for (what, found, expected) in [
            ("least", node.min_numeric_value(), least),
            ("most", node.max_numeric_value(), most),
            ("step", node.numeric_value_step(), step),
        ] {
            let found = found.unwrap_or_else(|| panic!("{name} has no {what}"));
            assert!(
                (found - expected).abs() <= 1e-9 * expected.abs(),
                "{name}, {what}: {found}, not {expected}"
            );
        }
    }
}

#[test]
fn numbers_end_at_the_limits_of_scenes_and_move_in_steps_that_suit_their_size() {
    const PLACES: [f64; 2] = [-1e18, 1e18];
    // From (-2, 2, 1) to (0, 0, -1).
    let far = 12.0_f64.sqrt();
    let mut harness = panel("--stage defocus --size 32x18");
    assert_numbers(
        &mut harness,
        &[
            ("Look from x", PLACES, 0.005 * far),
            ("Look at z", PLACES, 0.005 * far),
            ("Up y", PLACES, 0.01),
            // Of 20 degrees.
            ("Field of view", [0.01, 179.0], 0.2),
            // Of 10 degrees, but the slider has only 30.
            ("Defocus angle", [0.0, 178.9], 0.06),
            ("Focus distance", [1e-18, 1e19], 0.034),
            ("Depth", [1.0, f64::from(DEPTH_LIMIT)], 0.2),
            ("Seed", [0.0, 4_294_967_295.0], 0.05),
            ("Width", [1.0, f64::from(SIZE_LIMIT)], 2.0),
            ("Height", [1.0, f64::from(SIZE_LIMIT)], 2.0),
            ("Samples limit", [1.0, SAMPLE_LIMIT as f64], 1.0),
            ("Time limit", [0.1, 1e6], 0.5),
            ("Error limit", [1e-6, 1.0], 1e-4),
        ],
    );
    let camera = &mut harness.state_mut().facts.model.document.camera;
    (camera.defocus_angle_degrees, camera.look_at) = (0.0, camera.look_from + DVec3::X * 1e-9);
    assert_numbers(
        &mut harness,
        &[("Defocus angle", [0.0, 178.9], 0.001), ("Look from x", PLACES, 1e-4), ("Look at z", PLACES, 1e-4)],
    );
    // Of a golden sphere at (1, 0, -1), seen from (0, 0, 0).
    let mut harness = panel("--stage metal-fuzzy --size 32x18");
    let gold = DVec3::new(1.0, 0.0, -1.0);
    harness.state_mut().facts.model.selected = sphere_at(&harness, gold);
    assert_numbers(
        &mut harness,
        &[
            ("Centre x", PLACES, 0.003 * 2.0_f64.sqrt()),
            ("Radius", [1e-18, 1e18], 0.005),
            ("Albedo red", [0.0, 1.0], 0.005),
            ("Fuzz", [0.0, f64::MAX], 0.002),
        ],
    );
    let mut harness = panel("--stage glass-refract --size 32x18");
    harness.state_mut().facts.model.selected = sphere_at(&harness, DVec3::new(-1.0, 0.0, -1.0));
    assert_numbers(&mut harness, &[("Refraction index", [1e-9, 1e9], 0.0044)]);
}

/// The sphere with this centre.
fn sphere_at(harness: &Harness<'_, Panel>, center: DVec3) -> Option<usize> {
    harness.state().facts.document().scene().spheres.iter().position(|sphere| sphere.center == center)
}
