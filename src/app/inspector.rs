//! The pixel inspector: value, error, and the surface under the pointer.

use super::answers::Answers;
use super::kept::{FilmId, Subject};
use super::model::document::Document;
use super::widgets::compact;
use crate::backends::layers::Layer;
use crate::film::to_byte;
use crate::progressive::standard_error;
use crate::scene::Scene;
use eframe::egui::{self, RichText, Ui};
use std::sync::{Arc, Weak};

/// With more spheres than this, searching for the one under the pointer would stall the window.
const PICK_LIMIT: usize = 50_000;

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
    /// Samples in the pixel.
    pub samples: u64,
}

/// What the picture that is compared with this one has at the pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OtherPixel {
    /// Linear radiance.
    pub mean: [f64; 3],
    /// Its column and row, if that picture is scaled.
    pub scaled: Option<[u32; 2]>,
}

/// The pixel under the pointer and what is known about it.
#[derive(Default)]
pub struct Inspector {
    hovered: Option<[u32; 2]>,
    pixel: Option<Pixel>,
    /// The pixel, the film and its sample count of the last query.
    asked: Option<([u32; 2], FilmId, u64)>,
    /// Can be upgraded as long as the query waits for the film.
    waiting: Weak<()>,
    answers: Answers<Pixel>,
}

impl Inspector {
    /// Notes the pixel under the pointer.
    pub fn hover(&mut self, pixel: Option<[u32; 2]>) {
        if pixel.is_some() {
            self.hovered = pixel;
        }
    }

    /// The pixel that the pointer was over last.
    pub fn hovered(&self) -> Option<[u32; 2]> {
        self.hovered
    }

    /// Forgets the pixel, because the picture has changed.
    pub fn forget(&mut self) {
        *self = Inspector { hovered: self.hovered, ..Inspector::default() };
    }

    /// The pixel as of the last answer.
    pub fn pixel(&self) -> Option<&Pixel> {
        self.pixel.as_ref()
    }

    /// Takes the film's answer and queries the film again if there may be news. If the film is gone or has no samples,
    /// the last known pixel stays.
    pub fn follow(&mut self, subject: &Subject<'_>, context: &egui::Context) {
        while let Some(pixel) = self.answers.take() {
            self.pixel = Some(pixel);
        }
        let Some(at) = self.hovered else { return };
        let wanted = Some((at, subject.film_id(), subject.shown_samples()));
        let is_waiting = self.waiting.strong_count() > 0;
        if is_waiting || self.asked == wanted || !subject.is_full() {
            return;
        }
        let question = Arc::new(());
        self.waiting = Arc::downgrade(&question);
        self.asked = wanted;
        let (transfer, answer) = (subject.document().rules().transfer, self.answers.answer(context));
        subject.inspect(move |film| {
            let [x, y] = at;
            if x < film.width() && y < film.height() && film.sample_count() > 0 {
                let index = y as usize * film.width() as usize + x as usize;
                let mean = film.mean(index);
                let bytes = mean.map(|v| to_byte(v, transfer, y as usize, film.height() as usize));
                let (error, samples) = (standard_error(film, index), film.sample_count());
                // Dropped first: it wakes a frame, which may ask the next question.
                drop(question);
                answer.give(Pixel { at, mean, error, bytes, samples });
            }
        });
    }

    /// Draws the panel. `layer` is the displayed layer and its value at the pixel; `other` is what is at that place in the
    /// picture that is compared with this one.
    pub fn ui(
        &self,
        ui: &mut Ui,
        document: &Document,
        layer: Option<(Layer, [f64; 3])>,
        other: Option<OtherPixel>,
    ) {
        ui.label(RichText::new("Pixel").strong());
        match &self.pixel {
            Some(pixel) => pixel_ui(document, pixel, layer, other, ui),
            None => {
                let text = "Move the pointer over the picture.";
                ui.label(RichText::new(text).color(ui.visuals().weak_text_color()));
            }
        }
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
    other: Option<OtherPixel>,
    ui: &mut Ui,
) {
    let [x, y] = pixel.at;
    let decimals = |v: [f64; 3]| v.map(|v| format!("{v:.5}"));
    egui::Grid::new("pixel").num_columns(4).spacing([8.0, 3.0]).show(ui, |ui| {
        let name = |ui: &mut Ui, text: &str| {
            ui.label(RichText::new(text).color(ui.visuals().weak_text_color()));
        };
        let row = |ui: &mut Ui, what: &str, values: [String; 3]| {
            name(ui, what);
            for value in values {
                ui.monospace(value);
            }
            ui.end_row();
        };
        name(ui, "at");
        ui.monospace(format!("{x}"));
        ui.monospace(format!("{y}"));
        ui.end_row();
        row(ui, "", ["red", "green", "blue"].map(str::to_owned));
        match other {
            Some(other) => {
                row(ui, "A, this", decimals(pixel.mean));
                row(ui, "B, other", decimals(other.mean));
                match other.scaled {
                    // A difference of scaled pictures would show the scaling.
                    Some([x, y]) => {
                        name(ui, "B at");
                        ui.monospace(format!("{x}"));
                        ui.monospace(format!("{y}"));
                        ui.end_row();
                    }
                    None => {
                        let difference = [0, 1, 2].map(|i| pixel.mean[i] - other.mean[i]);
                        row(ui, "A − B", difference.map(|value| format!("{value:+.4}")));
                    }
                }
            }
            None => row(ui, "linear", decimals(pixel.mean)),
        }
        match pixel.error {
            Some(error) => row(ui, "error", error.map(|v| format!("{v:.5}"))),
            None => row(ui, "error", ["–", "–", "–"].map(str::to_owned)),
        }
        row(ui, "8 bits", pixel.bytes.map(|byte| byte.to_string()));
        name(ui, "samples");
        ui.monospace(pixel.samples.to_string());
        ui.end_row();
        match layer {
            Some((Layer::Normals, n)) => row(ui, "normal", n.map(|v| format!("{:.4}", 2.0 * v - 1.0))),
            Some((Layer::Albedo, albedo)) => row(ui, "albedo", decimals(albedo)),
            Some((Layer::RaysPerPath, [rays, ..])) => {
                name(ui, "rays/path");
                ui.monospace(format!("{rays:.2}"));
                ui.end_row();
            }
            None => {}
        }
    });
    let scene = document.scene();
    if scene.spheres.len() <= PICK_LIMIT {
        let place = [
            (f64::from(x) + 0.5) / f64::from(document.settings.width),
            (f64::from(y) + 0.5) / f64::from(document.settings.height),
        ];
        let direction = document.camera.direction_through(place, document.aspect());
        let text = match scene.pick(document.camera.look_from, direction) {
            Some(pick) => {
                let (object, material) = names(scene, pick.sphere);
                format!("{object}, {material}\nat distance {}", compact(pick.distance))
            }
            None => "sky".to_owned(),
        };
        ui.add(egui::Label::new(text).wrap());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::kept::on_screen::{OnScreen, small_film};

    use crate::app::model::origin::{Origin, Source};

    use crate::job::recipe::Recipe;
    use crate::render_cpu::record_path;
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    #[test]
    fn a_difference_tells_both_sides() {
        let document = Document::new(Origin::new(Recipe::builtin("three-spheres").unwrap(), Source::Builtin));
        let pixel = Pixel { at: [0, 0], mean: [0.5, 0.25, 1.0], error: None, bytes: [0; 3], samples: 1 };
        let other = OtherPixel { mean: [0.25, 0.5, 1.0], scaled: None };
        let harness = Harness::new_ui(|ui| pixel_ui(&document, &pixel, None, Some(other), ui));
        let labels = harness.get_all_by_role(egui::accesskit::Role::Label);
        let texts: Vec<String> = labels.filter_map(|node| node.value()).collect();
        for text in ["A, this", "B, other", "A − B", "0.50000", "0.25000", "+0.2500", "-0.2500", "+0.0000"]
        {
            assert!(texts.iter().any(|found| found == text), "no {text} in {texts:?}");
        }
        assert!(!texts.iter().any(|text| text == "linear"));
    }

    /// The sphere under the pointer is the one that the tracer's camera ray hits.
    #[test]
    fn the_sphere_under_the_pointer_is_named() {
        let document = Document::new(Origin::new(Recipe::builtin("three-spheres").unwrap(), Source::Builtin));
        let [width, height] = [document.settings.width, document.settings.height];
        for at in [[width / 8, height * 7 / 8], [width / 2, height / 2], [width / 2, height / 8]] {
            let path = record_path(&document.job(1).unwrap(), at, 0, None);
            let expected = path.rays[0].hit.map_or("sky".to_owned(), |hit| {
                let (object, material) = names(document.scene(), hit.sphere);
                format!("{object}, {material}\nat distance")
            });
            let pixel = Pixel { at, mean: [0.0; 3], error: None, bytes: [0; 3], samples: 1 };
            let harness = Harness::new_ui(|ui| pixel_ui(&document, &pixel, None, None, ui));
            let labels = harness.get_all_by_role(egui::accesskit::Role::Label);
            let texts: Vec<String> = labels.filter_map(|node| node.value()).collect();
            assert!(
                texts.iter().any(|text| text.starts_with(&expected)),
                "{at:?}: no {expected} in {texts:?}"
            );
        }
    }

    #[test]
    fn each_pixel_is_asked_for_once() {
        let (screen, context) = (OnScreen::new(small_film(1, 0.0625)), egui::Context::default());
        let mut inspector = Inspector::default();
        // Whether the film is asked, and what it answers.
        let ask = |inspector: &mut Inspector, at: Option<[u32; 2]>| {
            let is_asked = screen.before_answers(|subject| {
                inspector.hover(at);
                for _ in 0..2 {
                    inspector.follow(subject, &context);
                }
                inspector.waiting.strong_count() > 0
            });
            assert_eq!(inspector.waiting.strong_count(), 0);
            let [answer, second] = [inspector.answers.take(), inspector.answers.take()];
            assert_eq!(second, None);
            (is_asked, answer)
        };
        assert_eq!(ask(&mut inspector, None), (false, None), "the pointer is elsewhere");
        let last = Pixel { at: [3, 1], mean: [0.0625; 3], error: None, bytes: [64; 3], samples: 1 };
        let dark = Pixel { at: [3, 0], mean: [0.0; 3], bytes: [0; 3], ..last.clone() };
        assert_eq!(ask(&mut inspector, Some([3, 1])), (true, Some(last.clone())));
        assert_eq!(ask(&mut inspector, Some([3, 1])), (false, None), "it is known");
        assert_eq!(ask(&mut inspector, None), (false, None));
        assert_eq!(inspector.hovered(), Some([3, 1]), "the pointer has left the picture");
        assert_eq!(ask(&mut inspector, Some([3, 0])), (true, Some(dark)));
        for outside in [[4, 0], [0, 2]] {
            assert_eq!(ask(&mut inspector, Some(outside)), (true, None));
        }
        inspector.answers.answer(&context).give(last.clone());
        inspector.follow(&screen.subject(), &context);
        assert_eq!(inspector.pixel(), Some(&last));
        inspector.hover(Some([3, 1]));
        inspector.forget();
        assert_eq!((inspector.pixel(), inspector.hovered()), (None, Some([3, 1])));
        assert_eq!(ask(&mut inspector, None), (true, Some(last)), "of another picture");
    }
}
