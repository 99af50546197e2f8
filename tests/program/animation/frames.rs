//! Frames, rendered by the program.

use super::common::{ends, names, render, temp, until, weekender};
use std::fs;
use std::path::Path;
use std::process::Stdio;

/// The bytes of a picture's pixels.
fn pixels(path: &Path) -> Vec<u8> {
    image::open(path).unwrap().into_bytes()
}

const KEYFRAMED: [&str; 2] = ["--scene", "scene.toml"];

#[test]
fn single_frame_matches_its_run() {
    let directory = temp();
    for (name, path) in [("turn", &["--turntable=9"][..]), ("keys", &KEYFRAMED)] {
        let run = |frames: &str, out: &str| {
            render(directory.path(), &[path, &["--frames", frames, "--out", out]].concat())
        };
        let json = run("0..7", name);
        assert_eq!((&json["frames_done"], &json["rendered"]), (&7.into(), &7.into()));
        let found = names(&directory.path().join(name));
        assert_eq!(found, (0..7).map(|frame| format!("frame-{frame:04}.png")).collect::<Vec<_>>());
        let in_run = |frame: u32| pixels(&directory.path().join(format!("{name}/frame-{frame:04}.png")));
        for frame in [3, 6] {
            run(&format!("{frame}..{}", frame + 1), &format!("{name}-alone-#.png"));
            assert!(in_run(frame) == pixels(&directory.path().join(format!("{name}-alone-{frame}.png"))));
        }
        assert!(in_run(3) != in_run(4), "the camera moves");
    }
}

#[test]
fn only_incomplete_frames_are_rendered_again() {
    let directory = temp();
    let run = |more: &[&str]| {
        let json = render(directory.path(), &[&["--turntable=8", "--out", "d"], more].concat());
        [&json["rendered"], &json["kept"]].map(|count| count.as_u64().unwrap())
    };
    let path = |frame: usize| directory.path().join(format!("d/frame-{frame:04}.png"));
    assert_eq!(run(&["--frames", "2..5"]), [3, 0]);
    assert_eq!(run(&[]), [5, 3], "a whole turn by default");
    assert_eq!(run(&[]), [0, 8]);
    let good: Vec<_> = (0..8).map(|frame| fs::read(path(frame)).unwrap()).collect();

    // Truncated, one flipped bit in the pixels, another frame, and not a picture.
    fs::write(path(0), &good[0][..good[0].len() - 20]).unwrap();
    let mut flipped = good[1].clone();
    let data = flipped.windows(4).position(|word| word == b"IDAT").unwrap();
    flipped[data + 40] ^= 1;
    fs::write(path(1), &flipped).unwrap();
    fs::write(path(2), &good[3]).unwrap();
    fs::write(path(4), "nothing").unwrap();
    fs::remove_file(path(5)).unwrap();
    assert_eq!(run(&[]), [5, 3]);
    for frame in [0, 1, 2, 4, 5] {
        let again = image::load_from_memory(&good[frame]).unwrap().into_bytes();
        assert!(pixels(&path(frame)) == again, "frame {frame}");
    }
    // Another picture has other frames.
    assert_eq!(run(&["--samples", "5"]), [8, 0]);
    assert_eq!(run(&["--samples", "5", "--seed", "1"]), [8, 0]);
    assert_eq!(run(&["--samples", "5", "--seed", "1"]), [0, 8]);
}

#[test]
fn frames_are_pictures_like_all_others() {
    use weekender::film::{checkpoint, key};
    let directory = temp();
    let run = |more: &[&str]| {
        let json = render(directory.path(), &[&["--turntable=3"], more].concat());
        [&json["rendered"], &json["kept"]].map(|count| count.as_u64().unwrap())
    };
    let at = |name: &str| directory.path().join(name);
    let denoised = ["--out", "d-#.exr", "--samples", "64", "--denoise"];
    assert_eq!([run(&denoised), run(&denoised)], [[3, 0], [0, 3]]);
    let read = checkpoint::load(&at("d-1.exr")).unwrap();
    assert_eq!(read.film.sample_count(), 64);
    assert!(read.description.get(key::DENOISED).is_some());
    assert_eq!(run(&denoised[..4]), [3, 0], "they were denoised");
    let noise = ["--out", "n-#.png", "--samples", "256", "--noise-target", "0.08"];
    assert_eq!([run(&noise), run(&noise)], [[3, 0], [0, 3]]);
    assert_eq!(run(&[&noise[..5], &["0.09"]].concat()), [3, 0], "another target");
    assert_eq!(run(&["--out", "t-#.png", "--samples", "8", "--time-limit", "60"]), [3, 0]);
    // A PFM does not say how it was made.
    assert_eq!(
        [run(&["--out", "pfm", "--format", "pfm"]), run(&["--out", "pfm", "--format", "pfm"])],
        [[3, 0]; 2]
    );
    assert_eq!(names(&at("pfm")), ["frame-0000.pfm", "frame-0001.pfm", "frame-0002.pfm"]);
}

/// Two runs in one directory, one of which ends early.
#[cfg(unix)]
#[test]
fn runs_in_one_directory_share_the_frames() {
    let directory = temp();
    let flags = ["--batch", "--size", "160x90", "--samples", "64", "--turntable=24", "--out", "d", "--json"];
    let start = |json: &str| {
        let mut command = weekender(directory.path(), &[&flags[..], &[json]].concat());
        command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
    };
    let (mut first, mut second) = (start("first.json"), start("second.json"));
    assert!(first.wait().unwrap().success() && second.wait().unwrap().success());
    let figures = ["first.json", "second.json"]
        .map(|name| crate::common::program::json_file(&directory.path().join(name)));
    let sum = |key: &str| figures.iter().map(|figures| figures[key].as_u64().unwrap()).sum::<u64>();
    assert_eq!((sum("rendered"), sum("kept"), sum("frames_done")), (24, 24, 48));
    // What a killed run has claimed is rendered by the next.
    fs::remove_file(directory.path().join("d/frame-0003.png")).unwrap();
    fs::write(directory.path().join("d/.weekender-frame-0003.png.lock"), "").unwrap();
    assert!(start("third.json").wait().unwrap().success());
    assert_eq!(names(&directory.path().join("d")).len(), 24);
}

#[cfg(unix)]
#[test]
fn interrupted_run_keeps_whole_frames_and_continues() {
    for (signal, code) in [("INT", 130), ("TERM", 143)] {
        let directory = temp();
        let flags = ["--batch", "--size", "160x90", "--samples", "64", "--turntable=400", "--out", "frames"];
        let arguments = [&flags[..], &["--json", "figures.json"]].concat();
        let mut command = weekender(directory.path(), &arguments);
        let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        let frames = directory.path().join("frames");
        let is_frame = |name: &String| name.starts_with("frame-");
        let count = || if frames.is_dir() { names(&frames).into_iter().filter(is_frame).count() } else { 0 };
        until("no frames are written", || count() >= 3);
        crate::common::program::signal(&child, signal);
        assert_eq!(child.wait().unwrap().code(), Some(code));

        let done = count();
        assert!((3..400).contains(&done), "{done} frames");
        assert!(names(&frames).iter().all(|name| name.starts_with("frame-")), "{:?}", names(&frames));
        let figures = crate::common::program::json_file(&directory.path().join("figures.json"));
        assert_eq!(figures["frames_done"], done);

        let range = format!("0..{}", done + 1);
        let again = [&flags[..], &["--frames", &range, "--json", "-"]].concat();
        let json = crate::common::program::json(directory.path(), &again);
        assert_eq!((&json["kept"], &json["rendered"]), (&done.into(), &1.into()));
    }
}

#[test]
fn failed_run_reports_where_and_keeps_its_frames() {
    let directory = temp();
    fs::create_dir_all(directory.path().join("d/frame-0002.png")).unwrap();
    let flags = ["--batch", "--size", "24x14", "--samples", "4", "--turntable=4", "--out", "d"];
    // The second run renders none, but keeps the frames of the first.
    for _ in 0..2 {
        let (_, message) = ends(directory.path(), 3, &flags);
        assert!(message.contains("frame 2"), "{message}");
    }
    assert_eq!(names(&directory.path().join("d")), ["frame-0000.png", "frame-0001.png", "frame-0002.png"]);
}
