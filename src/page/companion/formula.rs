//! Converts LaTeX to MathML when the page is built, so that readers need neither scripts nor the network.

use anyhow::{Result, anyhow, bail};
use math_core::{LatexToMathML, MathCoreConfig, MathDisplay};
use maud::{Markup, PreEscaped};

pub struct Formulas(LatexToMathML);

impl Formulas {
    /// Never fails with the built-in settings.
    pub fn new() -> Result<Self> {
        let converter = LatexToMathML::new(MathCoreConfig::default());
        Ok(Formulas(converter.map_err(|error| anyhow!("cannot convert formulas: {error:?}"))?))
    }

    /// Converts a formula: inline or, if `is_block`, on a line of its own.
    pub fn convert(&self, latex: &str, is_block: bool) -> Result<Markup> {
        let display = if is_block { MathDisplay::Block } else { MathDisplay::Inline };
        match self.0.convert_with_local_state(latex.trim(), display) {
            Ok(converted) => Ok(PreEscaped(converted.mathml)),
            Err(error) => bail!("the formula {:?} is not understood: {error}", latex.trim()),
        }
    }
}
