//! The book's chapters as data: what each adds, what to look for, and its picture.
//!
//! A stage is not a second tracer, but a scene, a camera and the [`Rules`] in effect at that point of the book. Window,
//! command line, gallery and tests find all stages in [`Stage::ALL`].

mod rules;
mod table;

pub use rules::{BOOK_T_MIN, DielectricLaws, Diffuse, Rules, Shading, SurfaceRule, Transfer};

use crate::scene::{Camera, Scene};
use anyhow::{Result, bail};
use std::collections::BTreeMap;
use std::sync::LazyLock;

/// Web address of the book.
pub const BOOK_URL: &str = "https://raytracing.github.io/books/RayTracingInOneWeekend.html";

#[derive(Clone, Copy, Debug)]
pub struct Stage {
    /// Identifier on the command line, in the window and in files. It never changes.
    pub id: &'static str,
    /// Section of the book, such as "11.4".
    pub section: &'static str,
    /// Weekender's own heading.
    pub title: &'static str,
    /// What the tracer can do from this stage on.
    pub what_is_new: &'static str,
    /// Why it is needed, or why it is correct.
    pub why: &'static str,
    /// Where to look in the picture, and what to see there.
    pub look_for: &'static str,
    /// How the window shows it.
    pub sight: Sight,
    /// Description for those who cannot see the picture.
    pub alt: &'static str,
    /// The stage to compare with: the same scene, but another picture.
    pub pair: Option<&'static str>,
    pub setup: Setup,
}

#[derive(Clone, Copy, Debug)]
pub struct Setup {
    /// Always gives the same scene.
    pub scene: fn() -> Scene,
    pub camera: Camera,
    pub rules: Rules,
    pub width: u32,
    pub height: u32,
    pub samples_per_pixel: u64,
    /// Rays per path, including the camera ray.
    pub max_depth: u32,
    /// Whether the book has this picture. If not, it only serves for measuring.
    pub is_in_book: bool,
    /// Whether it is about single pixels, so that other sizes and numbers of samples would not show it.
    pub is_about_pixels: bool,
    /// Whether every program places its small spheres differently.
    pub has_random_spheres: bool,
}

/// How the window shows what to look for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sight {
    pub means: Means,
    /// The part of the picture that fills the window: left, top, right and bottom as shares of width and height, from
    /// the upper left. `None` is the whole picture.
    pub part: Option<[f64; 4]>,
    /// What to see there, in one or two short sentences.
    pub caption: &'static str,
}

/// The tool that makes it visible.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Means {
    Picture,
    Albedo,
    RaysPerPath,
    StandardError,
    /// Luminance in false colours, between these powers of two.
    Luminance([f64; 2]),
    /// A wipe against the stage's pair or, without one, the next stage. The divider stands at this share of the width.
    Wipe(f32),
}

impl Stage {
    /// All stages in the book's order. The last has every rule on.
    pub const ALL: &'static [Stage] = table::STAGES;

    /// Finds a stage by id, or by the number of its section, if that has only one stage.
    pub fn find(id: &str) -> Result<&'static Stage> {
        let with_id = Self::ALL.iter().find(|stage| stage.id == id);
        let of_section: Vec<&Stage> = Self::walk().filter(|stage| stage.section == id).collect();
        match (with_id, &of_section[..]) {
            (Some(stage), _) => Ok(stage),
            (None, [stage]) => Ok(stage),
            (None, []) => bail!("there is no stage {id:?}; --list shows all"),
            (None, several) => {
                let ids: Vec<&str> = several.iter().map(|stage| stage.id).collect();
                bail!("section {id} has several stages; choose one of {}", ids.join(", "))
            }
        }
    }

    /// The stages of the book, without the scene that only serves for measuring.
    pub fn walk() -> impl DoubleEndedIterator<Item = &'static Stage> {
        Self::ALL.iter().filter(|stage| stage.is_in_book())
    }

    pub fn is_in_book(&self) -> bool {
        self.setup.is_in_book
    }

    /// The next stage of the book.
    pub fn next(&self) -> Option<&'static Stage> {
        Self::walk().find(|stage| stage.index() > self.index())
    }

    /// The stage of the book before this one.
    pub fn previous(&self) -> Option<&'static Stage> {
        Self::walk().rev().find(|stage| stage.index() < self.index())
    }

    /// Index in [`Stage::ALL`].
    pub fn index(&self) -> usize {
        Self::ALL.iter().position(|stage| stage.id == self.id).unwrap_or(Self::ALL.len())
    }

    pub fn chapter(&self) -> &'static str {
        self.section.split('.').next().unwrap_or(self.section)
    }

    /// Width of the book's pictures since its first rays, pixels: 400, and 1200 in its last chapter.
    pub fn book_width(&self) -> u32 {
        if self.next().is_none() { 1200 } else { 400 }
    }

    pub fn section_title(&self) -> &'static str {
        heading(self.section).unwrap_or_default()
    }

    pub fn chapter_title(&self) -> &'static str {
        heading(self.chapter()).unwrap_or_default()
    }

    /// Web address of the stage's section.
    pub fn url(&self) -> String {
        book_url(self.section)
    }
}

/// The book's heading of a chapter or section, such as "6" or "6.1".
pub fn heading(number: &str) -> Option<&'static str> {
    static HEADINGS: LazyLock<BTreeMap<String, String>> =
        LazyLock::new(|| toml::from_str(include_str!("../../assets/book-headings.toml")).unwrap_or_default());
    HEADINGS.get(number).map(String::as_str)
}

/// Web address of a chapter or section.
pub fn book_url(number: &str) -> String {
    // The book's anchors are headings in lower case without spaces.
    let anchor = |number| heading(number).unwrap_or_default().replace(' ', "").to_lowercase();
    match number.split_once('.') {
        Some((chapter, _)) => format!("{BOOK_URL}#{}/{}", anchor(chapter), anchor(number)),
        None => format!("{BOOK_URL}#{}", anchor(number)),
    }
}

impl PartialEq for Stage {
    fn eq(&self, other: &Self) -> bool {
        self.id == other.id
    }
}

impl Eq for Stage {}
