//! Charts as SVG.

use weekender::numbers::chart::{Axis, Figure, LineChart, Point, Series, svg};

fn figure(series: Vec<Series>) -> Figure {
    let axis = |label: &str| Axis { label: label.to_owned(), limits: [1e-300, 1e300] };
    let chart = LineChart { title: "Error".to_owned(), x: axis("seconds"), y: axis("RMSE"), series };
    let (title, about) = ("A title".to_owned(), "and a line".to_owned());
    Figure { title, about, size: [480, 360], columns: 1, panels: vec![chart] }
}

#[test]
fn unshowable_points_are_left_out() {
    let values = [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-300, 1e300];
    let points = values.map(|y| Point { x: y, y, spread: Some([-y, y]) }).to_vec();
    let odd = Series { name: "odd".to_owned(), points, is_guide: false };
    let none = Series { name: "none".to_owned(), points: Vec::new(), is_guide: true };
    svg(&figure(vec![odd, none])).unwrap();
    svg(&Figure { panels: Vec::new(), ..figure(Vec::new()) }).unwrap();
    let mut empty = figure(Vec::new());
    empty.panels[0].x.limits = [f64::INFINITY, 0.0];
    svg(&empty).unwrap();
}
