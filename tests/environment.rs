//! What the program makes of variables of the environment.
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

#[test]
fn who_allows_no_backend_of_the_graphics_library_is_told_which_variable_did_it() {
    let picture = std::env::temp_dir().join("weekender-environment-without-adapter.png");
    let output = Command::new(env!("CARGO_BIN_EXE_weekender"))
        .args(["--batch", "--device", "gpu", "--out"])
        .arg(&picture)
        .env("WGPU_BACKEND", "noop")
        .output()
        .unwrap();
    let told = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{told}");
    assert!(told.contains("no graphics adapter was found (WGPU_BACKEND allows only \"noop\")"), "{told}");
    assert!(!picture.exists());
}
