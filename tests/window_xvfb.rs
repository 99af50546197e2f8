//! A real window on a display of its own, used with mouse and keyboard as a person would.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, reason = "a helper of a test may fail like the test")]

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};
use weekender::output::read_description;

const PATIENCE: Duration = Duration::from_secs(60);

/// A display that goes away with this.
struct Display {
    server: Child,
    name: String,
}

impl Drop for Display {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

impl Display {
    /// `None`, with a message, where the programs for it are missing and need not be there.
    fn start() -> Option<Display> {
        let has = |program: &str| Command::new(program).arg("-version").output().is_ok();
        let missing: Vec<&str> = ["Xvfb", "xdotool"].into_iter().filter(|program| !has(program)).collect();
        if !missing.is_empty() {
            let message = format!("no window was tried: {} is not installed", missing.join(" and "));
            let is_required = std::env::var_os("WEEKENDER_REQUIRE_GPU").is_some_and(|value| value == "1");
            assert!(!is_required, "{message}");
            eprintln!("{message}");
            return None;
        }
        let mut server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", "1280x800x24", "-nolisten", "tcp"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut line = String::new();
        BufReader::new(server.stdout.take().unwrap()).read_line(&mut line).unwrap();
        Some(Display { server, name: format!(":{}", line.trim()) })
    }

    fn weekender(&self, home: &Path) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_weekender"));
        command.env("DISPLAY", &self.name).env_remove("WAYLAND_DISPLAY");
        command.env("HOME", home).env("XDG_DATA_HOME", home.join("data")).current_dir(home);
        command
    }

    fn xdotool(&self, arguments: &[&str]) -> Output {
        let output = Command::new("xdotool").env("DISPLAY", &self.name).args(arguments).output().unwrap();
        std::thread::sleep(Duration::from_millis(150));
        output
    }

    fn key(&self, keys: &str) {
        assert!(self.xdotool(&["key", keys]).status.success(), "{keys}");
    }

    fn type_text(&self, text: &str) {
        assert!(self.xdotool(&["type", "--delay", "4", text]).status.success(), "{text}");
    }

    fn wait_for_window(&self, child: &mut Child) -> String {
        let begin = Instant::now();
        loop {
            let found = self.xdotool(&["search", "--onlyvisible", "--name", "Weekender"]);
            let text = String::from_utf8_lossy(&found.stdout).into_owned();
            if let Some(id) = text.lines().last() {
                return id.to_owned();
            }
            if let Some(status) = child.try_wait().unwrap() {
                panic!("it ended before there was a window: {status}");
            }
            assert!(begin.elapsed() < PATIENCE, "no window came");
            std::thread::sleep(Duration::from_millis(100));
        }
    }
}

fn wait_for_end(child: &mut Child) -> std::process::ExitStatus {
    let begin = Instant::now();
    loop {
        if let Some(status) = child.try_wait().unwrap() {
            return status;
        }
        if begin.elapsed() > PATIENCE {
            let _ = child.kill();
            panic!("it did not end");
        }
        std::thread::sleep(Duration::from_millis(50));
    }
}

fn wait_for_file(path: &Path) {
    let begin = Instant::now();
    while !path.exists() {
        assert!(begin.elapsed() < PATIENCE, "{} was not written", path.display());
        std::thread::sleep(Duration::from_millis(50));
    }
}

fn pixels(path: &Path) -> (u32, u32, Vec<u8>) {
    let picture = image::open(path).unwrap().to_rgb8();
    (picture.width(), picture.height(), picture.into_raw())
}

#[test]
fn a_person_can_use_the_window() {
    let Some(display) = Display::start() else { return };
    let home = tempfile::tempdir().unwrap();
    let mut child = display
        .weekender(home.path())
        .args(["--stage", "glass-refract", "--size", "240x135"])
        .spawn()
        .unwrap();
    let id = display.wait_for_window(&mut child);
    std::thread::sleep(Duration::from_secs(2));
    display.xdotool(&["windowfocus", "--sync", &id]);

    // Switch the device and back, change the stage, drag.
    display.key("g");
    std::thread::sleep(Duration::from_millis(600));
    display.key("g");
    display.key("Next");
    display.key("Next");
    display.xdotool(&["mousemove", "620", "420"]);
    display.xdotool(&["mousedown", "1"]);
    for _ in 0..8 {
        display.xdotool(&["mousemove_relative", "--", "6", "-3"]);
    }
    display.xdotool(&["mouseup", "1"]);
    std::thread::sleep(Duration::from_secs(2));

    // Save.
    let saved = home.path().join("saved.png");
    display.key("ctrl+s");
    std::thread::sleep(Duration::from_millis(500));
    display.key("ctrl+a");
    display.type_text(saved.to_str().unwrap());
    display.key("Return");
    wait_for_file(&saved);
    display.key("ctrl+q");
    let status = wait_for_end(&mut child);
    assert_eq!(status.code(), Some(0), "{status}");

    // What was saved is what its own recipe gives without a window.
    let description = read_description(&saved).unwrap();
    assert_eq!(description.get("Stage"), Some("glass-schlick"), "two stages on");
    let scene = home.path().join("scene.toml");
    std::fs::write(&scene, description.recipe()).unwrap();
    assert!(!description.recipe().contains("look_from = [0.0, 0.0, 0.0]"), "the drag moved nothing");
    let again = home.path().join("again.png");
    let samples = description.get("Samples").unwrap();
    let batch = display
        .weekender(home.path())
        .args(["--batch", "--device", "cpu", "--samples", samples])
        .arg("--scene")
        .arg(&scene)
        .arg("--out")
        .arg(&again)
        .output()
        .unwrap();
    assert!(batch.status.success(), "{}", String::from_utf8_lossy(&batch.stderr));
    let is_cpu = description.get("Backend").is_some_and(|backend| backend.starts_with("cpu"));
    if is_cpu {
        assert!(pixels(&saved) == pixels(&again), "the saved picture differs from the batch's");
    }
}

#[test]
fn without_a_display_the_message_names_the_way_out() {
    let home = tempfile::tempdir().unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_weekender"))
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("WAYLAND_SOCKET")
        .env("HOME", home.path())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(told.contains("no display") && told.contains("--batch"), "{told}");

    let output = Command::new(env!("CARGO_BIN_EXE_weekender"))
        .env("DISPLAY", ":4711")
        .env_remove("WAYLAND_DISPLAY")
        .env("HOME", home.path())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2), "a display that does not answer");
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(told.contains("--batch"), "{told}");
}
