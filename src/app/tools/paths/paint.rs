//! Paths drawn as lines over the picture.

use super::{Path, Paths};
use crate::app::model::Document;
use crate::app::toolkit::theme;
use crate::backends::explain::Step;
use crate::scene::Camera;
use eframe::egui::{Color32, Painter, Pos2, Rect, Stroke, TextStyle, Ui, vec2};
use glam::DVec3;

/// The length at which a ray to the sky is drawn, in scene units.
const SKY_LENGTH: f64 = 2.0;

/// Parts closer to the camera than this share of the view distance are not drawn.
const NEAR_SHARE: f64 = 1e-4;

/// Maximum number of other paths, which are drawn faintly.
const FAINT: usize = 16;

impl Paths {
    /// Draws the paths; the shown one is drawn last and most clearly.
    pub fn paint(&self, document: &Document, ui: &Ui, painter: &Painter, rect: Rect) {
        let (Some(listed), Some(shown)) = (&self.query.answer, self.path()) else { return };
        let painter = &painter.with_clip_rect(rect.intersect(painter.clip_rect()));
        let accent = theme::colours(ui).accent;
        let view = View { camera: &document.camera, aspect: document.aspect(), rect };
        // From the eye, first rays are points.
        let first = usize::from(listed.document.camera == document.camera);
        let lines = |path: &Path, [shade, width]: [f32; 2], line: Stroke| {
            let shade = Stroke::new(width, Color32::from_black_alpha(shade as u8));
            for stroke in [shade, line] {
                path.iter().skip(first).for_each(|(ray, _)| view.paint_ray(ray, stroke, painter));
            }
        };
        for (_, path) in listed.paths.iter().enumerate().take(FAINT).filter(|(at, _)| *at != self.selected) {
            lines(path, [50.0, 2.0], Stroke::new(1.0, accent.gamma_multiply(0.5)));
        }
        lines(shown, [150.0, 4.5], Stroke::new(2.0, accent));
        if let Some((ray, _)) = shown.get(self.point) {
            view.paint_ray(ray, Stroke::new(3.0, Color32::WHITE), painter);
        }
        let font = TextStyle::Small.resolve(ui.style());
        for (number, (ray, _)) in shown.iter().enumerate() {
            let Some(at) = view.place(end_of(ray)) else { continue };
            let (radius, fill) = if number + 1 == self.point { (6.0, Color32::WHITE) } else { (4.0, accent) };
            painter.circle(at, radius, fill, Stroke::new(1.0, Color32::BLACK));
            let text = painter.layout_no_wrap((number + 2).to_string(), font.clone(), Color32::WHITE);
            let place = Rect::from_min_size(at + vec2(7.0, -6.0 - text.size().y), text.size());
            painter.rect_filled(place.expand2(vec2(3.0, 1.0)), 3, Color32::from_black_alpha(235));
            painter.galley(place.min, text, Color32::WHITE);
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

    fn paint_ray(&self, ray: &Step, stroke: Stroke, painter: &Painter) {
        if let Some(line) = self.line(ray.origin, end_of(ray)) {
            painter.line_segment(line, stroke);
        }
    }
}
