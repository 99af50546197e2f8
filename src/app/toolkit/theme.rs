//! Colours, fonts and distances: subdued greys, and one accent colour, the blue of the book's sky.

use eframe::egui::style::{ScrollStyle, Spacing};
use eframe::egui::{
    self, Color32, Context, CornerRadius, FontId, Frame, Margin, Shadow, Stroke, Style, TextStyle, Ui,
    Visuals, vec2,
};
use std::sync::Arc;

const fn rgb(hex: u32) -> Color32 {
    let [_, r, g, b] = hex.to_be_bytes();
    Color32::from_rgb(r, g, b)
}

macro_rules! colours {
    ($($(#[$what:meta])* $name:ident $dark:literal $light:literal)*) => {
        /// The colours of one theme. Letters on `tint` are `text` or `strong`.
        pub struct Colours {
            $($(#[$what])* pub $name: Color32,)*
        }

        const DARK: Colours = Colours { $($name: rgb($dark)),* };
        const LIGHT: Colours = Colours { $($name: rgb($light)),* };
    };
}

colours! {
    /// Panels, menus, cards, dialogs.
    panel 0x1B1D20 0xF7F7F5
    /// Around the picture, and behind plots.
    surround 0x111214 0xE2E3E2
    /// Behind what is typed, and behind code.
    well 0x111214 0xFFFFFF
    /// Buttons, fields, rails.
    raised 0x2A2D32 0xE6E7E7
    /// Under the pointer; open menus.
    hovered 0x363A40 0xDADDDF
    /// While pressed.
    pressed 0x42474F 0xCCD1D5
    /// Separators, edges of cards.
    line 0x303338 0xD6D7D7
    /// Rings and handles; never letters.
    edge 0x6F7680 0x81868C
    /// Active or chosen elements.
    tint 0x27405C 0xCFE0F2
    /// Labels, hints, keys.
    weak 0xA0A6AF 0x585D64
    text 0xCDD1D6 0x303439
    /// Titles, values, what is chosen.
    strong 0xF2F4F6 0x101215
    /// Links, focus, progress; as a fill, the one button to press next.
    accent 0x70B0F0 0x185FA5
    /// Letters on `accent`.
    on_accent 0x0C1826 0xFFFFFF
    /// Right.
    good 0x6CC58A 0x186839
    /// A mistake, a notice.
    warn 0xE8BA5C 0x7D5200
    /// An error.
    bad 0xF47A70 0xB0241C
    /// Data: the CPU.
    first 0x5C96FF 0x2F6FE0
    /// Data: the GPU.
    second 0xEB9438 0xD9791A
    /// Data: expected.
    third 0xB48CE0 0x8A55C0
    /// Data: both.
    fourth 0x46C396 0x1F9A6B
}

/// The colours of the theme that a part of the window has.
pub fn colours(ui: &Ui) -> &'static Colours {
    of_theme(ui.visuals().dark_mode)
}

fn of_theme(is_dark: bool) -> &'static Colours {
    if is_dark { &DARK } else { &LIGHT }
}

/// Sets both themes' styles.
pub fn install(context: &Context) {
    for theme in [egui::Theme::Dark, egui::Theme::Light] {
        context.style_mut_of(theme, |style| dress(style, theme == egui::Theme::Dark));
    }
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
        slider_rail_height: 4.0,
        combo_width: 112.0,
        combo_height: 320.0,
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
    visuals.disabled_alpha = 0.45;
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
    let png = include_bytes!("../../../assets/package/icons/64.png");
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
