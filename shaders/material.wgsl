// What a surface does with a ray: it goes on along `along d + across n + weight u`. (Book 1, sections 9 to 11.)
//
// Twin: src/render_cpu/material.rs

struct Surface {
    // Length of the unit vector's part; with a minus sign (also on 0) the direction is a reflection.
    weight: f32,
    // Refraction index; 0 if not glass.
    refraction_index: f32,
    // 1 / refraction index; 0 if not glass.
    inverse_index: f32,
    // Schlick's share at normal incidence.
    f0: f32,
}

// The material of a shading record.
fn surface_of(record: ShadingRecord) -> Surface {
    return Surface(record.weight, record.refraction_index, record.inverse_index, record.f0);
}

// Where light goes on; the direction's length is not 1.
struct Scatter {
    direction: vec3f,
    refracts: bool,
    is_metal: bool,
    // Sine in the refracted direction over that of incidence, where it refracts.
    ratio: f32,
}

// How a ray meets a surface: the cosine with the normal, in [0, 1], and the squared sine.
struct Incidence {
    cosine: f32,
    sine2: f32,
}

// From the cosine of direction and outward normal, which rounding can make larger than 1.
fn incidence_of(outward_cosine: f32) -> Incidence {
    let cosine = min(1.0, abs(outward_cosine));
    return Incidence(cosine, fma(-cosine, cosine, 1.0));
}

// From the squared sine, which rounding can make larger than 1.
fn incidence_of_sine2(squared_sine: f32) -> Incidence {
    let sine2 = min(1.0, squared_sine);
    return Incidence(sqrt(1.0 - sine2), sine2);
}

// Scatters at any surface. `front` says that the ray comes from outside; `coin` is uniform in [0, 1).
fn scatter(
    surface: Surface,
    direction: vec3f,
    normal: vec3f,
    incidence: Incidence,
    front: bool,
    unit: vec3f,
    coin: f32,
) -> Scatter {
    let cosine = incidence.cosine;
    var along = 0.0;
    var across = 1.0;
    var is_metal = false;
    var refracts = false;
    var ratio = 1.0;
    if METAL || GLASS {
        is_metal = (bitcast<u32>(surface.weight) >> 31u) != 0u;
        along = select(0.0, 1.0, is_metal);
        across = select(1.0, cosine + cosine, is_metal);
    }
    if GLASS {
        let is_glass = surface.refraction_index > 0.0;
        ratio = select(surface.refraction_index, surface.inverse_index, front);
        // Squared sine of the refracted ray's angle: above 1 Snell's law has no solution.
        let refracted_sine2 = ratio * ratio * incidence.sine2;
        refracts = is_glass;
        if DIELECTRIC_LAWS != LAWS_REFRACT_ONLY {
            refracts = refracts && refracted_sine2 <= 1.0;
        }
        if DIELECTRIC_LAWS == LAWS_SCHLICK {
            refracts = refracts && coin >= reflectance(cosine, surface.f0);
        }
        let inner_cosine = sqrt(abs(1.0 - refracted_sine2));
        along = select(along, ratio, refracts);
        across = select(across, fma(ratio, cosine, -inner_cosine), refracts);
        is_metal = is_metal && !is_glass;
    }
    var sent = normal * across;
    if METAL || GLASS {
        sent = mul_add3(direction, along, sent);
    }
    if LAMBERTIAN || FUZZ {
        sent = mul_add3(unit, abs(surface.weight), sent);
    }
    return Scatter(sent, refracts, is_metal, ratio);
}

// The refracted direction from the part of the incoming one `across` the normal, which loses nothing where the other
// form takes a difference of large numbers. Not of length 1.
fn refracted(across: vec3f, normal: vec3f, ratio: f32, sine2: f32) -> vec3f {
    let inner_cosine = sqrt(abs(1.0 - ratio * ratio * sine2));
    return neg_mul_add3(normal, inner_cosine, across * ratio);
}

// Schlick's approximation of the reflected share. (Section 11.4.)
fn reflectance(cosine: f32, f0: f32) -> f32 {
    let x = 1.0 - cosine;
    let x2 = x * x;
    return fma(1.0 - f0, x2 * x2 * x, f0);
}

// A uniform direction on the side of `normal`. (Section 9.1.)
fn hemisphere(normal: vec3f, unit: vec3f) -> vec3f {
    return unit * copysign(1.0, dot3(unit, normal));
}
