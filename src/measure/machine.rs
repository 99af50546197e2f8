//! The measured machine, and whether it was idle.

use super::table::counted;
use crate::render_cpu::Isa;
use serde::Serialize;
use std::fs;

#[derive(Clone, Debug, Serialize)]
pub struct Machine {
    pub processor: String,
    /// Number of threads that the system can run at once.
    pub cores: usize,
    /// Instruction levels, the most capable last.
    pub levels: Vec<&'static str>,
    /// System load at the start, averaged over a minute; `None` if unknown.
    pub load_at_start: Option<f64>,
}

impl Machine {
    pub fn look() -> Self {
        Machine {
            processor: processor(&fs::read_to_string("/proc/cpuinfo").unwrap_or_default()),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            levels: Isa::available().into_iter().map(Isa::name).collect(),
            load_at_start: fs::read_to_string("/proc/loadavg")
                .ok()
                .and_then(|averages| averages.split_whitespace().next()?.parse().ok()),
        }
    }

    /// One line of text.
    pub fn words(&self) -> String {
        let level = self.levels.last().copied().unwrap_or("no level");
        let load = self.load_at_start.map_or(String::new(), |load| format!(", load {load:.2} at the start"));
        let threads = counted(self.cores, "thread");
        format!("Weekender {}, {}, {threads}, {level}{load}", env!("CARGO_PKG_VERSION"), self.processor)
    }
}

/// Finds the processor's name in `/proc/cpuinfo`.
fn processor(info: &str) -> String {
    let name = info.lines().find_map(|line| line.strip_prefix("model name")?.trim_start().strip_prefix(':'));
    name.map_or_else(
        || format!("unnamed {} processor", std::env::consts::ARCH),
        |name| name.trim().to_owned(),
    )
}
