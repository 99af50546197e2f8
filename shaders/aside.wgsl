// A thread that has used up its loop turns puts its path aside. The next dispatch of the same tiles takes it up again.
// Each dispatch is therefore short, however long a thread's work is.
//
// Layout: ASIDE_STRIDE words per thread: origin and the sphere left | direction and the sphere inside | throughput, and
// one word with bounce, samples left and whether the path is absorbed (0 if nothing was put aside) | next block and
// sums | sine2.
//
// Twin: src/render_gpu/dispatches.rs

const ABSORBED_BIT = 0x80000000u;

fn put_aside(path: Path, next_block: u32, base: u32) {
    record_vector(base, path.ray.origin);
    words[base + 3u] = path.ray.left;
    record_vector(base + 4u, path.ray.direction);
    words[base + 7u] = path.ray.inside;
    record_vector(base + 8u, path.throughput);
    // A path has at most 10,000 rays, and a block at most 128 samples.
    words[base + 11u] = path.bounce | (path.remaining << 16u) | select(0u, ABSORBED_BIT, path.absorbed);
    words[base + 12u] = next_block;
    words[base + 13u] = path.sums.x;
    words[base + 14u] = path.sums.y;
    words[base + 15u] = path.sums.z;
    words[base + 16u] = bitcast<u32>(path.sine2);
}

// Returns the next block. If nothing was put aside, no samples are left.
fn take_up(path: ptr<function, Path>, base: u32) -> u32 {
    let state = words[base + 11u];
    let remaining = (state & ~ABSORBED_BIT) >> 16u;
    (*path).remaining = remaining;
    if remaining == 0u {
        return 0u;
    }
    words[base + 11u] = 0u;
    (*path).ray = Ray(aside_vector(base), aside_vector(base + 4u), words[base + 3u], words[base + 7u]);
    (*path).throughput = aside_vector(base + 8u);
    (*path).bounce = state & 0xFFFFu;
    (*path).absorbed = (state & ABSORBED_BIT) != 0u;
    (*path).sums = vec3u(words[base + 13u], words[base + 14u], words[base + 15u]);
    (*path).sine2 = bitcast<f32>(words[base + 16u]);
    let next_block = words[base + 12u];
    if next_block > 0u {
        let block = blocks[next_block - 1u];
        enter_block(path, block, block.count - remaining);
    }
    return next_block;
}

fn aside_vector(base: u32) -> vec3f {
    return bitcast<vec3f>(vec3u(words[base], words[base + 1u], words[base + 2u]));
}
