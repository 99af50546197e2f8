//! Settings that are kept from one run to the next.

use crate::common::{SMALL, opened, send, until};
use eframe::App;
use egui_kittest::Harness;
use std::fs;
use std::path::Path;
use weekender::app::{Command, Device, Theme, Window};
use weekender::cli::{self, Request, WindowOptions};

/// A window that has its settings in this file.
pub fn remembering(arguments: &str, settings: &Path) -> Harness<'static, Window> {
    let words = std::iter::once("weekender").chain(arguments.split_whitespace());
    let Request::Window(options) = cli::parse(words.map(Into::into)).unwrap() else { panic!("no window") };
    opened(Window::new(WindowOptions { settings: Some(settings.to_owned()), ..*options }).unwrap())
}

#[test]
fn settings_are_remembered() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("settings.json");
    let mut harness = remembering(SMALL, &path);
    for command in [
        Command::Theme(Theme::Light),
        Command::Plot,
        Command::Info,
        Command::Device(Device::Reference),
        Command::AddBookmark,
    ] {
        send(&mut harness, command);
    }
    harness.state_mut().remembered_mut().threads = Some(1);
    let kept = harness.state_mut().remembered_mut().clone();
    harness.state_mut().on_exit(None);
    drop(harness);

    let mut again = remembering("--stage metal", &path);
    assert_eq!(*again.state_mut().remembered_mut(), kept);
    assert_eq!((kept.theme, kept.has_plot, kept.has_info), (Theme::Light, true, false));
    assert_eq!((kept.device, kept.bookmarks.len(), kept.threads), (Device::Reference, 1, Some(1)));
    // The command line overrides remembered settings.
    let mut told = remembering("--stage metal --device cpu", &path);
    assert_eq!(told.state_mut().remembered_mut().device, Device::Cpu);
}

#[test]
fn settings_are_written_soon_and_by_several_windows() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("settings.json");
    let mut first = remembering("--stage metal --size 16x9", &path);
    until(&mut first, "the settings are written", |_| path.exists());
    let mut second = remembering("--stage glass-schlick --size 16x9", &path);
    send(&mut first, Command::AddBookmark);
    until(&mut first, "the bookmark is written", |_| {
        fs::read_to_string(&path).unwrap().contains("10.5 view 1")
    });
    send(&mut second, Command::AddBookmark);
    for harness in [&mut second, &mut first] {
        harness.state_mut().on_exit(None);
    }
    let mut third = remembering("--stage metal --size 16x9", &path);
    let names: Vec<String> =
        third.state_mut().remembered_mut().bookmarks.iter().map(|bookmark| bookmark.name.clone()).collect();
    assert_eq!(names, ["11.4 view 1", "10.5 view 1"]);
}

#[test]
fn settings_that_cannot_be_read_or_written_are_told_of() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("settings.json");
    fs::write(&path, "damaged").unwrap();
    let harness = remembering("--stage metal --size 16x9", &path);
    let told = harness.state().messages().pop().unwrap();
    assert!(told.starts_with("The settings start anew: ") && told.ends_with(".damaged-1"), "{told}");
    let path = directory.path().join("directory.json");
    fs::create_dir(&path).unwrap();
    let mut harness = remembering("--stage metal --size 16x9", &path);
    let told = harness.state().messages().pop().unwrap();
    assert!(told.starts_with("The usual settings are used: cannot read "), "{told}");
    send(&mut harness, Command::Plot);
    until(&mut harness, "it is told", |window| {
        window.messages().iter().any(|told| told.starts_with("The settings are not kept: cannot read "))
    });
}
