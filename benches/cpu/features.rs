//! What the code of features costs that a scene does not need: its own kernel and the general one, which has all of it.

use crate::packet::{job, trace};
use divan::Bencher;
use weekender::job::render::SamplerKind;
use weekender::render_cpu::CpuOptions;

/// Opaque spheres; with glass; with a lens, too; with a hierarchy, too.
const SCENES: [&str; 4] = ["metals", "three-spheres", "close-up", "book"];

fn measure(bencher: Bencher, scene: &str, general: bool) {
    let options = CpuOptions { threads: Some(1), general, ..CpuOptions::default() };
    trace(bencher, options, &job(scene, SamplerKind::Sobol));
}

#[divan::bench(args = SCENES, sample_count = 10)]
fn own(bencher: Bencher, scene: &str) {
    measure(bencher, scene, false);
}

#[divan::bench(args = SCENES, sample_count = 10)]
fn general(bencher: Bencher, scene: &str) {
    measure(bencher, scene, true);
}
