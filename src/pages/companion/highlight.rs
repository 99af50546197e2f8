//! Highlights code as HTML with classes, so that one style sheet serves light and dark.
//!
//! The syntax definitions are small and our own, because no collection has WGSL. Their scopes are the class names:
//! `hl-k` keyword, `hl-t` type, `hl-f` function, `hl-v` constant, `hl-n` number, `hl-s` string, `hl-c` comment, `hl-m`
//! macro or attribute.

use anyhow::{Context, Result, anyhow};
use maud::PreEscaped;
use syntect::easy::ScopeRegionIterator;
use syntect::html::{ClassStyle, ClassedHTMLGenerator};
use syntect::parsing::{
    ParseState, ScopeStack, SyntaxDefinition, SyntaxReference, SyntaxSet, SyntaxSetBuilder,
};

const SYNTAXES: [&str; 5] = [
    include_str!("../../../assets/companion/syntaxes/rust.sublime-syntax"),
    include_str!("../../../assets/companion/syntaxes/wgsl.sublime-syntax"),
    include_str!("../../../assets/companion/syntaxes/c.sublime-syntax"),
    include_str!("../../../assets/companion/syntaxes/python.sublime-syntax"),
    include_str!("../../../assets/companion/syntaxes/sh.sublime-syntax"),
];

/// What is not highlighted.
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
        let syntax = self.syntax(language)?;
        let mut html = ClassedHTMLGenerator::new_with_class_style(syntax, &self.0, ClassStyle::Spaced);
        for line in code.split_inclusive('\n') {
            html.parse_html_for_line_which_includes_newline(line).context("cannot colour code")?;
        }
        Ok(PreEscaped(html.finalize()))
    }

    /// The code in pieces, each with its class, for programs that have no HTML.
    pub fn pieces(&self, language: &str, code: &str) -> Result<Vec<(String, String)>> {
        let (mut state, mut stack) = (ParseState::new(self.syntax(language)?), ScopeStack::new());
        let mut pieces = Vec::new();
        for line in code.split_inclusive('\n') {
            let changes = state.parse_line(line, &self.0).context("cannot colour code")?;
            for (text, change) in ScopeRegionIterator::new(&changes, line) {
                stack.apply(change).context("cannot colour code")?;
                let class = stack.scopes.last().map(|scope| scope.build_string()).unwrap_or_default();
                pieces.push((text.to_owned(), class));
            }
        }
        Ok(pieces)
    }

    fn syntax(&self, language: &str) -> Result<&SyntaxReference> {
        self.0.find_syntax_by_token(language).ok_or_else(|| {
            let known: Vec<&str> = self.0.syntaxes().iter().map(|syntax| syntax.name.as_str()).collect();
            anyhow!("code in {language:?} has no colours; use text, {}", known.join(", "))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn highlighting_keeps_text() {
        for (language, code) in [
            ("rust", include_str!("../../render_cpu/sphere.rs")),
            ("wgsl", include_str!("../../../shaders/path.wgsl")),
            ("c", include_str!("../../../reference/rt_weekend.c")),
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
            let pieces = Highlighter::new().unwrap().pieces(language, code).unwrap();
            assert!(pieces.iter().any(|(_, class)| class == "hl-k"), "{language}");
            assert!(pieces.into_iter().map(|(text, _)| text).collect::<String>() == code, "{language}");
        }
    }
}
