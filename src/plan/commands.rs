//! The commands of a plan.

use super::manifest::{Plan, Work};
use crate::shell;
use std::borrow::Cow;

/// Makes the commands of a plan.
#[derive(Clone, Debug)]
pub struct Commands<'a> {
    /// How the commands call this program.
    pub program: &'a str,
    /// How they name the manifest.
    pub manifest: Cow<'a, str>,
    /// Flags of every part.
    pub flags: &'a [String],
}

impl<'a> Commands<'a> {
    /// The commands of `plan`, which name its manifest as `manifest`.
    pub fn new<W: Work>(program: &'a str, manifest: &'a str, plan: &'a Plan<W>) -> Self {
        Commands { program, manifest: shell::operand(manifest), flags: &plan.manifest.flags }
    }

    /// The words of the command that renders a part. `part` is its number, or what stands for it.
    pub fn part(&self, part: &str) -> Vec<String> {
        let words = [self.program, "render-part", &self.manifest, "--part", part];
        words.into_iter().map(str::to_owned).chain(self.flags.iter().cloned()).collect()
    }

    /// The words of the command that merges the parts into `out`.
    pub fn merge(&self, out: &str) -> Vec<String> {
        [self.program, "merge", &self.manifest, "--out", &shell::operand(out)].map(str::to_owned).to_vec()
    }

    /// The command line that renders a part.
    pub fn part_line(&self, part: usize) -> String {
        shell::line(self.part(&part.to_string()))
    }

    /// The same with a variable of the shell as the number.
    pub fn part_line_of(&self, variable: &str) -> String {
        // The variable must stay outside of the quotes that the other words may need.
        let words = self.part("\0");
        let word = |word: &String| {
            if word == "\0" { format!("\"${variable}\"") } else { shell::quoted(word).into_owned() }
        };
        words.iter().map(word).collect::<Vec<_>>().join(" ")
    }

    /// The command line that merges the parts into `out`.
    pub fn merge_line(&self, out: &str) -> String {
        shell::line(self.merge(out))
    }
}
