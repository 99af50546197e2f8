//! The answer of a check, from which the text and the window's view are made.

use super::hypothesis::{Compared, Fit, Hypothesis, compare};
use super::tracer::{Steps, Tracer};
use super::written::Seen;
use super::{Damage, Finding, Mine, Mistake};
use crate::comparison::answer::Verdict;
use crate::scene::{Scene, Sphere};
use crate::stages::{Shading, Stage, book_url, heading};
use serde::Serialize;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum AnswerKind {
    Right,
    /// A mistake that explains all differences.
    Mistake,
    /// A mistake that explains most of them.
    LikelyMistake,
    /// None of the known mistakes.
    Unknown,
    CannotCheck,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    pub kind: AnswerKind,
    /// The mistake, or the outcome of the check. Neither this nor the other texts end with a full stop.
    pub title: String,
    /// One sentence.
    pub explanation: String,
    /// What to change.
    pub remedy: Option<String>,
    /// Where the book explains what went wrong.
    pub section: Option<Section>,
    /// The stage that the picture shows.
    pub stage: Option<&'static Stage>,
    /// Figures and observations, one per line.
    pub evidence: Vec<String>,
    /// Column and row of a few places where it differs from ours by more than noise, the worst first.
    pub places: Vec<[u32; 2]>,
    /// Further faults, of the file rather than the picture.
    pub damages: Vec<Damage>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// Such as "9.5".
    pub number: &'static str,
    pub url: String,
    /// The stage of this section, or the last one before it.
    pub stage: &'static Stage,
}

impl Section {
    /// The section with this number, if the book has it.
    fn find(number: &'static str) -> Option<Section> {
        let place = |section: &str| {
            let (chapter, rest) = section.split_once('.')?;
            Some((chapter.parse::<u32>().ok()?, rest.parse::<u32>().ok()?))
        };
        heading(number)?;
        let own = Stage::walk().filter(|stage| stage.section == number);
        // Of several, the first that shows what the section adds, and not only what was there before.
        let own = own.rev().max_by_key(|stage| stage.setup.samples_per_pixel > 1);
        let before = || Stage::walk().rev().find(|stage| place(stage.section) < place(number));
        Some(Section { number, url: book_url(number), stage: own.or_else(before)? })
    }
}

impl Answer {
    /// The answer for a picture that cannot be read or compared.
    pub fn cannot_check(reason: &anyhow::Error) -> Answer {
        Answer {
            kind: AnswerKind::CannotCheck,
            title: "This picture cannot be checked".to_owned(),
            explanation: capitalised(&format!("{reason:#}")),
            remedy: None,
            section: None,
            stage: None,
            evidence: Vec::new(),
            places: Vec::new(),
            damages: Vec::new(),
        }
    }

    fn explain(&mut self, mistake: &Mistake) {
        self.remedy = Some(capitalised(mistake.remedy));
        self.section = Section::find(mistake.section);
    }

    /// A right picture in a damaged file counts as different, because other programs cannot read it.
    pub fn verdict(&self) -> Verdict {
        match self.kind {
            AnswerKind::Right => Verdict::Same,
            AnswerKind::CannotCheck => Verdict::Unclear,
            AnswerKind::Mistake | AnswerKind::LikelyMistake | AnswerKind::Unknown => Verdict::Different,
        }
    }
}

impl Finding {
    pub fn answer(&self, mine: &Mine) -> Answer {
        let mine = &Mine { ignored: self.ignored.clone(), ..mine.clone() };
        let mut answer = Answer {
            kind: AnswerKind::Right,
            title: "It is right".to_owned(),
            explanation: "It differs from ours by noise only".to_owned(),
            remedy: None,
            section: None,
            stage: Some(self.stage),
            evidence: self.evidence(mine),
            // If most of it differs, no place is more telling than another.
            places: match self.right.differing {
                share if share > 0.0 && share < 0.5 => apart(&self.right.places),
                _ => Vec::new(),
            },
            damages: mine.damages.clone(),
        };
        if self.ignored.is_some() {
            answer.title = "It is right, as far as it can be checked".to_owned();
            answer.explanation =
                "The part that does not depend on the placement of the small spheres differs from ours by noise only; \
                 glass, fuzz and the lens hardly show there"
                    .to_owned();
        }
        if let Some(mistake) = self.named().filter(|_| self.is_other_right()) {
            answer.title = "It is right for the book, though not the same as ours".to_owned();
            answer.explanation = capitalised(mistake.title);
            answer.explain(mistake);
        } else if let Some(mistake) = self.named().filter(|_| self.is_sure) {
            answer.kind = AnswerKind::Mistake;
            answer.title = capitalised(mistake.title);
            answer.explanation = match self.alike.as_slice() {
                [] => "With this mistake built into ours, the two differ by noise only".to_owned(),
                [other, ..] => {
                    answer.kind = AnswerKind::LikelyMistake;
                    answer.title = format!("{}, or {}", answer.title, other.title);
                    "Each of them produces this picture".to_owned()
                }
            };
            answer.explain(mistake);
        } else if self.is_too_little() {
            self.too_little(&mut answer);
        } else if let Some(mistake) = self.named() {
            answer.kind = AnswerKind::LikelyMistake;
            answer.title = format!("A guess: {}", mistake.title);
            answer.explanation =
                "It is the closest of the known mistakes, but does not explain everything".to_owned();
            answer.explain(mistake);
        } else if !self.is_sure {
            answer.kind = AnswerKind::Unknown;
            answer.title = "Something differs, and none of the known mistakes explains it".to_owned();
            answer.explanation = "It may be a picture of another section".to_owned();
            let remedy = "Choose the section that your picture belongs to, and look where it differs";
            answer.remedy = Some(remedy.to_owned());
        } else if !answer.damages.is_empty() {
            let damage = answer.damages.remove(0);
            answer.kind = AnswerKind::Mistake;
            answer.title = capitalised(&damage.title);
            answer.explanation = "The picture itself is right: it differs from ours by noise only".to_owned();
            answer.remedy = Some(capitalised(damage.remedy));
            answer.section = Section::find("2.2");
        }
        answer
    }

    /// The answer if the noise does not allow a verdict.
    fn too_little(&self, answer: &mut Answer) {
        answer.kind = AnswerKind::CannotCheck;
        let (title, remedy) = match self.grain.and_then(|grain| grain.altered) {
            Some(altered) => (
                format!("This file did not come straight from a ray tracer: {altered}"),
                "Check the PPM or PNG that your program writes: JPEG, palettes, scaling and filters change it",
            ),
            None => (
                "It is too noisy to judge".to_owned(),
                "Render it with at least 10 samples per pixel; with 100, even small faults show",
            ),
        };
        (answer.title, answer.remedy) = (title, Some(remedy.to_owned()));
        let likely = format!("It looks like section {}", self.stage.section);
        answer.explanation = match self.named() {
            _ if self.right.misfit < NEARLY_RIGHT => format!("{likely}, and no fault shows"),
            Some(mistake) => format!("{likely}, perhaps with this mistake: {}", mistake.title),
            None => format!("{likely}, but with differences that may be noise"),
        };
    }

    fn evidence(&self, mine: &Mine) -> Vec<String> {
        let percent = |share: f64| match 100.0 * share {
            percent if percent > 0.0 && percent < 1.0 => "less than 1 %".to_owned(),
            percent => format!("{percent:.0} %"),
        };
        let mut evidence = Vec::new();
        if let Some(ignored) = &self.ignored {
            let compared = ignored.iter().filter(|is_ignored| !**is_ignored).count() as f64;
            let spheres = Tracer::new(&self.right.hypothesis.recipe, Steps::OF_THE_BOOK, 1).spheres();
            let shown = spheres.iter().zip(ignored.iter()).filter(|(_, is_ignored)| !**is_ignored);
            let scene = &self.right.hypothesis.recipe.scene;
            evidence.push(format!(
                "{} of the pixels were compared: {}; the others depend on the placement of the small spheres",
                percent(compared / ignored.len() as f64),
                shares(shown.map(|(sphere, _)| name_of(scene, *sphere)))
            ));
        }
        if let Some(note) = self.mistake.as_ref().and_then(|found| found.hypothesis.note.as_deref()) {
            evidence.push(capitalised(note));
        }
        if let ([[column, row], ..], true) = (self.right.places.as_slice(), self.right.differing > 0.0) {
            evidence.push(format!(
                "They differ in {} of the blocks of 8 x 8 pixels, most around column {column}, row {row}",
                percent(self.right.differing)
            ));
        }
        match &self.mistake {
            Some(_) if self.right.differing == 0.0 => {
                evidence
                    .push("The means of blocks hardly differ; the mistake shows pixel by pixel".to_owned());
            }
            Some(found) if found.differing < self.right.differing => evidence.push(format!(
                "With the mistake built into ours, they differ in {}",
                percent(found.differing)
            )),
            _ => {}
        }
        for alike in &self.alike {
            let remedy = capitalised(alike.remedy);
            evidence.push(format!("Another mistake gives the same picture: {}. {remedy}", alike.title));
        }
        if !self.is_sure {
            evidence.extend(measured(&self.right, mine));
        }
        if let Some(grain) =
            self.grain.filter(|grain| grain.altered.is_none() && (1.0..5000.0).contains(&grain.samples))
        {
            evidence.push(format!("Its noise matches about {:.0} samples per pixel", grain.samples));
        }
        let is_gradient = self.stage.setup.rules.shading == Shading::ImageGradient;
        if self.is_right() && mine.width == mine.height && !is_gradient {
            let square = "The picture is square; if you wanted 16:9, divide 16.0 by 9.0, not 16 by 9";
            evidence.push(square.to_owned());
        }
        evidence
    }
}

/// Mean squared error of display values below which no fault can be seen.
const NEARLY_RIGHT: f64 = 1.5e-4;

/// The first places that are not next to each other.
fn apart(places: &[[u32; 2]]) -> Vec<[u32; 2]> {
    const MOST: usize = 5;
    const DISTANCE: u32 = 24;
    let mut chosen: Vec<[u32; 2]> = Vec::new();
    for [x, y] in places {
        let is_near = |[a, b]: &[u32; 2]| a.abs_diff(*x).max(b.abs_diff(*y)) < DISTANCE;
        if chosen.len() < MOST && !chosen.iter().any(is_near) {
            chosen.push([*x, *y]);
        }
    }
    chosen
}

/// Measurements of a picture that no mistake explains: brightness, and where it differs.
fn measured(right: &Compared, mine: &Mine) -> Vec<String> {
    let seen = Seen::of(mine, &right.hypothesis.written, |_, _| 0.0);
    let mut measured = Vec::new();
    let gain = Hypothesis { fit: Some(Fit::Gain), ..right.hypothesis.clone() };
    let brighter = compare(&seen, gain, right.rendered.clone());
    if brighter.misfit < 0.8 * right.misfit {
        measured.extend(brighter.hypothesis.note);
    }
    let tracer = Tracer::new(&right.hypothesis.recipe, Steps::OF_THE_BOOK, 1);
    let spheres = tracer.spheres();
    if right.differing > 0.0 {
        let sphere = |[x, y]: &[u32; 2]| spheres[(y * mine.width + x) as usize];
        let names = right.places.iter().map(|place| name_of(&right.hypothesis.recipe.scene, sphere(place)));
        measured.push(format!("blocks that differ show: {}", shares(names)));
    }
    measured.into_iter().map(|line| capitalised(&line)).collect()
}

/// The material of a sphere, or the sky.
fn name_of(scene: &Scene, sphere: Option<&Sphere>) -> String {
    sphere.map_or_else(|| "sky".to_owned(), |sphere| scene.materials[sphere.material].name.clone())
}

/// How often each name occurs, in per cent, the most frequent first.
fn shares(names: impl Iterator<Item = String>) -> String {
    let mut counts: Vec<(String, usize)> = Vec::new();
    for name in names {
        match counts.iter_mut().find(|(known, _)| *known == name) {
            Some((_, count)) => *count += 1,
            None => counts.push((name, 1)),
        }
    }
    counts.sort_by(|(_, a), (_, b)| b.cmp(a));
    let all: usize = counts.iter().map(|(_, count)| count).sum();
    let named = counts.iter().filter(|(_, count)| 50 * count >= all);
    let names: Vec<String> =
        named.map(|(name, count)| format!("{name} ({:.0} %)", 100.0 * *count as f64 / all as f64)).collect();
    names.join(", ")
}

fn capitalised(text: &str) -> String {
    let mut rest = text.chars();
    rest.next().map_or_else(String::new, |first| first.to_uppercase().chain(rest).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::comparison::check::MISTAKES;

    #[test]
    fn mistakes_link_to_their_own_sections() {
        for mistake in MISTAKES {
            let section = Section::find(mistake.section).unwrap();
            assert_eq!(section.number, mistake.section);
            let chapter =
                |section: &str| section.split('.').next().map(|chapter| chapter.parse::<u32>().unwrap());
            assert!(chapter(section.stage.section) <= chapter(mistake.section), "{section:?}");
        }
        let section = |number| Section::find(number).unwrap();
        let gamma = Stage::find("lambertian-gamma").unwrap();
        assert_eq!(section("9.5"), Section { number: "9.5", url: gamma.url(), stage: gamma });
        assert_eq!(section("8.2").stage.id, "antialiased");
        assert!(section("3.1").url.ends_with("#thevec3class/colorutilityfunctions"));
    }
}
