//! Colours and spacing: subdued greys, and one accent colour, the blue of the book's sky.

use super::model::remembered::Theme;
use eframe::egui::{
    self, Color32, Context, CornerRadius, Frame, Margin, Shadow, Stroke, Style, TextStyle, Ui, Visuals,
};
use std::sync::Arc;

/// The colours of one theme.
struct Palette {
    panel: Color32,
    surround: Color32,
    raised: Color32,
    hovered: Color32,
    pressed: Color32,
    line: Color32,
    weak: Color32,
    text: Color32,
    strong: Color32,
    accent: Color32,
    on_accent: Color32,
    warn: Color32,
    bad: Color32,
}

const DARK: Palette = Palette {
    panel: Color32::from_rgb(27, 29, 32),
    surround: Color32::from_rgb(17, 18, 20),
    raised: Color32::from_rgb(42, 45, 50),
    hovered: Color32::from_rgb(54, 58, 64),
    pressed: Color32::from_rgb(66, 71, 79),
    line: Color32::from_rgb(48, 51, 56),
    weak: Color32::from_rgb(160, 166, 175),
    text: Color32::from_rgb(205, 209, 214),
    strong: Color32::from_rgb(242, 244, 246),
    accent: Color32::from_rgb(112, 176, 240),
    on_accent: Color32::from_rgb(12, 24, 38),
    warn: Color32::from_rgb(232, 186, 92),
    bad: Color32::from_rgb(244, 122, 112),
};

const LIGHT: Palette = Palette {
    panel: Color32::from_rgb(247, 247, 245),
    surround: Color32::from_rgb(226, 227, 226),
    raised: Color32::from_rgb(230, 231, 231),
    hovered: Color32::from_rgb(218, 221, 223),
    pressed: Color32::from_rgb(204, 209, 213),
    line: Color32::from_rgb(214, 215, 215),
    weak: Color32::from_rgb(88, 93, 100),
    text: Color32::from_rgb(48, 52, 57),
    strong: Color32::from_rgb(16, 18, 21),
    accent: Color32::from_rgb(28, 104, 178),
    on_accent: Color32::WHITE,
    warn: Color32::from_rgb(138, 90, 0),
    bad: Color32::from_rgb(184, 38, 30),
};

fn palette(is_dark: bool) -> &'static Palette {
    if is_dark { &DARK } else { &LIGHT }
}

/// The colour around the picture.
pub fn surround(ui: &Ui) -> Color32 {
    palette(ui.visuals().dark_mode).surround
}

/// The accent colour.
pub fn accent(ui: &Ui) -> Color32 {
    palette(ui.visuals().dark_mode).accent
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
    for (text, size) in [
        (TextStyle::Small, 11.0),
        (TextStyle::Body, 13.0),
        (TextStyle::Button, 13.0),
        (TextStyle::Monospace, 12.0),
        (TextStyle::Heading, 16.0),
    ] {
        if let Some(font) = style.text_styles.get_mut(&text) {
            font.size = size;
        }
    }
    style.spacing.item_spacing = egui::vec2(8.0, 6.0);
    style.spacing.button_padding = egui::vec2(8.0, 3.0);
    style.spacing.interact_size = egui::vec2(40.0, 22.0);
    style.spacing.menu_margin = Margin::same(6);
    style.spacing.slider_rail_height = 4.0;
    style.spacing.tooltip_width = 320.0;
    style.interaction.tooltip_delay = 0.6;
    style.interaction.selectable_labels = false;
    style.visuals = visuals(is_dark);
}

fn visuals(is_dark: bool) -> Visuals {
    let colours = palette(is_dark);
    let mut visuals = if is_dark { Visuals::dark() } else { Visuals::light() };
    visuals.panel_fill = colours.panel;
    visuals.window_fill = colours.panel;
    visuals.window_stroke = Stroke::new(1.0, colours.line);
    visuals.window_corner_radius = CornerRadius::same(8);
    visuals.menu_corner_radius = CornerRadius::same(6);
    visuals.extreme_bg_color = colours.surround;
    visuals.faint_bg_color = colours.raised;
    visuals.hyperlink_color = colours.accent;
    visuals.warn_fg_color = colours.warn;
    visuals.error_fg_color = colours.bad;
    visuals.weak_text_color = Some(colours.weak);
    visuals.selection.bg_fill = colours.accent;
    visuals.selection.stroke = Stroke::new(1.0, colours.on_accent);
    visuals.slider_trailing_fill = true;
    // Colours have the numbers of scene files.
    visuals.numeric_color_space = egui::style::NumericColorSpace::Linear;
    visuals.handle_shape = egui::style::HandleShape::Circle;
    visuals.disabled_alpha = 0.45;
    let shadow = Shadow { offset: [0, 4], blur: 14, spread: 0, color: Color32::from_black_alpha(60) };
    visuals.popup_shadow = shadow;
    visuals.window_shadow = shadow;
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
        widget.corner_radius = CornerRadius::same(5);
        widget.expansion = 0.0;
    }
    widgets.noninteractive.bg_stroke = Stroke::new(1.0, colours.line);
    widgets.hovered.bg_stroke = Stroke::new(1.0, colours.line);
    visuals
}

/// Draws a ring around the control that has the keyboard focus.
pub fn paint_focus(context: &Context) {
    let focused = context.memory(|memory| memory.focused());
    let Some(response) = focused.and_then(|id| context.read_response(id)) else { return };
    let colours = palette(context.global_style().visuals.dark_mode);
    let painter = context.layer_painter(response.layer_id).with_clip_rect(response.interact_rect.expand(3.0));
    let kind = egui::StrokeKind::Outside;
    painter.rect_stroke(response.rect, CornerRadius::same(5), Stroke::new(2.0, colours.accent), kind);
}

/// A frame for widgets that float over the picture.
pub fn float_frame(ui: &Ui) -> Frame {
    let fill = ui.visuals().panel_fill.gamma_multiply(0.94);
    Frame::new()
        .fill(fill)
        .stroke(ui.visuals().window_stroke)
        .corner_radius(6)
        .inner_margin(Margin::symmetric(10, 6))
}

/// The window's icon.
pub fn icon() -> Arc<egui::IconData> {
    let png = include_bytes!("../../assets/package/icons/64.png");
    Arc::new(eframe::icon_data::from_png_bytes(png).unwrap_or_default())
}

/// A panel's frame. It has no fill: the window is cleared to the panel's colour, which costs almost nothing in software
/// rendering, while a fill costs as much as the whole content.
pub fn panel(inner_margin: egui::Margin) -> egui::Frame {
    egui::Frame::new().inner_margin(inner_margin)
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
        const LEAST: f64 = 4.5;
        for palette in [&DARK, &LIGHT] {
            let Palette { panel, surround, raised, hovered, weak, text, strong, .. } = *palette;
            for colour in [weak, text, strong] {
                for background in [panel, surround, raised, hovered] {
                    let found = contrast(colour, background);
                    assert!(found >= LEAST, "{colour:?} on {background:?}: {found:.2}");
                }
            }
            for colour in [palette.accent, palette.warn, palette.bad] {
                for background in [panel, raised] {
                    let found = contrast(colour, background);
                    assert!(found >= LEAST, "{colour:?} on {background:?}: {found:.2}");
                }
            }
            assert!(contrast(palette.on_accent, palette.accent) >= LEAST);
        }
    }
}
