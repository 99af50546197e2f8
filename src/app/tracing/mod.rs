//! What traces: the render on the screen, the one that it is compared with, and their size.

pub mod kept;
pub mod layers;
pub mod preview;
pub mod second;
pub mod subject;
pub mod tracer;

use crate::app::model::changes::Changes;
use crate::app::model::{Device, Document, Model, Sizing};
use crate::app::toolkit::Toasts;
use crate::film::Film;
use crate::progressive::Status;
use eframe::egui::Context;
use second::Second;
use std::time::{Duration, Instant};
use tracer::{Tracer, Want};

/// Longer than the time between two pictures.
const PICTURES_APART: Duration = Duration::from_millis(300);

/// A new size counts once it has stayed the same for so long: a window that is resized has many sizes.
const SETTLE: Duration = Duration::from_millis(250);

/// A picture that was traced for longer than this many seconds is kept.
const LONG_SECONDS: f64 = 10.0;

pub struct Tracing {
    pub main: Tracer,
    /// Traces what the picture is compared with.
    pub second: Second,
    pub sizer: Sizer,
    /// Tracing time of the film's samples from before this run; none if it is not known.
    pub seconds_before: Option<f64>,
    /// The film with which the next run begins.
    pub film: Option<Film>,
    /// Why the document cannot be rendered; `None` if it can.
    pub invalid: Option<String>,
    /// The run, and how many of its messages and failures have been seen.
    seen: (u64, usize, usize),
}

impl Tracing {
    /// # Errors
    /// If the render thread cannot be started.
    pub fn new() -> std::io::Result<Self> {
        Ok(Tracing {
            main: Tracer::new()?,
            second: Second::default(),
            sizer: Sizer::default(),
            seconds_before: Some(0.0),
            film: None,
            invalid: None,
            seen: (0, 0, 0),
        })
    }

    /// Tracing time of the film's samples, if known.
    pub fn seconds(&self) -> Option<f64> {
        Some(self.seconds_before? + self.main.status().trace.as_secs_f64())
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

    /// Throws the samples away and begins anew.
    pub fn restart(&mut self) {
        self.seconds_before = Some(0.0);
        self.main.started = None;
    }

    /// Gives the document the size that fits the window, unless its samples are worth more or are needed.
    pub fn follow_size(&mut self, context: &Context, model: &mut Model, room: [u32; 2], is_needed: bool) {
        if self.film.is_some() {
            return;
        }
        let is_presented = model.presentation.is_some();
        let seconds = match self.seconds() {
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
        let want = Want {
            document,
            backend: &model.backend(),
            stop: view.stop(self.main.status().run, document.stop),
            view: view.of_film(self.main.status().run, self.second.means(view)),
            is_moving: changes.is_moving(),
            is_paused: *is_paused,
        };
        self.invalid = self.main.want(&want, self.film.take()).err();
        self.second.follow(context, view, &want)
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
    /// A large size that the user wants.
    pub accepted: Option<[u32; 2]>,
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
        let now = Instant::now();
        let since = match self.fitting {
            Some((fitting, since)) if fitting == wanted => since,
            _ => now,
        };
        self.fitting = Some((wanted, since));
        if wanted == document.size() {
            return;
        }
        // The book's size changes only when the user chooses it or another picture.
        let Some(seconds) = lost.filter(|_| !is_asked && sizing != Sizing::Book) else {
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
            document.set_size(wanted);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::Origin;
    use crate::job::render::BackendInfo;
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
