//! Plans by frames.

use super::common::{ends, run, succeeds, text};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use tempfile::TempDir;

const SMALL: [&str; 8] = ["--size", "24x14", "--samples", "4", "--device", "cpu", "--threads", "2"];

fn plan(at: &Path, flags: &[&str]) -> String {
    succeeds(at, &[&["plan", "--out", "p"], &SMALL[..], flags].concat())
}

/// The frames of one run, by their numbers.
fn one_run(at: &Path, flags: &[&str]) {
    succeeds(at, &[&["--batch", "--out", "run"], &SMALL[..], flags].concat());
}

fn pixels(path: &Path) -> Vec<u8> {
    let file = std::io::BufReader::new(fs::File::open(path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    pixels
}

fn frame(directory: &Path, number: u32) -> std::path::PathBuf {
    directory.join(format!("frame-{number:04}.png"))
}

#[test]
fn parts_have_the_frames_of_one_run_and_make_its_animation() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    let flags = ["--turntable=7", "--fps", "12"];
    let lines = plan(at, &[&flags[..], &["--parts", "3"]].concat());
    assert_eq!(lines.lines().count(), 3, "{lines}");
    // Planning again repeats what it divides.
    let again = [&["plan", "--out", "p"], &SMALL[..], &flags, &["--parts", "3"]].concat();
    let message = ends(at, 0, &again).1;
    assert!(message.contains("3 parts of at most 3 frames"), "{message}");
    for line in lines.lines().rev() {
        let words = shlex::split(line).unwrap();
        assert_eq!(words[1], "render-part");
        succeeds(at, &words.iter().skip(1).map(String::as_str).collect::<Vec<_>>());
    }
    one_run(at, &["--turntable=7"]);
    for number in 0..7 {
        assert!(pixels(&frame(&at.join("p"), number)) == pixels(&frame(&at.join("run"), number)), "{number}");
    }
    assert!(pixels(&frame(&at.join("p"), 0)) != pixels(&frame(&at.join("p"), 3)), "the camera moves");
    assert!(succeeds(at, &["merge", "p", "--check"]).contains("7 of 7 frames are whole"));
    succeeds(at, &["merge", "p", "--out", "turn.png"]);
    let file = std::io::BufReader::new(fs::File::open(at.join("turn.png")).unwrap());
    let reader = png::Decoder::new(file).read_info().unwrap();
    assert_eq!(reader.info().animation_control().unwrap().num_frames, 7);
    let control = reader.info().frame_control().unwrap();
    assert_eq!((control.delay_num, control.delay_den), (1, 12));

    let again = succeeds(at, &["render-part", "p", "--part", "1", "--device", "cpu"]);
    assert!(again.contains("0 rendered, 2 already there"), "{again}");
    let info: Value = serde_json::from_str(&succeeds(at, &["info", "p", "--json"])).unwrap();
    assert_eq!((&info["frames"], &info["parts"]), (&"0..7".into(), &3.into()));
    assert_eq!(info["samples_per_pixel"], 4);
    assert!(succeeds(at, &["info", "p"]).contains("4 per pixel, frames 0..7, 3 parts"));
}

#[test]
fn keyframes_are_in_the_plan_and_wrong_frames_are_named() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    let keyframes = "\
        [camera]\nlook_from = [0.0, 1.0, 4.0]\nlook_at = [0.0, 0.0, 0.0]\nvfov_degrees = 40.0\n\
        [[keyframes]]\nframe = 0\n[[keyframes]]\nframe = 9\nlook_from = [3.0, 1.0, 3.0]\n\
        [materials.m]\nkind = \"lambertian\"\nalbedo = [0.8, 0.3, 0.1]\n\
        [[spheres]]\ncenter = [0.0, 0.0, 0.0]\nradius = 1.0\nmaterial = \"m\"\n";
    fs::write(at.join("s.toml"), keyframes).unwrap();
    let flags = ["--scene", "s.toml", "--frames", "3..9"];
    plan(at, &[&flags[..], &["--parts", "2"]].concat());
    // The plan is complete without the scene file that it was made from.
    fs::remove_file(at.join("s.toml")).unwrap();
    for part in ["0", "1"] {
        succeeds(at, &["render-part", "p", "--part", part, "--device", "cpu", "--threads", "2"]);
    }
    // The directory keeps the plan of these keyframes.
    fs::write(at.join("s.toml"), keyframes.replace("[3.0, 1.0, 3.0]", "[3.0, 1.0, 3.5]")).unwrap();
    let again = [&["plan", "--out", "p"], &SMALL[..], &flags, &["--parts", "2"]].concat();
    assert!(ends(at, 2, &again).1.contains("holds the plan of another picture"));
    fs::write(at.join("s.toml"), keyframes).unwrap();
    one_run(at, &flags);
    let (planned, run_frames) = (at.join("p"), at.join("run"));
    for number in 3..9 {
        assert!(pixels(&frame(&planned, number)) == pixels(&frame(&run_frames, number)), "{number}");
    }
    fs::remove_file(frame(&planned, 3)).unwrap();
    fs::copy(frame(&planned, 7), frame(&planned, 8)).unwrap();
    let mut bytes = fs::read(frame(&planned, 5)).unwrap();
    let end = bytes.len() - 20;
    bytes[end] ^= 1;
    fs::write(frame(&planned, 5), bytes).unwrap();
    for arguments in [&["merge", "p", "--check"][..], &["merge", "p", "--out", "a.png"]] {
        let (out, message) = ends(at, 1, arguments);
        let all = out + &message;
        for words in [
            "part 0: frame-0003.png is missing",
            "part 0: ",
            "frame-0005.png",
            "frame-0008.png is of another picture: look-from is",
            "3 of 6 frames are whole",
            "--array=0,1 in Slurm",
            "--part 0",
        ] {
            assert!(all.contains(words), "{words}: {all}");
        }
    }
    assert!(!at.join("a.png").exists());
    for part in ["0", "1"] {
        succeeds(at, &["render-part", "p", "--part", part, "--device", "cpu", "--threads", "2"]);
    }
    succeeds(at, &["merge", "p", "--check"]);
}

#[cfg(unix)]
#[test]
fn ended_watch_reports_what_is_wrong_and_missing() {
    use std::io::{BufRead, BufReader, Read};
    let at = TempDir::new().unwrap();
    let at = at.path();
    plan(at, &["--turntable=2", "--parts", "2"]);
    let mut watch =
        super::common::command(at, &["merge", "p", "--watch", "--every", "0.1s", "--out", "t.png"]);
    let mut child = watch.stderr(Stdio::piped()).spawn().unwrap();
    let mut stderr = BufReader::new(child.stderr.take().unwrap());
    let mut lines_until = |words: &str| -> Vec<String> {
        let mut lines = Vec::new();
        for line in stderr.by_ref().lines().map(Result::unwrap) {
            lines.push(line);
            if lines.last().is_some_and(|line| line.contains(words)) {
                return lines;
            }
        }
        panic!("{words} is not in {lines:?}");
    };
    // It has seen that there is no frame yet.
    lines_until("0 of 2 frames are whole");
    fs::write(at.join("no-picture"), "no picture").unwrap();
    fs::rename(at.join("no-picture"), frame(&at.join("p"), 0)).unwrap();
    succeeds(at, &["render-part", "p", "--part", "1", "--device", "cpu"]);
    let lines = lines_until("1 of 2 frames are whole");
    assert!(lines.iter().any(|line| line.starts_with("warning: part 0: ")), "{lines:?}");
    let killed = Command::new("kill").args(["-s", "INT", &child.id().to_string()]).status().unwrap();
    assert!(killed.success());
    lines_until("1 of 2 frames are whole");
    lines_until("interrupted; the same command continues");
    lines_until("--part 0");
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(!at.join("t.png").exists());
}

#[test]
fn invalid_frame_plans_are_refused() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    for (flags, parts) in [
        (&["--turntable=3", "--parts", "4"][..], &["--parts is 4", "3 frames"][..]),
        (&["--turntable=9", "--parts", "2", "--every", "5s"], &["--every", "--turntable"]),
        (&["--frames", "0..9", "--parts", "2"], &["--frames", "[[keyframes]]"]),
        (&["--fps", "9", "--parts", "2"], &["--fps", "--frames"]),
    ] {
        let output = run(at, &[&["plan", "--out", "p", "--samples", "4"], flags].concat());
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{message}");
        for part in parts {
            assert!(message.contains(part), "{part}: {message}");
        }
        assert!(!at.join("p").exists());
    }
    let sampled = ["plan", "--out", "q", "--sample-range", "4..8", "--turntable=9", "--parts", "2"];
    assert!(ends(at, 2, &sampled).1.contains("--sample-range"));
    plan(at, &["--turntable=3", "--parts", "3"]);
    let (_, message) = ends(at, 2, &["merge", "p", "--out", "a.exr"]);
    assert!(message.contains("a.exr") && message.contains(".png"), "{message}");
    // The directory keeps its plan.
    for other in
        [&["--turntable=6", "--parts", "3"][..], &["--parts", "3"], &["--turntable=3", "--parts", "1"]]
    {
        let (_, message) = ends(at, 2, &[&["plan", "--out", "p"], &SMALL[..], other].concat());
        assert!(message.contains("holds the plan of another picture"), "{message}");
    }
    let manifest = fs::read_to_string(at.join("p/plan.json")).unwrap();
    fs::write(at.join("p/plan.json"), manifest.replacen("\"frames\": [\n    0,", "\"frames\": [\n    1,", 1))
        .unwrap();
    assert!(ends(at, 2, &["merge", "p", "--check"]).1.contains("plan.json is not a plan"));
}
