//! The plot of error against tracing seconds, on logarithmic axes: a curve for each backend since the last restart, the
//! expected continuation, and the target, which the user can type or drag.

use super::command::Command;
use super::facts::Facts;
use super::prediction::{FARTHEST, points, prediction};
use super::theme;
use super::widgets::{About, FIELD, Number, compact};
use crate::numbers::statistics::fit::{Point, Prediction};
use crate::progressive::{HistoryPoint, Status, Stop};
use eframe::egui::{
    self, Align2, Color32, CursorIcon, Pos2, Rangef, Rect, RichText, Sense, Ui, Vec2, WidgetInfo,
};
use egui_plot::{
    AxisHints, GridInput, GridMark, HLine, HoverPosition, Line, LineStyle, Plot, PlotPoint, PlotPoints,
    PlotTransform, PlotUi, Points, Text,
};
use std::fmt::Write;

/// The range of targets, RMSE.
const TARGETS: std::ops::RangeInclusive<f64> = 1e-6..=1.0;

/// The largest number of decades for which an axis has grid lines.
const MOST_DECADES: f64 = 40.0;

/// Spacing of grid lines on the left axis, in points: from the smallest that gets labels to the one with full labels.
const LABEL_SPACING: Rangef = Rangef { min: 8.0, max: 14.0 };

/// How close the pointer must be to the target line to grab it, in points.
const GRIP: f32 = 8.0;

/// Draws the plot. `target` is the error at which the render ends.
pub fn ui(ui: &mut Ui, target: &mut Option<f64>, facts: &Facts, commands: &mut Vec<Command>) {
    let status = &facts.status;
    let frame = theme::panel(egui::Margin::symmetric(12, 6));
    egui::Panel::bottom("error plot")
        .frame(frame)
        .resizable(true)
        .default_size(240.0)
        .size_range(120.0..=700.0)
        .show(ui, |ui| {
            header(ui, target, facts, commands);
            if points(status).is_empty() {
                let weak = ui.visuals().weak_text_color();
                let words = match status.error {
                    Some(error) => {
                        let rmse = compact(error.rmse);
                        format!(
                            "The film's estimated error is {rmse}; the curve begins with the next samples"
                        )
                    }
                    None => "No estimate yet".to_owned(),
                };
                ui.centered_and_justified(|ui| ui.label(RichText::new(words).color(weak)));
            } else {
                plot(ui, target, status);
            }
        });
}

/// The header: a title, the target as a number, and buttons for the plot's data.
fn header(ui: &mut Ui, target: &mut Option<f64>, facts: &Facts, commands: &mut Vec<Command>) {
    let weak = ui.visuals().weak_text_color();
    ui.horizontal_wrapped(|ui| {
        let title = "Estimated error (RMSE, linear radiance) against seconds; dots at 1, 2, 4, 8 … samples";
        ui.label(RichText::new(title).small().color(weak)).on_hover_text(
            "Sobol points are spread most evenly at powers of two; between two dots the error falls a little less",
        );
        if let Some(target) = target {
            ui.label(RichText::new("target").small());
            let help = "The render ends at this error; the line in the plot can be dragged, too";
            Number::new(About::new("Target error", help), TARGETS).speed(1e-4).field(ui, FIELD, target);
        } else {
            let button = ui.add(egui::Button::new("Set a target").small());
            if button.on_hover_text("End the render at an estimated error; its line in the plot can be dragged").clicked() {
                *target = Some(Stop::NOISE);
            }
        }
        if ui.small_button("Copy").clicked() {
            ui.ctx().copy_text(csv(&facts.status.history));
        }
    });
}

fn plot(ui: &mut Ui, stop_at: &mut Option<f64>, status: &Status) {
    let accent = theme::accent(ui);
    let visuals = ui.visuals();
    let (weak, strong) = (visuals.weak_text_color(), visuals.strong_text_color());
    let (of_gpu, of_both) = (visuals.warn_fg_color, visuals.error_fg_color);
    let color_of = move |backend: &str| match backend {
        "cpu" => accent,
        "gpu" => of_gpu,
        "cpu,gpu" => of_both,
        _ => strong,
    };
    let curves = curves(&status.history);
    let all = points(status);
    let target = *stop_at;
    let font = egui::TextStyle::Small.resolve(ui.style());
    let name_size = ui.painter().layout_no_wrap(GUIDE.to_owned(), font, weak).size();
    let prediction = prediction(status, target);
    let plot = Plot::new("error")
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .show_background(false)
        .sense(Sense::hover())
        .set_margin_fraction(egui::vec2(0.03, 0.12))
        .x_axis_formatter(|mark, _| power(mark.value, " s"))
        .custom_y_axes(vec![
            AxisHints::new_y().formatter(|mark, _| power(mark.value, "")).label_spacing(LABEL_SPACING),
        ])
        .x_grid_spacer(decades)
        .y_grid_spacer(decades)
        .grid_color(weak.gamma_multiply(GRID_SHARE))
        .label_formatter(|hover| {
            let (HoverPosition::NearDataPoint { position: at, .. }
            | HoverPosition::Elsewhere { position: at }) = hover;
            Some(hover_words(&status.history, [at.x, at.y]))
        });
    let line = ui.scope_id().with("target line");
    let is_held = ui.ctx().is_being_dragged(line);
    let response = plot.show(ui, |plot| {
        // The axes stay fixed while the target is dragged.
        plot.set_auto_bounds(!is_held);
        let lines: Vec<&[[f64; 2]]> = curves.iter().map(|(_, points)| &points[..]).collect();
        guide(plot, &all, &lines, (name_size, weak));
        if let Some(target) = target.filter(|target| *target > 0.0) {
            let style = LineStyle::dashed_loose();
            plot.hline(HLine::new("target", target.log10()).color(weak).style(style).allow_hover(false));
            if let (Some(prediction), Some(now)) = (prediction, all.last()) {
                ahead(plot, now, target, &prediction, weak);
            }
        }
        for (backend, points) in &curves {
            curve(plot, backend, points, color_of(backend));
        }
        // A single curve needs no name: the status bar shows the backend.
        for (backend, points) in curves.iter().filter(|_| curves.len() > 1) {
            name_curve(plot, backend, points, color_of(backend));
        }
        // The newest estimate, between two powers of two.
        if let (Some(last), Some(now)) = (status.history.last().map(logarithms), all.last()) {
            let newest = vec![last, logarithm(now)];
            let color = status.backend.as_ref().map_or(accent, |backend| color_of(backend.name));
            plot.line(Line::new("now", PlotPoints::from(newest)).color(color).width(1.0).allow_hover(false));
        }
    });
    if let Some(target) = stop_at {
        drag_target(ui, line, target, &response.transform);
    }
}

/// Opacity of the grid relative to weak text.
const GRID_SHARE: f32 = 0.4;

/// Grid lines at powers of ten, and fainter ones at 2 and 5 times these; none if they would merge into solid grey.
fn decades(grid: GridInput) -> Vec<GridMark> {
    let (low, high) = grid.bounds;
    if !(0.0..=MOST_DECADES).contains(&(high - low)) {
        return Vec::new();
    }
    let powers = low.floor() as i32..=high.floor() as i32;
    let marks = powers.flat_map(|power| {
        [(1.0_f64, 1.0), (2.0, 0.3), (5.0, 0.3)]
            .map(|(digit, step_size)| GridMark { value: f64::from(power) + digit.log10(), step_size })
    });
    marks.filter(|mark| (low..=high).contains(&mark.value)).collect()
}

/// Moves the target with the pointer that grabbed its line.
fn drag_target(ui: &Ui, line: egui::Id, target: &mut f64, plot: &PlotTransform) {
    let level = plot.position_from_point_y(target.log10());
    let grip = Rect::from_x_y_ranges(plot.frame().x_range(), level - GRIP..=level + GRIP);
    let response = ui.interact(grip.intersect(plot.frame().expand(GRIP)), line, Sense::drag());
    response.widget_info(|| WidgetInfo::slider(true, *target, "Target error, as a line"));
    let Some(pointer) = response.interact_pointer_pos() else {
        if response.hovered() {
            ui.ctx().set_cursor_icon(CursorIcon::ResizeVertical);
        }
        return;
    };
    if response.drag_started() {
        ui.data_mut(|data| data.insert_temp(line, pointer.y - level));
    }
    let above_pointer = ui.data(|data| data.get_temp(line).unwrap_or(0.0_f32));
    let at = plot.value_from_position(egui::pos2(pointer.x, pointer.y - above_pointer));
    if response.drag_delta().y != 0.0 {
        *target = two_digits(10_f64.powf(at.y)).clamp(*TARGETS.start(), *TARGETS.end());
    }
    ui.ctx().set_cursor_icon(CursorIcon::ResizeVertical);
}

/// Rounds to two significant digits.
fn two_digits(value: f64) -> f64 {
    format!("{value:.1e}").parse().unwrap_or(value)
}

/// The text for the pointer's position: a point with its samples, or just the coordinates.
fn hover_words(history: &[HistoryPoint], [x, y]: [f64; 2]) -> String {
    let place = format!("{:.3} s\nerror {:.5}", 10_f64.powf(x), 10_f64.powf(y));
    match history.iter().find(|point| logarithms(point) == [x, y]) {
        Some(point) => format!("{} samples per pixel\n{place}", point.samples_per_pixel),
        None => place,
    }
}

/// What the guide line shows.
const GUIDE: &str = "4x the time, half the error";

/// Where along the guide line its name can stand, as shares of its length, and which corner of the name is there.
const NAME_PLACES: [(f64, Align2); 6] = [
    (0.5, Align2::LEFT_BOTTOM),
    (0.75, Align2::RIGHT_TOP),
    (0.75, Align2::LEFT_BOTTOM),
    (0.5, Align2::RIGHT_TOP),
    (0.25, Align2::LEFT_BOTTOM),
    (1.0, Align2::RIGHT_TOP),
];

/// The guide for independent samples from the first estimate on: four times the time halves the error. Its name, of this
/// size, stands where none of the `lines` strikes it through.
fn guide(plot: &mut PlotUi, points: &[Point], lines: &[&[[f64; 2]]], (size, color): (Vec2, Color32)) {
    let (Some(first), Some(last)) = (points.first(), points.last()) else { return };
    let [x, y] = logarithm(first);
    let across = logarithm(last)[0] - x;
    let ends = vec![[x, y], [x + across, y - 0.5 * across]];
    let line = Line::new(GUIDE, PlotPoints::from(ends));
    plot.line(line.color(color).style(LineStyle::dotted_dense()).width(1.0).allow_hover(false));
    // Shorter lines have no room for their name.
    if across > 0.5 {
        let at = |share: f64| PlotPoint::new(x + share * across, y - 0.5 * share * across);
        let is_free = |(share, corner): &(f64, Align2)| {
            let name = corner.anchor_size(plot.screen_from_plot(at(*share)), size).shrink(1.0);
            let mut pieces = lines.iter().flat_map(|line| line.windows(2));
            let on_screen = |[x, y]: [f64; 2]| plot.screen_from_plot(PlotPoint::new(x, y));
            !pieces.any(|piece| crosses(name, [on_screen(piece[0]), on_screen(piece[1])]))
        };
        if let Some((share, corner)) = NAME_PLACES.into_iter().find(is_free) {
            let words = RichText::new(GUIDE).small().color(color);
            plot.text(Text::new("guide", at(share), words).anchor(corner).allow_hover(false));
        }
    }
}

/// Whether a straight line between two points goes through a rectangle.
fn crosses(rect: Rect, [from, to]: [Pos2; 2]) -> bool {
    let mut inside = Rangef::new(0.0, 1.0);
    for axis in 0..2 {
        let (way, start) = (to[axis] - from[axis], from[axis]);
        let [low, high] = [rect.min[axis] - start, rect.max[axis] - start];
        if way == 0.0 {
            if low > 0.0 || high < 0.0 {
                return false;
            }
            continue;
        }
        let [a, b] = [low / way, high / way];
        inside = Rangef::new(inside.min.max(a.min(b)), inside.max.min(a.max(b)));
    }
    inside.min <= inside.max
}

/// From the newest estimate to the predicted time at the target, with its uncertainty.
fn ahead(plot: &mut PlotUi, now: &Point, target: f64, prediction: &Prediction, color: Color32) {
    let y = target.log10();
    let at = |seconds_from_now: f64| [(now.time + seconds_from_now.min(FARTHEST)).log10(), y];
    let way = vec![logarithm(now), at(prediction.time)];
    let range = prediction.range.map(at).to_vec();
    plot.line(Line::new("expected", PlotPoints::from(way)).color(color).width(1.0).allow_hover(false));
    plot.line(Line::new("expected", PlotPoints::from(range)).color(color).width(4.0).allow_hover(false));
}

fn curve(plot: &mut PlotUi, name: &str, points: &[[f64; 2]], color: Color32) {
    plot.line(Line::new(name, PlotPoints::from(points.to_vec())).color(color).width(1.5));
    plot.points(Points::new(name, PlotPoints::from(points.to_vec())).color(color).radius(2.5));
}

/// Writes the backend's name above the middle of its curve. That area is free, because errors fall.
fn name_curve(plot: &mut PlotUi, name: &str, points: &[[f64; 2]], color: Color32) {
    let (Some([x0, y0]), Some([x1, y1])) = (points.first(), points.last()) else { return };
    let middle = PlotPoint::new(0.5 * (x0 + x1), 0.5 * (y0 + y1));
    let words = RichText::new(name).small().color(color);
    plot.text(Text::new(name, middle, words).anchor(Align2::LEFT_BOTTOM).allow_hover(false));
}

/// Splits the history into one curve for each backend; a curve begins where the previous one ends.
fn curves(history: &[HistoryPoint]) -> Vec<(&'static str, Vec<[f64; 2]>)> {
    let mut curves: Vec<(&'static str, Vec<[f64; 2]>)> = Vec::new();
    for point in history.iter().filter(|point| point.rmse_estimate > 0.0 && point.trace_seconds > 0.0) {
        let at = logarithms(point);
        match curves.last_mut() {
            Some((name, points)) if *name == point.backend => points.push(at),
            Some((_, points)) => {
                let from = points.last().copied();
                curves.push((point.backend, from.into_iter().chain([at]).collect()));
            }
            None => curves.push((point.backend, vec![at])),
        }
    }
    curves
}

fn logarithms(point: &HistoryPoint) -> [f64; 2] {
    [point.trace_seconds.log10(), point.rmse_estimate.log10()]
}

fn logarithm(point: &Point) -> [f64; 2] {
    [point.time.log10(), point.error.log10()]
}

/// The points as CSV with a header line.
pub fn csv(history: &[HistoryPoint]) -> String {
    let mut text = String::from("backend,samples_per_pixel,trace_seconds,rmse_estimate,rel_mse_estimate\n");
    for point in history {
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "{},{},{},{},{}",
            point.backend,
            point.samples_per_pixel,
            point.trace_seconds,
            point.rmse_estimate,
            point.rel_mse_estimate
        );
    }
    text
}

/// A label of a logarithmic axis.
fn power(exponent: f64, unit: &str) -> String {
    let decade = 10_f64.powf(exponent.floor());
    format!("{}{unit}", compact((10_f64.powf(exponent) / decade).round() * decade))
}

#[cfg(test)]
mod tests;
