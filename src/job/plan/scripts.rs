//! The commands of a plan, and the files that give its parts to Slurm, GNU parallel or make. These are written beside the
//! manifest and name it without a directory, so the directory can be moved.

use super::manifest::{MANIFEST, Manifest};
use crate::system::shell::{Shell, operand};

/// What `weekender plan` makes besides the plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Format {
    /// The commands on standard output, one per line
    Text,
    /// A Slurm job array
    Slurm,
    /// A script for GNU parallel
    Parallel,
    /// A makefile
    Make,
}

impl Format {
    /// The scripts with their texts, which contain `@KEYS@` to fill in. The one to start comes first.
    fn templates(self) -> &'static [(&'static str, &'static str)] {
        match self {
            Format::Text => &[],
            Format::Slurm => &[
                ("submit.sh", include_str!("../../../assets/plan/submit.sh")),
                ("parts.sbatch", include_str!("../../../assets/plan/parts.sbatch")),
                ("merge.sbatch", include_str!("../../../assets/plan/merge.sbatch")),
            ],
            Format::Parallel => &[("run.sh", include_str!("../../../assets/plan/run.sh"))],
            Format::Make => &[("Makefile", include_str!("../../../assets/plan/Makefile"))],
        }
    }
}

/// Builds the commands of a plan.
#[derive(Clone, Debug)]
pub struct Commands<'a> {
    /// How they call this program.
    program: &'a str,
    /// How they name the manifest.
    manifest: String,
    /// Flags of every part.
    flags: &'a [String],
}

impl<'a> Commands<'a> {
    /// Commands that name the manifest as `path`.
    pub fn new(program: &'a str, path: &str, manifest: &'a Manifest) -> Self {
        Commands { program, manifest: operand(path).into_owned(), flags: &manifest.flags }
    }

    /// The command line that renders a part. `part` is its number, or its placeholder in a script.
    pub fn part(&self, shell: Shell, part: &str) -> String {
        let before = shell.line([self.program, "render-part", &self.manifest, "--part"]);
        let flags = self.flags.iter().map(|flag| format!(" {}", shell.quoted(flag)));
        format!("{before} {part}{}", flags.collect::<String>())
    }

    /// The command line that merges the parts into `out`.
    pub fn merge(&self, shell: Shell, out: &str) -> String {
        shell.line([self.program, "merge", &self.manifest, "--out", &operand(out)])
    }
}

/// The scripts of a plan, with their names; the one to start comes first.
pub fn scripts(format: Format, manifest: &Manifest, program: &str) -> Vec<(&'static str, String)> {
    let commands = Commands::new(program, MANIFEST, manifest);
    let count = manifest.parts.len();
    let merge = commands.merge(Shell::Posix, &manifest.result);
    let [part, merge] = match format {
        Format::Parallel => [Shell::Posix.quoted(&commands.part(Shell::Posix, "{}")).into_owned(), merge],
        Format::Make => {
            // make reads a doubled dollar sign as one.
            let part = commands.part(Shell::Posix, "\u{1}").replace('$', "$$").replace('\u{1}', "$@");
            [part, merge.replace('$', "$$")]
        }
        _ => [commands.part(Shell::Posix, "\"$SLURM_ARRAY_TASK_ID\""), merge],
    };
    let parts = (0..count).map(|part| part.to_string()).collect::<Vec<_>>().join(" ");
    let last = (count - 1).to_string();
    let filled = |template: &str| {
        [("@LAST@", &last), ("@PARTS@", &parts), ("@COMMAND@", &part), ("@MERGE@", &merge)]
            .into_iter()
            .fold(template.to_owned(), |text, (key, value)| text.replace(key, value))
    };
    format.templates().iter().map(|(name, template)| (*name, filled(template))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scripts_have_part_numbers_and_quoted_commands() {
        let flags = vec!["--adapter=it's $1".to_owned()];
        let manifest = Manifest { flags, ..Manifest::new(&(0..6), 3).unwrap() };
        let expected = [
            (Format::Slurm, 1, "#SBATCH --array=0-2"),
            (
                Format::Slurm,
                1,
                "'a w' render-part plan.json --part \"$SLURM_ARRAY_TASK_ID\" \"--adapter=it's \"'$1' &",
            ),
            (Format::Slurm, 2, "'a w' merge plan.json --out picture.exr"),
            (Format::Parallel, 0, "seq 0 2 |"),
            (Format::Make, 0, "parts := 0 1 2"),
            (Format::Make, 0, "\t'a w' render-part plan.json --part $@ \"--adapter=it's \"'$$1'"),
            (Format::Make, 0, "\t'a w' merge plan.json --out picture.exr"),
        ];
        for (format, index, line) in expected {
            let (name, text) = &scripts(format, &manifest, "a w")[index];
            assert!(text.lines().any(|found| found == line), "{line:?} is not in {name}: {text}");
        }
        let parallel = &scripts(Format::Parallel, &manifest, "a w")[0].1;
        let command =
            parallel.lines().filter_map(|line| line.trim().strip_suffix(" || exit")).next_back().unwrap();
        assert_eq!(
            shlex::split(command).unwrap(),
            ["'a w' render-part plan.json --part {} \"--adapter=it's \"'$1'"]
        );
        assert!(scripts(Format::Text, &manifest, "w").is_empty());
    }
}
