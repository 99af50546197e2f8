//! Where the camera stands and where it looks.

use super::{Group, Reset};
use crate::app::command::Command;
use crate::app::widgets::{About, slider, vector};
use crate::app::window::Window;
use crate::scene::Camera;
use crate::stages::Shading;
use eframe::egui::{self, Ui};

pub(super) const GROUP: Group = Group { name: "Camera", ui, reset: Some(Reset { is_changed, reset }) };

fn placed(camera: &Camera) -> (glam::DVec3, glam::DVec3, glam::DVec3, f64) {
    (camera.look_from, camera.look_at, camera.vup, camera.vfov_degrees)
}

fn is_changed(window: &Window) -> bool {
    placed(&window.document().camera) != placed(&window.document().origin.recipe.camera)
}

fn reset(window: &mut Window) {
    let Camera { look_from, look_at, vup, vfov_degrees, .. } = window.document().origin.recipe.camera;
    let camera = &mut window.document_mut().camera;
    *camera = Camera { look_from, look_at, vup, vfov_degrees, ..*camera };
}

/// Why the camera does not matter.
pub(super) fn useless(window: &Window) -> Option<&'static str> {
    (window.document().rules().shading == Shading::ImageGradient)
        .then_some("This stage sends no rays: its picture is computed from the pixel's place alone")
}

fn ui(window: &mut Window, ui: &mut Ui) {
    let useless = useless(window);
    let camera = &mut window.document_mut().camera;
    let speed = (camera.look_from.distance(camera.look_at) * 0.005).max(1e-4);
    let about = |name, help| About::new(name, help).useless_if(useless);
    vector(ui, about("Look from", "The eye, scene units (look_from)"), &mut camera.look_from, speed);
    vector(
        ui,
        about("Look at", "A point in the middle of the picture, scene units (look_at)"),
        &mut camera.look_at,
        speed,
    );
    vector(
        ui,
        about("Up", "What is up in the picture; its length does not matter (vup)"),
        &mut camera.vup,
        0.01,
    );
    let vfov = about("Field of view", "From the lower to the upper edge, degrees (vfov)");
    slider(ui, vfov, &mut camera.vfov_degrees, 1.0..=170.0, |slider| {
        slider.suffix("°").max_decimals(1).clamping(egui::SliderClamping::Edits)
    });
    bookmarks(window, ui);
}

fn bookmarks(window: &mut Window, ui: &mut Ui) {
    let mut chosen = None;
    let mut removed = None;
    ui.horizontal_wrapped(|ui| {
        if ui.button("Bookmark").on_hover_text("Keep camera and lens to come back to (Ctrl+B)").clicked() {
            window.send(Command::AddBookmark);
        }
        let bookmarks = &mut window.remembered_mut().bookmarks;
        ui.add_enabled_ui(!bookmarks.is_empty(), |ui| {
            ui.menu_button("Go to", |ui| {
                for (index, bookmark) in bookmarks.iter().enumerate() {
                    ui.horizontal(|ui| {
                        if ui.button(&bookmark.name).clicked() {
                            chosen = Some(bookmark.camera());
                            ui.close();
                        }
                        let forget = ui.small_button("×").on_hover_text("Forget this bookmark");
                        if forget.accessible_name(format!("Forget {}", bookmark.name)).clicked() {
                            removed = Some(index);
                        }
                    });
                }
            });
        })
        .response
        .on_disabled_hover_text("There is no bookmark yet");
        if let Some(index) = removed {
            bookmarks.remove(index);
        }
    });
    if let Some(camera) = chosen {
        window.document_mut().camera = camera;
    }
}
