//! Charts as plain data, drawn as SVG: lines with bands on logarithmic axes.
//!
//! plotters draws them; no other room uses it. Text is set in the window's embedded font, so no system library is
//! needed.

mod axis;
mod lines;
mod style;
mod svg;

pub use axis::Axis;
pub use svg::{UNTITLED_TOP, page_svg, svg};

/// A picture of one or more charts.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    pub title: String,
    /// A smaller line below the title, such as machine and settings; may be empty.
    pub about: String,
    /// Width and height in points.
    pub size: [u32; 2],
    /// Charts side by side.
    pub columns: usize,
    /// In reading order.
    pub panels: Vec<LineChart>,
}

/// Series over two axes.
#[derive(Clone, Debug, PartialEq)]
pub struct LineChart {
    /// May be empty.
    pub title: String,
    pub x: Axis,
    pub y: Axis,
    /// Back to front.
    pub series: Vec<Series>,
}

/// Points drawn as one line.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Shown at the end of the line; may be empty.
    pub name: String,
    /// In the order they are joined. Points that an axis cannot show are left out.
    pub points: Vec<Point>,
    pub look: Look,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Look {
    /// A line with a mark at each point, in the series' own colour and shape.
    Measured,
    /// A thin dashed grey line, for comparison with a law.
    Guide,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    pub x: f64,
    pub y: f64,
    /// Smallest and largest y, drawn as a band.
    pub spread: Option<[f64; 2]>,
}
