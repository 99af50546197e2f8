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
            processor: processor(&fs::read_to_string("/proc/cpuinfo").unwrap_or_default()),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            levels: Isa::available().into_iter().map(Isa::name).collect(),
            load_at_start: fs::read_to_string("/proc/loadavg").ok().and_then(|averages| load(&averages)),
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

/// The processor in the text of `/proc/cpuinfo`.
fn processor(info: &str) -> String {
    let name = info.lines().find_map(|line| line.strip_prefix("model name")?.trim_start().strip_prefix(':'));
    name.map_or_else(
        || format!("unnamed {} processor", std::env::consts::ARCH),
        |name| name.trim().to_owned(),
    )
}

/// The load of the last minute in the text of `/proc/loadavg`.
fn load(averages: &str) -> Option<f64> {
    averages.split_whitespace().next()?.parse().ok()
}

/// A number with its noun: `1 lane`, `8 lanes`.
pub fn counted(number: usize, noun: &str) -> String {
    format!("{number} {noun}{}", if number == 1 { "" } else { "s" })
}

/// Peak memory of this process since [`forget_peak_memory`], bytes; `None` if the system does not tell.
pub fn peak_memory() -> Option<u64> {
    peak(&fs::read_to_string("/proc/self/status").ok()?)
}

/// The peak in the text of `/proc/self/status`, bytes.
fn peak(status: &str) -> Option<u64> {
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()? << 10)
}

/// Resets [`peak_memory`], if the system can.
pub fn forget_peak_memory() {
    // If it cannot, the peak is that since the start of the process, which is at least as large.
    let _ = fs::write("/proc/self/clear_refs", "5");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_peak_is_of_the_memory_in_use() {
        let status = "Name:\tweekender\nVmPeak:\t 9000000 kB\nVmSize:\t 8000000 kB\nVmHWM:\t    1936 kB\n\
                      VmRSS:\t    1720 kB\n";
        assert_eq!(peak(status), Some(1936 * 1024));
        assert_eq!(peak("Name:\tweekender\nVmRSS:\t    1720 kB\n"), None);
    }

    #[test]
    fn the_load_is_that_of_the_last_minute() {
        assert_eq!(load("0.52 0.58 0.59 1/389 1234\n"), Some(0.52));
        assert_eq!(load(""), None);
    }

    #[test]
    fn the_processor_has_its_name_or_at_least_its_family() {
        let info = "processor\t: 0\nmodel\t\t: 85\nmodel name\t: Some CPU: 2.50GHz\nprocessor\t: 1\n\
                    model name\t: Another\n";
        assert_eq!(processor(info), "Some CPU: 2.50GHz");
        assert_eq!(processor("processor\t: 0\n"), format!("unnamed {} processor", std::env::consts::ARCH));
    }

    #[test]
    fn a_machine_in_one_line_has_its_most_capable_level() {
        let machine = Machine {
            version: "1.2.3",
            processor: "Some CPU".to_owned(),
            cores: 1,
            levels: vec!["portable", "sse4.2", "avx2"],
            load_at_start: None,
        };
        assert_eq!(machine.words(), "Weekender 1.2.3, Some CPU, 1 thread, avx2");
        let busy = Machine { cores: 2, load_at_start: Some(0.256), ..machine };
        assert_eq!(busy.words(), "Weekender 1.2.3, Some CPU, 2 threads, avx2, load 0.26 at the start");
    }
}
