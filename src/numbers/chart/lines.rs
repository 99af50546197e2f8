//! Lines over two axes.

use super::axis::position;
use super::style::{FAINT_INK, FINE_GRID, FONT, GRID, GUIDE, INK, color};
use super::{LineChart, Look, Point};
use plotters::chart::SeriesAnno;
use plotters::coord::Shift;
use plotters::prelude::*;

type Drawn<B> = Result<(), DrawingAreaErrorKind<<B as DrawingBackend>::ErrorType>>;

pub fn draw<B: DrawingBackend>(area: &DrawingArea<B, Shift>, chart: &LineChart) -> Drawn<B> {
    let points = || chart.series.iter().flat_map(|series| &series.points);
    let x = chart.x.ruler(points().map(|point| point.x));
    let y = chart
        .y
        .ruler(points().flat_map(|point| [point.y].into_iter().chain(point.spread.into_iter().flatten())));

    let mut builder = ChartBuilder::on(area);
    builder.margin(8).margin_right(18);
    builder.x_label_area_size(46).y_label_area_size(64);
    if !chart.title.is_empty() {
        builder.caption(&chart.title, (FONT, 17, &INK));
    }
    let mut context = builder.build_cartesian_2d(x, y)?;
    context
        .configure_mesh()
        .bold_line_style(GRID.stroke_width(1))
        .light_line_style(FINE_GRID.stroke_width(1))
        .axis_style(FAINT_INK.stroke_width(1))
        .set_all_tick_mark_size(4)
        .label_style((FONT, 14, &INK))
        .axis_desc_style((FONT, 15, &INK))
        .x_desc(&chart.x.label)
        .y_desc(&chart.y.label)
        .draw()?;

    let mut colors = 0;
    for series in &chart.series {
        let at = |point: &Point| Some((position(point.x)?, position(point.y)?));
        let points: Vec<(f64, f64)> = series.points.iter().filter_map(at).collect();
        match series.look {
            Look::Guide => {
                let style = GUIDE.stroke_width(2);
                let line = DashedLineSeries::new(points, 7, 5, style);
                name(context.draw_series(line)?, &series.name, style);
            }
            Look::Measured => {
                let color = color(colors);
                colors += 1;
                let end = |end: usize| {
                    let at = move |point: &Point| Some((position(point.x)?, position(point.spread?[end])?));
                    series.points.iter().filter_map(at)
                };
                let band: Vec<(f64, f64)> =
                    end(0).chain(end(1).collect::<Vec<_>>().into_iter().rev()).collect();
                if band.len() > 2 {
                    context.draw_series([Polygon::new(band, color.mix(0.22).filled())])?;
                }
                let style = color.filled().stroke_width(2);
                let line = LineSeries::new(points, style).point_size(5);
                name(context.draw_series(line)?, &series.name, style);
            }
        }
    }
    let Some(corner) = chart.legend.clone() else { return Ok(()) };
    context
        .configure_series_labels()
        .position(corner)
        .margin(12)
        .legend_area_size(34)
        .label_font((FONT, 14, &INK))
        .background_style(WHITE.mix(0.9))
        .border_style(GRID.stroke_width(1))
        .draw()
}

/// Adds a series to the legend if it has a name.
fn name<'a, B: DrawingBackend + 'a>(series: &mut SeriesAnno<'a, B>, name: &str, style: ShapeStyle) {
    if !name.is_empty() {
        let length = 26;
        series.label(name).legend(move |(x, y)| PathElement::new([(x, y), (x + length, y)], style));
    }
}
