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
