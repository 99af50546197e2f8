//! Thinking in lanes: lane values, a mask, a select, a reduction and a tail, in plain Rust. With optimisation the
//! compiler makes vector instructions of the loops over lanes.
//!
//! cargo run --release --example lanes

const LANES: usize = 8;

/// One number per lane.
type Row = [f32; LANES];

/// What one lane does, done in all of them.
fn each<T: Copy>(one: impl Fn(usize) -> T) -> [T; LANES] {
    std::array::from_fn(one)
}

fn select(mask: [bool; LANES], yes: Row, no: Row) -> Row {
    each(|i| if mask[i] { yes[i] } else { no[i] })
}

fn main() {
    let offsets: Vec<f32> = (0..21).map(|i| 2.0 - 0.1 * i as f32).collect();
    let (mut hits, mut sum) = (0, [0.0; LANES]);
    for chunk in offsets.chunks(LANES) {
        // The tail: lanes without work compute like the others, and a mask leaves them out.
        let active = each(|i| i < chunk.len());
        let offset = each(|i| chunk.get(i).copied().unwrap_or(0.0));
        // Lane values: how far rays at these offsets are from entering a ball of radius 1 at distance 4.
        let discriminant = each(|i| 1.0 - offset[i] * offset[i]);
        let mask = each(|i| active[i] && discriminant[i] >= 0.0);
        let distance = each(|i| 4.0 - discriminant[i].max(0.0).sqrt());
        sum = each(|i| sum[i] + select(mask, distance, [0.0; LANES])[i]);
        hits += mask.iter().filter(|hit| **hit).count();
        println!("{:?}", mask.map(u8::from));
    }
    // The reduction: one number from all lanes.
    let total: f32 = sum.iter().sum();
    println!("{hits} of {} rays hit, at {:.3} on average", offsets.len(), total / hits as f32);
}
