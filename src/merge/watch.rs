//! `--watch`: merges parts as they come, and writes the picture so far.

use super::parts::{self, PlanSum, State};
use super::{write, wrote};
use crate::cli::MergeOptions;
use crate::console;
use crate::failure::Failure;
use crate::files::{ShownPath, Stamp};
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
    let mut sum = PlanSum::new(plan).map_err(Failure::input)?;
    let mut awaited: Vec<Awaited> =
        (0..plan.manifest.work.parts.len()).map(|index| Awaited { index, seen: None }).collect();
    let (mut is_news, mut last) = (false, None::<Instant>);
    loop {
        is_news |= look(plan, &mut sum, &mut awaited)?;
        let is_over = awaited.is_empty() || interrupt.is_set();
        if is_over || is_news && is_due(last.map(|last| last.elapsed()), every) {
            // Checkpoints belong to the picture so far. They will grow, so they are taken away again.
            for part in &awaited {
                sum.add(part.index, true).map_err(Failure::run)?;
            }
            if sum.film().sample_count() > 0 {
                let names: Vec<String> = options.out.iter().map(ShownPath::shown).collect();
                let _writing = interrupt.while_writing(names.join(" and "));
                write(&options.out, sum.film(), plan.recipe.rules.transfer, &sum.description())?;
                console::note(&sum.words());
                last = Some(Instant::now());
            }
            is_news = false;
            if is_over {
                break;
            }
            sum.take_back().map_err(Failure::run)?;
            awaited.retain(|part| !sum.is_whole(part.index));
            continue;
        }
        let begin = Instant::now();
        while begin.elapsed() < LOOK && !interrupt.is_set() {
            sleep(SIGNAL);
        }
    }
    let lacking = sum.lacking();
    if lacking.is_empty() {
        print(&format!("{}\n{}", sum.words(), wrote(&options.out))).map_err(Failure::Run)?;
        return Ok(ExitCode::SUCCESS);
    }
    console::note("interrupted; the same command goes on");
    console::note(&parts::remedy(plan, &parts::numbers(&lacking), &options.program));
    Ok(interrupt.exit_code())
}

/// Whether a picture may be written: the first at once, and the next when `every` has passed `since` the last.
fn is_due(since: Option<Duration>, every: Duration) -> bool {
    since.is_none_or(|since| since >= every)
}

/// Adds the parts that have become whole. Returns whether any file has changed.
fn look(plan: &Plan<Samples>, sum: &mut PlanSum, awaited: &mut Vec<Awaited>) -> Result<bool, Failure> {
    let mut is_news = false;
    for part in awaited.iter_mut() {
        let path = plan.part_path(&plan.manifest.work.parts[part.index]);
        let now = stamp(&path);
        if now.is_none() || now == part.seen {
            continue;
        }
        (part.seen, is_news) = (now, true);
        let state = sum.add(part.index, false).map_err(Failure::run)?;
        if let State::Wrong(_) = state {
            console::note(&format!("warning: {}", parts::line(plan, part.index, state)));
        }
    }
    awaited.retain(|part| !sum.is_whole(part.index));
    Ok(is_news)
}

/// The file as it is now; `None` if there is none, or if it cannot be looked at.
pub(super) fn stamp(path: &Path) -> Option<Stamp> {
    Stamp::of(path).ok().flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

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
