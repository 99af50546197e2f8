//! The files for Slurm, GNU parallel and make.

use super::common::{film, part_path, plan, whole};
use std::fs;
use std::path::Path;
use std::process::Command;
use tempfile::TempDir;

#[cfg(unix)]
/// A program whose name a shell and make would split if it were not quoted.
fn awkward_program(at: &Path) -> String {
    let path = at.join("it's $HOME's weekender");
    std::os::unix::fs::symlink(env!("CARGO_BIN_EXE_weekender"), &path).unwrap();
    path.to_str().unwrap().to_owned()
}

fn is_there(tool: &str) -> bool {
    let found = Command::new(tool).arg("--version").output().is_ok_and(|output| output.status.success());
    if !found {
        eprintln!("NOT TESTED: there is no {tool}");
    }
    found
}

#[cfg(unix)]
#[test]
fn make_renders_and_merges() {
    if !is_there("make") {
        return;
    }
    let at = TempDir::new().unwrap();
    let at = at.path();
    let program = awkward_program(at);
    let flags = ["--samples", "6", "--parts", "3", "--format", "make", "--program", &program];
    let start = plan(at, "a b", &flags);
    assert_eq!(start, "make -C 'a b'\n");
    let make = || Command::new("sh").arg("-c").arg(&start).current_dir(at).output().unwrap();
    let made = make();
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    assert!(film(&at.join("a b/picture.exr")) == whole(at, "0..6", &[]));
    // Only what was lost is rendered again.
    fs::remove_file(part_path(at, "a b", 1)).unwrap();
    let again = make();
    let message = String::from_utf8_lossy(&again.stdout);
    assert!(again.status.success() && message.matches("is whole: samples").count() == 2, "{message}");
}

#[cfg(unix)]
#[test]
fn parallel_renders_and_merges() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    let program = awkward_program(at);
    let flags = ["--samples", "6", "--parts", "3", "--format", "parallel", "--program", &program];
    let start = plan(at, "a b", &flags);
    assert_eq!(start, "sh 'a b/run.sh'\n");
    if !is_there("parallel") {
        return;
    }
    let run = Command::new("sh").arg("-c").arg(&start).current_dir(at).output().unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    assert!(film(&at.join("a b/picture.exr")) == whole(at, "0..6", &[]));
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
    assert!(fs::read_to_string(at.join("a b/submit.sh")).unwrap().contains("afterany"));
    // A scontrol that records how it is called.
    let tools = at.join("tools");
    fs::create_dir(&tools).unwrap();
    let fake = "#!/bin/sh\necho \"$@\" >> \"$ASKED\"\necho JobState=\"$STATE\"\n";
    fs::write(tools.join("scontrol"), fake).unwrap();
    assert!(Command::new("chmod").arg("+x").arg(tools.join("scontrol")).status().unwrap().success());
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
        let (begin, mut is_late) = (std::time::Instant::now(), false);
        while !is_late && (!part.exists() || film(&part).sample_count() == before) {
            std::thread::sleep(std::time::Duration::from_millis(20));
            // Much later than --every asks, but sooner than without it.
            is_late = begin.elapsed().as_secs() >= 45;
        }
        let killed = Command::new("kill").args(["-s", "TERM", &task.id().to_string()]).status().unwrap();
        assert!(killed.success());
        assert_eq!(task.wait().unwrap().code(), Some(143));
        assert!(!is_late, "no checkpoint is written");
        assert_eq!(fs::read_to_string(&asked_path).unwrap(), asked);
        assert!(film(&part).sample_count() > before);
    }
}
