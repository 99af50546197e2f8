//! Prints the table of docs/check.md: mistakes are planted into a plain implementation of the book that shares no code
//! with Weekender, at 240x135 and 80 samples in 8 bits, and `weekender check` is asked what is wrong, with `--stage` and
//! without.
//!
//! `cargo run --release --example check_table [MISTAKE...]`; the mistake `right` stands for correct pictures. Mistakes
//! that Weekender does not know are planted, too: for those, a guess counts as right, and so does no answer. So are numbers
//! that are typed wrong; they are named as the answer names them.

#[path = "../tests/program/check/book.rs"]
mod book;

use book::Book;
use book::Material::{Dielectric, Lambertian, Metal};
use glam::DVec3;
use std::sync::atomic::AtomicBool;
use std::time::Instant;
use weekender::comparison::check::{Hypothesis, Mine, judge};
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

/// A number that is typed wrong: what must be said, a stage, and the change.
type Number = (&'static str, &'static str, fn(&mut Book));

const NUMBERS: [Number; 24] = [
    ("the x of the left ball is -1.1", "metal-fuzzy", |it| it.world[2].center.x = -1.1),
    ("the z of the middle ball is -1", "metal-fuzzy", |it| it.world[1].center.z = -1.0),
    ("the y of the ground is -100", "metal-fuzzy", |it| it.world[0].center.y = -100.0),
    ("the radius of the right ball is 0.45", "metal-fuzzy", |it| it.world[3].radius = 0.45),
    ("the fuzz of the right ball is 0.3", "metal-fuzzy", |it| it.world[3].mat = Metal(GOLD, 0.3)),
    ("the fuzz of the left ball is 0", "metal-fuzzy", |it| it.world[2].mat = Metal(DVec3::splat(0.8), 0.0)),
    ("the blue of the right ball is 0.4", "metal-fuzzy", |it| it.world[3].mat = Metal(GOLD.with_z(0.4), 1.0)),
    ("the blue of the middle ball is 0.4", "metal-fuzzy", |it| {
        it.world[1].mat = Lambertian(BLUE.with_z(0.4))
    }),
    ("the blue of the ground is 0.3", "metal-fuzzy", |it| {
        it.world[0].mat = Lambertian(DVec3::new(0.8, 0.8, 0.3));
    }),
    ("the field of view is 85", "metal-fuzzy", |it| it.vfov = 85.0),
    ("the camera's z is 0.1", "metal-fuzzy", |it| it.look_from.z = 0.1),
    ("the red of the ball is 0.7", "lambertian-gamma", |it| {
        it.world[0].mat = Lambertian(DVec3::new(0.7, 0.5, 0.5))
    }),
    ("the radius of the ball is 0.6", "lambertian-gamma", |it| it.world[0].radius = 0.6),
    ("the z of the ball is -1.5", "lambertian-gamma", |it| it.world[0].center.z = -1.5),
    ("the refraction index of the left ball is 1.33", "hollow-glass", |it| {
        it.world[2].mat = Dielectric(1.33)
    }),
    ("the refraction index of the left ball is 2", "hollow-glass", |it| it.world[2].mat = Dielectric(2.0)),
    ("the refraction index of the left ball is 1.52", "hollow-glass", |it| {
        it.world[2].mat = Dielectric(1.52)
    }),
    ("the radius of the air inside the glass is 0.45", "hollow-glass", |it| it.world[3].radius = 0.45),
    ("the refraction index of the air inside the glass is 1", "hollow-glass", |it| {
        it.world[3].mat = Dielectric(1.0)
    }),
    ("the fuzz of the right ball is 0.5", "hollow-glass", |it| it.world[4].mat = Metal(GOLD, 0.5)),
    ("the defocus angle is 5", "defocus", |it| it.defocus_angle = 5.0),
    ("the focus distance is 3", "defocus", |it| it.focus_dist = 3.0),
    ("the field of view is 25", "defocus", |it| it.vfov = 25.0),
    ("the camera's y is 1.8", "defocus", |it| it.look_from.y = 1.8),
];

const GOLD: DVec3 = DVec3::new(0.8, 0.6, 0.2);
const BLUE: DVec3 = DVec3::new(0.1, 0.2, 0.5);

/// Samples per pixel of right pictures.
const SAMPLES: [u32; 12] = [4, 5, 8, 10, 16, 25, 32, 50, 80, 100, 200, 500];

/// Sections whose pictures edition 3 has, too.
const EDITION_3: [&str; 3] = ["lambertian-gamma", "metal-fuzzy", "hollow-glass"];

const SIZE: [u32; 2] = [240, 135];

/// The answers for wrong pictures, with `--stage` or without.
#[derive(Default)]
struct Tally {
    named: usize,
    surely_wrong: Vec<String>,
    passed: Vec<String>,
    seconds: f64,
}

fn main() -> anyhow::Result<()> {
    let wanted: Vec<String> = std::env::args().skip(1).collect();
    let is_wanted = |what: &str| wanted.is_empty() || wanted.iter().any(|name| name == what);
    let mut tallies = [Tally::default(), Tally::default()];
    let mut all = 0;
    println!("| wrong is | stage | with --stage | without |\n|---|---|---|---|");
    let mistakes = PLANTED.into_iter().chain(UNKNOWN).map(|(is, stage)| (is, stage, false, None));
    let third = PLANTED.into_iter().filter(|(_, stage)| EDITION_3.contains(stage));
    let third = third.map(|(is, stage)| (is, stage, true, None));
    let numbers = NUMBERS.into_iter().map(|(is, stage, change)| (is, stage, false, Some(change)));
    for (is, stage, is_third, change) in mistakes.chain(third).chain(numbers).filter(|it| is_wanted(it.0)) {
        let program =
            |mistake| if is_third { Book::of_edition_3(stage, mistake) } else { Book::new(stage, mistake) };
        let mut wrong = program(if change.is_none() { is } else { "" });
        if let Some(change) = change {
            change(&mut wrong);
        }
        let mine = rendered(&wrong, 80, 1);
        assert!(mine != rendered(&program(""), 80, 1), "{is} does not change {stage}");
        all += 1;
        let mut row = format!("| {is} | {stage}{} |", if is_third { ", edition 3" } else { "" });
        for (tally, given) in tallies.iter_mut().zip([Some(stage), None]) {
            let (found, took) = found(&mine, given, is)?;
            tally.seconds += took;
            let case = format!("{is} in {stage}: {found}");
            match found.as_str() {
                "named" => tally.named += 1,
                "right" => tally.passed.push(case),
                "unknown" => {}
                guess if guess.ends_with('?') => {}
                _ => tally.surely_wrong.push(case),
            }
            row += &format!(" {found} |");
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

    let (mut accused, mut pictures) = (Vec::new(), 0);
    for (seed, samples) in (11..).zip(SAMPLES) {
        let programs = book::STAGES.map(|stage| (stage, Book::new(stage, "")));
        for (stage, program) in
            programs.into_iter().chain(EDITION_3.map(|stage| (stage, Book::of_edition_3(stage, ""))))
        {
            let mine = rendered(&program, samples, seed);
            pictures += 1;
            for given in [Some(stage), None] {
                let (found, _) = found(&mine, given, "")?;
                if !["right", "edition-scene", "edition-camera", "edition-fuzz"].contains(&found.as_str()) {
                    accused.push(format!("{stage} ({given:?}), {samples} samples, seed {seed}: {found}"));
                }
            }
        }
    }
    println!(
        "False alarms: {} of {pictures} correct pictures, each tried both ways. {}",
        accused.len(),
        accused.join("; ")
    );
    Ok(())
}

fn rendered(program: &Book, samples: u32, seed: u64) -> Mine {
    let [width, height] = SIZE;
    Mine::of_bytes(program.render(width, height, samples, seed), SIZE)
}

/// The answer for a picture, and how many seconds it took: "named" if what is wrong is among what explains it surely, or the
/// first thing that does; with a question mark, if it is a guess.
fn found(mine: &Mine, stage: Option<&str>, is: &str) -> anyhow::Result<(String, f64)> {
    let begin = Instant::now();
    let finding = judge(mine, stage.map(Stage::find).transpose()?, &AtomicBool::new(false), |_| {})?;
    let seconds = begin.elapsed().as_secs_f64();
    let explains = finding.found.as_ref().unwrap_or(&finding.right);
    let mut all = [&explains.hypothesis].into_iter().chain(&finding.alike).map(said);
    let first = all.next().unwrap_or_default();
    let is_named = |said: &str| said == is || is.contains(' ') && said.starts_with(&format!("{is},"));
    let found = match (finding.is_sure, first) {
        (true, first) if is_named(&first) || all.any(|other| is_named(&other)) => "named".to_owned(),
        (true, first) if first.is_empty() => "right".to_owned(),
        (true, first) => first,
        (false, first) if first.is_empty() => "unknown".to_owned(),
        (false, first) => format!("{first}?"),
    };
    Ok((found, seconds))
}

/// The words of a hypothesis's numbers, or the id of its mistake.
fn said(it: &Hypothesis) -> String {
    let numbers: Vec<&str> = it.numbers.iter().map(|number| number.words.as_str()).collect();
    if numbers.is_empty() { it.named().map_or("", |named| named.id).to_owned() } else { numbers.join("; ") }
}
