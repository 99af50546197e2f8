// The path loop: intersect, shade, spawn the next ray. A thread traces blocks of a pixel's samples. When a path ends, it
// starts the next sample immediately, so no thread waits for the longest path beside it. Where paths can be long, a thread
// that has finished its block takes the next one of the workgroup's tile, so no thread idles on the slowest pixel.
//
// Twin: src/render_cpu/path

// State that persists from ray to ray must also be suspended: see suspend.wgsl.
struct Path {
    ray: Ray,
    throughput: vec3f,
    // Squared sine of the angle between a ray inside steep glass and the normal where it starts; it is the same where
    // the ray ends.
    sine2: f32,
    bounce: u32,
    // The sampler's counter, which selects the sample, and its increment per sample.
    counter: u32,
    step: u32,
    // Samples left in the block, including the current one.
    remaining: u32,
    // Number of the block among those of the tile; NONE before the first.
    block: u32,
    // Key of the Sobol sampler.
    key: u32,
    // x | y << 16
    pixel: u32,
    // Left and upper edge of the pixel on the plane at distance 1.
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

// Counts of a thread's work.
struct Traced {
    rays: u32,
    rejected: u32,
    // Samples whose sums are in the film.
    finished: u32,
    // 1 if a path was suspended.
    unfinished: u32,
    // 1 if not even one ray could be traced to its end.
    stuck: u32,
}

// Iterations of all loops of this thread so far.
var<private> iterations: u32;

// Whether the current ray's traversal ended early: some drivers end loops after many iterations.
var<private> ray_is_cut: bool;

// The number of the next block of the tile that no thread has begun.
var<workgroup> next_block: atomic<u32>;

// Traces blocks of the dispatch in a tile, or continues them. After the number of iterations that the dispatch allows,
// the path is suspended to the scratch words from `suspended` on.
fn trace(tile: Tile, thread: u32, suspended: u32) -> Traced {
    let pixels = tile.size.x * tile.size.y;
    var path: Path;
    path.absorbed = true;
    path.remaining = 1u;
    path.block = NONE;
    var traced: Traced;
    if SUSPENDS && dispatch.resumes > 0u {
        resume(&path, tile, suspended);
    }
    let list_iterations = iterations_over_lists();
    var is_done = path.remaining == 0u;
    iterations = 0u;
    ray_is_cut = false;
    // Terminates, because `iterations` increases: it ends after at most `iteration_limit` iterations, which include those
    // of inner loops, except for the last ray's.
    while !is_done && iterations < dispatch.iteration_limit {
        iterations += 1u;
        var nearest = nothing();
        if !path.absorbed {
            if RAYS {
                iterations += list_iterations;
                nearest = intersect(path.ray);
            }
            if HIERARCHY && ray_is_cut {
                break;
            }
            traced.rays++;
        }
        let record = records[select(nearest.sphere, 0u, nearest.sphere == NONE)];
        var point: SurfacePoint;
        let ended = shade(&path, nearest, record, &point);
        if ended && path.remaining == 0u {
            if path.block != NONE {
                add_to_film(path);
                traced.finished += blocks[path.block / pixels].count;
            }
            path.block = take_block(path.block, thread, pixels);
            if path.block >= pixels * dispatch.block_count {
                is_done = true;
                break;
            }
            enter_block(&path, tile, 0u);
        }
        spawn_ray(&path, ended, nearest.sphere, record, point);
    }
    if !is_done {
        if SUSPENDS {
            suspend(path, suspended);
        }
        traced.unfinished = 1u;
        traced.stuck = u32(ray_is_cut && traced.rays == 0u);
    }
    traced.rejected = path.rejected;
    return traced;
}

// The block that the thread traces after `block`: the next of the tile, or the next of the thread's own pixel.
fn take_block(block: u32, thread: u32, pixels: u32) -> u32 {
    if SUSPENDS {
        return atomicAdd(&next_block, 1u);
    }
    return select(block + pixels, thread, block == NONE);
}

// Iterations of one ray's loops over lists: see `intersect`. Loops over a hierarchy count their own iterations.
fn iterations_over_lists() -> u32 {
    if HIERARCHY && SURFACE == SURFACE_EXACT {
        return anchored_count();
    }
    return opaque_count() + two_root_count() + anchored_count();
}

// Finds the nearest hit of a ray.
fn intersect(ray: Ray) -> Nearest {
    if SURFACE != SURFACE_EXACT {
        return book_nearest(ray);
    }
    var nearest = nothing();
    let opaque = opaque_count();
    let listed = opaque + two_root_count();
    if HIERARCHY {
        // A hit of the ground rules out the boxes behind it.
        nearest = take_anchored(ray, nearest, listed);
        return traverse(ray, nearest);
    }
    for (var i = 0u; i < opaque; i++) {
        nearest = take(nearest, near_root(ray, sphere_at(i), i), i);
    }
    if TWO_ROOT {
        for (var i = opaque; i < listed; i++) {
            nearest = take(nearest, nearest_root(ray, sphere_at(i), i), i);
        }
    }
    return take_anchored(ray, nearest, listed);
}

// Takes the hits of the anchored spheres, where they are nearer. The first has the number `first`.
fn take_anchored(ray: Ray, found: Nearest, first: u32) -> Nearest {
    var nearest = found;
    if ANCHORED {
        let count = anchored_count();
        for (var i = 0u; i < count; i++) {
            nearest = take(nearest, anchored_root(ray, anchored_at(i), first + i), first + i);
        }
    }
    return nearest;
}

// The hit point.
fn hit_point(ray: Ray, t: f32, record: ShadingRecord) -> SurfacePoint {
    if SURFACE != SURFACE_EXACT {
        return book_point(ray, t, record.reference, record.curvature);
    }
    if ANCHORED && is_anchored(record) {
        return anchored_surface_point(ray, t, record.reference, record.inward, record.curvature);
    }
    if SPECKS {
        return speck_surface_point(ray, t, record.reference, record.curvature, record.radius);
    }
    return surface_point(ray, t, record.reference, record.curvature, record.radius);
}

// Shades a hit: adds light, ends the path, and starts the next sample if it has ended. Returns whether it has. If the path
// continues, sets `point` to the hit point.
fn shade(
    path: ptr<function, Path>,
    nearest: Nearest,
    record: ShadingRecord,
    point: ptr<function, SurfacePoint>,
) -> bool {
    // End paths that miss, that were absorbed, or that have all their rays.
    let miss = nearest.sphere == NONE;
    var ended = miss || (*path).absorbed || (*path).bounce == job.max_depth - 1u;

    // Find the hit point of the others.
    if !ended || SHADING == SHADING_NORMALS {
        *point = hit_point((*path).ray, bitcast<f32>(nearest.key), record);
    }

    // Add the light of the sky where the ray misses, or what the stage shows in its place.
    var lit = miss && !(*path).absorbed;
    if SHADING != SHADING_PATH {
        lit = !(*path).absorbed;
        ended = true;
    }
    if lit {
        var light = sky_light((*path).ray.direction.y);
        if SHADING != SHADING_PATH {
            light = shown_colour((*path).pixel, miss, light, (*point).outward);
        }
        add_radiance(path, light);
    }

    // Start the next sample where a path has ended.
    (*path).bounce = select((*path).bounce + 1u, 0u, ended);
    if ended {
        (*path).counter += (*path).step;
        (*path).remaining -= 1u;
    }
    return ended;
}

// The sky's radiance in a direction with this y component, in units of the film.
fn sky_light(height: f32) -> vec3f {
    return max(vec3f(0.0), fma(job.sky_slope, vec3f(height), job.sky_middle));
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
    let block = blocks[(*path).block / pixels];
    let number = (*path).block % pixels;
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

// Where a ray meets the surface that it has hit, and from which side.
struct SurfaceInteraction {
    position: vec3f,
    // Unit normal on the side that the ray came from.
    normal: vec3f,
    // Cosine between the ray's direction and the outward normal.
    outward_cosine: f32,
    // Whether the ray came from outside.
    front_face: bool,
}

// Finds where and from which side a ray meets the surface that it has hit.
fn surface_interaction(ray: Ray, hit: u32, record: ShadingRecord, point: SurfacePoint) -> SurfaceInteraction {
    let outward_cosine = dot3(ray.direction, point.outward);
    var front_face = outward_cosine < 0.0;
    if SURFACE == SURFACE_EXACT {
        front_face = front_face && ray.inside != hit;
    }
    if CAVITY {
        front_face = front_face && !is_cavity(record);
    }
    let normal = select(-point.outward, point.outward, front_face);
    return SurfaceInteraction(point.position, normal, outward_cosine, front_face);
}

// The reflectance of the surface that was hit.
fn albedo_of(record: ShadingRecord, pixel: u32) -> vec3f {
    if REFLECTANCE_STRIPS {
        return vec3f(strip_reflectance(pixel));
    }
    return record.albedo;
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

// Spawns the next ray: from a surface, or from the camera if the path has ended. Neighbouring threads take both branches,
// so common work is outside the branch: one set of numbers, one sine and cosine, one normalisation.
fn spawn_ray(path: ptr<function, Path>, ended: bool, hit: u32, record: ShadingRecord, point: SurfacePoint) {
    let drawn = draw(*path);
    var ray: Ray;
    if ended {
        let camera = generate_camera_ray((*path).corner, drawn);
        ray = Ray(camera.origin, camera.direction, select(NONE, EYE, EYE_ON_SURFACE), NONE);
        (*path).throughput = vec3f(1.0);
        (*path).absorbed = false;
    } else {
        ray = scatter_path(path, drawn, hit, record, point);
    }
    ray.direction = normalized(ray.direction);
    (*path).ray = ray;
}

// The camera ray of a new path.
fn generate_camera_ray(corner: vec2f, drawn: Drawn) -> CameraRay {
    let jitter = select(vec2f(0.5), drawn.jitter, ANTIALIASING);
    if has_lens() {
        let on_lens = sqrt(drawn.pair.x) * drawn.sine_cosine.yx;
        return lens_ray(job.camera, corner, jitter, on_lens);
    }
    return pinhole_ray(job.camera, corner, jitter);
}

// Scatters the path at the surface that it has hit. The direction is not normalised.
fn scatter_path(
    path: ptr<function, Path>,
    drawn: Drawn,
    hit: u32,
    record: ShadingRecord,
    point: SurfacePoint,
) -> Ray {
    let ray = (*path).ray;
    let interaction = surface_interaction(ray, hit, record, point);
    let front_face = interaction.front_face;
    let normal = interaction.normal;
    let material = material_of(record);
    (*path).throughput *= albedo_of(record, (*path).pixel);

    // A uniform unit vector, with a vertical pole.
    let coin = drawn.pair.x;
    let rho = sqrt(coin * (1.0 - coin));
    let across = (rho + rho) * drawn.sine_cosine.yx;
    let unit = vec3f(across.x, 1.0 - (coin + coin), across.y);

    let incidence = incidence_of(interaction.outward_cosine);
    var scattered: Scattered;
    if STEEP_GLASS {
        scattered = scatter_steeply(path, material, hit, normal, incidence, front_face, unit, coin);
    } else {
        scattered = scatter(material, ray.direction, normal, incidence, front_face, unit, coin);
    }
    var direction = diffuse_direction(material, scattered.direction, normal, unit);
    if dot3(direction, direction) < NEAR_ZERO {
        direction = normal;
    }

    // Metal absorbs a fuzzy reflection that points into the surface.
    (*path).absorbed = METAL && scattered.is_metal && !(dot3(direction, normal) > 0.0);

    // Remember the sphere that the ray leaves or is inside of.
    let continues_inside = front_face == scattered.refracts;
    let left = select(hit, NONE, continues_inside);
    let inside = select(NONE, hit, continues_inside);
    return Ray(interaction.position, direction, left, inside);
}

// Scatters where the rounded cosine does not give the angle of incidence precisely enough. A ray inside glass arrives
// at the same angle at which it started. The angle is stored, so that total reflection persists.
fn scatter_steeply(
    path: ptr<function, Path>,
    material: Material,
    hit: u32,
    normal: vec3f,
    rough: Incidence,
    front_face: bool,
    unit: vec3f,
    coin: f32,
) -> Scattered {
    let direction = (*path).ray.direction;
    let across = mul_add3(normal, rough.cosine, direction);
    let is_known = (*path).ray.inside == hit && is_glass(material);
    let incidence = incidence_of_sine2(select(dot3(across, across), (*path).sine2, is_known));
    var scattered = scatter(material, direction, normal, incidence, front_face, unit, coin);
    (*path).sine2 = incidence.sine2;
    if scattered.refracts {
        scattered.direction = refracted(across, normal, scattered.ratio, incidence.sine2);
        (*path).sine2 *= scattered.ratio * scattered.ratio;
    }
    return scattered;
}

// Splits x | y << 16 into column and row.
fn pixel_position(pixel: u32) -> vec2f {
    return vec2f(f32(pixel & 0xFFFFu), f32(pixel >> 16u));
}

// Whether the sphere of a record is anchored.
fn is_anchored(record: ShadingRecord) -> bool {
    return record.anchoring > 0.0;
}

// Whether the sphere of a record encloses every ray.
fn is_cavity(record: ShadingRecord) -> bool {
    return record.anchoring > 1.0;
}
