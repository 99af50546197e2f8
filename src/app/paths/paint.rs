//! Paths drawn as lines over the picture, and the directions that the next ray was chosen from.

use super::{Path, Paths};
use crate::app::model::document::Document;
use crate::app::theme;
use crate::backends::explain::{Event, Lobe, Step};
use crate::scene::Camera;
use eframe::egui::{
    Align2, Color32, FontId, Painter, Pos2, Rect, Shape, Stroke, StrokeKind, TextStyle, Ui, vec2,
};
use glam::DVec3;

/// The length at which a ray to the sky is drawn, in scene units.
const SKY_LENGTH: f64 = 2.0;

/// Parts closer to the camera than this share of the view distance are not drawn.
const NEAR_SHARE: f64 = 1e-4;

/// The length of a unit vector that is drawn at a hit, as a share of the distance to the camera.
const UNIT_SHARE: f64 = 0.1;

/// The normal at a hit.
const NORMAL: Color32 = Color32::from_rgb(90, 200, 250);

/// The directions that the next ray was chosen from.
const LOBE: Color32 = Color32::from_rgb(255, 214, 10);

/// So many of the other paths are drawn, faintly.
const FAINT: usize = 16;

/// The number of points of a circle.
const CIRCLE: usize = 48;

impl Paths {
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
        for (index, path) in listed.paths.iter().enumerate().take(FAINT) {
            if index != self.selected {
                let (shade, line) = (Color32::from_black_alpha(50), accent.gamma_multiply(0.5));
                view.paint_lines(path, painter, [Stroke::new(2.0, shade), Stroke::new(1.0, line)]);
            }
        }
        if let Some(path) = self.path() {
            let shade = Color32::from_black_alpha(150);
            view.paint_lines(path, painter, [Stroke::new(4.5, shade), Stroke::new(2.0, accent)]);
            if let Some(line) = path.get(self.point).and_then(|(ray, _)| view.line(ray.origin, end_of(ray))) {
                painter.line_segment(line, Stroke::new(3.0, Color32::WHITE));
            }
            if let Some((ray, _)) = self.point.checked_sub(1).and_then(|before| path.get(before)) {
                view.paint_choice(ray, painter);
            }
            view.paint_numbers(path, self.point, painter, accent, TextStyle::Small.resolve(ui.style()));
        }
    }
}

/// The end of a ray, or the point up to which it is drawn.
fn end_of(step: &Step) -> DVec3 {
    step.hit.map_or(step.origin + step.direction * SKY_LENGTH, |hit| hit.point)
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

    fn paint_lines(&self, path: &Path, painter: &Painter, strokes: [Stroke; 2]) {
        let first = usize::from(self.is_from_eye);
        for stroke in strokes {
            for (step, _) in path.iter().skip(first) {
                if let Some(line) = self.line(step.origin, end_of(step)) {
                    painter.line_segment(line, stroke);
                }
            }
        }
    }

    /// The normal where a ray ends, and what the next direction was chosen from.
    fn paint_choice(&self, step: &Step, painter: &Painter) {
        let Some(hit) = step.hit else { return };
        let unit = UNIT_SHARE * hit.point.distance(self.camera.look_from);
        self.paint_arrow(hit.point, hit.normal * unit, NORMAL, painter);
        let (Event::Scattered(lobe) | Event::Absorbed(lobe)) = step.event else { return };
        match lobe {
            // The heads of the random vectors lie on a sphere.
            Lobe::Hemisphere => self.paint_ball(hit.point, unit, painter),
            Lobe::Lambertian => self.paint_ball(hit.point + hit.normal * unit, unit, painter),
            Lobe::Metal { mirrored, fuzz } => {
                self.paint_arrow(hit.point, mirrored * unit, LOBE, painter);
                self.paint_ball(hit.point + mirrored * unit, fuzz * unit, painter);
            }
            Lobe::Glass { mirrored, refracted, .. } => {
                for direction in std::iter::once(mirrored).chain(refracted) {
                    self.paint_arrow(hit.point, direction * unit, LOBE, painter);
                }
            }
        }
    }

    fn paint_arrow(&self, from: DVec3, by: DVec3, colour: Color32, painter: &Painter) {
        if let Some([start, end]) = self.line(from, from + by) {
            for stroke in [Stroke::new(4.0, Color32::from_black_alpha(150)), Stroke::new(2.0, colour)] {
                painter.arrow(start, end - start, stroke);
            }
        }
    }

    /// The outline of a ball.
    fn paint_ball(&self, center: DVec3, radius: f64, painter: &Painter) {
        let away = (center - self.camera.look_from).normalize_or_zero();
        let (u, v) = away.any_orthonormal_pair();
        let at = |index: usize| {
            let (sine, cosine) = (std::f64::consts::TAU * index as f64 / CIRCLE as f64).sin_cos();
            self.place(center + (u * cosine + v * sine) * radius)
        };
        if let Some(points) = (0..CIRCLE).map(at).collect::<Option<Vec<_>>>() {
            for stroke in [Stroke::new(3.0, Color32::from_black_alpha(120)), Stroke::new(1.5, LOBE)] {
                painter.add(Shape::closed_line(points.clone(), stroke));
            }
        }
    }

    fn paint_numbers(&self, path: &Path, point: usize, painter: &Painter, colour: Color32, font: FontId) {
        for (index, (step, _)) in path.iter().enumerate() {
            let Some(at) = self.place(end_of(step)) else { continue };
            let (radius, fill) = if index + 1 == point { (6.0, Color32::WHITE) } else { (4.0, colour) };
            painter.circle(at, radius, fill, Stroke::new(1.0, Color32::BLACK));
            let (number, corner) = ((index + 2).to_string(), at + vec2(7.0, -6.0));
            let place = painter.layout_no_wrap(number.clone(), font.clone(), Color32::WHITE).size();
            let behind = Rect::from_min_size(corner - vec2(0.0, place.y), place).expand2(vec2(3.0, 1.0));
            painter.rect_filled(behind, 3.0, Color32::from_black_alpha(235));
            painter.rect_stroke(behind, 3.0, Stroke::new(1.0, Color32::WHITE), StrokeKind::Outside);
            painter.text(corner, Align2::LEFT_BOTTOM, number, font.clone(), Color32::WHITE);
        }
    }
}
