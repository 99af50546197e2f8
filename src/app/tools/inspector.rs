//! The pixel inspector: value, error, and the surface under the pointer.

use crate::app::model::Document;
use crate::app::toolkit::widgets::{compact, hint, tip};
use crate::app::toolkit::{Query, theme};
use crate::app::tracing::subject::{PictureId, Subject};
use crate::backends::layers::Layer;
use crate::film::to_byte;
use crate::progressive::standard_error;
use crate::scene::Scene;
use eframe::egui::{self, Align, Color32, Layout, Rect, RichText, Sense, TextStyle, Ui, UiBuilder, vec2};

/// With more spheres than this, searching for the one under the pointer would stall the window.
const PICK_LIMIT: usize = 50_000;

/// Height of a row and distance of the columns of numbers, sizes of the font.
const ROW: f32 = 4.0 / 3.0;
const COLUMN: f32 = 14.0 / 3.0;

/// A pixel of the film.
#[derive(Clone, Debug, PartialEq)]
pub struct Pixel {
    /// Column and row, from the upper left.
    pub at: [u32; 2],
    /// Linear radiance.
    pub mean: [f64; 3],
    /// Standard error of `mean`.
    pub error: Option<[f64; 3]>,
    /// The 8-bit values in the picture.
    pub bytes: [u8; 3],
}

/// The pixel under the pointer and what is known about it.
#[derive(Default)]
pub struct Inspector {
    pub hovered: Option<[u32; 2]>,
    /// By pixel, film and number of samples.
    query: Query<([u32; 2], PictureId, u64), Pixel>,
}

impl Inspector {
    /// Notes the pixel under the pointer.
    pub fn hover(&mut self, pixel: Option<[u32; 2]>) {
        if pixel.is_some() {
            self.hovered = pixel;
        }
    }

    /// What is known about the pixel.
    pub fn pixel(&self) -> Option<&Pixel> {
        self.query.answer.as_ref()
    }

    /// Forgets the pixel, because the picture has changed.
    pub fn forget(&mut self) {
        *self = Inspector { hovered: self.hovered, ..Inspector::default() };
    }

    /// Takes the film's answer and queries the film again if there may be news. If the film is gone or has no samples,
    /// the last known pixel stays.
    pub fn follow(&mut self, subject: &Subject<'_>, context: &egui::Context) {
        self.query.follow();
        let (document, main) = (subject.document, &subject.tracing.main);
        let Some(at) = self.hovered.filter(|_| main.is_full(document)) else { return };
        let (key, transfer) = ((at, subject.id(), main.shown_samples()), document.rules().transfer);
        subject.ask(context, &mut self.query, key, move |film| {
            let [x, y] = at;
            if x >= film.width() || y >= film.height() || film.sample_count() == 0 {
                return None;
            }
            let index = y as usize * film.width() as usize + x as usize;
            let mean = film.mean(index);
            let bytes = mean.map(|v| to_byte(v, transfer, y as usize, film.height() as usize));
            Some(Pixel { at, mean, error: standard_error(film, index), bytes })
        });
    }

    /// Draws the pixel. `layer` is the displayed layer and its value there; `other` is what is at that place in the
    /// picture that is compared with this one.
    pub fn ui(
        &self,
        ui: &mut Ui,
        document: &Document,
        layer: Option<(Layer, [f64; 3])>,
        other: Option<[f64; 3]>,
    ) {
        ui.spacing_mut().item_spacing.y = 0.0;
        // The header and four rows, so that what is above stays where it is.
        ui.set_min_height(24.0 + 4.0 * ROW * TextStyle::Small.resolve(ui.style()).size);
        let Some(pixel) = self.pixel() else {
            ui.horizontal(|ui| ui.label(RichText::new("Pixel").strong()));
            hint(ui, "Point at the picture to read its numbers.");
            return;
        };
        pixel_ui(document, pixel, layer, other, ui);
        ui.add_space(4.0);
    }
}

/// The display names of a sphere and its material.
pub fn names(scene: &Scene, sphere: usize) -> (String, String) {
    let named = &scene.materials[scene.spheres[sphere].material];
    (format!("sphere {sphere}"), format!("{} ({})", named.name, named.material.kind()))
}

fn pixel_ui(
    document: &Document,
    pixel: &Pixel,
    layer: Option<(Layer, [f64; 3])>,
    other: Option<[f64; 3]>,
    ui: &mut Ui,
) {
    let (colours, [x, y]) = (theme::colours(ui), pixel.at);
    let (what, help) = surface(document, pixel.at).unzip();
    ui.horizontal(|ui| {
        ui.label(RichText::new("Pixel").strong());
        let at = what.map_or_else(|| format!("{x}, {y}"), |what| format!("{x}, {y} · {what}"));
        let text = RichText::new(at).small().color(colours.weak);
        let response = ui.add(egui::Label::new(text).truncate());
        tip(ui, response, help.as_deref().unwrap_or_default(), None);
    });
    let rgb = [("R", colours.bad), ("G", colours.good), ("B", colours.accent)];
    cells(ui, "", "Red, green, blue", rgb.map(|(name, color)| (name.to_owned(), color)));
    let mut line = |name: &str, help: &str, values: [String; 3]| {
        cells(ui, name, help, values.map(|value| (value, colours.strong)));
    };
    let light = "Linear radiance: the mean of the samples, before gamma";
    match other {
        Some(mean) => {
            line("A", &format!("This picture. {light}"), pixel.mean.map(decimals));
            line("B", "The picture that it is compared with", mean.map(decimals));
            let difference = [0, 1, 2].map(|i| pixel.mean[i] - mean[i]);
            line("A − B", "How much brighter this picture is", difference.map(signed));
        }
        None => line("light", light, pixel.mean.map(decimals)),
    }
    let noise = pixel.error.map_or_else(|| [(); 3].map(|()| "–".to_owned()), |error| error.map(decimals));
    line("noise ±", "How far off that mean may still be (standard error)", noise);
    let bytes = pixel.bytes.map(|byte| byte.to_string());
    line("saved as", "The byte that a file gets, 0 to 255", bytes);
    match layer {
        Some((Layer::Normals, normal)) => {
            line("normal", "Which way the surface faces: x, y, z", normal.map(|n| signed(2.0 * n - 1.0)));
        }
        Some((Layer::Albedo, albedo)) => {
            line("albedo", "What the surface reflects", albedo.map(decimals));
        }
        Some((Layer::RaysPerPath, [rays, ..])) => {
            let values = [String::new(), String::new(), format!("{rays:.2}")];
            line("rays per path", "How many rays a path through this pixel has", values);
        }
        None => {}
    }
}

/// The name of the surface at a pixel, and how far away it is.
fn surface(document: &Document, [x, y]: [u32; 2]) -> Option<(String, String)> {
    let scene = document.scene();
    if scene.spheres.len() > PICK_LIMIT {
        return None;
    }
    let [width, height] = document.size();
    let place = [(f64::from(x) + 0.5) / f64::from(width), (f64::from(y) + 0.5) / f64::from(height)];
    let Some(pick) = document.pick(&document.camera, place) else {
        return Some(("sky".to_owned(), String::new()));
    };
    let (sphere, material) = names(scene, pick.sphere);
    Some((material, format!("{sphere}, at distance {}", compact(pick.distance))))
}

fn decimals(value: f64) -> String {
    format!("{value:.4}")
}

fn signed(value: f64) -> String {
    format!("{value:+.4}").replace('-', "−")
}

/// A row of the table.
fn cells(ui: &mut Ui, name: &str, help: &str, values: [(String, Color32); 3]) {
    let em = TextStyle::Small.resolve(ui.style()).size;
    let (row, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW * em), Sense::hover());
    tip(ui, response, help, None);
    let weak = theme::colours(ui).weak;
    let mut cell = |rect: Rect, layout: Layout, text: &str, color: Color32| {
        let mut ui = ui.new_child(UiBuilder::new().max_rect(rect).layout(layout));
        ui.add(egui::Label::new(RichText::new(text).small().color(color)).extend());
    };
    cell(row, Layout::left_to_right(Align::Center), name, weak);
    for (place, (value, color)) in values.into_iter().enumerate() {
        let right = row.right() - COLUMN * em * (2 - place) as f32;
        cell(row.with_max_x(right), Layout::right_to_left(Align::Center), &value, color);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::{Origin, Source};
    use crate::job::recipe::Recipe;
    use crate::render_cpu::record_path;
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    #[test]
    fn a_difference_tells_both_sides() {
        let document = Document::new(Origin::new(Recipe::builtin("three-spheres").unwrap(), Source::Builtin));
        let pixel = Pixel { at: [0, 0], mean: [0.5, 0.25, 1.0], error: None, bytes: [0; 3] };
        let other = [0.25, 0.5, 1.0];
        let harness = Harness::new_ui(|ui| pixel_ui(&document, &pixel, None, Some(other), ui));
        let labels = harness.get_all_by_role(egui::accesskit::Role::Label);
        let texts: Vec<String> = labels.filter_map(|node| node.value()).collect();
        for text in ["A", "B", "A − B", "0.5000", "0.2500", "+0.2500", "−0.2500", "+0.0000"] {
            assert!(texts.iter().any(|found| found == text), "no {text} in {texts:?}");
        }
        assert!(!texts.iter().any(|text| text == "light"));
    }

    /// The sphere under the pointer is the one that the tracer's camera ray hits.
    #[test]
    fn the_sphere_under_the_pointer_is_named() {
        let document = Document::new(Origin::new(Recipe::builtin("three-spheres").unwrap(), Source::Builtin));
        let [width, height] = [document.settings.width, document.settings.height];
        for at in [[width / 8, height * 7 / 8], [width / 2, height / 2], [width / 2, height / 8]] {
            let path = record_path(&document.job(1).unwrap(), at, 0, None);
            let expected =
                path.rays[0].hit.map_or("sky".to_owned(), |hit| names(document.scene(), hit.sphere).1);
            assert_eq!(surface(&document, at).unwrap().0, expected, "{at:?}");
        }
    }
}
