//! The book's chapters as data: what each adds, what to look for, and the picture that shows it.
//!
//! A stage is no second tracer. It is a scene, a camera and the [`Rules`] in force at that point of the book;
//! the window, the command line, the gallery and the tests find all of them in [`Stage::ALL`].

mod rules;
mod table;

pub use rules::{BOOK_T_MIN, DielectricLaws, Diffuse, Rules, Shading, Surface, Transfer};

use crate::scene::{Camera, Scene};
use crate::suggest::{or_nearest, similar_names};
use std::fmt;
use thiserror::Error;

/// The book on the web.
pub const BOOK_URL: &str = "https://raytracing.github.io/books/RayTracingInOneWeekend.html";

/// One step of the book.
#[derive(Clone, Copy)]
pub struct Stage {
    /// What the command line, the window and files call it. Never changes.
    pub id: &'static str,
    /// Number of the book's section, such as "11.4".
    pub section: &'static str,
    /// Heading of the section in the book.
    pub section_title: &'static str,
    /// Heading of its chapter.
    pub chapter_title: &'static str,
    /// Our heading.
    pub title: &'static str,
    /// What the tracer can do now that it could not do before.
    pub what_is_new: &'static str,
    /// Why that is needed, or why it is right.
    pub why: &'static str,
    /// Where in the picture to look, and what is seen there.
    pub look_for: &'static str,
    /// The stage that a wipe compares this one with first.
    pub pair: Option<&'static str>,
    /// What the picture is made from.
    pub setup: Setup,
}

/// The scene of a stage and the numbers that it is rendered with.
#[derive(Clone, Copy)]
pub struct Setup {
    /// Makes the scene. The same every time.
    pub scene: fn() -> Scene,
    /// The camera.
    pub camera: Camera,
    /// The rules in force.
    pub rules: Rules,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Samples per pixel.
    pub samples_per_pixel: u64,
    /// Most rays of a path, the camera's included.
    pub max_depth: u32,
}

impl Stage {
    /// All of them, in the book's order. The last has every rule on.
    pub const ALL: &'static [Stage] = table::STAGES;

    /// The stage of this id.
    ///
    /// # Errors
    /// [`UnknownStage`] with those whose ids are like it.
    pub fn find(id: &str) -> Result<&'static Stage, UnknownStage> {
        Self::ALL.iter().find(|stage| stage.id == id).ok_or_else(|| UnknownStage {
            id: id.to_owned(),
            near: similar_names(id, Self::ALL.iter().map(|stage| stage.id)),
        })
    }

    /// The one after it in the book.
    pub fn next(&self) -> Option<&'static Stage> {
        Self::ALL.get(self.index() + 1)
    }

    /// The one before it in the book.
    pub fn previous(&self) -> Option<&'static Stage> {
        Self::ALL.get(self.index().checked_sub(1)?)
    }

    /// Its place in [`Stage::ALL`].
    pub fn index(&self) -> usize {
        Self::ALL.iter().position(|stage| stage.id == self.id).unwrap_or(Self::ALL.len())
    }

    /// Number of its chapter.
    pub fn chapter(&self) -> &'static str {
        self.section.split('.').next().unwrap_or(self.section)
    }

    /// Its section in the book on the web.
    pub fn url(&self) -> String {
        // The book's anchors are its headings without spaces and capitals.
        let anchor = |heading: &str| heading.replace(' ', "").to_lowercase();
        format!("{BOOK_URL}#{}/{}", anchor(self.chapter_title), anchor(self.section_title))
    }
}

impl fmt::Debug for Stage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Stage").field("id", &self.id).finish_non_exhaustive()
    }
}

impl PartialEq for Stage {
    fn eq(&self, other: &Self) -> bool {
        self.id == other.id
    }
}

impl Eq for Stage {}

/// No stage has this id.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("there is no stage {id:?}; {}", or_nearest(near))]
pub struct UnknownStage {
    /// What was asked for.
    pub id: String,
    /// Ids like it, the likeliest first.
    pub near: Vec<&'static str>,
}
