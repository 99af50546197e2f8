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
    /// A part of the glossary, with a heading there.
    pub area: String,
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
