//! A presentation: large captions around the picture, and progress along the bottom.
//!
//! All sizes are shares of the window's height, so that a projector's resolution does not matter.

use super::status;
use crate::app::commands::{Command, PanelContext, Snapshot};
use crate::app::toolkit::theme;
use crate::progressive::Phase;
use crate::stages::Stage;
use eframe::egui::{
    self, Align, Color32, Context, CursorIcon, FontFamily, FontId, Frame, Label, Layout, Margin, Panel, Rect,
    RichText, Role, Sense, Sides, Style, TextStyle, Ui, UiBuilder, WidgetInfo, vec2,
};

/// Text sizes in hundredths of the height: the largest that has room is used.
const SIZES: [f32; 5] = [2.75, 2.5, 2.25, 2.0, 1.75];

/// From the edges of the screen, in hundredths of the height.
const MARGIN: f32 = 4.0;

/// A hundredth of the window's height; less if the window is narrower than a 4:3 screen.
fn unit(context: &Context) -> f32 {
    let size = context.content_rect().size();
    (size.y / 100.0).min(size.x / 133.0).max(1.0)
}

/// Draws everything except the picture, which gets the room that is left. With captions, the numbers of the pixel under the
/// pointer stand in place of a text.
pub fn ui(ui: &mut Ui, cx: &PanelContext, numbers: Option<impl FnOnce(&mut Ui)>) {
    let unit = unit(ui.ctx());
    let words = status::sentence(cx);
    let is_done = matches!(cx.status.phase, Phase::Done(_)) && !cx.is_held;
    let share = if is_done { 1.0 } else { status::share(cx).unwrap_or(0.0) as f32 };
    bottom("present progress", 0.5 * unit, 0.0).show(ui, |ui| {
        let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::hover());
        response.widget_info(|| WidgetInfo::labeled(Role::ProgressIndicator, true, &words));
        let done = Rect::from_min_size(rect.min, vec2(rect.width() * share, rect.height()));
        ui.painter().rect_filled(rect, 0.0, theme::colours(ui).raised);
        ui.painter().rect_filled(done, 0.0, theme::colours(ui).accent);
    });
    if !cx.model.presentation.is_some_and(|presentation| presentation.has_captions) {
        return;
    }
    let margin = MARGIN * unit;
    bottom("present keys", 4.0 * unit, margin).show(ui, |ui| {
        ui.horizontal_centered(|ui| {
            keys(ui, unit, cx);
            let words = RichText::new(&words).size(1.75 * unit).color(theme::colours(ui).weak);
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| ui.label(words));
        });
    });
    bottom("present texts", 19.0 * unit, margin).show(ui, |ui| {
        // Whatever stands there, the picture keeps its room.
        let room = ui.available_rect_before_wrap();
        ui.allocate_rect(room, Sense::hover());
        columns(
            &mut ui.new_child(UiBuilder::new().max_rect(room)),
            unit,
            texts(cx),
            (numbers, cx.model.view.mode().is_some()),
        );
    });
    let title_bar = Panel::top("present title").exact_size(9.0 * unit).show_separator_line(false);
    title_bar.frame(frame(margin)).show(ui, |ui| ui.horizontal_centered(|ui| title(ui, unit, cx)));
}

/// The keys of a presentation.
fn keys(ui: &mut Ui, unit: f32, cx: &PanelContext) {
    let named = [
        (Command::NextStage, "next"),
        (Command::ShowMe, "show me"),
        (Command::Wipe, "wipe"),
        (Command::Blank, "blank"),
        (Command::Panels, "captions"),
    ];
    let is_stage = cx.document().stage().is_some();
    let is_of_use =
        |command| cx.disabled_reason(command).is_none() && (is_stage || command != Command::NextStage);
    let named = named.into_iter().filter(|(command, _)| is_of_use(*command));
    let key = |command: Command| command.keys(ui.ctx()).unwrap_or_default();
    let keys = named.map(|(command, what)| format!("{} {what}    ", key(command)));
    let text = format!("{}Escape ends", keys.collect::<String>());
    ui.label(RichText::new(text).size(1.75 * unit).color(theme::colours(ui).weak));
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

fn title(ui: &mut Ui, unit: f32, snapshot: &Snapshot) {
    let (colours, stage) = (theme::colours(ui), snapshot.document().stage());
    let place = |stage: &Stage| {
        let place = Stage::walk().take_while(|other| other.index() <= stage.index()).count();
        format!("{place} of {}", Stage::walk().count())
    };
    let left = |ui: &mut Ui| {
        let mut title = snapshot.document().title();
        if let Some(stage) = stage {
            ui.label(RichText::new(stage.section).size(4.5 * unit).color(colours.accent));
            ui.add_space(unit);
            let changed = if snapshot.document().has_changed_scene() { ", changed" } else { "" };
            title = format!("{}{changed}", stage.title);
        }
        ui.add(Label::new(RichText::new(title).size(4.5 * unit).color(colours.strong)).truncate());
    };
    let right = |ui: &mut Ui| {
        let place = stage.map(place).unwrap_or_default();
        ui.label(RichText::new(place).size(2.25 * unit).color(colours.weak));
    };
    Sides::new().height(ui.available_height()).shrink_left().show(ui, left, right);
}

/// The headings and texts below the picture; none of a scene of one's own.
fn texts(snapshot: &Snapshot) -> [(&'static str, &'static str); 2] {
    let (stage, case) = (snapshot.document().stage(), snapshot.document().case());
    let watched = case.map(|case| (case.family.title.as_str(), case.claim.look_for.as_str()));
    match (stage, watched) {
        (Some(stage), _) => {
            let look_for = if snapshot.has_sight { stage.sight.caption } else { stage.look_for };
            [("What is new", stage.what_is_new), ("Look for", look_for)]
        }
        (None, Some((title, look_for))) => [("What is difficult", title), ("Look for", look_for)],
        (None, None) => [("", ""); 2],
    }
}

/// Two texts side by side, as large as both have room.
fn columns(
    ui: &mut Ui,
    unit: f32,
    texts: [(&str, &str); 2],
    (mut numbers, is_compared): (Option<impl FnOnce(&mut Ui)>, bool),
) {
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
    ui.add_space(0.5 * heading);
    let rows = ui.available_height();
    ui.horizontal_top(|ui| {
        for (place, (name, text)) in texts.into_iter().enumerate() {
            ui.vertical(|ui| {
                ui.set_width(width);
                if let Some(numbers) = numbers.take_if(|_| place == 1) {
                    enlarge(&ui.ctx().clone(), ui.style_mut());
                    // Under their header, three or five rows of a line and a third have room.
                    let count = if is_compared { 5.0 } else { 3.0 };
                    let most = (rows - 28.0) / (count * 4.0 / 3.0);
                    let small = ui.style_mut().text_styles.get_mut(&TextStyle::Small);
                    small.into_iter().for_each(|font| font.size = font.size.min(most));
                    let width = width.min(28.0 * TextStyle::Small.resolve(ui.style()).size);
                    return ui.allocate_ui(vec2(width, rows), numbers).inner;
                }
                ui.label(RichText::new(name).size(heading).color(theme::colours(ui).accent));
                ui.add(Label::new(RichText::new(text).size(size).color(theme::colours(ui).strong)).wrap());
            });
        }
    });
}
