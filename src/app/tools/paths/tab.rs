//! The dock's tab of a path: its points in words, and the path seen from the side.

use super::{Path, Paths, side};
use crate::app::model::Document;
use crate::app::model::spheres::is_ground;
use crate::app::toolkit::number::{compact, point_words};
use crate::app::toolkit::theme;
use crate::app::toolkit::widgets::{choice, hint, sign_button, small, tip};
use crate::backends::explain::{Event, Lobe};
use crate::progressive::describe::counted;
use eframe::egui::{Align, Atom, Label, Layout, Margin, RichText, ScrollArea, Sides, Ui, vec2};

/// The largest width of the list, points.
const LIST: f32 = 352.0;

impl Paths {
    pub fn ui(&mut self, ui: &mut Ui) {
        let (Some(listed), Some(path)) = (&self.query.answer, self.path()) else {
            let fault =
                self.query.fault.as_ref().map(|reason| format!("The paths were not recorded: {reason}"));
            hint(
                ui,
                match &fault {
                    Some(fault) => fault,
                    None if self.query.answers.is_open() => "Recording paths\u{2026}",
                    None => "Point at the picture and press T.",
                },
            );
            return;
        };
        let width = (0.5 * ui.available_width()).min(LIST);
        let (mut selected, mut point) = (self.selected, self.point);
        ui.horizontal_top(|ui| {
            ui.spacing_mut().item_spacing.x = 16.0;
            let size = vec2(width, ui.available_height());
            ui.allocate_ui_with_layout(size, Layout::top_down(Align::Min), |ui| {
                ui.set_width(width);
                ui.spacing_mut().item_spacing = vec2(8.0, 0.0);
                Sides::new().show(
                    ui,
                    |ui| {
                        let title = format!("Path {} of {}", self.selected + 1, listed.paths.len());
                        ui.label(RichText::new(title).strong());
                        let [x, y] = listed.pixel;
                        small(ui, format!("pixel {x}, {y}"));
                    },
                    |ui| {
                        let last = listed.paths.len() - 1;
                        for (sign, name, to) in [
                            ("›", "Next path", (self.selected + 1).min(last)),
                            ("‹", "Previous path", self.selected.saturating_sub(1)),
                        ] {
                            let response = ui
                                .add_enabled_ui(to != self.selected, |ui| sign_button(ui, sign, 24.0, name));
                            let help = "The path of another sample of this pixel";
                            if tip(ui, response.inner, help, Some("There is none")).clicked() {
                                selected = to;
                            }
                        }
                    },
                );
                ui.add_space(4.0);
                ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                    points_ui(ui, path, &mut point, &listed.document);
                });
            });
            ui.vertical(|ui| {
                ui.spacing_mut().item_spacing.y = 4.0;
                small(ui, "Seen from the side");
                side::ui(ui, path, self.point, &listed.document);
            });
        });
        self.point = point;
        if selected != self.selected {
            self.select(selected);
        }
    }
}

fn points_ui(ui: &mut Ui, path: &Path, point: &mut usize, document: &Document) {
    let shown = *point;
    for at in 0..=path.len() {
        let (is_shown, number) = (at == shown, RichText::new((at + 1).to_string()).weak());
        let button = choice(ui, is_shown, (number, title(path, at, document), Atom::grow()));
        let button = button.min_size(vec2(ui.available_width(), 24.0)).frame_when_inactive(is_shown);
        let response = ui.add(button);
        if response.clicked() {
            *point = at;
        }
        if !is_shown {
            continue;
        }
        let words = match at.checked_sub(1).and_then(|before| path.get(before)) {
            Some((_, sentence)) => sentence,
            None => "The path goes backwards: from the eye to where the light may come from.",
        };
        theme::panel(Margin::symmetric(8, 4)).show(ui, |ui| ui.add(Label::new(words).wrap()));
        let response = tip(ui, response, &figures(path, at), None);
        let place = ui.scope_id().with("scrolled to");
        if ui.data(|data| data.get_temp(place)) != Some(at) {
            ui.data_mut(|data| data.insert_temp(place, at));
            response.scroll_to_me(None);
        }
    }
}

/// A point of a path in a few words.
fn title(path: &Path, at: usize, document: &Document) -> String {
    let Some((step, _)) = at.checked_sub(1).and_then(|before| path.get(before)) else {
        return "from the camera".to_owned();
    };
    let hit = step.hit;
    let is_ground = |sphere: usize| is_ground(&document.scene().spheres[sphere], &document.camera);
    match step.event {
        Event::Sky => "ends in the sky",
        Event::Shown => "ends at the surface",
        Event::Limit => return format!("ends after {}", counted(at as u64, "ray")),
        Event::Absorbed(_) => "ends in the metal",
        Event::Scattered(Lobe::Glass { refracts, .. }) => {
            match (refracts, hit.is_some_and(|hit| hit.is_outside)) {
                (true, true) => "into the glass",
                (true, false) => "out of the glass",
                (false, true) => "off the glass",
                (false, false) => "back into the glass",
            }
        }
        Event::Scattered(_) if hit.is_some_and(|hit| is_ground(hit.sphere)) => "off the ground",
        Event::Scattered(Lobe::Metal { .. }) => "off metal",
        Event::Scattered(Lobe::Hemisphere | Lobe::Lambertian) => "off matte",
    }
    .to_owned()
}

/// The numbers of a point.
fn figures(path: &Path, at: usize) -> String {
    let before = at.checked_sub(1).and_then(|before| path.get(before));
    let mut lines = Vec::new();
    if let Some((step, hit)) = before.and_then(|(step, _)| Some((step, step.hit?))) {
        lines.push(format!("position {}", point_words(hit.point)));
        lines.push(format!("normal {}", point_words(hit.normal)));
        lines.push(format!("distance {}", compact(hit.point.distance(step.origin))));
    }
    if let Some((step, _)) = path.get(at).or(before) {
        lines.push(format!("share of the light that counts {}", point_words(step.throughput)));
    }
    lines.join("\n")
}
