//! Validates pages by html-validate from npm: `npm ci --prefix tests/companion` installs it.

use crate::gpu_common;
use std::path::Path;
use std::process::Command;

/// Asserts that the HTML file is valid. Without html-validate it says so, or fails where `WEEKENDER_REQUIRE_BROWSER=1`.
pub fn assert_valid(page: &Path) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/companion");
    let program = folder.join("node_modules/html-validate/bin/html-validate.mjs");
    if !program.is_file() {
        return skip("the page's HTML was not checked: run npm ci --prefix tests/companion");
    }
    let output = Command::new("node")
        .arg(&program)
        .args(["--formatter", "text", "--config"])
        .arg(folder.join("html-validate.json"))
        .arg(page)
        .output();
    match output {
        Err(error) => skip(&format!("the page's HTML was not checked: cannot start node: {error}")),
        Ok(output) => {
            let said = [output.stdout, output.stderr].concat();
            let said = String::from_utf8_lossy(&said);
            assert!(output.status.success(), "{}", said.chars().take(4000).collect::<String>());
        }
    }
}

fn skip(reason: &str) {
    let is_required = std::env::var("WEEKENDER_REQUIRE_BROWSER").as_deref() == Ok("1");
    assert!(!is_required, "{reason}");
    gpu_common::say_loudly(reason);
}
