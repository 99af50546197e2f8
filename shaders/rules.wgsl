// The rules of the stages: what early pictures of the book show in place of the finished renderer.
//
// Twin: src/render_cpu/path/rules.rs

// The nearest hit by the book's own quadratic.
fn book_nearest(ray: Ray) -> Nearest {
    let t_min = select(0.0, BOOK_T_MIN, SURFACE == SURFACE_BOOK);
    let listed = opaque_count() + two_root_count();
    var nearest = nothing();
    for (var i = 0u; i < listed; i++) {
        nearest = take(nearest, book_root(ray, sphere_at(i), t_min), i);
    }
    return nearest;
}

// The colour that a stage shows in place of light, in units of the film: `sky` if the ray misses.
fn shown_colour(pixel: u32, miss: bool, sky: vec3f, outward: vec3f) -> vec3f {
    if SHADING == SHADING_IMAGE_GRADIENT {
        // A single column or row has no far end, so its share is 0.
        return vec3f(pixel_position(pixel) / max(job.camera.size - 1.0, vec2f(1.0)), 0.0) * FIXED_POINT_SCALE;
    }
    var shown = vec3f(FIXED_POINT_SCALE, 0.0, 0.0);
    if SHADING == SHADING_NORMALS {
        let half = vec3f(0.5 * FIXED_POINT_SCALE);
        shown = max(vec3f(0.0), fma(outward, half, half));
    }
    return select(shown, sky, miss);
}

// The reflectance of the picture strip that contains a pixel: 10, 30, 50, 70 or 90 %.
fn strip_reflectance(pixel: u32) -> f32 {
    let strip = (pixel_position(pixel).x + 0.5) * (5.0 / job.camera.size.x) - 0.5;
    return fma(round(max(0.0, strip)), 0.2, 0.1);
}

// The scattered direction, or one in the hemisphere of the normal where a Lambertian surface scatters so.
fn diffuse_direction(material: Material, scattered: vec3f, normal: vec3f, unit: vec3f) -> vec3f {
    if HEMISPHERE && is_lambertian(material) {
        return hemisphere(normal, unit);
    }
    return scattered;
}
