//! Prints the table of docs/check.md: mistakes are planted into a plain implementation of the book that shares no code
//! with Weekender, at 240x135 and 80 samples in 8 bits, and `weekender check` is asked what is wrong, with `--stage` and
//! without.
//!
//! `cargo run --release --example check_table [MISTAKE...]`; the mistake `right` stands for correct pictures. Mistakes
//! that Weekender does not know are planted, too: for those, a guess counts as right, and so does no answer.

#[path = "../tests/program/check/book.rs"]
mod book;

use book::Book;
use std::sync::atomic::AtomicBool;
use std::time::Instant;
use weekender::comparison::check::{Mine, judge};
use weekender::stages::Stage;

/// Mistakes, each with a stage in which it shows.
const PLANTED: [(&str, &str); 56] = [
    ("flipped-rows", "lambertian-gamma"),
    ("flipped-rows", "hollow-glass"),
    ("mirrored-columns", "hollow-glass"),
    ("swapped-channels", "lambertian-gamma"),
    ("swapped-channels", "hollow-glass"),
    ("no-gamma", "lambertian-gamma"),
    ("no-gamma", "hollow-glass"),
    ("gamma-early", "diffuse"),
    ("gamma-twice", "lambertian-gamma"),
    ("gamma-twice", "hollow-glass"),
    ("gamma-2.2", "lambertian-gamma"),
    ("gamma-2.2", "hollow-glass"),
    ("gamma-srgb", "lambertian-gamma"),
    ("gamma-srgb", "hollow-glass"),
    ("wraps-to-0", "lambertian-gamma"),
    ("wraps-to-0", "hollow-glass"),
    ("scale-255", "lambertian-gamma"),
    ("scale-255", "hollow-glass"),
    ("no-antialiasing", "antialiased"),
    ("no-antialiasing", "hollow-glass"),
    ("half-pixel-up", "antialiased"),
    ("half-pixel-up", "hollow-glass"),
    ("half-pixel-down", "lambertian-gamma"),
    ("width-less-one", "lambertian-gamma"),
    ("width-less-one", "hollow-glass"),
    ("integer-aspect", "lambertian-gamma"),
    ("vfov-radians", "hollow-glass"),
    ("vfov-radians", "defocus"),
    ("sky-reversed", "lambertian-gamma"),
    ("half-b-sign", "normals-world"),
    ("half-b-sign", "lambertian-gamma"),
    ("last-hit-wins", "lambertian-gamma"),
    ("last-hit-wins", "hollow-glass"),
    ("zero-t-min", "lambertian-gamma"),
    ("normal-not-unit", "normals-world"),
    ("normals-not-flipped", "hollow-glass"),
    ("hemisphere", "lambertian-gamma"),
    ("lambertian-early", "diffuse"),
    ("point-in-sphere", "lambertian-gamma"),
    ("bounce-limit", "hollow-glass"),
    ("fuzz-missing", "metal-fuzzy"),
    ("fuzz-unnormalised", "metal-fuzzy"),
    ("refract-unnormalised", "hollow-glass"),
    ("index-inverted", "hollow-glass"),
    ("glass-black", "hollow-glass"),
    ("glass-swapped", "hollow-glass"),
    ("always-refract", "hollow-glass"),
    ("schlick-missing", "hollow-glass"),
    ("lens-centre", "defocus"),
    ("lens-origin", "defocus"),
    ("lens-aim", "defocus"),
    ("focus-distance-one", "defocus"),
    ("same-seed", "lambertian-gamma"),
    ("same-seed", "hollow-glass"),
    ("hollow-missing", "hollow-glass"),
    ("hollow-index", "hollow-glass"),
];

/// Mistakes that Weekender does not know.
const UNKNOWN: [(&str, &str); 12] = [
    ("albedo-squared", "lambertian-gamma"),
    ("albedo-squared", "hollow-glass"),
    ("narrow-lobe", "lambertian-gamma"),
    ("sky-mirrored", "hollow-glass"),
    ("sky-plain", "lambertian-gamma"),
    ("tone-mapped", "lambertian-gamma"),
    ("tone-mapped", "hollow-glass"),
    ("vignette", "metal-fuzzy"),
    ("blue-lost", "lambertian-gamma"),
    ("blue-lost", "defocus"),
    ("truncated", "sky"),
    ("truncated", "lambertian-gamma"),
];

/// Samples per pixel of right pictures.
const SAMPLES: [u32; 12] = [4, 5, 8, 10, 16, 25, 32, 50, 80, 100, 200, 500];

/// Sections whose pictures edition 3 has, too.
const EDITION_3: [&str; 3] = ["lambertian-gamma", "metal-fuzzy", "hollow-glass"];

const SIZE: [u32; 2] = [240, 135];

/// The answers for planted mistakes, with `--stage` or without.
#[derive(Default)]
struct Tally {
    named: usize,
    surely_wrong: Vec<String>,
    passed: Vec<String>,
    seconds: f64,
}

fn main() -> anyhow::Result<()> {
    let wanted: Vec<String> = std::env::args().skip(1).collect();
    let is_wanted = |mistake: &str| wanted.is_empty() || wanted.iter().any(|name| name == mistake);
    let mut tallies = [Tally::default(), Tally::default()];
    let mut all = 0;
    println!("| mistake | stage | with --stage | without |\n|---|---|---|---|");
    let third = PLANTED.into_iter().filter(|(_, stage)| EDITION_3.contains(stage));
    let all_cases =
        PLANTED.into_iter().chain(UNKNOWN).map(|it| (it, false)).chain(third.map(|it| (it, true)));
    for ((mistake, stage), is_third) in all_cases.filter(|((mistake, _), _)| is_wanted(mistake)) {
        let mine = planted(stage, mistake, is_third, 80, 1);
        all += 1;
        let mut row = format!("| {mistake} | {stage}{} |", if is_third { ", edition 3" } else { "" });
        for (tally, given) in tallies.iter_mut().zip([Some(stage), None]) {
            let (found, took) = found(&mine, given, mistake)?;
            tally.seconds += took;
            let case = format!("{mistake} in {stage}: {found}");
            match found.as_str() {
                _ if found == mistake => tally.named += 1,
                "right" => tally.passed.push(case),
                "unknown" => {}
                guess if guess.ends_with('?') => {}
                _ => tally.surely_wrong.push(case),
            }
            row += &format!(" {} |", if found == mistake { "named" } else { &found });
        }
        println!("{row}");
    }
    for (tally, way) in tallies.iter().zip(["With --stage", "Without"]) {
        println!(
            "\n{way}: {} of {all} named surely, {} surely called something else ({}), {} called right ({}), {:.1} s each.",
            tally.named,
            tally.surely_wrong.len(),
            tally.surely_wrong.join("; "),
            tally.passed.len(),
            tally.passed.join("; "),
            tally.seconds / f64::from(all.max(1))
        );
    }
    println!();
    if !is_wanted("right") {
        return Ok(());
    }

    let (mut wrong, mut pictures) = (Vec::new(), 0);
    for (seed, samples) in (11..).zip(SAMPLES) {
        for (stage, is_third) in
            book::STAGES.into_iter().map(|it| (it, false)).chain(EDITION_3.map(|it| (it, true)))
        {
            let mine = planted(stage, "", is_third, samples, seed);
            pictures += 1;
            for given in [Some(stage), None] {
                let (found, _) = found(&mine, given, "")?;
                if !["right", "edition-scene", "edition-camera", "edition-fuzz"].contains(&found.as_str()) {
                    wrong.push(format!("{stage} ({given:?}), {samples} samples, seed {seed}: {found}"));
                }
            }
        }
    }
    println!(
        "False alarms: {} of {pictures} correct pictures, each tried both ways. {}",
        wrong.len(),
        wrong.join("; ")
    );
    Ok(())
}

fn planted(stage: &'static str, mistake: &'static str, is_third: bool, samples: u32, seed: u64) -> Mine {
    let [width, height] = SIZE;
    let program = if is_third { Book::of_edition_3 } else { Book::new };
    let picture = |mistake| program(stage, mistake).render(width, height, samples, seed);
    let shown = picture(mistake);
    assert!(mistake.is_empty() || shown != picture(""), "{mistake} does not change {stage}");
    Mine::of_bytes(shown, SIZE)
}

/// The finding for a picture, and how many seconds it took: a sure number in its words, or the id of a mistake. If two
/// mistakes give the same picture, the planted one counts.
fn found(mine: &Mine, stage: Option<&str>, planted: &str) -> anyhow::Result<(String, f64)> {
    let begin = Instant::now();
    let finding = judge(mine, stage.map(Stage::find).transpose()?, &AtomicBool::new(false), |_| {})?;
    let seconds = begin.elapsed().as_secs_f64();
    if finding.alike.iter().filter_map(|alike| alike.named()).any(|alike| alike.id == planted) {
        return Ok((planted.to_owned(), seconds));
    }
    let explains = finding.found.as_ref().map_or(&[][..], |found| &found.hypothesis.numbers);
    if let (Some(number), true) = (explains.first(), finding.is_sure) {
        return Ok((format!("number: {}", number.words), seconds));
    }
    let found = match finding.named() {
        Some(mistake) if finding.is_sure => mistake.id.to_owned(),
        Some(mistake) => format!("{}?", mistake.id),
        None if finding.is_right() => "right".to_owned(),
        None => "unknown".to_owned(),
    };
    Ok((found, seconds))
}
