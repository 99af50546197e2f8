//! The right panel: what the stage adds, what to look for, and the pixel under the pointer.

use super::command::Command;
use super::facts::Facts;
use super::menu::item;
use super::model::document::Document;
use super::model::show::Show;
use super::model::view::{With, is_of_cameras, partner};
use super::tips::{self, Side};
use super::widgets::{About, list};
use crate::measure::stress::Case;
use crate::stages::Stage;
use eframe::egui::{self, RichText, Ui};

/// Draws the panel except for the pixel.
pub fn ui(ui: &mut Ui, facts: &Facts, commands: &mut Vec<Command>) {
    let document = facts.document();
    match (document.stage(), document.case()) {
        (Some(stage), _) => {
            stage_ui(ui, stage, facts, commands);
            compare_ui(ui, stage, facts, commands);
        }
        (None, Some(case)) => case_ui(ui, case, facts, commands),
        (None, None) => recipe_ui(ui, document, facts, commands),
    }
    ui.add_space(8.0);
    ui.separator();
    ui.add_space(4.0);
    view_ui(ui, facts, commands);
}

fn stage_ui(ui: &mut Ui, stage: &Stage, facts: &Facts, commands: &mut Vec<Command>) {
    let weak = ui.visuals().weak_text_color();
    let over = format!("{} {}", stage.chapter(), stage.chapter_title);
    ui.add(egui::Label::new(RichText::new(over).small().color(weak)).wrap());
    ui.add(egui::Label::new(RichText::new(stage.title).heading()).wrap());
    changed_ui(ui, facts, commands);
    let link = format!("{} {}", stage.section, stage.section_title);
    let link = ui.add(egui::Hyperlink::from_label_and_url(link, stage.url()).open_in_new_tab(true));
    let help = format!("Opens this section of the book in the web browser:\n{}", stage.url());
    tips::beside(ui, link, &help);
    for (heading, text) in
        [("What is new", stage.what_is_new), ("Why", stage.why), ("Look for", stage.look_for)]
    {
        ui.add_space(6.0);
        ui.label(RichText::new(heading).small().color(weak));
        ui.add(egui::Label::new(text).wrap());
    }
    ui.add_space(2.0);
    show_me(ui, stage, facts, commands);
    ui.add_space(6.0);
    ui.horizontal_wrapped(|ui| {
        for (name, command) in [("Code", Command::Code), ("Companion", Command::Companion)] {
            let button = egui::Button::new(name).selected(facts.is_on(command));
            let response = ui.add(button);
            if tips::beside(ui, response, command.help()).clicked() {
                commands.push(command);
            }
        }
    });
    ui.add_space(10.0);
}

/// A button that shows what there is to look for, and what is then to be seen.
fn show_me(ui: &mut Ui, stage: &Stage, facts: &Facts, commands: &mut Vec<Command>) {
    let command = Command::ShowMe;
    let reason = facts.disabled_reason(command);
    let keys = command.keys(ui.ctx()).unwrap_or_default();
    let button = egui::Button::new("Show me").selected(facts.has_sight);
    let response = ui.add_enabled(reason.is_none(), button);
    let help = format!("{} ({keys})", command.help());
    if tips::explain(ui, response, Side::Beside, &help, reason.as_deref()).clicked() {
        commands.push(command);
    }
    if facts.has_sight {
        let text = RichText::new(stage.sight.caption).color(ui.visuals().strong_text_color());
        ui.add(egui::Label::new(text).wrap());
    }
}

/// Text about a scene that is not a stage.
fn recipe_ui(ui: &mut Ui, document: &Document, facts: &Facts, commands: &mut Vec<Command>) {
    let recipe = &document.origin.recipe;
    ui.add(egui::Label::new(RichText::new(&recipe.name).heading()).wrap());
    let scene = document.scene();
    let (spheres, materials) = (scene.spheres.len(), scene.materials.len());
    ui.label(format!("{spheres} spheres, {materials} materials"));
    changed_ui(ui, facts, commands);
    if let Some((frames, command)) = document.animation() {
        ui.add_space(6.0);
        ui.label(RichText::new("Animation").small().color(ui.visuals().weak_text_color()));
        let text =
            format!("{frames} frames along the scene file's keyframes. This command makes an animated PNG:");
        ui.add(egui::Label::new(text).wrap());
        ui.add(egui::Label::new(RichText::new(command).monospace().small()).wrap());
    }
}

/// Says that the scene was changed, with a button that resets it.
fn changed_ui(ui: &mut Ui, facts: &Facts, commands: &mut Vec<Command>) {
    if !facts.document().has_changed_scene() {
        return;
    }
    ui.horizontal(|ui| {
        let label = ui.label(RichText::new("changed").color(ui.visuals().warn_fg_color));
        tips::beside(ui, label, "The spheres are not those of the stage");
        let button = egui::Button::new("Reset").small();
        let response = ui.add(button);
        let response = tips::beside(ui, response, Command::ResetAll.help());
        if response.accessible_name("Reset the scene").clicked() {
            commands.push(Command::ResetAll);
        }
    });
}

/// Text about an extreme scene: what makes it difficult and what to watch.
fn case_ui(ui: &mut Ui, case: &Case, facts: &Facts, commands: &mut Vec<Command>) {
    let weak = ui.visuals().weak_text_color();
    ui.add(egui::Label::new(RichText::new(case.family.title).small().color(weak)).wrap());
    ui.add(egui::Label::new(RichText::new(case.title()).heading()).wrap());
    changed_ui(ui, facts, commands);
    let watch = case.watch.map_or("", |watch| watch.look_for);
    for (heading, text) in [
        ("Watch", watch),
        ("What is difficult", case.stiff.as_str()),
        ("What it teaches", case.family.lesson),
    ] {
        ui.add_space(6.0);
        ui.label(RichText::new(heading).small().color(weak));
        ui.add(egui::Label::new(text).wrap());
    }
    ui.add_space(10.0);
    let command = Command::BookArithmetic;
    let button = egui::Button::new(command.name()).selected(facts.is_on(command));
    let response = ui.add(button);
    if tips::beside(ui, response, command.help()).clicked() {
        commands.push(command);
    }
}

/// Text about the current view.
fn view_ui(ui: &mut Ui, facts: &Facts, commands: &mut Vec<Command>) {
    let show = facts.model.view.show();
    let about = About::new("View", "What the window shows in place of the picture (Ctrl+1 to Ctrl+8)");
    list(ui, about, show.name(), |ui| {
        for show in Show::ALL {
            item(ui, facts, commands, Command::Show(show));
        }
    });
    if show != Show::Picture {
        ui.add(egui::Label::new(RichText::new(show.help()).small()).wrap());
        ui.add_space(6.0);
    }
}

fn compare_ui(ui: &mut Ui, stage: &'static Stage, facts: &Facts, commands: &mut Vec<Command>) {
    let view = &facts.model.view;
    let weak = ui.visuals().weak_text_color();
    ui.label(RichText::new("Compare").small().color(weak));
    if view.with() == With::Book {
        ui.add(egui::Label::new("with the book's arithmetic, same camera").wrap());
    } else if let Some(other) = partner(stage) {
        let whose = if is_of_cameras(stage) { ", each with its own camera" } else { ", same camera" };
        let with = format!("with {} {}{whose}", other.section, other.title);
        ui.add(egui::Label::new(with).wrap());
    }
    ui.horizontal_wrapped(|ui| {
        for (command, name) in [(Command::Wipe, "Wipe"), (Command::Difference, "Difference")] {
            let is_on = facts.is_on(command);
            let response = ui.add(egui::Button::new(name).selected(is_on));
            if tips::beside(ui, response, command.help()).clicked() {
                commands.push(command);
            }
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::checked::CheckedScene;
    use crate::app::model::origin::{Origin, Source};
    use crate::scene::animation::Keyframe;

    use crate::app::tests::{dressed, facts_of};
    use crate::job::recipe::Recipe;

    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;
    use std::sync::Arc;

    struct Panel {
        facts: Facts,
        commands: Vec<Command>,
    }

    fn panel(words: &str) -> Harness<'static, Panel> {
        let panel = Panel { facts: facts_of(words), commands: Vec::new() };
        let draw = |ui: &mut Ui, Panel { facts, commands }: &mut Panel| {
            let mut is_with_next = facts.model.view.is_with_next;
            super::ui(ui, &mut is_with_next, facts, commands);
            facts.model.view.is_with_next = is_with_next;
        };
        dressed([270.0, 900.0]).build_ui_state(draw, panel)
    }

    #[test]
    fn spheres_and_materials_are_counted_as_edited() {
        let mut harness = panel("--scene field:20 --size 32x18");
        let told = |harness: &Harness<'_, Panel>| {
            let scene = harness.state().facts.document().scene();
            let words = format!("{} spheres, {} materials", scene.spheres.len(), scene.materials.len());
            assert!(harness.query_by_label(&words).is_some(), "{words}");
            words
        };
        let before = told(&harness);
        let document = &mut harness.state_mut().facts.model.document;
        let mut scene = document.scene().clone();
        let material = scene.materials[0].clone();
        scene.materials.extend([material.clone(), material]);
        scene.spheres.truncate(4);
        document.checked = Arc::new(CheckedScene::new(Arc::new(scene), *document.rules()));
        harness.run_steps(3);
        assert_ne!(told(&harness), before);
    }

    #[test]
    fn a_scene_with_keyframes_tells_how_its_animation_is_made() {
        let mut recipe = Recipe::builtin("three-spheres").unwrap();
        let source = Source::File("/of/mine.toml".into());
        let mut harness = panel("--stage sky --size 32x18");
        for (frames, is_told) in [(Vec::new(), false), (vec![0, 20], true)] {
            recipe.keyframes =
                frames.iter().map(|frame| Keyframe { frame: *frame, camera: recipe.camera }).collect();
            let document = Document::new(Origin::new(recipe.clone(), source.clone()));
            harness.state_mut().facts.model.document = document;
            harness.run_steps(3);
            for words in ["Animation", "21 frames along", "--frames=0..21"] {
                assert_eq!(harness.query_by_label_contains(words).is_some(), is_told, "{words}");
            }
        }
    }
}
