//! The pixel under the pointer: its value, its error, what is seen there, and the path through it.

use super::document::Document;
use super::files::Message;
use super::tracer::Tracer;
use super::widgets::compact;
use crate::film::to_byte;
use crate::progressive::standard_error;
use crate::render_cpu::{Isa, PathRecord, record_path};
use crate::scene::Scene;
use eframe::egui::{self, RichText, Ui};
use glam::DVec3;
use std::sync::mpsc::Sender;

/// With more spheres, looking for the one under the pointer would hold the window up.
const PICK_LIMIT: usize = 50_000;

/// How far a ray to the sky is drawn, scene units.
const SKY_LENGTH: f64 = 2.0;

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

/// A recorded path of a pixel.
#[derive(Clone, Debug, PartialEq)]
struct Path {
    pixel: [u32; 2],
    /// Which of the pixel's samples it is.
    sample: u64,
    record: PathRecord,
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
    /// The path has just been listed and is to be scrolled to.
    is_path_new: bool,
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

    /// Lists a path of a pixel, ray by ray, as the CPU traces it.
    pub fn list_path(&mut self, document: &Document, pixel: [u32; 2], sample: u64) {
        // A document that cannot be rendered says so elsewhere.
        let Ok(job) = document.job(1) else { return };
        let isa = Isa::available().into_iter().max();
        let record = record_path(&job, pixel, sample, isa);
        self.path = Some(Path { pixel, sample, record });
        self.is_path_new = true;
    }

    /// The points of the listed path after the eye.
    pub fn path_points(&self) -> impl Iterator<Item = DVec3> + '_ {
        let rays = self.path.iter().flat_map(|path| path.record.rays.iter());
        rays.map(|ray| {
            let length = ray.hit.map_or(SKY_LENGTH, |hit| hit.distance);
            DVec3::from(ray.origin) + DVec3::from(ray.direction) * length
        })
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
    ui.label(RichText::new("Pixel").strong());
    match &window.inspector.pixel {
        Some(pixel) => pixel_ui(&window.document, pixel, ui),
        None => {
            let text = "Move the pointer over the picture.";
            ui.label(RichText::new(text).color(ui.visuals().weak_text_color()));
        }
    }
    path_ui(window, ui);
}

fn pixel_ui(document: &Document, pixel: &Pixel, ui: &mut Ui) {
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
}

fn path_ui(window: &mut super::Window, ui: &mut Ui) {
    let weak = ui.visuals().weak_text_color();
    let Some(path) = &window.inspector.path else {
        ui.label(RichText::new("Alt-click lists a path, bounce by bounce.").color(weak).small());
        return;
    };
    let (pixel, sample) = (path.pixel, path.sample);
    ui.add_space(6.0);
    let heading = ui.label(RichText::new(format!("Path of pixel {}, {}", pixel[0], pixel[1])).strong());
    if window.inspector.is_path_new {
        heading.scroll_to_me(Some(egui::Align::Min));
    }
    let mut wanted = Some(sample);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        let earlier = egui::Button::new("‹").small();
        let earlier = ui.add_enabled(sample > 0, earlier).on_hover_text("The sample before");
        if earlier
            .on_disabled_hover_text("This is the first")
            .accessible_name("Path of the sample before")
            .clicked()
        {
            wanted = Some(sample - 1);
        }
        let later = ui.add(egui::Button::new("›").small()).on_hover_text("The sample after");
        if later.accessible_name("Path of the sample after").clicked() {
            wanted = Some(sample + 1);
        }
        ui.label(format!("sample {sample}"));
        let clear = ui.small_button("Clear").on_hover_text("Take the path off the picture");
        if clear.accessible_name("Clear path").clicked() {
            wanted = None;
        }
    });
    list_rays(ui, &path.record, window.document.scene());
    window.inspector.is_path_new = false;
    match wanted {
        None => window.inspector.path = None,
        Some(wanted) if wanted != sample => {
            let document = window.document.clone();
            window.inspector.list_path(&document, pixel, wanted);
        }
        Some(_) => {}
    }
}

fn list_rays(ui: &mut Ui, record: &PathRecord, scene: &Scene) {
    let weak = ui.visuals().weak_text_color();
    let triple = |v: [f64; 3]| format!("{} {} {}", compact(v[0]), compact(v[1]), compact(v[2]));
    for (index, ray) in record.rays.iter().enumerate() {
        let what = match ray.hit {
            Some(hit) => {
                let (object, material) = names(scene, hit.sphere);
                format!("{object}, {material}")
            }
            None => "leaves to the sky".to_owned(),
        };
        ui.add(egui::Label::new(format!("{}  {what}", index + 1)).wrap());
        let mut lines = vec![("throughput", triple(ray.throughput))];
        if let Some(hit) = ray.hit {
            let point = DVec3::from(ray.origin) + DVec3::from(ray.direction) * hit.distance;
            let sphere = &scene.spheres[hit.sphere];
            let normal = (point - sphere.center) / sphere.radius;
            lines.push(("position", triple(point.to_array())));
            lines.push(("normal", triple(normal.to_array())));
            lines.push(("distance", compact(hit.distance)));
        }
        // What the surface took is the next ray's share of this one's.
        if let Some(next) = record.rays.get(index + 1) {
            let share = |i: usize| {
                if ray.throughput[i] == 0.0 { 0.0 } else { next.throughput[i] / ray.throughput[i] }
            };
            lines.push(("attenuation", triple([share(0), share(1), share(2)])));
        }
        for (name, value) in lines {
            ui.label(RichText::new(format!("     {name}  {value}")).small().color(weak));
        }
    }
    ui.label(RichText::new(format!("adds {}", triple(record.radiance))).small().color(weak));
}
