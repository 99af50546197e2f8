//! A case of the suite: a scene, what is stiff about it, and what it must give.

use super::far::with_far_spheres;
use crate::recipe::{Recipe, plain_name};
use std::fmt;

/// What the cases of a family have in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Family {
    /// The first part of its cases' ids.
    pub id: &'static str,
    /// What it tries, as a heading.
    pub title: &'static str,
    /// What it teaches, in a sentence or two.
    pub lesson: &'static str,
}

/// What a case must give, with the derivation in a sentence.
#[derive(Clone, Debug, PartialEq)]
pub enum Expected {
    /// Every sample has this radiance, linear RGB: a closed form without noise.
    Every {
        /// The radiance.
        value: [f64; 3],
        /// Why.
        why: &'static str,
    },
    /// The mean of the picture over pixels and channels: a closed form with noise.
    Mean {
        /// The mean.
        value: f64,
        /// Why.
        why: &'static str,
    },
    /// Sample for sample the picture of another scene, by the same backend.
    Same {
        /// The other scene.
        other: Box<Recipe>,
        /// Why.
        why: &'static str,
    },
    /// Sample for sample the picture of the `f64` reference.
    Reference {
        /// Why `f64` can be trusted here.
        why: &'static str,
    },
}

impl Expected {
    /// The derivation.
    pub fn why(&self) -> &'static str {
        match self {
            Expected::Every { why, .. }
            | Expected::Mean { why, .. }
            | Expected::Same { why, .. }
            | Expected::Reference { why } => why,
        }
    }
}

impl fmt::Display for Expected {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Expected::Every { value: [red, green, blue], .. } if red == green && green == blue => {
                write!(f, "{red}")
            }
            Expected::Every { value: [red, green, blue], .. } => write!(f, "{red} {green} {blue}"),
            Expected::Mean { value, .. } => write!(f, "{value} (mean)"),
            Expected::Same { other, .. } => write!(f, "as {}", other.name),
            Expected::Reference { .. } => f.write_str("as f64"),
        }
    }
}

/// How the window shows a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Watch {
    /// What the menu calls it.
    pub title: &'static str,
    /// What to watch, in a sentence or two.
    pub look_for: &'static str,
}

/// Size of the window's picture of a case, pixels.
const SHOWN_SIZE: [u32; 2] = [600, 400];

/// A case.
#[derive(Clone)]
pub struct Case {
    /// Family and what tells it from its siblings: `copies/110`.
    pub id: String,
    /// Its family.
    pub family: &'static Family,
    /// What is stiff about it, in a sentence.
    pub stiff: String,
    /// The picture, with its samples per pixel.
    pub recipe: Recipe,
    /// The length of what is near the eye, scene units; distant spheres stand a thousand of them away.
    pub unit: f64,
    /// What it must give.
    pub expected: Expected,
    /// What the mean may be off by besides noise, linear radiance.
    pub tolerance: f64,
    /// A scene of the same kind without what is stiff, to hold the time against.
    pub tame: Option<Recipe>,
    /// How the window shows it; `None` for what is no picture to look at.
    pub watch: Option<Watch>,
    /// Whether it is among the few that the tests run.
    pub is_quick: bool,
}

impl fmt::Debug for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Case").field("id", &self.id).finish_non_exhaustive()
    }
}

impl PartialEq for Case {
    fn eq(&self, other: &Self) -> bool {
        self.id == other.id
    }
}

impl Eq for Case {}

/// Spheres from which on every backend takes a hierarchy, so that distant ones change nothing.
const HIERARCHY_SPHERES: usize = 24;

/// Whether distant spheres stand around the scene, which switch the hierarchy on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// The scene as it is.
    Plain,
    /// With 40 distant spheres.
    WithFar,
}

impl Form {
    /// As the table calls it.
    pub fn name(self) -> &'static str {
        match self {
            Form::Plain => "plain",
            Form::WithFar => "+40",
        }
    }
}

impl Case {
    /// A case that expects what `f64` gives; the caller changes what differs.
    pub fn new(
        family: &'static Family,
        name: impl fmt::Display,
        stiff: impl Into<String>,
        recipe: Recipe,
    ) -> Self {
        let id = format!("{}/{name}", family.id);
        Case {
            recipe: Recipe { name: id.clone(), ..recipe },
            id,
            family,
            stiff: stiff.into(),
            unit: 1.0,
            expected: Expected::Reference { why: "f64 has digits to spare at these scales" },
            tolerance: 2e-6,
            tame: None,
            watch: None,
            is_quick: false,
        }
    }

    /// With another expectation.
    #[must_use]
    pub fn expect(self, expected: Expected, tolerance: f64) -> Self {
        Case { expected, tolerance, ..self }
    }

    /// Every sample is grey of this radiance.
    #[must_use]
    pub fn every(self, value: f64, why: &'static str) -> Self {
        self.expect(Expected::Every { value: [value; 3], why }, 1e-6)
    }

    /// The time is held against `tame`.
    #[must_use]
    pub fn beside(self, tame: Recipe) -> Self {
        Case { tame: Some(tame), ..self }
    }

    /// Shown in the window.
    #[must_use]
    pub fn watched(self, title: &'static str, look_for: &'static str) -> Self {
        Case { watch: Some(Watch { title, look_for }), ..self }
    }

    /// Run by the tests, too.
    #[must_use]
    pub fn quick(self) -> Self {
        Case { is_quick: true, ..self }
    }

    /// With the length of what is near the eye.
    #[must_use]
    pub fn of_unit(self, unit: f64) -> Self {
        Case { unit, ..self }
    }

    /// The picture in a size to look at, with a name that can be a file's.
    pub fn shown(&self) -> Recipe {
        let mut recipe = Recipe { name: plain_name(&self.id), samples_per_pixel: 256, ..self.recipe.clone() };
        [recipe.settings.width, recipe.settings.height] = SHOWN_SIZE;
        recipe
    }

    /// What menus call it: its id where it is not shown.
    pub fn title(&self) -> &str {
        self.watch.map_or(&self.id, |watch| watch.title)
    }

    /// The forms that it is rendered in.
    pub fn forms(&self) -> &'static [Form] {
        if self.recipe.scene.spheres.len() < HIERARCHY_SPHERES {
            &[Form::Plain, Form::WithFar]
        } else {
            &[Form::Plain]
        }
    }

    /// The picture in one of its forms.
    pub fn recipe_in(&self, form: Form) -> Recipe {
        match form {
            Form::Plain => self.recipe.clone(),
            Form::WithFar => with_far_spheres(&self.recipe, self.unit),
        }
    }
}
