//! Lines over two axes.

use super::axis::position;
use super::style::{Area, Drawn, FAINT_INK, FINE_GRID, FONT, GRID, GUIDE, INK, PALETTE};
use super::{LineChart, Look, Point};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// A chart that is narrower than this has its names inside, in points.
const NARROW: u32 = 480;

pub fn draw(area: &Area, chart: &LineChart) -> Drawn {
    let is_narrow = area.dim_in_pixel().0 < NARROW;
    let mut builder = ChartBuilder::on(area);
    let measured = chart.series.iter().filter(|series| series.look == Look::Measured);
    let longest = measured.map(|series| series.name.chars().count()).max().unwrap_or(0);
    builder.margin(8).margin_right(18 + if is_narrow { 0 } else { 15 * longest as i32 / 2 });
    builder.x_label_area_size(46).y_label_area_size(64);
    if !chart.title.is_empty() {
        builder.caption(&chart.title, (FONT, 17, &INK));
    }
    let mut context = builder.build_cartesian_2d(chart.x.ruler(), chart.y.ruler())?;
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
    let mut ends = Vec::new();
    for series in &chart.series {
        let at = |point: &Point| Some((position(point.x)?, position(point.y)?));
        let points: Vec<(f64, f64)> = series.points.iter().filter_map(at).collect();
        // The name of a law is at its start.
        let end = if series.look == Look::Guide { points.first() } else { points.last() };
        let end = end.filter(|_| !series.name.is_empty());
        let end = end.map(|end| context.plotting_area().map_coordinate(end));
        let style = match series.look {
            Look::Guide => {
                let style = GUIDE.stroke_width(2);
                context.draw_series(DashedLineSeries::new(points, 7, 5, style))?;
                style
            }
            Look::Measured => {
                let color = PALETTE[colors % PALETTE.len()];
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
                context.draw_series(LineSeries::new(points, style).point_size(5))?;
                style
            }
        };
        ends.extend(end.map(|end| (series, end, style)));
    }
    // The names stand beside the plot, where no line touches them; those that would overlap move apart. In a narrow chart
    // they are a list in the corner below the falling lines.
    let (left, top) = area.get_base_pixel();
    let (columns, rows) = context.plotting_area().get_pixel_range();
    let column = if is_narrow { columns.start + 34 } else { columns.end + 14 } - left;
    ends.sort_by_key(|(_, (_, y), _)| *y);
    let named = ends.iter().filter(|(series, ..)| series.look == Look::Measured).count() as i32;
    let mut free = if is_narrow { rows.end - top - 17 * named } else { i32::MIN };
    for (series, (x, y), style) in ends {
        let (x, y) = if is_narrow && series.look == Look::Measured {
            (column - 29, free)
        } else {
            (x - left, y - top)
        };
        let text = (FONT, 14, &INK).into_text_style(area);
        if series.look == Look::Guide {
            let pos = Pos::new(HPos::Left, VPos::Bottom);
            area.draw_text(&series.name, &text.pos(pos), (x, y - 3))?;
            continue;
        }
        let moved = y.max(free);
        free = moved + 17;
        area.draw(&PathElement::new([(x + 5, y), (column - 3, moved)], style.stroke_width(1)))?;
        area.draw_text(&series.name, &text.pos(Pos::new(HPos::Left, VPos::Center)), (column, moved))?;
    }
    Ok(())
}
