//! Pictures rendered in ranges of samples, each into a film of its own, and their merge.

use crate::common::program::{ends, film, json, succeeds};
use std::fs;
use std::path::Path;
use tempfile::TempDir;
use weekender::film::Film;

/// A small picture. Two threads of the CPU make the same bits everywhere.
const PICTURE: [&str; 6] = ["--size", "32x18", "--device", "cpu", "--threads", "2"];

/// The film of one run with the samples `range`.
fn whole(at: &Path, range: &str, flags: &[&str]) -> Film {
    render(at, range, "one-run.exr", flags);
    film(&at.join("one-run.exr"))
}

fn render(at: &Path, range: &str, name: &str, flags: &[&str]) {
    let common = ["--batch", "--sample-range", range, "--out", name];
    succeeds(at, &[&common[..], &PICTURE, flags].concat());
}

/// The command that renders a range, or continues it.
fn part<'a>(range: &'a str, film: &'a str) -> Vec<&'a str> {
    [&["--batch", "--sample-range", range, "--checkpoint", film, "--continue"][..], &PICTURE].concat()
}

/// Changes a byte of a film's sums.
fn damage(path: &Path) {
    let mut bytes = fs::read(path).unwrap();
    let place = bytes.len() - 5;
    bytes[place] ^= 0x10;
    fs::write(path, bytes).unwrap();
}

#[test]
fn range_continues_from_its_checkpoint_unless_complete() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    let path = at.join("b.exr");
    // As a killed run leaves it.
    render(at, "32..39", "b.exr", &[]);
    let command = [&part("32..64", "b.exr")[..], &["--json", "-"]].concat();
    let found = json(at, &command);
    assert_eq!((&found["added_samples_per_pixel"], &found["samples_per_pixel"]), (&25.into(), &32.into()));
    assert!(film(&path) == whole(at, "32..64", &[]));
    assert!(!at.join("three-spheres.png").exists(), "a part has no picture unless --out asks for one");

    let modified = || fs::metadata(&path).unwrap().modified().unwrap();
    let before = modified();
    // A scheduler that repeats a command reads the same JSON again.
    let again = json(at, &command);
    assert_eq!((&again["added_samples_per_pixel"], &again["samples_per_pixel"]), (&0.into(), &32.into()));
    assert_eq!((&again["ended_by"], &again["files"][0]), (&"samples".into(), &"b.exr".into()));
    assert!(again["rmse_estimate"].is_number() && again["paths"] == 0, "{again}");
    assert_eq!(modified(), before);
    // A picture that was not written before is written now.
    succeeds(at, &[&part("32..64", "b.exr")[..], &["--out", "b.png"]].concat());
    assert!(at.join("b.png").exists());
}

#[test]
fn damaged_film_is_moved_aside_and_rendered_again() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    let path = at.join("a.exr");
    succeeds(at, &part("0..4", "a.exr"));
    let good = film(&path);
    damage(&path);
    let bytes = fs::read(&path).unwrap();
    let (_, message) = ends(at, 0, &part("0..4", "a.exr"));
    assert!(message.contains("a.exr.damaged") && message.contains("rendered again"), "{message}");
    assert!(fs::read(at.join("a.exr.damaged")).unwrap() == bytes && film(&path) == good);
    // With --resume it is refused, and so is a foreign file with --continue. An empty one holds nothing.
    damage(&path);
    ends(at, 2, &["--batch", "--resume", "a.exr", "--samples", "8", "--out", "b.exr"]);
    fs::write(at.join("c.exr"), "mine").unwrap();
    ends(at, 2, &part("0..4", "c.exr"));
    assert_eq!(fs::read(at.join("c.exr")).unwrap(), b"mine");
    fs::write(at.join("d.exr"), "").unwrap();
    succeeds(at, &part("0..4", "d.exr"));
    assert!(film(&at.join("d.exr")) == good);
}

/// Runs a line in a shell. Returns standard output and standard error.
#[cfg(unix)]
fn shell(at: &Path, line: &str) -> String {
    let output = std::process::Command::new("sh").args(["-c", line]).current_dir(at).output().unwrap();
    let text = [output.stdout, output.stderr].concat();
    let text = String::from_utf8_lossy(&text).into_owned();
    assert!(output.status.success(), "{line}: {text}");
    text
}

#[cfg(unix)]
#[test]
fn printed_commands_complete_a_picture() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    let names: Vec<String> = (0..5).map(|part| format!("it's part {part} of $HOME & Köln; *.exr")).collect();
    let flags = ["--scene", "book", "--seed", "3"];
    // 0 lacks its start, 1 is unfinished, 2 is damaged, 3 was never rendered, and 4 is whole.
    for (range, part) in [("4..8", 0), ("8..11", 1), ("16..24", 2), ("32..40", 4)] {
        render(at, range, &names[part], &flags);
    }
    damage(&at.join(&names[2]));
    let films = [0, 1, 2, 4].map(|part| names[part].as_str());
    let merge = [&["merge", "--samples", "40"], &films[..]].concat();
    let (out, _) = ends(at, 1, &[&merge[..], &["--out", "m.exr"]].concat());
    let mut sum = whole(at, "4..11", &flags);
    sum.merge(&whole(at, "32..40", &flags)).unwrap();
    assert!(film(&at.join("m.exr")) == sum, "what was added of the damaged film is taken away again");
    assert!(out.contains(&format!("left out: {} is damaged: the rows ", names[2])), "{out}");
    let commands: Vec<&str> = out.lines().filter(|line| line.contains(" --continue")).collect();
    let ranges = ["0..4", "11..16", "16..32"];
    assert_eq!(commands.len(), ranges.len(), "{out}");
    for (command, range) in commands.into_iter().zip(ranges) {
        assert!(command.contains(&format!("--sample-range={range} ")), "{out}");
        shell(at, &format!("{command} --device cpu"));
    }
    let (out, _) = ends(at, 0, &[&merge[..], &["--out", "m.exr"]].concat());
    assert!(out.starts_with("40 samples per pixel (0..40) from 4 films"), "{out}");
    assert!(film(&at.join("m.exr")) == whole(at, "0..40", &flags));
}

#[test]
fn films_are_added_or_refused_and_left_out_with_samples() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    render(at, "0..8", "a.exr", &[]);
    render(at, "8..24", "b c.exr", &[]);
    render(at, "6..9", "d.exr", &[]);
    render(at, "24..26", "e.exr", &["--seed", "1"]);
    render(at, "26..27", "f.exr", &[]);
    damage(&at.join("f.exr"));
    for (film, words) in [
        ("d.exr", "a.exr and d.exr both hold the samples 6..8"),
        ("e.exr", "e.exr is the film of another picture than a.exr: seed is 0 here, 1 there"),
        ("f.exr", "f.exr is damaged"),
        ("gone.exr", "gone.exr"),
    ] {
        let (_, message) = ends(at, 2, &["merge", "--out", "m.exr", "a.exr", film]);
        assert!(message.contains(words) && !at.join("m.exr").exists(), "{words}: {message}");
        let (out, _) = ends(at, 0, &["merge", "--samples", "8", "a.exr", film]);
        assert!(out.contains("8 samples per pixel (0..8) from 1 film\nleft out: "), "{out}");
        assert!(out.contains(words) && !out.contains("missing"), "{words}: {out}");
    }
    for arguments in
        [&["a.exr", "./a.exr", "--out", "m.exr"][..], &["a.exr", "b c.exr"], &["f.exr", "--samples", "4"]]
    {
        ends(at, 2, &[&["merge"], arguments].concat());
    }
    let message = succeeds(at, &["merge", "a.exr", "b c.exr", "--out", "all.exr", "--out", "all.png"]);
    assert!(message.starts_with("24 samples per pixel (0..24) from 2 films"), "{message}");
    assert!(film(&at.join("all.exr")) == whole(at, "0..24", &[]) && at.join("all.png").exists());
}

/// The makefile in docs/many-machines.md, with a smaller picture and three parts.
#[cfg(unix)]
#[test]
fn documented_makefile_renders_and_merges() {
    use crate::common::program::PROGRAM;
    if !std::process::Command::new("make")
        .arg("--version")
        .output()
        .is_ok_and(|output| output.status.success())
    {
        return crate::common::skip::report_untested("there is no make");
    }
    let at = TempDir::new().unwrap();
    let at = at.path();
    let docs =
        fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/many-machines.md")).unwrap();
    let makefile = docs.split("```make\n").nth(1).unwrap().split("```").next().unwrap();
    let small = [
        ("seq 0 128 3968", "seq 0 4 8".to_owned()),
        ("+ 128", "+ 4".to_owned()),
        ("4096", "12".to_owned()),
        ("--scene book", PICTURE.join(" ")),
    ];
    let makefile = small.iter().fold(makefile.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{from}: {text}");
        text.replace(from, to)
    });
    fs::write(at.join("Makefile"), makefile).unwrap();
    std::os::unix::fs::symlink(PROGRAM, at.join("weekender")).unwrap();
    let make = "PATH=$PWD:$PATH make -k";
    shell(at, make);
    assert!(film(&at.join("book.exr")) == whole(at, "0..12", &[]));
    // Only what was lost is rendered again.
    fs::remove_file(at.join("part-4.exr")).unwrap();
    let again = shell(at, make);
    assert_eq!(again.matches(" 0 of them new").count(), 2, "{again}");
    assert!(film(&at.join("book.exr")) == whole(at, "0..12", &[]));
}

#[test]
fn files_say_what_they_are() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    render(at, "4..8", "part.exr", &["--stage", "metal"]);
    let pictures = ["--samples", "4", "--progress", "off", "--out", "a.png", "--checkpoint", "a b.exr"];
    succeeds(at, &[&["--batch"], &PICTURE[..], &pictures].concat());
    succeeds(at, &["--scene", "book", "--save-scene", "s.toml"]);
    let json = |file: &str| json(at, &["info", file, "--json"]);
    let keys = ["kind", "scene", "stage", "samples_per_pixel", "sample_ranges", "film_version"];
    let of = |file: &str| {
        let json = json(file);
        keys.map(|key| json[key].to_string()).join(" ")
    };
    assert_eq!(of("part.exr"), "\"film\" \"metal\" \"metal\" 4 \"4..8\" 4");
    assert_eq!(of("a b.exr"), "\"film\" \"three-spheres\" null 4 \"0..4\" 4");
    assert_eq!(of("a.png"), "\"picture\" \"three-spheres\" null 4 null null");
    fs::copy(at.join("a.png"), at.join("without an ending")).unwrap();
    assert_eq!(of("without an ending"), of("a.png"));
    assert!(of("s.toml").starts_with("\"scene\" \"s\" null "), "{}", of("s.toml"));
    assert!(json("a b.exr")["rmse_estimate"].as_f64().unwrap() > 0.0);

    // The command is the one that made the file, and makes the same one again.
    let message = succeeds(at, &["info", "a b.exr"]);
    let command = message.lines().find_map(|line| line.strip_prefix("command  ")).unwrap();
    let words = shlex::split(command).unwrap();
    assert_eq!(words[0], "weekender");
    assert_eq!(json("a.png")["command"], command);
    let before = whole(at, "0..4", &[]);
    fs::remove_file(at.join("a b.exr")).unwrap();
    succeeds(at, &words.iter().skip(1).map(String::as_str).collect::<Vec<_>>());
    assert!(film(&at.join("a b.exr")) == before);
    for words in ["three-spheres, 32x18", "4 per pixel, samples 0..4", "RMSE"] {
        assert!(message.contains(words), "{words}: {message}");
    }
    fs::write(at.join("x.exr"), "x").unwrap();
    let (_, refused) = ends(at, 2, &["info", "x.exr"]);
    assert!(refused.contains("x.exr"), "{refused}");
}
