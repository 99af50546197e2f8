//! Draws figures as SVG.

use super::style::{Area, Drawn, FAINT_INK, FINE_GRID, FONT, GRID, GUIDE, INK, PALETTE};
use super::{Figure, lines};
use anyhow::{Context, Result, anyhow, ensure};
use plotters::prelude::*;
use plotters::style::{FontStyle, register_font};
use std::sync::OnceLock;

/// The figure as SVG, in its own colours on white.
///
/// # Errors
/// If plotters or the font fails.
pub fn svg(figure: &Figure) -> Result<String> {
    static HAS_FONT: OnceLock<bool> = OnceLock::new();
    let register = || register_font(FONT, FontStyle::Normal, epaint_default_fonts::UBUNTU_LIGHT).is_ok();
    ensure!(*HAS_FONT.get_or_init(register), "the font of the charts cannot be read");
    let mut text = String::new();
    let [width, height] = figure.size;
    let area = SVGBackend::with_string(&mut text, (width, height)).into_drawing_area();
    draw(&area, figure).map_err(|error| anyhow!("the chart cannot be drawn: {error}"))?;
    drop(area);
    Ok(text)
}

fn draw(area: &Area, figure: &Figure) -> Drawn {
    area.fill(&WHITE)?;
    area.draw_text(&figure.title, &(FONT, 22, &INK).into_text_style(area), (16, 14))?;
    area.draw_text(&figure.about, &(FONT, 14, &FAINT_INK).into_text_style(area), (16, 42))?;
    let (_, below) = area.split_vertically(if figure.about.is_empty() { 46 } else { 64 });
    let columns = figure.columns.max(1);
    let places = below.split_evenly((figure.panels.len().div_ceil(columns), columns));
    figure.panels.iter().zip(&places).try_for_each(|(chart, place)| lines::draw(place, chart))?;
    area.present()
}

/// Height of the space above the charts of an untitled figure, points.
pub const UNTITLED_TOP: u32 = 40;

/// The figure as an `<svg>` element that fills its container, in the page's colours: `currentColor` for text, the
/// variables `--muted` and `--line` for axes and grid, and `--series-1` to `--series-6` for measurements. `label`
/// describes it to screen readers.
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
