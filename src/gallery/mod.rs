//! The figures: the book's stages as pictures with captions, alone or side by side. `weekender gallery` renders them.

mod figures;
mod fingerprint;
mod page;
mod program;
mod progress;
mod quality;
mod rendering;
mod still;

pub use fingerprint::{FingerprintError, Fingerprints};
pub use program::run;
pub use progress::StillProgress;
pub use quality::{Quality, is_about_pixels};
pub use rendering::{Event, Order, Outcome, Work, render};
pub use still::{INDEX, Still, Stills};

use crate::stages::Stage;
use crate::suggest::similar_names;
use std::fmt;
use thiserror::Error;

/// One or more pictures with a caption.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Figure {
    /// The identifier in pages and on the command line. It never changes.
    pub id: &'static str,
    /// The heading.
    pub title: &'static str,
    /// What the pictures show: one or two sentences.
    pub caption: &'static str,
    /// The pictures from left to right, at least one.
    pub panels: &'static [Panel],
}

/// One picture of a figure.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Panel {
    /// The stage that the picture shows.
    pub stage: &'static Stage,
    /// A few words that tell the picture from its neighbours.
    pub label: &'static str,
    /// The picture in words, for those who cannot see it.
    pub alt: &'static str,
}

impl Figure {
    /// All figures in the book's order. Every stage is in at least one of them.
    pub const ALL: &'static [Figure] = figures::FIGURES;

    /// Finds the figure with this id.
    ///
    /// # Errors
    /// [`UnknownFigure`], with similar ids.
    pub fn find(id: &str) -> Result<&'static Figure, UnknownFigure> {
        Self::ALL.iter().find(|figure| figure.id == id).ok_or_else(|| UnknownFigure {
            id: id.to_owned(),
            near: similar_names(id, Self::ALL.iter().map(|figure| figure.id)),
        })
    }

    /// The stage whose section of the book the figure belongs to: the latest of its stages.
    pub fn stage(&self) -> &'static Stage {
        let latest = self.panels.iter().map(|panel| panel.stage).max_by_key(|stage| stage.index());
        latest.unwrap_or(&Stage::ALL[0])
    }
}

impl fmt::Debug for Figure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let stages: Vec<&str> = self.panels.iter().map(|panel| panel.stage.id).collect();
        f.debug_struct("Figure").field("id", &self.id).field("stages", &stages).finish_non_exhaustive()
    }
}

/// No figure has this id.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("there is no figure {id:?}; {}", listed(near))]
pub struct UnknownFigure {
    /// The requested id.
    pub id: String,
    /// Similar ids, the most similar first.
    pub near: Vec<&'static str>,
}

/// The similar ids, or all ids if none is similar.
fn listed(near: &[&str]) -> String {
    let all: Vec<&str> = Figure::ALL.iter().map(|figure| figure.id).collect();
    match near {
        [] => format!("choose one of {}", all.join(", ")),
        near => format!("did you mean {}?", near.join(" or ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::describe::counted;
    use crate::stages::{DielectricLaws, Diffuse, SurfaceRule, Transfer};
    use std::collections::HashSet;

    #[test]
    fn every_stage_is_in_a_figure_and_ids_are_unique() {
        let shown: HashSet<&str> =
            Figure::ALL.iter().flat_map(|figure| figure.panels).map(|panel| panel.stage.id).collect();
        assert_eq!(shown, Stage::ALL.iter().map(|stage| stage.id).collect());
        let ids: HashSet<&str> = Figure::ALL.iter().map(|figure| figure.id).collect();
        assert_eq!(ids.len(), Figure::ALL.len());
    }

    #[test]
    fn figures_are_in_the_books_order() {
        assert!(Figure::ALL.is_sorted_by_key(|figure| figure.stage().index()));
    }

    #[test]
    fn every_figure_and_picture_has_its_words() {
        for figure in Figure::ALL {
            assert!(!figure.panels.is_empty(), "{}", figure.id);
            assert!((40..400).contains(&figure.caption.len()), "{}: {}", figure.id, figure.caption);
            let labels: HashSet<&str> = figure.panels.iter().map(|panel| panel.label).collect();
            assert_eq!(labels.len(), figure.panels.len(), "{}: {labels:?}", figure.id);
            for text in figure.panels.iter().map(|panel| panel.alt).chain([figure.caption]) {
                assert!(text.ends_with('.') && !text.contains("  "), "{}: {text}", figure.id);
            }
            assert!(!figure.title.is_empty() && !figure.title.ends_with('.'), "{}", figure.id);
        }
    }

    #[test]
    fn unknown_ids_are_answered_with_similar_ones() {
        let message = |id: &str| Figure::find(id).expect_err("unknown").to_string();
        assert_eq!(message("hollow-glas"), "there is no figure \"hollow-glas\"; did you mean hollow-glass?");
        assert!(message("quux-corge").ends_with(", defocus, book"), "{}", message("quux-corge"));
        assert_eq!(Figure::find("gamma").expect("a figure").stage().id, "lambertian-gamma");
    }

    #[test]
    fn labels_say_what_is_true_of_their_pictures() {
        let mut checked = 0;
        for panel in Figure::ALL.iter().flat_map(|figure| figure.panels) {
            let (label, setup) = (panel.label, &panel.stage.setup);
            let (camera, rules) = (&setup.camera, &setup.rules);
            let bounces = setup.max_depth - 1;
            let is_true = match label {
                "Pinhole" => camera.defocus_angle_degrees == 0.0,
                "With a lens" => camera.defocus_angle_degrees > 0.0,
                "Linear" => rules.transfer == Transfer::Linear,
                "With gamma" => rules.transfer == Transfer::Gamma2,
                "Uniform over the hemisphere" => rules.diffuse == Diffuse::Hemisphere,
                "Lambertian" => rules.diffuse == Diffuse::Lambertian,
                "Refraction only" => rules.dielectric == DielectricLaws::RefractOnly,
                "Total reflection" => rules.dielectric == DielectricLaws::TotalReflection,
                "Schlick's reflectance" => rules.dielectric == DielectricLaws::Schlick,
                "Every distance above 0 counts" => rules.surface == SurfaceRule::Acne,
                "Without acne" => rules.surface == SurfaceRule::Exact,
                "At most four bounces" => bounces == 4,
                "Two spheres" => (setup.scene)().spheres.len() == 2,
                words if words.ends_with(" bounces") => words == format!("At most {bounces} bounces"),
                words if words.ends_with(" spheres") => {
                    words == format!("{} spheres", (setup.scene)().spheres.len())
                }
                words if words.ends_with(" degrees") => words == format!("{} degrees", camera.vfov_degrees),
                words if words.ends_with(" per pixel") => {
                    words == format!("{} per pixel", counted(setup.samples_per_pixel, "sample"))
                }
                words if words.ends_with(" pixels") => {
                    words == format!("{} by {} pixels", setup.width, setup.height)
                }
                _ => continue,
            };
            assert!(is_true, "{}: {label}", panel.stage.id);
            checked += 1;
        }
        assert_eq!(checked, 23, "labels with a number or the name of a rule");
    }
}
