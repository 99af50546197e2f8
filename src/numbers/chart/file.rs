//! Draws figures as SVG.

use super::style::{FAINT_INK, FONT, INK, provide_font};
use super::{Figure, lines};
use anyhow::{Result, anyhow, ensure};
use plotters::coord::Shift;
use plotters::prelude::*;

/// The figure as SVG, in its own colours on white.
///
/// # Errors
/// If plotters or the font fails.
pub fn svg(figure: &Figure) -> Result<String> {
    ensure!(provide_font(), "the font of the charts cannot be read");
    let mut text = String::new();
    let [width, height] = figure.size;
    let area = SVGBackend::with_string(&mut text, (width, height)).into_drawing_area();
    draw(&area, figure).map_err(|error| anyhow!("the chart cannot be drawn: {error}"))?;
    drop(area);
    Ok(text)
}

fn draw<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    figure: &Figure,
) -> Result<(), DrawingAreaErrorKind<B::ErrorType>> {
    area.fill(&WHITE)?;
    area.draw_text(&figure.title, &(FONT, 22, &INK).into_text_style(area), (16, 14))?;
    area.draw_text(&figure.about, &(FONT, 14, &FAINT_INK).into_text_style(area), (16, 42))?;
    let (_, below) = area.split_vertically(if figure.about.is_empty() { 46 } else { 64 });
    let columns = figure.columns.max(1);
    let places = below.split_evenly((figure.panels.len().div_ceil(columns), columns));
    figure.panels.iter().zip(&places).try_for_each(|(chart, place)| lines::draw(place, chart))?;
    area.present()
}
