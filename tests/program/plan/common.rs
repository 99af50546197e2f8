//! Plans of a small picture.

pub use crate::common::program::{ends, film, json, succeeds};

use crate::common::program::weekender;
use std::path::{Path, PathBuf};
use std::process::Command;
use weekender::film::Film;

/// A small picture. Two threads of the CPU make the same bits everywhere.
pub const PICTURE: [&str; 6] = ["--size", "32x18", "--device", "cpu", "--threads", "2"];

pub fn command(at: &Path, arguments: &[&str]) -> Command {
    let mut command = weekender(at, arguments);
    command.env_remove("SLURM_ARRAY_TASK_ID").env_remove("JOB_COMPLETION_INDEX");
    command
}

/// Plans the small picture with these flags into `directory`. Returns standard output.
pub fn plan(at: &Path, directory: &str, flags: &[&str]) -> String {
    succeeds(at, &[&["plan"], &PICTURE[..], &["--out", directory], flags].concat())
}

/// The film of one run with the samples `range`.
pub fn whole(at: &Path, range: &str, flags: &[&str]) -> Film {
    let common = ["--sample-range", range, "--progress", "off", "--out", "one-run.exr"];
    succeeds(at, &[&["--batch"], &PICTURE[..], &common, flags].concat());
    film(&at.join("one-run.exr"))
}

pub fn render_part(at: &Path, plan: &str, part: u32) -> String {
    succeeds(at, &["render-part", plan, "--part", &part.to_string(), "--device", "cpu"])
}

/// Changes a byte in the middle of a film's sums.
pub fn damage(path: &Path) {
    let mut bytes = std::fs::read(path).unwrap();
    let middle = bytes.len() * 2 / 3;
    bytes[middle] ^= 0x10;
    std::fs::write(path, bytes).unwrap();
}

pub fn part_path(at: &Path, plan: &str, part: u32) -> PathBuf {
    at.join(plan).join(format!("part-{part}.exr"))
}
