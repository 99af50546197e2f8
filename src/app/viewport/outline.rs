//! The outline of a sphere in the picture.

use super::point::point_at;
use crate::app::spheres::silhouette::OutlinePoint;
use eframe::egui::{Color32, Painter, Pos2, Rect, Shape, Stroke};

/// Draws what is visible as a line, and what is hidden as dashes.
pub(super) fn paint_outline(points: &[OutlinePoint], painter: &Painter, rect: Rect) {
    // Points far outside are left out: their lines would not be seen, and their coordinates have no precision.
    let near = |place: &[f64; 2]| place.iter().all(|along| along.abs() < 30.0);
    let at = |point: &OutlinePoint| point.place.filter(near).map(|place| point_at(rect, place));
    let Some(last) = points.last() else { return };
    let mut before = last;
    let (mut lines, mut dashes) = (Vec::new(), Vec::new());
    for point in points {
        if let (Some(from), Some(to)) = (at(before), at(point)) {
            let runs = if before.is_visible && point.is_visible { &mut lines } else { &mut dashes };
            join(runs, from, to);
        }
        before = point;
    }
    close(&mut lines);
    let [shade, light] = [Color32::from_black_alpha(150), Color32::WHITE];
    for (width, colour) in [(4.0, shade), (1.75, light)] {
        for run in &lines {
            painter.add(Shape::line(run.clone(), Stroke::new(width, colour)));
        }
    }
    for (width, colour) in [(2.5, shade.gamma_multiply(0.7)), (1.25, light.gamma_multiply(0.7))] {
        for run in &dashes {
            painter.extend(Shape::dashed_line(run, Stroke::new(width, colour), 4.0, 5.0));
        }
    }
}

/// Adds a segment to the last run if it goes on from there.
fn join(runs: &mut Vec<Vec<Pos2>>, from: Pos2, to: Pos2) {
    match runs.last_mut().filter(|run| run.last() == Some(&from)) {
        Some(run) => run.push(to),
        None => runs.push(vec![from, to]),
    }
}

/// Joins the last run with the first if it ends where that one begins.
fn close(runs: &mut Vec<Vec<Pos2>>) {
    let Some(last) = runs.pop() else { return };
    match runs.first_mut().filter(|first| first.first() == last.last()) {
        Some(first) => {
            let rest = std::mem::replace(first, last);
            first.extend(rest.into_iter().skip(1));
        }
        None => runs.push(last),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::pos2;

    #[test]
    fn segments_are_joined_to_runs_that_close() {
        let [a, b, c, d] = [0.0, 1.0, 2.0, 3.0].map(|x| pos2(x, 0.0));
        let mut runs = Vec::new();
        join(&mut runs, a, b);
        join(&mut runs, b, c);
        join(&mut runs, d, a);
        assert_eq!(runs, [vec![a, b, c], vec![d, a]]);
        close(&mut runs);
        assert_eq!(runs, [[d, a, b, c]], "the last ends where the first begins");
        join(&mut runs, b, d);
        close(&mut runs);
        assert_eq!(runs, [vec![b, d, a, b, c]]);
        join(&mut runs, a, d);
        close(&mut runs);
        assert_eq!(runs, [vec![b, d, a, b, c], vec![a, d]]);
        close(&mut Vec::new());
    }
}
