//! The pixel inspector: the numbers of what is under the pointer, which in a comparison are those of one side and the change
//! from one to the other.

use crate::app::commands::Snapshot;
use crate::app::model::spheres::MANY;
use crate::app::model::{Document, Mode, Model, Partner, at_other, kind_word, middle_of};
use crate::app::toolkit::number::compact;
use crate::app::toolkit::widgets::{hint, tip};
use crate::app::toolkit::{Query, theme};
use crate::app::tracing::second::OtherId;
use crate::app::tracing::subject::{PictureId, Subject};
use crate::backends::layers::Layer;
use crate::film::{Film, to_byte};
use crate::scene::Scene;
use crate::stages::Transfer;
use eframe::egui::{self, Align, Color32, Layout, Rect, RichText, Sense, TextStyle, Ui, UiBuilder, vec2};
use std::sync::mpsc::channel;

/// Height of a row and distance of the columns of numbers, sizes of the font.
const ROW: f32 = 4.0 / 3.0;
const COLUMN: f32 = 14.0 / 3.0;

/// A pixel of a film.
#[derive(Clone, Debug, PartialEq)]
pub struct Pixel {
    /// Column and row, from the upper left.
    pub at: [u32; 2],
    /// Linear radiance.
    pub mean: [f64; 3],
    /// The 8-bit values in the picture.
    pub bytes: [u8; 3],
}

impl Pixel {
    fn of(film: &Film, at: [u32; 2], transfer: Transfer) -> Option<Pixel> {
        let [x, y] = at;
        if x >= film.width() || y >= film.height() || film.sample_count() == 0 {
            return None;
        }
        let index = y as usize * film.width() as usize + x as usize;
        let mean = film.mean(index);
        let bytes = mean.map(|v| to_byte(v, transfer, y as usize, film.height() as usize));
        Some(Pixel { at, mean, bytes })
    }
}

/// What is read at a place.
#[derive(Clone, Debug, PartialEq)]
pub struct Readout {
    /// The pixel under the pointer.
    pub pixel: Pixel,
    /// It is one of the other picture.
    pub is_other: bool,
    /// The pixels of the other picture and of this one, if they are compared.
    pub compared: Option<[Pixel; 2]>,
}

/// A pixel of the picture, the film and number of samples, and the other picture.
type Key = ([u32; 2], PictureId, u64, Option<OtherId>);

/// The pixel under the pointer and what is known about it.
#[derive(Default)]
pub struct Inspector {
    pub hovered: Option<[u32; 2]>,
    /// The pixel of the other picture and that of this one.
    query: Query<Key, [Option<Pixel>; 2]>,
    /// The last ones that were found, which stay until there are others, and the place.
    known: Option<([u32; 2], [Option<Pixel>; 2])>,
}

impl Inspector {
    /// Notes the pixel under the pointer.
    pub fn hover(&mut self, pixel: Option<[u32; 2]>) {
        self.hovered = pixel.or(self.hovered);
    }

    /// What is known about the pixel.
    pub fn readout(&self, model: &Model) -> Option<Readout> {
        let (view, (at, [theirs, mine])) = (&model.view, self.known.as_ref()?);
        let is_other = view.is_other(middle_of(*at, model.document.size())[0]);
        let compared = theirs.clone().zip(mine.clone()).filter(|_| view.mode().is_some());
        let pixel = if is_other { theirs } else { mine }.clone()?;
        Some(Readout { pixel, is_other, compared: compared.map(|(theirs, mine)| [theirs, mine]) })
    }

    /// Forgets the pixel, because the picture has changed.
    pub fn forget(&mut self) {
        *self = Inspector::default();
    }

    /// Takes the films' answers and asks again if there may be news.
    pub fn follow(&mut self, subject: &Subject<'_>, context: &egui::Context) {
        if self.query.follow()
            && let Some((pixels, (at, ..))) = self.query.answer.take().zip(self.query.asked)
            && pixels.iter().any(Option::is_some)
        {
            self.known = Some((at, pixels));
        }
        let Some(at) = self.hovered else { return };
        let (document, main) = (subject.document(), &subject.tracing.main);
        let other = subject.tracing.other(subject.model);
        let key = (at, subject.id(), main.shown_samples(), other.map(|other| other.id()));
        let Some(answer) = self.query.ask(context, key) else { return };
        let (size, (give_theirs, theirs), (give_mine, mine)) = (document.size(), channel(), channel());
        if main.is_full(document) {
            let transfer = document.rules().transfer;
            subject.inspect(move |film| _ = give_mine.send(Pixel::of(film, at, transfer)));
        }
        if let Some(other) = other {
            let transfer = other.transfer();
            other.inspect(move |film| {
                let there = at_other(at, size, [film.width(), film.height()]);
                let _ = give_theirs.send(there.and_then(|there| Pixel::of(film, there, transfer)));
            });
        }
        answer.give_from("pixel", move || Ok([theirs, mine].map(|pixel| pixel.recv().ok().flatten())));
    }

    /// Draws the numbers; `other` is the document of the other picture, and `layer` the displayed layer and its value.
    pub fn ui(
        &self,
        ui: &mut Ui,
        snapshot: &Snapshot,
        other: Option<&Document>,
        layer: Option<(Layer, [f64; 3])>,
    ) {
        // The header and five rows, so that what is above stays where it is.
        ui.spacing_mut().item_spacing.y = 0.0;
        ui.set_min_height(24.0 + 5.0 * ROW * TextStyle::Small.resolve(ui.style()).size);
        let Some(readout) = self.readout(&snapshot.model) else {
            ui.horizontal(|ui| ui.label(RichText::new("Pixel").strong()));
            hint(ui, "Point at the picture to read its numbers.");
            return;
        };
        let document = if readout.is_other { other } else { Some(snapshot.document()) };
        header(ui, readout.pixel.at, document.and_then(|document| surface(document, readout.pixel.at)));
        let ([[_, theirs], [_, mine]], view) = (snapshot.model.side_names(), &snapshot.model.view);
        let of = Compared {
            names: [&theirs, &mine],
            mode: view.mode(),
            in_bytes: view.compared(snapshot.document()) == Some(Partner::Mine),
        };
        table(ui, &rows(&readout, &of, layer));
        ui.add_space(4.0);
    }
}

/// How two pictures are compared: their names, the other one first, and whether their numbers are bytes.
struct Compared<'a> {
    names: [&'a str; 2],
    mode: Option<Mode>,
    in_bytes: bool,
}

/// The display names of a sphere and its material.
fn names(scene: &Scene, sphere: usize) -> (String, String) {
    let named = &scene.materials[scene.spheres[sphere].material];
    let kind = kind_word(&named.material);
    let is_said = named.name.starts_with(kind);
    let name = if is_said { named.name.clone() } else { format!("{}, {kind}", named.name) };
    (format!("sphere {}", sphere + 1), name)
}

fn header(ui: &mut Ui, [x, y]: [u32; 2], surface: Option<(String, String)>) {
    let (what, help) = surface.unzip();
    ui.horizontal(|ui| {
        ui.label(RichText::new("Pixel").strong());
        let at = what.map_or_else(|| format!("{x}, {y}"), |what| format!("{x}, {y} · {what}"));
        let text = RichText::new(at).small().color(theme::colours(ui).weak);
        let response = ui.add(egui::Label::new(text).truncate());
        tip(ui, response, help.as_deref().unwrap_or_default(), None);
    });
}

/// A row of the table: name, help, red, green, blue, and whether it is about the picture under the pointer.
type Row<'a> = (&'a str, String, [String; 3], bool);

fn rows<'a>(
    Readout { pixel, is_other, compared }: &Readout,
    &Compared { names, mode, in_bytes }: &Compared<'a>,
    layer: Option<(Layer, [f64; 3])>,
) -> Vec<Row<'a>> {
    let light = "Linear radiance: the mean of the samples, before gamma";
    let mut rows: Vec<Row<'a>> = Vec::new();
    match compared {
        Some([theirs, mine]) => {
            let is_of_one = mode != Some(Mode::Difference);
            let what = if in_bytes { "The bytes of the picture, 0 to 255" } else { light };
            let values = |pixel: &Pixel| match in_bytes {
                true => pixel.bytes.map(|byte| byte.to_string()),
                false => pixel.mean.map(decimals),
            };
            for (name, pixel, is_it) in [(names[0], theirs, *is_other), (names[1], mine, !is_other)] {
                rows.push((name, format!("{name}. {what}"), values(pixel), is_of_one && is_it));
            }
            let change = [0, 1, 2].map(|i| match in_bytes {
                true => signed(f64::from(mine.bytes[i]) - f64::from(theirs.bytes[i]), 0),
                false => signed(mine.mean[i] - theirs.mean[i], 4),
            });
            let help = format!("How much brighter {} is than {}", names[1], names[0]);
            rows.push(("change", help, change, !is_of_one));
        }
        None => rows.push(("light", light.to_owned(), pixel.mean.map(decimals), true)),
    }
    if mode != Some(Mode::Difference) && !in_bytes && (compared.is_some() || !is_other) {
        let mine = compared.as_ref().map_or(pixel, |[_, mine]| mine);
        let help = "The byte that a file of the traced picture gets, 0 to 255".to_owned();
        rows.push(("saved as", help, mine.bytes.map(|byte| byte.to_string()), !is_other));
    }
    rows.extend(layer.map(|(layer, value)| match layer {
        Layer::Normals => {
            let help = "Which way the surface faces: x, y, z".to_owned();
            ("normal", help, value.map(|n| signed(2.0 * n - 1.0, 4)), true)
        }
        Layer::Albedo => ("albedo", "What the surface reflects".to_owned(), value.map(decimals), true),
        Layer::RaysPerPath => {
            let values = [String::new(), String::new(), format!("{:.2}", value[0])];
            ("rays per path", "How many rays a path through this pixel has".to_owned(), values, true)
        }
    }));
    rows
}

fn table(ui: &mut Ui, rows: &[Row<'_>]) {
    let colours = theme::colours(ui);
    let rgb = [("R", colours.bad), ("G", colours.good), ("B", colours.accent)];
    cells(ui, "", "Red, green, blue", rgb.map(|(name, color)| (name.to_owned(), color)));
    for (name, help, values, is_meant) in rows {
        let color = if *is_meant { colours.strong } else { colours.weak };
        cells(ui, name, help, values.clone().map(|value| (value, color)));
    }
}

/// The name of the surface at a pixel, and how far away it is.
fn surface(document: &Document, at: [u32; 2]) -> Option<(String, String)> {
    let scene = document.scene();
    if scene.spheres.len() > MANY || document.no_rays().is_some() {
        return None;
    }
    let Some(pick) = document.pick(&document.camera, middle_of(at, document.size())) else {
        return Some(("sky".to_owned(), String::new()));
    };
    let (sphere, material) = names(scene, pick.sphere);
    Some((material, format!("{sphere}, at distance {}", compact(pick.distance))))
}

fn decimals(value: f64) -> String {
    format!("{value:.4}")
}

fn signed(value: f64, places: usize) -> String {
    // Not −0.0000.
    let value = (value * 1e4).round() / 1e4 + 0.0;
    format!("{value:+.places$}").replace('-', "−")
}

/// A row of the table.
fn cells(ui: &mut Ui, name: &str, help: &str, values: [(String, Color32); 3]) {
    let em = TextStyle::Small.resolve(ui.style()).size;
    let (row, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW * em), Sense::hover());
    tip(ui, response, help, None);
    let weak = theme::colours(ui).weak;
    let mut cell = |rect: Rect, layout: Layout, text: &str, color: Color32, is_cut: bool| {
        let mut ui = ui.new_child(UiBuilder::new().max_rect(rect).layout(layout));
        let label = egui::Label::new(RichText::new(text).small().color(color));
        ui.add(if is_cut { label.truncate() } else { label.extend() });
    };
    let left = row.with_max_x(row.right() - (3.0 * COLUMN - 1.0) * em);
    cell(left, Layout::left_to_right(Align::Center), name, weak, true);
    for (place, (value, color)) in values.into_iter().enumerate() {
        let right = row.right() - COLUMN * em * (2 - place) as f32;
        cell(row.with_max_x(right), Layout::right_to_left(Align::Center), &value, color, false);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::{Origin, Source};
    use crate::job::recipe::Recipe;
    use crate::render_cpu::{Isa, PathRecorder};

    #[test]
    fn a_comparison_names_both_sides_and_tells_the_change() {
        let pixel = |mean, bytes| Pixel { at: [0, 0], mean, bytes };
        let compared = [pixel([0.25, 0.5, 1.0], [1; 3]), pixel([0.5, 0.25, 1.0], [2; 3])];
        let readout = |is_other: bool| Readout {
            pixel: compared[usize::from(!is_other)].clone(),
            is_other,
            compared: Some(compared.clone()),
        };
        for is_other in [true, false] {
            let mode = Some(Mode::Wipe);
            let of = Compared { names: ["11.2", "11.4"], mode, in_bytes: false };
            let found = rows(&readout(is_other), &of, None);
            let names: Vec<&str> = found.iter().map(|row| row.0).collect();
            assert_eq!(names, ["11.2", "11.4", "change", "saved as"]);
            assert_eq!(found[2].2, ["+0.2500", "−0.2500", "+0.0000"]);
            assert_eq!(found[3].2, ["2"; 3], "what Save saves");
            assert_eq!([found[0].3, found[1].3], [is_other, !is_other], "the one under the pointer");
            let of = Compared { in_bytes: true, ..of };
            let found = rows(&readout(is_other), &of, None);
            assert_eq!(found.iter().map(|row| row.2[0].as_str()).collect::<Vec<_>>(), ["1", "2", "+1"]);
        }
    }

    /// The sphere under the pointer is the one that the tracer's camera ray hits.
    #[test]
    fn the_sphere_under_the_pointer_is_named() {
        let document = Document::new(Origin::new(Recipe::builtin("three-spheres").unwrap(), Source::Builtin));
        let [width, height] = [document.settings.width, document.settings.height];
        let recorder = PathRecorder::new(&document.job(1).unwrap(), Isa::Portable, None);
        for at in [[width / 8, height * 7 / 8], [width / 2, height / 2], [width / 2, height / 8]] {
            let path = recorder.record(at, 0);
            let expected =
                path.rays[0].hit.map_or("sky".to_owned(), |hit| names(document.scene(), hit.sphere).1);
            assert_eq!(surface(&document, at).unwrap().0, expected, "{at:?}");
        }
    }
}
