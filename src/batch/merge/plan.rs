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

/// Pause between checks of the directory and of signals.
const LOOK: Duration = Duration::from_secs(1);
const SIGNAL: Duration = Duration::from_millis(100);

/// Merges, watches or checks the parts.
pub(super) fn run(plan: &Plan, options: &MergeOptions) -> Result<ExitCode, Failure> {
    check_outputs("a file of the plan", &plan.files(), options)?;
    let sum = match &plan.manifest.work {
        Work::Samples(_) => Some(empty_sum(plan).map_err(Failure::input)?),
        Work::Frames(_) => {
            check_names(options)?;
            None
        }
    };
    let mut merging = Merging {
        options,
        pieces: Pieces::of(plan),
        sum,
        interrupt: None,
        words: String::new(),
        is_written: false,
    };
    if options.check {
        return merging.check();
    }
    if options.watch {
        merging.interrupt = Some(Interrupt::install().map_err(Failure::Run)?);
        merging.watch(options.every)?;
    } else {
        merging.pieces.look();
        merging.write(true)?;
    }
    merging.finish()
}

fn empty_sum(plan: &Plan) -> Result<FilmSum, MergeError> {
    let settings = plan.job.settings();
    let mut description = describe(&plan.recipe, plan.stage(), &Film::new(1, 1, 1), &Status::default(), None);
    description.set(key::COMMAND, &plan.manifest.command);
    FilmSum::new(settings.width, settings.height, settings.half_count(), description, &plan.path)
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
    /// The sum of films; `None` for frames.
    sum: Option<FilmSum>,
    /// Set while waiting for parts.
    interrupt: Option<Interrupt>,
    /// How much exists.
    words: String,
    is_written: bool,
}

impl Merging<'_> {
    /// Reads everything, and prints what is missing, damaged or foreign.
    fn check(mut self) -> Result<ExitCode, Failure> {
        self.pieces.look();
        if let Some(sum) = &mut self.sum {
            add(sum, &mut self.pieces.all, |state| matches!(state, State::Whole | State::Unfinished { .. }));
        }
        let (pieces, is_complete) = (&self.pieces, self.pieces.is_complete());
        let mut lines: Vec<String> = pieces.lines().chain([pieces.words()]).collect();
        if !is_complete {
            lines.push(pieces.remedy(&self.options.program));
        }
        print(&(lines.join("\n") + "\n")).map_err(Failure::Run)?;
        Ok(if is_complete { ExitCode::SUCCESS } else { ExitCode::from(FAILED) })
    }

    /// Merges parts as they come, until all are complete or a signal arrives.
    fn watch(&mut self, every: Duration) -> Result<(), Failure> {
        let (mut is_news, mut last) = (true, None::<Instant>);
        loop {
            for changed in self.pieces.look() {
                is_news = true;
                if let State::Wrong(_) = changed.state {
                    console::note(&format!("warning: {}", changed.line()));
                }
            }
            let is_end = self.is_interrupted() || self.pieces.is_complete();
            if is_news && (is_end || last.is_none_or(|last| last.elapsed() >= every)) {
                if self.write(is_end)? {
                    console::note(&self.words);
                    last = Some(Instant::now());
                }
                is_news = false;
            }
            // What seemed complete may have turned out to be damaged.
            if self.is_interrupted() || self.pieces.is_complete() {
                return Ok(());
            }
            let begin = Instant::now();
            while begin.elapsed() < LOOK && !self.is_interrupted() {
                sleep(SIGNAL);
            }
        }
    }

    fn is_interrupted(&self) -> bool {
        self.interrupt.as_ref().is_some_and(Interrupt::is_set)
    }

    /// Writes the picture so far, or the animation once it is complete. Returns whether there is anything to report.
    fn write(&mut self, is_end: bool) -> Result<bool, Failure> {
        let plan = self.pieces.plan;
        let names: Vec<String> = self.options.out.iter().map(ShownPath::shown).collect();
        let _writing = self.interrupt.as_ref().map(|interrupt| interrupt.while_writing(names.join(" and ")));
        let Some(sum) = &mut self.sum else {
            self.words = self.pieces.words();
            if let (Work::Frames(work), true) = (&plan.manifest.work, self.pieces.is_complete()) {
                assemble(plan, work, self.options)?;
                self.is_written = true;
            }
            return Ok(true);
        };
        let mut wrong = add(sum, &mut self.pieces.all, |state| *state == State::Whole);
        // Unfinished checkpoints will grow, so they are added to a copy unless this is the end.
        let mut copy = if is_end { None } else { sum.try_copy().ok() };
        if is_end || copy.is_some() {
            let sum = copy.as_mut().unwrap_or(&mut *sum);
            let unfinished = |state: &State| matches!(state, State::Unfinished { .. });
            wrong.extend(add(sum, &mut self.pieces.all, unfinished));
        } else {
            console::note("warning: there is no memory for the checkpoints of unfinished parts");
        }
        // The end lists them among what is missing.
        if !is_end {
            wrong.iter().for_each(|line| console::note(&format!("warning: {line}")));
        }
        let sum = copy.as_ref().unwrap_or(sum);
        let (samples, lengths) = (sum.film().samples(), plan.manifest.work.lengths());
        let (count, of) = (samples.count(), lengths.iter().sum::<u64>());
        self.words = format!("{count} of {of} samples per pixel ({samples}); {}", self.pieces.words());
        if sum.film().sample_count() == 0 {
            return Ok(false);
        }
        let description = sum.description();
        if !self.is_written {
            warn_of_loss(&self.options.out, sum.film(), &description);
        }
        write(&self.options.out, sum.film(), plan.recipe.rules.transfer, &description)?;
        self.is_written = true;
        Ok(true)
    }

    /// Reports the outcome.
    fn finish(self) -> Result<ExitCode, Failure> {
        let Merging { options, pieces, interrupt, words, is_written, .. } = self;
        if is_written {
            print(&format!("{words}\n{}", wrote(&options.out))).map_err(Failure::Run)?;
        } else {
            console::note(&words);
        }
        if pieces.is_complete() {
            return Ok(ExitCode::SUCCESS);
        }
        let interrupted = interrupt.filter(Interrupt::is_set);
        if interrupted.is_some() {
            console::note("interrupted; the same command continues");
        }
        pieces.lines().for_each(|line| console::note(&line));
        console::note(&pieces.remedy(&options.program));
        Ok(interrupted.map_or(ExitCode::from(FAILED), |interrupt| interrupt.exit_code()))
    }
}

/// Adds the films whose state `fits` to the sum. One that cannot be added becomes [`State::Wrong`]; returns lines about
/// these.
fn add(sum: &mut FilmSum, pieces: &mut [Piece], fits: impl Fn(&State) -> bool) -> Vec<String> {
    let mut wrong = Vec::new();
    for piece in pieces.iter_mut().filter(|piece| fits(&piece.state) && !piece.is_merged) {
        let reason = match sum.add(&piece.path, same_job) {
            Ok(_) => {
                piece.is_merged = piece.state == State::Whole;
                continue;
            }
            Err(MergeError::OtherJob { other, difference, .. }) => {
                format!("{} is the film of another picture: {difference}; move it away", other.shown())
            }
            Err(error) => error.to_string(),
        };
        piece.state = State::Wrong(reason);
        wrong.push(piece.line());
    }
    wrong
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
