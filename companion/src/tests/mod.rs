//! The page, its links and HTML, its pictures, and what a reader can do with it in a browser.

mod check;
mod html;
mod live_browser;
mod live_bytes;
mod live_page;
mod live_session;
mod pictures;
mod reader;
#[path = "../../../tests/common/skip.rs"]
mod skipping;
mod texts;

use crate::options::Options;
use crate::write;
use clap::Parser;
use skipping::skip;
use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;
use tempfile::TempDir;
use weekender::system::interrupt::Interrupt;

/// Maximum size of the page and its quick stills, bytes.
const SIZE_LIMIT: u64 = 6_000_000;

/// The options of a quick run in this directory.
fn quick(out: &Path, arguments: &[&str]) -> Options {
    let own = ["companion", "--quick", "--progress", "off", "--out", out.to_str().unwrap()];
    Options::try_parse_from([&own, arguments].concat()).unwrap()
}

/// A page with quick stills, made once for all tests.
static PAGE: LazyLock<TempDir> = LazyLock::new(|| {
    let directory = tempfile::tempdir().unwrap();
    write(&quick(directory.path(), &[]), &Interrupt::unheard()).unwrap();
    directory
});

/// The main program, which a test of the whole workspace builds, too.
fn program() -> PathBuf {
    let name = format!("weekender{}", env::consts::EXE_SUFFIX);
    let here = env::current_exe().unwrap();
    let program = here.ancestors().map(|folder| folder.join(&name)).find(|program| program.is_file());
    program.expect("there is no program to compare with: cargo test --release --workspace builds it")
}

/// A script in node.
fn driver(name: &str) -> Command {
    let mut node = Command::new("node");
    node.arg(Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/{name}.mjs")));
    node
}

/// Reason why no browser can be used, if it cannot.
fn obstacle() -> Option<String> {
    let lacks = |program: &str| Command::new(program).arg("--version").output().is_err();
    let package = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/node_modules/playwright-core");
    let is_lacking = lacks("node") || lacks("chromium") || !package.exists();
    let reason = "no browser was used: install node and chromium, and run npm ci --prefix companion/tests";
    is_lacking.then(|| reason.to_owned())
}

#[test]
fn page_is_whole_small_and_rendered_once() {
    let directory = PAGE.path();
    let page = html::assert_whole(directory);
    let size = |folder| -> u64 {
        let files = std::fs::read_dir(directory.join(folder)).unwrap();
        files.map(|file| file.unwrap().metadata().unwrap().len()).sum()
    };
    let later = std::fs::metadata(directory.join("later.js")).unwrap().len();
    let bytes = size("figures") + size("figures/more") + later;
    assert!(page.len() as u64 + bytes < SIZE_LIMIT, "{} + {bytes} bytes", page.len());
    assert_eq!(write(&quick(directory, &[]), &Interrupt::unheard()).unwrap().rendered, 0);

    for id in ["content", "contents", "figure-normals", "stage-normals", "normals", "glossary", "term-lane"] {
        assert!(page.contains(&format!(" id=\"{id}\"")), "{id}");
    }
    assert!(!html::values(&page, "data-set").is_empty());
    // Every term is linked by a chapter.
    for term in html::values(&page, "id").into_iter().filter_map(|id| id.strip_prefix("term-")) {
        assert!(page.contains(&format!(" id=\"use-{term}\"")), "{term}");
    }
    let count = |part: &str| page.matches(part).count();
    assert!(count("<figure class=\"code") > 60 && count("<math") > 30 && count("data-stage=") > 25);
    let body = page.split("<main").nth(1).unwrap().split("<script").next().unwrap();
    // None of the texts' own notation remains.
    for part in ["{{", "}}", "[@", "](glossary:", "](book:", "](page:"] {
        assert!(!body.contains(part), "{part}");
    }
}
