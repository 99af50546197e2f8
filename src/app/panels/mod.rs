//! The left panel, with one file for each group of controls.

mod bookmarks;
mod camera;
mod lens;
mod output;
mod render;
mod reset;
mod spheres;
mod stop;

use super::command::Command;
use super::facts::Facts;
use super::model::document::Document;
use super::model::edit::Edit;
use super::model::remembered::Remembered;
use super::spheres::Selected;
use super::tips::{self, Side};
use eframe::egui::{self, RichText, Ui};
use reset::Reset;

/// Draws the groups. For a new user those about rendering are folded at first.
pub fn ui(
    ui: &mut Ui,
    (document, selected): (&mut Document, Option<&Selected>),
    remembered: &mut Remembered,
    (facts, is_new): (&Facts, bool),
    (edits, commands): (&mut Vec<Edit>, &mut Vec<Command>),
) {
    if let Some(reason) = &facts.invalid {
        let text = RichText::new(reason).color(ui.visuals().error_fg_color);
        ui.add(egui::Label::new(text).wrap());
        ui.add_space(4.0);
    }
    group(ui, ("Spheres", true), Some(&spheres::RESET), document, |ui, _| {
        spheres::ui(ui, selected, facts, edits, commands);
    });
    group(ui, ("Camera", true), Some(&camera::RESET), document, |ui, document| {
        camera::ui(ui, &mut document.camera, facts);
        bookmarks::ui(ui, &document.camera, &mut remembered.bookmarks, facts, commands);
    });
    group(ui, ("Lens", true), Some(&lens::RESET), document, |ui, document| {
        lens::ui(ui, &mut document.camera, facts);
    });
    group(ui, ("Render", !is_new), Some(&render::RESET), document, |ui, document| {
        render::ui(ui, &mut document.settings, remembered, facts);
    });
    group(ui, ("Stop", !is_new), Some(&stop::RESET), document, |ui, document| {
        stop::ui(ui, &mut document.stop, facts);
    });
    group(ui, ("Output", !is_new), Some(&output::RESET), document, |ui, document| {
        output::ui(ui, document, facts, commands);
    });
}

/// A collapsible group of controls, at first open or folded. `reset` is `None` if the stage has no values for the group.
fn group(
    ui: &mut Ui,
    (name, is_open): (&str, bool),
    reset: Option<&Reset>,
    document: &mut Document,
    body: impl FnOnce(&mut Ui, &mut Document),
) {
    let id = ui.make_persistent_id(("group", name));
    let state = egui::collapsing_header::CollapsingState::load_with_default_open(ui.ctx(), id, is_open);
    let mut is_pressed = false;
    let mut header = state.show_header(ui, |ui| {
        is_pressed = heading(ui, name, id);
        let Some(Reset { is_changed, reset }) = reset else { return };
        let is_changed = is_changed(document);
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let button = ui.add_enabled(is_changed, egui::Button::new("Reset").small());
            let (help, reason) = ("Reset to the stage's values", "Nothing here differs from the stage");
            let button = tips::explain(ui, button, Side::Beside, help, Some(reason))
                .accessible_name(format!("Reset {}", name.to_lowercase()));
            if button.clicked() {
                reset(document);
            }
        });
    });
    if is_pressed {
        header.toggle();
    }
    header.body_unindented(|ui| {
        ui.add_space(2.0);
        body(ui, document);
    });
    ui.add_space(6.0);
}

/// The name of a group. Returns whether it was clicked, or the place beside it, which folds the group as its triangle does.
fn heading(ui: &mut Ui, name: &str, id: egui::Id) -> bool {
    let label = ui.add(egui::Label::new(RichText::new(name).strong()).selectable(false)).rect;
    let half = 0.5 * ui.spacing().interact_size.y;
    let (middle, right) = (label.center().y, ui.max_rect().right());
    let row = egui::Rect::from_x_y_ranges(label.left()..=right, middle - half..=middle + half);
    // The Tab key leads to the triangle.
    let response = ui.interact(row, id.with("heading"), egui::Sense::CLICK);
    response.on_hover_cursor(egui::CursorIcon::PointingHand).clicked()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::Model;
    use crate::app::model::device::Device;
    use crate::app::model::origin::Origin;
    use crate::app::model::remembered::Bookmark;
    use crate::app::model::sizing::Sizing;
    use crate::app::model::viewpoint::Viewpoint;
    use crate::app::spheres::Spheres;
    use crate::app::tests::{Case, Drawings, alone, dressed, facts_of, leave};
    use crate::progressive::Stop;
    use crate::stages::Stage;
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

    fn draw(drawings: &mut Drawings, harness: &mut Harness<'_, Panel>, name: &str) {
        leave(harness);
        drawings.add(name, harness);
    }

    #[test]
    fn stages_have_the_controls_that_they_need() {
        let mut drawings = Drawings::default();
        let mut harness = panel("--stage glass-schlick --size 32x18");
        for id in
            ["glass-schlick", "ppm-tiny", "red-sphere", "normals", "antialiased", "gamut", "defocus", "book"]
        {
            let document = Document::new(Origin::of_stage(Stage::find(id).unwrap()));
            harness.state_mut().facts.model.document = document;
            draw(&mut drawings, &mut harness, id);
        }
        harness.state_mut().facts.invalid = Some("look_from is look_at".to_owned());
        draw(&mut drawings, &mut harness, "invalid");
        drawings.add("of a new user", &panel_of("--stage defocus --size 32x18", true));
        drawings.keep("panel_stages");
    }

    #[test]
    fn a_selected_sphere_has_the_controls_of_its_material() {
        let mut drawings = Drawings::default();
        let mut harness = panel("--stage metal-fuzzy --size 32x18");
        for id in ["metal-fuzzy", "glass-schlick", "gamut", "normals-world", "red-sphere"] {
            let document = Document::new(Origin::of_stage(Stage::find(id).unwrap()));
            let count = document.scene().spheres.len();
            harness.state_mut().facts.model.document = document;
            for sphere in 0..count {
                harness.state_mut().facts.model.selected = Some(sphere);
                draw(&mut drawings, &mut harness, &format!("{id} {sphere}"));
            }
        }
        drawings.keep("panel_spheres");
    }

    #[test]
    fn settings_are_shown_and_can_be_reset_where_they_were_changed() {
        let mut drawings = Drawings::default();
        let mut harness = panel("--stage defocus --size 32x18");
        harness.state_mut().facts.model.remembered.sizing = Sizing::Book;
        draw(&mut drawings, &mut harness, "as it was");
        let changes: [Case<Model>; 11] = [
            ("three limits", |model| {
                model.document.stop = Stop { samples: Some(100), seconds: Some(2.5), noise: Some(0.001) };
            }),
            ("one half", |model| model.document.settings.estimate_error = false),
            ("no limit", |model| model.document.stop = Stop::default()),
            ("another camera", |model| model.document.camera.vfov_degrees = 77.0),
            ("a pinhole", |model| model.document.camera.defocus_angle_degrees = 0.0),
            ("the size of the book", |model| model.document.has_own_size = false),
            ("the size of the viewport", |model| model.remembered.sizing = Sizing::Viewport),
            ("GPU", |model| model.remembered.device = Device::Gpu),
            ("both", |model| model.remembered.device = Device::Both),
            ("reference", |model| model.remembered.device = Device::Reference),
            ("lanes and threads", |model| {
                let remembered = &mut model.remembered;
                (remembered.lanes, remembered.threads, remembered.device) = (Some(8), Some(3), Device::Cpu);
            }),
        ];
        for (name, change) in changes {
            change(&mut harness.state_mut().facts.model);
            draw(&mut drawings, &mut harness, name);
        }
        drawings.keep("panel_settings");
    }

    #[test]
    fn bookmarks_are_listed_with_what_can_be_done_to_them() {
        let mut drawings = Drawings::default();
        let mut harness = panel("--stage defocus --size 32x18");
        let camera = harness.state().facts.document().camera;
        for side in Viewpoint::ALL {
            let bookmark = Bookmark::new(format!("the {side:?}"), &side.camera(&camera, camera.vup));
            harness.state_mut().facts.model.remembered.bookmarks.push(bookmark);
        }
        harness.state_mut().facts.model.document.camera = Viewpoint::Top.camera(&camera, camera.vup);
        draw(&mut drawings, &mut harness, "six, of which the second is here");
        for name in ["Right", "Top", "Back"] {
            let menu = format!("Change the {name}");
            harness.get_by_label(&menu).click_accesskit();
            harness.run_steps(3);
            draw(&mut drawings, &mut harness, &menu);
            harness.key_press(egui::Key::Escape);
            harness.run_steps(3);
        }
        drawings.keep("panel_bookmarks");
    }

    #[test]
    fn lists_show_what_can_be_chosen() {
        alone("panels::tests::lists_show_what_can_be_chosen", || {
            let mut drawings = Drawings::default();
            let mut harness = panel("--stage metal-fuzzy --size 32x18");
            harness.state_mut().facts.model.selected = Some(2);
            draw(&mut drawings, &mut harness, "closed");
            for name in ["Material", "Device", "Sampler"] {
                press(&mut harness, name);
                draw(&mut drawings, &mut harness, name);
                drawings.add_tips_of(&mut harness, &["CPU", "GPU", "Both", "f64"]);
                harness.key_press(egui::Key::Escape);
                harness.run_steps(3);
            }
            drawings.keep("panel_lists");
        });
    }

    #[test]
    fn every_control_has_its_tip() {
        let mut drawings = Drawings::default();
        for (words, selected) in [
            ("--stage defocus --size 32x18", None),
            ("--stage ppm-tiny", None),
            ("--stage metal-fuzzy --size 32x18", Some(2)),
            ("--stage normals --size 32x18", Some(0)),
        ] {
            let mut harness = panel(words);
            harness.state_mut().facts.model.selected = selected;
            draw(&mut drawings, &mut harness, words);
            drawings.add_tips(&mut harness);
        }
        drawings.keep("panel_tips");
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
}
