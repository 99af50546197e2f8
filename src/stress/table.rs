//! The table of results, for the terminal and as Markdown.

use super::families::build::counted;
use super::figures::Paired;
use super::report::{CaseReport, StressReport};
use super::verdict::Verdict;
use std::fmt::Write;

/// Column widths of the terminal's table.
const WIDTHS: [usize; 8] = [30, 12, 12, 9, 18, 7, 7, 18];

/// The header of the terminal's table.
pub fn head() -> String {
    line(["case", "expected", "measured", "off by", "rounding (RMS)", "time", "verdict", "book's f32, f64"])
}

/// A case as one line, followed by a line for each backend that is not right.
pub fn row(case: &CaseReport) -> String {
    let [expected, measured, off, rounding, time, verdict, book] = cells(case);
    let mut text = line([&case.id, &expected, &measured, &off, &rounding, &time, &verdict, &book]);
    for wrong in case.measured.iter().filter(|measured| measured.verdict != Verdict::Right) {
        let (backend, form, reason) = (&wrong.backend, wrong.form, wrong.verdict.reason());
        // Writing to a string cannot fail.
        let _ = writeln!(text, "    {backend}, {form}: {reason}");
    }
    if let Some(hits) = case.first_hits.filter(|hits| !hits.is_right()) {
        let (agree, rays) = (hits.agree, hits.rays);
        let _ = writeln!(
            text,
            "    only {agree} of {rays} rays from the eye hit the same surface as in 106-bit arithmetic"
        );
    }
    text
}

fn cells(case: &CaseReport) -> [String; 7] {
    let worst = case.worst();
    let or_dash = |value: Option<String>| value.unwrap_or_else(|| "-".to_owned());
    let verdicts = || case.measured.iter().map(|measured| &measured.verdict);
    let is_warned = |verdict: &&Verdict| matches!(verdict, Verdict::Warned(_));
    let verdict = match verdicts().find(|verdict| !verdict.is_right()).or_else(|| verdicts().find(is_warned))
    {
        _ if case.first_hits.is_some_and(|hits| !hits.is_right()) => "WRONG",
        Some(verdict) => verdict.name(),
        None => "right",
    };
    let book = case.book.iter().map(|book| or_dash(book.offset.map(brief))).collect::<Vec<_>>().join(", ");
    [
        case.expected.clone(),
        or_dash(worst.and_then(|worst| worst.mean).map(|mean| format!("{mean:.6}"))),
        or_dash(worst.and_then(|worst| worst.offset).map(brief)),
        or_dash(case.rounding().map(rounding)),
        or_dash(case.time_ratio().map(|ratio| format!("{ratio:.1}x"))),
        verdict.to_owned(),
        book,
    ]
}

/// A small number with its sign; zero as a plain 0.
fn brief(value: f64) -> String {
    if value == 0.0 { "0".to_owned() } else { format!("{value:+.1e}") }
}

fn rounding(paired: Paired) -> String {
    let rms = if paired.rms == 0.0 { "0".to_owned() } else { format!("{:.0e}", paired.rms) };
    format!("{} ({rms})", brief(paired.bias))
}

fn line<S: AsRef<str>>(cells: [S; 8]) -> String {
    let mut text = String::new();
    for (cell, width) in cells.iter().zip(WIDTHS) {
        let _ = write!(text, "{:width$} ", cell.as_ref());
    }
    text.truncate(text.trim_end().len());
    text.push('\n');
    text
}

/// One line that sums up the run.
pub fn summary(report: &StressReport) -> String {
    let count = report.cases.len();
    let wrong: Vec<&CaseReport> = report.cases.iter().filter(|case| !case.is_right()).collect();
    let failures = |precision: &str| {
        let has_failed = |case: &&CaseReport| {
            case.book.iter().any(|book| book.precision == precision && !book.verdict.is_right())
        };
        report.cases.iter().filter(has_failed).count()
    };
    let so_far =
        if report.interrupted { format!(" run so far, of {},", report.chosen) } else { String::new() };
    let mut text = format!(
        "\n{} of {}{} right on {} in {:.0} s; with the book's arithmetic, {} in f32 and {} in f64\n",
        count - wrong.len(),
        counted(count, "case"),
        so_far,
        report.backends.join(", "),
        report.seconds,
        count - failures("f32"),
        count - failures("f64"),
    );
    if report.interrupted {
        let missing = report.chosen.saturating_sub(count);
        let _ = writeln!(text, "interrupted: {} not run", counted(missing, "case"));
    }
    text
}

/// The table as Markdown, one section per family.
pub fn markdown(report: &StressReport) -> String {
    let mut text = String::new();
    let mut family = "";
    for case in &report.cases {
        if case.family != family {
            family = case.family;
            let lesson = super::families::families().find(|f| f.title == family).map_or("", |f| f.lesson);
            let _ = write!(text, "\n### {family}\n\n{lesson}\n\n{MARKDOWN_HEAD}");
        }
        let [expected, _, off, rounding, time, _, book] = cells(case);
        let (id, stiff) = (&case.id, &case.stiff);
        let verdict = verdicts(case);
        let _ = writeln!(
            text,
            "| `{id}` | {stiff} | {expected} | {off} | {rounding} | {time} | {verdict} | {book} |"
        );
    }
    text
}

const MARKDOWN_HEAD: &str = "| case | what is stiff about it | expected | off by | rounding (RMS) | time | verdict | \
                             book's f32, f64 |\n|---|---|---|---|---|---|---|---|\n";

/// "right", or the backends that are not and their verdicts.
fn verdicts(case: &CaseReport) -> String {
    let wrong: Vec<String> = case
        .measured
        .iter()
        .filter(|measured| measured.verdict != Verdict::Right)
        .map(|m| format!("{} {}: **{}**", m.backend, m.form, m.verdict.name().to_lowercase()))
        .collect();
    if wrong.is_empty() { "right".to_owned() } else { wrong.join(", ") }
}

#[cfg(test)]
mod tests {
    use super::super::report::{BookMeasured, FirstHits, Measured};
    use super::*;

    fn case(verdict: Verdict) -> CaseReport {
        let measured = |backend: &str, offset, verdict| Measured {
            backend: backend.to_owned(),
            form: "plain",
            mean: Some(0.5 + offset),
            offset: Some(offset),
            deviation: Some(0.0),
            rounding: Some(Paired { bias: offset, bias_deviation: 0.0, rms: 1e-5 }),
            seconds: Some(0.2),
            tame_seconds: Some(0.1),
            verdict,
        };
        CaseReport {
            id: "copies/2".into(),
            family: "Many spheres at the same place",
            stiff: "two".into(),
            expected: "0.5".into(),
            why: "",
            tolerance: 1e-6,
            spheres: 2,
            first_hits: Some(FirstHits { rays: 64, agree: 64 }),
            measured: vec![measured("avx2", 0.0, Verdict::Right), measured("sse4.2", -0.25, verdict)],
            book: vec![BookMeasured { precision: "f32", mean: None, offset: None, verdict: Verdict::Right }],
        }
    }

    #[test]
    fn a_line_shows_the_worst_and_names_who_is_wrong() {
        let text = row(&case(Verdict::Wrong("off".into())));
        let mut lines = text.lines();
        let words: Vec<&str> = lines.next().unwrap().split_whitespace().collect();
        assert_eq!(
            words,
            ["copies/2", "0.5", "0.250000", "-2.5e-1", "-2.5e-1", "(1e-5)", "2.0x", "WRONG", "-"]
        );
        assert_eq!(lines.next(), Some("    sse4.2, plain: off"));
        assert_eq!(row(&case(Verdict::Right)).lines().count(), 1);
        let with_hits = |first_hits| row(&CaseReport { first_hits, ..case(Verdict::Right) });
        assert!(with_hits(None).contains(" right ") && !with_hits(None).contains("WRONG"));
        assert!(with_hits(Some(FirstHits { rays: 64, agree: 7 })).contains("WRONG"));
        assert_eq!(rounding(Paired::default()), "0 (0)");
    }

    #[test]
    fn documents_have_a_table_for_each_family() {
        let mut report = StressReport {
            schema: 1,
            version: "",
            backends: vec!["avx2".into()],
            seconds: 1.0,
            chosen: 2,
            interrupted: false,
            cases: vec![case(Verdict::Right), case(Verdict::None("gone".into()))],
        };
        let text = markdown(&report);
        assert_eq!(text.matches("### Many spheres at the same place").count(), 1);
        assert!(text.contains("| right |") && text.contains("| sse4.2 plain: **none** |"), "{text}");
        assert!(text.contains("Two surfaces at the same place tie"), "{text}");
        assert!(summary(&report).contains("1 of 2 cases right on avx2"), "{}", summary(&report));
        report.cases[0].book[0].verdict = Verdict::Wrong("off".into());
        let double = BookMeasured { precision: "f64", mean: None, offset: None, verdict: Verdict::Right };
        report.cases[0].book.push(double);
        let text = summary(&report);
        assert!(text.ends_with("; with the book's arithmetic, 1 in f32 and 2 in f64\n"), "{text}");
        (report.chosen, report.interrupted) = (5, true);
        let text = summary(&report);
        assert!(text.contains("1 of 2 cases run so far, of 5, right on avx2"), "{text}");
        assert!(text.ends_with("interrupted: 3 cases not run\n"), "{text}");
    }

    #[test]
    fn columns_stand_below_their_heads() {
        let line = |[a, b, c, d, e, f, g, h]: [&str; 8]| {
            format!("{a:30} {b:12} {c:12} {d:9} {e:18} {f:7} {g:7} {h}")
        };
        let names = [
            "case",
            "expected",
            "measured",
            "off by",
            "rounding (RMS)",
            "time",
            "verdict",
            "book's f32, f64",
        ];
        assert_eq!(head(), line(names) + "\n");
        let mut told = case(Verdict::Warned("too thin".into()));
        let cells = ["copies/2", "0.5", "0.250000", "-2.5e-1", "-2.5e-1 (1e-5)", "2.0x"];
        let [a, b, c, d, e, f] = cells;
        assert_eq!(row(&told).lines().next(), Some(line([a, b, c, d, e, f, "warned", "-"]).as_str()));
        told.measured[0].verdict = Verdict::None("gone".into());
        assert_eq!(row(&told).lines().next(), Some(line([a, b, c, d, e, f, "NONE", "-"]).as_str()));
        told.book.push(BookMeasured {
            precision: "f64",
            mean: None,
            offset: Some(0.0),
            verdict: Verdict::Right,
        });
        told.book[0].offset = Some(0.25);
        told.measured.clear();
        let cells: Vec<String> = row(&told).split_whitespace().map(str::to_owned).collect();
        assert_eq!(cells, ["copies/2", "0.5", "-", "-", "-", "-", "right", "+2.5e-1,", "0"]);
    }
}
