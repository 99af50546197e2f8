//! The check on the page, in Chromium: pictures that are dropped on it get the verdict of this program.

use super::{PAGE, driver, program, quick, skip};
use crate::write;
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::SystemTime;
use weekender::system::interrupt::Interrupt;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");

fn run(directory: &Path, arguments: &[&str]) -> Output {
    Command::new(program()).current_dir(directory).env_remove("DISPLAY").args(arguments).output().unwrap()
}

/// Modification time of the newest file below a path.
fn changed(path: &Path) -> SystemTime {
    let own = path.metadata().unwrap().modified().unwrap();
    let inside = path.read_dir().into_iter().flatten();
    inside.map(|entry| changed(&entry.unwrap().path())).fold(own, SystemTime::max)
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in from.read_dir().unwrap() {
        let (source, target) = (entry.as_ref().unwrap().path(), to.join(entry.unwrap().file_name()));
        if source.is_dir() { copy(&source, &target) } else { _ = fs::copy(&source, &target).unwrap() }
    }
}

/// Makes `check.js`, which takes minutes the first time, where a browser is required; elsewhere, says why it cannot be
/// used.
fn obstacle() -> Option<String> {
    let script = Path::new(ROOT).join("target/cross/check.js");
    let builder = "assets/package/cross.sh";
    let targets = Command::new("rustup").args(["target", "list", "--installed"]).output();
    let can_build =
        targets.is_ok_and(|output| String::from_utf8_lossy(&output.stdout).contains("wasm32-wasip1"));
    if can_build && std::env::var("WEEKENDER_REQUIRE_BROWSER").as_deref() == Ok("1") {
        let output = Command::new("nice").arg(Path::new(ROOT).join(builder)).arg("web").output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        return None;
    }
    let sources =
        ["src", "assets/web/program.js", "Cargo.toml", "Cargo.lock"].map(|path| Path::new(ROOT).join(path));
    let is_new = script.exists() && sources.iter().all(|source| changed(source) <= changed(&script));
    (!is_new).then(|| format!("{} is missing or old: {builder} web builds it", script.display()))
}

/// Pictures: a right one, one with a mistake, one that is not a picture, one with too many pixels.
fn pictures(directory: &Path) -> Vec<PathBuf> {
    // Its name looks like a flag.
    run(directory, &["--batch", "--stage", "ppm-gradient", "--size", "64x36", "--out", "./-mine.ppm"]);
    let mistaken = Path::new(ROOT).join("tests/program/check/cases/half-bright.png");
    fs::copy(mistaken, directory.join("half.png")).unwrap();
    fs::write(directory.join("notes.txt"), "no picture").unwrap();
    let large = [b"P6 2500 1601 255\n".as_slice(), &vec![9; 3 * 2500 * 1601]].concat();
    fs::write(directory.join("large.ppm"), large).unwrap();
    ["-mine.ppm", "half.png", "notes.txt", "large.ppm"].map(|name| directory.join(name)).to_vec()
}

/// The finding of this program, or its message.
fn native(directory: &Path, name: &str, stage: &[&str]) -> Result<Value, String> {
    let found = directory.join("found.json");
    let _ = fs::remove_file(&found);
    let output = run(directory, &[&["check", "--json", "found.json"], stage, &["--", name]].concat());
    let json = fs::read(&found).map_err(|_| String::from_utf8(output.stderr).unwrap())?;
    Ok(serde_json::from_slice(&json).unwrap())
}

#[test]
fn a_reader_can_check_a_picture() {
    if let Some(reason) = super::obstacle() {
        return skip("BROWSER", &reason);
    }
    if let Some(reason) = obstacle() {
        return skip("WEB", &reason);
    }
    let directory = tempfile::tempdir().unwrap();
    let out = directory.path().join("out");
    copy(PAGE.path(), &out);
    // Now with the program.
    write(&quick(&out, &[]), &Interrupt::unheard()).unwrap();
    let pictures = pictures(directory.path());
    let output = driver("check").arg(&out).args(&pictures).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let seen: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&seen["console"], &seen["faults"]), (&json!([]), &json!([])), "{seen}");
    for name in ["-mine.ppm", "half.png", "notes.txt", "large.ppm"] {
        let answer = &seen["answers"][name];
        match native(directory.path(), name, &[]) {
            Ok(found) => {
                assert_eq!(answer["verdict"], found["verdict"], "{name}");
                assert_eq!(answer["explanation"], format!("{}.", found["explanation"].as_str().unwrap()));
                let size = [&found["width"], &found["height"]];
                assert_eq!(answer["sizes"], json!([size, size, size]), "{name}");
                let change = found["change"].as_str().unwrap_or_default();
                let code: Vec<&str> = change.split('`').skip(1).step_by(2).collect();
                assert_eq!(answer["code"], json!(code), "{name}");
                let links = answer["links"].as_array().unwrap();
                // The section on this page and in the book, and, for a mistake, its picture.
                assert!(links.len() >= 2 || found["read"].is_null(), "{links:?}");
            }
            Err(message) => {
                let reason = message.trim().trim_start_matches("error: ");
                let said = answer["explanation"].as_str().unwrap().trim_end_matches('.');
                // The page has less memory, and says so before it begins.
                if name == "large.ppm" {
                    assert!(said.contains("more pixels") && said.contains("400 x 225"), "{said}");
                    continue;
                }
                assert_eq!(said.to_lowercase(), reason.to_lowercase(), "{name}");
            }
        }
    }
    let [right, chosen] =
        [&[][..], &["--stage", "ppm-gradient"]].map(|stage| native(directory.path(), "-mine.ppm", stage));
    assert_eq!(seen["served"], right.unwrap()["verdict"]);
    assert_eq!(seen["chosen"]["verdict"], chosen.unwrap()["verdict"]);
}
