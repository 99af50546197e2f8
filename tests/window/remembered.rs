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
