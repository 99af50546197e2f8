//! Merging unfinished, damaged and foreign parts: what is reported, and what becomes of the others.

use super::common::{PICTURE, damage, ends, film, part_path, plan, render_part, succeeds, whole};
use tempfile::TempDir;

#[test]
fn existing_parts_are_merged_and_missing_ones_named() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    plan(at, "p", &["--samples", "32", "--parts", "4"]);
    render_part(at, "p", 0);
    render_part(at, "p", 3);
    // Part 1 is unfinished, part 2 missing.
    whole(at, "8..11", &[]);
    std::fs::rename(at.join("one-run.exr"), part_path(at, "p", 1)).unwrap();
    let (out, message) = ends(at, 1, &["merge", "p", "--out", "m.exr"]);
    assert!(out.contains("19 of 32 samples per pixel (0..11, 24..32); 2 of 4 parts are complete"), "{out}");
    for part in ["part-1.exr has 3 of 8 samples", "part-2.exr is missing", "--part 1", "--part 2"] {
        assert!(message.contains(part), "{part}: {message}");
    }
    let so_far = film(&at.join("m.exr"));
    let mut sum = whole(at, "0..11", &[]);
    sum.merge(&whole(at, "24..32", &[])).unwrap();
    assert!(so_far == sum);
    let (checked, _) = ends(at, 1, &["merge", "p", "--check"]);
    assert!(checked.contains("(--array=1,2 in Slurm)"), "{checked}");
    render_part(at, "p", 1);
    render_part(at, "p", 2);
    succeeds(at, &["merge", "p", "--out", "m.exr"]);
    assert!(succeeds(at, &["merge", "p", "--check"]).ends_with("; 4 of 4 parts are complete\n"));
    assert!(film(&at.join("m.exr")) == whole(at, "0..32", &[]));
}

#[test]
fn damaged_part_is_named_with_its_rows_and_left_out() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    // Several bands, so that some are added before the damage is met.
    let flags =
        ["plan", "--size", "32x150", "--samples", "4", "--parts", "2", "--device", "cpu", "--out", "p"];
    succeeds(at, &flags);
    for part in [0, 1] {
        render_part(at, "p", part);
    }
    let other = film(&part_path(at, "p", 1));
    damage(&part_path(at, "p", 0));
    for arguments in [&["merge", "p", "--check"][..], &["merge", "p", "--out", "m.exr"]] {
        let (out, message) = ends(at, 1, arguments);
        let all = out + &message;
        assert!(all.contains("part-0.exr is damaged: the rows ") && all.contains("--part 0"), "{all}");
        assert!(!all.contains("--part 1"), "{all}");
    }
    assert!(film(&at.join("m.exr")) == other, "what was added of the damaged film is taken away again");
    // Without a plan, nothing is merged.
    let (_, message) = ends(at, 2, &["merge", "p/part-0.exr", "p/part-1.exr", "--out", "x.exr"]);
    assert!(message.contains("part-0.exr is damaged"), "{message}");
    assert!(!at.join("x.exr").exists());
}

#[test]
fn misplaced_and_foreign_parts_are_named() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    plan(at, "p", &["--samples", "8", "--parts", "4"]);
    for part in 0..4 {
        render_part(at, "p", part);
    }
    let part = |index| part_path(at, "p", index);
    let whole_parts = film(&part(0));
    std::fs::copy(part(0), part(1)).unwrap();
    whole(at, "4..6", &["--seed", "9"]);
    std::fs::rename(at.join("one-run.exr"), part(2)).unwrap();
    let (checked, _) = ends(at, 1, &["merge", "p", "--check"]);
    for words in [
        "part-1.exr holds the samples 0..2, but this part has 2..4",
        "part-2.exr is the film of another picture than p/plan.json: seed is 0 here, 9 there",
        "2 of 4 parts are complete",
        "--array=1,2 ",
    ] {
        assert!(checked.contains(words), "{words}: {checked}");
    }
    let (out, message) = ends(at, 1, &["merge", "p", "--out", "m.exr"]);
    assert!(out.contains("(0..2, 6..8)") && message.contains("seed is 0 here, 9 there"), "{out}{message}");
    let mut sum = whole_parts;
    sum.merge(&film(&part(3))).unwrap();
    assert!(film(&at.join("m.exr")) == sum);
    // The program does not replace a possibly foreign film.
    for (index, words) in [("1", "0..2"), ("2", "seed")] {
        let (_, message) = ends(at, 2, &["render-part", "p", "--part", index, "--device", "cpu"]);
        assert!(message.contains(words), "{message}");
    }
}

#[test]
fn films_without_a_plan_are_added_or_refused() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    let render = |range: &str, name: &str, more: &[&str]| {
        let flags = ["--sample-range", range, "--progress", "off", "--out", name];
        succeeds(at, &[&["--batch"], &PICTURE[..], &flags, more].concat());
    };
    render("0..8", "a.exr", &[]);
    render("8..24", "b c.exr", &[]);
    render("6..9", "d.exr", &[]);
    render("24..26", "e.exr", &["--seed", "1"]);
    render("26..27", "f.exr", &[]);
    damage(&at.join("f.exr"));
    for (films, words) in [
        (["a.exr", "d.exr"], "a.exr and d.exr both hold the samples 6..8"),
        (["a.exr", "e.exr"], "e.exr is the film of another picture than a.exr: seed is 0 here, 1 there"),
        (["a.exr", "f.exr"], "f.exr is damaged"),
        (["a.exr", "./a.exr"], "./a.exr is named twice; name it once"),
    ] {
        let (_, message) = ends(at, 2, &["merge", "--out", "m.exr", films[0], films[1]]);
        assert!(message.contains(words), "{words}: {message}");
        assert!(!at.join("m.exr").exists());
    }
    let (_, message) = ends(at, 2, &["merge", "--check", "a.exr", "b c.exr"]);
    assert!(message.contains("needs a plan"), "{message}");
    let message = succeeds(at, &["merge", "a.exr", "b c.exr", "--out", "all.exr"]);
    assert!(message.starts_with("24 samples per pixel (0..24) from 2 films"), "{message}");
    assert!(film(&at.join("all.exr")) == whole(at, "0..24", &[]));
}
