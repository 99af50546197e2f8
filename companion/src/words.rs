//! Words of the page: numbered captions, flags and apostrophes.

use crate::uses::Uses;
use maud::{Markup, html};

/// Whether a letter can be part of a name in code.
pub fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// The caption of a figure with the next number.
pub fn numbered(caption: &Markup, uses: &mut Uses) -> Markup {
    uses.numbered_figures += 1;
    html! { figcaption { span .figure-number { "Figure " (uses.numbered_figures) "." } " " (caption) } }
}

/// Code within a line, which does not break after the hyphens of a flag.
pub fn code_words(text: &str) -> Markup {
    html! {
        code {
            @for (place, word) in text.split(' ').enumerate() {
                @if place > 0 { " " }
                @if word.starts_with('-') { span .nb { (word) } } @else { (word) }
            }
        }
    }
}

/// Replaces apostrophes by typographic ones, and keeps a percent sign with its number.
pub fn typographic(text: &str) -> String {
    text.replace('\'', "’").replace(" %", "\u{a0}%")
}
