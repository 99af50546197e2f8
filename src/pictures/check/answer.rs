//! The answer of a check, from which the text and the window's view are made.

use super::{Damage, Finding, Mine};
use crate::pictures::answer::Verdict;
use crate::stages::{Shading, Stage, book_url};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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
    /// The mistake, or what the check came to. Neither this nor the other texts end with a full stop.
    pub title: String,
    /// One sentence.
    pub explanation: String,
    /// What to change.
    pub remedy: Option<String>,
    /// Where the book explains what went wrong.
    pub section: Option<Section>,
    /// The stage that the picture shows.
    pub stage: Option<&'static Stage>,
    /// Figures and observations, one a line.
    pub evidence: Vec<String>,
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
    /// The section with this number, if a stage or a mistake has it.
    fn find(number: &'static str) -> Option<Section> {
        // Most sections are those of a stage; four of the mistakes belong to sections without a picture.
        let stage = match number {
            "3.1" => "ppm-gradient",
            "6.2" => "normals",
            "6.4" => "normals-world",
            "8.2" => "antialiased",
            _ => Stage::ALL.iter().find(|stage| stage.section == number)?.id,
        };
        Some(Section { number, url: book_url(number), stage: Stage::find(stage).ok()? })
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
            damages: Vec::new(),
        }
    }

    /// A right picture in a damaged file counts as different, because other programs cannot read it.
    pub fn verdict(&self) -> Verdict {
        if self.kind == AnswerKind::Right { Verdict::Same } else { Verdict::Different }
    }
}

impl Finding {
    pub fn answer(&self, mine: &Mine) -> Answer {
        let mut answer = Answer {
            kind: AnswerKind::Right,
            title: "It is right".to_owned(),
            explanation: "It differs from ours by noise only".to_owned(),
            remedy: None,
            section: None,
            stage: Some(self.stage),
            evidence: self.evidence(mine),
            damages: mine.damages.clone(),
        };
        if let (Some(found), Some(mistake)) = (&self.mistake, self.named()) {
            let title = capitalised(mistake.title);
            (answer.kind, answer.title, answer.explanation) = if found.is_noise {
                (AnswerKind::Mistake, title, "It is the only mistake; all else matches".to_owned())
            } else {
                let doubt = "It does not explain everything, so there may be a second mistake".to_owned();
                (AnswerKind::LikelyMistake, format!("{title}, most likely"), doubt)
            };
            answer.remedy = Some(capitalised(mistake.remedy));
            answer.section = Section::find(mistake.section);
        } else if !self.is_right() {
            answer.kind = AnswerKind::Unknown;
            answer.title = "Something differs, and none of the known mistakes explains it".to_owned();
            answer.explanation = "It may be a picture of another section".to_owned();
            let remedy = "Choose the section that your picture belongs to, and look where it differs; the final picture of \
                          section 14.1 cannot be checked: its small spheres are at random places";
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

    fn evidence(&self, mine: &Mine) -> Vec<String> {
        let percent = |share: f64| match 100.0 * share {
            percent if percent > 0.0 && percent < 1.0 => "less than 1 %".to_owned(),
            percent => format!("{percent:.0} %"),
        };
        let mut evidence = Vec::new();
        if let Some(note) = self.mistake.as_ref().and_then(|found| found.hypothesis.note.as_deref()) {
            evidence.push(capitalised(note));
        }
        if self.right.differing > 0.0 {
            let [column, row] = self.right.worst;
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
        if let Some(alike) = self.alike {
            let remedy = capitalised(alike.remedy);
            evidence.push(format!("Another mistake gives the same picture: {}. {remedy}", alike.title));
        }
        let is_gradient = self.stage.setup.rules.shading == Shading::ImageGradient;
        if self.is_right() && mine.width == mine.height && !is_gradient {
            let square = "The picture is square; if you wanted 16:9, divide 16.0 by 9.0, not 16 by 9";
            evidence.push(square.to_owned());
        }
        evidence
    }
}

fn capitalised(text: &str) -> String {
    let mut rest = text.chars();
    rest.next().map_or_else(String::new, |first| first.to_uppercase().chain(rest).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pictures::check::MISTAKES;

    #[test]
    fn mistakes_link_to_their_own_sections() {
        for mistake in MISTAKES {
            let section = Section::find(mistake.section).unwrap();
            assert_eq!(section.number, mistake.section);
            assert!(
                section.stage.section <= mistake.section || section.stage.section.len() < 4,
                "{section:?}"
            );
        }
        let section = |number| Section::find(number).unwrap();
        let gamma = Stage::find("lambertian-gamma").unwrap();
        assert_eq!(section("9.5"), Section { number: "9.5", url: gamma.url(), stage: gamma });
        assert!(section("3.1").url.ends_with("#thevec3class/colorutilityfunctions"));
    }
}
