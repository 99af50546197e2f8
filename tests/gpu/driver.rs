//! The graphics driver stays loaded after the search for adapters, because threads that used it may end later. Tested in a
//! process of its own, because another test's renderer would keep the driver loaded.
#![cfg(target_os = "linux")]

use crate::common::gpu::gpu;
use std::collections::BTreeSet;
use std::process::Command;
use weekender::render_gpu::GpuOptions;

/// The shared libraries mapped into this process.
fn libraries() -> BTreeSet<String> {
    let maps = std::fs::read_to_string("/proc/self/maps").unwrap();
    let files = maps.lines().filter_map(|line| line.split_whitespace().nth(5));
    files.filter(|file| file.contains(".so")).map(str::to_owned).collect()
}

#[test]
fn driver_stays_loaded() {
    let mut own = Command::new(std::env::current_exe().unwrap());
    own.args(["--exact", "driver::in_its_own_process", "--ignored", "--nocapture"]);
    assert!(own.status().unwrap().success());
}

#[test]
#[ignore = "driver_stays_loaded runs it"]
fn in_its_own_process() {
    let before = libraries();
    let Some(gpu) = gpu(GpuOptions::default()) else { return };
    let while_open = libraries();
    assert!(while_open.len() > before.len(), "no library was loaded: {while_open:?}");
    drop(gpu);
    let unloaded: Vec<_> = while_open.difference(&libraries()).cloned().collect();
    assert!(unloaded.is_empty(), "{unloaded:?} were unloaded with the renderer");
}
