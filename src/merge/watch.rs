//! `--watch`: merges parts as they come, and writes the picture so far.

use super::parts::{self, PlanSum, State};
use super::{write, wrote};
use crate::cli::MergeOptions;
use crate::console;
use crate::failure::Failure;
use crate::files::{ShownPath, Stamp};
use crate::film::MergeError;
use crate::interrupt::Interrupt;
use crate::plan::{Plan, Samples};
use crate::terminal::print;
use std::path::Path;
use std::process::ExitCode;
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Pause between two looks at the directory, and at the signals.
pub(super) const LOOK: Duration = Duration::from_secs(1);
pub(super) const SIGNAL: Duration = Duration::from_millis(100);

/// A part that is awaited.
struct Awaited {
    index: usize,
    /// The file that was seen last.
    seen: Option<Stamp>,
}

/// Merges until all parts are whole, or until a signal.
///
/// # Errors
/// [`Failure::Input`] if there is not enough memory; [`Failure::Run`] if the picture cannot be written.
pub(super) fn run(
    plan: &Plan<Samples>,
    options: &MergeOptions,
    every: Duration,
) -> Result<ExitCode, Failure> {
    let interrupt = Interrupt::install().map_err(Failure::Run)?;
    let mut watched = Watched::new(plan).map_err(Failure::input)?;
    let (mut is_news, mut last) = (false, None::<Instant>);
    let (lacking, words) = loop {
        is_news |= watched.look();
        let is_over = watched.awaited.is_empty() || interrupt.is_set();
        if is_over || is_news && is_due(last.map(|last| last.elapsed()), every) {
            let so_far = watched.so_far();
            let sum = so_far.as_ref().unwrap_or(&watched.sum);
            if sum.film().sample_count() > 0 {
                let names: Vec<String> = options.out.iter().map(ShownPath::shown).collect();
                let _writing = interrupt.while_writing(names.join(" and "));
                write(&options.out, sum.film(), plan.recipe.rules.transfer, &sum.description())?;
                console::note(&sum.words());
                last = Some(Instant::now());
            }
            is_news = false;
            if is_over {
                break (sum.lacking(), sum.words());
            }
            continue;
        }
        let begin = Instant::now();
        while begin.elapsed() < LOOK && !interrupt.is_set() {
            sleep(SIGNAL);
        }
    };
    if lacking.is_empty() {
        print(&format!("{words}\n{}", wrote(&options.out))).map_err(Failure::Run)?;
        return Ok(ExitCode::SUCCESS);
    }
    console::note("interrupted; the same command goes on");
    parts::note_remedy(plan, &parts::numbers(&lacking), &options.program);
    Ok(interrupt.exit_code())
}

/// The sum of the parts that are whole, and the parts that are awaited.
struct Watched<'a> {
    plan: &'a Plan<Samples>,
    sum: PlanSum<'a>,
    awaited: Vec<Awaited>,
}

impl<'a> Watched<'a> {
    fn new(plan: &'a Plan<Samples>) -> Result<Self, MergeError> {
        let sum = PlanSum::new(plan)?;
        Ok(Watched { plan, sum, awaited: awaited(plan) })
    }

    /// Adds the parts that have become whole. Returns whether any file has changed.
    fn look(&mut self) -> bool {
        let mut is_news = false;
        for part in &mut self.awaited {
            let path = self.plan.part_path(&self.plan.manifest.work.parts[part.index]);
            let now = stamp(&path);
            if now.is_none() || now == part.seen {
                continue;
            }
            (part.seen, is_news) = (now, true);
            let state = self.sum.add(part.index, false);
            if let State::Wrong(_) = state {
                console::note(&format!("warning: {}", parts::line(self.plan, part.index, state)));
            }
        }
        self.awaited.retain(|part| !self.sum.is_whole(part.index));
        is_news
    }

    /// A copy of the sum with the checkpoints of unfinished parts; `None` if all parts are whole, or if there is no memory
    /// for it. They belong to the picture so far but will grow, so they do not stay in the sum.
    fn so_far(&mut self) -> Option<PlanSum<'a>> {
        if self.awaited.is_empty() {
            return None;
        }
        let mut copy = match self.sum.try_copy() {
            Ok(copy) => copy,
            Err(error) => {
                console::note(&format!("warning: {error}; the picture so far has whole parts only"));
                return None;
            }
        };
        for part in &mut self.awaited {
            // What has become whole by now is still to be added to the sum.
            if *copy.add(part.index, true) == State::Whole {
                part.seen = None;
            }
        }
        Some(copy)
    }
}

/// All parts of a plan.
fn awaited(plan: &Plan<Samples>) -> Vec<Awaited> {
    (0..plan.manifest.work.parts.len()).map(|index| Awaited { index, seen: None }).collect()
}

/// Whether a picture may be written: the first at once, and the next when `every` has passed `since` the last.
fn is_due(since: Option<Duration>, every: Duration) -> bool {
    since.is_none_or(|since| since >= every)
}

/// The file as it is now; `None` if there is none, or if it cannot be looked at.
pub(super) fn stamp(path: &Path) -> Option<Stamp> {
    Stamp::of(path).ok().flatten()
}

#[cfg(test)]
mod tests {
    use super::super::parts::tests::{film, planned, save};
    use super::*;

    #[test]
    fn checkpoints_belong_to_the_picture_so_far_and_whole_parts_to_the_sum() {
        let (_directory, plan) = planned();
        save(&plan, "part-0.exr", 7..17);
        let mut watched = Watched::new(&plan).unwrap();
        assert!(watched.look() && !watched.look());
        assert!(watched.so_far().unwrap().film() == &film(&plan, 7..17));
        // A part that becomes whole before the picture is written.
        save(&plan, "part-0.exr", 7..30);
        save(&plan, "part-1.exr", 30..41);
        let so_far = watched.so_far().unwrap();
        assert!((so_far.film(), so_far.whole()) == (&film(&plan, 7..41), 1));
        assert!(watched.look() && watched.sum.film() == &film(&plan, 7..30));
        assert_eq!(watched.awaited.iter().map(|part| part.index).collect::<Vec<_>>(), [1]);
        save(&plan, "part-1.exr", 30..50);
        assert!(watched.look() && watched.so_far().is_none());
        assert!(watched.sum.film() == &film(&plan, 7..50));
    }

    #[test]
    fn the_first_picture_is_due_at_once_and_the_next_after_the_pause() {
        let is_due = |since: Option<u64>| is_due(since.map(Duration::from_secs), Duration::from_secs(60));
        assert_eq!(
            [None, Some(0), Some(59), Some(60), Some(61)].map(is_due),
            [true, false, false, true, true]
        );
    }

    #[test]
    fn a_file_that_is_not_there_has_no_stamp_and_one_that_grows_another() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("part.exr");
        assert_eq!(stamp(&path), None);
        std::fs::write(&path, "a").unwrap();
        let first = stamp(&path);
        assert!(first.is_some() && stamp(&path) == first);
        std::fs::write(&path, "longer").unwrap();
        assert_ne!(stamp(&path), first);
    }
}
