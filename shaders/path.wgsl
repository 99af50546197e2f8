// The path loop. A thread traces blocks of a pixel's samples. When a path ends, it starts the next sample immediately, so
// no thread waits for the longest path beside it. Where paths can be long, a thread that has finished its block takes the
// next one of the workgroup's tile, so none waits for the longest pixel either.
//
// Twin: src/render_cpu/path

// State that persists from ray to ray must also be put aside: see aside.wgsl.
struct Path {
    ray: Ray,
    throughput: vec3f,
    // Squared sine of the angle between a ray inside steep glass and the normal where it starts; it is the same where
    // the ray ends.
    sine2: f32,
    bounce: u32,
    counter: u32,
    step: u32,
    // Samples left in the block, including the current one.
    remaining: u32,
    // Number of the block among those of the tile; NONE before the first.
    item: u32,
    // Key of the Sobol sampler.
    key: u32,
    // x | y << 16
    pixel: u32,
    corner: vec2f,
    sums: vec3u,
    half: u32,
    // Whether the path was absorbed, or none has started yet: it ends without another ray.
    absorbed: bool,
    rejected: u32,
}

// The pixels of a workgroup. Their blocks of samples are numbered: first a block of every pixel, then the next.
struct Tile {
    corner: vec2u,
    size: vec2u,
}

// What a thread has traced.
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

// Whether the current ray's traversal ended early: some drivers end loops that have many turns.
var<private> ray_is_cut: bool;

// The number of the next block of the tile that no thread has begun.
var<workgroup> queue: atomic<u32>;

// Traces blocks of the dispatch in a tile, or continues them. After the number of loop turns that the dispatch allows,
// the path is put aside in the words from `aside` on.
fn trace(tile: Tile, thread: u32, aside: u32) -> Traced {
    let pixels = tile.size.x * tile.size.y;
    var path: Path;
    path.absorbed = true;
    path.remaining = 1u;
    path.item = NONE;
    var traced: Traced;
    if ASIDE && order.resumes > 0u {
        take_up(&path, tile, aside);
    }
    let list_turns = turns_over_lists();
    var is_done = path.remaining == 0u;
    turns = 0u;
    ray_is_cut = false;
    // Terminates, because each turn increases `turns`: it ends after at most `turn_limit` turns, which include the
    // turns of inner loops except those of the last ray.
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
                record_ray(words[RECORD_HEAD_RAY_COUNT] + traced.rays, path, nearest);
            }
            traced.rays++;
        }
        let record = records[select(nearest.sphere, 0u, nearest.sphere == NONE)];
        var point: SurfacePoint;
        let ended = collect(&path, nearest, record, &point);
        if ended && path.remaining == 0u {
            if path.item != NONE {
                add_to_film(path);
                traced.finished += blocks[path.item / pixels].count;
            }
            path.item = next_item(path.item, thread, pixels);
            if path.item >= pixels * order.block_count {
                is_done = true;
                break;
            }
            enter_block(&path, tile, 0u);
        }
        send_on(&path, ended, nearest.sphere, record, point);
    }
    if !is_done {
        if ASIDE {
            put_aside(path, aside);
        }
        traced.unfinished = 1u;
        traced.stuck = select(0u, 1u, ray_is_cut && traced.rays == 0u);
    }
    traced.rejected = path.rejected;
    return traced;
}

// The block after `item` that the thread traces: the next of the tile, or the next of the thread's own pixel.
fn next_item(item: u32, thread: u32, pixels: u32) -> u32 {
    if ASIDE {
        return atomicAdd(&queue, 1u);
    }
    return select(item + pixels, thread, item == NONE);
}

// Turns of one ray's loops over lists: see `intersect`. Loops over a hierarchy count their own turns.
fn turns_over_lists() -> u32 {
    let anchored_count = select(job.anchored_count, ANCHORED_COUNT, FEW_ANCHORED);
    if HIERARCHY && SURFACE == SURFACE_EXACT {
        return anchored_count;
    }
    let opaque_count = select(job.opaque_count, OPAQUE_COUNT, FEW_SPHERES);
    let two_root_count = select(job.two_root_count, TWO_ROOT_COUNT, FEW_SPHERES);
    return opaque_count + two_root_count + anchored_count;
}

// Finds the nearest hit of a ray.
fn intersect(ray: Ray) -> Nearest {
    var nearest = nothing();
    // Counts that are known when the kernel is compiled let its loops be unrolled.
    let opaque_count = select(job.opaque_count, OPAQUE_COUNT, FEW_SPHERES);
    let two_root_count = select(job.two_root_count, TWO_ROOT_COUNT, FEW_SPHERES);
    let listed = opaque_count + two_root_count;
    if SURFACE != SURFACE_EXACT {
        let t_min = select(0.0, BOOK_T_MIN, SURFACE == SURFACE_BOOK);
        for (var i = 0u; i < listed; i++) {
            nearest = take(nearest, book_root(ray, sphere_at(i), t_min), i);
        }
        return nearest;
    }
    if HIERARCHY {
        // A hit of the ground rules out the boxes behind it.
        nearest = take_anchored(ray, nearest, listed);
        return traverse(ray, nearest);
    }
    for (var i = 0u; i < opaque_count; i++) {
        nearest = take(nearest, near_root(ray, sphere_at(i), i), i);
    }
    if TWO_ROOT {
        for (var i = opaque_count; i < listed; i++) {
            nearest = take(nearest, nearest_root(ray, sphere_at(i), i), i);
        }
    }
    return take_anchored(ray, nearest, listed);
}

// Takes the hits of the anchored spheres, where they are nearer. The first has the number `first`.
fn take_anchored(ray: Ray, found: Nearest, first: u32) -> Nearest {
    var nearest = found;
    if ANCHORED {
        let count = select(job.anchored_count, ANCHORED_COUNT, FEW_ANCHORED);
        for (var i = 0u; i < count; i++) {
            nearest = take(nearest, anchored_root(ray, anchored_at(i), first + i), first + i);
        }
    }
    return nearest;
}

// The hit point.
fn hit_point(ray: Ray, t: f32, record: ShadingRecord) -> SurfacePoint {
    var point: SurfacePoint;
    if SURFACE != SURFACE_EXACT {
        point = book_point(ray, t, record.reference, record.curvature);
    } else if ANCHORED && record.anchoring > 0.0 {
        point = anchored_surface_point(ray, t, record.reference, record.inward, record.curvature);
    } else if SPECKS {
        point = speck_surface_point(ray, t, record.reference, record.curvature, record.radius);
    } else {
        point = surface_point(ray, t, record.reference, record.curvature, record.radius);
    }
    return point;
}

// Splits x | y << 16 into column and row.
fn pixel_position(pixel: u32) -> vec2f {
    return vec2f(f32(pixel & 0xFFFFu), f32(pixel >> 16u));
}

// Adds the arriving light, ends the path, and starts the next sample if the path has ended. Returns whether it has. If
// the ray continues, sets `point` to the hit point.
fn collect(
    path: ptr<function, Path>,
    nearest: Nearest,
    record: ShadingRecord,
    point: ptr<function, SurfacePoint>,
) -> bool {
    let miss = nearest.sphere == NONE;
    var ended = miss || (*path).absorbed || (*path).bounce == job.max_depth - 1u;
    var lit = miss && !(*path).absorbed;
    if !ended || SHADING == SHADING_NORMALS {
        *point = hit_point((*path).ray, bitcast<f32>(nearest.key), record);
    }
    if SHADING != SHADING_PATH {
        lit = !(*path).absorbed;
        ended = true;
    }
    if lit {
        var light = shade_miss((*path).ray.direction.y);
        if SHADING != SHADING_PATH {
            light = shade_hit((*path).pixel, miss, (*point).outward, light);
        }
        add_radiance(path, light);
    }
    (*path).bounce = select((*path).bounce + 1u, 0u, ended);
    if ended {
        (*path).counter += (*path).step;
        (*path).remaining -= 1u;
    }
    return ended;
}

// The sky's radiance in a direction with this y component, in units of the film.
fn shade_miss(height: f32) -> vec3f {
    return max(vec3f(0.0), fma(job.sky_slope, vec3f(height), job.sky_middle));
}

// A ray's contribution in stages that show something simpler than light; `light` if the ray misses.
fn shade_hit(pixel: u32, miss: bool, outward: vec3f, light: vec3f) -> vec3f {
    if SHADING == SHADING_IMAGE_GRADIENT {
        // A single column or row has no far end, so its value is 0.
        return vec3f(pixel_position(pixel) / max(job.camera.size - 1.0, vec2f(1.0)), 0.0) * FIXED_POINT_SCALE;
    }
    var shown = vec3f(FIXED_POINT_SCALE, 0.0, 0.0);
    if SHADING == SHADING_NORMALS {
        let half = vec3f(0.5 * FIXED_POINT_SCALE);
        shown = max(vec3f(0.0), fma(outward, half, half));
    }
    return select(shown, light, miss);
}

// Adds the radiance of a finished path to the sums, or counts it as rejected if it is not a number that can be added.
fn add_radiance(path: ptr<function, Path>, light: vec3f) {
    let radiance = light * (*path).throughput;
    // Compares bits, because a compiler may assume that NaN never occurs. All invalid values have larger bits.
    let total = bitcast<u32>(radiance.x + radiance.y + radiance.z);
    if total < RADIANCE_TOTAL_LIMIT_BITS || total == NEGATIVE_ZERO_BITS {
        (*path).sums += vec3u(fixed_point(radiance.x), fixed_point(radiance.y), fixed_point(radiance.z));
    } else {
        (*path).rejected += 1u;
    }
}

// Starts sample `place` of the path's block.
fn enter_block(path: ptr<function, Path>, tile: Tile, place: u32) {
    let pixels = tile.size.x * tile.size.y;
    let block = blocks[(*path).item / pixels];
    let number = (*path).item % pixels;
    let position = tile.corner + vec2u(number % tile.size.x, number / tile.size.x);
    (*path).pixel = position.x | (position.y << 16u);
    (*path).corner = screen(job.camera, vec2f(position));
    (*path).sums = vec3u(0u);
    (*path).half = block.half;
    (*path).counter = block.counter + place * block.step;
    (*path).step = block.step;
    (*path).remaining = block.count - place;
    (*path).key = sampler_key(job.seed, block.half, (*path).pixel);
}

// Where a ray meets what it has hit.
struct Arrival {
    position: vec3f,
    // Unit normal on the side that the ray came from.
    normal: vec3f,
    // Cosine between the ray's direction and the outward normal.
    outward_cosine: f32,
    // Whether the ray came from outside.
    front: bool,
}

// Finds where and from which side a ray meets what it has hit.
fn arrive(ray: Ray, hit: u32, record: ShadingRecord, point: SurfacePoint) -> Arrival {
    let outward_cosine = dot3(ray.direction, point.outward);
    var front = outward_cosine < 0.0;
    if SURFACE == SURFACE_EXACT {
        front = front && ray.inside != hit;
    }
    if CAVITY {
        front = front && record.anchoring < 2.0;
    }
    return Arrival(point.position, select(-point.outward, point.outward, front), outward_cosine, front);
}

// The reflectance of what was hit.
fn albedo_of(record: ShadingRecord, pixel: u32) -> vec3f {
    if REFLECTANCE_STRIPS {
        return vec3f(strip_reflectance(pixel));
    }
    return record.albedo;
}

// The reflectance of the picture strip that contains a pixel: 10, 30, 50, 70 or 90 %.
fn strip_reflectance(pixel: u32) -> f32 {
    let strip = (pixel_position(pixel).x + 0.5) * (5.0 / job.camera.size.x) - 0.5;
    return fma(round(max(0.0, strip)), 0.2, 0.1);
}

// The numbers for a path's next ray.
struct Drawn {
    // For a direction, or for a point on the lens.
    pair: vec2f,
    // Sine and cosine of the second number of the pair, in turns.
    sine_cosine: vec2f,
    // For the point in the pixel.
    jitter: vec2f,
}

fn draw(path: Path) -> Drawn {
    let drawn = numbers(job.seed, path.pixel, path.counter, path.key, path.bounce, has_lens());
    let pair = vec2f(unit_float(drawn.x), unit_float(drawn.y));
    let jitter = vec2f(unit_float(drawn.z), unit_float(drawn.w));
    return Drawn(pair, sin_cos_turns(pair.y), jitter);
}

fn has_lens() -> bool {
    return LENS && job.camera.tau > 0.0;
}

// Continues the path from a surface, or starts a new one at the camera if it has ended. Neighbouring threads take both
// branches, so common work is outside the branch: one set of numbers, one sine and cosine, one normalisation.
fn send_on(path: ptr<function, Path>, ended: bool, hit: u32, record: ShadingRecord, point: SurfacePoint) {
    let drawn = draw(*path);
    var sent: Ray;
    if ended {
        let camera = generate_camera_ray((*path).corner, drawn);
        sent = Ray(camera.origin, camera.direction, select(NONE, EYE, EYE_ON_SURFACE), NONE);
        (*path).throughput = vec3f(1.0);
        (*path).absorbed = false;
    } else {
        sent = scatter_path(path, drawn, hit, record, point);
    }
    sent.direction = normalized(sent.direction);
    (*path).ray = sent;
}

// The camera ray of a new path.
fn generate_camera_ray(corner: vec2f, drawn: Drawn) -> CameraRay {
    var jitter = drawn.jitter;
    if !ANTIALIASING {
        jitter = vec2f(0.5);
    }
    if has_lens() {
        let on_lens = sqrt(drawn.pair.x) * drawn.sine_cosine.yx;
        return lens_ray(job.camera, corner, jitter, on_lens);
    }
    return pinhole_ray(job.camera, corner, jitter);
}

// Scatters at the hit. The direction is not normalised.
fn scatter_path(
    path: ptr<function, Path>,
    drawn: Drawn,
    hit: u32,
    record: ShadingRecord,
    point: SurfacePoint,
) -> Ray {
    let direction = (*path).ray.direction;
    let arrival = arrive((*path).ray, hit, record, point);
    let front = arrival.front;
    let normal = arrival.normal;
    let rho = sqrt(drawn.pair.x * (1.0 - drawn.pair.x));
    let across = (rho + rho) * drawn.sine_cosine.yx;
    let unit = vec3f(across.x, 1.0 - (drawn.pair.x + drawn.pair.x), across.y);
    let incidence = incidence_of(arrival.outward_cosine);
    let surface = surface_of(record);
    let coin = drawn.pair.x;
    var bounced: Scatter;
    if STEEP_GLASS {
        bounced = scatter_steeply(path, surface, hit, normal, incidence, front, unit, coin);
    } else {
        bounced = scatter(surface, direction, normal, incidence, front, unit, coin);
    }
    var sent = bounced.direction;
    if HEMISPHERE && surface.weight > 0.0 {
        sent = hemisphere(normal, unit);
    }
    if dot3(sent, sent) < NEAR_ZERO {
        sent = normal;
    }
    // Metal absorbs a fuzzy reflection that points into the surface.
    (*path).absorbed = METAL && bounced.is_metal && !(dot3(sent, normal) > 0.0);
    (*path).throughput *= albedo_of(record, (*path).pixel);
    let inward = front == bounced.refracts;
    return Ray(arrival.position, sent, select(hit, NONE, inward), select(NONE, hit, inward));
}

// Scatters where the rounded cosine does not give the angle of incidence precisely enough. A ray inside glass arrives
// at the same angle at which it started. The angle is stored, so that total reflection persists.
fn scatter_steeply(
    path: ptr<function, Path>,
    surface: Surface,
    hit: u32,
    normal: vec3f,
    rough: Incidence,
    front: bool,
    unit: vec3f,
    coin: f32,
) -> Scatter {
    let direction = (*path).ray.direction;
    let across = mul_add3(normal, rough.cosine, direction);
    let is_known = (*path).ray.inside == hit && surface.refraction_index > 0.0;
    let incidence = incidence_of_sine2(select(dot3(across, across), (*path).sine2, is_known));
    var bounced = scatter(surface, direction, normal, incidence, front, unit, coin);
    (*path).sine2 = incidence.sine2;
    if bounced.refracts {
        bounced.direction = refracted(across, normal, bounced.ratio, incidence.sine2);
        (*path).sine2 *= bounced.ratio * bounced.ratio;
    }
    return bounced;
}
