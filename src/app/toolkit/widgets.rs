//! Controls of the window: numbers, switches, lists, headers, signs and tooltips.

use super::theme;
use crate::app::commands::{Command, PanelContext};
use crate::measure::grouped;
use eframe::egui::collapsing_header::{CollapsingState, paint_default_icon};
use eframe::egui::{
    self, Align, Atom, Button, Color32, ComboBox, CornerRadius, DragValue, Id, IntoAtoms, Key, Label, Layout,
    Rect, RectAlign, Response, RichText, Role, Sense, Sides, Slider, SliderClamping, Stroke, StrokeKind,
    Tooltip, Ui, UiBuilder, Vec2, Widget, WidgetInfo, pos2, response::Flags, vec2,
};
use glam::DVec3;
use std::cell::Cell;
use std::ops::RangeInclusive;
use std::time::Duration;

/// Width of a field for a number, points.
pub const FIELD: f32 = 64.0;

/// Space between the controls of a group, points.
const SPACING: f32 = 8.0;

/// Height of a row of tabs, points.
pub const TABS: f32 = 40.0;

/// How long a number is red that cannot be, seconds.
const REFUSED: f64 = 3.0;

/// A control's name, its tooltip, and the reason if it is disabled.
#[derive(Clone, Copy)]
pub struct About<'a> {
    pub name: &'a str,
    pub help: &'a str,
    pub disabled_reason: Option<&'a str>,
}

impl<'a> About<'a> {
    pub fn new(name: &'a str, help: &'a str) -> Self {
        About { name, help, disabled_reason: None }
    }

    pub fn disabled_if(self, reason: Option<&'a str>) -> Self {
        About { disabled_reason: reason, ..self }
    }
}

/// Gives a widget a name for assistive technology, and for [`focus`].
pub fn named(response: &Response, name: &str) {
    response.ctx.accesskit_node_builder(response.id, |node| node.set_label(name));
    take_focus(response, name);
}

/// Focuses the widget if [`focus`] wants it. Returns whether it does.
fn take_focus(response: &Response, name: &str) -> bool {
    let wanted: Option<String> = response.ctx.data(|data| data.get_temp(wanted()));
    let is_wanted = wanted.as_deref() == Some(name);
    if is_wanted {
        response.ctx.data_mut(|data| data.remove::<String>(self::wanted()));
        response.scroll_to_me(None);
        response.request_focus();
    }
    is_wanted
}

/// Gives the keyboard focus to the first widget of this name that is drawn next.
pub fn focus(context: &egui::Context, name: &str) {
    context.data_mut(|data| data.insert_temp(wanted(), name.to_owned()));
}

fn wanted() -> Id {
    Id::unique("widget to focus")
}

/// Adds a tooltip, which ends with the reason if the control is disabled. In a column it stands beside that, so that it
/// doesn't cover the next control.
pub fn tip(ui: &Ui, response: Response, help: &str, disabled_reason: Option<&str>) -> Response {
    let reason = disabled_reason.filter(|_| !response.enabled());
    let text = [Some(help), reason].into_iter().flatten().filter(|part| !part.is_empty());
    let text = text.collect::<Vec<_>>().join("\n\n");
    let is_held = response.ctx.input(|input| input.pointer.any_down());
    // A dialog may have opened above it.
    let is_reached = response.ctx.memory(|memory| memory.allows_interaction(response.layer_id));
    if !text.is_empty() && !is_held && is_reached && Tooltip::should_show_tooltip(&response, true) {
        show_tip(ui, &response, &text);
    }
    response
}

fn show_tip(ui: &Ui, response: &Response, text: &str) {
    const BESIDE: [RectAlign; 4] =
        [RectAlign::RIGHT_START, RectAlign::LEFT_START, RectAlign::RIGHT_END, RectAlign::LEFT_END];
    /// Anything narrower is a column, points.
    const COLUMN: f32 = 450.0;
    let (clip, mut tooltip) = (ui.clip_rect(), Tooltip::for_widget(response));
    if ui.layout().horizontal_justify() || clip.width() < COLUMN {
        let around = Rect::from_x_y_ranges(clip.x_range(), response.rect.y_range());
        // As wide as there is room beside it.
        let screen = ui.ctx().content_rect();
        let room = (screen.right() - around.right()).max(around.left() - screen.left()) - 32.0;
        tooltip.popup = tooltip.popup.anchor(around).align(BESIDE[0]).align_alternatives(&BESIDE).gap(8.0);
        tooltip.popup = tooltip.popup.width(room.clamp(120.0, ui.spacing().tooltip_width));
    }
    tooltip.show(|ui| ui.label(text));
}

/// A label at the left and a control at the right edge.
pub fn row<R>(ui: &mut Ui, about: About<'_>, add: impl FnOnce(&mut Ui) -> R) -> R {
    ui.add_enabled_ui(about.disabled_reason.is_none(), |ui| {
        let sides = Sides::new().height(ui.spacing().interact_size.y).shrink_left().truncate();
        let (label, added) = sides.show(ui, |ui| ui.label(about.name), add);
        tip(ui, label, about.help, about.disabled_reason);
        added
    })
    .inner
}

/// A small label above a control.
pub fn above(ui: &mut Ui, about: About<'_>) {
    ui.spacing_mut().item_spacing.y = 4.0;
    let color = ui.visuals().weak_text_color();
    let label = ui.add_enabled(
        about.disabled_reason.is_none(),
        Label::new(RichText::new(about.name).small().color(color)),
    );
    tip(ui, label, about.help, about.disabled_reason);
}

/// Small weak text.
pub fn small(ui: &mut Ui, text: impl Into<String>) -> Response {
    let text = RichText::new(text).small().color(ui.visuals().weak_text_color());
    ui.add(Label::new(text).wrap())
}

/// A small heading between rows of a list.
pub fn caption(ui: &mut Ui, text: &str) {
    ui.add_space(8.0);
    small(ui, text);
    ui.add_space(4.0);
}

/// A weak sentence that wraps.
pub fn hint(ui: &mut Ui, text: &str) -> Response {
    let text = RichText::new(text).color(ui.visuals().weak_text_color()).line_height(Some(20.0));
    ui.add(Label::new(text).wrap())
}

/// The button to press next. There is at most one in the window.
pub fn primary(text: impl Into<String>) -> impl Widget {
    move |ui: &mut Ui| {
        let colours = theme::colours(ui);
        let text = RichText::new(text).color(colours.on_accent);
        ui.add(Button::new(text).fill(colours.accent))
    }
}

/// A button for a command, under this name.
pub fn command_button(ui: &mut Ui, cx: &PanelContext, command: Command, name: &str) {
    add_command(ui, cx, command, Button::new(name));
}

/// A control for a command, with its help and keys as tooltip.
pub fn add_command(ui: &mut Ui, cx: &PanelContext, command: Command, control: impl Widget) -> Response {
    let reason = cx.disabled_reason(command);
    let response = ui.add_enabled(reason.is_none(), control);
    let response = tip(ui, response, &with_keys(ui, command.help(), command), reason.as_deref());
    if response.clicked() {
        cx.send(command);
    }
    response
}

/// Buttons of commands, at most one of them on, each at least `width` wide.
pub fn command_switch(ui: &mut Ui, cx: &PanelContext, width: f32, named: &[(&str, Command)]) {
    let words = |(_, command): &(&str, Command)| {
        (with_keys(ui, command.help(), *command), cx.disabled_reason(*command))
    };
    let words: Vec<_> = named.iter().map(words).collect();
    let options = named.iter().zip(&words).map(|((name, command), (help, reason))| {
        (Some(*command), About::new(name, help).disabled_if(reason.as_deref()))
    });
    let on = named.iter().map(|(_, command)| *command).find(|command| cx.is_on(*command));
    if let Some(Some(command)) = switch(ui, width, on, &options.collect::<Vec<_>>()) {
        cx.send(command);
    }
}

/// A help with the keys of a command.
pub fn with_keys(ui: &Ui, help: &str, command: Command) -> String {
    match command.keys(ui.ctx()) {
        Some(keys) => format!("{help} ({keys})"),
        None => help.to_owned(),
    }
}

/// A button that is tinted while it is on.
pub fn choice<'a>(ui: &Ui, is_on: bool, content: impl IntoAtoms<'a>) -> Button<'a> {
    // Both are equally large.
    let colour = if is_on { theme::colours(ui).accent } else { Color32::TRANSPARENT };
    Button::new(content).selected(is_on).stroke(Stroke::new(1.0, colour))
}

/// Buttons side by side, exactly one of them on, each at least `width` wide. Returns the one that was clicked.
pub fn switch<T: PartialEq + Copy>(
    ui: &mut Ui,
    width: f32,
    chosen: T,
    options: &[(T, About<'_>)],
) -> Option<T> {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 0.0;
        let mut clicked = None;
        let mut order: Vec<_> = options.iter().enumerate().collect();
        // At the right of a row, what is drawn first is the last one.
        if ui.layout().prefer_right_to_left() {
            order.reverse();
        }
        for (index, (value, about)) in order {
            let (left, right) = (u8::from(index == 0) * 4, u8::from(index + 1 == options.len()) * 4);
            let corners = CornerRadius { nw: left, sw: left, ne: right, se: right };
            let is_on = *value == chosen;
            let button = choice(ui, is_on, about.name).corner_radius(corners).min_size(vec2(width, 0.0));
            let response = ui.add_enabled(about.disabled_reason.is_none(), button);
            let is_enabled = response.enabled();
            response.widget_info(|| WidgetInfo::selected(Role::RadioButton, is_enabled, is_on, about.name));
            if tip(ui, response, about.help, about.disabled_reason).clicked() {
                clicked = Some(*value);
            }
        }
        clicked
    })
    .inner
}

/// A list that opens under its name's row; `entries` are drawn with [`entry`].
pub fn list(ui: &mut Ui, about: About<'_>, shown: &str, entries: impl FnOnce(&mut Ui)) -> Response {
    row(ui, about, |ui| {
        // Long words are cut, and not the name.
        ui.set_max_width(ui.spacing().combo_width);
        let combo = ComboBox::from_id_salt(about.name).width(ui.spacing().combo_width).truncate();
        let response = combo.selected_text(shown).show_ui(ui, entries).response;
        named(&response, about.name);
        tip(ui, response, about.help, about.disabled_reason)
    })
}

/// An entry of a [`list`]. Returns whether it was chosen, which closes the list.
pub fn entry(ui: &mut Ui, is_on: bool, about: About<'_>) -> bool {
    let response = ui.add_enabled(about.disabled_reason.is_none(), Button::selectable(is_on, about.name));
    let is_chosen = tip(ui, response, about.help, about.disabled_reason).clicked();
    if is_chosen {
        ui.close();
    }
    is_chosen
}

/// A check box.
pub fn check(ui: &mut Ui, about: About<'_>, value: &mut bool) -> Response {
    let response = ui.add_enabled(about.disabled_reason.is_none(), egui::Checkbox::new(value, about.name));
    tip(ui, response, about.help, about.disabled_reason)
}

/// A number to type or drag.
pub struct Number<'a> {
    about: About<'a>,
    limits: RangeInclusive<f64>,
    prefix: &'a str,
    suffix: &'a str,
    speed: Option<f64>,
    /// The largest of the numbers that it belongs to: beside that, rounding noise is 0.
    scale: f64,
    is_whole: bool,
}

impl<'a> Number<'a> {
    pub fn new(about: About<'a>, limits: RangeInclusive<f64>) -> Self {
        Number { about, limits, prefix: "", suffix: "", speed: None, scale: 0.0, is_whole: false }
    }

    /// The letter before the number.
    fn letter(self, prefix: &'a str) -> Self {
        Number { prefix, ..self }
    }

    /// The unit after the number.
    pub fn unit(self, suffix: &'a str) -> Self {
        Number { suffix, ..self }
    }

    /// Change for each point that the pointer is dragged; else it depends on the number.
    pub fn speed(self, speed: f64) -> Self {
        Number { speed: Some(speed), ..self }
    }

    pub fn whole(self) -> Self {
        Number { is_whole: true, ..self }
    }

    /// The field alone. A typed number beyond a limit changes nothing: the field is red then, and tells the limits.
    pub fn field(&self, ui: &mut Ui, width: f32, value: &mut f64) -> Response {
        let (before, mut shown, is_refused) = (*value, *value, Cell::new(false));
        // The shown text stands for the exact number, although it has fewer digits.
        let parse = |text: &str| {
            let text: String = text.chars().filter(|c| !c.is_whitespace()).collect();
            if text == self.text(before) {
                return Some(before);
            }
            let number = text.replace('\u{2212}', "-").trim_end_matches(self.suffix.trim()).parse().ok();
            let number = number.filter(|number| self.limits.contains(number));
            is_refused.set(number.is_none());
            number
        };
        let speed = self.speed.unwrap_or(0.01 * before.abs().max(0.1));
        let drag = DragValue::new(&mut shown)
            .speed(if self.is_whole { speed.max(0.1) } else { speed })
            .range(self.limits.clone())
            .clamp_existing_to_range(false)
            .update_while_editing(false)
            .custom_formatter(|n, _| self.text(n))
            .custom_parser(parse)
            .prefix(self.prefix)
            .suffix(self.suffix)
            .clip_text(true);
        let added = ui.add_enabled_ui(self.about.disabled_reason.is_none(), |ui| {
            ui.spacing_mut().button_padding.x = 4.0;
            ui.add_sized([width, ui.spacing().interact_size.y], drag)
        });
        let mut response = added.inner;
        named(&response, self.about.name);
        // The field takes the text of an edit that Escape ended for one in the frame after that.
        let is_cancelled = ui.input(|input| input.key_pressed(Key::Escape)) && response.lost_focus();
        let place = response.id.with("cancelled");
        let was_cancelled = ui.data_mut(|data| data.get_temp(place).unwrap_or(false));
        ui.data_mut(|data| data.insert_temp(place, is_cancelled));
        if shown.is_finite() && !was_cancelled {
            *value = if self.is_whole { shown.round() } else { shown };
        }
        response.flags.set(Flags::CHANGED, *value != before);
        let (place, now) = (response.id.with("refused"), ui.input(|input| input.time));
        if is_refused.get() && !was_cancelled {
            ui.data_mut(|data| data.insert_temp(place, now));
        }
        let left = ui.data(|data| data.get_temp(place)).map_or(0.0, |since: f64| since + REFUSED - now);
        if left > 0.0 && !ui.input(|input| input.pointer.any_down()) {
            let stroke = Stroke::new(1.5, theme::colours(ui).bad);
            ui.painter().rect_stroke(response.rect, 4, stroke, StrokeKind::Inside);
            let [least, most] = [self.limits.start(), self.limits.end()].map(|limit| self.text(*limit));
            show_tip(ui, &response, &format!("From {least} to {most}"));
            ui.ctx().request_repaint_after(Duration::from_secs_f64(left));
            return response;
        }
        tip(ui, response, self.about.help, self.about.disabled_reason)
    }

    /// The field alone, for a whole number.
    pub fn whole_field(self, ui: &mut Ui, width: f32, value: &mut u32) -> Response {
        let mut number = f64::from(*value);
        let response = Number { is_whole: true, ..self }.field(ui, width, &mut number);
        *value = number as u32;
        response
    }

    /// A label at the left and the field at the right.
    pub fn row(&self, ui: &mut Ui, value: &mut f64) -> Response {
        row(ui, self.about, |ui| self.field(ui, FIELD, value))
    }

    /// A row with a slider under it, which covers the usual values `track`.
    pub fn slider(
        &self,
        ui: &mut Ui,
        value: &mut f64,
        track: RangeInclusive<f64>,
        is_logarithmic: bool,
    ) -> Response {
        let response = ui
            .scope(|ui| {
                ui.spacing_mut().item_spacing.y = 0.0;
                let typed = self.row(ui, value);
                let accent = theme::colours(ui).accent;
                ui.visuals_mut().selection.bg_fill = accent;
                ui.spacing_mut().interact_size.y = 20.0;
                ui.spacing_mut().slider_width = ui.available_width();
                let (least, most, before) = (*track.start(), *track.end(), *value);
                let slider = Slider::new(value, track)
                    .show_value(false)
                    .clamping(SliderClamping::Edits)
                    .logarithmic(is_logarithmic)
                    .smallest_positive(most / 100.0);
                let slid = ui.add_enabled(self.about.disabled_reason.is_none(), slider);
                if *value != before {
                    // Assistive technology knows no limits.
                    *value = if value.is_nan() { before } else { value.clamp(least, most) };
                }
                named(&slid, self.about.name);
                typed.union(tip(ui, slid, self.about.help, self.about.disabled_reason))
            })
            .inner;
        ui.add_space(4.0);
        response
    }

    fn text(&self, n: f64) -> String {
        let scale = self.scale.max(n.abs());
        if self.is_whole {
            return with_minus(&format!("{n:.0}"));
        }
        // Three fields side by side have room for six characters.
        let text = compact(rounded(n, scale, 5));
        let is_long = !self.prefix.is_empty() && text.chars().count() > 6;
        if is_long { compact(rounded(n, scale, 4)) } else { text }
    }
}

/// Three coordinates under their name, each within `limits`.
pub fn vector(ui: &mut Ui, about: About<'_>, value: &mut DVec3, limits: RangeInclusive<f64>, speed: f64) {
    ui.scope(|ui| {
        above(ui, about);
        ui.horizontal(|ui| {
            let width = ((ui.available_width() - 16.0) / 3.0).floor();
            let scale = value.abs().max_element();
            for (component, letter) in ["x ", "y ", "z "].into_iter().enumerate() {
                let name = format!("{}, {}", about.name, letter.trim());
                let about = About { name: &name, ..about };
                let number =
                    Number { scale, ..Number::new(about, limits.clone()).speed(speed).letter(letter) };
                number.field(ui, width, &mut value[component]);
            }
        });
    });
}

/// The bytes of a colour as the picture shows it in white light.
pub fn shown_albedo(albedo: DVec3) -> [u8; 3] {
    albedo.to_array().map(|n| (255.0 * n.clamp(0.0, 1.0).sqrt()).round() as u8)
}

/// A colour to pick.
pub fn colour(ui: &mut Ui, about: About<'_>, albedo: &mut DVec3) {
    let shown = shown_albedo(*albedo);
    row(ui, about, |ui| {
        ui.spacing_mut().interact_size.x = FIELD;
        let mut picked = shown;
        let response = ui.color_edit_button_srgb(&mut picked);
        named(&response, about.name);
        tip(ui, response, about.help, about.disabled_reason);
        for component in (0..3).filter(|component| picked[*component] != shown[*component]) {
            let light = (f64::from(picked[component]) / 255.0).powi(2);
            albedo[component] = (light * 1e4).round() / 1e4;
        }
    });
}

/// Formats a number in few characters.
pub fn compact(n: f64) -> String {
    let magnitude = n.abs();
    if magnitude == 0.0 {
        return "0".to_owned();
    }
    let exponent = magnitude.log10().floor();
    let trimmed = |text: &str| match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text.to_owned(),
    };
    if !(1e-6..1e7).contains(&magnitude) {
        let text = format!("{n:.2e}");
        let (mantissa, power) = text.split_once('e').unwrap_or((&text, "0"));
        return with_minus(&format!("{}e{power}", trimmed(mantissa)));
    }
    let decimals = if exponent < -2.0 { 2.0 - exponent } else { (4.0 - exponent).clamp(0.0, 4.0) };
    with_minus(&trimmed(&format!("{n:.*}", decimals as usize)))
}

fn with_minus(text: &str) -> String {
    text.replace('-', "\u{2212}")
}

/// A number rounded to `digits` digits of `scale`.
pub fn rounded(n: f64, scale: f64, digits: i32) -> f64 {
    let step = 10_f64.powi(scale.log10().floor().clamp(-300.0, 300.0) as i32 + 1 - digits);
    let rounded = (n / step).round() * step;
    if rounded.is_finite() { rounded } else { n }
}

/// A number of samples, in words.
pub fn samples_words(count: u64) -> String {
    format!("{} sample{} per pixel", grouped(count), if count == 1 { "" } else { "s" })
}

/// A point in few characters, as in `13, 2, 3`.
pub fn point_words(point: DVec3) -> String {
    let scale = point.abs().max_element();
    point.to_array().map(|n| compact(rounded(n, scale, 3))).join(", ")
}

/// The parts of a group's header.
#[derive(Clone, Copy, Default)]
pub struct Header<'a> {
    pub title: &'a str,
    /// The group's values, shown while it is folded and as they were.
    pub summary: &'a str,
    /// The name of the button that resets the group, if something in it was changed.
    pub reset: Option<&'a str>,
    /// It belongs to the group above.
    pub is_minor: bool,
}

/// A group of controls that is always open. Returns whether the button that resets it was clicked.
pub fn group(ui: &mut Ui, header: Header<'_>, body: impl FnOnce(&mut Ui)) -> bool {
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), 32.0), Sense::hover());
        let is_reset = header_row(ui, rect, header, true);
        ui.spacing_mut().item_spacing.y = SPACING;
        ui.scope(body);
        is_reset
    })
    .inner
}

/// A group of controls that folds when its header is clicked. Returns whether the button that resets it was clicked.
pub fn fold(ui: &mut Ui, header: Header<'_>, is_open: bool, body: impl FnOnce(&mut Ui)) -> bool {
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        let id = ui.make_persistent_id(header.title);
        let mut state = CollapsingState::load_with_default_open(ui.ctx(), id, is_open);
        let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 32.0), Sense::click());
        let words = if state.is_open() { "open" } else { "folded" };
        let name = format!("{}, {words}", header.title);
        response.widget_info(|| WidgetInfo::labeled(Role::DisclosureTriangle, true, &name));
        if take_focus(&response, header.title) {
            state.set_open(true);
        } else if response.clicked() {
            state.toggle(ui);
        }
        let icon = Rect::from_center_size(pos2(rect.left() + 4.0, rect.center().y), vec2(10.0, 10.0));
        paint_default_icon(ui, state.openness(ui.ctx()), &response.clone().with_new_rect(icon));
        let is_reset = header_row(ui, rect.with_min_x(rect.left() + 16.0), header, state.is_open());
        ui.spacing_mut().item_spacing.y = SPACING;
        state.show_body_unindented(ui, |ui| {
            body(ui);
            ui.add_space(4.0);
        });
        is_reset
    })
    .inner
}

fn header_row(ui: &mut Ui, rect: Rect, header: Header<'_>, is_open: bool) -> bool {
    let mut is_reset = false;
    let mut row = ui.new_child(UiBuilder::new().max_rect(rect).layout(Layout::left_to_right(Align::Center)));
    row.spacing_mut().item_spacing.x = 4.0;
    Sides::new().height(rect.height()).spacing(4.0).shrink_left().truncate().show(
        &mut row,
        |ui| {
            let title = RichText::new(header.title);
            ui.label(if header.is_minor { title } else { title.strong() })
        },
        |ui| {
            if let Some(name) = header.reset {
                let response = ui.link(RichText::new("Reset").small());
                named(&response, name);
                is_reset = tip(ui, response, "Back to the stage\u{2019}s own values", None).clicked();
            }
            if !is_open && !header.summary.is_empty() && header.reset.is_none() {
                small(ui, header.summary);
            }
        },
    );
    is_reset
}

/// A tab of a panel or of the dock.
pub fn tab(ui: &mut Ui, name: &str, is_on: bool) -> Response {
    let colours = theme::colours(ui);
    let text = RichText::new(name).color(if is_on { colours.strong } else { colours.weak });
    ui.scope(|ui| {
        ui.spacing_mut().button_padding.x = 0.0;
        let response = ui.add(Button::new(text).frame(false).min_size(vec2(0.0, TABS)));
        response.widget_info(|| WidgetInfo::selected(Role::Tab, true, is_on, name));
        take_focus(&response, name);
        if is_on {
            let line = response.rect.x_range().expand(8.0);
            ui.painter().hline(line, response.rect.bottom() - 1.0, Stroke::new(2.0, colours.accent));
        }
        response
    })
    .inner
}

/// A line over the whole width of a panel.
pub fn panel_line(ui: &mut Ui) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), 0.0), Sense::hover());
    ui.painter().hline(
        ui.clip_rect().x_range(),
        rect.center().y,
        ui.visuals().widgets.noninteractive.bg_stroke,
    );
}

/// A button without a frame that shows a sign of the font. `name` is for assistive technology.
pub fn sign_button(ui: &mut Ui, sign: &str, size: f32, name: &str) -> Response {
    let text = RichText::new(sign).size(0.75 * size);
    let button = Button::new((Atom::grow(), text, Atom::grow())).frame_when_inactive(false).gap(0.0);
    let added = ui.scope(|ui| {
        ui.spacing_mut().button_padding = Vec2::ZERO;
        ui.add_sized([size, size], button)
    });
    named(&added.inner, name);
    added.inner
}

/// An entry of a legend.
pub fn swatch(ui: &mut Ui, colour: Color32, name: &str) {
    let (rect, _) = ui.allocate_exact_size(vec2(10.0, 10.0), Sense::hover());
    ui.painter().rect_filled(rect, 2, colour);
    ui.add(Label::new(RichText::new(name).small().color(ui.visuals().weak_text_color())).extend());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_free_of_noise() {
        for (number, expected) in [
            (0.0, "0"),
            (-0.0, "0"),
            (-1.2, "−1.2"),
            (-100.25, "−100.25"),
            (0.1 + 0.2, "0.3"),
            (-5e-4, "−0.0005"),
            (100_000.0, "100000"),
            (-2.5e-12, "−2.5e−12"),
            (1e18, "1e18"),
        ] {
            assert_eq!(compact(number), expected);
        }
        assert_eq!(point_words(DVec3::new(12.974, 2.08e-17, -3.0)), "13, 0, −3");
        assert_eq!(point_words(DVec3::ZERO), "0, 0, 0");
        assert_eq!([1, 2].map(samples_words), ["1 sample per pixel", "2 samples per pixel"]);
        let number = Number::new(About::new("", ""), -9.0..=9.0);
        assert_eq!([-0.695_65, 2.087_12].map(|n| number.text(n)), ["−0.6957", "2.0871"]);
        let beside = Number { scale: 2.0, ..number.letter("x ") };
        assert_eq!([-0.695_65, 2.087_12].map(|n| beside.text(n)), ["−0.696", "2.0871"]);
    }
}
