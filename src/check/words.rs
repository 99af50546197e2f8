//! The finding as text and as JSON.

use super::compared::Compared;
use super::judge::Finding;
use super::picture::Mine;
use crate::stages::Shading;
use serde::Serialize;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Version of the JSON. It grows when a key changes its meaning or is removed.
const SCHEMA: u32 = 1;

/// The finding for other programs.
#[derive(Serialize)]
pub struct FindingJson {
    schema: u32,
    version: &'static str,
    picture: PathBuf,
    format: &'static str,
    width: u32,
    height: u32,
    stage: &'static str,
    section: &'static str,
    is_right: bool,
    /// The likeliest mistake; `None` if the picture is right or nothing explains it.
    mistake: Option<MistakeJson>,
    damages: Vec<DamageJson>,
    files: Vec<PathBuf>,
}

#[derive(Serialize)]
struct MistakeJson {
    id: &'static str,
    title: &'static str,
    remedy: &'static str,
    note: Option<String>,
    explains_all: bool,
}

#[derive(Serialize)]
struct DamageJson {
    title: String,
    remedy: &'static str,
}

impl FindingJson {
    /// The finding about the picture in `path`; `files` were written.
    pub fn new(path: &Path, mine: &Mine, finding: &Finding, files: &[PathBuf]) -> Self {
        let mistake = finding.mistake.as_ref().and_then(|found| {
            let about = found.hypothesis.mistake?.about();
            Some(MistakeJson {
                id: about.id,
                title: about.title,
                remedy: about.remedy,
                note: found.hypothesis.note.clone(),
                explains_all: found.is_noise,
            })
        });
        let damages = mine.damages.iter();
        FindingJson {
            schema: SCHEMA,
            version: env!("CARGO_PKG_VERSION"),
            picture: path.to_owned(),
            format: mine.format,
            width: mine.width,
            height: mine.height,
            stage: finding.stage.id,
            section: finding.stage.section,
            is_right: finding.is_right() && mine.damages.is_empty(),
            mistake,
            damages: damages
                .map(|damage| DamageJson { title: damage.title.clone(), remedy: damage.remedy })
                .collect(),
            files: files.to_vec(),
        }
    }
}

/// The finding for people.
pub fn text(path: &Path, mine: &Mine, finding: &Finding, files: &[PathBuf]) -> String {
    let stage = finding.stage;
    let mut lines = vec![
        ("picture", format!("{}, {}, {}x{}", path.display(), mine.format, mine.width, mine.height)),
        ("stage", format!("{}, section {}, {}", stage.id, stage.section, stage.section_title)),
    ];
    for damage in &mine.damages {
        lines.push(("file", damage.title.clone()));
        lines.push(("change", damage.remedy.to_owned()));
    }
    match &finding.mistake {
        None if finding.is_right() => {
            lines.push(("verdict", "right: it differs from ours by noise only".to_owned()));
            if mine.width == mine.height && stage.setup.rules.shading != Shading::ImageGradient {
                let note = "the picture is square; if you wanted 16:9, divide 16.0 by 9.0, not 16 by 9";
                lines.push(("note", note.to_owned()));
            }
        }
        None => {
            let verdict = "not right, but none of the known mistakes explains it; name the stage with --stage if it is \
                           another one, and see with --out DIR where it differs (the final picture of section 14.1 \
                           cannot be checked: its small spheres are random)";
            lines.push(("verdict", verdict.to_owned()));
        }
        Some(found) => lines.extend(of_mistake(found)),
    }
    if !finding.is_right() {
        lines.push(("read", stage.url()));
    }
    if !files.is_empty() {
        let files: Vec<String> = files.iter().map(|path| path.display().to_string()).collect();
        lines.push(("files", files.join(", ")));
    }
    lines.iter().fold(String::new(), |mut text, (name, words)| {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{name:<8} {words}");
        text
    })
}

fn of_mistake(found: &Compared) -> Vec<(&'static str, String)> {
    let Some(about) = found.hypothesis.mistake.map(super::Mistake::about) else { return Vec::new() };
    let certainty = if found.is_noise { "a mistake" } else { "most likely a mistake" };
    let mut lines = vec![("verdict", format!("{certainty}: {}", about.title))];
    if let Some(note) = &found.hypothesis.note {
        lines.push(("seen", note.clone()));
    }
    lines.push(("change", about.remedy.to_owned()));
    if !found.is_noise {
        lines.push(("note", "it does not explain everything, so there may be a second mistake".to_owned()));
    }
    lines
}
