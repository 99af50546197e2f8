// How a surface scatters a ray, into the direction `along d + across n + |weight| u`. (Book 1, sections 9 to 11.) The twin
// has a table of the three factors.
//
// Twin: src/render_cpu/material.rs

struct Material {
    // Weight of the unit vector; a negative sign (also on 0) marks a reflection.
    weight: f32,
    // Refraction index; 0 if not glass.
    refraction_index: f32,
    // 1 / refraction index; 0 if not glass.
    inverse_index: f32,
    // Schlick's reflectance at normal incidence.
    f0: f32,
}

// Metal and glass.
fn reflects(material: Material) -> bool {
    return (bitcast<u32>(material.weight) >> 31u) != 0u;
}

fn is_lambertian(material: Material) -> bool {
    return material.weight > 0.0;
}

fn is_glass(material: Material) -> bool {
    return material.refraction_index > 0.0;
}

// Extracts the material of a shading record.
fn material_of(record: ShadingRecord) -> Material {
    return Material(record.weight, record.refraction_index, record.inverse_index, record.f0);
}

// A scattered ray; the direction is not normalised.
struct Scattered {
    direction: vec3f,
    refracts: bool,
    is_metal: bool,
    // Sine of the refracted angle over sine of the incident angle, where the ray refracts.
    ratio: f32,
}

// The angle at which a ray meets a surface: its cosine to the normal, in [0, 1], and its squared sine.
struct Incidence {
    cosine: f32,
    sine2: f32,
}

// Computes the incidence from the cosine between direction and outward normal, which rounding can push above 1.
fn incidence_of(outward_cosine: f32) -> Incidence {
    let cosine = min(1.0, abs(outward_cosine));
    return Incidence(cosine, fma(-cosine, cosine, 1.0));
}

// Computes the incidence from the squared sine, which rounding can push above 1.
fn incidence_of_sine2(squared_sine: f32) -> Incidence {
    let sine2 = min(1.0, squared_sine);
    return Incidence(sqrt(1.0 - sine2), sine2);
}

// Scatters at any surface. `front_face` is true if the ray comes from outside; `coin` is uniform in [0, 1).
fn scatter(
    material: Material,
    direction: vec3f,
    normal: vec3f,
    incidence: Incidence,
    front_face: bool,
    unit: vec3f,
    coin: f32,
) -> Scattered {
    let cosine = incidence.cosine;
    var along = 0.0;
    var across = 1.0;
    var is_metal = false;
    var refracts = false;
    var ratio = 1.0;
    if METAL || GLASS {
        is_metal = reflects(material);
        along = select(0.0, 1.0, is_metal);
        across = select(1.0, cosine + cosine, is_metal);
    }
    if GLASS {
        is_metal = is_metal && !is_glass(material);
        ratio = select(material.refraction_index, material.inverse_index, front_face);
        // Squared sine of the refraction angle: above 1, Snell's law has no solution.
        let refracted_sine2 = ratio * ratio * incidence.sine2;
        refracts = is_glass(material);
        if DIELECTRIC_LAWS != LAWS_REFRACT_ONLY {
            refracts = refracts && refracted_sine2 <= 1.0;
        }
        if DIELECTRIC_LAWS == LAWS_SCHLICK {
            refracts = refracts && coin >= reflectance(cosine, material.f0);
        }
        let inner_cosine = sqrt(abs(1.0 - refracted_sine2));
        along = select(along, ratio, refracts);
        across = select(across, fma(ratio, cosine, -inner_cosine), refracts);
    }
    var scattered = normal * across;
    if METAL || GLASS {
        scattered = mul_add3(direction, along, scattered);
    }
    if LAMBERTIAN || FUZZ {
        scattered = mul_add3(unit, abs(material.weight), scattered);
    }
    return Scattered(scattered, refracts, is_metal, ratio);
}

// The refracted direction, not normalised, from the part of the incoming direction `across` the normal. This form keeps
// its precision where the usual form subtracts large numbers.
fn refracted(across: vec3f, normal: vec3f, ratio: f32, sine2: f32) -> vec3f {
    let inner_cosine = sqrt(abs(1.0 - ratio * ratio * sine2));
    return neg_mul_add3(normal, inner_cosine, across * ratio);
}

// Schlick's approximation of the reflectance. (Section 11.4.)
fn reflectance(cosine: f32, f0: f32) -> f32 {
    let x = 1.0 - cosine;
    let x2 = x * x;
    return fma(1.0 - f0, x2 * x2 * x, f0);
}

// A uniform direction on the side of `normal`. (Section 9.1.)
fn hemisphere(normal: vec3f, unit: vec3f) -> vec3f {
    return unit * copysign(1.0, dot3(unit, normal));
}
