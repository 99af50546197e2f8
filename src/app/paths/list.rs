//! The list of paths, and the explanation of one ray.

use super::paint::end_of;
use super::{Path, Paths, most};
use crate::app::inspector::names;
use crate::app::model::document::Document;
use crate::app::tips::{self, Side};
use crate::app::widgets::compact;
use crate::scene::Scene;
use eframe::egui::{self, DragValue, RichText, Ui};

impl Paths {
    /// Draws the list.
    pub fn ui(&mut self, ui: &mut Ui, document: &Document) {
        let weak = ui.visuals().weak_text_color();
        let Some(listed) = &self.listed else {
            let text = if document.no_rays().is_some() {
                "This stage traces no rays, so its pixels have no paths.".to_owned()
            } else if self.is_waiting {
                "Recording paths…".to_owned()
            } else if let Some(reason) = &self.fault {
                format!("The paths could not be recorded: {reason}")
            } else {
                "T lists the paths of the pixel under the pointer; so do Alt-click and right-click."
                    .to_owned()
            };
            ui.label(RichText::new(text).color(weak).small());
            return;
        };
        let pixel = listed.pixel;
        ui.add_space(6.0);
        let heading = ui.label(RichText::new(format!("Paths of pixel {}, {}", pixel[0], pixel[1])).strong());
        if std::mem::take(&mut self.is_new) {
            heading.scroll_to_me(Some(egui::Align::Min));
        }
        let last = listed.paths.len().saturating_sub(1);
        let mut selected = self.selected;
        let mut ray = self.ray;
        let (most, before) = (most(document), self.count_in(document));
        let mut count = before;
        let mut is_cleared = false;
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            let suffix = if count == 1 { " path" } else { " paths" };
            let drag = DragValue::new(&mut count).range(1..=most).speed(0.2).suffix(suffix);
            let help = match most {
                1 => "The picture has one sample per pixel, so each pixel has one path".to_owned(),
                _ => format!("How many of the pixel's samples are listed, 1 to {most}"),
            };
            let drag = ui.add(drag);
            tips::beside(ui, drag, &help).accessible_name("Paths listed");
            let at = selected.unwrap_or(0);
            let [earlier, later] = [at.checked_sub(1), Some(at + 1).filter(|next| *next <= last)];
            if let Some(to) = step_button(ui, "‹", "Path of the sample before", earlier) {
                selected = Some(to);
            }
            if let Some(to) = step_button(ui, "›", "Path of the sample after", later) {
                selected = Some(to);
            }
            let clear = ui.small_button("Clear");
            let clear = tips::beside(ui, clear, "Remove the paths from the picture");
            is_cleared = clear.accessible_name("Clear paths").clicked();
        });
        if listed.document.camera != document.camera {
            let text = "Listed with an earlier camera; T lists those of the pixel under the pointer.";
            ui.add(egui::Label::new(RichText::new(text).small().color(weak)).wrap());
        }
        for (index, path) in listed.paths.iter().enumerate() {
            let rays = if path.steps.len() == 1 { "ray" } else { "rays" };
            let text = format!("sample {index:>2}  {:>2} {rays}", path.steps.len());
            let header = egui::CollapsingHeader::new(RichText::new(text).monospace())
                .id_salt(("path", index))
                .open(Some(selected == Some(index)))
                .show(ui, |ui| {
                    if selected == Some(index) {
                        path_ui(ui, path, &mut ray, document.scene());
                    }
                })
                .header_response;
            let help = "One path of this pixel; the open one is drawn most clearly";
            let header = tips::beside(ui, header, help);
            if header.accessible_name(format!("Path of sample {index}")).clicked() {
                selected = (selected != Some(index)).then_some(index);
            }
        }
        self.ray = ray;
        self.select(selected);
        if is_cleared {
            self.forget();
        } else if count != before {
            self.count = count;
            if let Some(listed) = &self.listed {
                let before = Document { camera: listed.document.camera, ..document.clone() };
                self.list(&before, pixel, ui.ctx());
            }
        }
    }
}

/// A small button that leads to `to`, if there is such a place. Returns it when clicked.
fn step_button(ui: &mut Ui, label: &str, name: &str, to: Option<usize>) -> Option<usize> {
    let response = ui.add_enabled(to.is_some(), egui::Button::new(label).small());
    let response =
        tips::explain(ui, response, Side::Beside, name, Some("There is none")).accessible_name(name);
    to.filter(|_| response.clicked())
}

/// The rays of a path by name, and the explanation of ray `at`.
fn path_ui(ui: &mut Ui, path: &Path, at: &mut usize, scene: &Scene) {
    let weak = ui.visuals().weak_text_color();
    let last = path.steps.len().saturating_sub(1);
    let shown = (*at).min(last);
    for (index, (step, _)) in path.steps.iter().enumerate() {
        let what = match step.hit {
            Some(hit) => {
                let (object, material) = names(scene, hit.sphere);
                format!("{object}, {material}")
            }
            None => "the sky".to_owned(),
        };
        let title = ui.selectable_label(index == shown, format!("{}  {what}", index + 1));
        if title.accessible_name(format!("Ray {}", index + 1)).clicked() {
            *at = index;
        }
        if index == shown {
            explanation(ui, path, index);
        }
    }
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        if let Some(to) = step_button(ui, "‹", "Ray before (Left)", shown.checked_sub(1)) {
            *at = to;
        }
        if let Some(to) =
            step_button(ui, "›", "Ray after (Right)", Some(shown + 1).filter(|next| *next <= last))
        {
            *at = to;
        }
        ui.label(RichText::new(format!("ray {} of {}", shown + 1, last + 1)).small().color(weak));
    });
    ui.label(RichText::new(format!("adds {}", triple(path.record.radiance))).small().color(weak));
}

/// What one ray does, in words and numbers.
fn explanation(ui: &mut Ui, path: &Path, index: usize) {
    let weak = ui.visuals().weak_text_color();
    let Some((step, sentence)) = path.steps.get(index) else { return };
    ui.add(egui::Label::new(sentence).wrap());
    let throughput = step.throughput.to_array();
    let mut lines = vec![("throughput", triple(throughput))];
    if let Some(hit) = step.hit {
        lines.push(("position", triple(hit.point.to_array())));
        lines.push(("normal", triple(hit.normal.to_array())));
        lines.push(("distance", compact(end_of(step).distance(step.origin))));
    }
    // The ratio of the next ray's throughput to this one's is the surface's attenuation.
    if let Some((next, _)) = path.steps.get(index + 1) {
        let next = next.throughput.to_array();
        let share = |i: usize| if throughput[i] == 0.0 { 0.0 } else { next[i] / throughput[i] };
        lines.push(("attenuation", triple([share(0), share(1), share(2)])));
    }
    egui::Grid::new(("ray", index)).num_columns(2).min_row_height(0.0).spacing([8.0, 1.0]).show(ui, |ui| {
        for (name, value) in lines {
            ui.label(RichText::new(name).small().color(weak));
            ui.label(RichText::new(value).small());
            ui.end_row();
        }
    });
}

fn triple(v: [f64; 3]) -> String {
    format!("{} {} {}", compact(v[0]), compact(v[1]), compact(v[2]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::paths::tests::listed;
    use crate::app::tests::{dressed, leave};
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    /// The list of a picture's paths in a panel.
    fn panel(document: &Document, paths: Paths) -> Harness<'_, Paths> {
        let draw = move |ui: &mut Ui, paths: &mut Paths| paths.ui(ui, document);
        dressed([270.0, 900.0]).build_ui_state(draw, paths)
    }

    #[test]
    fn buttons_go_through_paths_and_rays() {
        let (document, paths) = listed("metal", [16, 9]);
        let mut harness = panel(&document, paths);
        let mut press = |name: &str| {
            leave(&mut harness);
            harness.get_by_label(name).click();
            harness.run_steps(3);
            let paths = harness.state();
            (paths.selected, paths.ray)
        };
        assert_eq!(press("Ray after (Right)"), (Some(0), 1));
        assert_eq!(press("Ray before (Left)"), (Some(0), 0));
        assert_eq!(press("Ray before (Left)"), (Some(0), 0), "there is none before");
        assert_eq!(press("Ray 2"), (Some(0), 1));
        assert_eq!(press("Path of the sample after"), (Some(1), 0));
        assert_eq!(press("Path of the sample after"), (Some(2), 0));
        assert_eq!(press("Path of the sample before"), (Some(1), 0));
        assert_eq!(press("Path of sample 5"), (Some(5), 0));
        assert_eq!(press("Path of sample 5"), (None, 0), "it folds");
        assert_eq!(press("Path of the sample before").0, None, "there is none before the first");
        press("Clear paths");
        assert_eq!(harness.state().len(), 0);
    }
}
