//! Colours, fonts and distances: subdued greys, and one accent colour, the blue of the book's sky.

use super::model::remembered::Theme;
use eframe::egui::style::{HandleShape, ScrollStyle, Spacing};
use eframe::egui::{
    self, Color32, Context, CornerRadius, FontId, Frame, Margin, Shadow, Stroke, Style, TextStyle, Ui,
    Visuals, vec2,
};
use std::sync::Arc;

/// The colours of one theme. Letters on `tint` are `text` or `strong`.
pub struct Colours {
    /// Panels, menus, cards, dialogs.
    pub panel: Color32,
    /// Around the picture, and behind plots.
    pub surround: Color32,
    /// Behind what is typed, and behind code.
    pub well: Color32,
    /// Buttons, fields, rails.
    pub raised: Color32,
    /// Under the pointer; open menus.
    pub hovered: Color32,
    /// While pressed.
    pub pressed: Color32,
    /// Separators, edges of cards.
    pub line: Color32,
    /// Rings and handles; never letters.
    pub edge: Color32,
    /// What is on or chosen.
    pub tint: Color32,
    /// Labels, hints, keys.
    pub weak: Color32,
    pub text: Color32,
    /// Titles, values, what is chosen.
    pub strong: Color32,
    /// Links, focus, progress; as a fill, the one button to press next.
    pub accent: Color32,
    /// Letters on `accent`.
    pub on_accent: Color32,
    /// Right.
    pub good: Color32,
    /// A mistake, a notice.
    pub warn: Color32,
    /// An error.
    pub bad: Color32,
}

const fn rgb(hex: u32) -> Color32 {
    let [_, r, g, b] = hex.to_be_bytes();
    Color32::from_rgb(r, g, b)
}

const DARK: Colours = Colours {
    panel: rgb(0x1B1D20),
    surround: rgb(0x111214),
    well: rgb(0x111214),
    raised: rgb(0x2A2D32),
    hovered: rgb(0x363A40),
    pressed: rgb(0x42474F),
    line: rgb(0x303338),
    edge: rgb(0x6F7680),
    tint: rgb(0x27405C),
    weak: rgb(0xA0A6AF),
    text: rgb(0xCDD1D6),
    strong: rgb(0xF2F4F6),
    accent: rgb(0x70B0F0),
    on_accent: rgb(0x0C1826),
    good: rgb(0x6CC58A),
    warn: rgb(0xE8BA5C),
    bad: rgb(0xF47A70),
};

const LIGHT: Colours = Colours {
    panel: rgb(0xF7F7F5),
    surround: rgb(0xE2E3E2),
    well: rgb(0xFFFFFF),
    raised: rgb(0xE6E7E7),
    hovered: rgb(0xDADDDF),
    pressed: rgb(0xCCD1D5),
    line: rgb(0xD6D7D7),
    edge: rgb(0x81868C),
    tint: rgb(0xCFE0F2),
    weak: rgb(0x585D64),
    text: rgb(0x303439),
    strong: rgb(0x101215),
    accent: rgb(0x185FA5),
    on_accent: rgb(0xFFFFFF),
    good: rgb(0x186839),
    warn: rgb(0x7D5200),
    bad: rgb(0xB0241C),
};

/// The colours of the theme that a part of the window has.
pub fn colours(ui: &Ui) -> &'static Colours {
    of_theme(ui.visuals().dark_mode)
}

fn of_theme(is_dark: bool) -> &'static Colours {
    if is_dark { &DARK } else { &LIGHT }
}

/// The colour around the picture.
pub fn surround(ui: &Ui) -> Color32 {
    colours(ui).surround
}

/// The accent colour.
pub fn accent(ui: &Ui) -> Color32 {
    colours(ui).accent
}

/// Sets both themes' styles.
pub fn install(context: &Context) {
    for theme in [egui::Theme::Dark, egui::Theme::Light] {
        context.style_mut_of(theme, |style| dress(style, theme == egui::Theme::Dark));
    }
}

/// Chooses a theme.
pub fn choose(context: &Context, theme: Theme) {
    context.set_theme(match theme {
        Theme::System => egui::ThemePreference::System,
        Theme::Dark => egui::ThemePreference::Dark,
        Theme::Light => egui::ThemePreference::Light,
    });
}

fn dress(style: &mut Style, is_dark: bool) {
    style.text_styles = [
        (TextStyle::Small, FontId::proportional(12.0)),
        (TextStyle::Body, FontId::proportional(14.0)),
        (TextStyle::Button, FontId::proportional(14.0)),
        (TextStyle::Heading, FontId::proportional(20.0)),
        (TextStyle::Monospace, FontId::monospace(12.0)),
    ]
    .into();
    style.spacing = Spacing {
        item_spacing: vec2(8.0, 8.0),
        button_padding: vec2(8.0, 4.0),
        interact_size: vec2(40.0, 24.0),
        window_margin: Margin::same(24),
        menu_margin: Margin::same(4),
        menu_spacing: 4.0,
        menu_width: 248.0,
        indent: 16.0,
        slider_width: 200.0,
        slider_rail_height: 4.0,
        combo_width: 112.0,
        combo_height: 320.0,
        text_edit_width: 200.0,
        icon_width: 16.0,
        icon_width_inner: 10.0,
        icon_spacing: 8.0,
        tooltip_width: 320.0,
        // A bar shows whenever something overflows, and takes no room.
        scroll: ScrollStyle {
            bar_width: 6.0,
            floating_allocated_width: 0.0,
            dormant_handle_opacity: 0.6,
            foreground_color: false,
            ..ScrollStyle::floating()
        },
        ..style.spacing.clone()
    };
    style.interaction.tooltip_delay = 0.6;
    style.interaction.tooltip_grace_time = 0.3;
    style.interaction.show_tooltips_only_when_still = true;
    style.interaction.selectable_labels = false;
    style.animation_time = 0.1;
    style.visuals = visuals(is_dark);
}

fn visuals(is_dark: bool) -> Visuals {
    let colours = of_theme(is_dark);
    let mut visuals = if is_dark { Visuals::dark() } else { Visuals::light() };
    visuals.panel_fill = colours.panel;
    visuals.window_fill = colours.panel;
    visuals.extreme_bg_color = colours.surround;
    visuals.text_edit_bg_color = Some(colours.well);
    visuals.code_bg_color = colours.well;
    visuals.faint_bg_color = colours.raised;
    visuals.selection.bg_fill = colours.tint;
    visuals.selection.stroke = Stroke::new(1.0, colours.strong);
    visuals.hyperlink_color = colours.accent;
    visuals.weak_text_color = Some(colours.weak);
    visuals.warn_fg_color = colours.warn;
    visuals.error_fg_color = colours.bad;
    visuals.window_stroke = Stroke::new(1.0, colours.line);
    visuals.window_corner_radius = CornerRadius::same(8);
    visuals.menu_corner_radius = CornerRadius::same(6);
    let color = Color32::from_black_alpha(if is_dark { 96 } else { 48 });
    visuals.popup_shadow = Shadow { offset: [0, 4], blur: 14, spread: 0, color };
    visuals.window_shadow = visuals.popup_shadow;
    visuals.slider_trailing_fill = true;
    visuals.handle_shape = HandleShape::Circle;
    visuals.disabled_alpha = 0.45;
    visuals.collapsing_header_frame = false;
    visuals.indent_has_left_vline = false;
    visuals.button_frame = true;
    let widgets = &mut visuals.widgets;
    for (widget, fill, text) in [
        (&mut widgets.noninteractive, colours.panel, colours.text),
        (&mut widgets.inactive, colours.raised, colours.text),
        (&mut widgets.hovered, colours.hovered, colours.strong),
        (&mut widgets.active, colours.pressed, colours.strong),
        (&mut widgets.open, colours.hovered, colours.strong),
    ] {
        widget.bg_fill = fill;
        widget.weak_bg_fill = fill;
        widget.bg_stroke = Stroke::NONE;
        widget.fg_stroke = Stroke::new(1.0, text);
        widget.corner_radius = CornerRadius::same(4);
        widget.expansion = 0.0;
    }
    widgets.noninteractive.bg_stroke = Stroke::new(1.0, colours.line);
    visuals
}

/// Draws a ring around the control that has the keyboard focus.
pub fn paint_focus(context: &Context) {
    let focused = context.memory(|memory| memory.focused());
    let Some(response) = focused.and_then(|id| context.read_response(id)) else { return };
    let stroke = Stroke::new(2.0, of_theme(context.global_style().visuals.dark_mode).accent);
    let painter = context.layer_painter(response.layer_id).with_clip_rect(response.interact_rect.expand(3.0));
    painter.rect_stroke(response.rect.expand(1.0), CornerRadius::same(5), stroke, egui::StrokeKind::Outside);
}

/// A frame for widgets that float over the picture.
pub fn float_frame(ui: &Ui) -> Frame {
    Frame::new()
        .fill(colours(ui).panel.gamma_multiply(0.94))
        .stroke(ui.visuals().window_stroke)
        .corner_radius(6)
        .inner_margin(Margin::symmetric(12, 8))
}

/// The window's icon.
pub fn icon() -> Arc<egui::IconData> {
    let png = include_bytes!("../../assets/package/icons/64.png");
    Arc::new(eframe::icon_data::from_png_bytes(png).unwrap_or_default())
}

/// A panel's frame. It has no fill: the window is cleared to the panel's colour, which costs almost nothing in software
/// rendering, while a fill costs as much as the whole content.
pub fn panel(inner_margin: Margin) -> Frame {
    Frame::new().inner_margin(inner_margin)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The contrast of two colours by WCAG 2, 1 to 21.
    fn contrast(a: Color32, b: Color32) -> f64 {
        let luminance = |colour: Color32| {
            let linear = |byte: u8| {
                let value = f64::from(byte) / 255.0;
                if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
            };
            0.2126 * linear(colour.r()) + 0.7152 * linear(colour.g()) + 0.0722 * linear(colour.b())
        };
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn text_is_readable_on_every_background() {
        for c in [&DARK, &LIGHT] {
            let letters = [c.weak, c.text, c.strong, c.accent, c.good, c.warn, c.bad];
            let on_ground = letters.map(|letter| [c.panel, c.raised].map(|ground| (letter, ground, 4.5)));
            let others = [
                (c.text, c.tint, 4.5),
                (c.strong, c.tint, 4.5),
                (c.text, c.hovered, 4.5),
                (c.weak, c.surround, 4.5),
                (c.on_accent, c.accent, 4.5),
                (c.edge, c.panel, 3.0),
                (c.edge, c.raised, 2.95),
            ];
            for (front, ground, least) in on_ground.into_iter().flatten().chain(others) {
                let found = contrast(front, ground);
                assert!(found >= least, "{front:?} on {ground:?}: {found:.2}");
            }
        }
    }
}
