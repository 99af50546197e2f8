//! What is shown and written of a film: views, heat maps and files, by their digests.

use crate::common::{check, digest_of};
use std::fmt::Write as _;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use weekender::backends::{BackendChoice, create};
use weekender::film::{Description, Film, checkpoint, key};
use weekender::heat::HeatScale;
use weekender::output::{Forms, PngForm, PpmForm, write_image_as, write_part};
use weekender::progressive::{ReferenceMeans, View, luminance, standard_error};
use weekender::recipe::Recipe;
use weekender::recipe::file::to_picture_toml;
use weekender::render::TileOccupancy;
use weekender::stages::Transfer;

fn film(name: &str, samples: u64) -> (Recipe, Film) {
    let mut recipe = Recipe::find(name).unwrap();
    (recipe.settings.width, recipe.settings.height) = (13, 7);
    let job = recipe.job().unwrap();
    let mut film = job.new_film();
    let mut renderer = create(&BackendChoice::named("portable", None).unwrap()).unwrap();
    renderer.accumulate(&job, 0..samples, &mut film, &AtomicBool::new(false)).unwrap();
    (recipe, film)
}

#[test]
fn views_are_as_kept() {
    let (_, film) = film("three-spheres", 6);
    let (_, other) = self::film("metals", 6);
    let occupancy = TileOccupancy {
        side: 4,
        columns: 4,
        tiles: vec![[1, 8], [2, 8], [3, 8], [4, 8], [5, 8], [0, 0], [7, 8], [8, 8]],
    };
    let mut text = String::new();
    for view in [
        View::Picture,
        View::Exposed(1.5),
        View::Exposed(-2.0),
        View::Luminance([-3.0, 1.0]),
        View::StandardError,
        View::Difference(Arc::new(ReferenceMeans::of(&other))),
        View::Occupancy,
    ] {
        let name = format!("{view:?}").chars().take(20).collect::<String>();
        for transfer in [Transfer::Linear, Transfer::Gamma2, Transfer::LinearAboveGamma2] {
            let bytes = view.resolve(&film, transfer, Some(&occupancy));
            writeln!(text, "{name} {transfer:?} {} {:?}", digest_of(&bytes), &bytes[3 * 45..3 * 46]).unwrap();
        }
        if let Some(scale) = view.scale() {
            writeln!(text, "  {}: {:?}", scale.title, scale.marks()).unwrap();
        }
    }
    for pixel in [0, 45, 90] {
        writeln!(text, "pixel {pixel} standard error {:.6?}", standard_error(&film, pixel)).unwrap();
    }
    writeln!(text, "error {:#?}", film.error()).unwrap();
    writeln!(text, "luminance {:.6}", luminance([0.2, 0.5, 0.9])).unwrap();
    for scale in [
        HeatScale::ERROR,
        HeatScale::DIFFERENCE,
        HeatScale::RAYS,
        HeatScale::OCCUPANCY,
        HeatScale::luminance([-4.0, 3.0]),
    ] {
        writeln!(text, "{}: {:?}", scale.title, scale.marks()).unwrap();
        for value in [0.0, 1e-4, 0.003, 0.06, 0.4, 0.9, 3.0, 40.0] {
            writeln!(text, "  {value}: {:.4} {:?}", scale.place(value), scale.colour(value)).unwrap();
        }
    }
    check("views", &text);
}

#[test]
fn files_are_as_kept() {
    let directory = tempfile::tempdir().unwrap();
    let mut text = String::new();
    for estimate_error in [true, false] {
        let (mut recipe, mut film) = film("three-spheres", 4);
        if !estimate_error {
            recipe.settings.estimate_error = false;
            film = Film::new(13, 7, 1);
            film.record(3..9, 2).unwrap();
        }
        let mut description = Description::new(&to_picture_toml(&recipe));
        description.set(key::SCENE, "three-spheres");
        description.set(key::SAMPLES, 4);
        for (name, forms) in [
            ("a.png", Forms::default()),
            ("b.png", Forms { png: PngForm::Small, ..Forms::default() }),
            ("a.ppm", Forms::default()),
            ("b.ppm", Forms { ppm: PpmForm::Ascii, ..Forms::default() }),
            ("a.exr", Forms::default()),
        ] {
            let path = directory.path().join(name);
            write_image_as(&path, &film, Transfer::Gamma2, &description, forms).unwrap();
            let bytes = std::fs::read(&path).unwrap();
            writeln!(text, "{name} {} bytes, digest {}", bytes.len(), digest_of(&bytes)).unwrap();
        }
        let file = checkpoint::load(&directory.path().join("a.exr")).unwrap();
        assert!(file.film == film && file.film.rejected() == film.rejected());
        let part = directory.path().join("part.png");
        write_part(&part, &film, Transfer::Linear, [[2, 1], [5, 4]], &description).unwrap();
        writeln!(text, "part {}", digest_of(&std::fs::read(part).unwrap())).unwrap();
    }
    check("files", &text);
}
