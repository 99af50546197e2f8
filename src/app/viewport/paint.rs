//! Draws the viewport: the picture, the second picture and labels.

use super::badge::{badge, badge_below};
use super::legend::paint_scale;
use super::placement::{Placement, Zoom};
use super::selection::ROW;
use crate::app::facts::Facts;
use crate::app::model::document::Document;
use crate::app::model::fitted::Fitted;
use crate::app::model::show::Show;
use crate::app::model::view::Mode;
use crate::app::paths::Paths;
use crate::app::pixel_values::PixelValues;
use crate::app::texture::Texture;
use crate::app::theme;
use crate::numbers::heat::HeatScale;
use crate::progressive::Phase;
use eframe::egui::{self, Align2, Color32, Rect, Stroke, TextStyle, TextureOptions, Ui, pos2, vec2};

const WHOLE: Rect = Rect { min: pos2(0.0, 0.0), max: pos2(1.0, 1.0) };

/// From this many screen pixels per pixel on, pixels are drawn as squares.
const SQUARES: f32 = 8.0;

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

/// Draws the picture at `rect`, within `room`. Returns the places of the words at its top, which others must not cover.
pub(super) fn paint(
    ui: &Ui,
    [room, rect]: [Rect; 2],
    placement: &Placement,
    divider: f32,
    pictures: Pictures<'_>,
    document: &Document,
    facts: &Facts,
) -> Vec<Rect> {
    let mut taken = Vec::new();
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
        taken.extend(paint_wipe(ui, &painter, rect, divider, (texture, is_left, fitted), &titles));
    }
    let is_difference = view.mode() == Some(Mode::Difference);
    let scale = if is_difference { Some(HeatScale::DIFFERENCE) } else { view.show().scale(&view.tone) };
    if let Some(scale) = scale {
        paint_scale(ui, &painter, rect.intersect(room), &scale);
    }
    let corners = rect.intersect(room);
    if let Some((_, divisor @ 2..)) = main {
        let text = format!("preview 1/{divisor}");
        let at = (corners.left_top() + vec2(8.0, 8.0), Align2::LEFT_TOP);
        taken.push(badge_below(ui, &painter, at, &text, &font, &taken));
    }
    for (row, notice) in notices.iter().enumerate() {
        // Below the titles of a wipe.
        let row = row + usize::from(view.mode() == Some(Mode::Wipe));
        let at = corners.center_top() + vec2(0.0, 8.0 + ROW * row as f32);
        taken.push(badge_below(ui, &painter, (at, Align2::CENTER_TOP), notice, &font, &taken));
    }
    if !has_film {
        let text = match (&facts.invalid, &facts.status.phase) {
            (Some(reason), _) | (None, Phase::Failed(reason)) => reason.as_str(),
            _ => "preparing…",
        };
        let colour = ui.visuals().weak_text_color();
        painter.text(rect.center(), Align2::CENTER_CENTER, text, font.clone(), colour);
    }
    if let Zoom::Times(_) = placement.zoom() {
        let text = format!("{:.0} %", 100.0 * placement.times());
        let at = (corners.right_top() + vec2(-8.0, 8.0), Align2::RIGHT_TOP);
        taken.push(badge_below(ui, &painter, at, &text, &font, &taken));
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
    taken
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

/// The side of a wipe at `rect` with the first picture. `is_left` says that the second one is left of the divider.
pub(super) fn own_side(rect: Rect, share: f32, is_left: bool) -> Rect {
    let x = rect.left() + rect.width() * share;
    if is_left {
        Rect { min: pos2(x, rect.top()), ..rect }
    } else {
        Rect { max: pos2(x, rect.bottom()), ..rect }
    }
}

/// Draws the second picture to the left or right of the divider, and labels both sides. Returns the places of the labels.
fn paint_wipe(
    ui: &Ui,
    painter: &egui::Painter,
    rect: Rect,
    share: f32,
    (texture, is_left, fitted): (egui::TextureId, bool, Fitted),
    [mine, theirs]: &[String; 2],
) -> [Rect; 2] {
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
    [(x - 14.0, Align2::RIGHT_TOP, left), (x + 14.0, Align2::LEFT_TOP, right)]
        .map(|(x, anchor, title)| badge(ui, painter, pos2(x, y), anchor, title, &font))
}
