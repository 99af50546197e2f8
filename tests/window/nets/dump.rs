//! A window as text: what is on the screen, and what the window knows.

use eframe::egui::{self, Color32, Rect, Shape, Stroke};
use egui_kittest::kittest::{NodeT, Queryable};
use egui_kittest::{Harness, Node};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use weekender::app::Window;

/// Whether lines say where things are.
#[derive(Clone, Copy, PartialEq)]
pub enum Places {
    Yes,
    No,
}

/// A line for each control and text on the screen, for what is drawn over the picture, and for each kind of shape.
pub fn screen(harness: &Harness<'_, Window>, places: Places) -> String {
    let picture = harness.query_by_label("Picture").map_or(Rect::NOTHING, |node| node.rect());
    let mut painted = Painted { text: messages(harness.state()), picture, kinds: BTreeMap::new() };
    for clipped in &harness.output().shapes {
        painted.add(&clipped.shape, clipped.clip_rect);
    }
    let Painted { mut text, kinds, .. } = painted;
    let _ = writeln!(text, "cursor {:?}", harness.output().platform_output.cursor_icon);
    for node in harness.root().children_recursive() {
        if let Some(line) = node_line(&node, places).filter(|line| is_steady(line)) {
            let _ = writeln!(text, "{}", steady(&line));
        }
    }
    if places == Places::Yes {
        for (kind, count) in kinds {
            let _ = writeln!(text, "drawn {count} x {kind}");
        }
    }
    text
}

/// The messages on the screen, a line for each.
pub fn messages(window: &Window) -> String {
    let messages = window.messages().into_iter().filter(|message| is_steady(message));
    messages.fold(String::new(), |text, message| text + "message " + &steady(&message) + "\n")
}

/// Whether it is seen whenever the test looks. With few samples, the tracer says so once at some time.
fn is_steady(line: &str) -> bool {
    !["error estimate:", "so the error cannot", "Button \"×\""].iter().any(|words| line.contains(words))
}

fn node_line(node: &Node<'_>, places: Places) -> Option<String> {
    let inner = node.accesskit_node();
    let (role, label, value) = (inner.role(), inner.label(), inner.value());
    let is_structure = matches!(role, egui::Role::TextRun | egui::Role::Unknown);
    let is_named = label.as_ref().or(value.as_ref()).is_some_and(|text| !text.is_empty());
    if is_structure || !(is_named || inner.numeric_value().is_some() || inner.toggled().is_some()) {
        return None;
    }
    let mut line = format!("{role:?}");
    let _ = write!(line, " {:?}", label.clone().unwrap_or_default());
    if let Some(value) = value.filter(|value| Some(value) != label.as_ref()) {
        let _ = write!(line, " = {value:?}");
    }
    if let Some(number) = inner.numeric_value() {
        let ends = [inner.min_numeric_value(), inner.max_numeric_value()];
        let _ = write!(line, " {number:?} of {ends:?}");
    }
    if let Some(toggled) = inner.toggled() {
        let _ = write!(line, " {toggled:?}");
    }
    if inner.is_selected() == Some(true) {
        line.push_str(" selected");
    }
    for (is_so, word) in [(inner.is_disabled(), " disabled"), (inner.is_focused(), " focused")] {
        if is_so {
            line.push_str(word);
        }
    }
    if places == Places::Yes && inner.has_bounds() {
        let _ = write!(line, " {}", place(node.rect()));
    }
    Some(line)
}

/// Left and top, width and height in whole points.
fn place(rect: Rect) -> String {
    if !rect.is_finite() {
        return "everywhere".to_owned();
    }
    let [x, y, width, height] = [rect.left(), rect.top(), rect.width(), rect.height()].map(whole);
    format!("at {x},{y} {width}x{height}")
}

fn whole(length: f32) -> i32 {
    length.round() as i32
}

fn colour(colour: Color32) -> String {
    let [r, g, b, a] = colour.to_array();
    match a {
        0 => "none".to_owned(),
        255 => format!("#{r:02x}{g:02x}{b:02x}"),
        _ => format!("#{r:02x}{g:02x}{b:02x}{a:02x}"),
    }
}

fn stroke(stroke: &Stroke) -> String {
    if stroke.is_empty() { String::new() } else { format!(" line {} {}", stroke.width, colour(stroke.color)) }
}

struct Painted {
    text: String,
    picture: Rect,
    kinds: BTreeMap<String, usize>,
}

impl Painted {
    fn add(&mut self, shape: &Shape, clip: Rect) {
        if let Shape::Vec(shapes) = shape {
            shapes.iter().for_each(|shape| self.add(shape, clip));
            return;
        }
        let bounds = shape.visual_bounding_rect();
        if !bounds.intersects(clip) {
            return;
        }
        let kind = match shape {
            Shape::Circle(circle) => format!("circle {}{}", colour(circle.fill), stroke(&circle.stroke)),
            Shape::LineSegment { stroke: of_line, .. } => format!("segment{}", stroke(of_line)),
            Shape::Path(path) => {
                let closed = if path.closed { " closed" } else { "" };
                let of_line = match &path.stroke.color {
                    egui::epaint::ColorMode::Solid(solid) => stroke(&Stroke::new(path.stroke.width, *solid)),
                    egui::epaint::ColorMode::UV(_) => " shaded".to_owned(),
                };
                format!("path{closed} {}{of_line}", colour(path.fill))
            }
            Shape::Rect(rect) => format!("rect {}{}", colour(rect.fill), stroke(&rect.stroke)),
            Shape::Text(text) => {
                let sections = &text.galley.job.sections;
                let own = sections.first().map_or(Color32::PLACEHOLDER, |section| section.format.color);
                let own = if own == Color32::PLACEHOLDER { text.fallback_color } else { own };
                let used = text.override_text_color.unwrap_or(own);
                let size = sections.first().map_or(0.0, |section| section.format.font_id.size);
                format!("text {size} {}", colour(used))
            }
            Shape::Mesh(_) => "mesh".to_owned(),
            Shape::Noop => return,
            Shape::Callback(_) => "callback".to_owned(),
            _ => "curve".to_owned(),
        };
        if self.picture.contains_rect(clip) && clip.is_positive() {
            let words = match shape {
                Shape::Text(text) => format!(" {:?}", steady(text.galley.text())),
                Shape::LineSegment { points: [from, to], .. } => {
                    format!(" {},{} to {},{}", whole(from.x), whole(from.y), whole(to.x), whole(to.y))
                }
                _ => String::new(),
            };
            let _ = writeln!(self.text, "over {kind}{words} {}", place(bounds));
        }
        *self.kinds.entry(kind).or_default() += 1;
    }
}

/// The same without what differs from run to run or from machine to machine.
pub fn steady(text: &str) -> String {
    let here = std::env::current_dir().unwrap_or_default().display().to_string();
    let text = text.replace('\n', "|").replace(&here, "HERE");
    let number = |word: &str| word.trim_start_matches('"').parse::<f64>().is_ok();
    let mut words: Vec<&str> = text.split(' ').collect();
    for at in 1..words.len() {
        // Times and rates.
        let unit = words[at].trim_end_matches('"');
        let is_unit = ["s", "Mpaths/s"].contains(&unit) || unit.starts_with("s|");
        if is_unit && number(words[at - 1]) && words[at - 1].contains('.') {
            words[at - 1] = "N";
        }
    }
    words.join(" ")
}

/// Everything that the window knows, one value a line.
pub fn state(window: &Window) -> String {
    let all = format!("{window:#?}");
    let mut lines = all.lines().peekable();
    let mut text = String::new();
    lines.next();
    flatten(&mut lines, "", &mut text);
    text
}

/// What is long, or differs from run to run.
const LEFT_OUT: [&str; 9] =
    ["film", "means", "thumbnail", "status", "base", "number", "devices", "seconds_before", "identity"];

fn flatten<'a>(lines: &mut impl Iterator<Item = &'a str>, path: &str, text: &mut String) {
    let mut place = 0;
    while let Some(line) = lines.next() {
        let line = line.trim();
        if line.starts_with(['}', ')', ']']) {
            return;
        }
        let is_key = |key: &str| key.chars().all(|c| c.is_alphanumeric() || c == '_');
        let (key, rest) = match line.split_once(": ").filter(|(key, _)| is_key(key)) {
            Some((key, rest)) => (key.to_owned(), rest),
            None => {
                place += 1;
                ((place - 1).to_string(), line)
            }
        };
        let inner = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
        if rest.ends_with(['{', '(', '[']) {
            let mut within = String::new();
            flatten(lines, &inner, &mut within);
            let of_origin = inner.ends_with("origin.scene") || inner.ends_with("recipe.scene");
            if LEFT_OUT.contains(&key.as_str()) || of_origin {
                continue;
            }
            if within.lines().count() > 60 && ["spheres", "materials"].contains(&key.as_str()) {
                let _ = writeln!(text, "{inner} = {} lines", within.lines().count());
                continue;
            }
            let name = rest.trim_end_matches(['{', '(', '[', ' ']);
            // Numbers of a vector share a line.
            let prefix = format!("{inner}.");
            let values: Option<Vec<&str>> = within
                .lines()
                .map(|line| {
                    let (key, value) = line.strip_prefix(&prefix)?.split_once(" = ")?;
                    key.parse::<usize>().ok().map(|_| value)
                })
                .collect();
            match values.filter(|values| !values.is_empty()) {
                Some(values) if values.len() > 20 => {
                    let _ = writeln!(text, "{inner} = {} of them", values.len());
                }
                Some(values) => {
                    let _ = writeln!(text, "{inner} = {name}({})", values.join(", "));
                }
                None => text.push_str(&within),
            }
        } else if !LEFT_OUT.contains(&key.as_str()) {
            let _ = writeln!(text, "{inner} = {}", rounded(rest.trim_end_matches(',')));
        }
    }
}

/// Numbers to six digits after the point, because the last ones differ with the mathematical library.
fn rounded(value: &str) -> String {
    match value.parse::<f64>() {
        Ok(number) if value.contains('.') && number.abs() < 1e6 => {
            let short = format!("{number:.6}");
            let short = short.trim_end_matches('0').trim_end_matches('.');
            if short == "-0" { "0".to_owned() } else { short.to_owned() }
        }
        _ => value.to_owned(),
    }
}
