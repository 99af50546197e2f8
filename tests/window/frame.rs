//! Frames as eframe asks for them: their log, and the size of a new window.

use crate::common::{SMALL, has_samples, open_sized, send, until, window};
use eframe::egui::{Pos2, Rect, Vec2, ViewportCommand, ViewportId, pos2, vec2};
use eframe::{App, Frame};
use egui_kittest::Harness;
use std::path::Path;
use weekender::app::{Command, Window};

/// A window that logs its frames, drawn as eframe does.
fn logging(path: &Path, arguments: &str) -> Harness<'static, Window> {
    let window = window(&format!("{arguments} --device cpu --frame-log {}", path.display()));
    Harness::builder()
        .with_size([1280.0, 800.0])
        .with_step_dt(1.0 / 60.0)
        .build_ui_state(|ui, window: &mut Window| App::ui(window, ui, &mut Frame::_new_kittest()), window)
}

/// The complete lines of a kind, without the kind.
fn lines(path: &Path, kind: &str) -> Vec<Vec<String>> {
    let text = std::fs::read_to_string(path).unwrap();
    let whole = text.rfind('\n').map_or("", |end| &text[..end]);
    let fields = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
    whole.lines().map(fields).filter(|line| line[0] == kind).map(|line| line[1..].to_vec()).collect()
}

#[test]
fn frames_commands_renders_and_changes_are_logged() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("log.csv");
    let mut harness = logging(&path, "--stage glass-schlick --size 32x18 --samples 4000000000");
    until(&mut harness, "samples", has_samples(1));
    let first = harness.state().status().run;
    harness.state_mut().document_mut().camera.vfov_degrees = 33.0;
    until(&mut harness, "the changed picture", |window| {
        window.status().run > first && has_samples(1)(window)
    });
    let last = harness.state().status().run;
    send(&mut harness, Command::Pause);
    // The rest of the log is written at the end.
    drop(harness);
    let commands = lines(&path, "command");
    assert_eq!(commands.len(), 1, "{commands:?}");
    assert_eq!(commands[0][1], Command::Pause.name());
    let tracings = lines(&path, "tracing");
    for run in [first, last] {
        let of_run = tracings.iter().filter(|line| line[1..] == [run.to_string(), "cpu".to_owned()]);
        assert_eq!(of_run.count(), 1, "{tracings:?}");
    }
    assert!(!lines(&path, "latency").is_empty());
    let frames = lines(&path, "frame");
    assert!(frames.len() > 2, "{frames:?}");
    for line in &frames {
        let [_, _, _, ui, picture] = &line[..] else { panic!("{line:?}") };
        let [ui, picture] = [ui, picture].map(|milliseconds| milliseconds.parse::<f64>().unwrap());
        assert!(ui > 0.0 && picture <= ui, "{line:?}");
    }
}

#[test]
fn a_backend_is_logged_when_it_has_added_samples() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("log.csv");
    let mut harness = logging(&path, "--stage glass-schlick --size 640x360 --samples 1");
    until(&mut harness, "the end", |window| {
        let status = window.status();
        let is_logged = lines(&path, "tracing").iter().any(|line| line[1] == status.run.to_string());
        assert!(status.samples_per_pixel > 0 || !is_logged, "{status:?}");
        is_logged && status.phase.is_over() && has_samples(1)(window)
    });
}

/// The sizes of the window that the last frame asked for.
fn sizes(harness: &Harness<'_, Window>) -> Vec<Vec2> {
    let commands = &harness.output().viewport_output[&ViewportId::ROOT].commands;
    let size = |command: &ViewportCommand| match command {
        ViewportCommand::InnerSize(size) => Some(*size),
        _ => None,
    };
    commands.iter().filter_map(size).collect()
}

#[test]
fn a_new_window_that_is_larger_than_its_screen_is_made_smaller_once() {
    let mut harness = open_sized(SMALL, [1280.0, 800.0]);
    assert!(sizes(&harness).is_empty(), "its screen is not known yet");
    let viewport = harness.input_mut().viewports.get_mut(&ViewportId::ROOT).unwrap();
    viewport.inner_rect = Some(Rect::from_min_size(pos2(1.0, 20.0), vec2(1280.0, 800.0)));
    viewport.outer_rect = Some(Rect::from_min_size(Pos2::ZERO, vec2(1282.0, 821.0)));
    viewport.monitor_size = Some(vec2(1280.0, 800.0));
    harness.step();
    assert_eq!(sizes(&harness), [vec2(1278.0, 779.0)]);
    harness.step();
    assert!(sizes(&harness).is_empty(), "it may stay as large as its user makes it");
}
