//! Tests of the plot.

use super::*;
use crate::app::tests::{dressed, facts_of, leave, rest_at};
use crate::film::ErrorEstimate;
use crate::progressive::{EndReason, Phase};
use crate::render::BackendInfo;
use eframe::egui::{Event, Modifiers, PointerButton, Pos2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::sync::Arc;
use std::time::Duration;

fn point(backend: &'static str, samples: u64, trace_seconds: f64) -> HistoryPoint {
    let rmse_estimate = 0.1 / (samples as f64).sqrt();
    HistoryPoint { backend, samples_per_pixel: samples, trace_seconds, rmse_estimate, rel_mse_estimate: 0.1 }
}

#[test]
fn each_backend_has_a_curve_that_joins_the_one_before() {
    let history = [point("cpu", 2, 1.0), point("cpu", 4, 2.0), point("gpu", 8, 2.1)];
    let found = curves(&history);
    assert_eq!(
        found.iter().map(|(name, points)| (*name, points.len())).collect::<Vec<_>>(),
        [("cpu", 2), ("gpu", 2)]
    );
    assert_eq!(found[0].1[1], found[1].1[0]);
    let text = "backend,samples_per_pixel,trace_seconds,rmse_estimate,rel_mse_estimate\n\
                cpu,2,1,0.07071067811865475,0.1\ncpu,4,2,0.05,0.1\ngpu,8,2.1,0.035355339059327376,0.1\n";
    assert_eq!(csv(&history), text);
}

#[test]
fn what_has_no_logarithm_is_in_no_curve() {
    let exact = HistoryPoint { rmse_estimate: 0.0, ..point("cpu", 4, 2.0) };
    let history = [point("cpu", 2, 0.0), exact, point("cpu", 4, 100.0)];
    assert_eq!(curves(&history), [("cpu", vec![[2.0, 0.05_f64.log10()]])]);
}

#[test]
fn a_scale_has_a_line_for_each_power_of_ten_and_stays_finite() {
    let marks = |low: f64, high: f64| decades(GridInput { bounds: (low, high), base_step_size: 1.0 });
    let found = marks(-3.2, 1.5);
    let whole: Vec<f64> = found.iter().map(|mark| mark.value).filter(|value| value.fract() == 0.0).collect();
    assert_eq!(whole, [-3.0, -2.0, -1.0, 0.0, 1.0]);
    assert!(found.iter().all(|mark| (-3.2..=1.5).contains(&mark.value)));
    let log = f64::log10;
    let found: Vec<_> = marks(-1.0, 0.5).iter().map(|mark| (mark.value, mark.step_size)).collect();
    let (faint, bold) = (0.3, 1.0);
    let expected =
        [(-1.0, bold), (-1.0 + log(2.0), faint), (-1.0 + log(5.0), faint), (0.0, bold), (log(2.0), faint)];
    assert_eq!(found, expected);
    assert_eq!((marks(0.0, 40.0).len(), marks(0.0, 40.25).len()), (3 * 40 + 1, 0));
    assert_eq!(marks(2.0, 2.0).len(), 1);
    for (low, high) in [(-1.0, f64::INFINITY), (-1e300, 1e300), (f64::NAN, 1.0), (0.0, 1e9)] {
        assert!(marks(low, high).is_empty(), "{low} to {high}");
    }
}

#[test]
fn a_dot_tells_its_samples() {
    let history = [point("cpu", 4, 2.0)];
    let [x, y] = logarithms(&history[0]);
    assert_eq!(hover_words(&history, [x, y]), "4 samples per pixel\n2.000 s\nerror 0.05000");
    assert_eq!(hover_words(&history, [x, y + 1.0]), "2.000 s\nerror 0.50000");
}

#[test]
fn a_target_that_is_dragged_has_two_digits() {
    assert_eq!([0.002_134, 0.0999, 1.0].map(two_digits), [0.0021, 0.1, 1.0]);
}

/// The texts that are drawn, with the lower left corner of each.
fn texts(draw: impl FnMut(&mut Ui)) -> Vec<(String, egui::Pos2)> {
    let harness = egui_kittest::Harness::builder().with_size([600.0, 300.0]).build_ui(draw);
    let mut texts = Vec::new();
    for clipped in &harness.output().shapes {
        if let egui::Shape::Text(text) = &clipped.shape {
            let corner = text.pos + egui::vec2(0.0, text.galley.size().y);
            texts.push((text.galley.text().to_owned(), corner));
        }
    }
    texts
}

#[test]
fn several_curves_are_named_above_their_middles() {
    let history = vec![point("cpu", 4, 1.0), point("cpu", 16, 4.0)];
    let mut status = Status { history, ..Status::default() };
    let named = |status: &Status| {
        let texts = texts(|ui| plot(ui, &mut None, status));
        ["cpu", "gpu"].map(|name| texts.iter().any(|(text, _)| text == name))
    };
    assert_eq!(named(&status), [false; 2], "one curve needs no name");
    status.history.push(point("gpu", 64, 8.0));
    assert_eq!(named(&status), [true; 2]);
    let mut middle = egui::Pos2::ZERO;
    let texts = texts(|ui| {
        let ends = [[1.0, -1.0], [3.0, -4.0]];
        let shown = Plot::new("named").show(ui, |plot| name_curve(plot, "cpu", &ends, Color32::RED));
        middle = shown.transform.position_from_point(&PlotPoint::new(2.0, -2.5));
    });
    let (_, corner) = texts.iter().find(|(text, _)| text == "cpu").unwrap();
    assert!(corner.distance(middle) < 1.0, "{corner} {middle}");
}

/// Curves above the guide, below it, and from one side to the other.
#[test]
fn the_name_of_the_guide_is_struck_through_by_no_curve() {
    let at = |seconds: f64, rmse_estimate: f64| HistoryPoint { rmse_estimate, ..point("cpu", 4, seconds) };
    let above = [(0.2, 0.1), (1.0, 0.06), (3.0, 0.035), (7.0, 0.021), (10.0, 0.012), (19.0, 0.005)];
    let on_it = [(0.2, 0.1), (0.8, 0.05), (3.2, 0.025), (12.8, 0.0125)];
    let below = [(0.2, 0.1), (1.0, 0.03), (3.0, 0.015), (7.0, 0.005), (20.0, 0.002)];
    for history in [&above[..], &on_it, &below] {
        let history: Vec<_> = history.iter().map(|(seconds, rmse)| at(*seconds, *rmse)).collect();
        let (last, rmse) = (history.last().unwrap().trace_seconds, history.last().unwrap().rmse_estimate);
        let harness = plotted(status(&history, last, rmse), None);
        let names = harness.output().shapes.iter().filter_map(|clipped| match &clipped.shape {
            egui::Shape::Text(text) if text.galley.text() == GUIDE => {
                Some(Rect::from_min_size(text.pos, text.galley.size()))
            }
            _ => None,
        });
        let names: Vec<Rect> = names.collect();
        assert_eq!(names.len(), 1, "{rmse}");
        for ends in dots(&harness).windows(2) {
            assert!(!crosses(names[0].shrink(1.5), [ends[0], ends[1]]), "{rmse}: {} {ends:?}", names[0]);
        }
    }
}

#[test]
fn a_line_that_crosses_a_rectangle_is_found() {
    let rect = Rect::from_min_max(egui::pos2(10.0, 10.0), egui::pos2(20.0, 14.0));
    for (from, to, expected) in [
        ([0.0, 12.0], [30.0, 12.0], true),
        ([0.0, 9.0], [30.0, 9.0], false),
        ([15.0, 0.0], [15.0, 30.0], true),
        ([21.0, 0.0], [21.0, 30.0], false),
        ([0.0, 0.0], [30.0, 24.0], true),
        ([0.0, 20.0], [12.0, 30.0], false),
        ([12.0, 11.0], [13.0, 12.0], true),
        ([0.0, 12.0], [9.0, 12.0], false),
    ] {
        assert_eq!(crosses(rect, [from.into(), to.into()]), expected, "{from:?} {to:?}");
    }
}

#[test]
fn an_axis_is_labelled_with_round_numbers() {
    let labels = [-2.0, -2.0 + 2.0_f64.log10(), 5.0_f64.log10() - 1.0, 0.0, 2.0, 3.0 + 5.0_f64.log10()]
        .map(|exponent| power(exponent, " s"));
    assert_eq!(labels, ["0.01 s", "0.02 s", "0.5 s", "1 s", "100 s", "5000 s"]);
    assert_eq!(power(-1e-9, ""), "1", "a rounding error is no other decade");
}

/// A status with these points, whose newest estimate is the film's.
fn status(history: &[HistoryPoint], seconds: f64, rmse: f64) -> Status {
    let backend = history.last().map_or("cpu", |point| point.backend);
    Status {
        phase: Phase::Tracing,
        backend: Some(BackendInfo { name: backend, device: String::new(), lanes: 1, threads: 1 }),
        samples_per_pixel: 100,
        trace: Duration::from_secs_f64(seconds),
        error: Some(ErrorEstimate { rmse, rmse_deviation: 0.0, rel_mse: 0.0 }),
        history: history.to_vec(),
        ..Status::default()
    }
}

struct Plotted {
    status: Status,
    target: Option<f64>,
}

fn plotted(status: Status, target: Option<f64>) -> Harness<'static, Plotted> {
    let draw = |ui: &mut Ui, Plotted { status, target }: &mut Plotted| plot(ui, target, status);
    let mut harness = dressed([600.0, 300.0]).build_ui_state(draw, Plotted { status, target });
    harness.run_steps(3);
    harness
}

/// The middles of the dots, in the order of the curves.
fn dots(harness: &Harness<'_, Plotted>) -> Vec<Pos2> {
    fn gather(shape: &egui::Shape, found: &mut Vec<Pos2>) {
        match shape {
            // Those of a dotted line are smaller.
            egui::Shape::Circle(circle) if circle.radius > 2.0 => found.push(circle.center),
            egui::Shape::Vec(shapes) => shapes.iter().for_each(|shape| gather(shape, found)),
            _ => {}
        }
    }
    let mut found = Vec::new();
    harness.output().shapes.iter().for_each(|clipped| gather(&clipped.shape, &mut found));
    found
}

/// The place of the target's line.
fn line(harness: &Harness<'_, Plotted>) -> Rect {
    harness.get_by_label("Target error, as a line").rect()
}

#[test]
fn the_target_follows_the_pointer_that_holds_its_line() {
    let history = [point("cpu", 4, 1.0), point("cpu", 64, 16.0)];
    let mut harness = plotted(status(&history, 16.0, 0.0125), Some(0.02));
    assert!((line(&harness).height() - 16.0).abs() < 1e-3, "{}", line(&harness));
    let cursor = |harness: &Harness<'_, Plotted>| harness.output().platform_output.cursor_icon;
    let middle = line(&harness).center();
    rest_at(&mut harness, middle);
    assert_eq!(cursor(&harness), CursorIcon::ResizeVertical);
    rest_at(&mut harness, middle - vec2(0.0, 40.0));
    assert_ne!(cursor(&harness), CursorIcon::ResizeVertical);

    // Four times the error, which is 0.6 decades.
    let (high, low) = (dots(&harness)[0], dots(&harness)[1]);
    assert!(high.y < low.y, "errors fall");
    let per_decade = f64::from(low.y - high.y) / 4.0_f64.log10();
    let (from, button, modifiers) = (middle + vec2(0.0, 7.0), PointerButton::Primary, Modifiers::NONE);
    harness.event(Event::PointerMoved(from));
    harness.step();
    harness.event(Event::PointerButton { pos: from, button, pressed: true, modifiers });
    harness.run_steps(2);
    assert_eq!(harness.state().target, Some(0.02), "a press alone moves nothing");
    for step in 1..=8 {
        harness.event(Event::PointerMoved(from - vec2(0.0, 10.0 * step as f32)));
        harness.step();
        assert_eq!(dots(&harness), [high, low], "the axes stay");
    }
    assert_eq!(cursor(&harness), CursorIcon::ResizeVertical);
    let found = harness.state().target.unwrap();
    let expected = 0.02 * 10.0_f64.powf(80.0 / per_decade);
    assert!((found / expected - 1.0).abs() < 0.05, "{found}, not {expected}");
    assert_eq!(found, two_digits(found));
    harness.event(Event::PointerMoved(from - vec2(0.0, 5000.0)));
    harness.step();
    assert_eq!(harness.state().target, Some(1.0), "no more than that");
    harness.event(Event::PointerMoved(from + vec2(0.0, 9000.0)));
    harness.step();
    assert_eq!(harness.state().target, Some(1e-6), "no less than that");
    harness.event(Event::PointerButton { pos: from, button, pressed: false, modifiers });
    harness.run_steps(3);
    assert_ne!(dots(&harness), [high, low], "the axes show the target again");
}

struct Panel {
    facts: Facts,
    target: Option<f64>,
    commands: Vec<Command>,
}

fn panel(status: Status, target: Option<f64>) -> Harness<'static, Panel> {
    let facts = Facts { status: Arc::new(status), ..facts_of("--stage glass-schlick --size 32x18") };
    let draw = |ui: &mut Ui, Panel { facts, target, commands }: &mut Panel| {
        super::ui(ui, target, facts, commands);
    };
    let panel = Panel { facts, target, commands: Vec::new() };
    let mut harness = dressed([900.0, 500.0]).build_ui_state(draw, panel);
    harness.run_steps(3);
    harness
}

#[test]
fn the_controls_of_the_plot_do_what_they_say() {
    let mut harness = panel(status(&[point("cpu", 4, 0.5)], 3.0, 0.02), None);
    for (label, command) in [("Copy data", Command::CopyPlot), ("Save data…", Command::SavePlot)] {
        harness.get_by_label(label).click();
        harness.run_steps(2);
        assert_eq!(std::mem::take(&mut harness.state_mut().commands), [command]);
    }
    harness.get_by_label("Set a target").click();
    harness.run_steps(2);
    assert_eq!(harness.state().target, Some(Stop::NOISE));
    for target in [5.0, 1e-9, 0.25] {
        harness.state_mut().target = Some(target);
        harness.run_steps(2);
        assert_eq!(harness.state().target, Some(target), "nobody has changed it");
    }
    harness.state_mut().target = Some(0.002_123_456_7);
    harness.get_by_label("Target error").focus();
    harness.run_steps(3);
    harness.key_press(egui::Key::Tab);
    harness.run_steps(3);
    assert_eq!(harness.state().target, Some(0.002_123_456_7), "the keyboard only went by");
    for (typed, nearest) in [(5.0, 1.0), (1e-9, 1e-6), (0.5, 0.5)] {
        harness.get_by_label("Target error").set_value_accesskit(typed);
        harness.run_steps(2);
        assert_eq!(harness.state().target, Some(nearest));
    }
}
