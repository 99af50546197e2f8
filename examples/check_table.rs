//! Prints the table of docs/check.md: mistakes are planted into a plain implementation of the book that shares no code
//! with Weekender, at 240x135 and 80 samples in 8 bits, and `weekender check` is asked what is wrong, with `--stage` and
//! without.
//!
//! `cargo run --release --example check_table [MISTAKE...]`; the mistake `right` stands for correct pictures.

#[path = "../tests/check/book.rs"]
mod book;

use book::Book;
use std::time::Instant;
use weekender::pictures::check::{Mine, judge};
use weekender::stages::Stage;

/// Mistakes, each with a stage in which it shows.
const PLANTED: [(&str, &str); 51] = [
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
    ("glass-black", "hollow-glass"),
    ("glass-swapped", "hollow-glass"),
    ("always-refract", "hollow-glass"),
    ("schlick-missing", "hollow-glass"),
    ("hollow-missing", "hollow-glass"),
    ("hollow-index", "hollow-glass"),
];

/// Mistakes of the lens and of the random numbers.
const OTHERS: [(&str, &str); 6] = [
    ("lens-centre", "defocus"),
    ("lens-origin", "defocus"),
    ("lens-aim", "defocus"),
    ("focus-distance-one", "defocus"),
    ("same-seed", "lambertian-gamma"),
    ("same-seed", "hollow-glass"),
];

const SIZE: [u32; 2] = [240, 135];

/// Random numbers of the planted pictures.
const SEEDS: [u64; 1] = [1];

fn main() -> anyhow::Result<()> {
    let wanted: Vec<String> = std::env::args().skip(1).collect();
    let is_wanted = |mistake: &str| wanted.is_empty() || wanted.iter().any(|name| name == mistake);
    let (mut right, mut all, mut seconds) = ([0; 2], 0_u32, [0.0; 2]);
    println!("| mistake | stage | named with --stage | without |\n|---|---|---|---|");
    for (mistake, stage) in PLANTED.into_iter().chain(OTHERS).filter(|(mistake, _)| is_wanted(mistake)) {
        let mut others = [Vec::new(), Vec::new()];
        for seed in SEEDS {
            let mine = planted(stage, mistake, 80, seed);
            all += 1;
            for (way, given) in [Some(stage), None].into_iter().enumerate() {
                let (found, took) = found(&mine, given, mistake)?;
                seconds[way] += took;
                if found == mistake {
                    right[way] += 1;
                } else {
                    others[way].push(found);
                }
            }
        }
        let named = |others: &Vec<String>| match others.as_slice() {
            [] => format!("{} of {0}", SEEDS.len()),
            _ => format!("{} of {}, else {}", SEEDS.len() - others.len(), SEEDS.len(), others.join(", ")),
        };
        println!("| {mistake} | {stage} | {} | {} |", named(&others[0]), named(&others[1]));
    }
    let each = seconds.map(|seconds| seconds / f64::from(all.max(1)));
    println!(
        "\nNamed of {all}: {} with --stage, {:.1} s each; {} without, {:.1} s each.\n",
        right[0], each[0], right[1], each[1]
    );
    if !is_wanted("right") {
        return Ok(());
    }

    let (mut wrong, mut pictures) = (Vec::new(), 0);
    for stage in book::STAGES {
        for (samples, seed) in [(4, 11), (10, 12), (80, 13)] {
            let mine = planted(stage, "", samples, seed);
            pictures += 1;
            for given in [Some(stage), None] {
                let (found, _) = found(&mine, given, "")?;
                if found != "right" {
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

fn planted(stage: &'static str, mistake: &'static str, samples: u32, seed: u64) -> Mine {
    let [width, height] = SIZE;
    Mine::of_bytes(Book::new(stage, mistake).render(width, height, samples, seed), SIZE)
}

/// What is found in a picture, and in how many seconds. If two mistakes give the same picture, the planted one counts.
fn found(mine: &Mine, stage: Option<&str>, planted: &str) -> anyhow::Result<(String, f64)> {
    let begin = Instant::now();
    let finding = judge(mine, stage.map(Stage::find).transpose()?, |_| {})?;
    let seconds = begin.elapsed().as_secs_f64();
    if finding.alike.iter().any(|alike| alike.id == planted) {
        return Ok((planted.to_owned(), seconds));
    }
    let found = match finding.named() {
        Some(mistake) if finding.is_sure => mistake.id.to_owned(),
        Some(mistake) => format!("{}?", mistake.id),
        None if finding.is_right() => "right".to_owned(),
        None => "unknown".to_owned(),
    };
    Ok((found, seconds))
}
