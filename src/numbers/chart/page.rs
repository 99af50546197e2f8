//! Charts for a web page: SVG in the page's colours.

use super::Figure;
use super::file::svg;
use super::style::{FAINT_INK, FINE_GRID, GRID, GUIDE, INK, PALETTE};
use anyhow::{Context, Result};
use plotters::style::{RGBColor, WHITE};

/// Height of the space above the charts of an untitled figure, points.
pub const UNTITLED_TOP: u32 = 40;

/// The figure as an `<svg>` element that fills its place, in the page's colours: `currentColor` for text, the variables
/// `--muted` and `--line` for axes and grid, and `--series-1` to `--series-6` for measurements. `label` describes it to
/// screen readers.
///
/// # Errors
/// As for [`svg`].
pub fn page_svg(figure: &Figure, label: &str) -> Result<String> {
    let text = svg(figure)?;
    let inside =
        text.find("<svg").and_then(|start| text[start..].find('>').map(|end| &text[start + end + 1..]));
    let inside = inside.context("the chart has no <svg> element")?;
    let [width, height] = figure.size;
    let mut page =
        format!("<svg viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{label}\">{inside}");
    let named = [(INK, "currentColor"), (FAINT_INK, "var(--muted)"), (GUIDE, "var(--muted)")];
    let grid = [(GRID, "var(--line)"), (FINE_GRID, "var(--line-fine)"), (WHITE, "none")];
    for (color, name) in named.into_iter().chain(grid) {
        page = page.replace(&quoted(color), &format!("\"{name}\""));
    }
    for (index, color) in PALETTE.into_iter().enumerate() {
        page = page.replace(&quoted(color), &format!("\"var(--series-{})\"", index + 1));
    }
    Ok(page)
}

/// A colour as plotters writes it in an attribute.
fn quoted(RGBColor(r, g, b): RGBColor) -> String {
    format!("\"#{r:02X}{g:02X}{b:02X}\"")
}
