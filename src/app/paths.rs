//! The paths of one pixel, listed ray by ray and drawn as lines over the picture.

use super::answers::Answers;
use super::inspector::names;
use super::model::document::Document;
use super::theme;
use super::widgets::compact;
use crate::render_cpu::{Isa, PathRecord, PathRecorder, RecordedRay};
use crate::scene::{Camera, Scene};
use eframe::egui::{
    self, Align2, Color32, DragValue, Painter, Pos2, Rect, RichText, Stroke, TextStyle, Ui, vec2,
};
use glam::DVec3;

/// The largest number of paths in the list.
const COUNT_LIMIT: u64 = 64;

/// The length at which a ray to the sky is drawn, in scene units.
const SKY_LENGTH: f64 = 2.0;

/// Parts closer to the camera than this share of the view distance are not drawn.
const NEAR_SHARE: f64 = 1e-4;

/// Paths of a pixel, recorded by a background thread.
pub struct Listed {
    number: u64,
    pixel: [u32; 2],
    /// The document when they were recorded.
    document: Document,
    /// The paths of samples 0, 1, 2 and so on.
    records: Vec<PathRecord>,
}

/// The list of paths.
pub struct Paths {
    count: u64,
    /// The number of the newest query.
    number: u64,
    is_waiting: bool,
    listed: Option<Listed>,
    /// The sample whose path is highlighted.
    selected: Option<usize>,
    /// The list is new and the panel should scroll to it.
    is_new: bool,
    answers: Answers<Listed>,
}

impl Default for Paths {
    fn default() -> Self {
        Paths {
            count: 16,
            number: 0,
            is_waiting: false,
            listed: None,
            selected: None,
            is_new: false,
            answers: Answers::default(),
        }
    }
}

impl Paths {
    /// Lists the paths of a pixel. A background thread records them.
    pub fn list(&mut self, document: &Document, pixel: [u32; 2], context: &egui::Context) {
        // An invalid document is reported elsewhere.
        let Ok(job) = document.job(1) else { return };
        self.number += 1;
        let (number, count, document) = (self.number, self.count, document.clone());
        let record = move || {
            let isa = Isa::available().into_iter().max().unwrap_or(Isa::Portable);
            let recorder = PathRecorder::new(&job, isa, None);
            let records = (0..count).map(|sample| recorder.record(pixel, sample)).collect();
            Listed { number, pixel, document, records }
        };
        self.is_waiting = self.answers.ask("paths", context, record).is_ok();
    }

    /// Takes recorded paths.
    fn learn(&mut self, listed: Listed) {
        if listed.number == self.number {
            self.is_waiting = false;
            self.is_new = self.listed.as_ref().is_none_or(|old| old.pixel != listed.pixel);
            let last = listed.records.len().saturating_sub(1);
            self.selected = if self.is_new { Some(0) } else { self.selected.map(|index| index.min(last)) };
            self.listed = Some(listed);
        }
    }

    /// Removes the paths from the picture.
    pub fn forget(&mut self) {
        self.number += 1;
        (self.listed, self.is_waiting) = (None, false);
    }

    /// Takes recorded paths. Lists them again if a change affects the random numbers; if only the camera moves, the
    /// existing paths stay.
    pub fn follow(&mut self, document: &Document, context: &egui::Context) {
        while let Some(listed) = self.answers.take() {
            self.learn(listed);
        }
        let Some(listed) = &self.listed else { return };
        if self.is_waiting || listed.document.settings == document.settings {
            return;
        }
        let [x, y] = listed.pixel;
        if x < document.settings.width && y < document.settings.height {
            let before = Document { camera: listed.document.camera, ..document.clone() };
            self.list(&before, [x, y], context);
        } else {
            self.forget();
        }
    }

    /// The number of listed paths.
    pub fn len(&self) -> usize {
        self.listed.as_ref().map_or(0, |listed| listed.records.len())
    }

    /// Draws the list.
    pub fn ui(&mut self, ui: &mut Ui, document: &Document) {
        let weak = ui.visuals().weak_text_color();
        let Some(listed) = &self.listed else {
            let text = if self.is_waiting {
                "Recording paths…"
            } else {
                "Alt-click or right-click lists the paths of a pixel."
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
        let last = listed.records.len().saturating_sub(1);
        let mut selected = self.selected;
        let mut count = self.count;
        let mut is_cleared = false;
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 4.0;
            let drag = DragValue::new(&mut count).range(1..=COUNT_LIMIT).speed(0.2).suffix(" paths");
            let help = format!("How many of the pixel's samples are listed, 1 to {COUNT_LIMIT}");
            ui.add(drag).on_hover_text(help).accessible_name("Paths listed");
            let step = |ui: &mut Ui, label: &str, name: &str, to: Option<usize>| {
                let button = egui::Button::new(label).small();
                let response = ui.add_enabled(to.is_some(), button).on_hover_text(name);
                response.on_disabled_hover_text("There is no such path").accessible_name(name).clicked()
            };
            let at = selected.unwrap_or(0);
            let [before, after] = [at.checked_sub(1), Some(at + 1).filter(|next| *next <= last)];
            if step(ui, "‹", "Path of the sample before", before) {
                selected = before;
            }
            if step(ui, "›", "Path of the sample after", after) {
                selected = after;
            }
            let clear = ui.small_button("Clear").on_hover_text("Remove the paths from the picture");
            is_cleared = clear.accessible_name("Clear paths").clicked();
        });
        if listed.document.camera != document.camera {
            let text = "Listed with an earlier camera; Alt-click lists them again.";
            ui.add(egui::Label::new(RichText::new(text).small().color(weak)).wrap());
        }
        for (index, record) in listed.records.iter().enumerate() {
            let rays = if record.rays.len() == 1 { "ray" } else { "rays" };
            let text = format!("sample {index:>2}  {:>2} {rays}", record.rays.len());
            let header = egui::CollapsingHeader::new(RichText::new(text).monospace())
                .id_salt(("path", index))
                .open(Some(selected == Some(index)))
                .show(ui, |ui| list_rays(ui, record, document.scene()))
                .header_response
                .on_hover_text("One path of this pixel; the open one is drawn most clearly");
            if header.accessible_name(format!("Path of sample {index}")).clicked() {
                selected = (selected != Some(index)).then_some(index);
            }
        }
        self.selected = selected;
        if is_cleared {
            self.forget();
        } else if count != self.count {
            self.count = count;
            let before = Document { camera: listed.document.camera, ..document.clone() };
            self.list(&before, pixel, ui.ctx());
        }
    }

    /// Draws all paths; the selected one is drawn last and most clearly.
    pub fn paint(&self, document: &Document, ui: &Ui, painter: &Painter, rect: Rect) {
        let Some(listed) = &self.listed else { return };
        let painter = &painter.with_clip_rect(rect.intersect(painter.clip_rect()));
        let accent = theme::accent(ui);
        let view = View {
            camera: &document.camera,
            aspect: document.aspect(),
            rect,
            is_from_eye: listed.document.camera == document.camera,
        };
        for (index, record) in listed.records.iter().enumerate() {
            if Some(index) != self.selected {
                let (shade, line) = (Color32::from_black_alpha(50), accent.gamma_multiply(0.5));
                view.paint_lines(record, painter, [Stroke::new(2.0, shade), Stroke::new(1.0, line)]);
            }
        }
        if let Some(record) = self.selected.and_then(|index| listed.records.get(index)) {
            let shade = Color32::from_black_alpha(150);
            view.paint_lines(record, painter, [Stroke::new(4.5, shade), Stroke::new(2.0, accent)]);
            view.paint_numbers(record, painter, accent, TextStyle::Small.resolve(ui.style()));
        }
    }
}

/// The end of a ray, or the point up to which it is drawn.
fn end_of(ray: &RecordedRay) -> DVec3 {
    let length = ray.hit.map_or(SKY_LENGTH, |hit| hit.distance);
    DVec3::from(ray.origin) + DVec3::from(ray.direction) * length
}

/// The projection of paths onto the picture.
struct View<'a> {
    camera: &'a Camera,
    aspect: f64,
    rect: Rect,
    /// The paths start at this camera, so their first rays project to points.
    is_from_eye: bool,
}

impl View<'_> {
    fn place(&self, point: DVec3) -> Option<Pos2> {
        let [x, y] = self.camera.place_of(point, self.aspect)?;
        Some(self.rect.min + vec2(x as f32, y as f32) * self.rect.size())
    }

    /// The part of a line in front of the camera.
    fn line(&self, mut a: DVec3, mut b: DVec3) -> Option<[Pos2; 2]> {
        let near = NEAR_SHARE * self.camera.look_from.distance(self.camera.look_at);
        let [depth_a, depth_b] = [a, b].map(|point| self.camera.depth_of(point));
        let cut = a + (b - a) * ((near - depth_a) / (depth_b - depth_a));
        match (depth_a < near, depth_b < near) {
            (true, true) => return None,
            (true, false) => a = cut,
            (false, true) => b = cut,
            (false, false) => {}
        }
        Some([self.place(a)?, self.place(b)?])
    }

    fn paint_lines(&self, record: &PathRecord, painter: &Painter, strokes: [Stroke; 2]) {
        let first = usize::from(self.is_from_eye);
        for stroke in strokes {
            for ray in record.rays.iter().skip(first) {
                if let Some(line) = self.line(DVec3::from(ray.origin), end_of(ray)) {
                    painter.line_segment(line, stroke);
                }
            }
        }
    }

    fn paint_numbers(&self, record: &PathRecord, painter: &Painter, colour: Color32, font: egui::FontId) {
        for (index, ray) in record.rays.iter().enumerate() {
            let Some(at) = self.place(end_of(ray)) else { continue };
            painter.circle(at, 4.0, colour, Stroke::new(1.0, Color32::BLACK));
            let (number, corner) = ((index + 1).to_string(), at + vec2(6.0, -5.0));
            let shade = Color32::from_black_alpha(200);
            painter.text(corner + vec2(1.0, 1.0), Align2::LEFT_BOTTOM, &number, font.clone(), shade);
            painter.text(corner, Align2::LEFT_BOTTOM, number, font.clone(), Color32::WHITE);
        }
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
            None => "escapes to the sky".to_owned(),
        };
        ui.add(egui::Label::new(format!("{}  {what}", index + 1)).wrap());
        let mut lines = vec![("throughput", triple(ray.throughput))];
        if let Some(hit) = ray.hit {
            let point = end_of(ray);
            let sphere = &scene.spheres[hit.sphere];
            let normal = (point - sphere.center) / sphere.radius;
            lines.push(("position", triple(point.to_array())));
            lines.push(("normal", triple(normal.to_array())));
            lines.push(("distance", compact(hit.distance)));
        }
        // The ratio of the next ray's throughput to this one's is the surface's attenuation.
        if let Some(next) = record.rays.get(index + 1) {
            let share = |i: usize| {
                if ray.throughput[i] == 0.0 { 0.0 } else { next.throughput[i] / ray.throughput[i] }
            };
            lines.push(("attenuation", triple([share(0), share(1), share(2)])));
        }
        egui::Grid::new(("ray", index)).num_columns(2).min_row_height(0.0).spacing([8.0, 1.0]).show(
            ui,
            |ui| {
                for (name, value) in lines {
                    ui.label(RichText::new(name).small().color(weak));
                    ui.label(RichText::new(value).small());
                    ui.end_row();
                }
            },
        );
    }
    ui.label(RichText::new(format!("adds {}", triple(record.radiance))).small().color(weak));
}
