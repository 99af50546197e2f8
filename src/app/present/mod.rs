//! A presentation: large captions around the picture, progress along the bottom, and the pixel under the pointer.
//!
//! All sizes are shares of the window's height, so that a projector's resolution does not matter.

mod lens;
mod progress;
mod unit;

pub use lens::{Lens, Seen};

use super::command::Command;
use super::facts::Facts;
use super::theme;
use crate::stages::Stage;
use eframe::egui::{
    self, Align, Color32, Context, CursorIcon, FontFamily, FontId, Frame, Layout, Margin, Panel, RichText,
    Style, TextStyle, Ui, vec2,
};
use progress::Progress;
use unit::unit;

/// Seconds for which the keys are shown, and in which they fade.
const HELP_SECONDS: [f64; 2] = [8.0, 2.0];

/// Text sizes in hundredths of the height: the largest that has room is used.
const SIZES: [f32; 5] = [3.2, 2.9, 2.6, 2.3, 2.0];

/// Height of the texts below the picture, in hundredths of the height.
const TEXTS: f32 = 19.0;

/// The state of the display.
#[derive(Default)]
pub struct Presenter {
    /// When the presentation began, in egui's seconds.
    since: f64,
}

impl Presenter {
    /// Begins a presentation.
    pub fn begin(&mut self, context: &Context) {
        self.since = context.input(|input| input.time);
    }

    /// Draws everything except the picture, which gets the room that is left.
    pub fn ui(&self, ui: &mut Ui, facts: &Facts) {
        let unit = unit(ui.ctx());
        let has_captions = facts.model.presentation.is_some_and(|presentation| presentation.has_captions);
        let progress = Progress::of(facts);
        bottom("present progress", 0.7 * unit).show(ui, |ui| progress.bar(ui));
        if !has_captions {
            return;
        }
        let margin = Margin::symmetric(whole(3.0 * unit), 0);
        bottom("present keys", 4.4 * unit).frame(Frame::new().inner_margin(margin)).show(ui, |ui| {
            ui.horizontal_centered(|ui| {
                self.keys(ui, unit);
                ui.with_layout(Layout::right_to_left(Align::Center), |ui| progress.words(ui, 2.4 * unit));
            });
        });
        if let Some(texts) = texts(facts) {
            let frame = Frame::new().inner_margin(margin);
            bottom("present texts", TEXTS * unit).frame(frame).show(ui, |ui| columns(ui, unit, texts));
        }
        let frame = Frame::new().inner_margin(margin);
        Panel::top("present title")
            .exact_size(10.0 * unit)
            .show_separator_line(false)
            .frame(frame)
            .show(ui, |ui| ui.horizontal_centered(|ui| title(ui, unit, facts)));
    }

    /// The keys, for a while.
    fn keys(&self, ui: &mut Ui, unit: f32) {
        let [whole, fading] = HELP_SECONDS;
        let age = ui.input(|input| input.time) - self.since;
        let left = 1.0 - ((age - whole) / fading).clamp(0.0, 1.0);
        if left <= 0.0 {
            return;
        }
        let context = ui.ctx();
        if age < whole {
            context.request_repaint_after(std::time::Duration::from_secs_f64(whole - age));
        } else {
            context.request_repaint();
        }
        let named = [
            (Command::NextStage, "next"),
            (Command::PreviousStage, "back"),
            (Command::ShowMe, "show me"),
            (Command::Wipe, "wipe"),
            (Command::Blank, "blank"),
            (Command::Panels, "captions"),
        ];
        let keys = named.map(|(command, what)| {
            let keys = command.keys(context).unwrap_or_default();
            format!("{keys}: {what}")
        });
        let text = format!("{}   Escape: end", keys.join("   "));
        let colour = ui.visuals().weak_text_color().gamma_multiply(left as f32);
        ui.label(RichText::new(text).size(2.0 * unit).color(colour));
    }
}

fn whole(points: f32) -> i8 {
    points.round() as i8
}

fn bottom(name: &'static str, height: f32) -> Panel {
    Panel::bottom(name).exact_size(height).show_separator_line(false).frame(Frame::new())
}

/// Makes the words in the picture, such as the titles of a wipe, large enough.
pub fn enlarge(context: &Context, style: &mut Style) {
    let unit = unit(context);
    for (text, size) in [(TextStyle::Body, 2.6), (TextStyle::Small, 2.0)] {
        if let Some(font) = style.text_styles.get_mut(&text) {
            font.size = font.size.max(size * unit);
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
    let visuals = ui.visuals();
    let (strong, weak) = (visuals.strong_text_color(), visuals.weak_text_color());
    let stage = facts.document().stage();
    if let Some(stage) = stage {
        let section = RichText::new(stage.section).size(5.0 * unit).color(theme::accent(ui));
        ui.label(section);
        ui.add_space(1.5 * unit);
    }
    ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
        if let Some(stage) = stage {
            if let Some(place) = Stage::walk().position(|other| other == stage) {
                let place = format!("{} of {}", place + 1, Stage::walk().count());
                ui.label(RichText::new(place).size(2.6 * unit).color(weak));
            }
        }
        ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
            let document = facts.document();
            let changed = if document.has_changed_scene() { " (changed)" } else { "" };
            let title = stage.map_or_else(|| document.title(), |stage| format!("{}{changed}", stage.title));
            ui.add(egui::Label::new(RichText::new(title).size(5.0 * unit).color(strong)).truncate());
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
    let gap = 4.0 * unit;
    let width = 0.5 * (ui.available_width() - gap);
    let heading = 2.2 * unit;
    let room = ui.available_height() - 2.2 * heading - 0.5 * unit;
    let height = |text: &str, size: f32| {
        let font = FontId::new(size, FontFamily::Proportional);
        ui.painter().layout(text.to_owned(), font, Color32::WHITE, width).size().y
    };
    let fits = |size: &f32| texts.iter().all(|(_, text)| height(text, *size) <= room);
    let size = SIZES.map(|size| size * unit).into_iter().find(fits).unwrap_or(SIZES[4] * unit);
    ui.spacing_mut().item_spacing = vec2(gap, 0.2 * heading);
    ui.add_space(0.5 * heading);
    ui.horizontal_top(|ui| {
        for (name, text) in texts {
            ui.allocate_ui_with_layout(
                vec2(width, ui.available_height()),
                Layout::top_down(Align::Min),
                |ui| {
                    ui.set_width(width);
                    ui.label(RichText::new(name).size(heading).color(theme::accent(ui)));
                    let text = RichText::new(text).size(size).color(ui.visuals().strong_text_color());
                    ui.add(egui::Label::new(text).wrap());
                },
            );
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::app::model::presentation::Presentation;
    use crate::app::tests::{dressed, facts_of};

    use egui_kittest::Harness;

    #[derive(Default)]
    struct Screen {
        presenter: Presenter,
        facts: Option<Facts>,
    }

    /// A presentation of this picture.
    fn presented(words: &str, size: [f32; 2]) -> Harness<'static, Screen> {
        let mut facts = facts_of(words);
        facts.model.presentation =
            Some(Presentation { was_full_screen: false, has_captions: true, is_blank: false });
        let draw = |ui: &mut Ui, screen: &mut Screen| {
            if let Some(facts) = &screen.facts {
                screen.presenter.ui(ui, facts);
            }
        };
        let screen = Screen { facts: Some(facts), ..Screen::default() };
        dressed(size).build_ui_state(draw, screen)
    }

    #[test]
    fn the_window_sleeps_except_while_the_keys_fade() {
        let mut harness = presented("--stage metal --size 32x18", [1280.0, 720.0]);
        let context = harness.ctx.clone();
        harness.state_mut().presenter.begin(&context);
        let begin = context.input(|input| input.time);
        for (age, [least, most]) in [(4.0, [3.99, 4.01]), (8.5, [0.0, 0.0]), (11.0, [3600.0, f64::INFINITY])]
        {
            while context.input(|input| input.time) < begin + age {
                harness.step();
            }
            let sleep = harness.output().viewport_output[&egui::ViewportId::ROOT].repaint_delay.as_secs_f64();
            assert!((least..=most).contains(&sleep), "after {age} s: {sleep}");
        }
    }
}
