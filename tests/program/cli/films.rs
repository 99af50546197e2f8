//! Film files: saved, resumed, merged.

use super::common::{film, json_file, refused_in, render, succeeds, temp};

#[test]
fn a_saved_scene_renders_the_same_film() {
    let directory = temp();
    let at = |name: &str| directory.path().join(name);
    for from in [["--scene", "book"], ["--stage", "gamut"], ["--stage", "shadow-acne"]] {
        succeeds(directory.path(), &[&from[..], &["--save-scene", "s.toml", "--size", "32x18"]].concat());
        render(directory.path(), &[&from[..], &["--samples", "4", "--out", "a.exr"]].concat());
        render(directory.path(), &["--scene", "s.toml", "--samples", "4", "--out", "b.exr"]);
        assert_eq!(film(&at("a.exr")), film(&at("b.exr")), "{from:?}");
    }
}

#[test]
fn seconds_add_up_over_runs() {
    use weekender::film::{checkpoint, key};
    let directory = temp();
    let at = |name: &str| directory.path().join(name);
    render(directory.path(), &["--samples", "4", "--out", "film.exr"]);
    // As if the earlier run had taken long.
    let mut kept = checkpoint::load(&at("film.exr")).unwrap();
    assert!(kept.description.get(key::SECONDS).unwrap().parse::<f64>().unwrap() > 0.0);
    kept.description.set(key::SECONDS, 1000.0);
    checkpoint::save(&at("film.exr"), &kept.film, &kept.description).unwrap();
    let resume = ["--resume", "film.exr", "--samples", "64", "--checkpoint", "more.exr"];
    render(directory.path(), &[&resume[..], &["--out", "more.png", "--json", "more.json"]].concat());
    let description = checkpoint::load(&at("more.exr")).unwrap().description;
    let both: f64 = description.get(key::SECONDS).unwrap().parse().unwrap();
    let of_run = json_file(&at("more.json"))["trace_seconds"].as_f64().unwrap();
    let added = &json_file(&at("more.json"))["added_samples_per_pixel"];
    assert_eq!((added, film(&at("more.exr")).sample_count()), (&60.into(), 64));
    assert!(of_run > 0.0 && (both - 1000.0 - of_run).abs() < 1e-6, "{both} of 1000 and {of_run}");
}

/// What a film has is denoised; nothing is rendered unless more is asked for.
#[test]
fn denoising_a_film_renders_nothing() {
    use weekender::film::{checkpoint, key};
    let directory = temp();
    let at = |name: &str| directory.path().join(name);
    render(directory.path(), &["--sample-range", "64..96", "--out", "a.exr"]);
    render(directory.path(), &["--sample-range", "128..160", "--out", "b.exr"]);
    succeeds(directory.path(), &["merge", "a.exr", "b.exr", "--denoise", "--out", "m.exr", "--out", "m.png"]);
    let merged = checkpoint::load(&at("m.exr")).unwrap();
    assert!(merged.description.get(key::DENOISED).is_some() && at("m.png").exists());
    // Its command is the merge, not that of its first part.
    assert!(merged.description.get(key::COMMAND).unwrap().contains("merge a.exr b.exr"));
    for (film, more, added) in [("m.exr", &[][..], 0), ("a.exr", &[], 0), ("a.exr", &["--samples", "96"], 64)]
    {
        let flags = ["--resume", film, "--denoise", "--out", "d.exr", "--json", "d.json"];
        render(directory.path(), &[&flags[..], more].concat());
        let figures = json_file(&at("d.json"));
        assert_eq!(figures["added_samples_per_pixel"], added, "{film} {more:?}");
        assert!(figures["denoised"].is_string());
        assert!(succeeds(directory.path(), &["info", "d.exr"]).contains("denoised"));
    }
    // A film that becomes its own denoised one keeps its samples.
    render(directory.path(), &["--resume", "a.exr", "--denoise", "--out", "a.exr"]);
    assert_eq!(film(&at("a.exr")).samples().to_string(), "64..96");
    // Sums of sums name each backend once.
    render(directory.path(), &["--sample-range", "0..4", "--out", "c.exr"]);
    render(directory.path(), &["--resume", "c.exr", "--sample-range", "4..8", "--out", "c.exr"]);
    succeeds(directory.path(), &["merge", "m.exr", "c.exr", "--out", "o.exr"]);
    let backend = checkpoint::load(&at("o.exr")).unwrap().description.get(key::BACKEND).unwrap().to_owned();
    assert_eq!(backend.matches("cpu").count(), 1, "{backend}");
}

/// One file under two names is one file.
#[cfg(unix)]
#[test]
fn a_merge_writes_each_file_once() {
    let directory = temp();
    let at = |name: &str| directory.path().join(name);
    render(directory.path(), &["--sample-range", "0..4", "--out", "a.exr"]);
    render(directory.path(), &["--sample-range", "4..8", "--out", "b.exr"]);
    std::fs::create_dir(at("real")).unwrap();
    std::os::unix::fs::symlink("real", at("link")).unwrap();
    let whole = at("m.exr");
    for (one, other) in [
        ("m.exr", "./m.exr"),
        ("m.exr", whole.to_str().unwrap()),
        ("real/m.exr", "link/m.exr"),
        ("m.png", "real/../m.png"),
        ("m.exr", "link/../a.exr"),
    ] {
        let merge = ["merge", "a.exr", "b.exr", "--out", one, "--out", other];
        refused_in(&directory, &merge, &[other, "give each file its own name"]);
    }
    refused_in(&directory, &["merge", "a.exr", "./a.exr", "--out", "m.exr"], &["both hold the samples"]);
}

#[test]
fn films_of_other_pictures_are_not_resumed() {
    let directory = temp();
    render(directory.path(), &["--samples", "2", "--checkpoint", "film.exr"]);
    std::fs::write(directory.path().join("broken.exr"), "not a film").unwrap();
    // The window refuses them, too.
    for way in [&["--batch"][..], &[]] {
        let with = |film: &'static str, more: &[&'static str]| [way, &["--resume", film], more].concat();
        for (flags, parts) in [
            (&["--size", "16x9"][..], &["height is 9 here, 18 there"][..]),
            (&["--seed", "5"], &["seed is 5"]),
            (&["--scene", "book", "--size", "32x18"], &["another picture"]),
        ] {
            refused_in(&directory, &with("film.exr", flags), parts);
        }
        refused_in(&directory, &with("broken.exr", &[]), &["broken.exr"]);
        refused_in(&directory, &with("missing.exr", &[]), &["missing.exr"]);
        refused_in(&directory, &with("film.png", &[]), &["--resume", ".exr"]);
    }
}

#[test]
fn checkpoint_is_only_replaced_by_its_continuation() {
    let directory = temp();
    let at = |name: &str| directory.path().join(name);
    render(directory.path(), &["--samples", "32", "--checkpoint", "k.exr"]);
    let before = std::fs::read(at("k.exr")).unwrap();
    let endless = ["--batch", "--samples", "4294967296", "--size", "32x18", "--checkpoint"];
    let refused =
        |more: &[&str], parts: &[&str]| refused_in(&directory, &[&endless[..], more].concat(), parts);
    refused(
        &["k.exr"],
        &["k.exr", "32 samples per pixel of this picture", "--continue", "move this one away"],
    );
    refused(&["./k.exr", "--time-limit", "1"], &["32 samples per pixel"]);
    refused(
        &["k.exr", "--seed", "5"],
        &["k.exr", "32 samples", "another picture", "seed is 5 here, 0 there"],
    );
    refused(&["k.exr", "--seed", "5", "--continue"], &["seed is 5 here, 0 there", "name another film"]);
    render(directory.path(), &["--samples", "4", "--out", "other.exr"]);
    refused(&["k.exr", "--resume", "other.exr"], &["k.exr", "32 samples per pixel"]);
    assert_eq!(std::fs::read(at("k.exr")).unwrap(), before);
    std::fs::write(at("k.exr"), &before[..100]).unwrap();
    refused(&["k.exr"], &["k.exr is damaged", "move this one away"]);
    std::fs::write(at("k.exr"), "a picture").unwrap();
    refused(&["k.exr"], &["k.exr", "is not an EXR file", "move this one away"]);
    // There is nothing to lose.
    std::fs::write(at("k.exr"), "").unwrap();
    render(directory.path(), &["--samples", "4", "--checkpoint", "k.exr"]);
    assert_eq!(film(&at("k.exr")).sample_count(), 4);
}
