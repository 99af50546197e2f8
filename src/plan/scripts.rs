//! Files that give the parts of a plan to Slurm, GNU parallel or make. They are written beside the manifest and name it
//! without a directory, so the directory can be moved.

use super::commands::Commands;
use super::error::PlanError;
use super::manifest::{MANIFEST, Plan, Work, is_free};
use crate::files::write_text;
use crate::shell;
use std::path::{Path, PathBuf};

/// What runs the parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ScriptKind {
    /// A Slurm job array, and a job that merges.
    Slurm,
    /// GNU parallel.
    Parallel,
    /// make.
    Make,
}

impl ScriptKind {
    const ALL: [ScriptKind; 3] = [ScriptKind::Slurm, ScriptKind::Parallel, ScriptKind::Make];

    /// The names of all scripts.
    pub(super) fn names() -> impl Iterator<Item = &'static str> {
        Self::ALL.into_iter().flat_map(|kind| kind.templates()).map(|(name, _)| *name)
    }

    /// The scripts, each with its text, in which [`KEYS`] are filled in. The one to start comes first.
    fn templates(self) -> &'static [(&'static str, &'static str)] {
        match self {
            ScriptKind::Slurm => &[("submit.sh", SUBMIT), ("parts.sbatch", PARTS), ("merge.sbatch", MERGE)],
            ScriptKind::Parallel => &[("run.sh", PARALLEL)],
            ScriptKind::Make => &[("Makefile", MAKE)],
        }
    }
}

/// Checks that [`write_scripts`] would replace no file of another origin in `directory`. A script of an earlier plan may
/// go, whatever its values are, but not one that was changed by hand.
///
/// # Errors
/// [`PlanError::InTheWay`].
pub fn check_scripts(kind: ScriptKind, directory: &Path) -> Result<(), PlanError> {
    for (name, template) in kind.templates() {
        let path = directory.join(name);
        if !is_free(&path, |text| is_filled_from(template, text)) {
            return Err(PlanError::InTheWay { path });
        }
    }
    Ok(())
}

/// Writes the scripts of a plan, whose commands call this program `program`. Returns the files; the one to start comes
/// first.
///
/// # Errors
/// [`PlanError::Write`].
pub fn write_scripts<W: Work>(
    kind: ScriptKind,
    plan: &Plan<W>,
    program: &str,
) -> Result<Vec<PathBuf>, PlanError> {
    let commands = Commands::new(program, MANIFEST, plan);
    let last = plan.manifest.work.count() - 1;
    let (part, merge) =
        (commands.part_line_of("SLURM_ARRAY_TASK_ID"), commands.merge_line(&plan.manifest.result));
    let last_number = last.to_string();
    let values: [String; 4] = match kind {
        ScriptKind::Slurm => [last_number, String::new(), part, merge],
        ScriptKind::Parallel => {
            let part = shell::quoted(&shell::line(commands.part("{}")).replace("'{}'", "{}")).into_owned();
            [last_number, String::new(), part, merge]
        }
        ScriptKind::Make => {
            let numbers: Vec<String> = (0..=last).map(|part| part.to_string()).collect();
            // A name that make expands keeps its dollar sign when it is doubled.
            let dollars = |line: String| line.replace('$', "$$");
            let part = dollars(shell::line(commands.part("\u{1}")));
            let part = part.replace("'\u{1}'", "$@").replace('\u{1}', "$@");
            [last_number, numbers.join(" "), part, dollars(merge)]
        }
    };
    let write = |(name, template): &(&str, &str)| {
        let path = plan.path.with_file_name(name);
        write_text(&path, &filled(template, &values))?;
        Ok(path)
    };
    kind.templates().iter().map(write).collect()
}

/// What is filled into a template: the number of the last part, the numbers of all parts, the command of a part, and the
/// command that merges.
const KEYS: [&str; 4] = ["@LAST@", "@PARTS@", "@COMMAND@", "@MERGE@"];

/// The template with the values of [`KEYS`].
fn filled(template: &str, values: &[String; 4]) -> String {
    KEYS.iter().zip(values).fold(template.to_owned(), |text, (key, value)| text.replace(*key, value))
}

/// Whether `text` is the template with some values of one line each.
fn is_filled_from(template: &str, text: &str) -> bool {
    const GAP: &str = "\0";
    let gaps = filled(template, &KEYS.map(|_| GAP.to_owned()));
    let pieces: Vec<&str> = gaps.split(GAP).collect();
    let [first, middle @ .., last] = pieces.as_slice() else { return text == template };
    let inner = text.strip_prefix(*first).and_then(|rest| rest.strip_suffix(*last));
    let after_middle = middle.iter().try_fold(inner, |rest, piece| {
        let (value, rest) = rest?.split_once(*piece)?;
        (!value.contains('\n')).then_some(Some(rest))
    });
    after_middle.flatten().is_some_and(|value| !value.contains('\n'))
}

const SUBMIT: &str = r#"#!/bin/sh
# Submits the parts as a job array, and the job that merges them. Options for sbatch, such as --partition or --time, are
# handed on. To go on after a failure, run it again: parts that are whole end at once, the others go on.
cd "$(dirname "$0")" || exit
parts=$(sbatch --parsable "$@" parts.sbatch) || exit
# The cluster's name may follow the number. Once all tasks have ended, well or not, the merge says what is missing.
sbatch --dependency="afterany:${parts%%;*}" "$@" merge.sbatch
"#;

const PARTS: &str = r#"#!/bin/bash
#SBATCH --job-name=weekender
#SBATCH --array=0-@LAST@
#SBATCH --output=part-%a.log
#SBATCH --open-mode=append
#SBATCH --requeue
#SBATCH --signal=B:TERM@120
# A task that is ended early, by its time limit or a failed node, is queued again and goes on from what it has written.
child=
trap '[ -n "$child" ] && kill -TERM "$child" 2>/dev/null' TERM
@COMMAND@ &
child=$!
wait "$child"
code=$?
# A signal ends the waiting, not the program.
while kill -0 "$child" 2>/dev/null; do
  wait "$child"
  code=$?
done
# 143: SIGTERM came, and what was rendered is written. A task that was cancelled stays cancelled.
task=${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID
if [ "$code" -eq 143 ] && scontrol show job "$task" | grep -q 'JobState=RUNNING'; then
  scontrol requeue "$task"
fi
exit "$code"
"#;

const MERGE: &str = r#"#!/bin/bash
#SBATCH --job-name=weekender-merge
#SBATCH --output=merge.log
#SBATCH --open-mode=append
#SBATCH --requeue
@MERGE@
"#;

const PARALLEL: &str = r#"#!/bin/sh
# Renders the parts with GNU parallel, one at a time on each machine, then merges them. Options for parallel, such as
# --sshlogin a,b, are handed on; the machines must share this directory. To go on after a failure, run it again: parts
# that are whole end at once, the others go on.
cd "$(dirname "$0")" || exit
# The pause leaves time to write what was rendered.
seq 0 @LAST@ |
  parallel --jobs 1 --workdir . --joblog parallel.log --line-buffer --termseq TERM,60000,KILL,25 "$@" \
    @COMMAND@ || exit
@MERGE@
"#;

const MAKE: &str = r#"# Renders the parts, then merges them. To go on after a failure, run make again: parts that are whole end at once, the
# others go on. `make -k` does not stop at the first part that fails.
parts := @PARTS@
.PHONY: picture $(parts)
picture: $(parts)
	@MERGE@
$(parts):
	@COMMAND@
"#;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::{Manifest, Samples, divide};
    use crate::recipe::Recipe;

    fn values(kind: ScriptKind) -> [String; 4] {
        let part = if kind == ScriptKind::Make { "w render-part 'a $$b'" } else { "w render-part 'a b'" };
        ["7", "0 1 2", part, "w merge plan.json --out picture.exr"].map(str::to_owned)
    }

    #[test]
    fn a_script_is_known_by_all_but_its_values() {
        for kind in ScriptKind::ALL {
            for (name, template) in kind.templates() {
                let text = filled(template, &values(kind));
                assert!(!text.contains("@LAST@") && is_filled_from(template, &text), "{name}");
                for other in [
                    String::new(),
                    format!("{text}# mine\n"),
                    format!("# mine\n{text}"),
                    text.replacen('\n', "\n# mine\n", 2),
                    text.replace(" in", ""),
                    text.replace("w merge", "module load w\nw merge"),
                    text.replace("w render-part", "module load w\nw render-part"),
                ] {
                    assert!(other == text || !is_filled_from(template, &other), "{name}: {other}");
                }
            }
        }
    }

    #[test]
    fn a_file_of_another_origin_is_in_the_way_of_a_script() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("Makefile");
        let check = |kind| check_scripts(kind, directory.path());
        check(ScriptKind::Make).unwrap();
        std::fs::write(&path, filled(MAKE, &values(ScriptKind::Make))).unwrap();
        check(ScriptKind::Make).unwrap();
        std::fs::write(&path, "all:\n\ttrue\n").unwrap();
        let told = check(ScriptKind::Make).unwrap_err().to_string();
        assert!(told.contains("Makefile is in the way"), "{told}");
        check(ScriptKind::Slurm).unwrap();
        std::fs::remove_file(&path).unwrap();
        std::fs::create_dir(&path).unwrap();
        assert!(check(ScriptKind::Make).is_err());
    }

    #[test]
    fn each_script_has_the_commands_and_the_numbers_of_its_plan() {
        let directory = tempfile::tempdir().unwrap();
        let mut recipe = Recipe::find("three-spheres").unwrap();
        (recipe.settings.width, recipe.settings.height) = (4, 3);
        let work = Samples::new(&(0..6), &divide(0..6, 3).unwrap());
        let manifest = Manifest { flags: vec!["--every=5s".to_owned()], ..Manifest::new(work) };
        let plan = Plan::write(directory.path(), &recipe, &recipe.job().unwrap(), manifest).unwrap();
        let merge = "w merge plan.json --out picture.exr";
        let expected = [
            (
                ScriptKind::Slurm,
                "submit.sh",
                vec!["sbatch --dependency=\"afterany:${parts%%;*}\" \"$@\" merge.sbatch"],
            ),
            (
                ScriptKind::Slurm,
                "parts.sbatch",
                vec![
                    "#SBATCH --array=0-2",
                    "w render-part plan.json --part \"$SLURM_ARRAY_TASK_ID\" --every=5s &",
                ],
            ),
            (ScriptKind::Slurm, "merge.sbatch", vec![merge]),
            (
                ScriptKind::Parallel,
                "run.sh",
                vec!["seq 0 2 |", "    'w render-part plan.json --part {} --every=5s' || exit", merge],
            ),
            (
                ScriptKind::Make,
                "Makefile",
                vec![
                    "parts := 0 1 2",
                    "\tw merge plan.json --out picture.exr",
                    "\tw render-part plan.json --part $@ --every=5s",
                ],
            ),
        ];
        for kind in ScriptKind::ALL {
            let files = write_scripts(kind, &plan, "w").unwrap();
            let own: Vec<PathBuf> = expected
                .iter()
                .filter(|(of, ..)| *of == kind)
                .map(|(_, name, _)| plan.beside(name))
                .collect();
            assert_eq!(files, own, "the one to start comes first");
        }
        for (_, name, lines) in expected {
            let text = std::fs::read_to_string(plan.beside(name)).unwrap();
            for line in lines {
                assert!(text.lines().any(|found| found == line), "{line:?} is not in {name}: {text}");
            }
        }
    }
}
