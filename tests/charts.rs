//! Charts as SVG.

#![allow(clippy::unwrap_used)]

use weekender::numbers::chart::{Axis, Corner, Figure, LineChart, Look, Point, Series, svg};

fn series(name: &str, look: Look, law: impl Fn(f64) -> f64) -> Series {
    let point = |power: i32| {
        let x = 2_f64.powi(power);
        Point { x, y: law(x), spread: Some([0.8 * law(x), 1.3 * law(x)]) }
    };
    Series { name: name.to_owned(), points: (0..8).map(point).collect(), look }
}

fn figure(series: Vec<Series>) -> Figure {
    let chart = LineChart {
        title: "Error".to_owned(),
        x: Axis::new("seconds"),
        y: Axis::new("RMSE"),
        series,
        legend: Some(Corner::UpperRight),
    };
    let (title, about) = ("A title".to_owned(), "and a line".to_owned());
    Figure { title, about, size: [480, 360], columns: 1, panels: vec![chart] }
}

#[test]
fn a_chart_has_its_texts_and_colours() {
    let text = svg(&figure(vec![
        series("slope -1/2", Look::Guide, |x| 0.3 / x.sqrt()),
        series("independent", Look::Measured, |x| 0.1 / x.sqrt()),
        series("sobol", Look::Measured, |x| 0.05 / x.powf(0.7)),
    ]))
    .unwrap();
    assert!(text.starts_with("<svg") && text.trim_end().ends_with("</svg>"));
    for word in ["A title", "and a line", "seconds", "RMSE", "slope -1/2", "independent", "sobol"] {
        assert!(text.lines().any(|line| line.trim() == word), "{word}");
    }
    assert!(["#0072B2", "#D55E00"].iter().all(|colour| text.contains(colour)));
}

#[test]
fn what_cannot_be_shown_is_left_out() {
    let values = [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-300, 1e300];
    let points = values.map(|y| Point { x: y, y, spread: Some([-y, y]) }).to_vec();
    let odd = Series { name: "odd".to_owned(), points, look: Look::Measured };
    let none = Series { name: "none".to_owned(), points: Vec::new(), look: Look::Guide };
    svg(&figure(vec![odd, none])).unwrap();
    svg(&Figure { panels: Vec::new(), ..figure(Vec::new()) }).unwrap();
}
