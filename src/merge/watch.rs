//! `--watch`: merges parts as they come, and writes the picture so far.

use super::parts::{self, PlanSum, State};
use super::{Lacking, write, wrote};
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
            let copy = watched.copy();
            let written = watched.so_far(copy, |sum| -> Result<(Lacking, String), Failure> {
                if sum.film().sample_count() > 0 {
                    let names: Vec<String> = options.out.iter().map(ShownPath::shown).collect();
                    let _writing = interrupt.while_writing(names.join(" and "));
                    write(&options.out, sum.film(), plan.recipe.rules.transfer, &sum.description())?;
                    console::note(&sum.words());
                    last = Some(Instant::now());
                }
                Ok((sum.lacking(), sum.words()))
            });
            match written {
                Ok(end) => {
                    let end = end?;
                    is_news = false;
                    if is_over {
                        break end;
                    }
                    continue;
                }
                Err(error) if is_over => return Err(Failure::run(error)),
                Err(_) => is_news = true,
            }
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
        self.add_whole().unwrap_or_else(|error| {
            self.begin_anew(&error);
            true
        })
    }

    fn add_whole(&mut self) -> Result<bool, MergeError> {
        let mut is_news = false;
        for part in &mut self.awaited {
            let path = self.plan.part_path(&self.plan.manifest.work.parts[part.index]);
            let now = stamp(&path);
            if now.is_none() || now == part.seen {
                continue;
            }
            (part.seen, is_news) = (now, true);
            let state = self.sum.add(part.index, false)?;
            if let State::Wrong(_) = state {
                console::note(&format!("warning: {}", parts::line(self.plan, part.index, state)));
            }
        }
        self.awaited.retain(|part| !self.sum.is_whole(part.index));
        Ok(is_news)
    }

    /// A copy of the sum for the checkpoints of unfinished parts, if there are any parts to come and memory for it.
    fn copy(&self) -> Option<PlanSum<'a>> {
        if self.awaited.is_empty() { None } else { self.sum.try_copy().ok() }
    }

    /// Hands `write` the sum with the checkpoints of unfinished parts. They belong to the picture so far but will grow, so
    /// they are added to a `copy` or, without one, taken away again.
    ///
    /// # Errors
    /// Without a copy: if a checkpoint has spoiled the sum. All parts are then awaited again.
    fn so_far<T>(
        &mut self,
        copy: Option<PlanSum<'a>>,
        write: impl FnOnce(&PlanSum) -> T,
    ) -> Result<T, MergeError> {
        let Some(mut copy) = copy else {
            if let Err(error) = add_checkpoints(&mut self.sum, &self.awaited) {
                self.begin_anew(&error);
                return Err(error);
            }
            let written = write(&self.sum);
            match self.sum.take_back() {
                Ok(()) => self.awaited.retain(|part| !self.sum.is_whole(part.index)),
                Err(error) => self.begin_anew(&error),
            }
            return Ok(written);
        };
        if let Err(error) = add_checkpoints(&mut copy, &self.awaited) {
            console::note(&format!("warning: {}; the picture has whole parts only", reason(&error)));
            return Ok(write(&self.sum));
        }
        // What has become whole in the copy is still to be added to the sum.
        for part in self.awaited.iter_mut().filter(|part| copy.is_whole(part.index)) {
            part.seen = None;
        }
        Ok(write(&copy))
    }

    /// Reads all parts again, because of an error that has spoiled the sum.
    fn begin_anew(&mut self, error: &MergeError) {
        console::note(&format!("warning: {}; all parts are read again", reason(error)));
        self.sum.clear();
        self.awaited = awaited(self.plan);
    }
}

/// All parts of a plan.
fn awaited(plan: &Plan<Samples>) -> Vec<Awaited> {
    (0..plan.manifest.work.parts.len()).map(|index| Awaited { index, seen: None }).collect()
}

fn add_checkpoints(sum: &mut PlanSum, awaited: &[Awaited]) -> Result<(), MergeError> {
    awaited.iter().try_for_each(|part| sum.add(part.index, true).map(drop))
}

fn reason(error: &MergeError) -> String {
    match error {
        MergeError::Lost { reason } => reason.to_string(),
        error => error.to_string(),
    }
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
    fn a_checkpoint_that_is_copied_over_while_the_picture_is_written_does_not_spoil_the_sum() {
        for has_memory in [true, false] {
            let (_directory, plan) = planned();
            save(&plan, "part-0.exr", 7..17);
            save(&plan, "longer.exr", 7..22);
            let mut watched = Watched::new(&plan).unwrap();
            assert!(watched.look());
            let copy = watched.copy().filter(|_| has_memory);
            let written = watched.so_far(copy, |sum| {
                // Into the file that is there, as `cp` does.
                std::fs::copy(plan.beside("longer.exr"), plan.beside("part-0.exr")).unwrap();
                sum.film().clone()
            });
            assert!(written.unwrap() == film(&plan, 7..17));
            save(&plan, "part-0.exr", 7..30);
            save(&plan, "part-1.exr", 30..50);
            assert!(watched.look() && watched.awaited.is_empty());
            assert!(watched.sum.film() == &film(&plan, 7..50), "{has_memory}");
        }
    }

    #[test]
    fn a_part_that_becomes_whole_before_the_picture_is_written_is_added_for_good() {
        for has_memory in [true, false] {
            let (_directory, plan) = planned();
            save(&plan, "part-0.exr", 7..17);
            let mut watched = Watched::new(&plan).unwrap();
            assert!(watched.look());
            save(&plan, "part-0.exr", 7..30);
            save(&plan, "part-1.exr", 30..41);
            let copy = watched.copy().filter(|_| has_memory);
            let written = watched.so_far(copy, |sum| (sum.film().clone(), sum.whole())).unwrap();
            assert!(written == (film(&plan, 7..41), 1));
            watched.look();
            assert!(watched.sum.film() == &film(&plan, 7..30), "{has_memory}");
            assert_eq!(watched.awaited.iter().map(|part| part.index).collect::<Vec<_>>(), [1]);
        }
    }

    #[test]
    fn a_part_that_could_not_be_read_at_first_is_added_though_its_file_looks_the_same() {
        for has_memory in [true, false] {
            let (_directory, plan) = planned();
            save(&plan, "part-0.exr", 7..30);
            let path = plan.beside("part-0.exr");
            let (bytes, changed) =
                (std::fs::read(&path).unwrap(), std::fs::metadata(&path).unwrap().modified().unwrap());
            let put = |bytes: &[u8]| {
                std::fs::write(&path, bytes).unwrap();
                let file = std::fs::File::options().write(true).open(&path).unwrap();
                file.set_modified(changed).unwrap();
            };
            put(&vec![0; bytes.len()]);
            let mut watched = Watched::new(&plan).unwrap();
            assert!(watched.look() && watched.sum.whole() == 0);
            put(&bytes);
            let copy = watched.copy().filter(|_| has_memory);
            assert_eq!(watched.so_far(copy, |sum| sum.whole()).unwrap(), 1);
            watched.look();
            assert!(watched.sum.film() == &film(&plan, 7..30), "{has_memory}");
        }
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
