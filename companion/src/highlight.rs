//! Highlights code as HTML with classes, so that one style sheet serves light and dark.
//!
//! The syntax definitions are small and our own, because no collection has WGSL. Their scopes are the class names:
//! `hl-k` keyword, `hl-t` type, `hl-f` function, `hl-v` constant, `hl-n` number, `hl-s` string, `hl-c` comment, `hl-m`
//! macro or attribute.

use anyhow::{Context, Result};
use maud::PreEscaped;
use syntect::html::{ClassStyle, ClassedHTMLGenerator};
use syntect::parsing::{SyntaxDefinition, SyntaxSet, SyntaxSetBuilder};

const SYNTAXES: [&str; 5] = [
    include_str!("../assets/syntaxes/rust.sublime-syntax"),
    include_str!("../assets/syntaxes/wgsl.sublime-syntax"),
    include_str!("../assets/syntaxes/c.sublime-syntax"),
    include_str!("../assets/syntaxes/python.sublime-syntax"),
    include_str!("../assets/syntaxes/sh.sublime-syntax"),
];

/// Languages without highlighting.
const PLAIN: [&str; 2] = ["text", "toml"];

pub struct Highlighter(SyntaxSet);

impl Highlighter {
    /// Reads the syntax definitions.
    pub fn new() -> Result<Self> {
        let mut builder = SyntaxSetBuilder::new();
        for text in SYNTAXES {
            let read = SyntaxDefinition::load_from_str(text, true, None);
            builder.add(read.context("cannot read a syntax definition of the page")?);
        }
        Ok(Highlighter(builder.build()))
    }

    /// The code as HTML. `language` is a name or a file extension; an unknown one is an error.
    pub fn html(&self, language: &str, code: &str) -> Result<PreEscaped<String>> {
        if PLAIN.contains(&language) {
            return Ok(PreEscaped(maud::html! { (code) }.into_string()));
        }
        let syntax = self.0.find_syntax_by_token(language).with_context(|| {
            let known: Vec<&str> = self.0.syntaxes().iter().map(|syntax| syntax.name.as_str()).collect();
            format!("code in {language:?} has no colours; use text, {}", known.join(", "))
        })?;
        let mut html = ClassedHTMLGenerator::new_with_class_style(syntax, &self.0, ClassStyle::Spaced);
        for line in code.split_inclusive('\n') {
            html.parse_html_for_line_which_includes_newline(line).context("cannot colour code")?;
        }
        Ok(PreEscaped(html.finalize()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn highlighting_keeps_text() {
        for (language, code) in [
            ("rust", include_str!("../../src/render_cpu/sphere.rs")),
            ("wgsl", include_str!("../../shaders/path.wgsl")),
            ("c", include_str!("../../reference/rt_weekend.c")),
        ] {
            let html = Highlighter::new().unwrap().html(language, code).unwrap().into_string();
            assert!(html.contains("class=\"hl-k\""), "{language}");
            let mut text: String =
                html.split('<').map(|part| part.split_once('>').map_or(part, |(_, text)| text)).collect();
            for (name, c) in [("&lt;", "<"), ("&gt;", ">"), ("&quot;", "\""), ("&#39;", "'"), ("&amp;", "&")]
            {
                text = text.replace(name, c);
            }
            assert!(text == code, "{language}");
        }
    }
}
