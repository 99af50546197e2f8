//! What backends say of themselves: several together, and in the status of a render.

use super::common::{CPU, Fake, job, other_cpu, wait_for, wait_until};
use std::ops::Range;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use weekender::backends::Together;
use weekender::film::Film;
use weekender::progressive::{Plan, Progressive, RenderRequest};
use weekender::render::{
    BackendInfo, KernelContents, RenderError, RenderJob, Renderer, Stats, TileOccupancy,
};

/// One of two backends that describe themselves.
struct Telling {
    fake: Fake,
    number: u32,
    /// What comes of preparing a job.
    prepared: fn() -> Result<(), RenderError>,
}

fn telling(name: &'static str, number: u32) -> Telling {
    let message = Some(["the first is here", "the second is here"][number as usize - 1]);
    Telling { fake: Fake { message, ..Fake::new(name) }, number, prepared: || Ok(()) }
}

impl Renderer for Telling {
    fn info(&self) -> BackendInfo {
        BackendInfo { device: format!("device {}", self.number), ..self.fake.info() }
    }

    fn take_messages(&mut self) -> Vec<String> {
        self.fake.take_messages()
    }

    fn hierarchy_time(&self) -> Duration {
        Duration::from_secs(self.number.into())
    }

    fn kernel(&self) -> String {
        format!("kernel {}", self.number)
    }

    fn kernel_contents(&self) -> KernelContents {
        let left_out = [["lens", "glass"], ["glass", "fuzz"]][self.number as usize - 1].to_vec();
        KernelContents { present: format!("code {}", self.number), left_out }
    }

    fn tile_occupancy(&self) -> Option<TileOccupancy> {
        (self.number > 1).then(|| TileOccupancy { side: 8, columns: 1, tiles: vec![[3, 4]] })
    }

    fn prepare(&mut self, _: &RenderJob, _: &AtomicBool) -> Result<(), RenderError> {
        (self.prepared)()
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
}

fn together(members: [Telling; 2]) -> Together {
    Together::new(members.map(|member| Box::new(member) as Box<dyn Renderer>).into())
}

#[test]
fn members_are_described_in_their_order() {
    let mut both = together([telling("cpu", 1), telling("gpu", 2)]);
    let info = BackendInfo { name: "cpu,gpu", device: "device 1 and device 2".into(), lanes: 1, threads: 2 };
    assert_eq!(both.info(), info);
    assert_eq!(both.kernel(), "kernel 1 | kernel 2");
    let left_out = vec!["lens", "glass", "fuzz"];
    assert_eq!(both.kernel_contents(), KernelContents { present: "code 1 | code 2".into(), left_out });
    assert_eq!(both.hierarchy_time(), Duration::from_secs(3));
    assert_eq!(both.tile_occupancy().map(|found| found.tiles), Some(vec![[3, 4]]));
    assert_eq!(both.take_messages(), ["the first is here", "the second is here"]);
    for (names, name) in [(["cpu", "cpu"], "cpu"), (["gpu", "cpu"], "gpu"), (["gpu", "gpu"], "gpu")] {
        let [first, second] = names;
        assert_eq!(together([telling(first, 1), telling(second, 2)]).info().name, name);
    }
}

fn failing() -> Result<(), RenderError> {
    Err(RenderError::Backend { backend: "gpu", reason: "no such kernel".into() })
}

#[test]
fn a_member_that_cannot_prepare_is_left_out() {
    let mut both = together([telling("cpu", 1), Telling { prepared: failing, ..telling("gpu", 2) }]);
    let mut film = job(2).new_film();
    both.prepare(&job(2), &AtomicBool::new(false)).unwrap();
    assert_eq!(both.kernel(), "kernel 1");
    assert_eq!(
        both.take_messages(),
        [
            "gpu failed: no such kernel; cpu continues the same picture",
            "the second is here",
            "the first is here"
        ]
    );
    both.accumulate(&job(2), 0..8, &mut film, &AtomicBool::new(false)).unwrap();
    assert_eq!(film.sample_count(), 8);

    let [first, second] =
        [("cpu", 1), ("gpu", 2)].map(|(name, n)| Telling { prepared: failing, ..telling(name, n) });
    let outcome = together([first, second]).prepare(&job(2), &AtomicBool::new(false));
    assert!(matches!(outcome, Err(RenderError::Backend { .. })), "{outcome:?}");

    let cancelled: fn() -> Result<(), RenderError> = || Err(RenderError::Cancelled);
    let mut both = together([Telling { prepared: cancelled, ..telling("cpu", 1) }, telling("gpu", 2)]);
    let outcome = both.prepare(&job(2), &AtomicBool::new(false));
    assert!(matches!(outcome, Err(RenderError::Cancelled)), "{outcome:?}");
    assert_eq!(both.kernel(), "kernel 1 | kernel 2");
}

#[test]
fn the_status_describes_the_backend_at_work_and_adds_up_what_preparing_took() {
    let progressive = Progressive::with_factory(Box::new(|choice| {
        Ok(Box::new(telling(choice.name(), if *choice == CPU { 1 } else { 2 })))
    }));
    let mut progressive = progressive.unwrap();
    progressive.start(RenderRequest::new(job(2), CPU, Plan::endless()));
    wait_for(&progressive, 4);
    let told = |progressive: &Progressive| {
        let status = progressive.status();
        let device = status.backend.map(|backend| backend.device).unwrap_or_default();
        (device, status.kernel, status.left_out, status.hierarchy.as_secs(), status.messages)
    };
    let said = ["the first is here", "the second is here"].map(str::to_owned);
    assert_eq!(
        told(&progressive),
        ("device 1".to_owned(), "kernel 1".to_owned(), vec!["lens", "glass"], 1, said[..1].to_vec())
    );
    let before = progressive.status().prepare;
    progressive.switch_backend(other_cpu());
    wait_until(&progressive, |status| status.kernel != "kernel 1");
    assert_eq!(
        told(&progressive),
        ("device 2".to_owned(), "kernel 2".to_owned(), vec!["glass", "fuzz"], 3, said.to_vec())
    );
    assert!(progressive.status().prepare >= before);
}
