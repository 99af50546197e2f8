// The path loop: a thread owns a pixel and walks through blocks of its samples. When a path ends the thread
// starts its next sample at once, so that none waits for the longest path beside it.
//
// Twin: src/render_cpu/path

// What lives on from one ray to the next is put aside, too: see aside.wgsl.
struct Path {
    ray: Ray,
    throughput: vec3f,
    // Squared sine between a ray inside steep glass and the normal where it starts, and so where it ends.
    sine2: f32,
    bounce: u32,
    counter: u32,
    step: u32,
    // Samples left of the block, the current one included.
    remaining: u32,
    // The Sobol sampler's.
    key: u32,
    // x | y << 16
    pixel: u32,
    corner: vec2f,
    sums: vec3u,
    half: u32,
    // The path was absorbed, or there was none yet: it ends without another ray.
    absorbed: bool,
    rejected: u32,
}

// What a thread did.
struct Traced {
    rays: u32,
    rejected: u32,
    // Samples whose sums are in the film.
    finished: u32,
    // 1 if a path was put aside.
    unfinished: u32,
    // 1 if not even one ray could be traced to its end.
    stuck: u32,
}

// Turns of all loops of this thread so far.
var<private> turns: u32;

// Whether the ray at hand left its traversal before the end: some drivers end loops that have many turns.
var<private> ray_is_cut: bool;

// Traces the blocks of the dispatch at a pixel, which is number `slot` of the film buffer, or goes on with them. After
// so many turns of loops as the dispatch allows, the path is put aside in the words from `aside` on.
fn trace(position: vec2u, slot: u32, aside: u32) -> Traced {
    var path: Path;
    path.pixel = position.x | (position.y << 16u);
    path.corner = screen(job.camera, vec2f(position));
    path.absorbed = true;
    path.remaining = 1u;
    var traced: Traced;
    var next_block = 0u;
    if ASIDE && order.resumes > 0u {
        next_block = take_up(&path, aside);
    }
    let first_block = max(next_block, 1u) - 1u;
    let list_turns = turns_over_lists();
    var is_done = path.remaining == 0u;
    turns = 0u;
    ray_is_cut = false;
    // Ends, since each turn makes `turns` larger: after `turn_limit` turns at the latest, those of the loops within
    // included but for the last ray's.
    while !is_done && turns < order.turn_limit {
        turns += 1u;
        var nearest = nothing();
        if !path.absorbed {
            if RAYS {
                turns += list_turns;
                nearest = intersect(path.ray);
            }
            if HIERARCHY && ray_is_cut {
                break;
            }
            if RECORD {
                record_ray(words[2] + traced.rays, path, nearest);
            }
            traced.rays++;
        }

        // What the ray brings back, and whether it is the last of its path.
        let miss = nearest.sphere == NONE;
        var ended = miss || path.absorbed || path.bounce == job.max_depth - 1u;
        var lit = miss && !path.absorbed;
        var point: SurfacePoint;
        let row = rows[select(nearest.sphere, 0u, miss)];
        if !ended || SHADING == SHADING_NORMALS {
            point = hit_point(path.ray, bitcast<f32>(nearest.key), row);
        }
        if SHADING != SHADING_PATH {
            lit = !path.absorbed;
            ended = true;
        }
        if lit {
            add_radiance(&path, miss, point.outward);
        }

        // The next sample's place in the sequence.
        path.bounce = select(path.bounce + 1u, 0u, ended);
        if ended {
            path.counter += path.step;
            path.remaining -= 1u;
            if path.remaining == 0u {
                if next_block > 0u {
                    add_to_film(path.half, slot, path.sums);
                }
                if next_block == order.block_count {
                    is_done = true;
                    break;
                }
                enter_block(&path, blocks[next_block], 0u);
                path.sums = vec3u(0u);
                next_block++;
            }
        }
        send(&path, ended, nearest.sphere, row, point);
    }
    // Counted here, since some drivers go through a branch whether it is taken or not.
    let end_block = select(max(next_block, 1u) - 1u, next_block, is_done);
    for (var i = first_block; i < end_block; i++) {
        traced.finished += blocks[i].count;
    }
    if !is_done {
        if ASIDE {
            put_aside(path, next_block, aside);
        }
        traced.unfinished = 1u;
        traced.stuck = select(0u, 1u, ray_is_cut && traced.rays == 0u);
    }
    traced.rejected = path.rejected;
    return traced;
}

// Turns of one ray's loops over lists: see `intersect`. Those over a hierarchy count themselves.
fn turns_over_lists() -> u32 {
    let anchored_count = select(job.anchored_count, ANCHORED_COUNT, FEW_ANCHORED);
    if HIERARCHY && !BOOK_ARITHMETIC {
        return anchored_count;
    }
    let opaque_count = select(job.opaque_count, OPAQUE_COUNT, FEW_SPHERES);
    let two_root_count = select(job.two_root_count, TWO_ROOT_COUNT, FEW_SPHERES);
    return opaque_count + two_root_count + anchored_count;
}

// Goes to sample `place` of a block.
fn enter_block(path: ptr<function, Path>, block: Block, place: u32) {
    (*path).half = block.half;
    (*path).counter = block.counter + place * block.step;
    (*path).step = block.step;
    (*path).remaining = block.count - place;
    if SOBOL {
        (*path).key = pixel_key(job.seed, block.half, (*path).pixel);
    }
}

// What a ray meets first.
fn intersect(ray: Ray) -> Nearest {
    var nearest = nothing();
    // Counts that are known when the kernel is built let its loops be unrolled.
    let opaque_count = select(job.opaque_count, OPAQUE_COUNT, FEW_SPHERES);
    let two_root_count = select(job.two_root_count, TWO_ROOT_COUNT, FEW_SPHERES);
    let anchored_count = select(job.anchored_count, ANCHORED_COUNT, FEW_ANCHORED);
    let listed = opaque_count + two_root_count;
    if BOOK_ARITHMETIC {
        for (var i = 0u; i < listed; i++) {
            nearest = take(nearest, book_root(ray, sphere_at(i), BOOK_T_MIN), i);
        }
        return nearest;
    }
    if HIERARCHY && CWBVH {
        nearest = traverse_cwbvh(ray, nearest);
    } else if HIERARCHY {
        nearest = traverse(ray, nearest);
    } else {
        for (var i = 0u; i < opaque_count; i++) {
            nearest = take(nearest, near_root(ray, sphere_at(i), i), i);
        }
        if TWO_ROOT {
            for (var i = opaque_count; i < listed; i++) {
                nearest = take(nearest, nearest_root(ray, sphere_at(i), i), i);
            }
        }
    }
    if ANCHORED {
        for (var i = 0u; i < anchored_count; i++) {
            nearest = take(nearest, anchored_root(ray, anchored_at(i), listed + i), listed + i);
        }
    }
    return nearest;
}

fn hit_point(ray: Ray, t: f32, row: Row) -> SurfacePoint {
    var point: SurfacePoint;
    if BOOK_ARITHMETIC {
        point = book_point(ray, t, row.reference, row.curvature);
    } else if ANCHORED && row.is_anchored > 0.0 {
        point = anchored_surface_point(ray, t, row.reference, row.inward, row.curvature);
    } else if SPECKS {
        point = speck_surface_point(ray, t, row.reference, row.curvature, row.radius);
    } else {
        point = surface_point(ray, t, row.reference, row.curvature, row.radius);
    }
    return point;
}

fn sky(direction: vec3f) -> vec3f {
    return max(vec3f(0.0), fma(job.sky_slope, vec3f(direction.y), job.sky_middle));
}

// Adds a path's end to the sums, or counts it where it is not a number that can be added.
fn add_radiance(path: ptr<function, Path>, miss: bool, outward: vec3f) {
    var light = sky((*path).ray.direction);
    if SHADING == SHADING_IMAGE_GRADIENT {
        light = vec3f(pixel_position((*path).pixel) / max(job.camera.size - 1.0, vec2f(1.0)), 0.0) * FIXED_POINT_SCALE;
    } else if SHADING == SHADING_FIRST_HIT_RED {
        light = select(vec3f(FIXED_POINT_SCALE, 0.0, 0.0), light, miss);
    } else if SHADING == SHADING_NORMALS {
        let half = vec3f(0.5 * FIXED_POINT_SCALE);
        light = select(max(vec3f(0.0), fma(outward, half, half)), light, miss);
    }
    let radiance = light * (*path).throughput;
    // As bits, since a compiler may take it that no NaN occurs: all that is wrong has larger bits.
    let total = bitcast<u32>(radiance.x + radiance.y + radiance.z);
    if total < RADIANCE_TOTAL_LIMIT_BITS || total == NEGATIVE_ZERO_BITS {
        (*path).sums += vec3u(fixed_point(radiance.x), fixed_point(radiance.y), fixed_point(radiance.z));
    } else {
        (*path).rejected += 1u;
    }
}

// Sends the path on from a surface, or a new one from the camera where it has ended. Lanes go both ways side by
// side, so what both need stands outside the branch: one set of numbers, one sine and cosine, one length.
fn send(path: ptr<function, Path>, ended: bool, hit: u32, row: Row, point: SurfacePoint) {
    let drawn = draw(*path);
    let sine_cosine = sin_cos_turns(drawn.pair.y);
    var sent: Ray;
    if ended {
        sent = start_path(path, drawn, sine_cosine);
    } else {
        sent = scatter_path(path, drawn, sine_cosine, hit, row, point);
    }
    sent.direction = normalized(sent.direction);
    (*path).ray = sent;
}

fn start_path(path: ptr<function, Path>, drawn: Drawn, sine_cosine: vec2f) -> Ray {
    var jitter = drawn.jitter;
    if !ANTIALIASING {
        jitter = vec2f(0.5);
    }
    var from_camera: CameraRay;
    if has_lens() {
        let on_lens = sqrt(drawn.pair.x) * sine_cosine.yx;
        from_camera = lens_ray(job.camera, (*path).corner, jitter, on_lens);
    } else {
        from_camera = pinhole_ray(job.camera, (*path).corner, jitter);
    }
    (*path).throughput = vec3f(1.0);
    (*path).absorbed = false;
    return Ray(from_camera.origin, from_camera.direction, select(NONE, EYE, EYE_ON_SURFACE), NONE);
}

fn scatter_path(
    path: ptr<function, Path>,
    drawn: Drawn,
    sine_cosine: vec2f,
    hit: u32,
    row: Row,
    point: SurfacePoint,
) -> Ray {
    let direction = (*path).ray.direction;
    let outward_cosine = dot3(direction, point.outward);
    var front = outward_cosine < 0.0;
    if !BOOK_ARITHMETIC {
        front = front && (*path).ray.inside != hit;
    }
    if CAVITY {
        front = front && row.is_anchored < 2.0;
    }
    let normal = select(-point.outward, point.outward, front);
    var cosine = min(1.0, abs(outward_cosine));
    var sine2 = fma(-cosine, cosine, 1.0);
    let rho = sqrt(drawn.pair.x * (1.0 - drawn.pair.x));
    let across = (rho + rho) * sine_cosine.yx;
    let unit = vec3f(across.x, 1.0 - (drawn.pair.x + drawn.pair.x), across.y);
    let surface = Surface(row.weight, row.index, row.inverse_index, row.normal_share);
    var across_normal: vec3f;
    if STEEP_GLASS {
        // A ray inside glass meets it under the angle under which it started: that is remembered, so that total
        // reflection lasts.
        across_normal = mul_add3(normal, cosine, direction);
        let is_known = (*path).ray.inside == hit && row.index > 0.0;
        sine2 = min(1.0, select(dot3(across_normal, across_normal), (*path).sine2, is_known));
        cosine = sqrt(1.0 - sine2);
    }
    let scattered = scatter(surface, direction, normal, cosine, sine2, front, unit, drawn.pair.x);
    var sent = scattered.direction;
    if STEEP_GLASS {
        if scattered.refracts {
            sent = refracted(across_normal, normal, scattered.ratio, sine2);
            sine2 *= scattered.ratio * scattered.ratio;
        }
        (*path).sine2 = sine2;
    }
    if HEMISPHERE && row.weight > 0.0 {
        sent = hemisphere(normal, unit);
    }
    var albedo = row.albedo;
    if REFLECTANCE_STRIPS {
        albedo = vec3f(strip_reflectance((*path).pixel));
    }
    if dot3(sent, sent) < NEAR_ZERO {
        sent = normal;
    }
    // A fuzzy reflection into the surface is absorbed.
    (*path).absorbed = METAL && scattered.is_metal && !(dot3(sent, normal) > 0.0);
    (*path).throughput *= albedo;
    let inward = front == scattered.refracts;
    return Ray(point.position, sent, select(hit, NONE, inward), select(NONE, hit, inward));
}

fn has_lens() -> bool {
    return LENS && job.camera.tau > 0.0;
}

fn normalized(v: vec3f) -> vec3f {
    return v * inverseSqrt(dot3(v, v));
}

// The reflectance of the picture's strip that a pixel lies in: 10, 30, 50, 70, 90 %.
fn strip_reflectance(pixel: u32) -> f32 {
    let strip = (pixel_position(pixel).x + 0.5) * (5.0 / job.camera.size.x) - 0.5;
    return fma(round(max(0.0, strip)), 0.2, 0.1);
}

// Column and row from x | y << 16.
fn pixel_position(pixel: u32) -> vec2f {
    return vec2f(f32(pixel & 0xFFFFu), f32(pixel >> 16u));
}

// Two numbers for a direction or a lens point, and a point in the pixel.
struct Drawn {
    pair: vec2f,
    jitter: vec2f,
}

fn draw(path: Path) -> Drawn {
    var first: vec2u;
    var second: vec2u;
    if SOBOL {
        first = sobol_pair(path.counter, stream_of(path.key, path.bounce));
        second = first;
        if has_lens() {
            second = sobol_pair(path.counter, lens_stream_of(path.key, path.bounce));
        }
    } else {
        let numbers = pcg4d(vec4u(path.pixel, path.counter, path.bounce, job.seed));
        first = numbers.xy;
        second = select(first, numbers.zw, has_lens());
    }
    return Drawn(
        vec2f(unit_float(first.x), unit_float(first.y)),
        vec2f(unit_float(second.x), unit_float(second.y)),
    );
}
