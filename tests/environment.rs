//! The program starts itself again if it has no runtime directory, and nobody notices.
#![cfg(target_os = "linux")]

use std::os::unix::process::CommandExt;
use std::process::Command;

#[test]
fn without_a_runtime_directory_the_program_keeps_its_name_and_its_arguments() {
    for directory in [None, Some("/tmp")] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_weekender"));
        command.arg0("some/where/tracer").args(["bench", "--help"]).env_remove("XDG_RUNTIME_DIR");
        if let Some(directory) = directory {
            command.env("XDG_RUNTIME_DIR", directory);
        }
        let output = command.output().unwrap();
        let told = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success() && told.contains("Usage: tracer bench"), "{directory:?}: {told}");
    }
}
