// Entry point for tests: runs one small function on many inputs. Thread i reads the words from PROBE_STRIDE * i on and
// overwrites them with its results.

fn f(base: u32, i: u32) -> f32 {
    return bitcast<f32>(scratch[base + i]);
}

fn v3(base: u32, i: u32) -> vec3f {
    return vec3f(f(base, i), f(base, i + 1u), f(base, i + 2u));
}

fn put(base: u32, i: u32, x: f32) {
    scratch[base + i] = bitcast<u32>(x);
}

fn put3(base: u32, i: u32, v: vec3f) {
    put(base, i, v.x);
    put(base, i + 1u, v.y);
    put(base, i + 2u, v.z);
}

fn probe_ray(base: u32) -> Ray {
    return Ray(v3(base, 0u), v3(base, 3u), scratch[base + 6u], scratch[base + 7u]);
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn probe(@builtin(global_invocation_id) id: vec3u) {
    let base = id.x * PROBE_STRIDE;
    if base + PROBE_STRIDE > arrayLength(&scratch) {
        return;
    }
    switch PROBE {
        case PROBE_PCG4D: {
            let v = pcg4d(vec4u(scratch[base], scratch[base + 1u], scratch[base + 2u], scratch[base + 3u]));
            scratch[base] = v.x;
            scratch[base + 1u] = v.y;
            scratch[base + 2u] = v.z;
            scratch[base + 3u] = v.w;
        }
        case PROBE_SOBOL: {
            let key = pixel_key(scratch[base], scratch[base + 1u], scratch[base + 2u]);
            let counter = scratch[base + 3u];
            let bounce = scratch[base + 4u];
            let drawn = numbers(scratch[base], scratch[base + 2u], counter, key, bounce, true);
            scratch[base] = drawn.x;
            scratch[base + 1u] = drawn.y;
            scratch[base + 2u] = drawn.z;
            scratch[base + 3u] = drawn.w;
        }
        case PROBE_SIN_COS: {
            let u = unit_float(scratch[base]);
            let sine_cosine = sin_cos_turns(u);
            put(base, 0u, u);
            put(base, 1u, sine_cosine.x);
            put(base, 2u, sine_cosine.y);
        }
        case PROBE_ROOTS: {
            let ray = probe_ray(base);
            let sphere = vec4f(v3(base, 8u), f(base, 11u));
            scratch[base] = near_root(ray, sphere, 1u);
            scratch[base + 1u] = nearest_root(ray, sphere, 1u);
            scratch[base + 2u] = book_root(ray, sphere, f(base, 14u));
            // As `traverse` does: the chord of a ray inside, and the other spheres.
            let start = select(ray.left, 1u, ray.inside == 1u);
            scratch[base + 3u] = select(signed_root(ray, sphere, 1u, start), chord_end(ray, sphere), ray.inside == 1u);
            scratch[base + 4u] = signed_root(ray, vec4f(sphere.xyz, -sphere.w), 1u, ray.left);
        }
        case PROBE_ANCHORED: {
            let ray = probe_ray(base);
            let sphere = AnchoredSphere(v3(base, 8u), f(base, 11u), v3(base, 12u), scratch[base + 3u] % 3u);
            let key = anchored_root(ray, sphere, 1u);
            let t = f(base, 15u);
            let point = anchored_surface_point(ray, t, sphere.anchor, sphere.inward, sphere.curvature);
            scratch[base] = key;
            put3(base, 1u, point.position);
            put3(base, 4u, point.outward);
        }
        case PROBE_SURFACE: {
            let ray = probe_ray(base);
            let point = surface_point(ray, f(base, 12u), v3(base, 8u), f(base, 11u), f(base, 13u));
            let speck = speck_surface_point(ray, f(base, 12u), v3(base, 8u), f(base, 11u), f(base, 13u));
            put3(base, 0u, point.position);
            put3(base, 3u, point.outward);
            put3(base, 6u, speck.position);
            put3(base, 9u, speck.outward);
        }
        case PROBE_SCATTER: {
            var record: ShadingRecord;
            record.weight = f(base, 0u);
            record.refraction_index = f(base, 1u);
            record.inverse_index = f(base, 2u);
            record.f0 = f(base, 3u);
            let material = material_of(record);
            let front_face = scratch[base + 14u] != 0u;
            let incidence = incidence_of(f(base, 13u));
            let coin = f(base, 15u);
            let scattered = scatter(material, v3(base, 4u), v3(base, 7u), incidence, front_face, v3(base, 10u), coin);
            let share = reflectance(incidence.cosine, f(base, 3u));
            let through = refracted(v3(base, 4u), v3(base, 7u), scattered.ratio, incidence.sine2);
            put3(base, 0u, scattered.direction);
            scratch[base + 3u] = select(0u, 1u, scattered.refracts) | select(0u, 2u, scattered.is_metal);
            put(base, 4u, share);
            put3(base, 5u, through);
        }
        case PROBE_CAMERA: {
            let corner = screen(job.camera, vec2f(f(base, 0u), f(base, 1u)));
            let jitter = vec2f(f(base, 2u), f(base, 3u));
            let on_lens = vec2f(f(base, 4u), f(base, 5u));
            let pinhole = pinhole_ray(job.camera, corner, jitter);
            let lens = lens_ray(job.camera, corner, jitter, on_lens);
            put3(base, 0u, pinhole.origin);
            put3(base, 3u, pinhole.direction);
            put3(base, 6u, lens.origin);
            put3(base, 9u, lens.direction);
        }
        case PROBE_FIXED_POINT: {
            scratch[base] = fixed_point(f(base, 0u));
        }
        case PROBE_INCIDENCE: {
            let by_cosine = incidence_of(f(base, 0u));
            let by_sine2 = incidence_of_sine2(f(base, 1u));
            let sent = hemisphere(v3(base, 2u), v3(base, 5u));
            let reflectance = strip_reflectance(scratch[base + 8u]);
            put(base, 0u, by_cosine.cosine);
            put(base, 1u, by_cosine.sine2);
            put(base, 2u, by_sine2.cosine);
            put(base, 3u, by_sine2.sine2);
            put3(base, 4u, sent);
            put(base, 7u, reflectance);
        }
        case PROBE_BOX: {
            let slabs = slabs_of(probe_ray(base), f(base, 15u));
            let slope = slope_of(slabs);
            let low = fma(v3(base, 8u), slope.inverse, -slabs.low);
            let high = fma(v3(base, 11u), slope.inverse, -slabs.high);
            let near = select(low, high, slope.backward);
            let far = select(high, low, slope.backward);
            scratch[base] = hit_bits(
                vec4f(near.x), vec4f(near.y), vec4f(near.z), vec4f(far.x), vec4f(far.y), vec4f(far.z),
                f(base, 14u), vec4u(1u, 2u, 4u, 8u),
            );
        }
        default: {}
    }
}
