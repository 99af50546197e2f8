//! The code of the book's sections, as the companion's chapters quote it.

use crate::excerpt::{Excerpt, cut};

/// Embeds files by folder and name.
macro_rules! embedded {
    ($($folder:literal: $($name:literal)*;)*) => {
        &[$($((
            concat!($folder, $name),
            include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/", $folder, $name)),
        ),)*)*]
    };
}

/// The book's chapters with code, from 2 on.
#[rustfmt::skip]
const CHAPTERS: &[(&str, &str)] = embedded![
    "docs/companion/": "02-image.md" "03-vectors.md" "04-rays.md" "05-sphere.md" "06-normals.md" "07-camera-class.md"
        "08-antialiasing.md" "09-diffuse.md" "10-metal.md" "11-glass.md" "12-camera.md" "13-defocus.md" "14-final.md";
];

/// The sources that they quote.
#[rustfmt::skip]
const SOURCES: &[(&str, &str)] = embedded![
    "reference/": "rt_weekend.c";
    "shaders/": "camera.wgsl" "lanes.wgsl" "material.wgsl" "path.wgsl" "resolve.wgsl" "rng.wgsl" "rules.wgsl" "sphere.wgsl";
    "src/batch/": "picture.rs";
    "src/film/": "resolve.rs";
    "src/job/output/": "ppm.rs";
    "src/kernel/": "constants.rs";
    "src/prepared/": "camera.rs" "mod.rs";
    "src/render_cpu/": "camera.rs" "material.rs" "rng.rs" "sphere.rs";
    "src/render_cpu/lanes/": "vector.rs";
    "src/render_cpu/path/": "shade.rs";
    "src/scene/": "camera.rs";
    "src/scene/builtin/": "book.rs";
    "src/stages/table/": "setups.rs";
];

/// The excerpts that the companion shows after section `after`, up to and including section `section` of the same chapter
/// of the book. If `after` is the previous section with a picture, this is the code that `section` adds. Both are numbers
/// such as "9.1"; an `after` in another chapter excludes nothing.
pub fn excerpts_between(after: Option<&str>, section: &str) -> Vec<Excerpt> {
    let [chapter, part] = parts(section);
    let text = chapter.checked_sub(2).and_then(|place| CHAPTERS.get(place)).map_or("", |(_, text)| *text);
    let first_part = after.map(parts).filter(|after| after[0] == chapter).map_or(0, |after| after[1] + 1);
    let (mut at, mut is_code) = (0, false);
    let mut found = Vec::new();
    for line in text.lines() {
        match line.strip_prefix("## ").and_then(|heading| heading.split(' ').next()) {
            Some(number) if number.contains('.') => at = parts(number)[1],
            _ if line.starts_with("{{code") || line == "}}" => is_code = line != "}}",
            _ if is_code && (first_part..=part).contains(&at) => found.extend(excerpt(line).ok()),
            _ => {}
        }
    }
    found
}

/// The numbers of a section's chapter and of the section in it.
fn parts(section: &str) -> [usize; 2] {
    let (chapter, part) = section.split_once('.').unwrap_or((section, ""));
    [chapter, part].map(|number| number.parse().unwrap_or_default())
}

fn excerpt(wanted: &str) -> Result<Excerpt, String> {
    let (file, words) = wanted.split_once(": ").ok_or("no file")?;
    let (_, text) = SOURCES.iter().find(|(path, _)| *path == file).ok_or("is not embedded")?;
    cut(file, text, words)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_quoted_code_is_embedded() {
        let mut count = 0;
        for (chapter, text) in CHAPTERS {
            for block in text.split("{{code\n").skip(1) {
                for line in block.split("\n}}").next().unwrap().lines() {
                    excerpt(line).unwrap_or_else(|error| panic!("{chapter}: {line}: {error}"));
                    count += 1;
                }
            }
        }
        assert!(count > 50, "{count}");
    }

    #[test]
    fn section_has_new_excerpts() {
        let first_lines = |after: Option<&str>, section: &str| -> Vec<String> {
            let first = |excerpt: Excerpt| excerpt.text.lines().next().unwrap_or_default().to_owned();
            excerpts_between(after, section).into_iter().map(first).collect()
        };
        let glass = first_lines(Some("11.3"), "11.4");
        let has = |words: &str| glass.iter().filter(|line| line.contains(words)).count();
        assert_eq!((has("fn reflectance"), has("double reflectance")), (2, 1), "{glass:?}");
        // The code of 5.1 is new in the picture of 5.2, the chapter's first.
        assert!(first_lines(Some("4.2"), "5.2").iter().any(|line| line.contains("fn book_root")));
        assert_eq!(first_lines(Some("10.5"), "10.6"), Vec::<String>::new());
        assert_eq!(first_lines(None, "99.1"), Vec::<String>::new());
    }
}
