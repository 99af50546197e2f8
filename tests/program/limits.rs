//! Files that are damaged or claim more than they contain are refused with exit code 2 and the reason: no panic, no abort,
//! no hang.
#![cfg(target_os = "linux")]

use crate::common::program::{PROGRAM, refused, succeeds, text};
use std::fs;
use std::path::Path;
use std::process::Command;
use tempfile::TempDir;

/// Exit code (`None` after a signal) and messages of a run with at most `kilobytes` of address space.
fn limited(kilobytes: u64, arguments: &[&str], directory: &Path) -> (Option<i32>, String) {
    let script = format!("ulimit -v {kilobytes}; exec timeout 60 \"$0\" \"$@\"");
    let mut command = Command::new("sh");
    command.args(["-c", &script, PROGRAM]).args(arguments).current_dir(directory);
    let output = command.env("RAYON_NUM_THREADS", "2").output().unwrap();
    (output.status.code(), text(&[output.stdout, output.stderr].concat()))
}

fn render(directory: &Path, arguments: &[&str]) {
    let usual = ["--batch", "--device", "cpu", "--progress", "off"];
    succeeds(directory, &[&usual[..], arguments].concat());
}

#[test]
fn a_damaged_film_is_refused_by_all_that_read_films() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    render(at, &["--size", "16x9", "--samples", "4", "--out", "good.exr"]);
    render(at, &["--size", "16x9", "--sample-range", "8..9", "--out", "other.exr"]);
    let mut bytes = fs::read(at.join("good.exr")).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 4;
    fs::write(at.join("bad.exr"), bytes).unwrap();
    let ways: [&[&str]; 4] = [
        &["compare", "bad.exr", "good.exr"],
        &["compare", "good.exr", "bad.exr"],
        &["merge", "other.exr", "bad.exr", "--out", "sum.exr"],
        &["--batch", "--resume", "bad.exr", "--samples", "6", "--out", "more.exr"],
    ];
    for way in ways {
        refused(at, way, &["bad.exr is damaged", "use an earlier copy"]);
    }
}

#[test]
fn devices_and_directories_are_not_read() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    std::os::unix::fs::symlink("/dev/zero", at.join("endless.exr")).unwrap();
    fs::create_dir(at.join("folder.exr")).unwrap();
    for (name, kind) in
        [("endless.exr", "a device"), ("folder.exr", "a directory"), ("/dev/zero", "a device")]
    {
        let ways: [&[&str]; 3] = [
            &["compare", name, "cpu"],
            &["merge", name, "--out", "sum.exr"],
            &["--batch", "--scene", name, "--out", "a.exr"],
        ];
        for way in ways {
            refused(at, way, &[name, kind, "a file is needed"]);
        }
    }
    refused(at, &["--batch", "--resume", "endless.exr", "--out", "a.exr"], &["endless.exr is a device"]);
}

#[test]
fn a_picture_that_claims_more_than_its_file_holds_is_refused() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    let pixels = "0".repeat(20_000);
    fs::write(at.join("a.ppm"), format!("P6\n16000 16000\n255\n{pixels}")).unwrap();
    fs::write(at.join("b.ppm"), format!("P3\n16000 16000\n255\n{pixels}")).unwrap();
    fs::write(at.join("a.pfm"), format!("PF\n16000 16000\n-1\n{pixels}")).unwrap();
    let mut encoder = png::Encoder::new(fs::File::create(at.join("a.png")).unwrap(), 16_000, 16_000);
    encoder.set_color(png::ColorType::Rgb);
    encoder.write_header().unwrap().write_chunk(png::chunk::IDAT, pixels.as_bytes()).unwrap();
    exr::prelude::write_rgb_file(at.join("small.exr"), 64, 48, |_, _| (0.1_f32, 0.2_f32, 0.3_f32)).unwrap();
    let mut bytes = fs::read(at.join("small.exr")).unwrap();
    let window = b"dataWindow\0box2i\0";
    let place = bytes.windows(window.len()).position(|found| found == window).unwrap() + window.len() + 4;
    for corner in [8, 12] {
        bytes[place + corner..place + corner + 4].copy_from_slice(&15_999_i32.to_le_bytes());
    }
    fs::write(at.join("a.exr"), bytes).unwrap();
    for name in ["a.ppm", "b.ppm", "a.pfm", "a.png", "a.exr"] {
        // With so little memory, an attempt to allocate would fail.
        let (code, message) = limited(900_000, &["compare", name, "small.exr"], at);
        assert!(code == Some(2) && message.contains(name) && message.contains("need"), "{message}");
    }
}

#[test]
fn failing_to_start_threads_is_an_error() {
    let at = TempDir::new().unwrap();
    let many = ["--batch", "--device", "cpu", "--threads", "1024", "--samples", "1", "--size", "16x9"];
    let (code, message) = limited(900_000, &[&many[..], &["--out", "a.png"]].concat(), at.path());
    assert!(matches!(code, Some(1 | 2)), "{code:?}: {message}");
    assert!(message.contains("cannot start 1024 threads") && message.contains("--threads"), "{message}");
    assert!(!message.contains("panicked") && !at.path().join("a.png").exists(), "{message}");
}

/// A group of version 1, as Slurm and Docker use on older systems, with 200 MB. Without the right to make one, nothing is
/// tested.
#[test]
fn the_limit_of_a_control_group_is_never_reached() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    let large = |range: &str, name: &str| {
        render(at, &["--size", "2400x1350", "--sample-range", range, "--out", name]);
    };
    large("0..1", "a.exr");
    large("1..2", "b.exr");
    let own = fs::read_to_string("/proc/self/cgroup").unwrap();
    let own = own.lines().find_map(|line| line.split_once(":memory:")).map_or("", |(_, own)| own);
    let group = format!("/sys/fs/cgroup/memory{own}/weekender-test-{}", std::process::id());
    if fs::create_dir(&group).is_err()
        || fs::write(format!("{group}/memory.limit_in_bytes"), "200000000").is_err()
    {
        return eprintln!("no control group can be made: nothing was tested");
    }
    let batch = ["--batch", "--device", "cpu", "--size", "2400x1350", "--samples", "2", "--out", "c.png"];
    let ways: [&[&str]; 5] = [
        &["merge", "a.exr", "b.exr", "--out", "c.exr"],
        &["compare", "a.exr", "b.exr"],
        &[&batch[..], &["--denoise"]].concat(),
        &["--batch", "--resume", "a.exr", "--size", "2400x1350", "--denoise", "--out", "c.png"],
        &["--batch", "--device", "cpu", "--size", "4096x2304", "--samples", "1", "--out", "c.exr"],
    ];
    for way in ways {
        let mut command = Command::new("sh");
        command.args(["-c", "echo $$ > \"$0\"; exec \"$@\"", &format!("{group}/cgroup.procs"), PROGRAM]);
        let output = command.args(way).current_dir(at).output().unwrap();
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{way:?}: {output:?}");
        assert!(message.contains("control group") && message.len() < 400, "{message}");
    }
    fs::remove_dir(group).unwrap();
}

#[test]
fn the_limit_in_force_is_named() {
    let at = TempDir::new().unwrap();
    for (limit, name) in [("-v", "ulimit -v"), ("-d", "ulimit -d")] {
        let script = format!("ulimit {limit} 900000; exec \"$0\" \"$@\"");
        let mut command = Command::new("sh");
        command.args(["-c", &script, PROGRAM]).current_dir(at.path());
        command.args(["--batch", "--device", "cpu", "--threads", "2", "--samples", "1", "--out", "a.exr"]);
        let output = command.args(["--size", "16384x8192"]).output().unwrap();
        let message = text(&output.stderr);
        assert!(message.contains(name) && !message.contains("is free"), "{limit}: {message}");
    }
}
