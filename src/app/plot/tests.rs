//! Tests of the plot.

use super::*;
use crate::app::tests::{dressed, rest_at};
use crate::film::ErrorEstimate;
use crate::job::render::BackendInfo;
use crate::progressive::Phase;
use eframe::egui::{Event, Modifiers, PointerButton, Pos2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
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
