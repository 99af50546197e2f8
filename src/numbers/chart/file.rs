//! Writes figures to files.

use super::style::{FAINT_INK, FONT, INK, Units, provide_font};
use super::{Figure, Panel, bars, lines};
use crate::system::files::{WriteError, replace_file};
use image::{ImageFormat, RgbImage};
use plotters::coord::Shift;
use plotters::prelude::*;
use std::io::{self, Cursor};
use std::path::{Path, PathBuf};

/// Pixels of a PNG per point.
const PNG_SCALE: u32 = 2;

/// A PNG is drawn this much larger and then reduced, to smooth edges.
const SMOOTHING: u32 = 2;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChartFormat {
    Png,
    Svg,
}

impl ChartFormat {
    /// The format for a file name's extension, in either case. Fails with [`ChartError::UnknownEnding`].
    pub fn from_path(path: &Path) -> Result<Self, ChartError> {
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
        match ending.as_deref() {
            Some("png") => Ok(ChartFormat::Png),
            Some("svg") => Ok(ChartFormat::Svg),
            _ => Err(ChartError::UnknownEnding { path: path.to_owned() }),
        }
    }
}

#[derive(Debug, thiserror::Error)]
pub enum ChartError {
    #[error("cannot tell the format of {}; let the name of a chart end in .png or .svg", path.display())]
    UnknownEnding { path: PathBuf },
    /// plotters, the font or the encoder failed.
    #[error("cannot draw {}: {reason}; the figures are also in the text and the JSON", path.display())]
    Draw { path: PathBuf, reason: String },
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// Writes a figure to `path`, replacing any file, in the format of its extension. On failure, an existing file is
/// unchanged.
pub fn save(path: &Path, figure: &Figure) -> Result<(), ChartError> {
    let draw_error = |reason: String| ChartError::Draw { path: path.to_owned(), reason };
    if !provide_font() {
        return Err(draw_error("the font cannot be read".to_owned()));
    }
    let bytes = match ChartFormat::from_path(path)? {
        ChartFormat::Png => png(figure),
        ChartFormat::Svg => svg(figure),
    };
    let bytes = bytes.map_err(draw_error)?;
    replace_file(path, |writer| io::Write::write_all(writer, &bytes))?;
    Ok(())
}

/// The figure as SVG, in its own colours on white.
pub(super) fn svg(figure: &Figure) -> Result<Vec<u8>, String> {
    let mut text = String::new();
    let [width, height] = figure.size;
    let area = SVGBackend::with_string(&mut text, (width, height)).into_drawing_area();
    draw(&area, figure, Units(1.0)).map_err(|error| error.to_string())?;
    drop(area);
    Ok(text.into_bytes())
}

fn png(figure: &Figure) -> Result<Vec<u8>, String> {
    let [width, height] = figure.size.map(|points| points * PNG_SCALE);
    let mut large = RgbImage::new(width * SMOOTHING, height * SMOOTHING);
    let dimensions = large.dimensions();
    let area = BitMapBackend::with_buffer(&mut large, dimensions).into_drawing_area();
    draw(&area, figure, Units(f64::from(PNG_SCALE * SMOOTHING))).map_err(|error| error.to_string())?;
    drop(area);
    let mut bytes = Cursor::new(Vec::new());
    let small = image::imageops::thumbnail(&large, width, height);
    small.write_to(&mut bytes, ImageFormat::Png).map_err(|error| error.to_string())?;
    Ok(bytes.into_inner())
}

fn draw<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    figure: &Figure,
    units: Units,
) -> Result<(), DrawingAreaErrorKind<B::ErrorType>> {
    area.fill(&WHITE)?;
    let margin = units.px(16.0);
    let title = (FONT, units.px(22.0), &INK).into_text_style(area);
    area.draw_text(&figure.title, &title, (margin, units.px(14.0)))?;
    let about = (FONT, units.px(14.0), &FAINT_INK).into_text_style(area);
    area.draw_text(&figure.about, &about, (margin, units.px(42.0)))?;
    let (_, below) = area.split_vertically(units.px(if figure.about.is_empty() { 46.0 } else { 64.0 }));
    let columns = figure.columns.max(1);
    let places = below.split_evenly((figure.panels.len().div_ceil(columns), columns));
    for (panel, place) in figure.panels.iter().zip(&places) {
        match panel {
            Panel::Lines(chart) => lines::draw(place, chart, units)?,
            Panel::Bars(chart) => bars::draw(place, chart, units)?,
        }
    }
    area.present()
}
