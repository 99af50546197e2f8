//! The lanes of a core over time, with and without refill: a row per lane, a column per step. The paths are the
//! tracer's.

use crate::app::commands::Snapshot;
use crate::app::model::{Device, Document, best_isa};
use crate::app::toolkit::widgets::{hint, small, swatch};
use crate::app::toolkit::{Query, theme};
use crate::backends::explain::{Activity, Timeline, timeline};
use crate::progressive::describe::counted;
use crate::render_cpu::PathRecorder;
use crate::stages::Shading;
use eframe::egui::{self, Color32, Rect, RichText, ScrollArea, Sense, Ui, WidgetInfo, vec2};

/// Samples that each lane traces.
const SAMPLES: u64 = 12;

/// The distance of columns, and that of rows at least and at most, in points; 1 of it is a gap.
const COLUMN: f32 = 11.8;
const ROWS: std::ops::RangeInclusive<f32> = 4.0..=12.0;

/// Height of the heading of a timeline, points.
const HEADING: f32 = 24.0;

/// The timelines without and with refill, recorded by a background thread while they are shown.
#[derive(Default)]
pub struct Lanes {
    /// By document, its size, and number of lanes.
    query: Query<(Document, [u32; 2], usize), [Timeline; 2]>,
}

impl Lanes {
    /// Records `count` lanes in the middle of the picture; `None` if they are not shown.
    pub fn follow(
        &mut self,
        context: &egui::Context,
        document: &Document,
        lanes: Option<usize>,
        is_moving: bool,
    ) {
        self.query.follow();
        let Some(lanes) = lanes else {
            *self = Lanes::default();
            return;
        };
        // An invalid document is reported elsewhere.
        let Some(job) = document.job(1).ok().filter(|_| !is_moving) else { return };
        let Some(answer) = self.query.ask(context, (document.clone(), document.size(), lanes)) else {
            return;
        };
        answer.give_from("lanes", move || {
            let recorder = PathRecorder::new(&job, best_isa(), None);
            let size = [job.settings().width, job.settings().height];
            let paths_of = |lane: usize| -> Vec<_> {
                let pixel = pixel_of(lane, lanes, size);
                (0..SAMPLES).map(|sample| recorder.record(pixel, sample)).collect()
            };
            let paths: Vec<_> = (0..lanes).map(paths_of).collect();
            Ok([false, true].map(|refill| timeline(job.scene(), &paths, refill)))
        });
    }

    pub fn ui(&self, ui: &mut Ui, snapshot: &Snapshot) {
        let is_one_ray = snapshot.no_rays().is_some() || snapshot.document().rules().shading != Shading::Path;
        let empty = match (snapshot.model.remembered.device, &self.query) {
            (Device::Gpu, _) => "The graphics card has its own lanes. Choose CPU to see them.",
            (Device::Reference, _) => "The reference traces one ray at a time. Choose CPU to see lanes.",
            _ if is_one_ray => "In this stage each path is one ray, so no lane waits.",
            (_, Query { fault: Some(reason), .. }) => reason,
            (_, Query { answer: Some(timelines), .. }) => return timelines_ui(ui, timelines),
            _ => "Recording paths\u{2026}",
        };
        hint(ui, empty);
    }
}

fn timelines_ui(ui: &mut Ui, timelines: &[Timeline; 2]) {
    let height = ui.available_height();
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| timelines_in(ui, height, timelines));
}

fn timelines_in(ui: &mut Ui, height: f32, timelines: &[Timeline; 2]) {
    let lanes = timelines[0].lanes.len().max(1);
    ui.spacing_mut().item_spacing.y = 4.0;
    let count = counted(lanes as u64, "path");
    ui.add(egui::Label::new(format!(
        "A core traces {count} side by side, one per lane. Each row is a lane, each column a step. A lane whose path \
         has ended waits, unless it is refilled with the next path."
    )).wrap());
    let colours = theme::colours(ui);
    let colours = [colours.first, colours.second, colours.third, colours.fourth, colours.waits];
    ui.horizontal_wrapped(|ui| {
        let names = ["from the camera", "off matte", "off metal", "glass", "waits"];
        names.into_iter().zip(&colours).for_each(|(name, colour)| swatch(ui, *colour, name));
    });
    let steps = timelines.iter().map(Timeline::len).max().unwrap_or(0).max(1);
    let room = height - ui.min_rect().height() - HEADING - 8.0;
    let row = (room / lanes as f32).clamp(*ROWS.start(), *ROWS.end());
    // Side by side, since a dock is wide and low.
    ui.columns_const(|columns: &mut [Ui; 2]| {
        for (ui, (timeline, name)) in
            columns.iter_mut().zip(timelines.iter().zip(["Without refill", "With refill"]))
        {
            let column = (ui.available_width() / steps as f32).min(COLUMN);
            let (steps, share) = (timeline.len(), 100.0 * timeline.share_at_work());
            let figures = format!("{steps} steps, {share:.0} % of the lanes at work");
            ui.horizontal(|ui| {
                ui.label(RichText::new(name).small().strong());
                small(ui, &figures);
            });
            let size = vec2(column * timeline.len() as f32, row * lanes as f32);
            let (place, response) = ui.allocate_exact_size(size, Sense::hover());
            response
                .widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, format!("{name}: {figures}")));
            paint(ui, timeline, place, vec2(column, row), &colours);
        }
    });
}

fn paint(ui: &Ui, timeline: &Timeline, place: Rect, pitch: egui::Vec2, colours: &[Color32; 5]) {
    let gap = if pitch.min_elem() > 3.0 { 1.0 } else { 0.0 };
    for (lane, activities) in timeline.lanes.iter().enumerate() {
        for (step, activity) in activities.iter().enumerate() {
            let corner = place.min + vec2(step as f32, lane as f32) * pitch;
            let cell = Rect::from_min_size(corner, pitch - egui::Vec2::splat(gap));
            let colour = colours[match activity {
                Activity::Camera => 0,
                Activity::Matte => 1,
                Activity::Metal => 2,
                Activity::Glass => 3,
                Activity::Waits => 4,
            }];
            ui.painter().rect_filled(cell, 0.0, colour);
        }
    }
}

/// The pixel of a lane: a block of pixels around the middle of the picture, as wide as it is high or twice as wide.
fn pixel_of(lane: usize, lanes: usize, [width, height]: [u32; 2]) -> [u32; 2] {
    let columns = 1_u32 << (lanes.max(1).ilog2().div_ceil(2));
    let [x, y] = [lane as u32 % columns, lane as u32 / columns];
    [(width / 2 + x).min(width - 1), (height / 2 + y).min(height - 1)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::Origin;
    use crate::stages::Stage;

    #[test]
    fn timelines_are_recorded_once_for_each_picture() {
        let (mut lanes, context) = (Lanes::default(), egui::Context::default());
        let mut document = Document::new(Origin::of_stage(Stage::find("metal").unwrap()));
        document.set_size([32, 18]);
        lanes.follow(&context, &document, None, false);
        lanes.follow(&context, &document, Some(4), true);
        assert!(lanes.query.asked.is_none(), "they are not shown, or something is moving");
        lanes.follow(&context, &document, Some(4), false);
        assert!(lanes.query.answer.is_none());
        lanes.query.answer = lanes.query.answers.wait().and_then(Result::ok);
        let [without, with] = lanes.query.answer.as_ref().unwrap().each_ref().map(Timeline::len);
        assert!(without >= with && with >= SAMPLES as usize, "{without} {with}");
        lanes.follow(&context, &document, Some(4), false);
        assert!(!lanes.query.answers.is_open(), "nothing has changed");
        document.settings.seed += 1;
        lanes.follow(&context, &document, Some(4), false);
        assert!(lanes.query.answers.wait().is_some_and(|traced| traced.is_ok()), "another picture");
        lanes.follow(&context, &document, None, false);
        assert!(lanes.query.answer.is_none() && lanes.query.asked.is_none());
    }
}
