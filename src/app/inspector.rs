//! The pixel under the pointer: its value, its error, what is seen there, and the path through it.

use super::document::Document;
use super::files::Message;
use super::tracer::Tracer;
use super::widgets::compact;
use crate::film::to_byte;
use crate::progressive::standard_error;
use crate::scene::Scene;
use eframe::egui::{self, RichText, Ui};
use glam::DVec3;
use std::sync::mpsc::Sender;

/// With more spheres, looking for the one under the pointer would hold the window up.
const PICK_LIMIT: usize = 50_000;

/// A pixel as the film has it.
#[derive(Clone, Debug, PartialEq)]
pub struct Pixel {
    /// Column and row, from the upper left.
    pub at: [u32; 2],
    /// Linear radiance.
    pub mean: [f64; 3],
    /// Its standard error.
    pub error: Option<[f64; 3]>,
    /// As the picture has it.
    pub bytes: [u8; 3],
    /// Samples.
    pub samples: u64,
}

/// One bounce of a path.
#[derive(Clone, Debug, PartialEq)]
struct Vertex {
    object: String,
    material: String,
    position: DVec3,
    normal: Option<DVec3>,
    attenuation: Option<DVec3>,
    throughput: DVec3,
}

/// A path, as a list.
#[derive(Clone, Debug, PartialEq)]
struct Path {
    pixel: [u32; 2],
    start: DVec3,
    vertices: Vec<Vertex>,
}

/// What is known of the pixel under the pointer.
#[derive(Default)]
pub struct Inspector {
    hovered: Option<[u32; 2]>,
    pixel: Option<Pixel>,
    /// What the last answer was for: pixel and samples.
    asked: Option<([u32; 2], u64)>,
    is_waiting: bool,
    path: Option<Path>,
}

impl Inspector {
    /// The pointer is over this pixel.
    pub fn hover(&mut self, pixel: Option<[u32; 2]>) {
        if pixel.is_some() {
            self.hovered = pixel;
        }
    }

    /// Another picture: nothing is known of it.
    pub fn forget(&mut self) {
        *self = Inspector { hovered: self.hovered, ..Inspector::default() };
    }

    /// The film has answered.
    pub fn learn(&mut self, pixel: Option<Pixel>) {
        self.is_waiting = false;
        self.pixel = pixel;
    }

    /// Asks the film, if there is something to learn.
    pub fn follow(
        &mut self,
        document: &Document,
        main: &Tracer,
        sender: &Sender<Message>,
        context: &egui::Context,
    ) {
        let Some(at) = self.hovered else { return };
        let samples = main.shown().map_or(0, |shown| shown.samples);
        if self.is_waiting || self.asked == Some((at, samples)) || !main.is_full(document) {
            return;
        }
        self.is_waiting = true;
        self.asked = Some((at, samples));
        let transfer = document.rules().transfer;
        let answer = Answer { sender: sender.clone(), context: context.clone(), pixel: None };
        main.inspect(move |film| {
            let mut answer = answer;
            let [x, y] = at;
            if x < film.width() && y < film.height() {
                let index = y as usize * film.width() as usize + x as usize;
                let mean = film.mean(index);
                let bytes = mean.map(|v| to_byte(v, transfer, y as usize, film.height() as usize));
                let (error, samples) = (standard_error(film, index), film.sample_count());
                answer.pixel = Some(Pixel { at, mean, error, bytes, samples });
            }
        });
    }

    /// Lists the path through the middle of a pixel.
    pub fn list_path(&mut self, document: &Document, pixel: [u32; 2]) {
        let settings = &document.settings;
        let place = [
            (f64::from(pixel[0]) + 0.5) / f64::from(settings.width),
            (f64::from(pixel[1]) + 0.5) / f64::from(settings.height),
        ];
        let direction = document.camera.direction_through(place, document.aspect());
        let start = document.camera.look_from;
        let scene = document.scene();
        let vertices = scene.pick(start, direction).map(|pick| {
            let (object, material) = names(scene, pick.sphere);
            Vertex {
                object,
                material,
                position: pick.point,
                normal: Some(pick.normal),
                attenuation: scene.material_of(&scene.spheres[pick.sphere]).albedo(),
                throughput: DVec3::ONE,
            }
        });
        self.path = Some(Path { pixel, start, vertices: vertices.into_iter().collect() });
    }

    /// The points of the listed path.
    pub fn path_points(&self) -> impl Iterator<Item = DVec3> + '_ {
        self.path.iter().flat_map(|path| path.vertices.iter().map(|vertex| vertex.position))
    }
}

/// Sends what was found, or, if the film is gone before, that nothing was.
struct Answer {
    sender: Sender<Message>,
    context: egui::Context,
    pixel: Option<Pixel>,
}

impl Drop for Answer {
    fn drop(&mut self) {
        // A window that has been closed wants no answer.
        let _ = self.sender.send(Message::Pixel(self.pixel.take()));
        self.context.request_repaint();
    }
}

fn names(scene: &Scene, sphere: usize) -> (String, String) {
    let named = &scene.materials[scene.spheres[sphere].material];
    (format!("sphere {sphere}"), format!("{} ({})", named.name, named.material.kind()))
}

pub fn ui(window: &mut super::Window, ui: &mut Ui) {
    let heading = RichText::new("Pixel").strong();
    ui.label(heading);
    let document = &window.document;
    let Some(pixel) = &window.inspector.pixel else {
        ui.label(RichText::new("Move the pointer over the picture.").color(ui.visuals().weak_text_color()));
        return;
    };
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
        row(ui, "linear", decimals(pixel.mean));
        match pixel.error {
            Some(error) => row(ui, "error", error.map(|v| format!("{v:.5}"))),
            None => row(ui, "error", ["–", "–", "–"].map(str::to_owned)),
        }
        row(ui, "8 bits", pixel.bytes.map(|byte| byte.to_string()));
        name(ui, "samples");
        ui.monospace(pixel.samples.to_string());
        ui.end_row();
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
    path_ui(window, ui);
}

fn path_ui(window: &mut super::Window, ui: &mut Ui) {
    let weak = ui.visuals().weak_text_color();
    let Some(path) = &window.inspector.path else {
        ui.label(RichText::new("Alt-click shows what a ray meets.").color(weak).small());
        return;
    };
    ui.add_space(6.0);
    ui.label(RichText::new(format!("Ray through {}, {}", path.pixel[0], path.pixel[1])).strong());
    let point = |v: DVec3| format!("{} {} {}", compact(v.x), compact(v.y), compact(v.z));
    if path.vertices.is_empty() {
        ui.label("meets the sky");
    }
    for (index, vertex) in path.vertices.iter().enumerate() {
        ui.label(format!("{}  {}, {}", index + 1, vertex.object, vertex.material));
        let mut lines = vec![("position", vertex.position)];
        lines.extend(vertex.normal.map(|normal| ("normal", normal)));
        lines.extend(vertex.attenuation.map(|attenuation| ("attenuation", attenuation)));
        lines.push(("throughput", vertex.throughput));
        for (name, value) in lines {
            ui.label(RichText::new(format!("     {name}  {}", point(value))).small().color(weak));
        }
    }
    let from = format!("from {}", point(path.start));
    ui.label(RichText::new(from).small().color(weak));
    if ui.small_button("Clear").on_hover_text("Take the ray off the picture").clicked() {
        window.inspector.path = None;
    }
}
