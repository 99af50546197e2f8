//! The terms of the glossary, and the references.

use serde::Deserialize;

pub const GLOSSARY: &str = "docs/companion/glossary.toml";

pub const REFERENCES: &str = "docs/companion/references.toml";

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Term {
    pub term: String,
    /// Definition, in Markdown.
    pub text: String,
    pub area: Area,
}

#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum Area {
    /// Light, pictures and noise.
    Rendering,
    /// Lanes, threads and devices.
    Parallelism,
    /// How numbers are stored and rounded.
    Numbers,
    /// Words of Rust, WGSL and C++.
    Languages,
}

/// A work cited in the text.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Reference {
    pub title: String,
    pub authors: String,
    pub year: u16,
    pub url: String,
    /// Where it appeared, and what it is good for.
    pub note: String,
}
