//! The colours and the font of all charts.

use plotters::coord::Shift;
use plotters::prelude::*;

pub const INK: RGBColor = RGBColor(0x22, 0x26, 0x2B);
/// Less important text, and axes.
pub const FAINT_INK: RGBColor = RGBColor(0x5B, 0x63, 0x6B);
/// Grid lines at labels.
pub const GRID: RGBColor = RGBColor(0xD5, 0xD9, 0xDD);
/// Grid lines between labels.
pub const FINE_GRID: RGBColor = RGBColor(0xEC, 0xEE, 0xF0);
/// Lines for comparison.
pub const GUIDE: RGBColor = RGBColor(0x8A, 0x92, 0x99);

/// Colours that people with any kind of colour vision can distinguish.
///
/// Source: Okabe and Ito, "Color Universal Design", 2008; without black, which is used for text, and yellow, which is
/// too light.
pub const PALETTE: [RGBColor; 6] = [
    RGBColor(0x00, 0x72, 0xB2),
    RGBColor(0xD5, 0x5E, 0x00),
    RGBColor(0x00, 0x9E, 0x73),
    RGBColor(0xCC, 0x79, 0xA7),
    RGBColor(0xE6, 0x9F, 0x00),
    RGBColor(0x56, 0xB4, 0xE9),
];

pub(super) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
pub(super) type Drawn = Result<(), DrawingAreaErrorKind<std::io::Error>>;

/// A name that SVG readers know, too.
pub const FONT: &str = "sans-serif";
