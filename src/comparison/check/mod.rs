//! `weekender check`: finds the mistake in a picture rendered by a reader's own program. (All chapters of book 1.)
//!
//! Renders every known mistake: with the program's own tracer where a rule, the scene or the camera can express it,
//! otherwise with a plain tracer that follows the book. A picture is right if it differs from ours only by noise;
//! otherwise the mistake with the closest picture is named.

mod answer;
mod fit;
mod hypothesis;
mod judge;
mod mask;
mod mine;
mod mistakes;
mod noise;
mod numbers;
mod random;
mod screen;
mod tracer;
mod watch;
mod written;

pub use crate::job::output::Damage;
pub use answer::{Answer, AnswerKind, Section};
pub use fit::Compared;
pub use hypothesis::{Hypothesis, Mistake, Studio};
pub use judge::{Finding, judge};
pub use mine::Mine;
pub use mistakes::MISTAKES;
pub use watch::{POLL_INTERVAL, Watched};

use super::answer::{Verdict, deliver, extended};
use crate::batch::aligned;
use crate::cli::{CheckOptions, check_outputs};
use crate::numbers::heat::HeatScale;
use crate::system::console;
use crate::system::files::{STANDARD, make_directory, replace_file, write_text};
use crate::system::terminal::{Display, ProgressChoice, print_beside};
use anyhow::{Context, Result, ensure};
use image::{ImageError, ImageFormat, RgbImage};
use serde_json::json;
use std::io::{self, IsTerminal, stderr};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// Checks pictures. Exit code 0 means that all are right, 1 that one is wrong, and 2 that one could not be checked.
pub fn run(options: &CheckOptions) -> Result<ExitCode> {
    let files = options.outputs();
    options.out.iter().try_for_each(|directory| make_directory(directory))?;
    let inputs = options.pictures.iter().map(PathBuf::as_path);
    check_outputs(inputs, files.iter().chain(&options.json).map(PathBuf::as_path))?;
    let count = options.pictures.len();
    ensure!(options.out.is_none() || count == 1, "--out is for a single picture, but there are {count}");
    if options.watch {
        return watch::run(options);
    }
    let [picture] = options.pictures.as_slice() else { return each(options) };
    let mine = Mine::read(picture)?;
    let finding = judged(&mine, options, &AtomicBool::new(false))?;
    // The verdict is worth more than the pictures.
    let wrote = write_pictures(&files, &mine, &finding);
    let files = if wrote.is_ok() { files } else { Vec::new() };
    let text = text(picture, &mine, &finding, &files, options.stage.is_some());
    deliver(options.json.as_deref(), &text, 1, &figures(picture, &mine, &finding, &files))?;
    wrote.map(|()| finding.answer(&mine).verdict().exit_code())
}

fn write_pictures(files: &[PathBuf], mine: &Mine, finding: &Finding) -> Result<()> {
    for (path, pixels) in files.iter().zip(pictures(mine, finding)) {
        let image = RgbImage::from_raw(mine.width, mine.height, pixels.into_iter().flatten().collect());
        let image = image.context("a picture has another size than its pixels")?;
        replace_file(path, |writer| {
            image.write_to(writer, ImageFormat::Png).map_err(|error| match error {
                ImageError::IoError(error) => error,
                other => io::Error::other(other),
            })
        })?;
    }
    Ok(())
}

/// Time between two lines of progress where there is no terminal.
const INTERVAL: Duration = Duration::from_secs(5);

/// Judges a picture and shows what is being tried.
fn judged(mine: &Mine, options: &CheckOptions, stop: &AtomicBool) -> Result<Finding> {
    let is_silent = options.progress == ProgressChoice::Auto && !stderr().is_terminal();
    let choice = if is_silent { ProgressChoice::On } else { options.progress };
    let (mut display, begin) = (Display::new(choice, 1, "{wide_msg}", "", INTERVAL), Instant::now());
    let finding = judge(mine, options.stage, stop, |what| {
        // A quick answer needs no lines in a log.
        if !is_silent || begin.elapsed() >= INTERVAL {
            display.update(0, || what);
        }
    });
    display.clear();
    finding
}

/// Checks several pictures, one line each.
fn each(options: &CheckOptions) -> Result<ExitCode> {
    let mut lines = Lines::new(options);
    let mut worst = Verdict::Same;
    for picture in &options.pictures {
        let judged =
            Mine::read(picture).and_then(|mine| Ok((judged(&mine, options, &AtomicBool::new(false))?, mine)));
        let judged = judged.map(|(finding, mine)| (mine, finding));
        worst = worst.max(lines.add(picture, &judged)?);
    }
    Ok(worst.exit_code())
}

/// One line for each verdict: as text, and as JSON if requested.
struct Lines<'a> {
    json: Option<&'a Path>,
    written: String,
}

impl<'a> Lines<'a> {
    fn new(options: &'a CheckOptions) -> Self {
        Lines { json: options.json.as_deref(), written: String::new() }
    }

    fn add(&mut self, path: &Path, judged: &Result<(Mine, Finding)>) -> Result<Verdict> {
        let (mine, finding) = match judged {
            Ok(judged) => judged,
            Err(reason) => {
                let figures =
                    json!({ "picture": path.display().to_string(), "error": format!("{reason:#}") });
                self.say(&format!("{}: {reason:#}\n", path.display()), figures)?;
                return Ok(Verdict::Unclear);
            }
        };
        let answer = finding.answer(mine);
        let rows = if mine.rows < mine.height {
            format!("{} of {} rows, ", mine.rows, mine.height)
        } else {
            String::new()
        };
        let section = finding.stage.section;
        let text = format!("{}: {rows}section {section}: {}\n", path.display(), answer.title);
        self.say(&text, figures(path, mine, finding, &[]))?;
        Ok(answer.verdict())
    }

    fn say(&mut self, text: &str, mut figures: serde_json::Value) -> Result<()> {
        print_beside(self.json, text)?;
        let Some(target) = self.json else { return Ok(()) };
        figures["schema"] = 1.into();
        let line = format!("{figures}\n");
        if target == Path::new(STANDARD) {
            return console::write_out(&line);
        }
        self.written += &line;
        Ok(write_text(target, &self.written)?)
    }
}

/// The reader's picture, ours, and a heat map of the difference: 8-bit RGB, row by row from the top.
fn pictures(mine: &Mine, finding: &Finding) -> [Vec<[u8; 3]>; 3] {
    let right = &finding.right;
    let ours = right.hypothesis.written.bytes_of(&right.rendered.mean(), [mine.width, mine.height]);
    let difference = mine.bytes.iter().zip(&ours).map(|(mine, ours)| {
        let square = |channel: usize| ((f64::from(mine[channel]) - f64::from(ours[channel])) / 255.0).powi(2);
        HeatScale::DISPLAYED.colour(((square(0) + square(1) + square(2)) / 3.0).sqrt())
    });
    let difference = difference.collect();
    [mine.bytes.clone(), ours, difference]
}

/// The report for people; `files` lists the pictures written, and `is_chosen` tells whether the user chose the stage.
pub fn text(path: &Path, mine: &Mine, finding: &Finding, files: &[PathBuf], is_chosen: bool) -> String {
    let (stage, answer) = (finding.stage, finding.answer(mine));
    let mut text = vec![("verdict", answer.title), ("", answer.explanation)];
    text.extend(answer.remedy.map(|remedy| ("change", remedy)));
    text.extend(answer.evidence.into_iter().map(|line| ("seen", line)));
    if answer.kind == AnswerKind::Unknown {
        let stage = if is_chosen { "" } else { "--stage names the section, and " };
        text.push(("note", format!("{stage}--out DIR shows where the two differ")));
    }
    text.push(("picture", format!("{}, {}, {}x{}", path.display(), mine.format, mine.width, mine.height)));
    text.push(("stage", format!("{}, section {}, {}", stage.id, stage.section, stage.section_title())));
    text.extend(answer.section.map(|section| ("read", format!("{}, {}", section.number, section.url))));
    text.extend(mine.notes.iter().map(|note| ("note", note.clone())));
    for damage in answer.damages {
        text.extend([("file", damage.title), ("change", damage.remedy.to_owned())]);
    }
    if !files.is_empty() {
        let files: Vec<String> = files.iter().map(|path| path.display().to_string()).collect();
        text.push(("files", files.join(", ")));
    }
    aligned(&text)
}

/// The report as JSON.
fn figures(path: &Path, mine: &Mine, finding: &Finding, files: &[PathBuf]) -> serde_json::Value {
    let answer = finding.answer(mine);
    let explains = &finding.found.as_ref().unwrap_or(&finding.right).hypothesis;
    let named = |it: &Hypothesis| it.named().filter(|_| it.numbers.is_empty());
    let mistake = named(explains).map(|mistake| {
        let also = finding.alike.iter().filter_map(named).map(|also| also.id).collect::<Vec<_>>();
        extended(mistake, json!({ "note": explains.note, "explains_all": finding.is_sure, "also": also }))
    });
    let variants = finding.right.hypothesis.rows.iter().filter(|row| row.is_right).map(|row| row.id);
    let more = json!({
        "picture": path.display().to_string(),
        "format": mine.format,
        "width": mine.width,
        "height": mine.height,
        "rows": mine.rows,
        "stage": finding.stage.id,
        "section": finding.stage.section,
        "is_right": answer.verdict() == Verdict::Same,
        "mistake": mistake,
        "numbers": explains.numbers,
        "variants": variants.collect::<Vec<_>>(),
        "samples": finding.samples(),
        "damages": mine.damages,
        "files": files.iter().map(|path| path.display().to_string()).collect::<Vec<_>>(),
    });
    extended(&answer, more)
}

#[cfg(test)]
mod tests;
