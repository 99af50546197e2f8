//! The page's texts and the sources that it quotes: embedded when the program was built, or read from a checkout.

use crate::system::files;
use serde::de::DeserializeOwned;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt;
use std::path::PathBuf;
use std::time::SystemTime;
use thiserror::Error;
use toml::Spanned;

/// Reads project files by their paths in the checkout.
#[derive(Clone, Debug)]
pub enum Library {
    /// The files embedded in the program.
    Embedded,
    /// A checkout's files, so that edits show without rebuilding the program.
    Checkout(PathBuf),
}

pub const FOLDER: &str = "docs/companion";

/// Largest file read from a checkout, bytes.
const FILE_LIMIT: u64 = 1 << 22;

/// Embeds files by folder and name.
macro_rules! embedded {
    ($($folder:literal: $($name:literal)*;)*) => {
        &[$($((
            concat!($folder, $name),
            include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/", $folder, $name)),
        ),)*)*]
    };
}

/// Every file that the page is made of: chapters and data, diagrams, and quoted sources. A test compares the list with
/// the folder.
#[rustfmt::skip]
const FILES: &[(&str, &str)] = embedded![
    "docs/companion/": "00-start.md" "01-languages.md" "02-image.md" "03-vectors.md" "04-rays.md"
        "05-sphere.md" "06-normals.md" "07-camera-class.md" "08-antialiasing.md" "09-diffuse.md"
        "10-metal.md" "11-glass.md" "12-camera.md" "13-defocus.md" "14-final.md" "20-many-rays.md"
        "21-mappings.md" "22-simd.md" "23-speed.md" "24-control.md" "25-error.md" "26-precision.md"
        "27-references.md" "28-glossary.md" "glossary.toml" "measured.toml" "references.toml";
    "docs/companion/measured/": "error.json" "mappings.json" "refill.json" "speed.json";
    "docs/companion/diagrams/": "basis.svg" "cosine.svg" "error.svg" "floats.svg" "fuzz.svg" "hero.svg" "hierarchy.svg"
        "lanes.svg" "lens.svg" "life-cycle.svg" "mappings.svg" "path.svg" "pipeline.svg" "points.svg" "rows.svg" "select.svg"
        "shell.svg" "sides.svg" "snell.svg" "sphere.svg" "streams.svg" "subtract.svg" "viewport.svg";
    "assets/companion/": "check.css" "check.js" "diagrams.js" "fonts.css" "more-fonts.css" "page.css" "page.js" "theme.js";
    "assets/web/": "film.js" "live.css" "live.js" "scene.js";
    "examples/": "lanes.rs";
    "reference/": "rt_weekend.c";
    "shaders/": "bindings.wgsl" "bvh.wgsl" "camera.wgsl" "lanes.wgsl" "material.wgsl"
        "path.wgsl" "resolve.wgsl" "rng.wgsl" "rules.wgsl" "sphere.wgsl";
    "src/batch/": "progress.rs";
    "src/denoise/": "mod.rs";
    "src/film/": "error_estimate.rs" "fixed_point.rs" "resolve.rs";
    "src/kernel/": "constants.rs" "records.rs";
    "src/job/output/": "ppm.rs";
    "src/prepared/": "camera.rs" "mod.rs";
    "src/render_cpu/": "bvh.rs" "camera.rs" "kernels.rs" "material.rs" "rng.rs" "sphere.rs";
    "src/render_cpu/lanes/": "vector.rs";
    "src/render_cpu/path/": "scatter.rs" "schedule.rs" "shade.rs";
    "src/scene/builtin/": "book.rs";
    "src/scene/": "camera.rs";
    "src/stages/table/": "setups.rs";
];

/// An entry of a TOML file with one table per entry.
#[derive(Clone, Debug)]
pub struct Entry<T> {
    pub key: String,
    /// Line in the file, counted from 1.
    pub line: usize,
    pub value: T,
}

impl Library {
    pub fn read(&self, path: &str) -> Result<Cow<'static, str>, Fault> {
        let content = match self {
            Library::Embedded => {
                FILES.iter().find(|(name, _)| *name == path).map(|(_, text)| Cow::Borrowed(*text)).ok_or_else(
                    || "is not in the program; add it to FILES in src/pages/companion/library.rs".to_owned(),
                )
            }
            Library::Checkout(directory) => {
                files::read(&directory.join(path), "a text of the page", FILE_LIMIT)
                    .map_err(|error| error.to_string())
                    .and_then(|bytes| String::from_utf8(bytes).map_err(|_| "is not UTF-8".to_owned()))
                    .map(Cow::Owned)
            }
        };
        content.map_err(|message| Fault::new(path, 0, message))
    }

    /// When the files were last changed; `None` for those that are not there.
    pub fn stamps(&self) -> Vec<Option<SystemTime>> {
        let Library::Checkout(directory) = self else { return Vec::new() };
        FILES.iter().map(|(path, _)| directory.join(path).metadata().ok()?.modified().ok()).collect()
    }

    pub fn toml<T: DeserializeOwned>(&self, path: &str) -> Result<T, Fault> {
        let text = self.read(path)?;
        toml::from_str(&text).map_err(|error| {
            let line = error.span().map_or(0, |span| line_of(&text, span.start));
            Fault::new(path, line, error.message())
        })
    }

    /// The tables of a TOML file, in file order.
    pub fn entries<T: DeserializeOwned>(&self, path: &str) -> Result<Vec<Entry<T>>, Fault> {
        let tables: BTreeMap<String, Spanned<T>> = self.toml(path)?;
        let text = self.read(path)?;
        let entry = |(key, value): (String, Spanned<T>)| {
            let line = line_of(&text, value.span().start);
            Entry { key, line, value: value.into_inner() }
        };
        let mut entries: Vec<Entry<T>> = tables.into_iter().map(entry).collect();
        entries.sort_by_key(|entry| entry.line);
        Ok(entries)
    }

    /// Paths of the chapters, ascending.
    pub fn chapters() -> impl Iterator<Item = &'static str> {
        FILES.iter().map(|(path, _)| *path).filter(|path| path.starts_with(FOLDER) && path.ends_with(".md"))
    }
}

/// An error in the texts, with file and line.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{file}{}: {message}", if *.line == 0 { String::new() } else { format!(":{}", .line) })]
pub struct Fault {
    /// Path in the checkout.
    pub file: String,
    /// Counted from 1; 0 if the fault concerns the whole file.
    pub line: usize,
    /// What is wrong and how to fix it.
    pub message: String,
}

impl Fault {
    pub fn new(file: &str, line: usize, message: impl fmt::Display) -> Self {
        Fault { file: file.to_owned(), line, message: message.to_string() }
    }
}

/// The line of a byte position, counted from 1.
pub fn line_of(text: &str, position: usize) -> usize {
    1 + text.bytes().take(position).filter(|byte| *byte == b'\n').count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    fn checkout() -> PathBuf {
        PathBuf::from(env!("CARGO_MANIFEST_DIR"))
    }

    #[test]
    fn every_file_is_embedded() {
        let paths = FILES.iter().map(|(path, _)| (*path).to_owned());
        let embedded: BTreeSet<String> = paths.filter(|path| path.starts_with(FOLDER)).collect();
        let mut found = BTreeSet::new();
        for folder in ["", "diagrams", "measured"] {
            let entries = std::fs::read_dir(checkout().join(FOLDER).join(folder)).unwrap();
            let is_text = |path: &PathBuf| {
                path.is_file() && !path.extension().is_some_and(|end| end == "sh" || end == "mjs")
            };
            let files = entries.map(|entry| entry.unwrap().path()).filter(is_text);
            found.extend(
                files.map(|path| path.strip_prefix(checkout()).unwrap().to_str().unwrap().replace('\\', "/")),
            );
        }
        assert_eq!(embedded, found, "left: FILES in library.rs; right: {FOLDER}");
    }

    #[test]
    fn sources_that_chapters_cite_exist() {
        for path in Library::chapters() {
            let text = Library::Embedded.read(path).unwrap();
            for cited in text.split("](source:").skip(1) {
                let cited = cited.split(')').next().unwrap();
                assert!(checkout().join(cited).exists(), "{path}: {cited}");
            }
        }
    }

    #[test]
    fn entries_have_lines_and_errors_name_files() {
        let directory = tempfile::tempdir().unwrap();
        let library = Library::Checkout(directory.path().to_owned());
        std::fs::write(directory.path().join("a.toml"), "# A\n[z]\nx = 1\n\n[b]\nx = 2\n").unwrap();
        let entries: Vec<Entry<BTreeMap<String, u32>>> = library.entries("a.toml").unwrap();
        let found: Vec<_> = entries.iter().map(|entry| (entry.key.as_str(), entry.line)).collect();
        assert_eq!(found, [("z", 2), ("b", 5)]);
        std::fs::write(directory.path().join("a.toml"), "# A\n[z]\nx = 1\n").unwrap();
        let fault = library.entries::<BTreeMap<String, bool>>("a.toml").unwrap_err();
        assert_eq!((fault.file.as_str(), fault.line), ("a.toml", 3));
        std::fs::write(directory.path().join("b.md"), b"a\xff").unwrap();
        assert_eq!(library.read("b.md").unwrap_err().to_string(), "b.md: is not UTF-8");
        assert!(library.read("c.md").unwrap_err().to_string().starts_with("c.md: "));
    }
}
