//! `weekender check`: right pictures pass, planted mistakes are named, damaged files are understood.

mod book;
mod cases;

use crate::common::program::{ends, json_file, refused};
use book::Book;
use std::fmt::Write;
use std::sync::atomic::AtomicBool;
use tempfile::TempDir;
use weekender::comparison::check::{Finding, Mine, judge};
use weekender::stages::Stage;

fn mine(stage: &'static str, mistake: &'static str, samples: u32, seed: u64) -> Mine {
    made_by(&Book::new(stage, mistake), samples, seed)
}

fn made_by(program: &Book, samples: u32, seed: u64) -> Mine {
    let (width, height) = (160, 90);
    let bytes = program.render(width, height, samples, seed);
    Mine::of_bytes(bytes, [width, height])
}

/// The id of the mistake found, or "right".
fn found(mine: &Mine, stage: &str) -> &'static str {
    let finding = judge(mine, Some(Stage::find(stage).unwrap()), &AtomicBool::new(false), |_| {}).unwrap();
    match finding.named() {
        Some(mistake) => mistake.id,
        None if finding.is_right() => "right",
        None => "unknown",
    }
}

/// The mistakes found: the one named and those that give the same picture.
fn ids(finding: &Finding) -> Vec<&'static str> {
    let alike = finding.alike.iter().filter_map(|alike| alike.named());
    finding.named().into_iter().chain(alike).map(|mistake| mistake.id).collect()
}

#[test]
fn noise_is_not_a_mistake() {
    for (stage, samples) in book::STAGES.into_iter().zip([10, 60].into_iter().cycle()) {
        let mine = mine(stage, "", samples, u64::from(samples));
        assert_eq!(found(&mine, stage), "right", "{stage}, {samples} samples");
    }
}

#[test]
fn planted_mistakes_are_named() {
    let planted = [
        ("normals-world", "normal-not-unit"),
        ("antialiased", "no-antialiasing"),
        ("lambertian-gamma", "gamma-twice"),
        ("lambertian-gamma", "zero-t-min"),
        ("lambertian-gamma", "point-in-sphere"),
        ("metal-fuzzy", "fuzz-missing"),
        ("hollow-glass", "index-inverted"),
        ("hollow-glass", "vfov-radians"),
        ("hollow-glass", "normals-not-flipped"),
        ("defocus", "focus-distance-one"),
        // Its picture has other random numbers than the right one.
        ("defocus", "lens-centre"),
        ("lambertian-gamma", "wraps-to-0"),
        ("lambertian-gamma", "same-seed"),
    ]
    .map(|(stage, mistake)| (stage, mistake, Book::new(stage, mistake)));
    let (stage, mistake) = ("hollow-glass", "last-hit-wins");
    let in_edition_3 = (stage, mistake, Book::of_edition_3(stage, mistake));
    let wrong: Vec<String> = planted
        .into_iter()
        .chain([in_edition_3])
        .filter_map(|(stage, mistake, program)| {
            let mine = made_by(&program, 60, 3);
            let finding =
                judge(&mine, Some(Stage::find(stage).unwrap()), &AtomicBool::new(false), |_| {}).unwrap();
            let named = ids(&finding);
            (!named.contains(&mistake)).then(|| format!("{stage}: {mistake} is {named:?}"))
        })
        .collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
    // More samples have less noise than ours.
    let of_one_seed = Book::new("lambertian-gamma", "same-seed").render(240, 135, 80, 1);
    assert_eq!(found(&Mine::of_bytes(of_one_seed, [240, 135]), "lambertian-gamma"), "same-seed");
}

/// Some mistake is always closer than none, but no mistake turns one scene into another.
#[test]
fn other_scene_gets_only_guesses() {
    let finding = judge(
        &mine("lambertian-gamma", "", 30, 7),
        Stage::find("hollow-glass").ok(),
        &AtomicBool::new(false),
        |_| {},
    )
    .unwrap();
    assert!(!finding.is_sure, "{:?}", ids(&finding));
}

#[test]
fn without_a_stage_right_is_right() {
    let blurred = Book::new("defocus", "").render(240, 135, 10, 12);
    let blurred = Mine::of_bytes(blurred, [240, 135]);
    let pictures = book::STAGES.map(|stage| (stage, mine(stage, "", 30, 3)));
    for (stage, mine) in pictures.into_iter().chain([("defocus", blurred)]) {
        let finding = judge(&mine, None, &AtomicBool::new(false), |_| {}).unwrap();
        assert!(finding.is_right(), "{stage} as {}: {:?}", finding.stage.id, ids(&finding));
    }
}

#[test]
fn without_a_stage_no_answer_is_surely_wrong() {
    let planted = [
        ("normals-world", "normal-not-unit", 1),
        ("lambertian-gamma", "flipped-rows", 30),
        ("lambertian-gamma", "zero-t-min", 60),
        ("defocus", "vfov-radians", 30),
    ];
    for (stage, mistake, samples) in planted {
        let finding =
            judge(&mine(stage, mistake, samples, 3), None, &AtomicBool::new(false), |_| {}).unwrap();
        let named = ids(&finding);
        assert!(!finding.is_sure || named.contains(&mistake), "{stage}, {mistake}: {named:?}");
    }
    // Neither a mistake that changes most of the picture nor one that changes what differs between stages hides its stage.
    for (stage, mistake) in [("lambertian-gamma", "sky-reversed"), ("hollow-glass", "index-inverted")] {
        let finding = judge(&mine(stage, mistake, 60, 3), None, &AtomicBool::new(false), |_| {}).unwrap();
        assert!(finding.is_sure && ids(&finding).contains(&mistake), "{mistake}: {:?}", ids(&finding));
    }
}

#[test]
fn finding_sets_exit_code_files_and_json() {
    let at = TempDir::new().unwrap();
    let at = at.path();
    for (name, mistake) in [("right.ppm", ""), ("wrong.ppm", "gamma-twice")] {
        let mine = mine("lambertian-gamma", mistake, 20, 2);
        let mut file = format!("P3\n{} {}\n255\n", mine.width, mine.height);
        for [r, g, b] in mine.bytes {
            writeln!(file, "{r} {g} {b}").unwrap();
        }
        std::fs::write(at.join(name), file).unwrap();
    }
    let check = |code: i32, flags: &[&str]| ends(at, code, &[&["check"], flags].concat());
    let stage = ["--stage", "lambertian-gamma"];
    let (text, _) = check(0, &[&["right.ppm"], &stage[..]].concat());
    assert!(text.contains("noise only"), "{text}");
    check(1, &[&["wrong.ppm", "--out", "d", "--json", "found.json"], &stage[..]].concat());
    let json = json_file(&at.join("found.json"));
    assert_eq!((&json["mistake"]["id"], &json["stage"]), (&"gamma-twice".into(), &"lambertian-gamma".into()));
    assert_eq!(json["is_right"], false);
    for name in ["mine.png", "ours.png", "difference.png"] {
        let read = Mine::read(&at.join("d").join(name)).unwrap();
        assert_eq!((read.width, read.height), (160, 90), "{name}");
    }
    // Our own picture in the same place is right.
    check(0, &[&["d/ours.png"], &stage[..]].concat());
    for (arguments, part) in [
        (&["nothing.ppm"][..], "nothing.ppm"),
        (&["right.ppm", "--stage", "metall"], "'metal'"),
        (&["right.ppm", "--out", "right.ppm"], "right.ppm"),
        (&["right.ppm", "--json", "nowhere/found.json"], "nowhere"),
        (&["d/mine.png", "--out", "d"], "would replace"),
    ] {
        refused(at, &[&["check"], arguments].concat(), &[part]);
    }
}

#[test]
fn blank_or_tiny_picture_is_refused() {
    let directory = TempDir::new().unwrap();
    let path = directory.path().join("tiny.ppm");
    let read = |width: usize, height: usize, pixels: String| {
        std::fs::write(&path, format!("P3\n{width} {height}\n255\n{pixels}")).unwrap();
        Mine::read(&path).map_err(|error| error.to_string())
    };
    for [width, height] in [[1, 1], [15, 9], [16, 8]] {
        let refused = read(width, height, "0 0 0\n".repeat(width * height)).unwrap_err();
        assert!(refused.contains(&format!("{width} x {height} pixels, fewer than 16 x 9")), "{refused}");
    }
    for value in ["0 0 0", "255 255 255", "9 8 7"] {
        let refused = read(16, 9, format!("{value}\n").repeat(16 * 9)).unwrap_err();
        assert!(refused.contains(&format!("all its pixels are {value}, so")), "{refused}");
        assert!(refused.contains("number of samples") && refused.contains("int(x) * 256"), "{refused}");
    }
    assert!(read(16, 9, "1 0 0\n".to_owned() + &"0 0 0\n".repeat(16 * 9 - 1)).is_ok());
}
