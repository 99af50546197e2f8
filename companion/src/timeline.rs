//! A figure of the steps of a packet's lanes, laid out from recorded paths.

use crate::uses::Uses;
use crate::words::numbered;
use anyhow::Result;
use maud::{Markup, html};
use std::fmt::Write;
use weekender::kernel::path_record::PathRecord;
use weekender::render_cpu::{Isa, PathRecorder};
use weekender::scene::{Look, Scene};
use weekender::stages::Stage;

/// Lanes of the packet.
const LANES: u32 = 8;

/// Samples per lane.
const SAMPLES: u64 = 48;

/// The work of a lane in a step: its CSS class.
type Activity = &'static str;

const CAMERA: Activity = "from-camera";
const WAITS: Activity = "waits";

/// Meaning of the colours.
const LEGEND: [(Activity, &str); 5] = [
    (CAMERA, "a ray from the camera"),
    ("off-matte", "off a matte surface"),
    ("off-metal", "off metal"),
    ("off-glass", "off or through glass"),
    (WAITS, "waits"),
];

/// The steps of a packet: a row per lane, all equally long.
type Timeline = Vec<Vec<Activity>>;

/// The figure for a stage: the packet in the middle of its picture, without and with refill.
pub fn figure(id: &str, uses: &mut Uses) -> Result<Markup> {
    let stage = Stage::find(id)?;
    let job = stage.recipe().job()?;
    // Every level records the same steps; the portable one exists on all machines.
    let recorder = PathRecorder::new(&job, Isa::Portable, None);
    let middle = [job.settings().width / 2, job.settings().height / 2];
    // Two rows of pixels, from the middle of the picture to the right and downwards.
    let pixel = |lane: u32| [middle[0] + lane % (LANES / 2), middle[1] + lane / (LANES / 2)];
    let lane = |lane| (0..SAMPLES).map(|sample| recorder.record(pixel(lane), sample)).collect::<Vec<_>>();
    let paths: Vec<_> = (0..LANES).map(lane).collect();
    let [plain, refilled] = [false, true].map(|refill| timeline(job.scene(), &paths, refill));
    // Refill never takes longer.
    let columns = plain[0].len();
    let summary = |timeline: &Timeline| {
        let at_work = timeline.iter().flatten().filter(|activity| **activity != WAITS).count();
        let share = 100.0 * at_work as f64 / (timeline.len() * timeline[0].len()) as f64;
        format!("{} steps, {share:.0} % of the lanes at work", timeline[0].len())
    };
    Ok(html! {
        figure .timeline id={ "timeline-" (id) } {
            @for (label, timeline) in [
                ("Without refill, all lanes wait for the longest path: ", plain),
                ("With refill, a lane starts its next path at once: ", refilled),
            ] {
                p .label { (label) (summary(&timeline)) }
                (drawing(&timeline, columns))
            }
            ul .legend aria-hidden="true" {
                @for (class, meaning) in LEGEND { li { span .swatch .(class) {} (meaning) } }
            }
            (numbered(&html! {
                "The " (LANES) " lanes of a packet in the middle of the stage " code { (stage.id) } ", each with " (SAMPLES)
                " samples of its pixel: a row is a lane, a column a step. Laid out from the tracer’s own paths; only after \
                 its last sample does a refilled lane wait here."
            }, uses))
        }
    })
}

/// Lays out the paths of each lane over time as a packet traces them. With `refill`, a lane starts its next path at
/// once; otherwise all lanes start their next paths when the longest has ended.
fn timeline(scene: &Scene, paths: &[Vec<PathRecord>], refill: bool) -> Timeline {
    let mut lanes: Timeline = vec![Vec::new(); paths.len()];
    for sample in 0..SAMPLES as usize {
        for (lane, paths) in lanes.iter_mut().zip(paths) {
            lane.push(CAMERA);
            let rays = &paths[sample].rays;
            // The last ray's hit scatters no other.
            lane.extend(rays[..rays.len().saturating_sub(1)].iter().filter_map(|ray| ray.hit).map(|hit| {
                match scene.material_of(&scene.spheres[hit.sphere]).look() {
                    Look::Matte => "off-matte",
                    Look::Mirror { .. } => "off-metal",
                    Look::Glass { .. } => "off-glass",
                }
            }));
        }
        if !refill || sample + 1 == SAMPLES as usize {
            let longest = lanes.iter().map(Vec::len).max().unwrap_or_default();
            lanes.iter_mut().for_each(|lane| lane.resize(longest, WAITS));
        }
    }
    lanes
}

/// One timeline, `columns` steps wide: a step and a lane are units of the drawing, which the style stretches.
fn drawing(timeline: &Timeline, columns: usize) -> Markup {
    let path = |activity: Activity| {
        let mut path = String::new();
        for (lane, activities) in timeline.iter().enumerate() {
            for step in (0..activities.len()).filter(|step| activities[*step] == activity) {
                // Writing to a string cannot fail.
                let _ = write!(path, "M{step} {lane}h.8v.85h-.8z");
            }
        }
        path
    };
    html! {
        svg viewBox={ "0 0 " (columns) " " (LANES) } preserveAspectRatio="none" aria-hidden="true" {
            @for (class, _) in LEGEND { path class=(class) d=(path(class)) {} }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figure_states_gain_of_refill() {
        let html = figure("three-spheres", &mut Uses::default()).unwrap().into_string();
        let steps = |after: &str| -> f64 {
            let rest = &html[html.find(after).unwrap() + after.len()..];
            rest.trim_start_matches(": ").split(' ').next().unwrap().parse().unwrap()
        };
        let (plain, refilled) = (steps("the longest path"), steps("its next path at once"));
        assert!(refilled >= 48.0 && refilled < 0.9 * plain, "{refilled} {plain}");
        // Every lane starts with a camera ray.
        assert_eq!(html.matches("M0 ").count(), 16);
    }
}
