//! Merges the existing parts of a plan, or parts as they come.

use super::pieces::{Piece, Pieces, State};
use super::{check_outputs, warn_of_loss, write, wrote};
use crate::cli::MergeOptions;
use crate::cli::terminal::print;
use crate::film::{Film, FilmSum, MergeError, key};
use crate::job::output::{OutputFormat, write_animation};
use crate::job::plan::{Frames, Plan, Work};
use crate::job::saved::same_job;
use crate::progressive::Status;
use crate::progressive::describe::{describe, describe_animation};
use crate::system::console;
use crate::system::failure::{FAILED, Failure};
use crate::system::files::ShownPath;
use crate::system::interrupt::Interrupt;
use anyhow::anyhow;
use std::process::ExitCode;
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Pause between checks of signals.
const SIGNAL: Duration = Duration::from_millis(100);

/// Merges, watches or checks the parts.
pub(super) fn run(plan: &Plan, options: &MergeOptions) -> Result<ExitCode, Failure> {
    check_outputs("a file of the plan", &plan.files(), options)?;
    let sum = match plan.manifest.work {
        Work::Samples(_) => Some(empty_sum(plan).map_err(Failure::input)?),
        Work::Frames(_) => check_names(options).map(|()| None)?,
    };
    let pieces = Pieces::of(plan);
    let mut merging = Merging { options, pieces, sum, found: String::new(), is_written: false };
    if options.check {
        return merging.check();
    }
    let interrupt = if options.watch { Some(Interrupt::install().map_err(Failure::Run)?) } else { None };
    let is_interrupted = || interrupt.as_ref().is_some_and(Interrupt::is_set);
    loop {
        let is_end = !options.watch || is_interrupted();
        let before = merging.found.clone();
        merging.merge(interrupt.as_ref(), is_end)?;
        if is_end || merging.pieces.is_complete() {
            return merging.finish(interrupt.filter(Interrupt::is_set));
        }
        if merging.found != before {
            merging.pieces.wrong().for_each(|line| console::note(&format!("warning: {line}")));
            console::note(&merging.found);
        }
        let begin = Instant::now();
        while begin.elapsed() < options.every && !is_interrupted() {
            sleep(SIGNAL.min(options.every));
        }
    }
}

/// Refuses a result that is not an animated PNG.
fn check_names(options: &MergeOptions) -> Result<(), Failure> {
    let is_png = |out: &&std::path::PathBuf| matches!(OutputFormat::from_path(out), Ok(OutputFormat::Png));
    match options.out.iter().find(|out| !is_png(out)) {
        Some(out) => Err(Failure::Input(anyhow!(
            "--out is {}, but the frames of an animation make an animated PNG; let the name end in .png",
            out.shown()
        ))),
        None => Ok(()),
    }
}

/// A merge in progress.
struct Merging<'a> {
    options: &'a MergeOptions,
    pieces: Pieces<'a>,
    /// The sum of the whole parts, until the end; `None` for frames.
    sum: Option<FilmSum>,
    /// How much exists, as of the last merge.
    found: String,
    is_written: bool,
}

impl Merging<'_> {
    /// Reads everything, and prints what is missing, damaged or foreign.
    fn check(mut self) -> Result<ExitCode, Failure> {
        self.pieces.look();
        if let Some(sum) = &mut self.sum {
            add(sum, &mut self.pieces.all, true);
        }
        let (pieces, is_complete) = (&self.pieces, self.pieces.is_complete());
        let mut lines: Vec<String> = pieces.lines().chain([pieces.words()]).collect();
        if !is_complete {
            lines.push(pieces.remedy(&self.options.program));
        }
        print(&(lines.join("\n") + "\n")).map_err(Failure::Run)?;
        Ok(if is_complete { ExitCode::SUCCESS } else { ExitCode::from(FAILED) })
    }

    /// Writes the picture so far if it has changed, or the animation once it is complete.
    fn merge(&mut self, interrupt: Option<&Interrupt>, is_end: bool) -> Result<(), Failure> {
        let Merging { options, pieces, sum, found, is_written } = self;
        let plan = pieces.plan;
        pieces.look();
        let names: Vec<String> = options.out.iter().map(ShownPath::shown).collect();
        let _writing = interrupt.map(|interrupt| interrupt.while_writing(names.join(" and ")));
        if let Work::Frames(work) = &plan.manifest.work {
            *found = pieces.words();
            if pieces.is_complete() {
                assemble(plan, work, options)?;
                *is_written = true;
            }
            return Ok(());
        }
        let Some(whole) = sum else { return Ok(()) };
        add(whole, &mut pieces.all, false);
        // Unfinished checkpoints will grow, so they are added to a copy unless this is the end.
        let mut sum = if is_end || pieces.is_complete() {
            sum.take()
        } else {
            whole.try_copy().inspect_err(|error| console::note(&format!("warning: {error}"))).ok()
        };
        let Some(sum) = &mut sum else { return Ok(()) };
        add(sum, &mut pieces.all, true);
        let (samples, lengths) = (sum.film().samples(), plan.manifest.work.lengths());
        let (count, of) = (samples.count(), lengths.iter().sum::<u64>());
        let now = format!("{count} of {of} samples per pixel ({samples}); {}", pieces.words());
        let is_new = now != *found;
        *found = now;
        if is_new && count > 0 {
            if !*is_written {
                warn_of_loss(&options.out, sum.film(), &sum.description());
            }
            write(&options.out, sum.film(), plan.recipe.rules.transfer, &sum.description())?;
            *is_written = true;
        }
        Ok(())
    }

    /// Reports the outcome; `interrupt` is that of a merge that was interrupted.
    fn finish(self, interrupt: Option<Interrupt>) -> Result<ExitCode, Failure> {
        let Merging { options, pieces, found, is_written, .. } = self;
        if is_written {
            print(&format!("{found}\n{}", wrote(&options.out))).map_err(Failure::Run)?;
        } else {
            console::note(&found);
        }
        if pieces.is_complete() {
            return Ok(ExitCode::SUCCESS);
        }
        if interrupt.is_some() {
            console::note("interrupted; the same command continues");
        }
        pieces.lines().for_each(|line| console::note(&line));
        console::note(&pieces.remedy(&options.program));
        Ok(interrupt.map_or(ExitCode::from(FAILED), |interrupt| interrupt.exit_code()))
    }
}

fn empty_sum(plan: &Plan) -> Result<FilmSum, MergeError> {
    let settings = plan.job.settings();
    let mut description = describe(&plan.recipe, plan.stage(), &Film::new(1, 1, 1), &Status::default(), None);
    description.set(key::COMMAND, &plan.manifest.command);
    FilmSum::new(settings.width, settings.height, settings.half_count(), description, &plan.path)
}

/// Adds the films of whole parts, and of unfinished ones `with_unfinished`. One that cannot be added becomes
/// [`State::Wrong`].
fn add(sum: &mut FilmSum, pieces: &mut [Piece], with_unfinished: bool) {
    for piece in pieces.iter_mut().filter(|piece| !piece.is_merged) {
        match piece.state {
            State::Whole => {}
            State::Unfinished { .. } if with_unfinished => {}
            _ => continue,
        }
        match sum.add(&piece.path, same_job) {
            Ok(_) => piece.is_merged = piece.state == State::Whole,
            Err(MergeError::OtherJob { other, difference, .. }) => {
                let other = other.shown();
                piece.state = State::Wrong(format!(
                    "{other} is the film of another picture: {difference}; move it away"
                ));
            }
            Err(error) => piece.state = State::Wrong(error.to_string()),
        }
    }
}

/// Makes the animated PNG of all frames.
fn assemble(plan: &Plan, work: &Frames, options: &MergeOptions) -> Result<(), Failure> {
    let (settings, names) = (plan.job.settings(), plan.frame_names());
    let description = describe_animation(&plan.recipe, &plan.manifest.command);
    let size = [settings.width, settings.height];
    for out in &options.out {
        let frames = work.range().map(|frame| names.path(frame));
        write_animation(out, size, work.rate, frames, &description).map_err(Failure::run)?;
    }
    Ok(())
}
