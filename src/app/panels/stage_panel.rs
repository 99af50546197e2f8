//! The text about the stage: what it adds, what to look for, and what to compare it with.

use crate::app::commands::{Command, PanelContext};
use crate::app::model::{Document, Source};
use crate::app::toolkit::widgets::{add_command, command_button, hint, primary, small};
use crate::measure::stress::Case;
use crate::progressive::describe::counted;
use crate::stages::Stage;
use eframe::egui::{Label, Link, RichText, Ui};

/// How a scene of one's own begins.
const NEW: &str = "Insert puts a sphere where the pointer is. Click a sphere to drag it; the controls change its size, its \
                   material and the sky. Ctrl+S saves the picture or the scene.";

pub fn ui(ui: &mut Ui, cx: &PanelContext) {
    let document = cx.document();
    match (document.stage(), document.case()) {
        (Some(stage), _) => stage_ui(ui, stage, cx),
        (None, Some(case)) => case_ui(ui, case),
        (None, None) => recipe_ui(ui, document),
    }
    // At the end, so that it moves nothing.
    if document.has_changed_scene() || document.camera != document.origin.recipe.camera {
        ui.add_space(8.0);
        let what = if document.stage().is_some() { "stage" } else { "picture" };
        hint(ui, &format!("You changed this {what}."));
        command_button(ui, cx, Command::ResetAll, &Command::ResetAll.name());
    }
}

/// A title, with what it belongs to above.
pub fn title(ui: &mut Ui, over: &str, title: &str) {
    small(ui, over);
    ui.add_space(-4.0);
    ui.add(Label::new(RichText::new(title).heading().strong()).wrap());
}

/// A paragraph under a small heading.
pub fn paragraph(ui: &mut Ui, heading: &str, text: &str) {
    ui.add_space(4.0);
    small(ui, heading);
    ui.add_space(-4.0);
    ui.add(Label::new(RichText::new(text).line_height(Some(20.0))).wrap());
}

fn stage_ui(ui: &mut Ui, stage: &Stage, cx: &PanelContext) {
    title(ui, &format!("{} {}", stage.section, stage.section_title()), stage.title);
    add_command(ui, cx, Command::Book, Link::new(format!("{} in the book", stage.section)));
    show_me(ui, stage, cx);
    for (heading, text) in
        [("What is new", stage.what_is_new), ("Look for", stage.look_for), ("Why", stage.why)]
    {
        paragraph(ui, heading, text);
    }
}

/// A button that shows what to look for, and then says what is seen.
fn show_me(ui: &mut Ui, stage: &Stage, cx: &PanelContext) {
    let is_off = cx.disabled_reason(Command::ShowMe).is_some();
    ui.add_space(4.0);
    if cx.has_sight || is_off {
        let label = if cx.has_sight { "Return" } else { "Show me" };
        command_button(ui, cx, Command::ShowMe, label);
    } else {
        add_command(ui, cx, Command::ShowMe, primary("Show me"));
    }
    if cx.has_sight {
        let text = RichText::new(stage.sight.caption).strong().line_height(Some(20.0));
        ui.add(Label::new(text).wrap());
    }
}

/// Text about a scene that is not a stage.
fn recipe_ui(ui: &mut Ui, document: &Document) {
    let scene = document.scene();
    let spheres = counted(scene.spheres.len() as u64, "sphere");
    let materials = counted(scene.materials.len() as u64, "material");
    title(ui, &format!("{spheres}, {materials}"), &document.heading());
    if document.origin.source == Source::New {
        paragraph(ui, "To begin with", NEW);
    }
}

/// Text about an extreme scene: what makes it difficult and what to watch.
fn case_ui(ui: &mut Ui, case: &Case) {
    title(ui, &case.family.title, case.title());
    for (heading, text) in [
        ("Watch", case.claim.look_for.as_str()),
        ("What is difficult", case.difficulty()),
        ("What it teaches", &case.family.lesson),
    ] {
        paragraph(ui, heading, text);
    }
}
