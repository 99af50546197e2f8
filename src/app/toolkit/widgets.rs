//! Controls of the window: switches, lists, headers, signs and tooltips.

use super::theme;
use crate::app::commands::{Command, PanelContext};
use eframe::egui::collapsing_header::{CollapsingState, paint_default_icon};
use eframe::egui::{
    self, Align, Atom, Button, Color32, ComboBox, CornerRadius, Id, IntoAtoms, Label, Layout, Rect,
    RectAlign, Response, RichText, Role, Sense, Sides, Stroke, Tooltip, Ui, UiBuilder, Vec2, Widget,
    WidgetInfo, pos2, vec2,
};

/// Width of a field for a number, points.
pub const FIELD: f32 = 64.0;

/// Space between the controls of a group, points.
const SPACING: f32 = 8.0;

/// Height of a row of tabs, points.
const TABS: f32 = 40.0;

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

pub fn show_tip(ui: &Ui, response: &Response, text: &str) {
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

/// A group of controls that folds when its header is clicked. The header has the group's values at the right.
pub fn fold(ui: &mut Ui, [title, summary]: [&str; 2], is_open: bool, body: impl FnOnce(&mut Ui)) {
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.y = 0.0;
        let id = ui.make_persistent_id((title, is_open));
        let mut state = CollapsingState::load_with_default_open(ui.ctx(), id, is_open);
        let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 32.0), Sense::click());
        let words = if state.is_open() { "open" } else { "folded" };
        let name = format!("{title}, {words}");
        response.widget_info(|| WidgetInfo::labeled(Role::DisclosureTriangle, true, &name));
        if take_focus(&response, title) {
            state.set_open(true);
        } else if response.clicked() {
            state.toggle(ui);
        }
        let icon = Rect::from_center_size(pos2(rect.left() + 4.0, rect.center().y), vec2(10.0, 10.0));
        paint_default_icon(ui, state.openness(ui.ctx()), &response.clone().with_new_rect(icon));
        let header = UiBuilder::new().max_rect(rect.with_min_x(rect.left() + 16.0));
        let mut header = ui.new_child(header.layout(Layout::left_to_right(Align::Center)));
        let sides = Sides::new().height(rect.height()).spacing(4.0).shrink_left().truncate();
        sides.show(&mut header, |ui| ui.label(RichText::new(title).strong()), |ui| small(ui, summary));
        ui.spacing_mut().item_spacing.y = SPACING;
        state.show_body_unindented(ui, |ui| {
            body(ui);
            ui.add_space(4.0);
        });
    });
}

/// A row of tabs over a line, with something at its right end. Returns the one to show from now on.
pub fn tabs<T: Copy + PartialEq>(
    ui: &mut Ui,
    tabs: &[(T, &str)],
    shown: T,
    right: impl FnOnce(&mut Ui),
) -> T {
    ui.spacing_mut().item_spacing.y = 0.0;
    let mut chosen = shown;
    let left = |ui: &mut Ui| {
        ui.spacing_mut().item_spacing.x = 16.0;
        for (each, name) in tabs {
            if tab(ui, name, *each == shown).clicked() {
                chosen = *each;
            }
        }
    };
    egui::Frame::new().inner_margin(egui::Margin::symmetric(16, 0)).show(ui, |ui| {
        Sides::new().height(TABS).shrink_left().show(ui, left, right);
    });
    panel_line(ui);
    chosen
}

fn tab(ui: &mut Ui, name: &str, is_on: bool) -> Response {
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
