//! The machine that is measured, and whether it was idle.

use crate::render_cpu::Isa;
use serde::Serialize;
use std::fs;

/// The machine and the program.
#[derive(Clone, Debug, Serialize)]
pub struct Machine {
    /// Version of the program.
    pub version: &'static str,
    /// Name of the processor.
    pub processor: String,
    /// Number of threads that the system can run at once.
    pub cores: usize,
    /// Instruction levels, the most capable last.
    pub levels: Vec<&'static str>,
    /// System load at the start, averaged over a minute; `None` if the system does not tell.
    pub load_at_start: Option<f64>,
}

/// At a higher system load, the figures are doubtful.
pub const LOAD_LIMIT: f64 = 0.5;

impl Machine {
    /// Describes this machine now.
    pub fn look() -> Self {
        Machine {
            version: env!("CARGO_PKG_VERSION"),
            processor: processor(),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            levels: Isa::available().into_iter().map(Isa::name).collect(),
            load_at_start: load(),
        }
    }

    /// One line of text.
    pub fn words(&self) -> String {
        let level = self.levels.last().copied().unwrap_or("no level");
        let load = self.load_at_start.map_or(String::new(), |load| format!(", load {load:.2} at the start"));
        let threads = counted(self.cores, "thread");
        format!("Weekender {}, {}, {threads}, {level}{load}", self.version, self.processor)
    }
}

fn processor() -> String {
    let info = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = info.lines().find_map(|line| line.strip_prefix("model name")?.trim_start().strip_prefix(':'));
    name.map_or_else(
        || format!("unnamed {} processor", std::env::consts::ARCH),
        |name| name.trim().to_owned(),
    )
}

fn load() -> Option<f64> {
    fs::read_to_string("/proc/loadavg").ok()?.split_whitespace().next()?.parse().ok()
}

/// A number with its noun: `1 lane`, `8 lanes`.
pub fn counted(number: usize, noun: &str) -> String {
    format!("{number} {noun}{}", if number == 1 { "" } else { "s" })
}

/// Peak memory of this process since [`forget_peak_memory`], bytes; `None` if the system does not tell.
pub fn peak_memory() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()? << 10)
}

/// Resets [`peak_memory`], if the system can.
pub fn forget_peak_memory() {
    // If it cannot, the peak is that since the start of the process, which is at least as large.
    let _ = fs::write("/proc/self/clear_refs", "5");
}
