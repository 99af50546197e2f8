//! Trial.
use std::sync::atomic::AtomicBool;
use weekender::recipe::Recipe;
use weekender::render::*;
use weekender::render_cpu::*;
// args: scene isa lanes spp sampler width threads
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let mut recipe = Recipe::builtin(&a[1]).unwrap();
    let isa = Isa::ALL.into_iter().find(|i| i.name() == a[2]).unwrap();
    let lanes: usize = a[3].parse().unwrap();
    let spp: u64 = a[4].parse().unwrap();
    recipe.settings.sampler = if a[5] == "i" { SamplerKind::Independent } else { SamplerKind::Sobol };
    if let Some(w) = a.get(6) {
        let w: u32 = w.parse().unwrap();
        recipe.settings.height = w * recipe.settings.height / recipe.settings.width;
        recipe.settings.width = w;
    }
    let job = recipe.job().unwrap();
    let threads = a.get(7).map_or(1, |t| t.parse().unwrap());
    let mut r =
        CpuRenderer::new(CpuOptions { isa: Some(isa), lanes: Some(lanes), threads: Some(threads) }).unwrap();
    r.prepare(&job).unwrap();
    let mut film = job.new_film();
    let s = r.accumulate(&job, 0..spp, &mut film, &AtomicBool::new(false)).unwrap();
    let hash = film
        .halves()
        .iter()
        .flatten()
        .fold(0u64, |h, p| p.0.iter().fold(h, |h, k| (h ^ k).wrapping_mul(0x100000001b3)));
    println!(
        "{isa} {lanes}: {:.2} Mpaths/s, {} rays, {:.3} rays/path, lanes {:.3}, hash {hash:x}",
        s.paths as f64 / s.trace.as_secs_f64() / 1e6,
        s.rays,
        s.rays as f64 / s.paths as f64,
        s.busy_lanes as f64 / s.offered_lanes as f64
    );
}
