//! A renderer that can be told to fail.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender};
use std::time::Duration;
use weekender::backends::BackendChoice;
use weekender::film::{Film, PixelSum};
use weekender::progressive::{Factory, Plan, Progressive, RenderRequest, Status};
use weekender::render::{BackendInfo, RenderError, RenderJob, RenderSettings, Renderer, Stats};
use weekender::render_cpu::CpuOptions;
use weekender::scene::{Camera, Scene};
use weekender::stages::Rules;

/// Shortest time of a sample of the fake renderer.
pub const PAUSE: Duration = Duration::from_micros(100);

pub const PATIENCE: Duration = Duration::from_secs(60);

/// Adds to each pixel a number that depends only on pixel and sample.
pub struct Fake {
    pub name: &'static str,
    pub pause: Duration,
    pub fails_at: Option<u64>,
    pub panics_at: Option<u64>,
    /// The time that it takes to prepare.
    pub preparation: Duration,
    /// What it says after every pass.
    pub message: Option<&'static str>,
    /// How long it says that a sample takes, before its first pass: after a quick trial and after a thorough one.
    pub trial: Option<[Duration; 2]>,
    /// Whether passes after the first last until they are stopped, and are given up.
    pub waits_for_stop: bool,
}

impl Fake {
    /// A renderer that works.
    pub fn new(name: &'static str) -> Self {
        Fake {
            name,
            pause: PAUSE,
            fails_at: None,
            panics_at: None,
            preparation: Duration::ZERO,
            message: None,
            trial: None,
            waits_for_stop: false,
        }
    }
}

pub fn sample(pixel: usize, index: u64) -> PixelSum {
    let mixed = (pixel as u64 * 0x9E37_79B9 + index).wrapping_mul(0xD6E8_FEB8_6659_FD93) >> 40;
    PixelSum([mixed, mixed / 2, mixed / 3])
}

impl Renderer for Fake {
    fn info(&self) -> BackendInfo {
        BackendInfo { name: self.name, device: "fake".into(), lanes: 1, threads: 1 }
    }

    fn take_messages(&mut self) -> Vec<String> {
        self.message.into_iter().map(str::to_owned).collect()
    }

    fn prepare(&mut self, _: &RenderJob, _: &AtomicBool) -> Result<(), RenderError> {
        std::thread::sleep(self.preparation);
        Ok(())
    }

    fn try_out(&mut self, _: &mut Film, one_in: usize, _: &AtomicBool) -> Option<Duration> {
        self.trial.map(|[quick, thorough]| if one_in > 16 { quick } else { thorough })
    }

    fn advance_unless(
        &mut self,
        job: &RenderJob,
        range: Range<u64>,
        film: &mut Film,
        cancel: &AtomicBool,
        stop: &AtomicBool,
    ) -> Result<Option<Stats>, RenderError> {
        if !self.waits_for_stop {
            return self.advance(job, range, film, cancel).map(Some);
        }
        while !stop.load(Ordering::Relaxed) {
            std::thread::sleep(Duration::from_millis(1));
        }
        Ok(None)
    }

    fn accumulate(
        &mut self,
        _: &RenderJob,
        range: Range<u64>,
        film: &mut Film,
        cancel: &AtomicBool,
    ) -> Result<Stats, RenderError> {
        if self.fails_at.is_some_and(|at| range.end > at) {
            return Err(RenderError::Backend { backend: self.name, reason: "pulled out".into() });
        }
        assert!(self.panics_at.is_none_or(|at| range.end <= at), "a slip of the tracer");
        for index in range.clone() {
            if cancel.load(Ordering::Relaxed) {
                return Err(RenderError::Cancelled);
            }
            std::thread::sleep(self.pause);
            let half_count = film.halves().len();
            let half = &mut film.halves_mut()[index as usize % half_count];
            half.iter_mut().enumerate().for_each(|(pixel, sum)| sum.add(sample(pixel, index)));
        }
        let samples = range.end - range.start;
        film.record(range, 0)?;
        Ok(Stats { paths: samples * 4, rays: samples * 8, ..Stats::default() })
    }
}

/// Spoils the film in its second pass, and tells so.
pub struct Spoiling {
    pub fake: Fake,
    pub passes: u32,
    /// Is told when the film has been spoilt.
    pub spoilt: Option<Sender<()>>,
}

impl Spoiling {
    pub fn new(name: &'static str) -> Self {
        Spoiling { fake: Fake::new(name), passes: 0, spoilt: None }
    }
}

impl Renderer for Spoiling {
    fn info(&self) -> BackendInfo {
        self.fake.info()
    }

    fn prepare(&mut self, job: &RenderJob, cancel: &AtomicBool) -> Result<(), RenderError> {
        self.fake.prepare(job, cancel)
    }

    fn accumulate(
        &mut self,
        job: &RenderJob,
        range: Range<u64>,
        film: &mut Film,
        cancel: &AtomicBool,
    ) -> Result<Stats, RenderError> {
        self.passes += 1;
        if self.passes == 1 {
            return self.fake.accumulate(job, range, film, cancel);
        }
        film.halves_mut()[0][0].add(PixelSum([1; 3]));
        if let Some(spoilt) = &self.spoilt {
            spoilt.send(()).unwrap();
        }
        Err(RenderError::FilmLost { backend: self.fake.name, reason: "pulled out".into() })
    }
}

/// Waits for a signal before its first pass.
pub struct Waiting {
    pub fake: Fake,
    pub signal: Option<Receiver<()>>,
}

impl Renderer for Waiting {
    fn info(&self) -> BackendInfo {
        self.fake.info()
    }

    fn prepare(&mut self, job: &RenderJob, cancel: &AtomicBool) -> Result<(), RenderError> {
        self.fake.prepare(job, cancel)
    }

    fn accumulate(
        &mut self,
        job: &RenderJob,
        range: Range<u64>,
        film: &mut Film,
        cancel: &AtomicBool,
    ) -> Result<Stats, RenderError> {
        if let Some(signal) = self.signal.take() {
            signal.recv_timeout(PATIENCE).unwrap();
        }
        self.fake.accumulate(job, range, film, cancel)
    }
}

/// Holds samples back until they are collected, as a GPU does.
pub struct Holding<F> {
    fake: Fake,
    held: Vec<Range<u64>>,
    /// Collections that go well before one that loses the samples.
    good_collections: u32,
    /// Is told of every pass, and of how many collections will still go well.
    on_pass: F,
}

impl<F: FnMut(&Range<u64>, u32) + Send> Holding<F> {
    pub fn new(fake: Fake, good_collections: u32, on_pass: F) -> Self {
        Holding { fake, held: Vec::new(), good_collections, on_pass }
    }
}

impl<F: FnMut(&Range<u64>, u32) + Send> Renderer for Holding<F> {
    fn info(&self) -> BackendInfo {
        self.fake.info()
    }

    fn prepare(&mut self, _: &RenderJob, _: &AtomicBool) -> Result<(), RenderError> {
        self.held.clear();
        Ok(())
    }

    fn accumulate(
        &mut self,
        job: &RenderJob,
        range: Range<u64>,
        film: &mut Film,
        cancel: &AtomicBool,
    ) -> Result<Stats, RenderError> {
        self.fake.accumulate(job, range, film, cancel)
    }

    fn advance(
        &mut self,
        _: &RenderJob,
        range: Range<u64>,
        _: &mut Film,
        _: &AtomicBool,
    ) -> Result<Stats, RenderError> {
        std::thread::sleep(PAUSE);
        (self.on_pass)(&range, self.good_collections);
        self.held.push(range);
        Ok(Stats::default())
    }

    fn collect(&mut self, film: &mut Film) -> Result<Stats, RenderError> {
        let held = std::mem::take(&mut self.held);
        let Some(left) = self.good_collections.checked_sub(1) else {
            return Err(RenderError::Backend { backend: self.fake.name, reason: "pulled out".into() });
        };
        self.good_collections = left;
        let mut stats = Stats::default();
        for range in held {
            stats.add(&self.fake.accumulate(&job(2), range, film, &AtomicBool::new(false))?);
        }
        Ok(stats)
    }
}

/// Adds nothing to the film, and does not say so.
pub struct Forgetful;

impl Renderer for Forgetful {
    fn info(&self) -> BackendInfo {
        BackendInfo { name: "cpu", device: "fake".into(), lanes: 1, threads: 1 }
    }

    fn prepare(&mut self, _: &RenderJob, _: &AtomicBool) -> Result<(), RenderError> {
        Ok(())
    }

    fn accumulate(
        &mut self,
        _: &RenderJob,
        _: Range<u64>,
        _: &mut Film,
        _: &AtomicBool,
    ) -> Result<Stats, RenderError> {
        Ok(Stats::default())
    }
}

/// In these tests, the reference fails after sample 16, and every CPU backend works.
pub fn factory() -> Factory {
    Box::new(|choice| {
        let fails_at = matches!(choice, BackendChoice::Reference { .. }).then_some(16);
        Ok(Box::new(Fake { fails_at, ..Fake::new(choice.name()) }))
    })
}

pub const CPU: BackendChoice = BackendChoice::Cpu(CpuOptions {
    isa: None,
    lanes: None,
    threads: None,
    low_priority: false,
    general: false,
    panics_after: None,
});
pub const FAILING: BackendChoice = BackendChoice::Reference { threads: None };

pub fn other_cpu() -> BackendChoice {
    BackendChoice::Cpu(CpuOptions { lanes: Some(1), ..CpuOptions::default() })
}

pub fn job(width: u32) -> RenderJob {
    let settings = RenderSettings { width, height: 2, max_depth: 5, ..RenderSettings::default() };
    RenderJob::new(Scene::default(), Camera::default(), settings, Rules::default()).unwrap()
}

pub fn expected(samples: u64) -> Film {
    let mut film = job(2).new_film();
    let mut fake = Fake { pause: Duration::ZERO, ..Fake::new("alone") };
    fake.accumulate(&job(2), 0..samples, &mut film, &AtomicBool::new(false)).unwrap();
    film
}

pub fn started(backend: BackendChoice, plan: Plan) -> Progressive {
    let mut progressive = Progressive::with_factory(factory()).unwrap();
    progressive.start(RenderRequest::new(job(2), backend, plan));
    progressive
}

pub fn wait_for(progressive: &Progressive, samples: u64) {
    wait_until(progressive, |status| status.samples_per_pixel >= samples);
}

pub fn wait_until(progressive: &Progressive, is_so: impl Fn(&Status) -> bool) {
    let begin = std::time::Instant::now();
    while !is_so(&progressive.status()) {
        assert!(begin.elapsed() < PATIENCE, "stuck: {:?}", progressive.status());
        std::thread::sleep(Duration::from_millis(1));
    }
}
