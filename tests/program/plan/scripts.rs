//! The files for Slurm, GNU parallel and make.

use super::common::{film, part_path, plan, whole};
use crate::common::program::{PROGRAM, signal, text, until};
use crate::common::skip::report_untested;
use std::fs;
use std::path::Path;
use std::process::Command;
use tempfile::TempDir;

#[cfg(unix)]
/// A program whose name a shell and make would split if it were not quoted.
fn awkward_program(at: &Path) -> String {
    let path = at.join("it's $HOME's weekender");
    std::os::unix::fs::symlink(PROGRAM, &path).unwrap();
    path.to_str().unwrap().to_owned()
}

fn is_there(tool: &str) -> bool {
    let found = Command::new(tool).arg("--version").output().is_ok_and(|output| output.status.success());
    if !found {
        report_untested(&format!("there is no {tool}"));
    }
    found
}

/// Runs a line in a shell. Returns standard output.
fn shell(at: &Path, line: &str) -> String {
    let output = Command::new("sh").args(["-c", line]).current_dir(at).output().unwrap();
    assert!(output.status.success(), "{line}{}", text(&output.stderr));
    text(&output.stdout)
}

#[cfg(unix)]
#[test]
fn make_and_parallel_render_and_merge() {
    for (tool, start) in [("make", "make -C 'a b'\n"), ("parallel", "sh 'a b/run.sh'\n")] {
        let at = TempDir::new().unwrap();
        let at = at.path();
        let program = awkward_program(at);
        let flags = ["--samples", "6", "--parts", "3", "--format", tool, "--program", &program];
        assert_eq!(plan(at, "a b", &flags), start);
        if !is_there(tool) {
            continue;
        }
        shell(at, start);
        assert!(film(&at.join("a b/picture.exr")) == whole(at, "0..6", &[]));
        // Only what was lost is rendered again.
        fs::remove_file(part_path(at, "a b", 1)).unwrap();
        let again = shell(at, start);
        assert!(tool != "make" || again.matches("is complete: samples").count() == 2, "{again}");
    }
}

/// Slurm itself is not needed: a task is its script with the variables that Slurm sets.
#[cfg(unix)]
#[test]
fn slurm_task_requeues_itself_after_sigterm() {
    if !is_there("bash") {
        return;
    }
    let at = TempDir::new().unwrap();
    let at = at.path();
    let program = awkward_program(at);
    let flags = ["--samples", "4294967296", "--parts", "64", "--format", "slurm", "--every", "0.2s"];
    assert_eq!(plan(at, "a b", &[&flags[..], &["--program", &program]].concat()), "sh 'a b/submit.sh'\n");
    let script = fs::read_to_string(at.join("a b/parts.sbatch")).unwrap();
    for line in ["#SBATCH --array=0-63", "#SBATCH --requeue", "#SBATCH --signal=B:TERM@120"] {
        assert!(script.lines().any(|found| found == line), "{line}: {script}");
    }
    assert!(script.contains("--every"), "{script}");
    assert!(fs::read_to_string(at.join("a b/submit.sh")).unwrap().contains("afterany"));
    // A scontrol that records how it is called.
    let tools = at.join("tools");
    fs::create_dir(&tools).unwrap();
    let fake = "#!/bin/sh\necho \"$@\" >> \"$ASKED\"\necho JobState=\"$STATE\"\n";
    fs::write(tools.join("scontrol"), fake).unwrap();
    let executable = std::os::unix::fs::PermissionsExt::from_mode(0o755);
    fs::set_permissions(tools.join("scontrol"), executable).unwrap();
    for (state, asked) in [("RUNNING", "show job 70_5\nrequeue 70_5\n"), ("COMPLETING", "show job 70_5\n")] {
        let asked_path = at.join(format!("asked-{state}"));
        let path = std::env::join_paths(
            [tools.clone()].into_iter().chain(std::env::split_paths(&std::env::var_os("PATH").unwrap())),
        );
        let mut task = Command::new("bash")
            .arg("parts.sbatch")
            .current_dir(at.join("a b"))
            .env("PATH", path.unwrap())
            .env("ASKED", &asked_path)
            .env("STATE", state)
            .envs([("SLURM_ARRAY_TASK_ID", "5"), ("SLURM_ARRAY_JOB_ID", "70"), ("SLURM_JOB_ID", "77")])
            .spawn()
            .unwrap();
        let part = at.join("a b/part-05.exr");
        let before = if part.exists() { film(&part).sample_count() } else { 0 };
        until("no checkpoint is written", || part.exists() && film(&part).sample_count() > before);
        signal(&task, "TERM");
        assert_eq!(task.wait().unwrap().code(), Some(143));
        assert_eq!(fs::read_to_string(&asked_path).unwrap(), asked);
    }
}
