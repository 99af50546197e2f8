//! A preview: its first pass has the samples that were asked for, and its picture is smooth.

use crate::common::{CPU, expected, started, wait_until};
use weekender::progressive::{Phase, Picture, Plan, Progressive, View};
use weekender::stages::Transfer;

/// The picture of four samples, and the samples of the first pass.
fn rendered(plan: Plan, view: View) -> (Picture, u64) {
    let progressive = started(CPU, plan);
    progressive.set_view(view);
    wait_until(&progressive, |status| matches!(status.phase, Phase::Done(_)));
    let first = progressive.status().history.first().map_or(0, |point| point.samples_per_pixel);
    (picture(&progressive), first)
}

fn picture(progressive: &Progressive) -> Picture {
    loop {
        progressive.ask_for_picture();
        match progressive.newest_picture() {
            Some(picture) if picture.samples_per_pixel == 4 => return picture,
            _ => std::thread::sleep(std::time::Duration::from_millis(1)),
        }
    }
}

#[test]
fn a_preview_is_smooth_and_its_first_pass_is_long_enough() {
    let (preview, plain) = (Plan { preview: Some(4), ..Plan::samples(4) }, Plan::samples(4));
    let film = expected(4);
    let transfer = Transfer::Gamma2;
    assert_ne!(film.smoothed().to_rgb8(transfer), film.to_rgb8(transfer), "there is noise to smooth");

    let (picture, first) = rendered(preview.clone(), View::Picture);
    assert_eq!((picture.rgb8, first), (film.smoothed().to_rgb8(transfer), 4));
    let (picture, first) = rendered(plain, View::Picture);
    assert_eq!((picture.rgb8, first), (film.to_rgb8(transfer), 2));

    let (picture, _) = rendered(preview.clone(), View::Exposed(1.0));
    assert_eq!(picture.rgb8, film.smoothed().exposed(transfer, 1.0));
    // A heat map shows the noise that is there.
    let (picture, _) = rendered(preview, View::Luminance([-8.0, 4.0]));
    let (plain, _) = rendered(Plan::samples(4), View::Luminance([-8.0, 4.0]));
    assert_eq!(picture.rgb8, plain.rgb8);
}
