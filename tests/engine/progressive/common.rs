//! A renderer that fails on request.

use std::collections::VecDeque;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::channel;
use std::time::{Duration, Instant};
use weekender::backends::BackendChoice;
use weekender::film::{Film, PixelSum};
use weekender::job::render::{
    BackendInfo, Control, Outcome, RenderError, RenderJob, RenderSettings, Renderer, Stats,
};
use weekender::progressive::{EndReason, Phase, Picture, Plan, Progressive, RenderRequest, Status};
use weekender::render_cpu::CpuOptions;
use weekender::scene::{Camera, Scene};
use weekender::stages::Rules;

/// Shortest time of a sample of the fake renderer.
pub const PAUSE: Duration = Duration::from_micros(100);

pub const PATIENCE: Duration = Duration::from_secs(60);

type Pass =
    Box<dyn FnMut(&mut Fake, Range<u64>, &mut Film, &AtomicBool) -> Result<Stats, RenderError> + Send>;

type Prepare = Box<dyn FnMut(&AtomicBool) -> Result<(), RenderError> + Send>;
type OnPass = Box<dyn FnMut(&Range<u64>, u32) + Send>;

/// Adds to each pixel a number that depends only on pixel and sample.
pub struct Fake {
    pub name: &'static str,
    pub threads: usize,
    pub pause: Duration,
    pub fails_at: Option<u64>,
    pub panics_at: Option<u64>,
    /// Message after every pass.
    pub message: Option<&'static str>,
    /// Claimed time per sample before its first pass, after a quick and after a thorough trial.
    pub trial: Option<[Duration; 2]>,
    /// Whether later passes last until they are stopped and are then given up.
    pub waits_for_stop: bool,
    pub value: Box<dyn Fn(usize, u64) -> PixelSum + Send>,
    pub prepares: Option<Prepare>,
    /// A replacement for a pass.
    pub pass: Option<Pass>,
    /// Passes whose samples are held back until they are collected, as by a GPU.
    pub holds: usize,
    pub held: VecDeque<Range<u64>>,
    /// Collections that succeed before one loses the samples.
    pub good_collections: u32,
    /// Called on every pass that is held back with the number of collections that will still succeed.
    pub on_pass: OnPass,
}

impl Fake {
    /// A renderer that works.
    pub fn new(name: &'static str) -> Self {
        Fake {
            name,
            threads: 1,
            pause: PAUSE,
            fails_at: None,
            panics_at: None,
            message: None,
            trial: None,
            waits_for_stop: false,
            value: Box::new(sample),
            prepares: None,
            pass: None,
            holds: 0,
            held: VecDeque::new(),
            good_collections: u32::MAX,
            on_pass: Box::new(|_, _| ()),
        }
    }

    /// Adds samples to the film, or does what `pass` says.
    fn add(&mut self, range: Range<u64>, film: &mut Film, cancel: &AtomicBool) -> Result<Stats, RenderError> {
        if let Some(mut pass) = self.pass.take() {
            let outcome = pass(self, range, film, cancel);
            self.pass = Some(pass);
            return outcome;
        }
        if self.fails_at.is_some_and(|at| range.end > at) {
            return Err(pulled_out(self.name));
        }
        assert!(self.panics_at.is_none_or(|at| range.end <= at), "a slip of the tracer");
        for index in range.clone() {
            if cancel.load(Ordering::Relaxed) {
                return Err(RenderError::Cancelled);
            }
            std::thread::sleep(self.pause);
            let half = &mut film.halves_mut()[index as usize % 2];
            half.iter_mut().enumerate().for_each(|(pixel, sum)| sum.add((self.value)(pixel, index)));
        }
        let samples = range.end - range.start;
        film.record(range, 0)?;
        Ok(Stats { paths: samples * 4, rays: samples * 8, ..Stats::default() })
    }

    pub fn preparing_for(self, time: Duration) -> Self {
        let prepares = move |_: &AtomicBool| {
            std::thread::sleep(time);
            Ok(())
        };
        Fake { prepares: Some(Box::new(prepares)), ..self }
    }

    /// Holds all samples back until they are collected.
    pub fn holding(
        self,
        good_collections: u32,
        on_pass: impl FnMut(&Range<u64>, u32) + Send + 'static,
    ) -> Box<dyn Renderer> {
        Box::new(Fake { holds: usize::MAX, good_collections, on_pass: Box::new(on_pass), ..self })
    }
}

pub fn pulled_out(backend: &'static str) -> RenderError {
    RenderError::Backend { backend, reason: "pulled out".into() }
}

fn sample(pixel: usize, index: u64) -> PixelSum {
    let mixed = (pixel as u64 * 0x9E37_79B9 + index).wrapping_mul(0xD6E8_FEB8_6659_FD93) >> 40;
    PixelSum([mixed, mixed / 2, mixed / 3])
}

impl Renderer for Fake {
    fn info(&self) -> BackendInfo {
        BackendInfo { name: self.name, device: "fake".into(), lanes: 1, threads: self.threads }
    }

    fn take_messages(&mut self) -> Vec<String> {
        self.message.into_iter().map(str::to_owned).collect()
    }

    fn prepare(&mut self, _: &RenderJob, cancel: &AtomicBool) -> Result<(), RenderError> {
        self.held.clear();
        self.prepares.as_mut().map_or(Ok(()), |prepares| prepares(cancel))
    }

    fn estimate_sample_time(&mut self, one_in: usize, _: &AtomicBool) -> Option<Duration> {
        self.trial.map(|[quick, thorough]| if one_in > 16 { quick } else { thorough })
    }

    fn advance(
        &mut self,
        _: &RenderJob,
        range: Range<u64>,
        film: &mut Film,
        &Control { cancel, stop, may_defer }: &Control,
    ) -> Result<Outcome, RenderError> {
        // The first pass has no flag to stop it.
        if self.waits_for_stop && may_defer && film.sample_count() > 0 {
            while !stop.load(Ordering::Relaxed) {
                std::thread::sleep(Duration::from_millis(1));
            }
            return Ok(Outcome::Withdrawn);
        }
        if self.holds == 0 || !may_defer {
            return self.add(range, film, cancel).map(Outcome::Added);
        }
        std::thread::sleep(PAUSE);
        (self.on_pass)(&range, self.good_collections);
        self.held.push_back(range);
        if self.held.len() <= self.holds {
            return Ok(Outcome::Added(Stats::default()));
        }
        let due = self.held.pop_front().unwrap();
        self.add(due, film, cancel).map(Outcome::Added)
    }

    fn finish(&mut self, film: &mut Film) -> Result<Stats, RenderError> {
        let held = std::mem::take(&mut self.held);
        if self.holds > 0 {
            self.good_collections =
                self.good_collections.checked_sub(1).ok_or_else(|| pulled_out(self.name))?;
        }
        let mut stats = Stats::default();
        for range in held {
            stats.add(&self.add(range, film, &AtomicBool::new(false))?);
        }
        Ok(stats)
    }
}

/// A fake renderer whose passes are made by a closure.
pub fn scripted<A>(name: &'static str, pass: A) -> Box<dyn Renderer>
where
    A: FnMut(&mut Fake, Range<u64>, &mut Film, &AtomicBool) -> Result<Stats, RenderError> + Send + 'static,
{
    Box::new(Fake { pass: Some(Box::new(pass)), ..Fake::new(name) })
}

/// Spoils the film in its second pass, then calls `spoilt`.
pub fn spoiling(name: &'static str, mut spoilt: impl FnMut() + Send + 'static) -> Box<dyn Renderer> {
    let mut passes = 0;
    scripted(name, move |fake, range, film, cancel| {
        passes += 1;
        if passes == 1 {
            return fake.accumulate(&job(2), range, film, cancel);
        }
        film.halves_mut()[0][0].add(PixelSum([1; 3]));
        spoilt();
        Err(RenderError::FilmLost { backend: name, reason: "pulled out".into() })
    })
}

/// Adds nothing to the film and does not report it.
pub fn forgetful() -> Box<dyn Renderer> {
    scripted("cpu", |_, _, _, _| Ok(Stats::default()))
}

pub const CPU: BackendChoice = BackendChoice::Cpu(CpuOptions {
    isa: None,
    lanes: None,
    threads: None,
    low_priority: false,
    general: false,
});
pub const FAILING: BackendChoice = BackendChoice::Reference { threads: None };

pub fn other_cpu() -> BackendChoice {
    BackendChoice::Cpu(CpuOptions { lanes: Some(1), ..CpuOptions::default() })
}

pub fn job(width: u32) -> RenderJob {
    let settings = RenderSettings { width, height: 2, max_depth: 5, ..RenderSettings::default() };
    RenderJob::new(Scene::default(), Camera::default(), settings, Rules::default()).unwrap()
}

/// A film with samples in these ranges.
pub fn film(ranges: impl IntoIterator<Item = Range<u64>>) -> Film {
    let mut film = job(2).new_film();
    let mut fake = Fake { pause: Duration::ZERO, ..Fake::new("alone") };
    for range in ranges {
        fake.accumulate(&job(2), range, &mut film, &AtomicBool::new(false)).unwrap();
    }
    film
}

pub fn expected(samples: u64) -> Film {
    film(std::iter::once(0..samples))
}

/// A render thread with these renderers.
pub fn idle(mut make: impl FnMut(&BackendChoice) -> Box<dyn Renderer> + Send + 'static) -> Progressive {
    Progressive::with_factory(Box::new(move |choice| Ok(make(choice)))).unwrap()
}

/// A render with these renderers.
pub fn started_with(
    backend: BackendChoice,
    plan: Plan,
    make: impl FnMut(&BackendChoice) -> Box<dyn Renderer> + Send + 'static,
) -> Progressive {
    let mut progressive = idle(make);
    progressive.start(RenderRequest::new(job(2), backend, plan));
    progressive
}

/// The reference fails after sample 16, and every CPU backend works.
pub fn usual(choice: &BackendChoice) -> Box<dyn Renderer> {
    let fails_at = matches!(choice, BackendChoice::Reference { .. }).then_some(16);
    Box::new(Fake { fails_at, ..Fake::new(choice.name()) })
}

pub fn started(backend: BackendChoice, plan: Plan) -> Progressive {
    started_with(backend, plan, usual)
}

pub fn wait_for(progressive: &Progressive, samples: u64) {
    wait_until(progressive, |status| status.samples_per_pixel >= samples);
}

pub fn wait_until(progressive: &Progressive, is_so: impl Fn(&Status) -> bool) {
    let begin = Instant::now();
    while !is_so(&progressive.status()) {
        assert!(begin.elapsed() < PATIENCE, "stuck: {:?}", progressive.status());
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// The status once all requests so far are obeyed.
pub fn settled(progressive: &Progressive) -> Status {
    let (seen, is_seen) = channel();
    progressive.inspect(move |_| seen.send(()).unwrap());
    // Without a film, the request is dropped, which ends the wait, too.
    let _ = is_seen.recv_timeout(PATIENCE);
    progressive.status()
}

/// Stops the render; returns its last status. All samples must be there.
pub fn stopped(progressive: Progressive) -> Status {
    progressive.stop();
    let status = progressive.wait_until_over();
    assert_eq!(status.phase, Phase::Done(EndReason::Stopped));
    assert_eq!(progressive.take_film(), Some(expected(status.samples_per_pixel)));
    status
}

/// The messages of a render, except the one that its tiny picture says little about the error.
pub fn said(status: &Status) -> Vec<String> {
    let is_about_error = |message: &&String| message.starts_with("an error estimate needs");
    status.messages.iter().filter(|message| !is_about_error(message)).cloned().collect()
}

/// The next picture with this many samples.
pub fn picture(progressive: &Progressive, samples: u64) -> Picture {
    let begin = Instant::now();
    loop {
        progressive.ask_for_picture();
        match progressive.newest_picture() {
            Some(picture) if picture.samples_per_pixel == samples => return picture,
            _ => std::thread::sleep(Duration::from_millis(1)),
        }
        assert!(begin.elapsed() < PATIENCE, "no picture: {:?}", progressive.status());
    }
}

/// The names of the backends that added samples, with the number of samples.
pub fn parts(status: &Status) -> Vec<(&'static str, u64)> {
    status.contributions.iter().map(|part| (part.backend.name, part.samples_per_pixel)).collect()
}
