//! Horizontal bars.

use super::style::{FAINT_INK, FONT, INK, Units, color};
use super::{Axis, BarChart, Scale};
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

type Drawn<B> = Result<(), DrawingAreaErrorKind<<B as DrawingBackend>::ErrorType>>;

const ROW_TEXT: f64 = 15.0;
const TITLE_TEXT: f64 = 17.0;
/// Gap between text and bars, points.
const GAP: f64 = 8.0;
/// Height of a bar as a share of its row.
const BAR_SHARE: f64 = 0.66;

pub fn draw<B: DrawingBackend>(area: &DrawingArea<B, Shift>, chart: &BarChart, units: Units) -> Drawn<B> {
    let (width, height) = area.dim_in_pixel();
    let (width, height) = (width as i32, height as i32);
    let row_style = (FONT, units.px(ROW_TEXT), &INK).into_text_style(area);
    let text_width = |text: &str| -> Result<i32, _> {
        Ok::<i32, DrawingAreaErrorKind<B::ErrorType>>(area.estimate_text_size(text, &row_style)?.0 as i32)
    };
    let mut name_width = 0;
    let mut note_width = 0;
    for bar in &chart.bars {
        name_width = name_width.max(text_width(&bar.name)?);
        note_width = note_width.max(text_width(&bar.note)?);
    }
    let gap = units.px(GAP);
    let left = name_width + 3 * gap + gap / 2;
    let right = width - note_width - 3 * gap;
    let top = if chart.title.is_empty() { gap } else { units.px(2.0 * TITLE_TEXT) };
    let bottom = height - units.px(3.2 * ROW_TEXT);

    if !chart.title.is_empty() {
        let style = (FONT, units.px(TITLE_TEXT), &INK).into_text_style(area);
        area.draw_text(&chart.title, &style, (2 * gap, units.px(0.5 * TITLE_TEXT)))?;
    }

    let largest = chart.bars.iter().flat_map(|bar| [bar.value, bar.spread.map_or(0.0, |[_, high]| high)]);
    let largest = largest.fold(0.0, f64::max);
    let limits = Some([0.0, if largest > 0.0 { largest } else { 1.0 }]);
    let ruler = Axis { limits, ..Axis::new("", Scale::Linear) }.ruler(std::iter::empty());
    let x = |value: f64| left + (f64::from(right - left) * value / ruler.range.end).round() as i32;

    let axis = FAINT_INK.stroke_width(units.size(1.0));
    let label = (FONT, units.px(14.0), &FAINT_INK).into_text_style(area);
    let centred = label.pos(Pos::new(HPos::Center, VPos::Top));
    for tick in &ruler.ticks {
        let line = vec![(x(*tick), top), (x(*tick), bottom + units.px(4.0))];
        let grid = super::style::GRID.stroke_width(units.size(1.0));
        area.draw(&PathElement::new(line, grid))?;
        area.draw_text(&ruler.text(*tick), &centred, (x(*tick), bottom + units.px(7.0)))?;
    }
    area.draw_text(&chart.label, &centred, ((left + right) / 2, bottom + units.px(27.0)))?;

    let pitch = f64::from(bottom - top) / chart.bars.len().max(1) as f64;
    for (row, bar) in chart.bars.iter().enumerate() {
        let middle = top + ((row as f64 + 0.5) * pitch).round() as i32;
        let half = ((0.5 * BAR_SHARE * pitch).round() as i32).max(1);
        let corners = [(left, middle - half), (x(bar.value), middle + half)];
        area.draw(&Rectangle::new(corners, color(bar.kind).filled()))?;
        let mut end = x(bar.value);
        if let Some([low, high]) = bar.spread {
            let line = INK.stroke_width(units.size(1.5));
            let cap = half / 3;
            for (from, to) in [
                ((x(low), middle), (x(high), middle)),
                ((x(low), middle - cap), (x(low), middle + cap)),
                ((x(high), middle - cap), (x(high), middle + cap)),
            ] {
                area.draw(&PathElement::new(vec![from, to], line))?;
            }
            end = end.max(x(high));
        }
        let name = row_style.pos(Pos::new(HPos::Right, VPos::Center));
        let note = row_style.pos(Pos::new(HPos::Left, VPos::Center));
        area.draw_text(&bar.name, &name, (left - gap, middle))?;
        area.draw_text(&bar.note, &note, (end + gap, middle))?;
    }
    area.draw(&PathElement::new(vec![(left, top), (left, bottom)], axis))
}
