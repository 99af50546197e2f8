//! The texts of the page and the sources that it quotes: as they were when the program was built, or those of a
//! checkout.

use crate::files;
use std::borrow::Cow;
use std::path::{Path, PathBuf};

/// Reads files of the project by their paths in the checkout.
#[derive(Clone, Debug)]
pub enum Library {
    /// The files in the program.
    Embedded,
    /// Those of a checkout, so that a text can be changed and seen without building the program again.
    Checkout(PathBuf),
}

/// The folder of the texts.
pub const FOLDER: &str = "docs/companion";

/// Largest file of a checkout that is read, bytes.
const FILE_LIMIT: u64 = 1 << 22;

/// Includes files by their paths in the checkout.
macro_rules! embedded {
    ($($path:literal)*) => {
        &[$(($path, include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/", $path)))),*]
    };
}

/// Every file that the page is made of: chapters and data, diagrams, and the sources that it quotes. A test compares
/// the list with the folder and with the excerpts.
const FILES: &[(&str, &str)] = embedded![
    "docs/companion/00-start.md"
    "docs/companion/01-languages.md"
    "docs/companion/02-image.md"
    "docs/companion/03-vectors.md"
    "docs/companion/04-rays.md"
    "docs/companion/05-sphere.md"
    "docs/companion/06-normals.md"
    "docs/companion/07-camera-class.md"
    "docs/companion/08-antialiasing.md"
    "docs/companion/09-diffuse.md"
    "docs/companion/10-metal.md"
    "docs/companion/11-glass.md"
    "docs/companion/12-camera.md"
    "docs/companion/13-defocus.md"
    "docs/companion/14-final.md"
    "docs/companion/20-many-rays.md"
    "docs/companion/21-mappings.md"
    "docs/companion/22-simd.md"
    "docs/companion/23-speed.md"
    "docs/companion/24-control.md"
    "docs/companion/25-error.md"
    "docs/companion/26-precision.md"
    "docs/companion/27-references.md"
    "docs/companion/28-glossary.md"
    "docs/companion/book.toml"
    "docs/companion/excerpts.toml"
    "docs/companion/glossary.toml"
    "docs/companion/measured.toml"
    "docs/companion/measured/error.json"
    "docs/companion/measured/mappings.json"
    "docs/companion/measured/refill.json"
    "docs/companion/measured/speed.json"
    "docs/companion/references.toml"
    "docs/companion/diagrams/lanes.svg"
    "docs/companion/diagrams/life-cycle.svg"
    "docs/companion/diagrams/mappings.svg"
    "reference/rt_weekend.c"
    "shaders/aside.wgsl"
    "shaders/bindings.wgsl"
    "shaders/bvh.wgsl"
    "shaders/camera.wgsl"
    "shaders/lanes.wgsl"
    "shaders/material.wgsl"
    "shaders/path.wgsl"
    "shaders/resolve.wgsl"
    "shaders/rng.wgsl"
    "shaders/sphere.wgsl"
    "src/film/error_estimate.rs"
    "src/film/fixed_point.rs"
    "src/film/resolve.rs"
    "src/kernel/records.rs"
    "src/output/ppm.rs"
    "src/prepared/camera.rs"
    "src/prepared/mod.rs"
    "src/render_cpu/bvh.rs"
    "src/render_cpu/camera.rs"
    "src/render_cpu/kernels.rs"
    "src/render_cpu/lanes/mod.rs"
    "src/render_cpu/lanes/vector.rs"
    "src/render_cpu/material.rs"
    "src/render_cpu/path/collect.rs"
    "src/render_cpu/path/mod.rs"
    "src/render_cpu/path/send.rs"
    "src/render_cpu/rng.rs"
    "src/render_cpu/sphere.rs"
    "src/render_cpu/tiles.rs"
    "src/render_cpu/work.rs"
    "src/render_gpu/schedule.rs"
    "src/sampling/mod.rs"
    "src/sampling/warp.rs"
    "src/scene/builtin/book.rs"
    "src/scene/camera.rs"
    "src/stages/table/setups.rs"
];

impl Library {
    /// The content of a file.
    ///
    /// # Errors
    /// A text that tells what to do, without the path.
    pub fn read(&self, path: &str) -> Result<Cow<'static, str>, String> {
        match self {
            Library::Embedded => {
                let found = FILES.iter().find(|(name, _)| *name == path);
                found.map(|(_, text)| Cow::Borrowed(*text)).ok_or_else(|| {
                    "is not in the program; add it to FILES in src/companion/library.rs".to_owned()
                })
            }
            Library::Checkout(directory) => {
                let bytes = files::read(&directory.join(path), "a text of the page", FILE_LIMIT)
                    .map_err(|error| error.to_string())?;
                let text =
                    String::from_utf8(bytes).map_err(|_| "is not UTF-8; save it as UTF-8".to_owned())?;
                Ok(Cow::Owned(text))
            }
        }
    }

    /// Paths of the chapters, ascending.
    ///
    /// # Errors
    /// If the folder of a checkout cannot be read.
    pub fn chapters(&self) -> std::io::Result<Vec<String>> {
        let mut chapters: Vec<String> = match self {
            Library::Embedded => FILES.iter().map(|(path, _)| (*path).to_owned()).collect(),
            Library::Checkout(directory) => {
                let entries = std::fs::read_dir(directory.join(FOLDER))?;
                let names = entries.map(|entry| Ok(entry?.file_name().to_string_lossy().into_owned()));
                let paths = names.map(|name| name.map(|name: String| format!("{FOLDER}/{name}")));
                paths.collect::<std::io::Result<_>>()?
            }
        };
        chapters.retain(|path| is_chapter(path));
        chapters.sort();
        Ok(chapters)
    }

    /// The paths of `FILES`.
    pub fn embedded() -> impl Iterator<Item = &'static str> {
        FILES.iter().map(|(path, _)| *path)
    }
}

/// Whether a path of the repository looks like one: not all of them can be looked up in the program.
pub fn is_source(path: &str) -> bool {
    let folders = ["src/", "shaders/", "tests/", "examples/", "reference/", "benches/", "docs/", "assets/"];
    folders.iter().any(|folder| path.starts_with(folder)) && !path.contains("..")
}

/// Whether this is `docs/companion/NN-name.md`.
fn is_chapter(path: &str) -> bool {
    let name = Path::new(path).strip_prefix(FOLDER).ok().and_then(Path::to_str).unwrap_or_default();
    let number = name.split('-').next().unwrap_or_default();
    name.ends_with(".md") && !name.contains('/') && number.len() == 2 && number.parse::<u8>().is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    fn checkout() -> PathBuf {
        PathBuf::from(env!("CARGO_MANIFEST_DIR"))
    }

    #[test]
    fn every_file_of_the_folder_is_in_the_program() {
        let embedded: BTreeSet<String> =
            Library::embedded().filter(|path| path.starts_with(FOLDER)).map(str::to_owned).collect();
        let mut found = BTreeSet::new();
        let mut folders = vec![checkout().join(FOLDER)];
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    folders.push(path);
                } else {
                    found.insert(path.strip_prefix(checkout()).unwrap().to_str().unwrap().to_owned());
                }
            }
        }
        assert_eq!(embedded, found, "left: FILES in library.rs; right: {FOLDER}");
    }

    #[test]
    fn the_program_and_the_checkout_agree() {
        let library = Library::Checkout(checkout());
        assert_eq!(library.chapters().unwrap(), Library::Embedded.chapters().unwrap());
        for path in Library::embedded() {
            assert!(library.read(path) == Library::Embedded.read(path), "{path}");
        }
    }

    #[test]
    fn sources_that_chapters_cite_exist() {
        for path in Library::Embedded.chapters().unwrap() {
            let text = Library::Embedded.read(&path).unwrap();
            for cited in text.split("](source:").skip(1) {
                let cited = cited.split(')').next().unwrap();
                assert!(is_source(cited) && checkout().join(cited).exists(), "{path}: {cited}");
            }
        }
    }

    #[test]
    fn chapters_have_numbers() {
        assert!(is_chapter("docs/companion/06-normals.md"));
        for path in [
            "docs/companion/readme.md",
            "docs/companion/6-normals.md",
            "docs/06-a.md",
            "docs/companion/06-a.txt",
        ] {
            assert!(!is_chapter(path), "{path}");
        }
    }

    #[test]
    fn what_cannot_be_read_says_what_to_do() {
        let told = Library::Embedded.read("docs/companion/nothing.md").unwrap_err();
        assert!(told.contains("add it to FILES in src/companion/library.rs"), "{told}");
        let directory = tempfile::tempdir().unwrap();
        std::fs::write(directory.path().join("a.md"), b"a\xff").unwrap();
        std::fs::write(directory.path().join("b.md"), "ö").unwrap();
        let library = Library::Checkout(directory.path().to_owned());
        assert_eq!(library.read("a.md"), Err("is not UTF-8; save it as UTF-8".to_owned()));
        assert_eq!(library.read("b.md").as_deref(), Ok("ö"));
        assert!(library.read("c.md").is_err() && library.chapters().is_err());
    }
}
