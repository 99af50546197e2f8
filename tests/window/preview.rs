//! While something moves, coarse previews are shown; afterwards the picture gets finer.

use crate::harness::{has_samples, hold, open, until};
use crate::questions::Ask as _;
use std::time::{Duration, Instant};

/// Large enough for previews to be coarser.
#[test]
fn large_pictures_are_coarse_in_motion_and_refine_afterwards() {
    let mut harness = open("--stage metal --size 2560x1440 --device cpu --samples 2");
    until(&mut harness, "a picture", has_samples(1));
    let at = harness.state().picture_rect().center();
    hold(&mut harness, at, true);
    let begin = Instant::now();
    while harness.state().shown().is_none_or(|(_, divisor)| divisor == 1) {
        assert!(begin.elapsed() < Duration::from_secs(60), "no preview");
        std::thread::sleep(Duration::from_millis(2));
        harness.state_mut().document_mut().camera.vfov_degrees -= 0.01;
        harness.step();
    }
    hold(&mut harness, at, false);
    let mut divisors = vec![harness.state().shown().unwrap().1];
    while divisors.last() != Some(&1) {
        assert!(begin.elapsed() < Duration::from_secs(120), "{divisors:?}");
        harness.step();
        divisors.push(harness.state().shown().unwrap().1);
    }
    // On a busy machine, the last preview of the move is coarser than the first.
    divisors.dedup();
    let coarsest = divisors.iter().max().unwrap();
    let after_move = divisors.iter().skip_while(|divisor| *divisor != coarsest);
    assert!(after_move.is_sorted_by(|a, b| a >= b), "{divisors:?}");
    until(&mut harness, "the picture", has_samples(1));
}
