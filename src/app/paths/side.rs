//! A path seen from the side: from the eye, its first ray is only a point.

use super::{Path, is_ground};
use crate::app::model::Document;
use crate::app::theme;
use crate::scene::{Look, Sphere};
use eframe::egui::{
    Align2, Color32, Painter, Pos2, Rect, Sense, Shape, Stroke, StrokeKind, TextStyle, Ui, Vec2, pos2, vec2,
};
use glam::{DVec2, DVec3};

/// Space around what is drawn, points.
const MARGIN: f32 = 28.0;

/// The largest distance of the camera, and that to which a ray into the sky is drawn, relative to the part of the scene that
/// the path touches.
const CAMERA: f64 = 1.5;
const SKY: f64 = 0.6;

/// Points of the line of the ground.
const GROUND: usize = 32;

/// A parallel projection onto a plane.
struct View {
    right: DVec3,
    up: DVec3,
    /// Points of the screen per unit, and the point of the plane that is in the middle of the screen.
    scale: f64,
    middle: DVec2,
    rect: Rect,
}

impl View {
    fn project(&self, point: DVec3) -> DVec2 {
        DVec2::new(point.dot(self.right), point.dot(self.up))
    }

    fn on_screen(&self, flat: DVec2) -> Pos2 {
        let by = (flat - self.middle) * self.scale;
        self.rect.center() + vec2(by.x as f32, -by.y as f32)
    }

    fn place(&self, point: DVec3) -> Pos2 {
        self.on_screen(self.project(point))
    }
}

/// Draws a path; `at` is the point that is explained.
pub(super) fn ui(ui: &mut Ui, path: &Path, at: usize, document: &Document) {
    let (rect, _) = ui.allocate_exact_size(ui.available_size(), Sense::hover());
    let colours = theme::colours(ui);
    let painter = ui.painter().with_clip_rect(rect.intersect(ui.clip_rect()));
    painter.rect_filled(rect, 4, colours.surround);
    let Some((first, _)) = path.first() else { return };
    let scene = document.scene();
    let mut touched: Vec<usize> = path.iter().filter_map(|(step, _)| Some(step.hit?.sphere)).collect();
    touched.sort_unstable();
    touched.dedup();
    let touched = || touched.iter().map(|sphere| &scene.spheres[*sphere]);
    let hits: Vec<DVec3> = path.iter().filter_map(|(step, _)| step.hit).map(|hit| hit.point).collect();

    // The plane through up and the direction in which the path reaches farthest.
    let up = document.camera.vup.normalize_or(DVec3::Y);
    let mut view = View { right: across(first.origin, &hits, up), up, scale: 1.0, middle: DVec2::ZERO, rect };

    // A far camera and the end of a ray to the sky are drawn nearer.
    let balls: Vec<&Sphere> = touched().filter(|sphere| !is_ground(sphere)).collect();
    let (low, high) = bounds(&view, &hits, &balls);
    let distance = hits.first().map_or(1.0, |hit| first.origin.distance(*hit));
    let size = (high - low).max_element().max(0.1 * distance);
    let eye = hits
        .first()
        .map_or(first.origin, |hit| *hit - first.direction.normalize_or_zero() * distance.min(CAMERA * size));
    let mut points: Vec<DVec3> = std::iter::once(eye).chain(hits.iter().copied()).collect();
    let is_lost = path.last().filter(|(step, _)| step.hit.is_none());
    points.extend(
        is_lost.and_then(|(step, _)| Some(*points.last()? + step.direction.normalize_or_zero() * SKY * size)),
    );

    let (low, high) = bounds(&view, &points, &balls);
    let room = rect.shrink(MARGIN).size();
    let extent = (high - low).max(DVec2::splat(1e-9));
    view.scale = (f64::from(room.x) / extent.x).min(f64::from(room.y) / extent.y).max(1e-9);
    view.middle = 0.5 * (low + high);

    // What the plane cuts, and what the path touches.
    let font = TextStyle::Small.resolve(ui.style());
    let label = |at: Pos2, align: Align2, text: &str| {
        let shape = painter.layout_no_wrap(text.to_owned(), font.clone(), colours.weak);
        let place = align.anchor_size(at, shape.size());
        let inside = rect.shrink(4.0);
        let shift = (inside.min - place.min).max(Vec2::ZERO) + (inside.max - place.max).min(Vec2::ZERO);
        painter.galley(place.min + shift, shape, colours.weak);
    };
    let normal = view.right.cross(up);
    let depth = points.iter().map(|point| point.dot(normal)).sum::<f64>() / points.len() as f64;
    for sphere in scene.spheres.iter().filter(|sphere| !is_ground(sphere)) {
        let off = sphere.center.dot(normal) - depth;
        if off.abs() < sphere.radius {
            let radius = (sphere.radius.powi(2) - off.powi(2)).sqrt();
            circle(&view, &painter, sphere.center, radius, Stroke::new(1.0, colours.line));
        }
    }
    for sphere in touched() {
        if is_ground(sphere) {
            let line = ground(&view, sphere);
            if let Some(last) = line.last() {
                label(*last + vec2(-8.0, 4.0), Align2::RIGHT_TOP, "ground");
            }
            painter.line(line, Stroke::new(1.0, colours.edge));
        } else {
            circle(&view, &painter, sphere.center, sphere.radius, Stroke::new(1.0, colours.text));
            let top = view.place(sphere.center + up * sphere.radius) - vec2(0.0, 2.0);
            let name = match scene.material_of(sphere).look() {
                Look::Matte => "matte ball",
                Look::Mirror { .. } => "metal ball",
                Look::Glass { .. } => "glass ball",
            };
            label(top, Align2::CENTER_BOTTOM, name);
        }
    }

    // The rays.
    let places: Vec<Pos2> = points.iter().map(|point| view.place(*point)).collect();
    for (ray, ends) in places.windows(2).enumerate() {
        let stroke = match ray == at {
            true => Stroke::new(2.5, colours.accent),
            false => Stroke::new(1.5, colours.text),
        };
        painter.line_segment([ends[0], ends[1]], stroke);
    }
    for (number, place) in places.iter().enumerate().take(hits.len() + 1).skip(1) {
        let (radius, colour) = if number == at { (4.0, colours.accent) } else { (3.0, colours.text) };
        painter.circle_filled(*place, radius, colour);
    }
    if is_lost.is_some()
        && let Some(last) = places.last()
    {
        label(*last - vec2(8.0, 0.0), Align2::RIGHT_CENTER, "to the sky");
    }
    camera(&painter, places[0], if at == 0 { colours.accent } else { colours.text });
    label(places[0] + vec2(0.0, 12.0), Align2::CENTER_TOP, "camera");
}

/// The horizontal direction in which the points reach farthest, away from the eye.
fn across(eye: DVec3, hits: &[DVec3], up: DVec3) -> DVec3 {
    let (a, b) = up.any_orthonormal_pair();
    let flat: Vec<DVec2> =
        std::iter::once(&eye).chain(hits).map(|point| DVec2::new(point.dot(a), point.dot(b))).collect();
    let mean = flat.iter().sum::<DVec2>() / flat.len() as f64;
    let [xx, xy, yy] = flat
        .iter()
        .map(|point| *point - mean)
        .fold([0.0; 3], |[xx, xy, yy], by| [xx + by.x * by.x, xy + by.x * by.y, yy + by.y * by.y]);
    let (sine, cosine) = (0.5 * (2.0 * xy).atan2(xx - yy)).sin_cos();
    let right = a * cosine + b * sine;
    if hits.last().is_some_and(|last| (*last - eye).dot(right) < 0.0) { -right } else { right }
}

/// The box around points and balls.
fn bounds(view: &View, points: &[DVec3], balls: &[&Sphere]) -> (DVec2, DVec2) {
    let points = points.iter().map(|point| (view.project(*point), 0.0));
    let balls = balls.iter().map(|ball| (view.project(ball.center), ball.radius));
    let all = points.chain(balls).map(|(at, radius)| (at - radius, at + radius));
    all.reduce(|(a, b), (low, high)| (a.min(low), b.max(high))).unwrap_or((DVec2::ZERO, DVec2::ZERO))
}

fn circle(view: &View, painter: &Painter, center: DVec3, radius: f64, stroke: Stroke) {
    painter.circle_stroke(view.place(center), (radius * view.scale) as f32, stroke);
}

/// The upper edge of a huge sphere, from the left to the right of the screen.
fn ground(view: &View, sphere: &Sphere) -> Vec<Pos2> {
    let center = view.project(sphere.center);
    let height = |x: f32| {
        let across = f64::from(x - view.rect.center().x) / view.scale + view.middle.x - center.x;
        center.y + (sphere.radius.powi(2) - across.powi(2)).max(0.0).sqrt()
    };
    let columns =
        (0..=GROUND).map(|at| view.rect.x_range().min + view.rect.width() * at as f32 / GROUND as f32);
    columns.map(|x| pos2(x, view.on_screen(DVec2::new(view.middle.x, height(x))).y)).collect()
}

fn camera(painter: &Painter, at: Pos2, colour: Color32) {
    let stroke = Stroke::new(1.0, colour);
    let body = Rect::from_min_max(at + vec2(-14.0, -8.0), at + vec2(-4.0, 8.0));
    painter.rect_stroke(body, 1, stroke, StrokeKind::Inside);
    painter.add(Shape::closed_line(
        vec![at + vec2(-4.0, 0.0), at + vec2(2.0, -6.0), at + vec2(2.0, 6.0)],
        stroke,
    ));
}
