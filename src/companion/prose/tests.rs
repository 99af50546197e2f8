//! Made-up texts as HTML, and what is wrong with them.

use super::*;
use std::collections::BTreeMap;

/// The HTML of a text of the first chapter.
fn converted(site: &Site, text: &str, uses: &mut Uses, faults: &mut Vec<Fault>) -> String {
    let of_text = Chapter { body: text.to_owned(), ..site.chapters[0].clone() };
    chapter(site, &of_text, uses, faults).into_string()
}

/// The HTML of a text that has no faults.
fn alone(site: &Site, text: &str) -> String {
    let mut faults = Vec::new();
    let html = converted(site, text, &mut Uses::default(), &mut faults);
    assert_eq!(faults, [], "{text}");
    html
}

#[test]
fn links_lead_to_what_they_name() {
    let site = Site::made_up();
    for (target, html) in [
        ("#there", "<a href=\"#there\">x</a>"),
        ("https://a.org/b", "<a href=\"https://a.org/b\">x</a>"),
        ("mailto:a@b.org", "<a href=\"mailto:a@b.org\">x</a>"),
        ("page:normals", "<a href=\"#normals\" title=\"Chapter 6: All normals\">x</a>"),
        ("page:languages#two", "<a href=\"#languages-two\" title=\"All languages\">x</a>"),
        (
            "page:normals#6.1",
            "<a href=\"#normals-61-shading-with-surface-normals\" title=\"Section 6.1 Shading with Surface Normals\">x</a>",
        ),
        ("glossary:lane", "<a id=\"use-lane\" class=\"term\" href=\"#term-lane\">x</a>"),
        ("source:src/lib.rs", "x <span class=\"cite\">[<code class=\"path\">src/lib.rs</code>]</span>"),
    ] {
        assert_eq!(alone(&site, &format!("[x]({target})")), format!("<p>{html}</p>\n"));
    }
}

#[test]
fn links_are_noted_with_their_lines_and_only_the_first_to_a_term_can_be_returned_to() {
    let (site, mut uses, mut faults) = (Site::made_up(), Uses::default(), Vec::new());
    let text =
        "[a](#there)\n\n[b](page:languages#two) [c](glossary:ray)\n\n[d](glossary:ray)\n\n[e](page:nowhere)";
    let html = converted(&site, text, &mut uses, &mut faults);
    let target = |anchor: &str, line| (anchor.to_owned(), "normals.md".to_owned(), line);
    assert_eq!(uses.targets, [target("there", 5), target("languages-two", 7)]);
    assert_eq!(uses.terms, BTreeMap::from([("ray".to_owned(), "Some normals".to_owned())]));
    assert_eq!(html.matches("id=\"use-ray\"").count(), 1, "{html}");
    assert!(html.contains("<a class=\"term\" href=\"#term-ray\">d</a>"), "{html}");
    assert_eq!(faults, [Fault::new("normals.md", 11, "the page has no chapter \"nowhere\"")]);
}

#[test]
fn a_link_leads_to_the_section_that_it_names() {
    let (site, mut uses, mut faults) = (Site::made_up(), Uses::default(), Vec::new());
    let text = "## 6.1 Shading with Surface Normals\n\n[6.1](page:normals#6.1) [section 6.1](page:normals) [6.1](book:6)\n\n\
                [6.1](book:6.1) [6.2](page:normals#6.2)";
    // As the page does.
    uses.anchors.insert("normals".to_owned());
    converted(&site, text, &mut uses, &mut faults);
    site.check(&uses, &mut faults);
    faults.retain(|fault| fault.file == "normals.md");
    let names = |target: &str| {
        format!("the link names section 6.1 but leads to {target:?}; write page:CHAPTER#6.1 or book:6.1")
    };
    let nothing =
        "nothing on the page has the anchor #normals-62-simplifying-the-ray-sphere-intersection-code";
    assert_eq!(
        faults,
        [
            Fault::new("normals.md", 7, names("page:normals")),
            Fault::new("normals.md", 7, names("book:6")),
            Fault::new("normals.md", 9, nothing),
        ]
    );
}

#[test]
fn only_a_formula_alone_has_a_wide_paragraph() {
    let site = Site::made_up();
    for (text, is_wide) in
        [("$$x$$", true), ("$$x\n= y$$", true), ("So $$x$$", false), ("$$x$$ holds", false), ("$x$", false)]
    {
        assert_eq!(
            alone(&site, text).starts_with("<p class=\"wide\"><span class=\"formula\""),
            is_wide,
            "{text}"
        );
    }
}

#[test]
fn citations_are_sorted_numbers_in_brackets() {
    let site = Site::made_up();
    let [first, second] = [("first", 1), ("second", 2)]
        .map(|(key, n)| format!("<a href=\"#ref-{key}\" title=\"{key} and others: On {key}\">{n}</a>"));
    assert_eq!(alone(&site, "[@second]"), format!("<p><span class=\"cite\">[{second}]</span></p>\n"));
    assert_eq!(
        alone(&site, "[@second; @first]"),
        format!("<p><span class=\"cite\">[{first}, {second}]</span></p>\n")
    );
}

#[test]
fn a_short_text_has_no_paragraph_around_it() {
    let (site, mut uses, mut faults) = (Site::made_up(), Uses::default(), Vec::new());
    let mut short = |text: &str| short_text(&site, "a.toml", 9, text, &mut uses, &mut faults).into_string();
    assert_eq!(short(" a *b* c\n"), "a <em>b</em> c");
    assert_eq!(short("- a"), "<ul>\n<li>a</li>\n</ul>\n");
    assert_eq!(short("\n[x](nowhere)"), "x");
    assert_eq!((faults.len(), faults[0].file.as_str(), faults[0].line), (1, "a.toml", 9));
}

#[test]
fn a_mark_after_a_formula_stays_with_it() {
    let site = Site::made_up();
    for (text, is_kept) in [("$x$, y", true), ("$x$) y", true), ("$x$ y", false), ("$x$-y", false)] {
        assert_eq!(alone(&site, text).contains("<span class=\"nb\">"), is_kept, "{text}");
    }
}

#[test]
fn what_nothing_refers_to_and_links_to_nothing_are_faults() {
    let (site, mut uses, mut faults) = (Site::made_up(), Uses::default(), Vec::new());
    converted(&site, "## Here\n\n[a](glossary:lane) [b](#normals-here) [c](#gone)", &mut uses, &mut faults);
    site.check(&uses, &mut faults);
    let unlinked = "no chapter links the term \"ray\"; link it as [text](glossary:ray), or remove it";
    assert_eq!(
        faults,
        [
            Fault::new("docs/companion/glossary.toml", 5, unlinked),
            Fault::new("normals.md", 7, "nothing on the page has the anchor #gone"),
        ]
    );
}
