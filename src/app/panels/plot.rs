//! The plot of error against tracing seconds, on logarithmic axes: a curve for each backend, the
//! expected continuation, and the goal; and when a render will reach its goal.

use super::compare;
use crate::app::commands::{PanelContext, Snapshot};
use crate::app::model::Device;
use crate::app::toolkit::number::{compact, samples_words};
use crate::app::toolkit::theme;
use crate::app::toolkit::widgets::{hint, small, swatch};
use crate::numbers::rounded;
use crate::numbers::statistics::fit::{Point, Prediction, predict};
use crate::progressive::{NOISE_TARGET_FIRST_SAMPLES, Status};
use eframe::egui::{self, Color32, Rangef, Sense, Ui, UiBuilder, Vec2b};
use egui_plot::{
    AxisHints, HLine, HoverPosition, Line, LineStyle, Plot, PlotPoints, Points, uniform_grid_spacer,
};
use std::sync::Arc;

/// Predictions more than this many seconds ahead are not shown.
const FARTHEST: f64 = 1e6;

/// Draws the plot, and what tells two devices apart.
pub fn ui(ui: &mut Ui, cx: &PanelContext) {
    let status = &cx.status;
    if points(status).is_empty() {
        hint(ui, "The error is known after four samples per pixel.");
        return;
    }
    let drawn = Drawn::of(ui, cx);
    ui.horizontal_wrapped(|ui| {
        ui.label("Four times the samples halve the error.");
        drawn.names().for_each(|(colour, name)| swatch(ui, colour, name));
    });
    let race = Race::of(cx);
    let (room, width) = (ui.available_rect_before_wrap(), if race.is_some() { NUMBERS } else { 0.0 });
    if let Some(race) = race {
        let left = UiBuilder::new().max_rect(room.with_max_x(room.left() + width - 16.0));
        ui.scope_builder(left, |ui| race.ui(ui, cx));
    }
    let right = UiBuilder::new().max_rect(room.with_min_x(room.left() + width));
    ui.scope_builder(right, |ui| plot(ui, drawn));
}

/// Width of the numbers beside the plot, points.
const NUMBERS: f32 = 264.0;

/// The picture traced by one device, and by another.
struct Race([(Device, Arc<Status>); 2]);

impl Race {
    fn of(cx: &Snapshot) -> Option<Race> {
        let other = cx.model.other_device()?;
        let mine = (cx.model.remembered.device, Arc::clone(&cx.status));
        Some(Race([mine, (other, Arc::clone(cx.other.as_ref()?))]))
    }

    /// How much faster a device is than the other one; `None` until both have traced, each alone.
    fn factor(&self) -> Option<(Device, f64)> {
        let [(mine, status), (other, of_other)] = &self.0;
        let speeds = [status, of_other].map(|status| status.rays_per_second());
        let is_pure = |status: &Status| {
            status.contributions.iter().all(|part| part.backend.name == status.contributions[0].backend.name)
        };
        let is_known = speeds.iter().all(|speed| *speed > 0.0) && is_pure(status) && is_pure(of_other);
        is_known.then(|| {
            if speeds[0] >= speeds[1] {
                (*mine, speeds[0] / speeds[1])
            } else {
                (*other, speeds[1] / speeds[0])
            }
        })
    }

    fn ui(&self, ui: &mut Ui, cx: &PanelContext) {
        ui.spacing_mut().item_spacing.y = 4.0;
        for (device, status) in &self.0 {
            let name = device.label();
            let speed = two_digits(status.rays_per_second() / 1e6);
            let words = egui::RichText::new(format!("{name}: {speed} million rays per second"));
            ui.label(words.strong().color(style(ui, device.name()).0));
            let error = status
                .error
                .map_or_else(String::new, |error| format!(", error {} %", two_digits(100.0 * error.rmse)));
            let seconds = two_digits(status.trace.as_secs_f64());
            small(ui, format!("{} in {seconds} s{error}", samples_words(status.samples_per_pixel)));
        }
        match self.factor() {
            Some((device, factor)) => {
                let name = device.label();
                ui.label(format!("{name} is {} times as fast.", two_digits(factor)));
            }
            None if self.0[0].1.contributions.len() > 1 => {
                _ = hint(ui, "Several devices have traced this picture. R starts again, to measure one.");
            }
            None => {}
        }
        if cx.verdict.is_some() {
            compare::verdict(ui, cx);
        }
    }
}

type Curve = (Color32, String, Vec<[f64; 2]>);

/// What is drawn, each with its colour and name.
struct Drawn {
    curves: Vec<Curve>,
    /// From the newest error to the goal.
    expected: Option<Curve>,
    /// The error at which the render ends, as [`at`] places it.
    goal: Option<(Color32, String, f64)>,
}

impl Drawn {
    fn of(ui: &Ui, cx: &Snapshot) -> Self {
        let (status, goal) = (&cx.status, cx.document().stop.noise);
        let &theme::Colours { third, fourth: of_other, weak, .. } = theme::colours(ui);
        let own = curves(status).into_iter().map(|(backend, points)| {
            let (colour, name) = style(ui, backend);
            (colour, name.to_owned(), points)
        });
        let mut drawn: Vec<Curve> = own.collect();
        if let Some(other) = &cx.other {
            let is_device = cx.model.other_device().is_some();
            let [[_, name], _] = cx.model.side_names();
            for (backend, points) in curves(other) {
                drawn.push((if is_device { style(ui, backend).0 } else { of_other }, name.clone(), points));
            }
        }
        let now = points(status).last().map(|(_, point)| at(point));
        let expected = prediction(status, goal).zip(now).zip(goal).map(|((ahead, [x, y]), goal)| {
            let seconds = 10_f64.powf(x) + ahead.time.min(FARTHEST);
            let line = vec![[x, y], at(&Point { time: seconds, error: goal })];
            (third, "expected".to_owned(), line)
        });
        let goal = goal.map(|goal| {
            let percent = 100.0 * goal;
            (weak, format!("goal {} %", two_digits(percent)), percent.log10())
        });
        Drawn { curves: drawn, expected, goal }
    }

    /// The legend. A backend that took turns has several curves and one name.
    fn names(&self) -> impl Iterator<Item = (Color32, &str)> {
        let first =
            |place: &usize| self.curves[..*place].iter().all(|(_, name, _)| *name != self.curves[*place].1);
        let curves = (0..self.curves.len()).filter(first).map(|place| &self.curves[place]);
        let curves = curves.chain(&self.expected).map(|(colour, name, _)| (*colour, name.as_str()));
        curves.chain(self.goal.iter().map(|(colour, name, _)| (*colour, name.as_str())))
    }
}

fn plot(ui: &mut Ui, Drawn { curves, expected, goal }: Drawn) {
    let axis = |hints: AxisHints<'static>, name: &str| {
        hints.label(egui::RichText::new(name).small()).formatter(|mark, _| power(mark.value))
    };
    let plot = Plot::new("error")
        .allow_drag(false)
        .allow_zoom(Vec2b::FALSE)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .show_background(false)
        .sense(Sense::hover())
        .set_margin_fraction(egui::vec2(0.03, 0.12))
        .custom_x_axes(vec![axis(AxisHints::new_x(), "seconds")])
        .custom_y_axes(vec![
            axis(AxisHints::new_y(), "error, %").label_spacing(Rangef { min: 8.0, max: 14.0 }),
        ])
        .x_grid_spacer(uniform_grid_spacer(|_| [1.0, 1.0, 1.0]))
        .y_grid_spacer(uniform_grid_spacer(|_| [1.0, 1.0, 1.0]))
        .grid_color(theme::colours(ui).line)
        .label_formatter(|hover| {
            // Beside the curves there is nothing to tell.
            let HoverPosition::NearDataPoint { position: place, .. } = hover else { return None };
            let [seconds, error] = [place.x, place.y].map(|power| compact(10_f64.powf(power)));
            Some(format!("{seconds} s\nerror {error} %"))
        });
    plot.show(ui, |plot| {
        if let Some((colour, name, height)) = goal {
            let line = HLine::new(name, height).color(colour);
            plot.hline(line.style(LineStyle::dashed_loose()).allow_hover(false));
        }
        if let Some((colour, name, points)) = expected {
            let line = Line::new(name, PlotPoints::from(points)).color(colour);
            plot.line(line.style(LineStyle::dashed_dense()).width(1.5).allow_hover(false));
        }
        for (colour, name, points) in curves {
            plot.points(Points::new(name.clone(), points.clone()).color(colour).radius(2.5));
            plot.line(Line::new(name, points).color(colour).width(1.5));
        }
    });
}

/// The colour and the name of a backend's curve.
fn style(ui: &Ui, backend: &str) -> (Color32, &'static str) {
    let &theme::Colours { first: of_cpu, second: of_gpu, .. } = theme::colours(ui);
    match backend {
        "cpu" => (of_cpu, "CPU"),
        "gpu" => (of_gpu, "GPU"),
        _ => (ui.visuals().strong_text_color(), "reference"),
    }
}

/// A number with two significant digits.
fn two_digits(value: f64) -> String {
    compact(rounded(value, value, 2))
}

/// Splits a history and the newest error into one curve for each backend; a curve begins where the previous one ends.
fn curves(status: &Status) -> Vec<(&'static str, Vec<[f64; 2]>)> {
    let mut curves: Vec<(&'static str, Vec<[f64; 2]>)> = Vec::new();
    for (backend, point) in points(status) {
        let at = at(&point);
        match curves.last_mut() {
            Some((name, points)) if *name == backend => points.push(at),
            last => {
                let from = last.and_then(|(_, points)| points.last().copied());
                curves.push((backend, from.into_iter().chain([at]).collect()));
            }
        }
    }
    curves
}

/// Where a point lies in the plot: the logarithms of seconds and of per cent.
fn at(point: &Point) -> [f64; 2] {
    [point.time.log10(), (100.0 * point.error).log10()]
}

/// A label of a logarithmic axis.
fn power(exponent: f64) -> String {
    let decade = 10_f64.powf(exponent.floor());
    compact((10_f64.powf(exponent) / decade).round() * decade)
}

/// All error estimates with their backends, the newest last.
fn points(status: &Status) -> Vec<(&'static str, Point)> {
    let history = status.history.iter().map(|p| (p.backend, p.trace_seconds, p.rmse_estimate));
    let now = status.backend.as_ref().zip(status.error);
    let now = now.map(|(backend, error)| (backend.name, status.trace.as_secs_f64(), error.rmse));
    let known = history.chain(now).filter(|(_, time, error)| *time > 0.0 && *error > 0.0);
    known.map(|(backend, time, error)| (backend, Point { time, error })).collect()
}

/// Predicts in how many seconds the error will reach the target. `None` if it already has, or with too little data.
pub fn prediction(status: &Status, target: Option<f64>) -> Option<Prediction> {
    if status.samples_per_pixel < NOISE_TARGET_FIRST_SAMPLES || status.phase.is_over() {
        return None;
    }
    let error = status.error?;
    // As if the samples that the film held at the start had been traced at the same speed.
    let all = status.samples_per_pixel as f64 * status.seconds_per_sample();
    let before = all - status.trace.as_secs_f64();
    // Switching the backend bends the curve, so only the current backend's points are used.
    let backend = status.history.last().map(|point| point.backend);
    let mut history: Vec<Point> = status
        .history
        .iter()
        .rev()
        .take_while(|point| {
            Some(point.backend) == backend && point.samples_per_pixel >= NOISE_TARGET_FIRST_SAMPLES
        })
        .map(|point| Point { time: before + point.trace_seconds, error: point.rmse_estimate })
        .collect();
    history.reverse();
    let now = Point { time: all, error: error.rmse };
    let from_now = |time: f64| (time - now.time).max(0.0);
    predict(&history, now, target?)
        .map(|found| Prediction { time: from_now(found.time), range: found.range.map(from_now) })
        .filter(|found| found.time < FARTHEST)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::ErrorEstimate;
    use crate::job::render::BackendInfo;
    use crate::progressive::{Contribution, HistoryPoint, Phase};
    use std::time::Duration;

    fn point(backend: &'static str, samples: u64, trace_seconds: f64) -> HistoryPoint {
        let rmse_estimate = 0.1 / (samples as f64).sqrt();
        HistoryPoint {
            backend,
            samples_per_pixel: samples,
            trace_seconds,
            rmse_estimate,
            rel_mse_estimate: 0.1,
        }
    }

    #[test]
    fn each_backend_has_a_curve_that_joins_the_one_before() {
        let exact = HistoryPoint { rmse_estimate: 0.0, ..point("cpu", 4, 3.0) };
        let history = vec![point("cpu", 2, 1.0), point("cpu", 4, 2.0), exact, point("gpu", 8, 2.1)];
        let found = curves(&Status { history, ..Status::default() });
        let names: Vec<_> = found.iter().map(|(name, points)| (*name, points.len())).collect();
        assert_eq!(names, [("cpu", 2), ("gpu", 2)]);
        assert_eq!(found[0].1[1], found[1].1[0]);
    }

    #[test]
    fn the_prediction_counts_from_now_and_tells_its_range() {
        let mut status = Status {
            samples_per_pixel: 100,
            phase: Phase::Tracing,
            trace: Duration::from_secs(10),
            error: Some(ErrorEstimate { rmse: 0.004, rmse_deviation: 0.0, rel_mse: 0.0 }),
            ..Status::default()
        };
        let found = prediction(&status, Some(0.002)).unwrap();
        assert!((found.time - 30.0).abs() < 1e-6, "{found:?}");
        let now = Point { time: 10.0, error: 0.004 };
        let [low, high] = predict(&[], now, 0.002).unwrap().range;
        assert_eq!(found.range, [low - 10.0, high - 10.0]);
        assert!(found.range[0] < 30.0 && found.range[1] > 30.0, "{found:?}");
        assert_eq!(prediction(&status, Some(0.01)), None);
        assert_eq!(prediction(&status, None), None);
        // A quarter of the samples is of this run, which takes as long for each of them.
        let backend = BackendInfo { name: "cpu", device: String::new(), lanes: 1, threads: 1 };
        status.contributions = vec![Contribution { backend, samples_per_pixel: 25 }];
        assert!((prediction(&status, Some(0.002)).unwrap().time - 120.0).abs() < 1e-6);
        status.contributions.clear();
        for (samples, is_predicted) in
            [(NOISE_TARGET_FIRST_SAMPLES - 1, false), (NOISE_TARGET_FIRST_SAMPLES, true)]
        {
            status.samples_per_pixel = samples;
            assert_eq!(prediction(&status, Some(0.002)).is_some(), is_predicted, "{samples}");
        }
    }

    fn at(
        backend: &'static str,
        samples_per_pixel: u64,
        trace_seconds: f64,
        rmse_estimate: f64,
    ) -> HistoryPoint {
        HistoryPoint { backend, samples_per_pixel, trace_seconds, rmse_estimate, rel_mse_estimate: 0.0 }
    }

    fn tracing(history: Vec<HistoryPoint>, seconds: f64, rmse: f64) -> Status {
        Status {
            samples_per_pixel: 1000,
            phase: Phase::Tracing,
            trace: Duration::from_secs_f64(seconds),
            error: Some(ErrorEstimate { rmse, rmse_deviation: 0.0, rel_mse: 0.0 }),
            history,
            ..Status::default()
        }
    }

    #[test]
    fn only_the_clear_estimates_of_the_present_backend_count() {
        let now = Point { time: 16.0, error: 0.02 };
        let few = vec![at("gpu", 16, 4.0, 0.05), at("gpu", 200, 12.0, 0.027)];
        let many = [few.clone(), vec![at("gpu", 400, 13.0, 0.026), at("gpu", 800, 14.0, 0.021)]].concat();
        for counted in [few, many] {
            let before = vec![at("gpu", 64, 1.0, 0.9), at("cpu", 128, 2.0, 0.8), at("gpu", 15, 3.0, 0.7)];
            let points: Vec<Point> =
                counted.iter().map(|p| Point { time: p.trace_seconds, error: p.rmse_estimate }).collect();
            let expected = predict(&points, now, 0.01).unwrap();
            let found = prediction(&tracing([before, counted].concat(), now.time, now.error), Some(0.01));
            let from_now = |time: f64| time - now.time;
            let (time, range) = (from_now(expected.time), expected.range.map(from_now));
            assert_eq!(found, Some(Prediction { time, range }));
        }
        let status = tracing(Vec::new(), now.time, now.error);
        assert!(prediction(&status, Some(0.01)).is_some());
        let over = Status { phase: Phase::Failed("the device is gone".to_owned()), ..status.clone() };
        assert_eq!(prediction(&over, Some(0.01)), None);
        assert_eq!(prediction(&Status { error: None, ..status }, Some(0.01)), None);
    }
}
