//! Formulas: LaTeX becomes MathML when the page is built, so that no reader needs a script or the network for it.

use math_core::{LatexToMathML, MathCoreConfig, MathDisplay};
use maud::PreEscaped;

/// Converts formulas.
pub struct Formulas {
    converter: LatexToMathML,
}

impl Formulas {
    /// # Errors
    /// Never with the built-in settings.
    pub fn new() -> anyhow::Result<Self> {
        let converter = LatexToMathML::new(MathCoreConfig::default());
        Ok(Formulas {
            converter: converter.map_err(|error| anyhow::anyhow!("cannot convert formulas: {error:?}"))?,
        })
    }

    /// A formula in a line of text.
    ///
    /// # Errors
    /// If the LaTeX is not understood.
    pub fn inline(&self, latex: &str) -> Result<PreEscaped<String>, String> {
        self.convert(latex, MathDisplay::Inline)
    }

    /// A formula on a line of its own.
    ///
    /// # Errors
    /// If the LaTeX is not understood.
    pub fn block(&self, latex: &str) -> Result<PreEscaped<String>, String> {
        self.convert(latex, MathDisplay::Block)
    }

    fn convert(&self, latex: &str, display: MathDisplay) -> Result<PreEscaped<String>, String> {
        let converted = self.converter.convert_with_local_state(latex.trim(), display);
        converted
            .map(|converted| PreEscaped(converted.mathml))
            .map_err(|error| format!("the formula {:?} is not understood: {error}", latex.trim()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_become_mathml() {
        let formulas = Formulas::new().unwrap();
        let half = formulas.inline(r"\frac{1}{2}").unwrap().into_string();
        assert!(half.starts_with("<math>") && half.contains("<mfrac><mn>1</mn><mn>2</mn></mfrac>"), "{half}");
        assert!(formulas.block("x").unwrap().into_string().starts_with("<math display=\"block\""));
        let message = formulas.inline(r"\fraction{1}{2}").unwrap_err();
        assert!(message.contains("\\\\fraction"), "{message}");
    }
}
