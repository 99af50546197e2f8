//! Restarts after a change by the reader, run by node without a browser.

use super::live_page::SCRIPT;
use std::process::Command;

#[test]
fn a_change_starts_the_film_again_only_if_it_must() {
    let directory = tempfile::tempdir().unwrap();
    let script = directory.path().join("live.mjs");
    std::fs::write(&script, SCRIPT).unwrap();
    let program = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/session.mjs");
    match Command::new("node").arg(program).arg(&script).output() {
        Ok(output) => assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr)),
        Err(error) => super::skip("BROWSER", &format!("node cannot be run: {error}")),
    }
}
