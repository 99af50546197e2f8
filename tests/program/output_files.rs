//! Picture files: content, descriptions, and errors when they cannot be written.

use crate::common::program::names;
use image::ImageFormat;
use std::fs;
use std::io;
use std::path::Path;
use weekender::film::{Film, checkpoint, fixed_point};
use weekender::job::output::{Description, OutputFormat, key, read_description, write_image};
use weekender::stages::Transfer;
use weekender::system::files::{check_writable, replace_file};

fn film() -> Film {
    let (width, height) = (13, 7);
    let mut film = Film::new(width, height);
    for half in 0..2 {
        for (i, sum) in film.halves_mut()[half].iter_mut().enumerate() {
            let x = i as f64 / 80.0;
            *sum = fixed_point([x, x * x, 1.0 - 0.5 * x]).unwrap();
        }
    }
    film.record(0..2, 0).unwrap();
    film
}

fn description() -> Description {
    let mut description =
        Description::new("# a recipe\n[render]\nwidth = 13\n\n[materials.\"Glas: grün\"]\nkind = \"metal\"");
    description.set(key::SOFTWARE, "Weekender 0.1.0");
    description.set(key::SCENE, "three-spheres");
    description.set(key::CAMERA, "from 0,0,0 at 0,0,-1: 90 degrees");
    description.set("Note", "");
    description
}

#[test]
fn the_format_follows_the_extension() {
    for (name, format) in
        [("a.png", OutputFormat::Png), ("dir.exr/a.PPM", OutputFormat::P6), ("a.png.Exr", OutputFormat::Exr)]
    {
        assert_eq!(OutputFormat::from_path(Path::new(name)).unwrap(), format);
    }
    for name in ["a.jpg", "a", ".png", "", "png"] {
        let message = OutputFormat::from_path(Path::new(name)).unwrap_err().to_string();
        assert!([".png", ".ppm", ".exr", name].iter().all(|known| message.contains(known)), "{message}");
    }
}

#[test]
fn eight_bit_pictures_are_read_back_by_another_reader() {
    let directory = tempfile::tempdir().unwrap();
    for path in ["a.png", "a.ppm"].map(|name| directory.path().join(name)) {
        for transfer in [Transfer::Gamma2, Transfer::Linear, Transfer::LinearAboveGamma2] {
            write_image(&path, &film(), transfer, &description()).unwrap();
            let image = image::open(&path).unwrap().into_rgb8();
            assert_eq!((image.width(), image.height()), (13, 7));
            assert_eq!(image.into_raw(), film().to_rgb8(transfer), "{path:?} {transfer:?}");
        }
    }
}

#[test]
fn an_exr_is_the_linear_picture_and_the_film() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.exr");
    write_image(&path, &film(), Transfer::Gamma2, &description()).unwrap();
    let image = exr::prelude::read_first_rgba_layer_from_file(
        &path,
        |size, _| (size, vec![[0.0_f32; 4]; size.area()]),
        |(size, pixels), at, (r, g, b, a): (f32, f32, f32, f32)| {
            pixels[at.y() * size.width() + at.x()] = [r, g, b, a];
        },
    )
    .unwrap();
    let (size, pixels) = image.layer_data.channel_data.pixels;
    assert_eq!((size.width(), size.height()), (13, 7));
    for (pixel, mean) in pixels.iter().zip(film().means()) {
        assert_eq!(pixel[..3], mean);
    }
    assert_eq!(checkpoint::load(&path).unwrap().film, film());
}

#[test]
fn descriptions_are_read_back() {
    let directory = tempfile::tempdir().unwrap();
    let with_place = |mut description: Description, place: &str| {
        description.set("Place", place);
        description
    };
    let large: String = (0..100_000).map(|i| format!("center = [{i}, {}, 0]\n", i * 7919 % 1013)).collect();
    for (case, description) in [
        description(),
        with_place(description(), "東京 or Köln"),
        with_place(description(), "Köln"),
        with_place(Description::new("# a recipe"), "東京 or Köln"),
        Description::new(&large),
        Description::new(""),
    ]
    .iter()
    .enumerate()
    {
        for format in [OutputFormat::Png, OutputFormat::Exr] {
            let path = directory.path().join(format!("a{}", format.ending()));
            write_image(&path, &film(), Transfer::Gamma2, description).unwrap();
            // The name of the file does not matter.
            let renamed = directory.path().join("renamed");
            fs::rename(&path, &renamed).unwrap();
            assert!(read_description(&renamed).unwrap() == *description, "case {case}, {format:?}");
        }
    }
}

#[test]
fn foreign_pictures_have_no_description() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a");
    let pixels = image::RgbImage::new(2, 2);
    let message = |path: &Path| read_description(path).unwrap_err().to_string();
    let is_foreign = |path: &Path| message(path).contains("does not say how it was made");
    for format in [ImageFormat::Png, ImageFormat::Pnm] {
        pixels.save_with_format(&path, format).unwrap();
        assert!(is_foreign(&path));
    }
    exr::prelude::write_rgb_file(&path, 3, 2, |_, _| (0.1_f32, 0.2_f32, 0.3_f32)).unwrap();
    assert!(is_foreign(&path));
    for bytes in [&b"P6"[..], b"P6\n# x: y\n", b"text"] {
        fs::write(&path, bytes).unwrap();
        assert!(is_foreign(&path));
    }
    fs::write(&path, b"\x89PNG\r\n\x1a\n").unwrap();
    assert!(message(&path).contains("whether the file is complete"));
    assert!(message(directory.path()).contains("a directory, but a file is needed"));
}

#[test]
fn a_file_is_replaced_whole_or_not_at_all() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.png");
    fs::write(&path, "old").unwrap();
    let error = replace_file(&path, |writer| {
        io::Write::write_all(writer, &[7; 1 << 20])?;
        Err(io::ErrorKind::StorageFull.into())
    })
    .unwrap_err();
    let message = error.to_string();
    assert!(message.contains("a.png") && message.contains("free some space"), "{message}");
    assert_eq!(fs::read(&path).unwrap(), b"old");
    assert_eq!(names(directory.path()), ["a.png"]);
    replace_file(&path, |writer| io::Write::write_all(writer, b"new")).unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"new");
    assert_eq!(names(directory.path()), ["a.png"]);
}

#[test]
fn check_writable_finds_errors_beforehand() {
    let directory = tempfile::tempdir().unwrap();
    let at = |name: &str| directory.path().join(name);
    fs::create_dir(at("directory.png")).unwrap();
    fs::write(at("file"), "").unwrap();
    fs::write(at("read-only.png"), "old").unwrap();
    let mut permissions = fs::metadata(at("read-only.png")).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(at("read-only.png"), permissions).unwrap();
    for (name, reason) in [
        ("missing/a.png", "create its directory"),
        ("directory.png", "name a file in that directory"),
        ("file/a.png", "choose another place"),
        ("read-only.png", "marked read-only"),
        (&"long".repeat(200), "choose another name"),
        ("nul\0.png", "choose another name"),
        ("directory.png/", "name a file in that directory"),
        ("new.png/", "choose another name"),
        ("file/", "choose another"),
    ] {
        let message = check_writable(&at(name)).unwrap_err().to_string();
        assert!(message.contains(reason) && message.contains(&name.replace('\0', "\\u{0}")), "{message}");
        assert!(replace_file(&at(name), |_| Ok(())).is_err());
    }
    assert!(check_writable(Path::new("")).is_err());
    assert_eq!(fs::read(at("read-only.png")).unwrap(), b"old");

    fs::write(at("a.png"), "old").unwrap();
    check_writable(&at("a.png")).unwrap();
    check_writable(&at("new.png")).unwrap();
    assert_eq!(fs::read(at("a.png")).unwrap(), b"old");
    assert_eq!(names(directory.path()), ["a.png", "directory.png", "file", "read-only.png"]);
}

#[cfg(unix)]
mod unix {
    use super::*;
    use std::os::unix::fs::{PermissionsExt, symlink};

    fn mode(path: &Path) -> u32 {
        fs::metadata(path).unwrap().permissions().mode() & 0o777
    }

    #[test]
    fn permissions_are_the_usual_or_the_old_ones() {
        let directory = tempfile::tempdir().unwrap();
        let (usual, ours) = (directory.path().join("usual"), directory.path().join("ours"));
        fs::write(&usual, "").unwrap();
        replace_file(&ours, |_| Ok(())).unwrap();
        assert_eq!(mode(&ours), mode(&usual));
        fs::set_permissions(&ours, fs::Permissions::from_mode(0o640)).unwrap();
        replace_file(&ours, |_| Ok(())).unwrap();
        assert_eq!(mode(&ours), 0o640);
    }

    #[test]
    fn a_link_stays_and_its_target_is_replaced() {
        let directory = tempfile::tempdir().unwrap();
        let (target, link) = (directory.path().join("target"), directory.path().join("link"));
        fs::write(&target, "old").unwrap();
        symlink(&target, &link).unwrap();
        replace_file(&link, |writer| io::Write::write_all(writer, b"new")).unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read(&target).unwrap(), b"new");
        fs::remove_file(&target).unwrap();
        assert!(check_writable(&link).unwrap_err().to_string().contains("link to a missing file"));
    }
}
