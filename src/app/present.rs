//! A presentation: large captions around the picture, progress along the bottom, and a magnifier.
//!
//! All sizes are shares of the window's height, so that a projector's resolution does not matter.

use super::command::Command;
use super::facts::Facts;
use super::status;
use super::theme;
use super::widgets::compact;
use crate::progressive::Phase;
use crate::stages::Stage;
use eframe::egui::{
    self, Align, Align2, Color32, Context, CornerRadius, CursorIcon, FontFamily, FontId, Frame, Label,
    Layout, Margin, Panel, Pos2, Rect, RichText, Role, Sense, Stroke, StrokeKind, Style, TextStyle, Ui,
    WidgetInfo, vec2,
};
use std::time::Duration;

/// Seconds for which the keys are shown, and in which they fade.
const HELP_SECONDS: [f64; 2] = [5.0, 1.0];

/// Text sizes in hundredths of the height: the largest that has room is used.
const SIZES: [f32; 5] = [2.75, 2.5, 2.25, 2.0, 1.75];

/// From the edges of the screen, in hundredths of the height.
const MARGIN: f32 = 4.0;

/// Pixels on a side of a swatch of the magnifier.
const SIDE: u32 = 5;

/// A hundredth of the window's height; less if the window is narrower than a 4:3 screen.
fn unit(context: &Context) -> f32 {
    let size = context.content_rect().size();
    (size.y / 100.0).min(size.x / 133.0).max(1.0)
}

/// When the pointer was moved last, or the presentation began, in egui's seconds.
#[derive(Default)]
pub struct Presenter {
    since: f64,
}

impl Presenter {
    pub fn begin(&mut self, context: &Context) {
        self.since = context.input(|input| input.time);
    }

    /// Draws everything except the picture, which gets the room that is left.
    pub fn ui(&mut self, ui: &mut Ui, facts: &Facts) {
        let unit = unit(ui.ctx());
        if ui.input(|input| input.pointer.is_moving()) {
            self.begin(&ui.ctx().clone());
        }
        let words = status::sentence(facts);
        let is_done = matches!(facts.status.phase, Phase::Done(_));
        let share = if is_done { 1.0 } else { status::share(facts).unwrap_or(0.0) as f32 };
        bottom("present progress", 0.5 * unit, 0.0).show(ui, |ui| {
            let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::hover());
            response.widget_info(|| WidgetInfo::labeled(Role::ProgressIndicator, true, &words));
            let done = Rect::from_min_size(rect.min, vec2(rect.width() * share, rect.height()));
            ui.painter().rect_filled(rect, 0.0, theme::colours(ui).raised);
            ui.painter().rect_filled(done, 0.0, theme::colours(ui).accent);
        });
        if !facts.model.presentation.is_some_and(|presentation| presentation.has_captions) {
            return;
        }
        let margin = MARGIN * unit;
        bottom("present keys", 4.0 * unit, margin).show(ui, |ui| {
            ui.horizontal_centered(|ui| {
                self.keys(ui, unit);
                let words = RichText::new(&words).size(1.75 * unit).color(theme::colours(ui).weak);
                ui.with_layout(Layout::right_to_left(Align::Center), |ui| ui.label(words));
            });
        });
        if let Some(texts) = texts(facts) {
            bottom("present texts", 16.0 * unit, margin).show(ui, |ui| columns(ui, unit, texts));
        }
        let title_bar = Panel::top("present title").exact_size(9.0 * unit).show_separator_line(false);
        title_bar.frame(frame(margin)).show(ui, |ui| ui.horizontal_centered(|ui| title(ui, unit, facts)));
    }

    /// The keys, for a while.
    fn keys(&self, ui: &mut Ui, unit: f32) {
        let [whole, fading] = HELP_SECONDS;
        let age = ui.input(|input| input.time) - self.since;
        let left = 1.0 - ((age - whole) / fading).clamp(0.0, 1.0);
        if left <= 0.0 {
            return;
        }
        ui.ctx().request_repaint_after(Duration::from_secs_f64((whole - age).max(0.0)));
        let named = [
            (Command::NextStage, "next"),
            (Command::ShowMe, "show me"),
            (Command::Wipe, "wipe"),
            (Command::Blank, "blank"),
            (Command::Panels, "captions"),
        ];
        let key = |command: Command| command.keys(ui.ctx()).unwrap_or_default();
        let keys = named.map(|(command, what)| format!("{} {what}", key(command)));
        let text = format!("{}    Escape ends", keys.join("    "));
        let colour = theme::colours(ui).weak.gamma_multiply(left as f32);
        ui.label(RichText::new(text).size(1.75 * unit).color(colour));
    }
}

fn frame(margin: f32) -> Frame {
    Frame::new().inner_margin(Margin::symmetric(margin.round() as i8, 0))
}

fn bottom(name: &'static str, height: f32, margin: f32) -> Panel {
    Panel::bottom(name).exact_size(height).show_separator_line(false).frame(frame(margin))
}

/// Makes the words in the picture, such as the titles of a wipe, large enough.
pub fn enlarge(context: &Context, style: &mut Style) {
    let unit = unit(context);
    for text in [TextStyle::Body, TextStyle::Small] {
        if let Some(font) = style.text_styles.get_mut(&text) {
            font.size = font.size.max(2.25 * unit);
        }
    }
}

/// Covers everything with black.
pub fn blank(context: &Context) {
    let layer = egui::LayerId::new(egui::Order::Debug, egui::Id::unique("blank"));
    context.layer_painter(layer).rect_filled(context.content_rect(), 0.0, Color32::BLACK);
    context.set_cursor_icon(CursorIcon::None);
}

fn title(ui: &mut Ui, unit: f32, facts: &Facts) {
    let (colours, stage) = (theme::colours(ui), facts.document().stage());
    if let Some(stage) = stage {
        ui.label(RichText::new(stage.section).size(4.5 * unit).color(colours.accent));
        ui.add_space(unit);
    }
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        if let Some(stage) = stage {
            let place = Stage::walk().take_while(|other| other.index() <= stage.index()).count();
            let place = format!("{place} of {}", Stage::walk().count());
            ui.label(RichText::new(place).size(2.25 * unit).color(colours.weak));
        }
        ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
            let changed = if facts.document().has_changed_scene() { ", changed" } else { "" };
            let title = stage.map_or_else(|| facts.title(), |stage| format!("{}{changed}", stage.title));
            ui.add(Label::new(RichText::new(title).size(4.5 * unit).color(colours.strong)).truncate());
        });
    });
}

/// The headings and texts below the picture.
fn texts(facts: &Facts) -> Option<[(&'static str, &'static str); 2]> {
    let (stage, case) = (facts.document().stage(), facts.document().case());
    if let Some(stage) = stage {
        let look_for = if facts.has_sight { stage.sight.caption } else { stage.look_for };
        return Some([("What is new", stage.what_is_new), ("Look for", look_for)]);
    }
    let watch = case?.watch?;
    Some([("What is difficult", case?.family.title), ("Look for", watch.look_for)])
}

/// Two texts side by side, as large as both have room.
fn columns(ui: &mut Ui, unit: f32, texts: [(&str, &str); 2]) {
    let (gap, heading) = (MARGIN * unit, 2.0 * unit);
    let width = 0.5 * (ui.available_width() - gap);
    let room = ui.available_height() - 2.5 * heading;
    let height = |text: &str, size: f32| {
        let font = FontId::new(size, FontFamily::Proportional);
        ui.painter().layout(text.to_owned(), font, Color32::WHITE, width).size().y
    };
    let fits = |size: &f32| texts.iter().all(|(_, text)| height(text, *size) <= room);
    let size = SIZES.map(|size| size * unit).into_iter().find(fits).unwrap_or(SIZES[4] * unit);
    ui.spacing_mut().item_spacing = vec2(gap, 0.2 * heading);
    ui.add_space(heading);
    ui.horizontal_top(|ui| {
        for (name, text) in texts {
            ui.vertical(|ui| {
                ui.set_width(width);
                ui.label(RichText::new(name).size(heading).color(theme::colours(ui).accent));
                ui.add(Label::new(RichText::new(text).size(size).color(theme::colours(ui).strong)).wrap());
            });
        }
    });
}

/// What the magnifier shows.
pub struct Magnified {
    /// Pixels around the pointer in each picture, row by row; `None` beyond the picture.
    pub swatches: Vec<Vec<Option<[u8; 3]>>>,
    /// Headings and the three channels.
    pub columns: Vec<(&'static str, [String; 3])>,
}

impl Magnified {
    /// A pixel of one picture: its byte and its radiance, if that is known.
    pub fn one(colours: Vec<Option<[u8; 3]>>, mean: Option<[f64; 3]>) -> Self {
        let bytes = pixel(&colours).map(|bytes| ("byte", bytes.map(|byte| byte.to_string())));
        let light = mean.map(|mean| ("light", mean.map(|light| compact((1e3 * light).round() / 1e3))));
        Magnified { columns: bytes.into_iter().chain(light).collect(), swatches: vec![colours] }
    }

    /// A pixel of two pictures, and by how much they differ. `swatches` are on the screen.
    pub fn two(swatches: Vec<Vec<Option<[u8; 3]>>>, without: [u8; 3], with: [u8; 3]) -> Self {
        let change = [0, 1, 2].map(|channel| match i16::from(with[channel]) - i16::from(without[channel]) {
            0 => "0".to_owned(),
            change => format!("{change:+}").replace('-', "\u{2212}"),
        });
        let [without, with] = [without, with].map(|bytes| bytes.map(|byte| byte.to_string()));
        Magnified { swatches, columns: vec![("without", without), ("with", with), ("change", change)] }
    }

    /// Draws it in a lower corner of the viewport, away from the pointer.
    pub fn paint(&self, ui: &Ui, room: Rect, pointer: Pos2) {
        let (unit, colours) = (unit(ui.ctx()), theme::colours(ui));
        let (side, pad, row) = (3.0 * unit, 1.5 * unit, 3.25 * unit);
        let swatch = side * SIDE as f32;
        let width = (swatch * self.swatches.len() as f32).max(9.0 * unit * self.columns.len() as f32);
        let size = vec2(width + 2.0 * pad, swatch + 4.0 * row + 2.5 * pad);
        let inner = room.shrink(if room.width() > 4.0 * size.x { MARGIN * unit } else { unit });
        let is_left = pointer.x > inner.left() + size.x + 4.0 * unit
            || pointer.y < inner.bottom() - size.y - 4.0 * unit;
        let corner = if is_left { Align2::LEFT_BOTTOM } else { Align2::RIGHT_BOTTOM };
        let plate = corner.anchor_size(corner.pos_in_rect(&inner), size);
        let painter = ui.painter().with_clip_rect(room);
        painter.rect_filled(plate, CornerRadius::same(8), colours.panel);
        let corner = plate.min + vec2(pad, pad);
        for (index, pixels) in self.swatches.iter().enumerate() {
            let corner = corner + vec2(index as f32 * swatch, 0.0);
            for (place, colour) in pixels.iter().enumerate() {
                let Some([red, green, blue]) = *colour else { continue };
                let [column, row] = [place as u32 % SIDE, place as u32 / SIDE].map(|along| along as f32);
                let square = Rect::from_min_size(corner + vec2(column, row) * side, vec2(side, side));
                painter.rect_filled(square, 0.0, Color32::from_rgb(red, green, blue));
            }
            let middle = Rect::from_center_size(corner + vec2(0.5, 0.5) * swatch, vec2(side, side));
            for (width, colour) in [(3.0, Color32::BLACK), (1.5, Color32::WHITE)] {
                painter.rect_stroke(middle, 0.0, Stroke::new(width, colour), StrokeKind::Inside);
            }
        }
        let top = corner.y + swatch + pad;
        let text = |at: Pos2, anchor, size: f32, text: &str, colour| {
            let font = FontId::new(size * unit, FontFamily::Proportional);
            painter.text(at, anchor, text, font, colour);
        };
        let channels = [("R", colours.bad), ("G", colours.good), ("B", colours.accent)];
        for (channel, (name, colour)) in channels.into_iter().enumerate() {
            let y = top + row * (channel as f32 + 1.0);
            text(Pos2::new(corner.x, y), Align2::LEFT_TOP, 2.25, name, colour);
            for (index, (heading, values)) in self.columns.iter().enumerate() {
                let x = corner.x + width * (index as f32 + 1.0) / self.columns.len() as f32;
                text(Pos2::new(x, y), Align2::RIGHT_TOP, 2.25, &values[channel], colours.strong);
                if channel == 0 {
                    text(Pos2::new(x, top), Align2::RIGHT_TOP, 1.75, heading, colours.weak);
                }
            }
        }
    }
}

/// The pixel `at` with its neighbours; `colour` gives the colour of a pixel of the picture.
pub fn around([x, y]: [u32; 2], colour: impl Fn([u32; 2]) -> Option<[u8; 3]>) -> Vec<Option<[u8; 3]>> {
    let (reach, along) = (SIDE / 2, 0..SIDE);
    let places = along.clone().flat_map(|row| along.clone().map(move |column| [column, row]));
    places
        .map(|[column, row]| colour([(x + column).checked_sub(reach)?, (y + row).checked_sub(reach)?]))
        .collect()
}

/// The pixel in the middle of a swatch.
pub fn pixel(swatch: &[Option<[u8; 3]>]) -> Option<[u8; 3]> {
    swatch.get(swatch.len() / 2).copied().flatten()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::Presentation;
    use crate::app::tests::{dressed, facts_of};

    #[test]
    fn the_magnifier_tells_both_pictures_apart() {
        let picture = |[x, y]: [u32; 2]| (x < 9 && y < 9).then_some([x as u8, y as u8, 7]);
        let swatch = around([8, 1], picture);
        assert_eq!((pixel(&swatch), swatch[0], swatch[4]), (Some([8, 1, 7]), None, None));
        let two = Magnified::two(vec![], [174, 198, 9], [185, 190, 9]);
        assert_eq!(two.columns[2].1, ["+11", "\u{2212}8", "0"]);
    }

    #[test]
    fn the_keys_fade_and_the_window_sleeps() {
        let mut facts = facts_of("--stage metal --size 32x18");
        facts.model.presentation =
            Some(Presentation { was_full_screen: false, has_captions: true, is_blank: false });
        let draw = move |ui: &mut Ui, presenter: &mut Presenter| presenter.ui(ui, &facts);
        let mut harness = dressed([1280.0, 720.0]).build_ui_state(draw, Presenter::default());
        let sleep = |harness: &egui_kittest::Harness<'_, Presenter>| {
            harness.output().viewport_output[&egui::ViewportId::ROOT].repaint_delay.as_secs_f64()
        };
        for (age, least) in [(4.0, 0.9), (8.0, 3600.0)] {
            while harness.ctx.input(|input| input.time) < age {
                harness.step();
            }
            assert!(sleep(&harness) >= least, "after {age} s: {}", sleep(&harness));
        }
    }
}
