// Rays from the camera. (Book 1, sections 12 and 13.)
//
// Twin: src/render_cpu/camera.rs

// Where a ray starts and its direction, which is not normalised.
struct CameraRay {
    origin: vec3f,
    direction: vec3f,
}

// Position of a pixel's left or upper edge on the plane at distance 1.
fn screen(camera: Camera, position: vec2f) -> vec2f {
    return fma(position, vec2f(camera.scale_x, camera.scale_y), camera.offset);
}

// A ray from the eye through the point `jitter` of the pixel at `corner`.
fn pinhole_ray(camera: Camera, corner: vec2f, jitter: vec2f) -> CameraRay {
    let s = fma(jitter, vec2f(camera.scale_x, camera.scale_y), corner);
    return CameraRay(camera.eye, through(camera, s));
}

// Like `pinhole_ray`, but from the point `on_lens` of the unit disk.
fn lens_ray(camera: Camera, corner: vec2f, jitter: vec2f, on_lens: vec2f) -> CameraRay {
    let s = fma(jitter, vec2f(camera.scale_x, camera.scale_y), corner);
    let direction = through(camera, fma(vec2f(-camera.tau), on_lens, s));
    let origin = mul_add3(camera.u, camera.lens_radius * on_lens.x, camera.eye);
    return CameraRay(mul_add3(camera.v, camera.lens_radius * on_lens.y, origin), direction);
}

fn through(camera: Camera, s: vec2f) -> vec3f {
    return mul_add3(camera.u, s.x, camera.v * s.y) - camera.w;
}
