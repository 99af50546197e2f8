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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::hypothesis::{Expected, Hypothesis};
    use crate::check::{Damage, Mistake};
    use crate::stages::Stage;

    fn mine([width, height]: [u32; 2], damages: Vec<Damage>) -> Mine {
        Mine { width, height, bytes: Vec::new(), format: "P3", damages }
    }

    /// What is said about a picture of the stage `id` that shows `mistake` or is right.
    fn told(id: &str, mine: &Mine, mistake: Option<(Mistake, bool)>) -> String {
        let stage = Stage::find(id).unwrap();
        let right = Compared {
            hypothesis: Hypothesis::right(&stage.recipe()),
            misfit: 0.0,
            is_noise: mistake.is_none(),
            expected: Expected { pixels: Vec::new() },
        };
        let mistake = mistake.map(|(mistake, is_noise)| Compared {
            hypothesis: Hypothesis::of(mistake, &stage.recipe()).remove(0),
            is_noise,
            ..right.clone()
        });
        text(Path::new("a.ppm"), mine, &Finding { stage, right, mistake }, &[])
    }

    #[test]
    fn a_damaged_file_is_told_with_what_to_change() {
        let damage = Damage { title: "it is torn".to_owned(), remedy: "mend it" };
        let told = told("metal", &mine([40, 20], vec![damage]), None);
        assert!(told.contains("\nfile     it is torn\nchange   mend it\n"), "{told}");
    }

    /// The first picture of the book is square.
    #[test]
    fn a_square_picture_is_remarked_on_unless_it_is_meant_to_be_square() {
        let gradient = Stage::ALL.iter().find(|stage| stage.setup.rules.shading == Shading::ImageGradient);
        let gradient = gradient.unwrap().id;
        for (id, size, is_remarked) in
            [("metal", [40, 40], true), ("metal", [40, 20], false), (gradient, [40, 40], false)]
        {
            let told = told(id, &mine(size, Vec::new()), None);
            assert!(told.contains("right: it differs from ours by noise only"), "{told}");
            assert_eq!(told.contains("\nnote     the picture is square"), is_remarked, "{told}");
        }
    }

    #[test]
    fn what_was_seen_of_a_mistake_is_told() {
        let told = told("metal", &mine([40, 20], Vec::new()), Some((Mistake::SwappedChannels, true)));
        assert!(told.contains("\nseen     the channels seem to be blue, green, red\n"), "{told}");
    }

    #[test]
    fn a_mistake_that_does_not_explain_all_may_not_be_the_only_one() {
        let mine = mine([40, 20], Vec::new());
        for explains_all in [true, false] {
            let told = told("metal", &mine, Some((Mistake::GammaTwice, explains_all)));
            let certainty = if explains_all { "a mistake: " } else { "most likely a mistake: " };
            assert!(told.contains(&format!("\nverdict  {certainty}gamma is applied twice\n")), "{told}");
            assert_eq!(told.contains("there may be a second mistake"), !explains_all, "{told}");
        }
    }

    #[test]
    fn a_right_picture_in_a_damaged_file_is_not_right_for_other_programs() {
        let stage = Stage::find("metal").unwrap();
        let right = Compared {
            hypothesis: Hypothesis::right(&stage.recipe()),
            misfit: 0.0,
            is_noise: true,
            expected: Expected { pixels: Vec::new() },
        };
        let finding = Finding { stage, right, mistake: None };
        let damage = Damage { title: "it is torn".to_owned(), remedy: "mend it" };
        for (damages, is_right) in [(Vec::new(), true), (vec![damage], false)] {
            let found = FindingJson::new(Path::new("a.ppm"), &mine([40, 20], damages), &finding, &[]);
            assert_eq!((found.is_right, found.damages.is_empty()), (is_right, is_right));
        }
    }

    #[test]
    fn other_programs_get_the_mistake_with_its_remedy_and_the_files() {
        let stage = Stage::find("metal").unwrap();
        let of = |mistake, is_noise| Compared {
            hypothesis: Hypothesis::of(mistake, &stage.recipe()).remove(0),
            misfit: 0.5,
            is_noise,
            expected: Expected { pixels: Vec::new() },
        };
        let right =
            Compared { hypothesis: Hypothesis::right(&stage.recipe()), ..of(Mistake::GammaTwice, false) };
        let files = ["d/mine.png", "d/ours.png"].map(PathBuf::from);
        for (mistake, explains_all, note) in [
            (Mistake::SwappedChannels, true, Some("the channels seem to be blue, green, red")),
            (Mistake::GammaTwice, false, None),
        ] {
            let finding = Finding { stage, right: right.clone(), mistake: Some(of(mistake, explains_all)) };
            let mine = mine([40, 20], Vec::new());
            let found = FindingJson::new(Path::new("a.ppm"), &mine, &finding, &files);
            let about = mistake.about();
            let expected = serde_json::json!({
                "schema": 1,
                "version": env!("CARGO_PKG_VERSION"),
                "picture": "a.ppm",
                "format": "P3",
                "width": 40,
                "height": 20,
                "stage": "metal",
                "section": stage.section,
                "is_right": false,
                "mistake": {
                    "id": about.id,
                    "title": about.title,
                    "remedy": about.remedy,
                    "note": note,
                    "explains_all": explains_all,
                },
                "damages": [],
                "files": ["d/mine.png", "d/ours.png"],
            });
            assert_eq!(serde_json::to_value(&found).unwrap(), expected);
            let told = text(Path::new("a.ppm"), &mine, &finding, &files);
            let last = format!("read     {}\nfiles    d/mine.png, d/ours.png\n", stage.url());
            assert!(told.ends_with(&last), "{told}");
        }
        // A picture that differs by more than noise is not right, even if no mistake explains it.
        let finding = Finding { stage, right, mistake: None };
        let found = FindingJson::new(Path::new("a.ppm"), &mine([40, 20], Vec::new()), &finding, &[]);
        assert!(!found.is_right && found.mistake.is_none() && found.files.is_empty());
        let told = text(Path::new("a.ppm"), &mine([40, 20], Vec::new()), &finding, &[]);
        assert!(told.contains("\nverdict  not right, but none of the known mistakes explains it;"), "{told}");
        assert!(told.contains("\nread     ") && !told.contains("\nfiles "), "{told}");
    }
}
