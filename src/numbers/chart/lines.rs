//! Lines over two axes.

use super::axis::position;
use super::style::{FAINT_INK, FINE_GRID, FONT, GRID, GUIDE, INK, Units, color};
use super::{LineChart, Look, Point};
use plotters::chart::SeriesAnno;
use plotters::coord::Shift;
use plotters::prelude::*;

type Drawn<B> = Result<(), DrawingAreaErrorKind<<B as DrawingBackend>::ErrorType>>;

pub fn draw<B: DrawingBackend>(area: &DrawingArea<B, Shift>, chart: &LineChart, units: Units) -> Drawn<B> {
    let points = || chart.series.iter().flat_map(|series| &series.points);
    let x = chart.x.ruler(points().map(|point| point.x));
    let y = chart
        .y
        .ruler(points().flat_map(|point| [point.y].into_iter().chain(point.spread.into_iter().flatten())));

    let mut builder = ChartBuilder::on(area);
    builder.margin(units.px(8.0)).margin_right(units.px(18.0));
    builder.x_label_area_size(units.px(46.0)).y_label_area_size(units.px(64.0));
    if !chart.title.is_empty() {
        builder.caption(&chart.title, (FONT, units.px(17.0), &INK));
    }
    let mut context = builder.build_cartesian_2d(x, y)?;
    context
        .configure_mesh()
        .bold_line_style(GRID.stroke_width(units.size(1.0)))
        .light_line_style(FINE_GRID.stroke_width(units.size(1.0)))
        .axis_style(FAINT_INK.stroke_width(units.size(1.0)))
        .set_all_tick_mark_size(units.px(4.0))
        .label_style((FONT, units.px(14.0), &INK))
        .axis_desc_style((FONT, units.px(15.0), &INK))
        .x_desc(&chart.x.label)
        .y_desc(&chart.y.label)
        .draw()?;

    let mut colors = 0;
    for series in &chart.series {
        let at = |point: &Point| Some((position(point.x)?, position(point.y)?));
        let points: Vec<(f64, f64)> = series.points.iter().filter_map(at).collect();
        match series.look {
            Look::Guide => {
                let style = GUIDE.stroke_width(units.size(1.5));
                let line = DashedLineSeries::new(points, units.px(7.0), units.px(5.0), style);
                name(context.draw_series(line)?, &series.name, style, units);
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
                let style = color.filled().stroke_width(units.size(2.0));
                let line = LineSeries::new(points, style).point_size(units.size(4.5));
                name(context.draw_series(line)?, &series.name, style, units);
            }
        }
    }
    let Some(corner) = chart.legend.clone() else { return Ok(()) };
    context
        .configure_series_labels()
        .position(corner)
        .margin(units.px(12.0))
        .legend_area_size(units.px(34.0))
        .label_font((FONT, units.px(14.0), &INK))
        .background_style(WHITE.mix(0.9))
        .border_style(GRID.stroke_width(units.size(1.0)))
        .draw()
}

/// Adds a series to the legend if it has a name.
fn name<'a, B: DrawingBackend + 'a>(
    series: &mut SeriesAnno<'a, B>,
    name: &str,
    style: ShapeStyle,
    units: Units,
) {
    if !name.is_empty() {
        let length = units.px(26.0);
        series.label(name).legend(move |(x, y)| PathElement::new([(x, y), (x + length, y)], style));
    }
}
