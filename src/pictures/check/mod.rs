//! `weekender check`: finds the mistake in a picture rendered by a reader's own program. (All chapters of book 1.)
//!
//! Renders every known mistake: with the program's own tracer where a rule, the scene or the camera can express it,
//! otherwise with a plain tracer that follows the book. A picture is right if it differs from ours only by noise;
//! otherwise the mistake with the closest picture is named.

mod answer;
mod bytes;
mod hypothesis;
mod judge;
mod mine;
mod mistakes;
mod tracer;

pub use crate::job::output::Damage;
pub use answer::{Answer, AnswerKind, Section};
pub use hypothesis::{Compared, Hypothesis, Mistake, Studio};
pub use judge::{Finding, judge, stages};
pub use mine::Mine;
pub use mistakes::MISTAKES;

use super::answer::{Verdict, deliver, lines};
use crate::cli::terminal::Display;
use crate::cli::{CheckOptions, ProgressChoice, check_outputs};
use crate::numbers::heat::HeatScale;
use crate::system::files::{make_directory, replace_file};
use anyhow::{Context, Result};
use image::{ImageFormat, RgbImage};
use serde_json::json;
use std::io;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

/// Checks a picture. Exit code 0 means right, 1 wrong, and 2 that it could not be checked.
pub fn run(options: &CheckOptions) -> Result<ExitCode> {
    options.out.iter().try_for_each(|directory| make_directory(directory))?;
    let files = options.pictures();
    check_outputs([options.picture.as_path()], files.iter().chain(&options.json).map(PathBuf::as_path))?;
    let mine = Mine::read(&options.picture)?;
    let mut display = Display::new(ProgressChoice::Auto, 1, "{wide_msg}", "", Duration::ZERO);
    let finding = judge(&mine, options.stage, |what| display.update(0, || what))?;
    display.clear();
    for (path, pixels) in files.iter().zip(pictures(&mine, &finding)) {
        let image = RgbImage::from_raw(mine.width, mine.height, pixels.into_iter().flatten().collect());
        let image = image.context("a picture has another size than its pixels")?;
        replace_file(path, |writer| image.write_to(writer, ImageFormat::Png).map_err(io::Error::other))?;
    }
    let text = text(&options.picture, &mine, &finding, &files);
    deliver(options.json.as_deref(), &text, 1, &figures(&options.picture, &mine, &finding, &files))?;
    Ok(finding.answer(&mine).verdict().exit_code())
}

/// The reader's picture, ours, and a heat map of the difference: 8-bit RGB, row by row from the top.
pub fn pictures(mine: &Mine, finding: &Finding) -> [Vec<[u8; 3]>; 3] {
    let right = &finding.right;
    let ours = right.hypothesis.written.bytes_of(&right.expected, [mine.width, mine.height]);
    let difference = mine.bytes.iter().zip(&ours).map(|(mine, ours)| {
        let square = |channel: usize| ((f64::from(mine[channel]) - f64::from(ours[channel])) / 255.0).powi(2);
        HeatScale::ERROR.colour(((square(0) + square(1) + square(2)) / 3.0).sqrt())
    });
    let difference = difference.collect();
    [mine.bytes.clone(), ours, difference]
}

/// The report for people; `files` lists the pictures written.
pub fn text(path: &Path, mine: &Mine, finding: &Finding, files: &[PathBuf]) -> String {
    let (stage, answer) = (finding.stage, finding.answer(mine));
    let picture = format!("{}, {}, {}x{}", path.display(), mine.format, mine.width, mine.height);
    let stage = format!("{}, section {}, {}", stage.id, stage.section, stage.section_title());
    let mut text = vec![("picture", picture), ("stage", stage), ("verdict", answer.title)];
    text.push(("", answer.explanation));
    text.extend(answer.evidence.into_iter().map(|line| ("seen", line)));
    text.extend(answer.remedy.map(|remedy| ("change", remedy)));
    if answer.kind == AnswerKind::Unknown {
        text.push(("note", "--stage names the section, and --out DIR shows where the two differ".to_owned()));
    }
    text.extend(answer.section.map(|section| ("read", format!("{}, {}", section.number, section.url))));
    text.extend(mine.notes.iter().map(|note| ("note", note.clone())));
    for damage in answer.damages {
        text.extend([("file", damage.title), ("change", damage.remedy.to_owned())]);
    }
    if !files.is_empty() {
        let files: Vec<String> = files.iter().map(|path| path.display().to_string()).collect();
        text.push(("files", files.join(", ")));
    }
    lines(text)
}

/// The report as JSON.
fn figures(path: &Path, mine: &Mine, finding: &Finding, files: &[PathBuf]) -> serde_json::Value {
    let mistake = finding.named().zip(finding.mistake.as_ref()).map(|(mistake, found)| {
        json!({
            "id": mistake.id,
            "section": mistake.section,
            "title": mistake.title,
            "remedy": mistake.remedy,
            "note": found.hypothesis.note,
            "explains_all": found.is_noise,
        })
    });
    json!({
        "picture": path.display().to_string(),
        "format": mine.format,
        "width": mine.width,
        "height": mine.height,
        "stage": finding.stage.id,
        "section": finding.stage.section,
        "is_right": finding.answer(mine).verdict() == Verdict::Same,
        "mistake": mistake,
        "damages": mine.damages,
        "files": files.iter().map(|path| path.display().to_string()).collect::<Vec<_>>(),
    })
}

#[cfg(test)]
mod tests;
