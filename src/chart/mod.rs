//! Charts as plain data, drawn into PNG or SVG files: lines with error bars on linear or logarithmic axes, and
//! bars with what is to be read beside them.
//!
//! plotters draws; no other room knows it. Text is set in the font of the window, which the program carries, so
//! that no system library is needed.

mod axis;
mod bars;
mod file;
mod lines;
mod style;

pub use axis::{Axis, Scale};
pub use file::{ChartError, ChartFormat, save};

/// A picture of one or more charts.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Says what is to be seen.
    pub title: String,
    /// A smaller line below it: machine, settings; may be empty.
    pub about: String,
    /// Width and height in points; a PNG has twice as many pixels each way.
    pub size: [u32; 2],
    /// Charts side by side; the next ones stand below.
    pub columns: usize,
    /// In reading order.
    pub panels: Vec<Panel>,
}

/// One chart of a figure.
#[derive(Clone, Debug, PartialEq)]
pub enum Panel {
    /// Lines over an axis.
    Lines(LineChart),
    /// Horizontal bars, one a row.
    Bars(BarChart),
}

/// Series over two axes.
#[derive(Clone, Debug, PartialEq)]
pub struct LineChart {
    /// What the chart shows; may be empty.
    pub title: String,
    /// Across.
    pub x: Axis,
    /// Up.
    pub y: Axis,
    /// What is drawn, the first one lowest. Those without a name are left out of the legend.
    pub series: Vec<Series>,
    /// Where the legend stands; `None`: there is none.
    pub legend: Option<Corner>,
}

/// A corner of a chart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Corner {
    /// Upper left.
    UpperLeft,
    /// Upper right.
    UpperRight,
    /// Lower left.
    LowerLeft,
    /// Lower right.
    LowerRight,
}

/// Points that belong together.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// As the legend has it.
    pub name: String,
    /// In the order in which they are joined. Points that an axis cannot show are left out.
    pub points: Vec<Point>,
    /// How it is drawn.
    pub look: Look,
}

/// How a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Look {
    /// A line with a mark at each point, in a colour and with a mark of its own.
    Measured,
    /// A thin dashed grey line: a law to compare with.
    Guide,
}

/// A value and how far measurements of it spread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Across.
    pub x: f64,
    /// Up.
    pub y: f64,
    /// Least and largest y, drawn as a band between the points.
    pub spread: Option<[f64; 2]>,
}

/// Horizontal bars from 0.
#[derive(Clone, Debug, PartialEq)]
pub struct BarChart {
    /// What the chart shows; may be empty.
    pub title: String,
    /// What the bars' length means, with its unit.
    pub label: String,
    /// From the top down.
    pub bars: Vec<Bar>,
}

/// A bar and the texts of its row.
#[derive(Clone, Debug, PartialEq)]
pub struct Bar {
    /// Stands before it.
    pub name: String,
    /// Its length, at least 0.
    pub value: f64,
    /// Least and largest value.
    pub spread: Option<[f64; 2]>,
    /// Stands behind it.
    pub note: String,
    /// Bars of one kind have one colour.
    pub kind: usize,
}
