//! Items and regions of made-up sources.

use super::*;

const SOURCE: &str = r##"
//! A file.

/// Adds.
#[inline]
pub(crate) fn add<'a>(a: [u32; 2], b: &'a str) -> u32 {
    let close = '}'; // }
    let text = "} \" ;";
    if b == text { a[0] } else { a[1] }
}

pub const TABLE: [Row; 1] = [
    Row { x: 1 },
];

const fn addition() {}

    // ANCHOR: middle
    let x = 1;
    // ANCHOR: inner

        let y = 2;
    // ANCHOR_END: inner
    // ANCHOR_END: middle
@compute @workgroup_size(64) fn trace(at: u32) {
    return;
}
struct Pair(u32, u32);
"##;

fn lines() -> Vec<&'static str> {
    SOURCE.lines().collect()
}

#[test]
fn items_end_with_their_brace_or_semicolon() {
    let found = |item: &str, docs: bool| find_item(&lines(), item, docs).map(|(a, b)| (a + 1, b + 1));
    assert_eq!(found("fn add", false), Ok((6, 10)));
    assert_eq!(found("fn add", true), Ok((4, 10)));
    assert_eq!(found("const TABLE", false), Ok((12, 14)));
    assert_eq!(found("const fn addition", false), Ok((16, 16)));
    assert_eq!(found("fn trace", false), Ok((25, 27)));
    assert_eq!(found("struct Pair", false), Ok((28, 28)));
    assert!(found("fn subtract", false).unwrap_err().contains("no line begins with"));
    assert!(found("let", false).unwrap_err().contains("begins lines 7 and 8 and"));
}

#[test]
fn regions_lie_between_two_comments() {
    let (first, last) = find_region(&lines(), "middle").unwrap();
    assert_eq!((first + 1, last + 1), (19, 23));
    let kept: Vec<&str> =
        lines()[first..=last].iter().copied().filter(|line| anchor(line).is_none()).collect();
    assert_eq!(without_indentation(&kept), "let x = 1;\n\n    let y = 2;\n");
    for (source, message) in [
        (&["x"][..], "there is no comment // ANCHOR: a"),
        (&["// ANCHOR: b", "x", "// ANCHOR_END: b"], "there is no comment // ANCHOR: a"),
        (&["// ANCHOR: a", "x"], "the region a needs one "),
        (&["// ANCHOR_END: a", "x", "// ANCHOR: a"], "the region a needs one "),
        (&["// ANCHOR: a", "// ANCHOR_END: a"], "the region a needs one "),
        (&["// ANCHOR: a", "x", "// ANCHOR_END: a", "// ANCHOR_END: a"], "the region a needs one "),
    ] {
        assert!(find_region(source, "a").unwrap_err().starts_with(message), "{source:?}");
    }
    assert_eq!(find_region(&["  // ANCHOR: a", "x", "//ANCHOR_END:a"], "a"), Ok((1, 1)));
}

#[test]
fn items_longer_than_a_screen_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    let library = Library::Checkout(directory.path().to_owned());
    let cut = |lines_inside: usize, more: &str| {
        let body = "    x();\n".repeat(lines_inside);
        std::fs::write(directory.path().join("a.rs"), format!("fn a() {{\n{body}{more}}}\n")).unwrap();
        let (file, item) = ("a.rs".to_owned(), Some("fn a".to_owned()));
        let found = super::cut(&library, &Declared { file, item, region: None, docs: false });
        found.map(|excerpt| (excerpt.last, excerpt.text.lines().count()))
    };
    let message = "a.rs: lines 1 to 41 are 41, more than 40; choose a shorter item or region";
    assert_eq!(cut(39, ""), Err(message.to_owned()));
    assert_eq!(cut(38, ""), Ok((40, 40)));
    // Comments around regions are not shown.
    assert_eq!(cut(38, "    // ANCHOR: b\n    // ANCHOR_END: b\n"), Ok((42, 40)));
}

#[test]
fn braces_in_comments_end_nothing() {
    let source = [
        "fn nested() {",
        "    /* } /* } */ } */",
        "    more();",
        "}",
        "fn short() {",
        "    /*/ } */",
        "    more();",
        "}",
        "fn divided() { f(a /* b *// c) }",
        "fn after() {}",
    ];
    let found = |item: &str| find_item(&source, item, false);
    assert_eq!(found("fn nested"), Ok((0, 3)));
    assert_eq!(found("fn short"), Ok((4, 7)));
    assert_eq!(found("fn divided"), Ok((8, 8)));
}

#[test]
fn declarations_that_are_no_toml_are_a_fault_of_their_line() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join(FILE);
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    std::fs::write(&path, "# Excerpts\n[first]\nfile = \"a.rs\"\nitem = \"fn a\"\ncolour = 1\n").unwrap();
    let mut faults = Vec::new();
    let found = read_all(&Library::Checkout(directory.path().to_owned()), &mut faults);
    assert!(found.is_empty());
    assert_eq!(faults.iter().map(|fault| (fault.file.as_str(), fault.line)).collect::<Vec<_>>(), [(FILE, 5)]);
}

#[test]
fn an_excerpt_names_its_first_and_its_last_line() {
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("a.rs"), "\n\nmod b {\n    fn a() {\n        x();\n    }\n}\n")
        .unwrap();
    let library = Library::Checkout(directory.path().to_owned());
    let declared =
        Declared { file: "a.rs".to_owned(), item: Some("fn a".to_owned()), region: None, docs: false };
    let text = "fn a() {\n    x();\n}\n".to_owned();
    assert_eq!(cut(&library, &declared), Ok(Excerpt { file: "a.rs".to_owned(), first: 4, last: 6, text }));
}

#[test]
fn braces_in_texts_and_in_values_end_nothing() {
    for (source, item, last) in [
        (&["fn a() {", "    let b = '\\'';", "    let c = '}';", "}"][..], "fn a", 3),
        (&["fn a() {", "    let b = '\\u{7d}';", "    // }", "    let c = '\\\\';", "}"], "fn a", 4),
        (&["fn a<'a>() -> &'a str {", "    let b = \"}\\\"}\";", "    b", "}"], "fn a", 3),
        (&["pub const A: Row = Row { x: 1 }", "    .doubled();", "fn b() {}"], "const A", 1),
        (&["static A: Row = Row { x: 1 }", "    .doubled();", "fn b() {}"], "static A", 1),
        (&["    let a = Row { x: 1 }", "        .doubled();", "    b();"], "let a", 1),
        (&["type A = [f32; 3];", "fn b() {}"], "type A", 0),
        (&["struct A {", "    x: [f32; 3],", "}", "fn b() {}"], "struct A", 2),
    ] {
        assert_eq!(find_item(source, item, false), Ok((0, last)), "{source:?}");
    }
    let endless = ["fn a() {", "    b();"];
    assert_eq!(find_item(&endless, "fn a", false), Err("the item \"fn a\" has no end".to_owned()));
}

#[test]
fn an_item_is_found_behind_its_visibility_and_its_attributes() {
    for (line, item) in [
        ("pub(crate) const fn a() {}", "fn a"),
        ("pub const A: u32 = 1;", "const A"),
        ("    pub unsafe fn a() {}", "fn a"),
        ("pub(super) async fn a() {}", "fn a"),
        ("static inline double a(void) {}", "double a"),
        ("static const int a = 1;", "const int a"),
        ("@must_use fn a() {}", "fn a"),
        ("@compute @workgroup_size(64) fn a() {}", "fn a"),
        ("@group(0) @binding(1) var<uniform> a: A;", "var<uniform> a"),
        ("pub fn a() {}", "pub fn a"),
    ] {
        assert_eq!(find_item(&["x;", line], item, false), Ok((1, 1)), "{line}");
    }
    for line in ["fn ab() {}", "fn a_b() {}", "fn a2() {}", "// fn a", "x fn a() {}"] {
        assert!(find_item(&[line], "fn a", false).is_err(), "{line}");
    }
}
