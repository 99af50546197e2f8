//! Tests of the left panel.

use super::*;
use crate::app::model::remembered::Bookmark;
use crate::app::model::sizing::Sizing;
use crate::app::spheres::Spheres;
use crate::app::tests::{dressed, facts_of};
use crate::job::output::OutputFormat;
use crate::progressive::Stop;
use egui_kittest::kittest::{NodeT, Queryable};
use egui_kittest::{Harness, Node};

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
