//! The answer of a check, from which the text and the window's view are made.

use super::fit::Fit;
use super::hypothesis::{Added, Hypothesis};
use super::judge::with_added;
use super::tracer::{Steps, Tracer};
use super::written::Seen;
use super::{Damage, Finding, Mine};
use crate::comparison::answer::Verdict;
use crate::scene::{Scene, Sphere};
use crate::stages::{Shading, Stage, book_url, heading};
use serde::Serialize;
use std::collections::BTreeSet;

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

/// In JSON, the fields have the names of the lines of the text.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Answer {
    pub kind: AnswerKind,
    /// The mistake, or the outcome of the check. Neither this nor the other texts end with a full stop.
    #[serde(rename = "verdict")]
    pub title: String,
    /// One sentence.
    pub explanation: String,
    /// What to change.
    #[serde(rename = "change")]
    pub remedy: Option<String>,
    /// Where the book explains what went wrong.
    #[serde(rename = "read")]
    pub section: Option<Section>,
    /// The stage that the picture shows.
    #[serde(skip)]
    pub stage: Option<&'static Stage>,
    /// Figures and observations, one per line.
    #[serde(rename = "seen")]
    pub evidence: Vec<String>,
    /// Column and row of a few places where it differs from ours by more than noise, the worst first.
    pub places: Vec<[u32; 2]>,
    /// Further faults, of the file rather than the picture.
    pub damages: Vec<Damage>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Section {
    /// Such as "9.5".
    #[serde(rename = "section")]
    pub number: &'static str,
    pub url: String,
    /// The stage of this section, or the last one before it.
    #[serde(skip)]
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

    fn explain(&mut self, cause: &Cause) {
        self.remedy = Some(capitalised(&cause.remedy));
        self.section = Section::find(cause.section);
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

/// What a hypothesis does otherwise than the book.
struct Cause {
    title: String,
    remedy: String,
    section: &'static str,
}

impl Hypothesis {
    fn cause(&self) -> Option<Cause> {
        let words: Vec<&str> = self.numbers.iter().map(|number| number.words.as_str()).collect();
        if let Some(first) = self.numbers.first() {
            let codes =
                self.numbers.iter().map(|number| format!("`{}`", number.code)).collect::<BTreeSet<_>>();
            let codes: Vec<String> = codes.into_iter().collect();
            let remedy = format!("look at {}", codes.join(" and "));
            return Some(Cause { title: words.join("; "), remedy, section: first.section });
        }
        let row = self.named()?;
        Some(Cause { title: row.title.to_owned(), remedy: row.remedy.to_owned(), section: row.section })
    }

    /// The remarks of what is right all the same.
    fn harmless(&self) -> Vec<&'static str> {
        self.rows.iter().filter(|row| row.is_right).map(|row| row.title).collect()
    }
}

impl Finding {
    pub fn answer(&self, mine: &Mine) -> Answer {
        let mine = &Mine { ignored: self.ignored.clone(), ..mine.clone() };
        let right = &self.right;
        let mut answer = Answer {
            kind: AnswerKind::Right,
            title: "It is right".to_owned(),
            explanation: "It differs from ours by noise only".to_owned(),
            remedy: None,
            section: None,
            stage: Some(self.stage),
            evidence: self.evidence(mine),
            places: self.places(),
            damages: mine.damages.clone(),
        };
        if self.ignored.is_some() {
            answer.title = "It is right, as far as it can be checked".to_owned();
            answer.explanation =
                "The part that does not depend on the placement of the small spheres differs from ours by noise only; \
                 glass, fuzz and the lens hardly show there"
                    .to_owned();
        }
        let explains = self.found.as_ref().unwrap_or(right);
        match explains.hypothesis.cause() {
            Some(cause) if self.is_right() => {
                answer.title = "It is right for the book, though not the same as ours".to_owned();
                answer.explanation = capitalised(&right.hypothesis.harmless().join(", and "));
                answer.explain(&cause);
            }
            Some(cause) if self.is_sure => {
                answer.kind = AnswerKind::Mistake;
                answer.title = capitalised(&cause.title);
                answer.explanation = "With this in ours, the two differ by noise only".to_owned();
                let others = self.alike.iter().filter_map(Hypothesis::cause).map(|other| other.title);
                let others: Vec<String> = others.collect();
                if !others.is_empty() {
                    answer.kind = AnswerKind::LikelyMistake;
                    answer.title = format!("{}, or {}", answer.title, others.join(", or "));
                    answer.explanation = "Each of them produces this picture".to_owned();
                }
                answer.explain(&cause);
            }
            _ if self.is_too_little() => self.too_little(&mut answer),
            Some(cause) if self.found.is_some() => {
                answer.kind = AnswerKind::LikelyMistake;
                answer.title = format!("A guess: {}", cause.title);
                answer.explanation = "It explains most of what differs, but not all".to_owned();
                answer.explain(&cause);
            }
            _ if !self.is_sure => {
                answer.kind = AnswerKind::Unknown;
                answer.title = "Something differs, and none of the known mistakes explains it".to_owned();
                answer.explanation = format!("It was compared with section {}", self.stage.section);
            }
            _ if !answer.damages.is_empty() => {
                let damage = answer.damages.remove(0);
                answer.kind = AnswerKind::Mistake;
                answer.title = capitalised(&damage.title);
                answer.explanation =
                    "The picture itself is right: it differs from ours by noise only".to_owned();
                answer.remedy = Some(capitalised(damage.remedy));
                answer.section = Section::find("2.2");
            }
            _ => {}
        }
        answer
    }

    /// Whether the reader's noise is too strong for a verdict, or something has changed the picture.
    fn is_too_little(&self) -> bool {
        let is_noisy = self.samples().is_some_and(|samples| samples < SAMPLES_LEAST)
            && self.right.fit.excess < 10.0 * NEARLY_RIGHT;
        !self.is_sure && (is_noisy || self.altered.is_some() && self.right.fit.excess < NEARLY_RIGHT)
    }

    /// The answer if the noise does not allow a verdict.
    fn too_little(&self, answer: &mut Answer) {
        answer.kind = AnswerKind::CannotCheck;
        let likely = format!("It looks like section {}", self.stage.section);
        answer.explanation = match self.found.as_ref().and_then(|found| found.hypothesis.cause()) {
            _ if self.right.fit.excess < NEARLY_RIGHT => format!("{likely}, and no fault shows"),
            Some(cause) => format!("{likely}, perhaps with this mistake: {}", cause.title),
            None => format!("{likely}, but with differences that may be noise"),
        };
        let (title, remedy) = match self.altered {
            Some(_) => (
                "It looks right, but its noise is not that of a ray tracer",
                "Check the PPM or PNG that your program writes: JPEG, palettes, scaling and filters change it",
            ),
            None => (
                "It is too noisy to judge",
                "Render it with at least 10 samples per pixel; with 100, even small faults show",
            ),
        };
        (answer.title, answer.remedy) = (title.to_owned(), Some(remedy.to_owned()));
    }

    /// Places that tell most: the ball whose number is another, or where the pictures differ.
    fn places(&self) -> Vec<[u32; 2]> {
        let numbers = self.found.iter().flat_map(|found| &found.hypothesis.numbers);
        let scene = &self.right.hypothesis.recipe.scene;
        if let Some(sphere) = numbers.filter_map(|number| number.what.sphere(scene)).next()
            && let Some(place) = self.right.hypothesis.middle_of(&scene.spheres[sphere])
        {
            return vec![place];
        }
        // If most of it differs, no place is more telling than another.
        match self.right.fit.differing {
            share if share > 0.0 && share < 0.5 => apart(&self.right.fit.places),
            _ => Vec::new(),
        }
    }

    fn evidence(&self, mine: &Mine) -> Vec<String> {
        let percent = |share: f64| match 100.0 * share {
            percent if percent > 0.0 && percent < 1.0 => "less than 1 %".to_owned(),
            percent => format!("{percent:.0} %"),
        };
        let (mut evidence, right) = (Vec::new(), &self.right);
        let scene = &right.hypothesis.recipe.scene;
        let spheres = right.hypothesis.spheres();
        if let ([[column, row], ..], Some(_)) = (right.fit.places.as_slice(), self.not_right()) {
            let names = right.fit.places.iter().map(|[x, y]| spheres[(y * mine.width + x) as usize]);
            evidence.push(format!(
                "It differs in {} of the blocks of 8 x 8 pixels, most around column {column}, row {row}: {}",
                percent(right.fit.differing),
                shares(names.map(|sphere| name_of(scene, sphere)))
            ));
        }
        let found = self.found.iter();
        evidence.extend(found.clone().filter_map(|found| found.hypothesis.note.as_deref()).map(capitalised));
        for number in found.clone().flat_map(|found| &found.hypothesis.numbers) {
            let deviation = number.deviation.max(0.001);
            evidence.push(format!("The number is {:.3}, with a deviation of {deviation:.3}", number.value));
        }
        for cause in self.alike.iter().filter_map(Hypothesis::cause) {
            evidence.push(format!("Or {}: {}", cause.title, cause.remedy));
        }
        if self.found.is_some() && !right.hypothesis.rows.is_empty() {
            evidence.push(format!("Not wrong: {}", right.hypothesis.harmless().join(", and ")));
        }
        if !self.is_sure && self.found.is_none() {
            evidence.extend(self.brightness(mine));
        }
        if let Some(samples) = self.samples().filter(|_| self.is_sure || self.is_too_little()) {
            evidence.push(format!("Its noise is that of about {samples:.0} samples per pixel"));
        }
        if let Some(ignored) = &self.ignored {
            let compared = ignored.iter().filter(|is_ignored| !**is_ignored).count() as f64;
            let shown = spheres.iter().zip(ignored.iter()).filter(|(_, is_ignored)| !**is_ignored);
            evidence.push(format!(
                "{} of the pixels were compared: {}; the others depend on the placement of the small spheres",
                percent(compared / ignored.len() as f64),
                shares(shown.map(|(sphere, _)| name_of(scene, *sphere)))
            ));
        }
        if let Some(altered) = self.altered.filter(|_| !self.is_right()) {
            evidence.push(format!("The file may have been changed since it was written: {altered}"));
        }
        let is_gradient = self.stage.setup.rules.shading == Shading::ImageGradient;
        if self.is_right() && mine.width == mine.height && !is_gradient {
            let square = "The picture is square; if you wanted 16:9, divide 16.0 by 9.0, not 16 by 9";
            evidence.push(square.to_owned());
        }
        evidence
    }

    fn not_right(&self) -> Option<&Finding> {
        (!self.is_right()).then_some(self)
    }

    /// How bright the picture is, if that explains a part.
    fn brightness(&self, mine: &Mine) -> Option<String> {
        let seen = Seen::of(mine, &self.right.hypothesis.written, |_, _| 0.0);
        let written = &self.right.hypothesis.written;
        let (rendered, note) = with_added(&seen, written, self.right.rendered.clone(), Added::Gain);
        let fit = Fit::new(&seen, written, &rendered);
        note.filter(|_| fit.excess < 0.8 * self.right.fit.excess).map(|note| capitalised(&note))
    }
}

/// Samples per pixel below which noise hides faults.
const SAMPLES_LEAST: f64 = 8.0;

/// Mean square of the blocks' means, in bytes, below which no fault can be seen.
const NEARLY_RIGHT: f64 = 4.0;

impl Hypothesis {
    /// The sphere that each pixel shows; `None` for the sky.
    fn spheres(&self) -> Vec<Option<&Sphere>> {
        Tracer::new(&self.recipe, Steps::OF_THE_BOOK, &self.viewport, 1).spheres()
    }

    /// The middle of the pixels that show a sphere.
    fn middle_of(&self, sphere: &Sphere) -> Option<[u32; 2]> {
        let [width, _] = self.size();
        let shown = self
            .spheres()
            .into_iter()
            .enumerate()
            .filter(|(_, it)| it.is_some_and(|it| it.center == sphere.center));
        let (mut sum, mut count) = ([0, 0], 0);
        for (pixel, _) in shown {
            sum[0] += pixel as u32 % width;
            sum[1] += pixel as u32 / width;
            count += 1;
        }
        (count > 0).then(|| sum.map(|sum| sum / count))
    }
}

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
