//! The glossary and the list of references.

use serde::Deserialize;

/// Where the terms are explained.
pub const GLOSSARY: &str = "docs/companion/glossary.toml";

/// Where the references are listed.
pub const REFERENCES: &str = "docs/companion/references.toml";

/// A term of the glossary.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Term {
    pub term: String,
    /// What it means, in Markdown.
    pub text: String,
    pub area: Area,
}

/// A part of the glossary.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub enum Area {
    /// Light, pictures and noise.
    Rendering,
    /// Lanes, threads and devices.
    Parallelism,
    /// How numbers are stored and rounded.
    Numbers,
}

/// A work that the text refers to.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Reference {
    pub title: String,
    pub authors: String,
    pub year: Option<u16>,
    pub url: Option<String>,
    /// Where it appeared, and what it is good for.
    pub note: Option<String>,
}
