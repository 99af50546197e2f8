//! Charts as plain data, drawn to PNG or SVG files: lines with error bars on linear or logarithmic axes, and bars
//! with notes beside them.
//!
//! plotters draws them; no other room uses it. Text is set in the window's font, which is part of the program, so no
//! system library is needed.

mod axis;
mod bars;
mod file;
mod lines;
mod page;
mod style;

pub use axis::{Axis, Scale};
pub use file::{ChartError, ChartFormat, save};
pub use page::{UNTITLED_TOP, page_svg};
pub use plotters::chart::SeriesLabelPosition as Corner;

/// A picture of one or more charts.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Title of the whole figure.
    pub title: String,
    /// A smaller line below the title, such as machine and settings; may be empty.
    pub about: String,
    /// Width and height in points; a PNG has twice as many pixels each way.
    pub size: [u32; 2],
    /// Number of charts side by side.
    pub columns: usize,
    /// The charts in reading order.
    pub panels: Vec<Panel>,
}

/// One chart of a figure.
#[derive(Clone, Debug, PartialEq)]
pub enum Panel {
    /// Lines over an axis.
    Lines(LineChart),
    /// Horizontal bars, one per row.
    Bars(BarChart),
}

/// Series over two axes.
#[derive(Clone, Debug, PartialEq)]
pub struct LineChart {
    /// What the chart shows; may be empty.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// What is drawn, from back to front. Series without a name are not in the legend.
    pub series: Vec<Series>,
    /// Position of the legend; `None` for no legend.
    pub legend: Option<Corner>,
}

/// Points drawn as one line.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Name in the legend.
    pub name: String,
    /// Points in the order in which they are joined. Those that an axis cannot show are left out.
    pub points: Vec<Point>,
    /// How it is drawn.
    pub look: Look,
}

impl Series {
    /// Points without a spread.
    pub fn new(name: impl Into<String>, look: Look, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let points = points.into_iter().map(|(x, y)| Point { x, y, spread: None }).collect();
        Series { name: name.into(), points, look }
    }
}

/// How a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Look {
    /// A line with a mark at each point; each series has its own colour and mark.
    Measured,
    /// A thin dashed grey line, to compare with a law.
    Guide,
}

/// A value and the spread of its measurements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Horizontal value.
    pub x: f64,
    /// Vertical value.
    pub y: f64,
    /// Smallest and largest y, drawn as a band.
    pub spread: Option<[f64; 2]>,
}

/// Horizontal bars from 0.
#[derive(Clone, Debug, PartialEq)]
pub struct BarChart {
    /// What the chart shows; may be empty.
    pub title: String,
    /// What the length of the bars means, with the unit.
    pub label: String,
    /// From top to bottom.
    pub bars: Vec<Bar>,
}

/// A bar and the texts of its row.
#[derive(Clone, Debug, PartialEq)]
pub struct Bar {
    /// Text to the left of the bar.
    pub name: String,
    /// Length of the bar, at least 0.
    pub value: f64,
    /// Smallest and largest value.
    pub spread: Option<[f64; 2]>,
    /// Text to the right of the bar.
    pub note: String,
    /// Bars of the same kind have the same colour.
    pub kind: usize,
}
