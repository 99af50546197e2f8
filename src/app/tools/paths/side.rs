//! A path seen from the side: from the eye, its first ray is only a point.

use super::Path;
use crate::app::model::spheres::{MANY, is_ground};
use crate::app::model::{Document, kind_word};
use crate::app::toolkit::theme;
use crate::scene::Sphere;
use eframe::egui::{Align2, Color32, RichText, Sense, Ui};
use egui_plot::{Line, MarkerShape, Plot, PlotBounds, PlotPoint, PlotPoints, Points, Polygon, Text};
use glam::{DVec2, DVec3};
use std::collections::BTreeSet;

/// The largest distance of the camera, that to which a ray into the sky is drawn, and the space around the drawing, relative
/// to the part of the scene that the path touches.
const CAMERA: f64 = 1.5;
const SKY: f64 = 0.6;
const MARGIN: f64 = 0.15;

/// Draws a path; `at` is the point that is explained.
pub(super) fn ui(ui: &mut Ui, path: &Path, at: usize, document: &Document) {
    let (Some((first, _)), Some((last, _))) = (path.first(), path.last()) else { return };
    let (scene, colours) = (document.scene(), theme::colours(ui));
    let hits: Vec<_> = path.iter().filter_map(|(step, _)| step.hit).collect();
    let touched: BTreeSet<usize> = hits.iter().map(|hit| hit.sphere).collect();
    let touched = touched.into_iter().map(|sphere| &scene.spheres[sphere]);
    let (grounds, balls): (Vec<&Sphere>, Vec<&Sphere>) =
        touched.partition(|sphere| is_ground(sphere, &document.camera));

    // The plane through up and the direction in which the path reaches farthest.
    let up = document.camera.vup.normalize_or(DVec3::Y);
    let reach = hits.iter().map(|hit| (hit.point - first.origin).reject_from_normalized(up));
    let reach = reach.max_by(|a, b| a.length().total_cmp(&b.length()));
    let reach = reach.unwrap_or(first.direction.reject_from_normalized(up));
    let right = reach.normalize_or(up.any_orthonormal_vector());
    let flat = |point: DVec3| DVec2::new(point.dot(right), point.dot(up));
    let bounds = |points: &[DVec3]| {
        let points = points.iter().map(|point| (flat(*point), 0.0));
        let all = points.chain(balls.iter().map(|ball| (flat(ball.center), ball.radius)));
        let all = all.map(|(at, radius)| (at - radius, at + radius));
        all.reduce(|(a, b), (low, high)| (a.min(low), b.max(high))).unwrap_or_default()
    };

    // A far camera and the end of a ray to the sky are drawn nearer.
    let mut points: Vec<DVec3> = hits.iter().map(|hit| hit.point).collect();
    let (low, high) = bounds(&points);
    let distance = points.first().map_or(1.0, |hit| first.origin.distance(*hit));
    let size = (high - low).max_element().max(0.1 * distance);
    let eye = points
        .first()
        .map_or(first.origin, |hit| *hit - first.direction.normalize_or_zero() * distance.min(CAMERA * size));
    points.insert(0, eye);
    if last.hit.is_none() {
        points.push(points[hits.len()] + last.direction.normalize_or_zero() * SKY * size);
    }
    let (low, high) = bounds(&points);
    let margin = MARGIN * (high - low).max_element();
    let normal = right.cross(up);
    let depth = points.iter().map(|point| point.dot(normal)).sum::<f64>() / points.len() as f64;
    let points: Vec<DVec2> = points.into_iter().map(flat).collect();

    let line = |ends: &[DVec2], width: f32, colour: Color32| {
        let ends: Vec<_> = ends.iter().map(DVec2::to_array).collect();
        Line::new("", ends).width(width).color(colour)
    };
    let circle = |center: DVec2, radius: f64, colour: Color32| {
        let around = |angle: f64| (center.x + radius * angle.cos(), center.y + radius * angle.sin());
        let around = PlotPoints::from_parametric_callback(around, 0.0..std::f64::consts::TAU, 96);
        Polygon::new("", around).fill_color(Color32::TRANSPARENT).stroke((1.0, colour))
    };
    let label = |at: DVec2, anchor: Align2, text: &str| {
        let text = RichText::new(text).small();
        Text::new("", PlotPoint::new(at.x, at.y), text).anchor(anchor).color(colours.weak)
    };
    ui.painter().rect_filled(ui.available_rect_before_wrap(), 4, colours.surround);
    let plot = Plot::new("side").data_aspect(1.0).show_axes(false).show_grid(false).show_background(false);
    let plot = plot.show_x(false).show_y(false).sense(Sense::hover()).allow_drag(false).allow_zoom(false);
    plot.allow_scroll(false).allow_boxed_zoom(false).show(ui, |plot| {
        let [from, to] = [low - margin, high + margin];
        plot.set_plot_bounds(PlotBounds::from_min_max(from.to_array(), to.to_array()));
        // What the plane cuts, and what the path touches.
        let count = if scene.spheres.len() > MANY { 0 } else { scene.spheres.len() };
        for sphere in scene.spheres[..count].iter().filter(|sphere| !is_ground(sphere, &document.camera)) {
            let off = sphere.center.dot(normal) - depth;
            if off.abs() < sphere.radius {
                let radius = (sphere.radius.powi(2) - off.powi(2)).sqrt();
                plot.polygon(circle(flat(sphere.center), radius, colours.line));
            }
        }
        for ball in &balls {
            let center = flat(ball.center);
            plot.polygon(circle(center, ball.radius, colours.text));
            let name = format!("{} ball", kind_word(scene.material_of(ball)));
            plot.text(label(center + DVec2::Y * ball.radius, Align2::CENTER_BOTTOM, &name));
        }
        // The upper edges of huge spheres.
        for sphere in &grounds {
            let Sphere { radius, .. } = **sphere;
            let center = flat(sphere.center);
            let height = move |x: f64| center.y + (radius.powi(2) - (x - center.x).powi(2)).max(0.0).sqrt();
            let beyond = 4.0 * (to - from).max_element();
            let edge = PlotPoints::from_explicit_callback(height, from.x - beyond..to.x + beyond, 256);
            plot.line(Line::new("", edge).width(1.0).color(colours.edge));
            plot.text(label(DVec2::new(to.x, height(to.x)), Align2::RIGHT_TOP, "ground"));
        }
        for (ray, ends) in points.windows(2).enumerate() {
            let (width, colour) = if ray == at { (2.5, colours.accent) } else { (1.5, colours.text) };
            plot.line(line(ends, width, colour));
        }
        for (number, point) in points.iter().enumerate().take(hits.len() + 1) {
            let shape = if number == 0 { MarkerShape::Square } else { MarkerShape::Circle };
            let (radius, colour) = if number == at { (4.0, colours.accent) } else { (3.0, colours.text) };
            plot.points(Points::new("", vec![point.to_array()]).shape(shape).radius(radius).color(colour));
        }
        plot.text(label(points[0] - DVec2::Y * 0.3 * margin, Align2::CENTER_TOP, "camera"));
        if let Some(end) = points.get(hits.len() + 1) {
            plot.text(label(*end + DVec2::Y * 0.2 * margin, Align2::CENTER_BOTTOM, "to the sky"));
        }
    });
}
