//! Lines over two axes.

use super::axis::position;
use super::style::{FAINT_INK, FINE_GRID, FONT, GRID, GUIDE, INK, Units, color};
use super::{LineChart, Look, Point};
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

type Drawn<B> = Result<(), DrawingAreaErrorKind<<B as DrawingBackend>::ErrorType>>;

pub fn draw<B: DrawingBackend>(area: &DrawingArea<B, Shift>, chart: &LineChart, units: Units) -> Drawn<B> {
    let points = || chart.series.iter().flat_map(|series| &series.points);
    let x = chart.x.ruler(points().map(|point| point.x));
    let y = chart
        .y
        .ruler(points().flat_map(|point| [point.y].into_iter().chain(point.spread.into_iter().flatten())));

    let mut builder = ChartBuilder::on(area);
    let measured = chart.series.iter().filter(|series| series.look == Look::Measured);
    let longest = measured.map(|series| series.name.chars().count()).max().unwrap_or(0);
    builder.margin(units.px(8.0)).margin_right(units.px(18.0 + 7.5 * longest as f64));
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
    let mut ends = Vec::new();
    for series in &chart.series {
        let at = |point: &Point| Some((position(point.x)?, position(point.y)?));
        let points: Vec<(f64, f64)> = series.points.iter().filter_map(at).collect();
        // A law has its name at its beginning.
        let end = if series.look == Look::Guide { points.first() } else { points.last() };
        let end = end.filter(|_| !series.name.is_empty());
        let end = end.map(|end| context.plotting_area().map_coordinate(end));
        let style = match series.look {
            Look::Guide => {
                let style = GUIDE.stroke_width(units.size(1.5));
                let line = DashedLineSeries::new(points, units.px(7.0), units.px(5.0), style);
                context.draw_series(line)?;
                style
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
                context.draw_series(line)?;
                style
            }
        };
        ends.extend(end.map(|end| (series, end, style)));
    }
    // The names are at the ends of the lines; those that would overlap move apart.
    let (left, top) = area.get_base_pixel();
    ends.sort_by_key(|(_, (_, y), _)| *y);
    let mut free = i32::MIN;
    for (series, (x, y), style) in ends {
        let (x, y) = (x - left, y - top);
        let text = (FONT, units.px(14.0), &INK).into_text_style(area);
        if series.look == Look::Guide {
            let pos = Pos::new(HPos::Left, VPos::Bottom);
            area.draw_text(&series.name, &text.pos(pos), (x, y - units.px(3.0)))?;
            continue;
        }
        let moved = y.max(free);
        free = moved + units.px(17.0);
        let at = (x + units.px(16.0), moved);
        area.draw(&PathElement::new([(x + units.px(5.0), y), (at.0 - units.px(3.0), at.1)], style))?;
        area.draw_text(&series.name, &text.pos(Pos::new(HPos::Left, VPos::Center)), at)?;
    }
    Ok(())
}
