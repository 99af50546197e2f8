//! Files that give the parts of a plan to Slurm, GNU parallel or make. They are written beside the manifest and name it
//! without a directory, so the directory can be moved.

use super::commands::Commands;
use super::error::PlanError;
use super::manifest::{MANIFEST, Plan, Work};
use crate::files::write_text;
use crate::shell;
use std::path::PathBuf;

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
    let files = match kind {
        ScriptKind::Slurm => vec![
            ("submit.sh", SUBMIT.to_owned()),
            ("parts.sbatch", filled(PARTS, &[("LAST", &last.to_string()), ("COMMAND", &part)])),
            ("merge.sbatch", filled(MERGE, &[("COMMAND", &merge)])),
        ],
        ScriptKind::Parallel => {
            let part = shell::quoted(&shell::line(commands.part("{}")).replace("'{}'", "{}")).into_owned();
            let values = [("LAST", last.to_string()), ("COMMAND", part), ("MERGE", merge)];
            vec![("run.sh", filled(PARALLEL, &values.each_ref().map(|(key, value)| (*key, value.as_str()))))]
        }
        ScriptKind::Make => {
            let numbers: Vec<String> = (0..=last).map(|part| part.to_string()).collect();
            // A name that make expands keeps its dollar sign when it is doubled.
            let dollars = |line: String| line.replace('$', "$$");
            let part = dollars(shell::line(commands.part("\u{1}")));
            let part = part.replace("'\u{1}'", "$@").replace('\u{1}', "$@");
            let values = [("PARTS", numbers.join(" ")), ("COMMAND", part), ("MERGE", dollars(merge))];
            vec![("Makefile", filled(MAKE, &values.each_ref().map(|(key, value)| (*key, value.as_str()))))]
        }
    };
    let write = |(name, text): (&str, String)| {
        let path = plan.path.with_file_name(name);
        write_text(&path, &text)?;
        Ok(path)
    };
    files.into_iter().map(write).collect()
}

/// The text with each `@KEY@` replaced.
fn filled(text: &str, values: &[(&str, &str)]) -> String {
    values.iter().fold(text.to_owned(), |text, (key, value)| text.replace(&format!("@{key}@"), value))
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
@COMMAND@
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
