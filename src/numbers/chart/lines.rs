//! Lines over two axes.

use super::axis::{Ruler, position};
use super::style::{FAINT_INK, FINE_GRID, FONT, GRID, GUIDE, INK, Units, color};
use super::{LineChart, Look, Series};
use plotters::coord::Shift;
use plotters::prelude::*;

type Drawn<B> = Result<(), DrawingAreaErrorKind<<B as DrawingBackend>::ErrorType>>;

/// A point and its spread, as positions on both axes.
struct Placed {
    at: (f64, f64),
    spread: Option<[f64; 2]>,
}

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
        let placed: Vec<Placed> = series
            .points
            .iter()
            .filter_map(|point| {
                let at = (position(point.x)?, position(point.y)?);
                let ends = |[low, high]: [f64; 2]| Some([position(low)?, position(high)?]);
                Some(Placed { at, spread: point.spread.and_then(ends) })
            })
            .collect();
        match series.look {
            Look::Guide => guide(&mut context, series, &placed, units)?,
            Look::Measured => {
                measured(&mut context, series, &placed, colors, units)?;
                colors += 1;
            }
        }
    }
    legend(&mut context, chart, units)
}

type Context<'a, B> = ChartContext<'a, B, Cartesian2d<Ruler, Ruler>>;

fn guide<'a, B: DrawingBackend + 'a>(
    context: &mut Context<'a, B>,
    series: &Series,
    placed: &[Placed],
    units: Units,
) -> Drawn<B> {
    let style = GUIDE.stroke_width(units.size(1.5));
    let line =
        DashedLineSeries::new(placed.iter().map(|point| point.at), units.px(7.0), units.px(5.0), style);
    let drawn = context.draw_series(line)?;
    if !series.name.is_empty() {
        let length = units.px(26.0);
        drawn.label(&series.name).legend(move |(x, y)| {
            let dash = |from: i32, to: i32| (x + length * from / 5, x + length * to / 5);
            let lines = [dash(0, 2), dash(3, 5)].map(|(from, to)| vec![(from, y), (to, y)]);
            let [first, second] = lines.map(|line| PathElement::new(line, style));
            EmptyElement::at((0, 0)) + first + second
        });
    }
    Ok(())
}

fn measured<'a, B: DrawingBackend + 'a>(
    context: &mut Context<'a, B>,
    series: &Series,
    placed: &[Placed],
    index: usize,
    units: Units,
) -> Drawn<B> {
    let style = color(index).stroke_width(units.size(2.0));
    let band = |end: usize| placed.iter().filter_map(move |point| Some((point.at.0, point.spread?[end])));
    let outline: Vec<(f64, f64)> = band(0).chain(band(1).collect::<Vec<_>>().into_iter().rev()).collect();
    if outline.len() > 2 {
        context.draw_series([Polygon::new(outline, color(index).mix(0.22).filled())])?;
    }
    let drawn = context.draw_series(LineSeries::new(placed.iter().map(|point| point.at), style))?;
    if !series.name.is_empty() {
        let (length, radius) = (units.px(26.0), units.px(4.5));
        drawn.label(&series.name).legend(move |(x, y)| {
            let line = PathElement::new(vec![(x, y), (x + length, y)], style);
            EmptyElement::at((0, 0)) + line + Circle::new((x + length / 2, y), radius, color(index).filled())
        });
    }
    let radius = units.px(4.5);
    context.draw_series(placed.iter().map(|point| Circle::new(point.at, radius, color(index).filled())))?;
    Ok(())
}

fn legend<'a, B: DrawingBackend + 'a>(
    context: &mut Context<'a, B>,
    chart: &LineChart,
    units: Units,
) -> Drawn<B> {
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
