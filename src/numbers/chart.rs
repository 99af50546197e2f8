//! Charts as plain data, drawn as SVG: lines with bands on logarithmic axes.
//!
//! plotters draws them; no other room uses it. Text is set in the window's embedded font, so no system library is
//! needed.

use anyhow::{Result, anyhow};
use plotters::coord::Shift;
use plotters::coord::combinators::{LogCoord, WithKeyPoints};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{FontStyle, register_font};

/// A picture of one or more charts.
#[derive(Clone, Debug)]
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
#[derive(Clone, Debug)]
pub struct LineChart {
    /// May be empty.
    pub title: String,
    pub x: Axis,
    pub y: Axis,
    /// Back to front.
    pub series: Vec<Series>,
}

/// A logarithmic axis; values must be above 0.
#[derive(Clone, Debug)]
pub struct Axis {
    /// Quantity and unit.
    pub label: String,
    /// Smallest and largest value. If they span no range, as in a chart without points, the axis gets an arbitrary one.
    pub limits: [f64; 2],
}

/// Points drawn as one line.
#[derive(Clone, Debug)]
pub struct Series {
    /// Shown at the end of the line; may be empty.
    pub name: String,
    /// In the order they are joined. Points that an axis cannot show are left out.
    pub points: Vec<Point>,
    /// Whether it is a thin dashed grey line for comparison with a law, not a line with a mark at each point in its own
    /// colour.
    pub is_guide: bool,
}

#[derive(Clone, Copy, Debug)]
pub struct Point {
    pub x: f64,
    pub y: f64,
    /// Smallest and largest y, drawn as a band.
    pub spread: Option<[f64; 2]>,
}

const INK: RGBColor = RGBColor(0x22, 0x26, 0x2B);
/// Less important text, and axes.
const FAINT_INK: RGBColor = RGBColor(0x5B, 0x63, 0x6B);
/// Grid lines at labels.
const GRID: RGBColor = RGBColor(0xD5, 0xD9, 0xDD);
/// Grid lines between labels.
const FINE_GRID: RGBColor = RGBColor(0xEC, 0xEE, 0xF0);
/// Lines for comparison.
const GUIDE: RGBColor = RGBColor(0x8A, 0x92, 0x99);

/// Colours that people with any kind of colour vision can distinguish.
///
/// Source: Okabe and Ito, "Color Universal Design", 2008; without black, which is used for text, and yellow, which is
/// too light.
const PALETTE: [RGBColor; 6] = [
    RGBColor(0x00, 0x72, 0xB2),
    RGBColor(0xD5, 0x5E, 0x00),
    RGBColor(0x00, 0x9E, 0x73),
    RGBColor(0xCC, 0x79, 0xA7),
    RGBColor(0xE6, 0x9F, 0x00),
    RGBColor(0x56, 0xB4, 0xE9),
];

/// A name that SVG readers know, too.
const FONT: &str = "sans-serif";

/// Height of the space above the charts of an untitled figure, points.
pub const UNTITLED_TOP: u32 = 40;

/// A chart that is narrower than this has its names inside, in points.
const NARROW: u32 = 480;

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Drawn = Result<(), DrawingAreaErrorKind<std::io::Error>>;

/// The figure as SVG, in its own colours on white.
///
/// # Errors
/// If plotters or the font fails.
pub fn svg(figure: &Figure) -> Result<String> {
    register_font(FONT, FontStyle::Normal, epaint_default_fonts::UBUNTU_LIGHT)
        .map_err(|_| anyhow!("the font of the charts cannot be read"))?;
    let mut text = String::new();
    let [width, height] = figure.size;
    let area = SVGBackend::with_string(&mut text, (width, height)).into_drawing_area();
    draw(&area, figure).map_err(|error| anyhow!("the chart cannot be drawn: {error}"))?;
    drop(area);
    Ok(text)
}

/// The figure as an `<svg>` element that fills its container, in the page's colours: `currentColor` for text, the
/// variables `--muted` and `--line` for axes and grid, and `--series-1` to `--series-6` for measurements. `label`
/// describes it to screen readers.
///
/// # Errors
/// As for [`svg`].
pub fn page_svg(figure: &Figure, label: &str) -> Result<String> {
    let [width, height] = figure.size;
    let size = format!("width=\"{width}\" height=\"{height}\"");
    let page = svg(figure)?.replacen(&size, &format!("role=\"img\" aria-label=\"{label}\""), 1);
    let named = [(INK, "currentColor"), (FAINT_INK, "var(--muted)"), (GUIDE, "var(--muted)")];
    let grid = [(GRID, "var(--line)"), (FINE_GRID, "var(--line-fine)"), (WHITE, "none")];
    let named = named.into_iter().chain(grid).map(|(color, name)| (color, name.to_owned()));
    let series =
        PALETTE.iter().enumerate().map(|(index, color)| (*color, format!("var(--series-{})", index + 1)));
    Ok(named.chain(series).fold(page, |page, (RGBColor(r, g, b), name)| {
        page.replace(&format!("\"#{r:02X}{g:02X}{b:02X}\""), &format!("\"{name}\""))
    }))
}

fn draw(area: &Area, figure: &Figure) -> Drawn {
    area.fill(&WHITE)?;
    area.draw_text(&figure.title, &(FONT, 22, &INK).into_text_style(area), (16, 14))?;
    area.draw_text(&figure.about, &(FONT, 14, &FAINT_INK).into_text_style(area), (16, 42))?;
    let (_, below) = area.split_vertically(if figure.about.is_empty() { 46 } else { 64 });
    let columns = figure.columns.max(1);
    let places = below.split_evenly((figure.panels.len().div_ceil(columns), columns));
    figure.panels.iter().zip(&places).try_for_each(|(chart, place)| draw_chart(place, chart))?;
    area.present()
}

/// Whether an axis can show a value.
fn is_shown(value: f64) -> bool {
    value > 0.0 && value.is_finite()
}

/// An axis with labels at powers of ten and, if these are few, at multiples of them; fine lines at every digit.
fn axis(limits: [f64; 2]) -> WithKeyPoints<LogCoord<f64>> {
    let is_range = limits.into_iter().all(is_shown) && limits[0] < limits[1];
    let [low, high] = if is_range { limits } else { [1.0, 10.0] };
    let at = |digits: &[u32]| -> Vec<f64> {
        let powers = low.log10().floor() as i32..=high.log10().ceil() as i32;
        let all = powers.flat_map(|power| digits.iter().map(move |digit| format!("{digit}e{power}")));
        let known = all.filter_map(|text| text.parse().ok());
        known.filter(|value| (low * (1.0 - 1e-9)..=high * (1.0 + 1e-9)).contains(value)).collect()
    };
    let powers = at(&[1]);
    let ticks = match powers.len() {
        0 | 1 => at(&[1, 2, 3, 5, 7]),
        2 => at(&[1, 2, 5]),
        count => powers.into_iter().step_by(1 + count / 13).collect(),
    };
    let fine = if high / low > 1e8 { Vec::new() } else { at(&[2, 3, 4, 5, 6, 7, 8, 9]) };
    (low..high).log_scale().with_key_points(ticks).with_light_points(fine)
}

/// The value of a tick.
fn label(value: &f64) -> String {
    if (1e-3..1e5).contains(value) { value.to_string() } else { format!("{value:e}") }
}

fn draw_chart(area: &Area, chart: &LineChart) -> Drawn {
    let is_narrow = area.dim_in_pixel().0 < NARROW;
    let mut builder = ChartBuilder::on(area);
    let measured = chart.series.iter().filter(|series| !series.is_guide);
    let longest = measured.map(|series| series.name.chars().count()).max().unwrap_or(0);
    builder.margin(8).margin_right(18 + if is_narrow { 0 } else { 15 * longest as i32 / 2 });
    builder.x_label_area_size(46).y_label_area_size(64);
    if !chart.title.is_empty() {
        builder.caption(&chart.title, (FONT, 17, &INK));
    }
    let mut context = builder.build_cartesian_2d(axis(chart.x.limits), axis(chart.y.limits))?;
    context
        .configure_mesh()
        .bold_line_style(GRID.stroke_width(1))
        .light_line_style(FINE_GRID.stroke_width(1))
        .axis_style(FAINT_INK.stroke_width(1))
        .set_all_tick_mark_size(4)
        .label_style((FONT, 14, &INK))
        .axis_desc_style((FONT, 15, &INK))
        .x_label_formatter(&label)
        .y_label_formatter(&label)
        .x_desc(&chart.x.label)
        .y_desc(&chart.y.label)
        .draw()?;

    let mut colors = PALETTE.iter().cycle();
    let mut ends = Vec::new();
    for series in &chart.series {
        let line = |y: fn(&Point) -> Option<f64>| {
            let shown =
                move |point: &Point| Some((point.x, y(point)?)).filter(|(x, y)| is_shown(*x) && is_shown(*y));
            series.points.iter().filter_map(shown)
        };
        let points: Vec<(f64, f64)> = line(|point| Some(point.y)).collect();
        // The name of a law is at its start.
        let end = if series.is_guide { points.first() } else { points.last() };
        let end = end.map(|end| context.plotting_area().map_coordinate(end));
        let mut style = GUIDE.stroke_width(2);
        if series.is_guide {
            context.draw_series(DashedLineSeries::new(points, 7, 5, style))?;
        } else {
            let color = colors.next().unwrap_or(&INK);
            let mut band: Vec<(f64, f64)> = line(|point| Some(point.spread?[1])).collect();
            band.reverse();
            band.splice(0..0, line(|point| Some(point.spread?[0])));
            if band.len() > 2 {
                context.draw_series([Polygon::new(band, color.mix(0.22).filled())])?;
            }
            style = color.filled().stroke_width(2);
            context.draw_series(LineSeries::new(points, style).point_size(5))?;
        }
        ends.extend(end.map(|end| (series, end, style)));
    }
    // The names stand beside the plot, where no line touches them; those that would overlap move apart. In a narrow chart
    // they are a list in the corner below the falling lines.
    let (left, top) = area.get_base_pixel();
    let (columns, rows) = context.plotting_area().get_pixel_range();
    let column = if is_narrow { columns.start + 34 } else { columns.end + 14 } - left;
    ends.sort_by_key(|(_, (_, y), _)| *y);
    let named = ends.iter().filter(|(series, ..)| !series.is_guide).count() as i32;
    let mut free = if is_narrow { rows.end - top - 17 * named } else { i32::MIN };
    for (series, (x, y), style) in ends {
        let text = (FONT, 14, &INK).into_text_style(area);
        if series.is_guide {
            let pos = Pos::new(HPos::Left, VPos::Bottom);
            area.draw_text(&series.name, &text.pos(pos), (x - left, y - top - 3))?;
            continue;
        }
        let (x, y) = if is_narrow { (column - 29, free) } else { (x - left, y - top) };
        let moved = y.max(free);
        free = moved + 17;
        area.draw(&PathElement::new([(x + 5, y), (column - 3, moved)], style.stroke_width(1)))?;
        area.draw_text(&series.name, &text.pos(Pos::new(HPos::Left, VPos::Center)), (column, moved))?;
    }
    Ok(())
}
