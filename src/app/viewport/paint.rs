//! Draws the viewport: the picture, the second picture, scales, markers and labels.

use super::placement::{Placement, Zoom};
use crate::app::facts::Facts;
use crate::app::model::document::Document;
use crate::app::model::fitted::Fitted;
use crate::app::model::show::Show;
use crate::app::model::view::Mode;
use crate::app::paths::Paths;
use crate::app::pixel_values::PixelValues;
use crate::app::texture::Texture;
use crate::app::theme;
use crate::heat::{HeatScale, colour_at};
use crate::progressive::Phase;
use eframe::egui::{
    self, Align2, Color32, CornerRadius, FontId, Pos2, Rect, Stroke, TextStyle, TextureOptions, Ui, pos2,
    vec2,
};
use std::time::{Duration, Instant};

const WHOLE: Rect = Rect { min: pos2(0.0, 0.0), max: pos2(1.0, 1.0) };

/// From this many screen pixels per pixel on, pixels are drawn as squares.
const SQUARES: f32 = 8.0;

/// The size of the letters for which the legend of a heat map was laid out, in points.
const LEGEND_FONT: f32 = 11.0;

/// How long a click's marker stays.
const MARK: Duration = Duration::from_millis(1600);

/// The pictures to draw.
pub struct Pictures<'a> {
    /// The picture or a layer of it, and the factor by which it is smaller.
    pub main: Option<(&'a mut Texture, u32)>,
    /// Whether there is a picture of the film.
    pub has_film: bool,
    /// The second picture.
    pub second: Option<SecondPicture<'a>>,
    /// Paths to draw over the picture, if it is the live one.
    pub paths: Option<&'a Paths>,
    /// Numbers to draw in large pixels.
    pub values: &'a PixelValues,
    /// What the user should know about the picture.
    pub notices: Vec<String>,
}

/// The picture at the other side of a wipe.
pub struct SecondPicture<'a> {
    /// Its pixels.
    pub texture: &'a mut Texture,
    /// The factor by which it is smaller than its full size.
    pub divisor: u32,
    /// Its name.
    pub title: String,
    /// Where it lies in the place of the first picture.
    pub fitted: Fitted,
}

/// Draws the picture at `rect`, within `room`.
pub(super) fn paint(
    ui: &Ui,
    [room, rect]: [Rect; 2],
    placement: &Placement,
    divider: f32,
    pictures: Pictures<'_>,
    document: &Document,
    facts: &Facts,
) {
    let painter = ui.painter().with_clip_rect(room);
    let options = |divisor: u32, is_scaled: bool| {
        // Smooth until pixels are large, except where each is one of the screen's. Previews and pictures of another size
        // are always smooth.
        let is_exact = (placement.times() - 1.0).abs() < 1e-4;
        let is_square = divisor == 1 && !is_scaled && (is_exact || placement.times() >= SQUARES);
        if is_square { TextureOptions::NEAREST } else { TextureOptions::LINEAR }
    };
    let context = ui.ctx();
    let Pictures { main, has_film, second, paths, values, notices } = pictures;
    let second = second.map(|SecondPicture { texture, divisor, title, fitted }| {
        (texture.id(context, options(divisor, !fitted.is_exact())), title, fitted)
    });
    let main = main.map(|(texture, divisor)| (texture.id(context, options(divisor, false)), divisor));
    // The hole is one point smaller, so that no gap stays between picture and background.
    let hole = if main.is_some() { rect.shrink(1.0).intersect(room) } else { Rect::NOTHING };
    fill_around(&painter, room, hole, theme::surround(ui));
    if let Some((texture, _)) = main {
        painter.image(texture, rect, WHOLE, Color32::WHITE);
    }
    let font = TextStyle::Body.resolve(ui.style());
    let view = &facts.model.view;
    if view.mode() == Some(Mode::Wipe)
        && let Some((texture, title, fitted)) = second
    {
        let whose = if view.has_other_camera(document) { ", with its own camera" } else { "" };
        let titles = [facts.title(), format!("{title}{whose}{}", fitted.words())];
        let is_left = view.is_other_earlier(document);
        paint_wipe(ui, &painter, rect, divider, (texture, is_left, fitted), &titles);
    }
    let is_difference = view.mode() == Some(Mode::Difference);
    let scale = if is_difference { Some(HeatScale::DIFFERENCE) } else { view.show().scale(&view.tone) };
    if let Some(scale) = scale {
        paint_scale(ui, &painter, rect.intersect(room), &scale);
    }
    let corners = rect.intersect(room);
    if let Some((_, divisor @ 2..)) = main {
        let text = format!("preview 1/{divisor}");
        badge(ui, &painter, corners.left_top() + vec2(8.0, 8.0), Align2::LEFT_TOP, &text, &font);
    }
    for (row, notice) in notices.iter().enumerate() {
        // Below the titles of a wipe.
        let row = row + usize::from(view.mode() == Some(Mode::Wipe));
        let at = corners.center_top() + vec2(0.0, 8.0 + 28.0 * row as f32);
        badge(ui, &painter, at, Align2::CENTER_TOP, notice, &font);
    }
    if !has_film {
        let text = match (&facts.invalid, &facts.status.phase) {
            (Some(reason), _) | (None, Phase::Failed(reason)) => reason.as_str(),
            _ => "preparing…",
        };
        let colour = ui.visuals().weak_text_color();
        painter.text(rect.center(), Align2::CENTER_CENTER, text, font.clone(), colour);
    }
    if let Zoom::Times(_) | Zoom::As(_) = placement.zoom() {
        let text = format!("{:.0} %", 100.0 * placement.times());
        badge(ui, &painter, corners.right_top() + vec2(-8.0, 8.0), Align2::RIGHT_TOP, &text, &font);
    }
    if facts.model.view.tone.exposure != 0.0 && view.show() == Show::Picture && !is_difference {
        let text = format!("exposure {:+.1} stops", view.tone.exposure);
        let at = corners.left_bottom() + vec2(8.0, -8.0);
        badge(ui, &painter, at, Align2::LEFT_BOTTOM, &text, &font);
    }
    values.paint(ui, room, rect, document.size(), &view.tone);
    if let Some(paths) = paths {
        paths.paint(document, ui, &painter, rect);
    }
}

/// Fills `room` except for `hole`: software rendering pays for each pixel that is drawn twice.
fn fill_around(painter: &egui::Painter, room: Rect, hole: Rect, colour: Color32) {
    if !hole.is_positive() {
        painter.rect_filled(room, 0.0, colour);
        return;
    }
    for rect in [
        Rect { max: pos2(room.right(), hole.top()), ..room },
        Rect { min: pos2(room.left(), hole.bottom()), ..room },
        Rect { min: pos2(room.left(), hole.top()), max: pos2(hole.left(), hole.bottom()) },
        Rect { min: pos2(hole.right(), hole.top()), max: pos2(room.right(), hole.bottom()) },
    ] {
        painter.rect_filled(rect, 0.0, colour);
    }
}

/// Draws the second picture to the left or right of the divider, and labels both sides.
fn paint_wipe(
    ui: &Ui,
    painter: &egui::Painter,
    rect: Rect,
    share: f32,
    (texture, is_left, fitted): (egui::TextureId, bool, Fitted),
    [mine, theirs]: &[String; 2],
) {
    let x = rect.left() + rect.width() * share;
    let shares = if is_left { [0.0, share] } else { [share, 1.0] };
    let [from, to] = shares.map(|share| rect.left() + rect.width() * share);
    let side = Rect::from_x_y_ranges(from..=to, rect.y_range());
    let [left, top, right, bottom] = fitted.part().map(|share| share as f32);
    let place = Rect::from_min_max(rect.lerp_inside(vec2(left, top)), rect.lerp_inside(vec2(right, bottom)));
    let seen = place.intersect(side);
    fill_around(painter, side, seen, theme::surround(ui));
    if seen.is_positive() {
        let [min, max] = [seen.min, seen.max].map(|corner| ((corner - place.min) / place.size()).to_pos2());
        painter.image(texture, seen, Rect { min, max }, Color32::WHITE);
    }
    let [left, right] = if is_left { [theirs, mine] } else { [mine, theirs] };
    painter.vline(x, rect.y_range(), Stroke::new(3.0, Color32::from_black_alpha(120)));
    painter.vline(x, rect.y_range(), Stroke::new(1.5, Color32::WHITE));
    let knob = pos2(x, rect.center().y);
    painter.circle(knob, 9.0, Color32::WHITE, Stroke::new(1.0, Color32::from_black_alpha(120)));
    for side in [-1.0, 1.0] {
        let tip = knob + vec2(6.0 * side, 0.0);
        let back = knob + vec2(2.5 * side, 0.0);
        let points = vec![tip, back + vec2(0.0, -3.5), back + vec2(0.0, 3.5)];
        painter.add(egui::Shape::convex_polygon(points, Color32::from_gray(60), Stroke::NONE));
    }
    let y = rect.top().max(painter.clip_rect().top()) + 8.0;
    // Labels are clipped at the picture's edges.
    let painter = &painter.with_clip_rect(rect.intersect(painter.clip_rect()));
    let font = TextStyle::Body.resolve(ui.style());
    badge(ui, painter, pos2(x - 14.0, y), Align2::RIGHT_TOP, left, &font);
    badge(ui, painter, pos2(x + 14.0, y), Align2::LEFT_TOP, right, &font);
}

/// Draws the legend of a heat map.
fn paint_scale(ui: &Ui, painter: &egui::Painter, rect: Rect, scale: &HeatScale) {
    const STEPS: usize = 64;
    let font = TextStyle::Small.resolve(ui.style());
    // The legend is as large as its letters.
    let large = font.size / LEGEND_FONT;
    let row = font.size + 4.0 * large;
    let plate = vec2(228.0 * large, 22.0 * large + 2.0 * row);
    let plate = Rect::from_min_size(rect.left_bottom() + vec2(10.0, -plate.y - 10.0), plate);
    painter.rect_filled(plate, CornerRadius::same(6), ui.visuals().panel_fill.gamma_multiply(0.9));
    let weak = ui.visuals().weak_text_color();
    painter.text(plate.min + vec2(24.0, 5.0) * large, Align2::LEFT_TOP, scale.title, font.clone(), weak);
    let bar = Rect::from_min_size(
        plate.min + vec2(24.0 * large, 6.0 * large + row),
        vec2(plate.width() - 48.0 * large, 9.0 * large),
    );
    for step in 0..STEPS {
        let [red, green, blue] = colour_at((step as f64 + 0.5) / STEPS as f64);
        let left = bar.left() + bar.width() * step as f32 / STEPS as f32;
        let size = vec2(bar.width() / STEPS as f32 + 0.5, bar.height());
        painter.rect_filled(
            Rect::from_min_size(pos2(left, bar.top()), size),
            0.0,
            Color32::from_rgb(red, green, blue),
        );
    }
    for (value, name) in scale.marks() {
        let at = pos2(bar.left() + bar.width() * scale.place(value) as f32, bar.bottom() + 2.0);
        painter.text(at, Align2::CENTER_TOP, name, font.clone(), ui.visuals().text_color());
    }
}

/// Shows what will happen to files dragged over the window.
pub(super) fn paint_drop(ui: &Ui, room: Rect) {
    let Some(files) = ui.input(|input| words_for_files(&input.raw.hovered_files)) else { return };
    let painter =
        ui.ctx().layer_painter(egui::LayerId::new(egui::Order::Foreground, egui::Id::unique("drop")));
    painter.rect_filled(room, CornerRadius::ZERO, ui.visuals().panel_fill.gamma_multiply(0.8));
    painter.rect_stroke(
        room.shrink(12.0),
        CornerRadius::same(8),
        Stroke::new(2.0, theme::accent(ui)),
        egui::StrokeKind::Inside,
    );
    let font = TextStyle::Heading.resolve(ui.style());
    painter.text(room.center(), Align2::CENTER_CENTER, files, font, ui.visuals().strong_text_color());
}

fn words_for_files(files: &[egui::HoveredFile]) -> Option<String> {
    let name = files.first()?.path.as_ref().and_then(|path| path.file_name());
    Some(
        name.map_or_else(
            || "Drop to open".to_owned(),
            |name| format!("Drop to open {}", name.to_string_lossy()),
        ),
    )
}

/// Text on a background plate, readable on any picture.
pub(super) fn badge(ui: &Ui, painter: &egui::Painter, at: Pos2, anchor: Align2, text: &str, font: &FontId) {
    let galley = painter.layout_no_wrap(text.to_owned(), font.clone(), ui.visuals().strong_text_color());
    let mut rect = anchor.anchor_size(at, galley.size() + vec2(14.0, 6.0));
    let clip = painter.clip_rect();
    let (beyond_left, beyond_right) = (clip.left() + 4.0 - rect.left(), rect.right() + 4.0 - clip.right());
    if beyond_left > 0.0 || beyond_right > 0.0 {
        let along = if beyond_left > 0.0 { beyond_left } else { -beyond_right };
        // One row lower, so that it does not cover its neighbour.
        rect = rect.translate(vec2(along, rect.height() + 4.0));
    }
    painter.rect_filled(rect, CornerRadius::same(5), ui.visuals().panel_fill.gamma_multiply(0.9));
    painter.galley(rect.min + vec2(7.0, 3.0), galley, ui.visuals().strong_text_color());
}

/// The result of a click, shown for a moment.
pub(super) struct Mark {
    /// Position in the picture, `0..=1` from the upper left.
    pub place: [f64; 2],
    /// The text beside the marker.
    pub text: String,
    /// The time of the click.
    pub since: Instant,
}

impl Mark {
    /// Draws the marker; returns false once its time is over.
    pub fn paint(&self, ui: &Ui, room: Rect, rect: Rect) -> bool {
        let age = self.since.elapsed();
        if age > MARK {
            return false;
        }
        let painter = &ui.painter().with_clip_rect(room);
        let at = rect.min + vec2(self.place[0] as f32, self.place[1] as f32) * rect.size();
        painter.circle_stroke(at, 9.0, Stroke::new(3.0, Color32::from_black_alpha(130)));
        painter.circle_stroke(at, 9.0, Stroke::new(1.5, Color32::WHITE));
        painter.circle_filled(at, 1.5, Color32::WHITE);
        let font = TextStyle::Body.resolve(ui.style());
        badge(ui, painter, at + vec2(14.0, 0.0), Align2::LEFT_CENTER, &self.text, &font);
        ui.ctx().request_repaint_after(MARK - age);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui_kittest::Harness;

    #[test]
    fn each_side_of_a_wipe_has_its_own_title() {
        let rect = Rect::from_min_size(pos2(0.0, 0.0), vec2(800.0, 400.0));
        let titles = ["mine", "theirs"].map(str::to_owned);
        for is_left in [false, true] {
            let harness = Harness::builder().with_size(rect.size()).build_ui(|ui| {
                let painter = ui.painter().with_clip_rect(rect);
                paint_wipe(
                    ui,
                    &painter,
                    rect,
                    0.25,
                    (egui::TextureId::default(), is_left, Fitted::new([8, 4], [8, 4])),
                    &titles,
                );
            });
            let left_of = |title: &str| {
                let place = harness.output().shapes.iter().find_map(|clipped| match &clipped.shape {
                    egui::Shape::Text(text) if text.galley.text() == title => Some(text.pos.x),
                    _ => None,
                });
                place.unwrap() < 200.0
            };
            assert_eq!([left_of("mine"), left_of("theirs")], [!is_left, is_left]);
        }
    }

    #[test]
    fn the_words_of_a_click_are_beside_it() {
        let rect = Rect::from_min_size(pos2(100.0, 50.0), vec2(400.0, 200.0));
        let click = pos2(200.0, 150.0);
        let mark = Mark { place: [0.25, 0.5], text: "sky".to_owned(), since: Instant::now() };
        let harness = Harness::builder().with_size([600.0, 300.0]).build_ui(|ui| {
            mark.paint(ui, rect, rect);
        });
        let words = harness.output().shapes.iter().find_map(|clipped| match &clipped.shape {
            egui::Shape::Text(text) if text.galley.text() == "sky" => Some(text.visual_bounding_rect()),
            _ => None,
        });
        let words = words.unwrap();
        assert!(words.left() > click.x && words.left() < click.x + 40.0, "{words}");
        assert!(words.y_range().contains(click.y), "{words}");
    }
}
