//! Command lines and the requests that they make.

use super::*;

pub(super) fn request(line: &str) -> Result<Request, Failure> {
    parse(format!("weekender {line}").split(' ').map(Into::into))
}

/// The options of a batch render with these flags.
pub(crate) fn batch(flags: &str) -> BatchOptions {
    match request(&format!("--batch {flags}")) {
        Ok(Request::Batch(options)) => *options,
        other => panic!("{other:?}"),
    }
}

pub(super) fn refused(line: &str) -> String {
    request(line).unwrap_err().to_string()
}

#[test]
fn the_definition_of_all_flags_is_consistent() {
    command().debug_assert();
}

#[test]
fn a_negative_number_is_a_wrong_value() {
    for line in ["--batch --samples -3", "bench --runs -1"] {
        let message = refused(line);
        assert!(message.contains("invalid value '-"), "{message}");
    }
}

#[test]
fn commands_call_the_program_from_any_directory() {
    let whole = std::env::current_exe().unwrap().to_str().unwrap().to_owned();
    for (name, expected) in [
        ("weekender", "weekender"),
        ("./weekender", whole.as_str()),
        ("target/release/weekender", whole.as_str()),
    ] {
        assert_eq!(called(Some(&name.into())), expected);
    }
    assert_eq!(called(None), "weekender");
}

#[test]
fn the_recorded_command_has_file_names_instead_of_paths() {
    let directory = tempfile::tempdir().unwrap();
    let inside = |name: &str| directory.path().join(name).to_str().unwrap().to_owned();
    let words = [
        "/usr/bin/weekender",
        "--batch",
        "--scene",
        &inside("my scene.toml"),
        &format!("--out={}", inside("a.png")),
        "--json",
        "-",
        "--adapter",
        "a/b",
        "--log=/no-such-directory/run.log",
        "src/x.exr",
    ];
    assert_eq!(
        recorded(&words.map(OsString::from)),
        format!(
            "weekender --batch --scene {} --out=a.png --json - --adapter a/b --log=run.log x.exr",
            shell::quoted("my scene.toml")
        )
    );
}

#[test]
fn frames_default_to_one_turn() {
    for (flags, frames, samples) in [
        ("--turntable=4 --samples 3 --out no-such", 0..4, 3),
        ("--frames 3..5 --turntable=90 --samples 2 --out no-such-#.png", 3..5, 2),
    ] {
        let Ok(Request::Frames(options)) = request(&format!("--batch --device cpu {flags}")) else {
            panic!("no frames: {flags}")
        };
        assert_eq!((options.frames, options.picture.recipe.samples_per_pixel), (frames, samples), "{flags}");
    }
}

#[test]
#[cfg(feature = "window")]
fn backend_flags_choose_the_windows_backend() {
    let is_given = |flags: &str| match request(flags) {
        Ok(Request::Window(options)) => options.is_device_given,
        other => panic!("{other:?}"),
    };
    assert!(!is_given("--fresh --vfov 30 --samples 3"));
    for flag in ["--device cpu", "--adapter some", "--threads 3", "--simd 1", "--isa portable"] {
        assert!(is_given(flag), "{flag}");
    }
}

#[test]
#[cfg(feature = "window")]
fn a_file_alone_is_opened_in_the_window() {
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name);
    let recipe = Recipe { samples_per_pixel: 7, ..Recipe::builtin("three-spheres").unwrap() };
    let toml = crate::job::recipe::file::to_toml(&recipe);
    let mut film = recipe.job().unwrap().new_film();
    film.record(0..2, 0).unwrap();
    let description = crate::film::Description::new(&toml);
    for name in ["film.exr", "a picture.png"] {
        crate::job::output::write_image(&at(name), &film, recipe.rules.transfer, &description).unwrap();
    }
    std::fs::write(at("scene.toml"), &toml).unwrap();
    let opened = |words: &[&OsStr]| -> Result<WindowOptions, String> {
        let words = std::iter::once(OsStr::new("weekender")).chain(words.iter().copied());
        match parse(words.map(OsStr::to_owned)).map_err(|failure| failure.to_string())? {
            Request::Window(options) => Ok(*options),
            other => panic!("{other:?}"),
        }
    };
    for name in ["film.exr", "a picture.png", "scene.toml"] {
        let path = at(name);
        for words in [
            &[path.as_os_str()][..],
            &["--fresh".as_ref(), path.as_ref()],
            &["--open".as_ref(), path.as_ref()],
        ] {
            let options = opened(words).unwrap();
            assert!(options.is_picture_given && options.recipe.samples_per_pixel == 7, "{name}");
            assert_eq!(options.resume.is_some(), name == "film.exr", "{name}");
            assert_eq!(options.file.is_some(), name == "scene.toml", "{name}");
        }
        let error = opened(&[path.as_ref(), "--stage".as_ref(), "sky".as_ref()]).unwrap_err();
        assert!(error.contains("--stage"), "{error}");
    }
    // A picture of another program is checked.
    std::fs::write(at("mine.ppm"), "P3\n1 1\n255\n1 2 3\n").unwrap();
    let options = opened(&[at("mine.ppm").as_os_str()]).unwrap();
    assert!(options.mine == Some(at("mine.ppm")) && !options.is_picture_given);
    let error = opened(&["chekc".as_ref()]).unwrap_err();
    assert!(error.contains("unrecognized") && error.contains("check"), "{error}");
    let error = opened(&["missing.exr".as_ref()]).unwrap_err();
    assert!(error.contains("cannot read missing.exr"), "{error}");
}

#[cfg(unix)]
#[test]
fn names_that_are_not_utf_8_are_recorded_and_read() {
    use std::os::unix::ffi::OsStrExt;
    let name = |bytes: &'static [u8]| OsStr::from_bytes(bytes).to_owned();
    let line = recorded(&["weekender".into(), "--scene".into(), name(b"/x/K\xf6ln.toml")]);
    assert_eq!(line, "weekender --scene $'K\\xf6ln.toml'");
    let words = ["weekender".into(), "--scene".into(), name(b"no-such-K\xf6ln.toml")];
    let error = parse(words).unwrap_err().to_string();
    assert!(error.contains("cannot read no-such-K"), "{error}");
}
