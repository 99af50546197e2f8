//! The panel at the right: what the stage adds, what to look for, and the pixel under the pointer.

use super::command::Command;
use super::compare::Mode;
use super::inspector;
use super::menu::item;
use super::viewport::Show;
use super::widgets::{About, control};
use super::window::Window;
use crate::stress::Case;
use eframe::egui::{self, RichText, Ui};

pub fn ui(window: &mut Window, ui: &mut Ui) {
    match window.document.stage() {
        Some(stage) => {
            let weak = ui.visuals().weak_text_color();
            let over = format!("{} {}", stage.chapter(), stage.chapter_title);
            ui.add(egui::Label::new(RichText::new(over).small().color(weak)).wrap());
            ui.add(egui::Label::new(RichText::new(stage.title).heading()).wrap());
            let link = format!("{} {}", stage.section, stage.section_title);
            ui.add(egui::Hyperlink::from_label_and_url(link, stage.url()).open_in_new_tab(true))
                .on_hover_text(format!(
                    "Opens this section of the book in the web browser:\n{}",
                    stage.url()
                ));
            for (heading, text) in
                [("What is new", stage.what_is_new), ("Why", stage.why), ("Look for", stage.look_for)]
            {
                ui.add_space(6.0);
                ui.label(RichText::new(heading).small().color(weak));
                ui.add(egui::Label::new(text).wrap());
            }
            ui.add_space(10.0);
            compare_ui(window, ui, stage);
        }
        None => match window.document.case() {
            Some(case) => case_ui(window, ui, case),
            None => recipe_ui(window, ui),
        },
    }
    ui.add_space(8.0);
    ui.separator();
    ui.add_space(4.0);
    view_ui(window, ui);
    inspector::ui(window, ui);
}

/// A scene that is no stage.
fn recipe_ui(window: &Window, ui: &mut Ui) {
    let recipe = &window.document.origin.recipe;
    ui.add(egui::Label::new(RichText::new(&recipe.name).heading()).wrap());
    let scene = window.document.scene();
    let (spheres, materials) = (scene.spheres.len(), scene.materials.len());
    ui.label(format!("{spheres} spheres, {materials} materials"));
}

/// An extreme scene: what is stiff about it and what to watch.
fn case_ui(window: &mut Window, ui: &mut Ui, case: &'static Case) {
    let weak = ui.visuals().weak_text_color();
    ui.add(egui::Label::new(RichText::new(case.family.title).small().color(weak)).wrap());
    ui.add(egui::Label::new(RichText::new(case.title()).heading()).wrap());
    let watch = case.watch.map_or("", |watch| watch.look_for);
    for (heading, text) in
        [("Watch", watch), ("What is stiff", case.stiff.as_str()), ("What it teaches", case.family.lesson)]
    {
        ui.add_space(6.0);
        ui.label(RichText::new(heading).small().color(weak));
        ui.add(egui::Label::new(text).wrap());
    }
    ui.add_space(10.0);
    let is_on = window.compare.mode.is_some();
    let command = Command::BookArithmetic;
    let response = ui.add(egui::Button::new(command.name()).selected(is_on)).on_hover_text(command.help());
    if response.clicked() {
        window.send(command);
    }
}

/// What the picture's place shows.
fn view_ui(window: &mut Window, ui: &mut Ui) {
    let show = window.viewport.show;
    control(ui, About::new("View", "What is shown in the picture's place (Ctrl+1 to Ctrl+7)"), |ui| {
        egui::ComboBox::from_id_salt("view")
            .width(ui.available_width())
            .selected_text(show.name())
            .show_ui(ui, |ui| {
                for show in Show::ALL {
                    item(window, ui, Command::Show(show));
                }
            })
            .response
    });
    if show != Show::Picture {
        ui.add(egui::Label::new(RichText::new(show.help()).small()).wrap());
        ui.add_space(6.0);
    }
}

fn compare_ui(window: &mut Window, ui: &mut Ui, stage: &'static crate::stages::Stage) {
    let weak = ui.visuals().weak_text_color();
    ui.label(RichText::new("Compare").small().color(weak));
    if let Some(other) = window.compare.other_of(stage) {
        let whose =
            if window.compare.is_of_cameras(stage) { ", each with its own camera" } else { ", same camera" };
        let with = format!("with {} {}{whose}", other.section, other.title);
        ui.add(egui::Label::new(with).wrap());
    }
    ui.horizontal_wrapped(|ui| {
        for (command, name, mode) in
            [(Command::Wipe, "Wipe", Mode::Wipe), (Command::WipeDifference, "Difference", Mode::Difference)]
        {
            let is_on = window.compare.mode == Some(mode);
            let response = ui.add(egui::Button::new(name).selected(is_on)).on_hover_text(command.help());
            if response.clicked() {
                window.send(command);
            }
        }
        if stage.pair.is_some() && stage.next().is_some_and(|next| Some(next.id) != stage.pair) {
            ui.checkbox(&mut window.compare.is_with_next, "Next stage")
                .on_hover_text("Compare with the next stage of the book in place of the pair");
        }
    });
}
