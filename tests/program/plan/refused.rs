//! Plans that are refused, each with what to do.

use super::common::{PICTURE, ends, plan, render_part, succeeds};
use crate::common::program::refused;
use std::fs;
use tempfile::TempDir;

#[test]
fn a_directory_keeps_its_plan() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    let common = [&["plan"], &PICTURE[..], &["--out", "p"]].concat();
    let again = |flags: &[&'static str]| [&common[..], flags].concat();
    succeeds(at, &again(&["--samples", "8", "--parts", "2"]));
    render_part(at, "p", 0);
    let manifest = fs::read_to_string(at.join("p/plan.json")).unwrap();
    // The same plan may be made again, with other commands.
    succeeds(at, &again(&["--samples", "8", "--parts", "2", "--format", "make"]));
    for other in [
        &["--samples", "8", "--parts", "4"][..],
        &["--samples", "16", "--parts", "2"],
        &["--samples", "8", "--parts", "2", "--seed", "1"],
    ] {
        let (_, message) = ends(at, 2, &again(other));
        assert!(message.contains("plan.json holds the plan of another picture"), "{message}");
    }
    let now = fs::read_to_string(at.join("p/plan.json")).unwrap();
    let without_command =
        |text: &str| text.lines().filter(|line| !line.contains("\"command\"")).collect::<Vec<_>>().join("\n");
    assert_eq!(without_command(&now), without_command(&manifest));
    assert!(render_part(at, "p", 0).contains("complete"));
}

#[test]
fn changed_plan_or_other_version_is_refused() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    plan(at, "p", &["--samples", "8", "--parts", "2"]);
    let (manifest, scene) = (at.join("p/plan.json"), at.join("p/scene.toml"));
    let [good, good_scene] = [&manifest, &scene].map(|path| fs::read_to_string(path).unwrap());
    for (from, to, parts) in [
        (
            "\"sample_version\": 6",
            "\"sample_version\": 3",
            &["version 3", "version 6", "another directory"][..],
        ),
        ("\"plan_version\": 1", "\"plan_version\": 7", &["version 7", "version 1"]),
        ("\"block\"", "\"blocks\"", &["plan.json is not a plan"]),
        ("part-1.exr", "../part-1.exr", &["plan.json is not a plan", "other names"]),
        ("        4\n", "        5\n", &["its parts are not those of the samples 0..8"]),
        ("{", "", &["plan.json", "move it away"]),
    ] {
        assert!(good.contains(from), "{from}");
        fs::write(&manifest, good.replace(from, to)).unwrap();
        let (_, message) = ends(at, 2, &["merge", "p", "--check"]);
        assert!(parts.iter().all(|part| message.contains(part)), "{parts:?}: {message}");
    }
    fs::write(&manifest, &good).unwrap();
    fs::write(&scene, good_scene.clone() + "\n").unwrap();
    let (_, message) = ends(at, 2, &["render-part", "p", "--part", "0"]);
    assert!(
        message.contains("scene.toml was changed since") && message.contains("undo the change"),
        "{message}"
    );
    // The same plan writes the scene again.
    plan(at, "p", &["--samples", "8", "--parts", "2"]);
    assert_eq!(fs::read_to_string(&scene).unwrap(), good_scene);
}

#[test]
fn foreign_files_in_the_way_are_named_and_kept() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    fs::create_dir(at.join("p")).unwrap();
    let common = [&["plan"], &PICTURE[..], &["--samples", "8", "--parts", "2", "--out", "p"]].concat();
    let with = |format: &'static str| [&common[..], &["--format", format]].concat();
    for (name, format) in
        [("scene.toml", "text"), ("Makefile", "make"), ("run.sh", "parallel"), ("merge.sbatch", "slurm")]
    {
        let path = at.join("p").join(name);
        fs::write(&path, "# mine\n").unwrap();
        let (_, message) = ends(at, 2, &with(format));
        assert!(message.contains(&format!("p/{name} is in the way")), "{message}");
        assert_eq!(fs::read_to_string(&path).unwrap(), "# mine\n");
        assert_eq!(fs::read_dir(at.join("p")).unwrap().count(), 1, "nothing else is written");
        fs::remove_file(&path).unwrap();
    }
    // The same plan may be made again, in every form.
    for format in ["text", "make", "parallel", "slurm", "slurm"] {
        succeeds(at, &with(format));
    }
}

#[test]
fn invalid_plans_and_merges_are_refused() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    fs::write(at.join("file"), "").unwrap();
    fs::create_dir(at.join("empty")).unwrap();
    plan(at, "p", &["--samples", "8", "--parts", "2"]);
    for (arguments, parts) in [
        (&["plan", "--parts", "4", "--samples", "3", "--out", "q"][..], &["--parts is 4", "3 samples"][..]),
        (&["plan", "--parts", "0", "--out", "q"], &["100000"]),
        (&["plan", "--parts", "2", "--out", "file"], &["cannot create the directory file"]),
        (&["plan", "--parts", "2", "--out", "a\nb"], &["control characters"]),
        (&["render-part", "p", "--part", "2"], &["no part 2", "0 to 1"]),
        (&["render-part", "p"], &["--part NUMBER", "JOB_COMPLETION_INDEX"]),
        (&["merge", "empty", "--check"], &["empty is a directory without a plan.json"]),
        (&["info", "empty"], &["empty is a directory without a plan.json"]),
        (&["merge", "a.exr", "--check"], &["--check", "weekender plan"]),
        (&["merge", "p", "a.exr", "--out", "x.exr"], &["merge it alone"]),
        (&["merge", "p", "--out", "x.gif"], &["x.gif", ".exr"]),
    ] {
        refused(at, arguments, parts);
    }
    let (_, message) = ends(at, 1, &["merge", "p", "--out", "x.exr"]);
    assert!(message.contains("part-0.exr is missing") && !at.join("x.exr").exists(), "{message}");
}

/// As editors of Windows and git's `autocrlf` change text files.
#[test]
fn line_ends_and_byte_order_marks_do_not_matter() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    plan(at, "p", &["--samples", "4", "--parts", "2"]);
    for name in ["p/plan.json", "p/scene.toml"] {
        let text = fs::read_to_string(at.join(name)).unwrap();
        fs::write(at.join(name), format!("\u{feff}{}", text.replace('\n', "\r\n"))).unwrap();
    }
    render_part(at, "p", 0);
    assert!(render_part(at, "p", 0).contains("complete"));
    plan(at, "p", &["--samples", "4", "--parts", "2"]);
}
