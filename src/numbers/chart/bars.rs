//! Horizontal bars.

use super::BarChart;
use super::axis::label;
use super::style::{FAINT_INK, FONT, GRID, INK, Units, color};
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

type Drawn<B> = Result<(), DrawingAreaErrorKind<<B as DrawingBackend>::ErrorType>>;

/// Gap between text and bars, points.
const GAP: f64 = 8.0;

/// Height of a bar as a share of its row.
const BAR_SHARE: f64 = 0.66;

/// Length of the axis relative to the longest bar, so that notes have room beside it.
const ROOM: f64 = 1.3;

pub fn draw<B: DrawingBackend>(area: &DrawingArea<B, Shift>, chart: &BarChart, units: Units) -> Drawn<B> {
    let (gap, rows) = (units.px(GAP), chart.bars.len() as f64);
    let text = (FONT, units.px(15.0), &INK).into_text_style(area);
    let mut name_width = 0;
    for bar in &chart.bars {
        name_width = name_width.max(area.estimate_text_size(&bar.name, &text)?.0);
    }
    let end = |bar: &super::Bar| bar.spread.map_or(bar.value, |[_, high]| high.max(bar.value));
    let longest = chart.bars.iter().map(end).fold(0.0, f64::max);
    let longest = if longest > 0.0 { longest } else { 1.0 };

    let mut builder = ChartBuilder::on(area);
    builder.margin(gap).x_label_area_size(units.px(46.0)).y_label_area_size(name_width + 3 * gap as u32);
    if !chart.title.is_empty() {
        builder.caption(&chart.title, (FONT, units.px(17.0), &INK));
    }
    let mut context = builder.build_cartesian_2d(0.0..ROOM * longest, 0.0..rows.max(1.0))?;
    context
        .configure_mesh()
        .disable_y_mesh()
        .y_labels(0)
        .x_labels(6)
        .bold_line_style(GRID.stroke_width(units.size(1.0)))
        .light_line_style(TRANSPARENT)
        .axis_style(FAINT_INK.stroke_width(units.size(1.0)))
        .set_all_tick_mark_size(units.px(4.0))
        .label_style((FONT, units.px(14.0), &FAINT_INK))
        .axis_desc_style((FONT, units.px(14.0), &FAINT_INK))
        .x_label_formatter(&|x| label(*x))
        .x_desc(&chart.label)
        .draw()?;
    for (row, bar) in chart.bars.iter().enumerate() {
        let middle = rows - row as f64 - 0.5;
        let corners = [0.5, -0.5].map(|side| middle + side * BAR_SHARE);
        context.draw_series([Rectangle::new(
            [(0.0, corners[0]), (bar.value, corners[1])],
            color(bar.kind).filled(),
        )])?;
        let spread = bar.spread.map(|[low, high]| vec![(low, middle), (high, middle)]);
        context.draw_series(spread.map(|line| PathElement::new(line, INK.stroke_width(units.size(2.5)))))?;
        let beside = |x: f64, by: i32, side: HPos, words: &str| {
            let style = text.pos(Pos::new(side, VPos::Center));
            EmptyElement::at((x, middle)) + Text::new(words.to_owned(), (by, 0), style)
        };
        context.draw_series([
            beside(0.0, -gap, HPos::Right, &bar.name),
            beside(end(bar), gap, HPos::Left, &bar.note),
        ])?;
    }
    Ok(())
}
