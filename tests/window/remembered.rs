//! Settings that are kept from one run to the next.

use crate::common::{SMALL, open, send};
use weekender::app::{Command, Device, Theme, Window};
use weekender::cli::{self, Request};

/// What eframe stores in a file.
#[derive(Default)]
pub struct Storage(std::collections::HashMap<String, String>);

impl eframe::Storage for Storage {
    fn get_string(&self, key: &str) -> Option<String> {
        self.0.get(key).cloned()
    }

    fn set_string(&mut self, key: &str, value: String) {
        self.0.insert(key.to_owned(), value);
    }

    fn remove_string(&mut self, key: &str) {
        self.0.remove(key);
    }

    fn flush(&mut self) {}
}

#[test]
fn settings_are_remembered() {
    let options = |arguments: &str| match cli::parse(arguments.split_whitespace().map(Into::into)).unwrap() {
        Request::Window(options) => *options,
        other => panic!("{other:?}"),
    };
    let mut harness = open(SMALL);
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
    let mut storage = Storage::default();
    eframe::App::save(harness.state_mut(), &mut storage);
    let kept = harness.state_mut().remembered_mut().clone();
    let names: Vec<&str> = storage.0.keys().map(String::as_str).collect();
    assert!(!names.contains(&"window"), "the window's place and size would be lost: {names:?}");

    let mut again = Window::new(options("weekender --stage metal"), Some(&storage)).unwrap();
    assert_eq!(*again.remembered_mut(), kept);
    assert_eq!((kept.theme, kept.has_plot, kept.has_info), (Theme::Light, true, false));
    assert_eq!((kept.device, kept.bookmarks.len(), kept.threads), (Device::Reference, 1, Some(1)));
    // The command line overrides remembered settings.
    let mut told = Window::new(options("weekender --stage metal --device cpu"), Some(&storage)).unwrap();
    assert_eq!(told.remembered_mut().device, Device::Cpu);
    // Settings that cannot be read are ignored.
    storage.0.values_mut().for_each(|value| *value = "(theme: Purple)".to_owned());
    let mut fresh = Window::new(options("weekender --stage metal"), Some(&storage)).unwrap();
    assert_eq!(fresh.remembered_mut().theme, Theme::System);
}
