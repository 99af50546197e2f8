//! A packet of lanes over time, with and without refill: a row per lane, a column per step. The paths are the tracer's.

use super::answers::Answers;
use super::command::Command;
use super::model::document::Document;
use super::model::remembered::Dock;
use super::theme;
use crate::backends::explain::{Activity, Timeline, timeline};
use crate::render_cpu::{Isa, PathRecorder};
use eframe::egui::{self, Align2, Color32, Rect, RichText, Sense, TextStyle, Ui, WidgetInfo, vec2};

/// Samples that each lane traces.
const SAMPLES: u64 = 12;

/// The greatest height of a lane, in points.
const ROW_MAX: f32 = 12.0;

/// Space for the heading of a timeline, in points.
const HEADING: f32 = 18.0;

/// What was asked for last.
struct Asked {
    document: Document,
    lanes: usize,
}

/// The timelines of one packet.
struct Traced {
    number: u64,
    /// Without and with refill, or why there are none.
    timelines: Result<[Timeline; 2], String>,
}

/// The panel's timelines, recorded by a background thread.
#[derive(Default)]
pub struct Packet {
    asked: Option<Asked>,
    number: u64,
    traced: Option<Traced>,
    answers: Answers<Traced>,
}

impl Packet {
    /// Records the packet of the picture's middle while the panel is shown.
    pub fn follow(
        &mut self,
        context: &egui::Context,
        document: &Document,
        lanes: Option<usize>,
        is_moving: bool,
    ) {
        while let Some(traced) = self.answers.take() {
            if traced.number == self.number {
                self.traced = Some(traced);
            }
        }
        let Some(lanes) = lanes else {
            (self.asked, self.traced) = (None, None);
            return;
        };
        let is_asked = self
            .asked
            .as_ref()
            .is_some_and(|asked| asked.lanes == lanes && asked.document.has_same_film(document));
        if is_asked || is_moving {
            return;
        }
        // An invalid document is reported elsewhere.
        let Ok(job) = document.job(1) else { return };
        self.number += 1;
        let number = self.number;
        let record = move || {
            let isa = Isa::available().into_iter().max().unwrap_or(Isa::Portable);
            let recorder = PathRecorder::new(&job, isa, None);
            let settings = job.settings();
            let paths_of = |lane: usize| -> Vec<_> {
                let pixel = pixel_of(lane, lanes, [settings.width, settings.height]);
                (0..SAMPLES).map(|sample| recorder.record(pixel, sample)).collect()
            };
            let paths: Vec<_> = (0..lanes).map(paths_of).collect();
            let timelines = [false, true].map(|refill| timeline(job.scene(), &paths, refill));
            Traced { number, timelines: Ok(timelines) }
        };
        let substitute = move |reason: String| Traced { number, timelines: Err(reason) };
        self.answers.ask("packet", context, record, substitute);
        self.asked = Some(Asked { document: document.clone(), lanes });
    }

    /// The numbers of steps without and with refill; `None` until they are recorded.
    pub fn steps(&self) -> Option<[usize; 2]> {
        let [without, with] = self.traced.as_ref()?.timelines.as_ref().ok()?;
        Some([without.len(), with.len()])
    }

    /// Draws the panel.
    pub fn ui(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let frame = theme::panel(egui::Margin::symmetric(12, 6));
        egui::Panel::bottom("packet").frame(frame).resizable(true).default_size(210.0).size_range(120.0..=520.0).show(
            ui,
            |ui| {
                let weak = ui.visuals().weak_text_color();
                ui.horizontal_wrapped(|ui| {
                    let title = "One packet in the middle of the picture: a row per lane, a column per step";
                    ui.label(RichText::new(title).small().color(weak)).on_hover_text(format!(
                        "Each lane traces {SAMPLES} samples of its own pixel. All lanes of a packet take their steps \
                         together, one ray each."
                    ));
                    for (activity, name) in LEGEND {
                        let (place, _) = ui.allocate_exact_size(vec2(10.0, 10.0), Sense::hover());
                        ui.painter().rect_filled(place, 2.0, colour(activity, ui));
                        ui.label(RichText::new(name).small().color(weak));
                    }
                    if ui.small_button("Close").clicked() {
                        commands.push(Command::Dock(Dock::Lanes));
                    }
                });
                let words = match self.traced.as_ref().map(|traced| &traced.timelines) {
                    Some(Ok(timelines)) => return paint(ui, timelines),
                    Some(Err(reason)) => format!("No paths: {reason}"),
                    None => "Recording paths…".to_owned(),
                };
                ui.centered_and_justified(|ui| ui.label(RichText::new(words).color(weak)));
            },
        );
    }
}

/// The colours' meanings.
const LEGEND: [(Activity, &str); 5] = [
    (Activity::Camera, "from the camera"),
    (Activity::Matte, "off a matte surface"),
    (Activity::Metal, "off metal"),
    (Activity::Glass, "off or through glass"),
    (Activity::Waits, "waits"),
];

fn colour(activity: Activity, ui: &Ui) -> Color32 {
    match activity {
        Activity::Camera => Color32::from_rgb(92, 150, 255),
        Activity::Matte => Color32::from_rgb(235, 150, 60),
        Activity::Metal => Color32::from_rgb(170, 175, 185),
        Activity::Glass => Color32::from_rgb(70, 200, 150),
        Activity::Waits => ui.visuals().faint_bg_color.gamma_multiply(0.6),
    }
}

/// The pixel of a lane: a block of pixels around the middle of the picture, as wide as it is high or twice as wide.
fn pixel_of(lane: usize, lanes: usize, [width, height]: [u32; 2]) -> [u32; 2] {
    let columns = 1_u32 << (lanes.max(1).ilog2().div_ceil(2));
    let [x, y] = [lane as u32 % columns, lane as u32 / columns];
    [(width / 2 + x).min(width - 1), (height / 2 + y).min(height - 1)]
}

/// What a timeline says, in one sentence.
fn heading(timeline: &Timeline, is_refilled: bool) -> String {
    let (steps, share) = (timeline.len(), 100.0 * timeline.share_at_work());
    if is_refilled {
        format!(
            "With refill, a lane starts its next path at once: {steps} steps, {share:.0} % of the lanes at work"
        )
    } else {
        format!("Without, all wait for the longest path: {steps} steps, {share:.0} % of the lanes at work")
    }
}

/// Draws both timelines at one scale.
fn paint(ui: &mut Ui, timelines: &[Timeline; 2]) {
    let room = ui.available_rect_before_wrap();
    let response = ui.allocate_rect(room, Sense::hover());
    let headings = [heading(&timelines[0], false), heading(&timelines[1], true)];
    let said = headings.join(". ");
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, &said));
    let steps = timelines.iter().map(Timeline::len).max().unwrap_or(0).max(1);
    let lanes = timelines[0].lanes.len().max(1);
    let column = room.width() / steps as f32;
    let row = ((0.5 * room.height() - HEADING) / lanes as f32).clamp(1.0, ROW_MAX);
    let (font, weak) = (TextStyle::Small.resolve(ui.style()), ui.visuals().text_color());
    let mut top = room.top();
    for (timeline, heading) in timelines.iter().zip(headings) {
        ui.painter().text(
            room.left_top() + vec2(0.0, top - room.top()),
            Align2::LEFT_TOP,
            heading,
            font.clone(),
            weak,
        );
        top += HEADING;
        let gap = if column > 3.0 && row > 3.0 { 1.0 } else { 0.0 };
        for (lane, activities) in timeline.lanes.iter().enumerate() {
            for (step, activity) in activities.iter().enumerate() {
                let corner = egui::pos2(room.left() + step as f32 * column, top + lane as f32 * row);
                let cell = Rect::from_min_size(corner, vec2(column - gap, row - gap));
                ui.painter().rect_filled(cell, 0.0, colour(*activity, ui));
            }
        }
        top += lanes as f32 * row + 4.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::origin::Origin;
    use crate::app::tests::dressed;
    use crate::stages::Stage;
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    fn document(stage: &str) -> Document {
        let mut document = Document::new(Origin::of_stage(Stage::find(stage).unwrap()));
        document.set_size([32, 18]);
        document
    }

    /// Waits for the timelines that have been asked for.
    fn take(packet: &mut Packet) {
        let traced = packet.answers.wait().unwrap();
        packet.answers.answer(&egui::Context::default()).give(traced);
    }

    /// The panel with the timelines of a stage.
    fn panel(stage: &str, lanes: usize, size: [f32; 2]) -> Harness<'static, (Packet, Vec<Command>)> {
        let (mut packet, context) = (Packet::default(), egui::Context::default());
        packet.follow(&context, &document(stage), Some(lanes), false);
        take(&mut packet);
        packet.follow(&context, &document(stage), Some(lanes), true);
        let draw = |ui: &mut Ui, (packet, commands): &mut (Packet, Vec<Command>)| packet.ui(ui, commands);
        let mut harness = dressed(size).build_ui_state(draw, (packet, Vec::new()));
        harness.run_steps(3);
        harness
    }

    #[test]
    fn it_is_said_why_no_paths_were_recorded() {
        let mut harness = panel("red-sphere", 2, [700.0, 400.0]);
        assert!(harness.state().0.steps().is_some());
        let timelines = Err("the program failed (on purpose)".to_owned());
        harness.state_mut().0.traced = Some(Traced { number: 1, timelines });
        harness.run_steps(3);
        assert!(harness.query_by_label("No paths: the program failed (on purpose)").is_some());
        assert_eq!(harness.state().0.steps(), None);
    }

    #[test]
    fn timelines_are_recorded_once_for_each_picture() {
        let (mut packet, context) = (Packet::default(), egui::Context::default());
        let mut document = document("metal");
        packet.follow(&context, &document, None, false);
        assert!(packet.asked.is_none(), "the panel is not shown");
        packet.follow(&context, &document, Some(4), true);
        assert!(packet.asked.is_none(), "something is moving");
        packet.follow(&context, &document, Some(4), false);
        assert_eq!((packet.number, packet.steps()), (1, None));
        take(&mut packet);
        packet.follow(&context, &document, Some(4), false);
        let [without, with] = packet.steps().unwrap();
        assert!(packet.number == 1 && without >= with && with >= SAMPLES as usize, "{without} {with}");
        packet.follow(&context, &document, Some(8), false);
        assert_eq!(packet.number, 2, "other lanes");
        document.settings.seed += 1;
        packet.follow(&context, &document, Some(8), false);
        assert_eq!(packet.number, 3, "another picture");
        take(&mut packet);
        packet.follow(&context, &document, None, false);
        assert!(packet.steps().is_none() && packet.asked.is_none());
    }
}
