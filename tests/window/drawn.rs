//! What is drawn, as text: every shape with its place and its colours. The tests of single parts of the window in
//! `src/app` use this file, too.

use eframe::egui::{self, Color32, Rect, Shape, Stroke, TextureId};
use egui_kittest::Harness;

/// The shapes of the last frame, one a line. Texts that tell times are left out: they differ from run to run.
pub fn drawn<State>(harness: &Harness<'_, State>) -> Vec<String> {
    let mut lines = Vec::new();
    for clipped in &harness.output().shapes {
        draw(&clipped.shape, clipped.clip_rect, &mut lines);
    }
    lines
}

/// The lines of `after` that are not among those `before`, marked +, after those that have gone, marked -.
pub fn change(before: &[String], after: &[String]) -> String {
    let mut left: Vec<&String> = before.iter().collect();
    let mut new = String::new();
    for line in after {
        match left.iter().position(|old| *old == line) {
            Some(index) => drop(left.remove(index)),
            None => new.push_str(&format!("+ {line}\n")),
        }
    }
    left.iter().map(|line| format!("- {line}\n")).collect::<String>() + &new
}

fn tells_time(text: &str) -> bool {
    text.ends_with("paths/s") || text.strip_suffix(" s").is_some_and(|time| time.parse::<f64>().is_ok())
}

fn draw(shape: &Shape, clip: Rect, lines: &mut Vec<String>) {
    let bounds = shape.visual_bounding_rect();
    let line = match shape {
        Shape::Noop => return,
        Shape::Vec(shapes) => return shapes.iter().for_each(|shape| draw(shape, clip, lines)),
        Shape::Rect(shape) => {
            let corners = shape.corner_radius;
            format!(
                "rectangle {}{}{}{}{}{}",
                place(shape.rect),
                filled(shape.fill),
                edge(shape.stroke),
                if corners.average() > 0.0 {
                    format!(" round {:.1}", corners.average())
                } else {
                    String::new()
                },
                if shape.blur_width > 0.0 { format!(" blur {}", shape.blur_width) } else { String::new() },
                if shape.brush.is_some() { " with a picture" } else { "" }
            )
        }
        Shape::Circle(circle) => {
            let (center, fill, edge) = (at(circle.center), filled(circle.fill), edge(circle.stroke));
            format!("circle {center} {:.1}{fill}{edge}", circle.radius)
        }
        Shape::LineSegment { points: [a, b], stroke } => {
            format!("line {} {}{}", at(*a), at(*b), edge(*stroke))
        }
        Shape::Path(path) => {
            let points: Vec<String> = path.points.iter().map(|point| at(*point)).collect();
            let colour = match path.stroke.color {
                egui::epaint::ColorMode::Solid(colour) => filled(colour),
                egui::epaint::ColorMode::UV(_) => " of many colours".to_owned(),
            };
            let is_closed = if path.closed { " closed" } else { "" };
            let (width, fill) = (path.stroke.width, filled(path.fill));
            format!("path {}{is_closed}{fill} edge {width}{colour}", points.join(" "))
        }
        Shape::Text(shape) if tells_time(shape.galley.text()) => return,
        Shape::Text(shape) => {
            let sections = shape.galley.job.sections.iter().map(|section| {
                let own = shape.override_text_color.unwrap_or(section.format.color);
                let colour = if own == Color32::PLACEHOLDER { shape.fallback_color } else { own };
                format!(" {:.1}{}", section.format.font_id.size, filled(colour))
            });
            let sections: String = sections.collect();
            let is_faint = if shape.opacity_factor < 1.0 { " faint" } else { "" };
            format!("text {} {:?}{sections}{is_faint}", place(bounds), shape.galley.text())
        }
        Shape::Mesh(mesh) => {
            let colours: String = mesh.vertices.iter().take(8).map(|vertex| filled(vertex.color)).collect();
            let kind = if mesh.texture_id == TextureId::default() { "triangles" } else { "picture" };
            format!("{kind} {} of {} points{colours}{}", place(bounds), mesh.vertices.len(), part(mesh))
        }
        Shape::Ellipse(_)
        | Shape::Band(_)
        | Shape::QuadraticBezier(_)
        | Shape::CubicBezier(_)
        | Shape::Callback(_) => format!("other {}", place(bounds)),
    };
    let is_cut = !clip.contains_rect(bounds);
    lines.push(if is_cut { format!("{line} within {}", place(clip)) } else { line });
}

/// The part of its picture that a mesh shows, unless it is all of it.
fn part(mesh: &egui::Mesh) -> String {
    let points: Vec<egui::Pos2> = mesh.vertices.iter().map(|vertex| vertex.uv).collect();
    let part = Rect::from_points(&points);
    let is_whole = part == Rect::from_min_max(egui::pos2(0.0, 0.0), egui::pos2(1.0, 1.0));
    if is_whole || mesh.texture_id == TextureId::default() {
        String::new()
    } else {
        format!(" part {part:.3}")
    }
}

fn number(x: f32) -> String {
    // So that -0 and what rounds to it look like 0.
    format!("{:.1}", (x * 10.0).round() / 10.0 + 0.0)
}

fn at(point: egui::Pos2) -> String {
    format!("{},{}", number(point.x), number(point.y))
}

fn place(rect: Rect) -> String {
    if !rect.is_finite() {
        return "everywhere".to_owned();
    }
    format!("{} {}x{}", at(rect.min), number(rect.width()), number(rect.height()))
}

fn filled(colour: Color32) -> String {
    let [r, g, b, a] = colour.to_array();
    match a {
        0 if [r, g, b] == [0; 3] => String::new(),
        255 => format!(" #{r:02x}{g:02x}{b:02x}"),
        _ => format!(" #{r:02x}{g:02x}{b:02x}{a:02x}"),
    }
}

fn edge(stroke: Stroke) -> String {
    if stroke.is_empty() {
        String::new()
    } else {
        format!(" edge {:.2}{}", stroke.width, filled(stroke.color))
    }
}
