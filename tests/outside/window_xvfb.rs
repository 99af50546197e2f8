//! A real window on its own X display, used with mouse and keyboard as a person would.
#![cfg(target_os = "linux")]

use crate::common::program::{PATIENCE, PROGRAM, film, outcome, signal, until, wait};
use crate::common::skip::{report_untested, skip};
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};
use weekender::app::Device;
use weekender::job::output::read_description;
use weekender::stages::Stage;

/// Whether these programs are available. If not, prints so, and fails if they are required.
fn are_there(programs: &[&str], consequence: &str) -> bool {
    let is_missing = |program: &&&str| Command::new(program).arg("-version").output().is_err();
    let missing: Vec<&str> = programs.iter().filter(is_missing).copied().collect();
    if missing.is_empty() {
        return true;
    }
    skip("GPU", &format!("{consequence}: missing: {}", missing.join(", ")));
    false
}

/// An X display that ends when it is dropped.
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
    /// A display whose server has these arguments, too. `None`, with a message, if programs for it are missing and not
    /// required.
    fn start(arguments: &[&str]) -> Option<Display> {
        if !are_there(&["Xvfb", "xdotool"], "no window was tried") {
            return None;
        }
        let mut server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", "1280x800x24", "-nolisten", "tcp", "-noreset"])
            .args(arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut line = String::new();
        BufReader::new(server.stdout.take().unwrap()).read_line(&mut line).unwrap();
        Some(Display { server, name: format!(":{}", line.trim()) })
    }

    fn weekender(&self, home: &Path) -> Command {
        let mut command = Command::new(PROGRAM);
        command.env("DISPLAY", &self.name).env_remove("WAYLAND_DISPLAY");
        command.env("HOME", home).env("XDG_DATA_HOME", home.join("data")).current_dir(home);
        command.env("XDG_STATE_HOME", home.join("state"));
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

    /// Waits until the title of a window contains this text.
    fn wait_for_title(&self, id: &str, text: &str) {
        let title = || self.xdotool(&["getwindowname", id]).stdout;
        until(text, || String::from_utf8_lossy(&title()).contains(text));
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

fn pixels(path: &Path) -> (u32, u32, Vec<u8>) {
    let picture = image::open(path).unwrap().to_rgb8();
    (picture.width(), picture.height(), picture.into_raw())
}

/// Saves a picture with the keyboard.
fn save(display: &Display, path: &Path) {
    display.key("ctrl+s");
    std::thread::sleep(Duration::from_millis(500));
    display.key("ctrl+a");
    display.type_text(path.to_str().unwrap());
    display.key("Return");
    until("no file", || path.exists());
}

#[test]
fn a_person_can_use_the_window() {
    let Some(display) = Display::start(&[]) else { return };
    let home = tempfile::tempdir().unwrap();
    let mut child = display
        .weekender(home.path())
        .args(["--stage", "glass-refract", "--size", "240x135", "--samples", "4000000000", "--device", "cpu"])
        .spawn()
        .unwrap();
    let id = display.wait_for_window(&mut child);
    display.xdotool(&["windowfocus", "--sync", &id]);

    // Switch the device: it traces into the same film.
    display.key("g");
    match Device::Gpu.unavailable() {
        Some(reason) => report_untested(&format!("the device was not switched: {reason}")),
        None => {
            let paths = (0..).map(|number| home.path().join(format!("{number}.png")));
            let is_by_gpu = |path: &PathBuf| {
                save(&display, path);
                read_description(path).unwrap().get("Backend").unwrap().contains("gpu")
            };
            assert!(paths.take(20).any(|path| is_by_gpu(&path)), "the GPU has traced nothing");
            display.key("g");
        }
    }

    // Change the stage, drag, and wait for the resulting picture.
    display.key("Next");
    display.key("Next");
    display.wait_for_title(&id, Stage::find("glass-schlick").unwrap().title);
    display.xdotool(&["mousemove", "620", "420"]);
    display.xdotool(&["mousedown", "1"]);
    for _ in 0..8 {
        display.xdotool(&["mousemove_relative", "--", "6", "-3"]);
    }
    display.xdotool(&["mouseup", "1"]);
    display.wait_for_title(&id, "changed");
    std::thread::sleep(Duration::from_secs(1));

    // Saved during a pause.
    display.key("space");
    std::thread::sleep(Duration::from_millis(500));
    let saved = home.path().join("saved.png");
    save(&display, &saved);
    display.key("ctrl+q");
    let status = wait(&mut child);
    assert_eq!(status.code(), Some(0), "{status}");

    // Rendering the saved recipe without a window gives the same picture.
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
    assert!(description.get("Backend").unwrap().starts_with("cpu"), "{:?}", description.get("Backend"));
    assert!(pixels(&saved) == pixels(&again), "the saved picture differs from the batch's");
}

/// The films that windows have kept.
fn films(home: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(home.join("state/weekender/films")).into_iter().flatten();
    let paths = entries.map(|entry| entry.unwrap().path());
    paths.filter(|path| path.extension().is_some_and(|ending| ending == "exr")).collect()
}

#[test]
fn a_killed_window_loses_little_and_a_terminated_one_nothing() {
    let Some(display) = Display::start(&[]) else { return };
    let home = tempfile::tempdir().unwrap();
    let samples_in = |path: &Path| film(path).sample_count();
    let stage = ["--stage", "glass-refract", "--size", "240x135", "--samples", "4000000000"];
    let often = ["--device", "cpu", "--autosave-every", "0.5s"];
    let mut first = display.weekender(home.path()).args(stage).args(often).spawn().unwrap();
    until("no film", || !films(home.path()).is_empty());
    first.kill().unwrap();
    first.wait().unwrap();
    let kept = films(home.path()).remove(0);
    let samples = samples_in(&kept);

    // A window with another picture leaves it alone.
    let other = ["--stage", "metal", "--size", "32x18"];
    let mut second = display.weekender(home.path()).args(other).args(often).spawn().unwrap();
    display.wait_for_window(&mut second);
    std::thread::sleep(Duration::from_secs(6));
    assert_eq!(samples_in(&kept), samples);
    second.kill().unwrap();
    second.wait().unwrap();

    // A window that is terminated saves its film, and the next one continues it.
    let resume = home.path().join("resumed.exr");
    std::fs::copy(&kept, &resume).unwrap();
    let goes_on = ["--resume", resume.to_str().unwrap(), "--samples", "4000000000"];
    let mut before = samples;
    for flags in [&goes_on[..], &[]] {
        let mut next = display.weekender(home.path()).args(flags).args(often).spawn().unwrap();
        display.wait_for_window(&mut next);
        std::thread::sleep(Duration::from_secs(4));
        signal(&next, "TERM");
        assert_eq!(wait(&mut next).code(), Some(143));
        let after = samples_in(&kept);
        assert!(after > before, "{after} after {before}");
        before = after;
    }

    // It has the bits of an uninterrupted render.
    let count = samples_in(&kept).to_string();
    let whole = home.path().join("whole.exr");
    let batch =
        [&stage[..4], &["--batch", "--device", "cpu", "--samples", &count, "--out", "whole.exr"]].concat();
    let output = display.weekender(home.path()).args(batch).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(film(&kept) == film(&whole));
}

#[test]
fn without_a_display_the_message_names_the_way_out() {
    let home = tempfile::tempdir().unwrap();
    let told = |display: Option<&str>| {
        let mut command = Command::new(PROGRAM);
        for name in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
            command.env_remove(name);
        }
        command.env("HOME", home.path()).envs(display.map(|display| ("DISPLAY", display)));
        let (code, _, told) = outcome(&command.output().unwrap());
        assert!(code == Some(2) && told.contains("--batch"), "{told}");
        told
    };
    assert!(told(None).contains("no display"));
    // A system without a display may lack its libraries, too.
    let told = told(Some(":4711"));
    assert!(told.contains(":4711 does not answer") || told.contains("a window needs lib"), "{told}");
}

/// As with `ssh -X`, and with a factor that no window fits.
#[test]
fn unusable_display_is_refused_with_a_message() {
    let home = tempfile::tempdir().unwrap();
    let Some(display) = Display::start(&["-extension", "RANDR"]) else { return };
    let refused = |command: &mut Command| {
        let output = command.output().unwrap();
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{told}");
        assert!(told.contains("--batch") || told.contains("set it to"), "{told}");
        assert!(!told.contains("report it") && told.lines().count() == 1, "{told}");
        told
    };
    let told = refused(display.weekender(home.path()).arg("--fresh"));
    assert!(told.contains(&display.name), "{told}");
    for factor in ["100", "0", "1e-9", "nan"] {
        let told =
            refused(display.weekender(home.path()).arg("--fresh").env("WINIT_X11_SCALE_FACTOR", factor));
        assert!(told.contains("WINIT_X11_SCALE_FACTOR"), "{told}");
    }
}
