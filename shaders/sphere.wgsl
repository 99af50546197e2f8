// Ray-sphere intersection. (Book 1, section 5.) Distances are compared as the bits of a float, read as an unsigned
// integer. In that order negative numbers come last: -1 stands for a miss.
//
// Twin: src/render_cpu/sphere.rs

// A ray being traced. `left` is the sphere that it leaves outwards, `inside` the sphere that it enters, or NONE. For a
// ray that starts at an eye on a surface, `left` is EYE.
struct Ray {
    origin: vec3f,
    direction: vec3f,
    left: u32,
    inside: u32,
}

// The nearest hit found so far: the bits of its distance and the sphere's number, or NONE.
struct Nearest {
    key: u32,
    sphere: u32,
}

fn nothing() -> Nearest {
    return Nearest(INFINITE_KEY, NONE);
}

// Of two spheres at the same distance, the one taken first stays.
fn take(nearest: Nearest, key: u32, sphere: u32) -> Nearest {
    let nearer = key < nearest.key;
    return Nearest(select(nearest.key, key, nearer), select(nearest.sphere, sphere, nearer));
}

// Of two spheres at the same distance, the first in the list stays. Leaves do not keep the order of the list, and
// anchored spheres come last in it.
fn take_in_any_order(nearest: Nearest, key: u32, sphere: u32) -> Nearest {
    var nearer = key < nearest.key;
    if key == nearest.key && nearest.sphere != NONE {
        nearer = nearest.sphere >= job.opaque_count + job.two_root_count
            || rank_of(sphere) < rank_of(nearest.sphere);
    }
    return Nearest(select(nearest.key, key, nearer), select(nearest.sphere, sphere, nearer));
}

// The smaller of two distances, as bits.
fn smaller_key(a: f32, b: f32) -> u32 {
    return min(bitcast<u32>(a), bitcast<u32>(b));
}

// Distance to the middle of the chord, and the square of half its length, which is negative for a miss.
fn chord(ray: Ray, sphere: vec4f) -> vec2f {
    let f = sphere.xyz - ray.origin;
    let h = dot3(ray.direction, f);
    let across = neg_mul_add3(ray.direction, h, f);
    let d = fma(-across.x, across.x, fma(-across.y, across.y, fma(-across.z, across.z, sphere.w)));
    return vec2f(h, d);
}

// Distance to a sphere that no ray is inside of.
fn near_root(ray: Ray, sphere: vec4f, number: u32) -> u32 {
    let hd = chord(ray, sphere);
    let near = hd.x - sqrt(max(hd.y, 0.0));
    return bitcast<u32>(select(-1.0, near, hd.y >= 0.0 && ray.left != number));
}

// Distance to a sphere from inside or outside.
fn nearest_root(ray: Ray, sphere: vec4f, number: u32) -> u32 {
    let hd = chord(ray, sphere);
    let s = sqrt(max(hd.y, 0.0));
    let meets = hd.y >= 0.0;
    let leaves = ray.left == number;
    let enters = ray.inside == number;
    let near = select(-1.0, hd.x - s, meets && !leaves && !enters);
    // A ray that enters the sphere from its surface travels the chord 2h.
    let far = hd.x + select(s, abs(hd.x), enters);
    return smaller_key(near, select(-1.0, far, (meets || enters) && !leaves));
}

// Whether only the nearer root of a sphere of a hierarchy counts: its squared radius is negative.
fn has_one_root(sphere: vec4f) -> bool {
    return sphere.w < 0.0;
}

// Distance to a sphere of a hierarchy, unless the ray starts on it.
fn signed_root(ray: Ray, sphere: vec4f, number: u32, start: u32) -> u32 {
    let hd = chord(ray, vec4f(sphere.xyz, abs(sphere.w)));
    let s = sqrt(max(hd.y, 0.0));
    let key = select(smaller_key(hd.x - s, hd.x + s), bitcast<u32>(hd.x - s), has_one_root(sphere));
    return select(MISS_KEY, key, hd.y >= 0.0 && number != start);
}

// Distance to the far end of the chord of a ray that enters a sphere from its surface.
fn chord_end(ray: Ray, sphere: vec4f) -> u32 {
    let h = dot3(ray.direction, sphere.xyz - ray.origin);
    return bitcast<u32>(h + abs(h));
}

// Distance to an anchored sphere: everything is measured from the anchor.
fn anchored_root(ray: Ray, sphere: AnchoredSphere, number: u32) -> u32 {
    let d = ray.direction;
    let m = sphere.inward;
    let k = sphere.curvature;
    let x = ray.origin - sphere.anchor;
    let x_along = dot3(x, d);
    let m_along = dot3(m, d);
    let x_across = neg_mul_add3(d, x_along, x);
    let m_across = neg_mul_add3(d, m_along, m);
    let b = fma(-k, x_along, m_along);
    let c = fma(-2.0, dot3(x, m), k * dot3(x, x));
    let bend = fma(-2.0, dot3(x_across, m_across), k * dot3(x_across, x_across));
    let discriminant = fma(-k, bend, m_along * m_along);
    let meets = discriminant >= 0.0;
    let q = b + copysign(sqrt(max(discriminant, 0.0)), b);
    let starts = EYE_ON_SURFACE && ray.left == EYE && (sphere.flags & UNDER_EYE) != 0u;
    let leaves = ray.left == number || (starts && m_along < 0.0);
    let enters = ray.inside == number;
    // A ray that enters the sphere from its surface travels the chord 2b.
    let second = select(q, b + abs(b), enters) / k;
    let roots = sphere.flags & ROOTS_MASK;
    if roots == ROOTS_NEARER {
        // A ray that rounding puts inside hits the sphere where it starts.
        return bitcast<u32>(select(-1.0, max(c, 0.0) / q, meets && q > 0.0 && !leaves));
    }
    if roots == ROOTS_FARTHER {
        var farther = max(second, 0.0);
        if !enters && q != 0.0 {
            farther = max(farther, c / q);
        }
        return bitcast<u32>(farther);
    }
    let first = select(-1.0, c / q, meets && !leaves && !enters);
    return smaller_key(first, select(-1.0, second, (meets || enters) && !leaves));
}

// The book's own quadratic, which does not track the surface that a ray leaves: the nearer root beyond `t_min`.
fn book_root(ray: Ray, sphere: vec4f, t_min: f32) -> u32 {
    let f = sphere.xyz - ray.origin;
    let a = dot3(ray.direction, ray.direction);
    let h = dot3(ray.direction, f);
    let c = dot3(f, f) - sphere.w;
    let discriminant = h * h - a * c;
    let s = sqrt(max(discriminant, 0.0));
    let near = (h - s) / a;
    let far = (h + s) / a;
    let meets = discriminant >= 0.0;
    return smaller_key(select(-1.0, near, meets && near > t_min), select(-1.0, far, meets && far > t_min));
}

// A point on a surface, and the unit normal pointing away from the centre.
struct SurfacePoint {
    position: vec3f,
    outward: vec3f,
}

// The point at distance `t`, moved onto the sphere along the normal, which one Newton step normalises.
fn surface_point(ray: Ray, t: f32, center: vec3f, curvature: f32, radius: f32) -> SurfacePoint {
    let w = mul_add3(ray.direction, t, ray.origin - center) * curvature;
    let outward = w * fma(-0.5, dot3(w, w), 1.5);
    return SurfacePoint(mul_add3(outward, radius, center), outward);
}

// Like `surface_point`, with the book's own arithmetic: rounding may leave the point off the surface.
fn book_point(ray: Ray, t: f32, center: vec3f, curvature: f32) -> SurfacePoint {
    let position = mul_add3(ray.direction, t, ray.origin);
    return SurfacePoint(position, (position - center) * curvature);
}

// Like `surface_point`, for a sphere so far away that the rounding of `t` is a sizeable part of its radius. The point
// is found from the vector between the centre and the ray, and half the chord from there.
fn speck_surface_point(ray: Ray, t: f32, center: vec3f, curvature: f32, radius: f32) -> SurfacePoint {
    let g = ray.origin - center;
    let h = dot3(ray.direction, g);
    let across = neg_mul_add3(ray.direction, h, g) * curvature;
    let along = sqrt(max(1.0 - dot3(across, across), 0.0));
    let w = mul_add3(ray.direction, copysign(along, t + h), across);
    let outward = w * (1.0 / sqrt(dot3(w, w)));
    return SurfacePoint(mul_add3(outward, radius, center), outward);
}

// Like `surface_point`, on an anchored sphere.
fn anchored_surface_point(ray: Ray, t: f32, anchor: vec3f, inward: vec3f, curvature: f32) -> SurfacePoint {
    let x = mul_add3(ray.direction, t, ray.origin - anchor);
    let away = x * curvature - inward;
    let length = sqrt(dot3(away, away));
    let outward = away * (1.0 / length);
    let c = fma(-2.0, dot3(x, inward), curvature * dot3(x, x));
    let height = c / (1.0 + length);
    return SurfacePoint(neg_mul_add3(outward, height, x) + anchor, outward);
}
