//! Plans that are refused, each with what to do.

use super::common::{PICTURE, ends, plan, render_part, succeeds};
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
        let (_, told) = ends(at, 2, &again(other));
        assert!(told.contains("plan.json holds the plan of another picture"), "{told}");
    }
    let now = fs::read_to_string(at.join("p/plan.json")).unwrap();
    let without_command =
        |text: &str| text.lines().filter(|line| !line.contains("\"command\"")).collect::<Vec<_>>().join("\n");
    assert_eq!(without_command(&now), without_command(&manifest));
    assert!(render_part(at, "p", 0).contains("whole"));
}

#[test]
fn a_plan_that_was_changed_or_is_of_another_version_is_refused() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    plan(at, "p", &["--samples", "8", "--parts", "2"]);
    let (manifest, scene) = (at.join("p/plan.json"), at.join("p/scene.toml"));
    let [good, good_scene] = [&manifest, &scene].map(|path| fs::read_to_string(path).unwrap());
    let refused = |from: &str, to: &str, parts: &[&str]| {
        assert!(good.contains(from), "{from}");
        fs::write(&manifest, good.replace(from, to)).unwrap();
        for arguments in [&["render-part", "p", "--part", "0"][..], &["merge", "p", "--check"]] {
            let (_, told) = ends(at, 2, arguments);
            for part in parts {
                assert!(told.contains(part), "{part}: {told}");
            }
        }
        fs::write(&manifest, &good).unwrap();
    };
    let program = concat!("Weekender ", env!("CARGO_PKG_VERSION"));
    refused(
        "\"sample_version\": 3",
        "\"sample_version\": 2",
        &["version 2", "version 3", program, "another directory"],
    );
    refused("\"plan_version\": 1", "\"plan_version\": 7", &["version 7", "version 1"]);
    refused("\"block\"", "\"blocks\": 1,\n\"block\"", &["plan.json", "blocks"]);
    refused("\"block\"", "\"blocks\"", &["plan.json", "block"]);
    for name in ["part-1.exr", "picture.exr"] {
        refused(name, &format!("../{name}"), &[&format!("../{name}")]);
    }
    for (name, other) in [
        ("part-1.exr", "part-0.exr"),
        ("part-1.exr", "scene.toml"),
        ("picture.exr", "PART-0.exr"),
        ("picture.exr", "scene.toml"),
        ("picture.exr", "plan.json"),
    ] {
        refused(name, other, &["is the name of two of its files", other]);
    }
    refused("        4\n", "        5\n", &["5", "comes next"]);
    refused("{", "", &["plan.json"]);
    fs::write(&scene, good_scene.replace("vfov_degrees = 90", "vfov_degrees = 91") + "\n").unwrap();
    let (_, told) = ends(at, 2, &["render-part", "p", "--part", "0"]);
    assert!(told.contains("scene.toml was changed since"), "{told}");
    assert!(told.contains("undo the change or make the same plan again"), "{told}");
    // Another plan is told the same, and the same plan writes the scene again.
    let again = |samples: &'static str| {
        [&["plan"], &PICTURE[..], &["--out", "p", "--samples", samples, "--parts", "2"]].concat()
    };
    let (_, told) = ends(at, 2, &again("16"));
    assert!(told.contains("scene.toml was changed since"), "{told}");
    succeeds(at, &again("8"));
    assert_eq!(fs::read_to_string(&scene).unwrap(), good_scene);
    fs::remove_file(&scene).unwrap();
    let (_, told) = ends(at, 2, &["render-part", "p", "--part", "0"]);
    assert!(told.contains("scene.toml"), "{told}");
    succeeds(at, &again("8"));
    render_part(at, "p", 0);
    fs::write(&manifest, "{").unwrap();
    let (_, told) = ends(at, 2, &again("8"));
    assert!(
        told.contains("plan.json is not a plan, or is damaged") && told.contains("move it away"),
        "{told}"
    );
    fs::remove_file(&manifest).unwrap();
    succeeds(at, &again("8"));
    assert!(render_part(at, "p", 0).contains("whole"));
}

#[test]
fn files_of_another_origin_in_the_way_of_a_plan_are_named_and_stay() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    fs::create_dir(at.join("p")).unwrap();
    let common = [&["plan"], &PICTURE[..], &["--samples", "8", "--parts", "2", "--out", "p"]].concat();
    let with = |more: &[&'static str]| [&common[..], more].concat();
    for (name, format) in [
        ("scene.toml", "text"),
        ("Makefile", "make"),
        ("run.sh", "parallel"),
        ("submit.sh", "slurm"),
        ("parts.sbatch", "slurm"),
        ("merge.sbatch", "slurm"),
    ] {
        let path = at.join("p").join(name);
        fs::write(&path, "# mine\n").unwrap();
        let (_, told) = ends(at, 2, &with(&["--format", format]));
        assert!(told.contains(&format!("p/{name} is in the way")), "{told}");
        assert_eq!(fs::read_to_string(&path).unwrap(), "# mine\n");
        assert_eq!(fs::read_dir(at.join("p")).unwrap().count(), 1, "nothing else is written");
        fs::remove_file(&path).unwrap();
    }
    // What a plan has written may be written again, also with other values.
    for format in ["text", "make", "parallel", "slurm"] {
        succeeds(at, &with(&["--format", format]));
        succeeds(at, &with(&["--format", format, "--every", "5s", "--program", "an other"]));
    }
    fs::remove_file(at.join("p/plan.json")).unwrap();
    succeeds(at, &with(&["--format", "slurm"]));
    // But not if it was changed by hand.
    let submit = at.join("p/submit.sh");
    fs::write(&submit, fs::read_to_string(&submit).unwrap() + "# mine\n").unwrap();
    let (_, told) = ends(at, 2, &with(&["--format", "slurm"]));
    assert!(told.contains("p/submit.sh is in the way"), "{told}");
    fs::remove_file(at.join("p/plan.json")).unwrap();
    fs::write(at.join("p/scene.toml"), "# mine\n").unwrap();
    let (_, told) = ends(at, 2, &with(&[]));
    assert!(told.contains("p/scene.toml is in the way"), "{told}");
    assert!(!at.join("p/plan.json").exists());
}

#[test]
fn what_cannot_be_planned_is_refused_with_the_limit() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    let refused = |flags: &[&str], parts: &[&str]| {
        let (_, told) = ends(at, 2, &[&["plan", "--out", "p"], flags].concat());
        for part in parts {
            assert!(told.contains(part), "{part}: {told}");
        }
        assert!(!at.join("p").exists());
    };
    refused(&["--samples", "3", "--parts", "4"], &["--parts is 4", "3 samples"]);
    refused(&["--parts", "0"], &["100000"]);
    refused(&["--parts", "2", "--stage", "all"], &["--stage all"]);
    refused(&["--parts", "2", "--scene", "none"], &["none"]);
    refused(&["--samples", "4"], &["--parts"]);
    fs::write(at.join("file"), "").unwrap();
    let (_, told) = ends(at, 2, &["plan", "--parts", "2", "--out", "file"]);
    assert!(told.contains("cannot create the directory file"), "{told}");
    let (_, told) = ends(at, 2, &["plan", "--parts", "2", "--out", "a\nb"]);
    assert!(told.contains("control characters"), "{told}");
    fs::create_dir(at.join("deep%")).unwrap();
    #[allow(unused_mut, reason = "only Unix has more")]
    let mut outs = vec!["shots%a", "deep%/p", "./deep%/../x%/y"];
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("deep%", at.join("link")).unwrap();
        outs.extend(["link/p", "a\\b"]);
    }
    for out in outs {
        let (_, told) = ends(at, 2, &["plan", "--parts", "2", "--format", "slurm", "--out", out]);
        assert!(told.contains("Slurm takes % and \\"), "{told}");
    }
    plan(at, "shots%a", &["--samples", "8", "--parts", "2", "--format", "make"]);

    plan(at, "p", &["--samples", "8", "--parts", "2"]);
    let (_, told) = ends(at, 2, &["render-part", "p", "--part", "2"]);
    assert!(told.contains("no part 2") && told.contains("0 to 1"), "{told}");
    let (_, told) = ends(at, 2, &["render-part", "p"]);
    assert!(told.contains("--part NUMBER") && told.contains("JOB_COMPLETION_INDEX"), "{told}");
    fs::create_dir(at.join("empty")).unwrap();
    for arguments in [
        &["merge", "empty", "--out", "q.png"][..],
        &["merge", "empty", "--check"],
        &["render-part", "empty", "--part", "0"],
        &["info", "empty"],
    ] {
        let (_, told) = ends(at, 2, arguments);
        assert!(told.contains("empty is a directory without a plan.json"), "{told}");
    }
    let (_, told) = ends(at, 2, &["merge", "a.exr", "--watch", "--out", "x.exr"]);
    assert!(told.contains("--watch") && told.contains("weekender plan"), "{told}");
    let (_, told) = ends(at, 2, &["merge", "p", "a.exr", "--out", "x.exr"]);
    assert!(told.contains("merge it alone"), "{told}");
    let (_, told) = ends(at, 1, &["merge", "p", "--out", "x.exr"]);
    assert!(told.contains("part-0.exr is missing") && !at.join("x.exr").exists(), "{told}");
}
