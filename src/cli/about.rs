//! What `--version` says: which build this is and, with `--verbose`, what it finds on this machine.

use crate::cli::terminal;
use crate::film::checkpoint;
use crate::render_cpu::Isa;
use crate::render_gpu::{AdapterInfo, adapters};
use anyhow::Result;
use std::fmt::Write as _;

/// Which build this is.
#[derive(Clone, Copy, Debug)]
pub struct Build {
    /// Abbreviated hash of the commit, with a `+` if files were changed; empty if it was built without git.
    pub commit: &'static str,
}

impl Build {
    /// Version, commit and target in one line.
    pub fn line(&self) -> String {
        let version = env!("CARGO_PKG_VERSION");
        format!("weekender {version} ({}, {})", self.commit(), current_platform::CURRENT_PLATFORM)
    }

    fn commit(&self) -> &'static str {
        if self.commit.is_empty() { "commit unknown" } else { self.commit }
    }

    /// Prints the version.
    ///
    /// # Errors
    /// If standard output cannot be written.
    pub fn print(&self, is_verbose: bool) -> Result<()> {
        if is_verbose {
            terminal::print(&self.details(&adapters()))
        } else {
            terminal::print(concat!("weekender ", env!("CARGO_PKG_VERSION"), "\n"))
        }
    }

    fn details(&self, adapters: &[AdapterInfo]) -> String {
        let levels: Vec<String> = Isa::available().iter().map(ToString::to_string).collect();
        let level = Isa::available().last().map_or_else(String::new, |best| {
            format!("{best}, {} lanes (of {})", best.native_lanes(), levels.join(", "))
        });
        let window = if cfg!(feature = "window") { "yes" } else { "no (built without the feature `window`)" };
        let mut text = format!(
            "weekender {}\ncommit        {}\ntarget        {}\nwindow        {window}\nallocator     the system's\n\
             instructions  {level}\nfilm files    version {}\n",
            env!("CARGO_PKG_VERSION"),
            self.commit(),
            current_platform::CURRENT_PLATFORM,
            checkpoint::VERSION,
        );
        if adapters.is_empty() {
            text.push_str("adapters      none\n");
        }
        for (index, adapter) in adapters.iter().enumerate() {
            let head = if index == 0 { "adapters" } else { "" };
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{head:14}{adapter}");
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_facts_are_named() {
        assert!(Build { commit: "" }.line().contains("commit unknown"));
        assert!(Build { commit: "0123abc+" }.details(&[]).contains("commit        0123abc+\n"));
        assert!(Build { commit: "" }.details(&[]).ends_with("\nadapters      none\n"));
    }

    #[test]
    fn every_adapter_has_a_line() {
        let adapter = |name: &str| AdapterInfo {
            name: name.to_owned(),
            kind: "discrete GPU",
            backend: "Vulkan".to_owned(),
            driver: "driver 1.2".to_owned(),
            is_software: false,
            storage_binding_limit: 1 << 30,
            buffer_limit: 1 << 30,
            has_timestamps: true,
            subgroup_size: 32,
            lacks: None,
        };
        let text = Build { commit: "" }.details(&["One", "Other"].map(adapter));
        let expected = "adapters      One (discrete GPU, Vulkan, driver 1.2)\n              \
                    Other (discrete GPU, Vulkan, driver 1.2)\n";
        assert!(text.ends_with(expected), "{text}");
    }
}
