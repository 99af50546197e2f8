//! Standard input and output, and pipes.

use crate::common::program::text;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output, Stdio};

fn weekender(directory: &Path, arguments: &str, input: &[u8]) -> Output {
    let mut command = crate::common::program::weekender(directory, &arguments.split(' ').collect::<Vec<_>>());
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let mut stdin = child.stdin.take().unwrap();
    let input = input.to_vec();
    let writer = std::thread::spawn(move || drop(stdin.write_all(&input)));
    let output = child.wait_with_output().unwrap();
    writer.join().unwrap();
    output
}

#[test]
fn pictures_and_scenes_go_through_pipes() {
    let at = tempfile::tempdir().unwrap();
    let at = at.path();
    let render = "--batch --device cpu --size 48x27 --samples 16 --out";
    let scene = weekender(at, "--save-scene - --scene metals", b"");
    assert!(scene.status.success() && text(&scene.stdout).contains("[camera]"), "{}", text(&scene.stderr));
    for (format, start) in
        [("png", &b"\x89PNG"[..]), ("ppm", b"P6"), ("exr", b"v/1\x01"), ("pfm", b"PF\n48 27\n-1.0\n")]
    {
        let name = format!("a.{format}");
        let piped = weekender(at, &format!("{render} - --format {format} --scene -"), &scene.stdout);
        assert!(
            piped.status.success() && piped.stdout.starts_with(start),
            "{format}: {}",
            text(&piped.stderr)
        );
        assert!(text(&piped.stderr).contains("16"), "{}", text(&piped.stderr));
        std::fs::write(at.join("scene.toml"), &scene.stdout).unwrap();
        let file = weekender(at, &format!("{render} {name} --scene scene.toml"), b"");
        assert!(file.status.success(), "{}", text(&file.stderr));
        let compared = weekender(at, &format!("compare - {name}"), &piped.stdout);
        assert!(
            text(&compared.stdout).contains("equal to the bit"),
            "{format}: {}{}",
            text(&compared.stdout),
            text(&compared.stderr)
        );
    }
    // A film through a pipe keeps its sums beside a denoised layer.
    let piped = weekender(at, &format!("{render} - --format exr --scene metals --denoise"), b"");
    std::fs::write(at.join("denoised.exr"), &piped.stdout).unwrap();
    for (side, said) in
        [("denoised.exr", "equal to the bit"), ("denoised.exr:denoised", "picture, 48x27, floats")]
    {
        let compared = weekender(at, &format!("compare {side} a.exr"), b"");
        assert!(
            text(&compared.stdout).contains(said),
            "{}{}",
            text(&compared.stdout),
            text(&compared.stderr)
        );
    }
    let film = std::fs::read(at.join("a.exr")).unwrap();
    assert!(text(&weekender(at, "info -", &film).stdout).contains("16 per pixel"));
    for (arguments, part) in [
        ("--batch --out -", "--format"),
        ("--batch --out - --format png --json -", "both write to standard output"),
        ("--batch --out a.png --format exr", "contradicts"),
    ] {
        let refused = weekender(at, arguments, b"");
        assert_eq!((refused.status.code(), refused.stdout.len()), (Some(2), 0), "{arguments}");
        assert!(text(&refused.stderr).contains(part), "{}", text(&refused.stderr));
    }
}

#[test]
fn check_reads_standard_input_and_fifos() {
    let at = tempfile::tempdir().unwrap();
    let at = at.path();
    let picture = weekender(
        at,
        "--batch --device cpu --stage metal --size 64x36 --samples 16 --out - --format ppm",
        b"",
    );
    let found = weekender(at, "check - --stage metal", &picture.stdout);
    assert_eq!(found.status.code(), Some(0), "{}{}", text(&found.stdout), text(&found.stderr));
    #[cfg(unix)]
    {
        std::fs::write(at.join("a.ppm"), &picture.stdout).unwrap();
        let line = format!("{} check <(cat a.ppm) --stage metal", crate::common::program::PROGRAM);
        let found = Command::new("bash").args(["-c", &line]).current_dir(at).output().unwrap();
        assert_eq!(found.status.code(), Some(0), "{}", text(&found.stderr));
    }
}

/// A read-only system without a directory for temporary files, as containers are.
#[cfg(target_os = "linux")]
#[test]
fn streams_need_no_temporary_directory() {
    let at = tempfile::tempdir().unwrap();
    let at = at.path();
    let run = |line: &str| {
        let line = line.replace("weekender", crate::common::program::PROGRAM);
        let output =
            Command::new("bash").args(["-c", &line]).current_dir(at).env("TMPDIR", "/nowhere").output();
        output.unwrap()
    };
    for format in ["png", "ppm", "exr", "pfm"] {
        let render = "weekender --batch --device cpu --stage metal --size 64x36 --samples 16 --out -";
        let rendered = run(&format!("{render} --format {format} > a.{format}"));
        assert_eq!(rendered.status.code(), Some(0), "{format}: {}", text(&rendered.stderr));
    }
    for line in [
        "weekender check - < a.ppm",
        "weekender compare - a.exr < a.exr",
        "weekender compare <(cat a.exr) a.exr",
        "weekender info - < a.png",
    ] {
        let found = run(line);
        assert_eq!(found.status.code(), Some(0), "{line}: {}{}", text(&found.stdout), text(&found.stderr));
    }
    let closed = run(
        "weekender --batch --device cpu --stage metal --size 64x36 --samples 1 --out - --format ppm > /dev/full",
    );
    let message = text(&closed.stderr);
    assert!(
        message.contains("cannot write standard output") && !message.contains("directory first"),
        "{message}"
    );
}
