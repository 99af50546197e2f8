//! How a surface scatters a ray. (Book 1, sections 9 to 11.)
//!
//! Every material scatters a ray into the direction `along d + across n + |weight| u`, where `d` is the incoming
//! direction, `n` the unit normal on the incoming side and `u` a uniform unit vector. Materials differ only in the three
//! factors, so a packet of mixed materials takes one path through this code:
//!
//! | material         | along | across               | weight  |
//! |------------------|-------|----------------------|---------|
//! | Lambertian       | 0     | 1                    | 1       |
//! | metal            | 1     | 2 cos θ              | −fuzz   |
//! | glass, reflected | 1     | 2 cos θ              | −0      |
//! | glass, refracted | η     | η cos θ − cos θ′     | −0      |
//!
//! θ is the angle of incidence, θ′ that of refraction, and η the ratio of their sines, sin θ′ / sin θ. The sign of the
//! weight tells materials that reflect from Lambertian ones.
//!
//! Twin: shaders/material.wgsl

use super::lanes::{Float, Lanes, Mask, V3, is_idle};
use crate::kernel::LoadShading;
use crate::stages::DielectricLaws;

/// A material as stored in a shading record.
#[derive(Clone, Copy)]
pub struct Material<L: Lanes> {
    /// Weight of the unit vector; a negative sign (also on 0) marks a reflection.
    pub weight: L::F,
    /// Refraction index; 0 if not glass.
    pub refraction_index: L::F,
    /// 1 / refraction index; 0 if not glass.
    pub inverse_index: L::F,
    /// Schlick's reflectance at normal incidence.
    pub f0: L::F,
}

impl<L: Lanes> Material<L> {
    /// Metal and glass.
    #[inline(always)]
    pub fn reflects(&self) -> L::M {
        self.weight.is_negative()
    }

    #[inline(always)]
    pub fn is_lambertian(&self, l: L) -> L::M {
        l.constant(0.0).lt(self.weight)
    }

    #[inline(always)]
    pub fn is_glass(&self, l: L) -> L::M {
        l.constant(0.0).lt(self.refraction_index)
    }
}

/// Extracts the materials of shading records.
#[inline(always)]
pub fn material_of<L: Lanes>(
    record: &impl LoadShading<L::Real, Number = L::F, Vector = V3<L::F>>,
) -> Material<L> {
    Material {
        weight: record.weight(),
        refraction_index: record.refraction_index(),
        inverse_index: record.inverse_index(),
        f0: record.f0(),
    }
}

/// A scattered ray.
pub struct Scattered<L: Lanes> {
    /// The scattered direction, not normalised.
    pub direction: V3<L::F>,
    /// Whether it passes through the surface.
    pub refracts: L::M,
    /// Whether the surface is a metal.
    pub is_metal: L::M,
    /// Sine of the refracted angle over sine of the incident angle, where the ray refracts.
    pub ratio: L::F,
}

impl<L: Lanes> Scattered<L> {
    /// Stands for scattered rays where no lane needs one.
    #[inline(always)]
    pub fn unused(l: L) -> Self {
        let zero = l.constant(0.0);
        Scattered { direction: V3::splat(zero), refracts: l.mask(0), is_metal: l.mask(0), ratio: zero }
    }
}

/// The angle at which a ray meets a surface.
pub struct Incidence<L: Lanes> {
    /// Cosine of the angle to the normal, in `[0, 1]`.
    pub cosine: L::F,
    /// Squared sine of that angle.
    pub sine2: L::F,
}

/// Computes the incidence from the cosine between direction and outward normal, which rounding can push above 1.
#[inline(always)]
pub fn incidence_of<L: Lanes>(l: L, outward_cosine: L::F) -> Incidence<L> {
    let one = l.constant(1.0);
    let cosine = one.min(outward_cosine.abs());
    Incidence { cosine, sine2: cosine.neg_mul_add(cosine, one) }
}

/// Computes the incidence from the squared sine, which rounding can push above 1.
#[inline(always)]
pub fn incidence_of_sine2<L: Lanes>(l: L, sine2: L::F) -> Incidence<L> {
    let sine2 = l.constant(1.0).min(sine2);
    Incidence { cosine: (l.constant(1.0) - sine2).sqrt(), sine2 }
}

/// Scatters at a mirror, metal or Lambertian surface, or at a dielectric if `GLASS` is set.
///
/// `front_face` is true where the ray comes from outside; `coin` is uniform in `[0, 1)`.
#[inline(always)]
pub fn scatter<L: Lanes, const GLASS: bool>(
    l: L,
    material: &Material<L>,
    laws: DielectricLaws,
    direction: V3<L::F>,
    normal: V3<L::F>,
    incidence: &Incidence<L>,
    front_face: L::M,
    unit: V3<L::F>,
    coin: L::F,
) -> Scattered<L> {
    let (zero, one) = (l.constant(0.0), l.constant(1.0));
    let &Incidence { cosine, sine2 } = incidence;
    let reflects = material.reflects();
    let mut along = reflects.select(one, zero);
    let mut across = reflects.select(cosine + cosine, one);
    let (mut refracts, mut is_metal, mut ratio) = (l.mask(0), reflects, one);
    let is_glass = material.is_glass(l);
    if GLASS && !is_idle::<L>(is_glass) {
        is_metal = reflects & !is_glass;
        ratio = front_face.select(material.inverse_index, material.refraction_index);
        // Squared sine of the refraction angle: above 1, Snell's law has no solution.
        let refracted_sine2 = ratio * ratio * sine2;
        refracts = is_glass;
        if laws != DielectricLaws::RefractOnly {
            refracts = refracts & !one.lt(refracted_sine2);
        }
        if laws == DielectricLaws::Schlick {
            refracts = refracts & !coin.lt(reflectance(l, cosine, material.f0));
        }
        let inner_cosine = (one - refracted_sine2).abs().sqrt();
        along = refracts.select(ratio, along);
        across = refracts.select(ratio.mul_add(cosine, -inner_cosine), across);
    }
    let smooth = direction.mul_add(along, normal.scale(across));
    Scattered { direction: unit.mul_add(material.weight.abs(), smooth), refracts, is_metal, ratio }
}

/// The refracted direction, not normalised, from the part of the incoming direction `across` the normal. This form
/// keeps its precision where the usual form subtracts large numbers.
#[inline(always)]
pub fn refracted<L: Lanes>(l: L, across: V3<L::F>, normal: V3<L::F>, ratio: L::F, sine2: L::F) -> V3<L::F> {
    let inner_cosine = (l.constant(1.0) - ratio * ratio * sine2).abs().sqrt();
    normal.neg_mul_add(inner_cosine, across.scale(ratio))
}

/// Schlick's approximation of the reflectance. (Section 11.4.)
#[inline(always)]
pub fn reflectance<L: Lanes>(l: L, cosine: L::F, f0: L::F) -> L::F {
    let one = l.constant(1.0);
    let x = one - cosine;
    let x2 = x * x;
    (one - f0).mul_add(x2 * x2 * x, f0)
}

/// A uniform direction on the side of `normal`, as in the first diffuse stage. (Section 9.1.)
#[inline(always)]
pub fn hemisphere<L: Lanes>(l: L, normal: V3<L::F>, unit: V3<L::F>) -> V3<L::F> {
    unit.scale(l.constant(1.0).copysign(unit.dot(normal)))
}
