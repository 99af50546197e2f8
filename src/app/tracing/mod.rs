//! What traces: the render on the screen, the one that it is compared with, and their size.

pub mod kept;
pub mod layers;
pub mod preview;
pub mod second;
pub mod subject;
pub mod tracer;

use crate::app::model::changes::Changes;
use crate::app::model::{Device, Document, Model, Partner, Sizing};
use crate::app::toolkit::Toasts;
use crate::job::saved::SavedFilm;
use crate::progressive::{Phase, Status, Stop};
use eframe::egui::{Context, Vec2};
use second::{Other, Second};
use std::sync::Arc;
use std::time::{Duration, Instant};
use tracer::{LONG_SECONDS, Left, Tracer, Want};

/// Longer than the time between two pictures.
const PICTURES_APART: Duration = Duration::from_millis(300);

/// A new size counts once it has stayed the same for so long: a window that is resized has many sizes.
const SETTLE: Duration = Duration::from_millis(250);

pub struct Tracing {
    pub main: Tracer,
    /// Traces what the picture is compared with.
    pub second: Second,
    pub sizer: Sizer,
    /// The film with which the next run begins.
    pub film: Option<SavedFilm>,
    /// Why the document cannot be rendered; `None` if it can.
    pub invalid: Option<String>,
    /// The run, and how many of its messages and failures have been seen.
    seen: (u64, usize, usize),
    turn: Option<Turn>,
}

/// Two devices trace in turns, so that neither has processors of the other and the speeds of both are true.
struct Turn {
    is_second: bool,
    since: Instant,
}

/// How long a turn takes.
const TURN: Duration = Duration::from_millis(500);

impl Tracing {
    /// # Errors
    /// If the render thread cannot be started.
    pub fn new() -> std::io::Result<Self> {
        Ok(Tracing {
            main: Tracer::new()?,
            second: Second::default(),
            sizer: Sizer::default(),
            film: None,
            invalid: None,
            seen: (0, 0, 0),
            turn: None,
        })
    }

    fn tracers(&self) -> impl Iterator<Item = &Tracer> {
        std::iter::once(&self.main).chain(&self.second.tracer)
    }

    pub fn pause(&self, context: &Context) {
        self.tracers().for_each(|tracer| tracer.progressive.pause());
        // The picture of the last samples is still to come.
        context.request_repaint_after(PICTURES_APART);
    }

    pub fn resume(&self) {
        self.tracers().for_each(|tracer| tracer.progressive.resume());
    }

    /// The status of the render of the other picture, if it has one of its own.
    pub fn other_status(&self, model: &Model) -> Option<Arc<Status>> {
        match self.other(model)? {
            Other::Traced(_, tracer, _) => Some(Arc::clone(tracer.status())),
            Other::Kept(_) => None,
        }
    }

    /// The other picture of a comparison, once it has samples.
    pub fn other<'a>(&'a self, model: &'a Model) -> Option<Other<'a>> {
        self.second.other(model)
    }

    /// The films to keep of the pictures that were left since the last call.
    pub fn take_left(&mut self) -> Vec<Left> {
        self.tracers_mut().flat_map(|tracer| tracer.left.drain(..)).collect()
    }

    pub fn tracers_mut(&mut self) -> impl Iterator<Item = &mut Tracer> {
        std::iter::once(&mut self.main).chain(&mut self.second.tracer)
    }

    /// Gives the document the size that fits the window, unless its samples are worth more or are needed.
    pub fn follow_size(&mut self, context: &Context, model: &mut Model, room: [u32; 2], is_needed: bool) {
        if self.film.is_some() {
            return;
        }
        let is_presented = model.presentation.is_some();
        let seconds = match self.main.seconds() {
            _ if is_needed => f64::INFINITY,
            // A presentation begins with a picture of its own size, whatever that costs.
            _ if is_presented => 0.0,
            seconds => seconds.unwrap_or(f64::INFINITY),
        };
        let lost = self.main.run_of(&model.document).map(|_| seconds);
        let sizing = if is_presented { Sizing::Viewport } else { model.remembered.sizing };
        self.sizer.follow(context, &mut model.document, (sizing, room), lost);
    }

    /// Traces what the model asks for. Returns whether there is a picture to compare with, if one is asked for.
    pub fn follow(&mut self, context: &Context, model: &Model, changes: &Changes) -> bool {
        let Model { document, view, is_paused, .. } = model;
        let (run, partner) = (self.main.status().run, view.compared(document));
        let mut stop = view.stop(run, document.stop);
        if let Some(second) =
            self.second.tracer.as_ref().filter(|_| partner.is_some_and(Partner::has_same_samples))
        {
            stop = common_stop(stop, [self.main.status(), second.status()]);
        }
        let want = Want {
            document,
            backend: &model.backend(),
            stop,
            view: view.of_film(run, self.second.means(model, document.size())),
            is_moving: changes.is_moving(),
            is_paused: *is_paused,
        };
        self.invalid = self.main.want(&want, self.film.take()).err();
        let is_there = self.second.follow(context, model, &want);
        self.take_turns(context, model.other_device().is_some(), *is_paused);
        is_there
    }

    fn take_turns(&mut self, context: &Context, is_race: bool, is_paused: bool) {
        let Some(second) = self.second.tracer.as_ref().filter(|second| is_race && !second.is_coarse()) else {
            if self.turn.take().is_some() && !is_paused {
                self.main.progressive.resume();
            }
            return;
        };
        let tracers = [&self.main, second];
        let turn = self.turn.get_or_insert_with(|| Turn { is_second: true, since: Instant::now() });
        let is_over = |tracer: &Tracer| tracer.status().phase.is_over();
        if turn.since.elapsed() >= TURN || is_over(tracers[usize::from(turn.is_second)]) {
            *turn = Turn { is_second: !turn.is_second, since: Instant::now() };
        }
        if is_paused {
            return;
        }
        for (place, tracer) in tracers.into_iter().enumerate() {
            let other = tracers[1 - place];
            let has_turn = turn.is_second == (place == 1) || is_over(other);
            match tracer.status().phase {
                Phase::Tracing if !has_turn => tracer.progressive.pause(),
                // Not before the pass of the other one has ended.
                Phase::Paused if has_turn && other.status().phase != Phase::Tracing => {
                    tracer.progressive.resume();
                    turn.since = Instant::now();
                }
                _ => {}
            }
        }
        if !tracers.into_iter().all(is_over) {
            context.request_repaint_after(TURN);
        }
    }

    /// Shows the render's new messages. If the chosen device has failed, chooses the one that has taken over.
    pub fn report(&mut self, device: &mut Device, toasts: &mut Toasts) {
        let status = self.main.status();
        let (messages, failures) = match self.seen {
            (run, messages, failures) if run == status.run => (messages, failures),
            _ => (0, 0),
        };
        for message in &status.messages[messages..] {
            if status.given_up.is_empty() {
                toasts.note(message);
            } else {
                toasts.bad(message);
            }
        }
        let (next, failures) = device_after(*device, failures, status);
        *device = next;
        self.seen = (status.run, status.messages.len(), failures);
    }
}

/// Where two films of the same samples end: the one that reaches its end first sets the number for both.
fn common_stop(stop: Stop, statuses: [&Arc<Status>; 2]) -> Stop {
    let is_reached = |status: &Status| {
        stop.samples.is_some_and(|samples| status.samples_per_pixel >= samples)
            || stop.noise.zip(status.error).is_some_and(|(goal, error)| error.rmse <= goal)
    };
    let ended =
        statuses.into_iter().filter(|status| matches!(status.phase, Phase::Done(_)) && is_reached(status));
    match ended.map(|status| status.samples_per_pixel).max() {
        Some(samples) if stop.seconds.is_none() => Stop::at_samples(samples),
        _ => stop,
    }
}

/// The device that the switch shows, and how many failures it has answered to: once `chosen` has failed, the one that
/// has taken over.
fn device_after(chosen: Device, seen: usize, status: &Status) -> (Device, usize) {
    let has_failed = status.given_up.iter().skip(seen).any(|name| *name == chosen.name());
    let name = status.backend.as_ref().map(|backend| backend.name);
    let present = Device::ALL.into_iter().find(|device| Some(device.name()) == name);
    match present {
        Some(present) if has_failed && present != chosen => (present, status.given_up.len()),
        // The next backend is still getting ready.
        _ if has_failed => (chosen, seen),
        _ => (chosen, status.given_up.len()),
    }
}

/// Follows the size of the viewport.
#[derive(Default)]
pub struct Sizer {
    /// The size that fits, and since when.
    fitting: Option<([u32; 2], Instant)>,
    is_asked: bool,
    /// The size of the window, points, when the picture got its size.
    window: Vec2,
    /// The size at which the picture could be rendered anew, if it is only scaled.
    pub offer: Option<[u32; 2]>,
}

impl Sizer {
    /// The user wants the size that the picture should have, whatever is lost.
    pub fn ask(&mut self) {
        self.is_asked = true;
    }

    /// Changes the size of the document if it should have another one. `room` is the room for the picture, pixels of
    /// the screen; `lost` is for how many seconds the document's own picture was traced.
    pub fn follow(
        &mut self,
        context: &Context,
        document: &mut Document,
        (sizing, room): (Sizing, [u32; 2]),
        lost: Option<f64>,
    ) {
        let is_asked = std::mem::take(&mut self.is_asked);
        self.offer = None;
        let Some(wanted) = document.fitting_size(sizing, room) else { return };
        let (now, window) = (Instant::now(), context.content_rect().size());
        let since = match self.fitting {
            Some((fitting, since)) if fitting == wanted => since,
            _ => now,
        };
        self.fitting = Some((wanted, since));
        // Panels that take room from a picture show it smaller, and give the room back.
        let is_smaller = (0..2).all(|side| wanted[side] <= document.size()[side]);
        if wanted == document.size() {
            self.window = window;
        }
        if wanted == document.size() || lost.is_some() && !is_asked && is_smaller && window == self.window {
            return;
        }
        // The book's size changes only when the user chooses it or another picture.
        let Some(seconds) = lost.filter(|_| !is_asked && sizing != Sizing::Book) else {
            self.window = window;
            document.set_size(wanted);
            return;
        };
        let settled = now.duration_since(since);
        if settled < SETTLE {
            context.request_repaint_after(SETTLE - settled);
        } else if seconds > LONG_SECONDS {
            // Also while a button of the mouse is down, which may be pressing the offer.
            self.offer = Some(wanted);
        } else if context.input(|input| input.pointer.any_down()) {
            context.request_repaint_after(SETTLE);
        } else {
            self.window = window;
            document.set_size(wanted);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::Origin;
    use crate::film::ErrorEstimate;
    use crate::job::render::BackendInfo;
    use crate::progressive::EndReason;
    use crate::stages::Stage;

    #[test]
    fn only_a_failure_of_the_chosen_device_changes_the_choice() {
        let status = |name, given_up: &[&'static str]| {
            let backend = BackendInfo { name, device: String::new(), lanes: 1, threads: 1 };
            let messages = vec!["the estimate is doubtful".to_owned()];
            Status { backend: Some(backend), given_up: given_up.to_vec(), messages, ..Status::default() }
        };
        let (cpu, gpu) = (Device::Cpu, Device::Gpu);
        assert_eq!(device_after(gpu, 0, &status("cpu", &[])), (gpu, 0), "the GPU is being prepared");
        assert_eq!(device_after(cpu, 0, &status("gpu", &[])), (cpu, 0));
        assert_eq!(device_after(gpu, 0, &status("gpu", &["gpu"])), (gpu, 0), "nothing has taken over yet");
        assert_eq!(device_after(gpu, 0, &status("cpu", &["gpu"])), (cpu, 1));
        assert_eq!(device_after(gpu, 1, &status("cpu", &["gpu"])), (gpu, 1), "it is tried again");
        assert_eq!(device_after(cpu, 0, &status("cpu", &["cpu"])), (cpu, 0), "its plainer code goes on");
    }

    #[test]
    fn the_first_end_counts_for_both_films_of_the_same_samples() {
        let status = |samples, rmse, is_done| {
            let phase = if is_done { Phase::Done(EndReason::NoiseTarget) } else { Phase::Tracing };
            let error = Some(ErrorEstimate { rmse, rmse_deviation: 0.0, rel_mse: 0.0 });
            Arc::new(Status { samples_per_pixel: samples, phase, error, ..Status::default() })
        };
        let goal = |noise| Stop { noise: Some(noise), ..Stop::default() };
        for (stop, mine, other, expected) in [
            (goal(0.01), status(64, 0.02, false), status(32, 0.03, false), goal(0.01)),
            (goal(0.01), status(64, 0.02, false), status(256, 0.01, true), Stop::at_samples(256)),
            (goal(0.01), status(260, 0.01, true), status(256, 0.01, true), Stop::at_samples(260)),
            // The next goal.
            (goal(0.005), status(256, 0.01, true), status(256, 0.01, true), goal(0.005)),
            (Stop::at_samples(64), status(64, 0.02, true), status(9, 0.1, false), Stop::at_samples(64)),
        ] {
            assert_eq!(common_stop(stop, [&mine, &other]), expected);
        }
        // In the same time, one device has more samples than another.
        let timed = Stop { seconds: Some(3.0), ..goal(0.01) };
        assert_eq!(common_stop(timed, [&status(9, 0.01, true), &status(5, 0.02, false)]), timed);
    }

    const YOUNG: Option<f64> = Some(2.0);

    fn ago(seconds: u64) -> Instant {
        Instant::now().checked_sub(Duration::from_secs(seconds)).unwrap()
    }

    /// The size after a frame with a room of 320 by 9000 pixels, of a picture that has had another size.
    fn followed(sizer: &mut Sizer, sizing: Sizing, lost: Option<f64>) -> [u32; 2] {
        let mut document = Document::new(Origin::of_stage(Stage::find("metal").unwrap()));
        document.set_size([160, 90]);
        sizer.follow(&Context::default(), &mut document, (sizing, [320, 9000]), lost);
        document.size()
    }

    #[test]
    fn a_size_is_followed_once_it_has_stayed_the_same() {
        let settled = |size| Sizer { fitting: Some((size, ago(1))), ..Sizer::default() };
        for (size, expected) in [([320, 180], [320, 180]), ([300, 169], [160, 90])] {
            let mut sizer = settled(size);
            assert_eq!(followed(&mut sizer, Sizing::Viewport, YOUNG), expected, "{size:?} has fitted");
            assert_eq!(sizer.fitting.unwrap().0, [320, 180]);
            assert_eq!(sizer.offer, None);
        }
        let mut sizer = settled([320, 180]);
        sizer.offer = Some([1, 1]);
        let old = Some(99.0);
        assert_eq!(followed(&mut sizer, Sizing::Viewport, old), [160, 90]);
        assert_eq!(sizer.offer, Some([320, 180]));
        sizer.ask();
        assert_eq!(followed(&mut sizer, Sizing::Viewport, old), [320, 180], "whatever is lost");
        assert_eq!(sizer.offer, None);
        assert_eq!(followed(&mut sizer, Sizing::Viewport, old), [160, 90], "once");
    }
}
