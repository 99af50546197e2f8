//! Prints the table of docs/check.md: mistakes are planted into a plain implementation of the book that shares no code
//! with Weekender, at 400x225 and 100 samples in 8 bits, and `weekender check` is asked what is wrong.
//!
//! `cargo run --release --example check_table [MISTAKE...]`; the mistake `right` stands for correct pictures.

#[path = "../tests/check/book.rs"]
mod book;

use book::Book;
use std::time::Instant;
use weekender::pictures::check::{Mine, judge};
use weekender::stages::Stage;

/// Mistakes, each with a stage in which it shows.
const PLANTED: [(&str, &str); 43] = [
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
    ("scale-255", "lambertian-gamma"),
    ("scale-255", "hollow-glass"),
    ("truncated", "lambertian-gamma"),
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
    ("always-refract", "hollow-glass"),
    ("schlick-missing", "hollow-glass"),
    ("hollow-missing", "hollow-glass"),
    ("hollow-index", "hollow-glass"),
];

/// Mistakes of the lens.
const LENS: [(&str, &str); 2] = [("lens-centre", "defocus"), ("focus-distance-one", "defocus")];

const SIZE: [u32; 2] = [400, 225];

/// Random numbers of the planted pictures.
const SEEDS: [u64; 2] = [1, 2];

fn main() -> anyhow::Result<()> {
    let wanted: Vec<String> = std::env::args().skip(1).collect();
    let is_wanted = |mistake: &str| wanted.is_empty() || wanted.iter().any(|name| name == mistake);
    let (mut right, mut all, mut seconds) = (0, 0_u32, 0.0);
    println!("| mistake | stage | named |\n|---|---|---|");
    for (mistake, stage) in PLANTED.into_iter().chain(LENS).filter(|(mistake, _)| is_wanted(mistake)) {
        let mut others = Vec::new();
        for seed in SEEDS {
            let (found, took) = found(stage, mistake, 100, seed)?;
            seconds += took;
            all += 1;
            if found == mistake {
                right += 1;
            } else {
                others.push(found);
            }
        }
        let named = SEEDS.len() - others.len();
        let others = if others.is_empty() { String::new() } else { format!(", else {}", others.join(", ")) };
        println!("| {mistake} | {stage} | {named} of {}{others} |", SEEDS.len());
    }
    println!("\nNamed: {right} of {all}; {:.1} s each.\n", seconds / f64::from(all.max(1)));
    if !is_wanted("right") {
        return Ok(());
    }

    let (mut wrong, mut pictures) = (Vec::new(), 0);
    for stage in book::STAGES {
        for (samples, seed) in [(10, 11), (10, 12), (100, 13)] {
            let (found, _) = found(stage, "", samples, seed)?;
            pictures += 1;
            if found != "right" {
                wrong.push(format!("{stage}, {samples} samples, seed {seed}: {found}"));
            }
        }
    }
    println!("False alarms: {} of {pictures} correct pictures. {}", wrong.len(), wrong.join("; "));
    Ok(())
}

/// What is found in a planted picture, and in how many seconds.
fn found(
    stage: &'static str,
    mistake: &'static str,
    samples: u32,
    seed: u64,
) -> anyhow::Result<(&'static str, f64)> {
    let [width, height] = SIZE;
    let bytes = Book::new(stage, mistake).render(width, height, samples, seed);
    let mine = Mine::of_bytes(bytes, [width, height]);
    let begin = Instant::now();
    let finding = judge(&mine, Some(Stage::find(stage)?))?;
    let seconds = begin.elapsed().as_secs_f64();
    let found = match finding.named() {
        Some(mistake) => mistake.id,
        None if finding.is_right() => "right",
        None => "unknown",
    };
    Ok((found, seconds))
}
