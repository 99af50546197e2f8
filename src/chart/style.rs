//! Colours, fonts and sizes.

use plotters::style::{FontStyle, RGBColor, register_font};
use std::sync::OnceLock;

/// Text.
pub const INK: RGBColor = RGBColor(0x22, 0x26, 0x2B);
/// Text that matters less, and axes.
pub const FAINT_INK: RGBColor = RGBColor(0x5B, 0x63, 0x6B);
/// Lines of the grid at labels.
pub const GRID: RGBColor = RGBColor(0xD5, 0xD9, 0xDD);
/// Lines of the grid between them.
pub const FINE_GRID: RGBColor = RGBColor(0xEC, 0xEE, 0xF0);
/// Lines to compare with.
pub const GUIDE: RGBColor = RGBColor(0x8A, 0x92, 0x99);

/// Colours that people with any kind of colour vision can tell apart.
///
/// Source: Okabe and Ito, "Color Universal Design", 2008; without black and yellow, which are text and too light.
const PALETTE: [RGBColor; 6] = [
    RGBColor(0x00, 0x72, 0xB2),
    RGBColor(0xD5, 0x5E, 0x00),
    RGBColor(0x00, 0x9E, 0x73),
    RGBColor(0xCC, 0x79, 0xA7),
    RGBColor(0xE6, 0x9F, 0x00),
    RGBColor(0x56, 0xB4, 0xE9),
];

/// The colour of series or kind number `index`.
pub fn color(index: usize) -> RGBColor {
    PALETTE[index % PALETTE.len()]
}

/// The font's name, which an SVG's reader knows too.
pub const FONT: &str = "sans-serif";

/// Makes [`FONT`] known to plotters. Says whether it could.
pub fn provide_font() -> bool {
    static IS_KNOWN: OnceLock<bool> = OnceLock::new();
    *IS_KNOWN
        .get_or_init(|| register_font(FONT, FontStyle::Normal, epaint_default_fonts::UBUNTU_LIGHT).is_ok())
}

/// Points to pixels of a drawing.
#[derive(Clone, Copy)]
pub struct Units(pub f64);

impl Units {
    /// A length as whole pixels.
    pub fn px(self, points: f64) -> i32 {
        (points * self.0).round() as i32
    }

    /// The same for what cannot be negative.
    pub fn size(self, points: f64) -> u32 {
        self.px(points).max(0).unsigned_abs()
    }
}
