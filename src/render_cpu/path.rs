//! The path loop: packets of rays that are always full.
//!
//! A lane owns a pixel and walks through a block of its samples. When its path ends it starts its next sample at
//! once, and when its block is done it is dealt the next (block, pixel) of the tile; so a packet never waits for
//! its longest path. A lane's sums stay in 32-bit registers until its block is done. Several packets take turns
//! in two phases, intersect and shade, so that the latency of one hides behind the others.
//!
//! Twin: shaders/path.wgsl

use super::bvh::{EMPTY_STACK, Stack, traverse};
use super::camera::{lens_rays, pinhole_rays, screen};
use super::lanes::{Lanes, MAX_LANES, V3, dot, mul_add3, select3, unit_float};
use super::material::{Surface, hemisphere, scatter};
use super::rng::{lens_stream_of, pcg4d, sobol_pair, stream_of};
use super::sphere::{
    NONE, Nearest, Rays, acne_root, anchored_root, anchored_surface_point, near_root, nearest_root,
    surface_point,
};
use super::work::{LaneState, TileStats, Work};
use crate::film::{FIXED_POINT_SCALE, RADIANCE_LIMIT};
use crate::render::SamplerKind;
use crate::stages::{Diffuse, Shading, Surface as SurfaceRule};
use crate::tables::{NEAR_ZERO, Real, Tables};

/// Code that a kernel may carry, as bits of its constant parameter.
pub mod needs {
    /// Spheres with both roots, and refraction.
    pub const GLASS: u32 = 1;
    /// A lens of some size.
    pub const LENS: u32 = 2;
    /// Anchored spheres.
    pub const ANCHORED: u32 = 4;
    /// The hierarchy.
    pub const HIERARCHY: u32 = 8;
    /// Stage rules.
    pub const RULES: u32 = 16;
    /// Everything.
    pub const ALL: u32 = 31;
}

/// Packets that take turns. In a prototype with 16 lanes, fewer left the processor waiting (2: -10 %, 1: -35 %) and
/// more gained nothing; not measured again here.
const PACKETS: usize = 4;

struct Packet<L: Lanes> {
    rays: Rays<L>,
    nearest: Nearest<L>,
    throughput: V3<L::F>,
    bounce: L::U,
    counter: L::U,
    step: L::U,
    remaining: L::U,
    key: L::U,
    pixel: L::U,
    screen: [L::F; 2],
    sums: [L::U; 3],
    /// Lanes that have work.
    alive: L::M,
    /// Lanes whose path was absorbed: it ends at its next shading, adds nothing and is not counted as a ray.
    absorbed: L::M,
    slots: [u32; MAX_LANES],
}

impl<L: Lanes> Packet<L> {
    /// All lanes at the end of a sample of nothing, so that the first shading deals them work.
    #[inline(always)]
    fn idle(l: L) -> Self {
        let zero = l.constant(0.0);
        let nowhere = V3 { x: zero, y: zero, z: zero };
        let none = l.splat_u(NONE);
        let nought = l.splat_u(0);
        Packet {
            rays: Rays { origin: nowhere, direction: nowhere, left: none, inside: none },
            nearest: Nearest::nothing(l),
            throughput: nowhere,
            bounce: nought,
            counter: nought,
            step: nought,
            remaining: l.splat_u(1),
            key: nought,
            pixel: nought,
            screen: [zero; 2],
            sums: [nought; 3],
            alive: l.mask(u32::MAX >> (32 - L::WIDTH)),
            absorbed: l.mask(0),
            slots: [0; MAX_LANES],
        }
    }
}

/// Traces all of `work` with the code that `NEEDS` names; the job must need no other.
#[inline(always)]
pub fn trace<L: Lanes, const NEEDS: u32>(l: L, tables: &Tables<L::Real>, work: &mut Work) -> TileStats {
    let mut packets: [Packet<L>; PACKETS] =
        [Packet::idle(l), Packet::idle(l), Packet::idle(l), Packet::idle(l)];
    let mut stats = TileStats::default();
    let mut stack = EMPTY_STACK;
    for packet in &mut packets {
        shade::<L, NEEDS>(l, tables, packet, work, &mut stats);
    }
    loop {
        let mut alive = 0;
        for packet in &mut packets {
            alive |= intersect::<L, NEEDS>(l, tables, packet, &mut stack, &mut stats);
        }
        if alive == 0 {
            return stats;
        }
        stats.offered_lanes += (PACKETS * L::WIDTH) as u64;
        for packet in &mut packets {
            shade::<L, NEEDS>(l, tables, packet, work, &mut stats);
        }
    }
}

/// A packet of one lane, for a record of what it does.
pub struct SinglePath<L: Lanes> {
    packet: Packet<L>,
    stack: Stack,
}

impl<L: Lanes> SinglePath<L> {
    /// Takes the first sample of `work`.
    #[inline(always)]
    pub fn start(l: L, tables: &Tables<L::Real>, work: &mut Work) -> Self {
        let mut packet = Packet::idle(l);
        shade::<L, { needs::ALL }>(l, tables, &mut packet, work, &mut TileStats::default());
        SinglePath { packet, stack: EMPTY_STACK }
    }

    /// Whether there is a ray to trace.
    pub fn is_alive(&self) -> bool {
        L::bits(self.packet.alive) != 0
    }

    /// Whether the path was absorbed where it is.
    pub fn is_absorbed(&self) -> bool {
        L::bits(self.packet.absorbed) != 0
    }

    /// Where the ray starts.
    pub fn origin(&self) -> V3<L::F> {
        self.packet.rays.origin
    }

    /// Where it goes.
    pub fn direction(&self) -> V3<L::F> {
        self.packet.rays.direction
    }

    /// What its light counts for.
    pub fn throughput(&self) -> V3<L::F> {
        self.packet.throughput
    }

    /// Traces the ray and sends it on. Returns the number of the sphere that it met and the distance.
    #[inline(always)]
    pub fn advance(&mut self, l: L, tables: &Tables<L::Real>, work: &mut Work) -> (u32, f64) {
        let mut stats = TileStats::default();
        intersect::<L, { needs::ALL }>(l, tables, &mut self.packet, &mut self.stack, &mut stats);
        let mut sphere = [0; MAX_LANES];
        let mut distance = [L::Real::default(); MAX_LANES];
        L::store_u(self.packet.nearest.sphere, &mut sphere);
        L::store(L::from_key(self.packet.nearest.key), &mut distance);
        shade::<L, { needs::ALL }>(l, tables, &mut self.packet, work, &mut stats);
        (sphere[0], distance[0].to_f64())
    }

    /// Ends an absorbed path.
    #[inline(always)]
    pub fn finish(&mut self, l: L, tables: &Tables<L::Real>, work: &mut Work) {
        if self.is_alive() {
            self.advance(l, tables, work);
        }
    }
}

/// Finds what the rays of a packet meet first. Returns the lanes that are alive.
#[inline(always)]
fn intersect<L: Lanes, const NEEDS: u32>(
    l: L,
    tables: &Tables<L::Real>,
    packet: &mut Packet<L>,
    stack: &mut Stack,
    stats: &mut TileStats,
) -> u32 {
    let alive = L::bits(packet.alive);
    if alive == 0 {
        return 0;
    }
    let active = packet.alive & !packet.absorbed;
    stats.rays += u64::from(L::bits(active).count_ones());
    let rays = &packet.rays;
    let mut nearest = Nearest::nothing(l);
    let one = l.splat_u(1);
    let mut number = l.splat_u(0);
    if NEEDS & needs::RULES != 0 && tables.rules.surface == SurfaceRule::Acne {
        for sphere in tables.opaque.iter().chain(&tables.two_root) {
            nearest.take(acne_root(l, rays, sphere), number);
            number = number + one;
        }
    } else {
        for sphere in &tables.opaque {
            nearest.take(near_root(l, rays, sphere, number), number);
            number = number + one;
        }
        match &tables.hierarchy {
            Some(hierarchy) if NEEDS & needs::HIERARCHY != 0 => {
                traverse(l, hierarchy, &tables.two_root, rays, active, stack, &mut nearest);
            }
            _ if NEEDS & needs::GLASS != 0 => {
                for sphere in &tables.two_root {
                    nearest.take(nearest_root(l, rays, sphere, number), number);
                    number = number + one;
                }
            }
            _ => {}
        }
        if NEEDS & needs::ANCHORED != 0 {
            let mut number = l.splat_u((tables.opaque.len() + tables.two_root.len()) as u32);
            for sphere in &tables.anchored {
                nearest.take(anchored_root(l, rays, sphere, number), number);
                number = number + one;
            }
        }
    }
    packet.nearest = nearest;
    alive
}

/// Which row of the table each lane looks up.
enum Rows<L: Lanes> {
    /// Few enough that a column fits a register.
    Permuted(L::U),
    /// By their number in memory.
    Gathered([u32; MAX_LANES]),
}

impl<L: Lanes> Rows<L> {
    #[inline(always)]
    fn of(_: L, tables: &Tables<L::Real>, numbers: L::U) -> Self {
        if tables.rows.len() <= L::PERMUTED_ROWS {
            return Rows::Permuted(numbers);
        }
        let mut stored = [0; MAX_LANES];
        L::store_u(numbers, &mut stored);
        Rows::Gathered(stored)
    }

    /// Columns `4 group ..`.
    #[inline(always)]
    fn columns(&self, l: L, tables: &Tables<L::Real>, group: usize) -> [L::F; 4] {
        match self {
            Rows::Permuted(numbers) => {
                let column = |offset: usize| l.permute(&tables.columns[4 * group + offset], *numbers);
                [column(0), column(1), column(2), column(3)]
            }
            Rows::Gathered(stored) => l.gather(&tables.rows, stored, group),
        }
    }
}

/// Ends paths or sends them on, and starts the next sample in lanes whose path has ended.
#[inline(always)]
fn shade<L: Lanes, const NEEDS: u32>(
    l: L,
    tables: &Tables<L::Real>,
    packet: &mut Packet<L>,
    work: &mut Work,
    stats: &mut TileStats,
) {
    let (zero, one) = (l.constant(0.0), l.constant(1.0));
    let with_rules = NEEDS & needs::RULES != 0;
    let rules = &tables.rules;
    let hit = packet.nearest.sphere;
    let miss = L::eq_u(hit, l.splat_u(NONE));
    let direction = packet.rays.direction;

    // What was hit, and where.
    let rows = Rows::of(l, tables, L::select_u(miss, l.splat_u(0), hit));
    let [cx, cy, cz, curvature] = rows.columns(l, tables, 0);
    let [red, green, blue, weight] = rows.columns(l, tables, 1);
    let [radius, index, inverse_index, normal_share] = rows.columns(l, tables, 2);
    let reference = V3 { x: cx, y: cy, z: cz };
    let t = L::from_key(packet.nearest.key);
    let mut point = surface_point(l, &packet.rays, t, reference, curvature, radius);
    if NEEDS & needs::ANCHORED != 0 && !tables.anchored.is_empty() {
        let [mx, my, mz, is_anchored] = rows.columns(l, tables, 3);
        let inward = V3 { x: mx, y: my, z: mz };
        let far = anchored_surface_point(l, &packet.rays, t, reference, inward, curvature);
        let is_anchored = L::lt(zero, is_anchored);
        point.position = select3::<L>(is_anchored, far.position, point.position);
        point.outward = select3::<L>(is_anchored, far.outward, point.outward);
    }
    let outward_cosine = dot::<L>(direction, point.outward);
    let mut front = L::lt(outward_cosine, zero);
    if with_rules && rules.surface == SurfaceRule::Acne {
        point.position = mul_add3::<L>(direction, t, packet.rays.origin);
    } else {
        front = front & !L::eq_u(packet.rays.inside, hit);
    }
    let outward = point.outward;
    let side = L::select(front, one, l.constant(-1.0));
    let normal = outward.scale(side);

    // Light that arrives.
    let is_last = L::eq_u(packet.bounce, l.splat_u(tables.settings.max_depth - 1));
    let mut ended = miss | is_last | packet.absorbed;
    let mut lit = miss & !packet.absorbed;
    let sky = |middle: L::Real, slope: L::Real| {
        L::max(zero, L::mul_add(l.splat(slope), direction.y, l.splat(middle)))
    };
    let mut light = V3 {
        x: sky(tables.sky_middle[0], tables.sky_slope[0]),
        y: sky(tables.sky_middle[1], tables.sky_slope[1]),
        z: sky(tables.sky_middle[2], tables.sky_slope[2]),
    };
    if with_rules && rules.shading != Shading::Path {
        let shown = shown_at_hit(l, tables, packet, outward, miss, light);
        light = shown;
        lit = packet.alive;
        ended = packet.alive;
    }
    let radiance = light.times(packet.throughput);
    let total = radiance.x + radiance.y + radiance.z;
    let is_valid = L::lt(total, l.constant(3.0 * RADIANCE_LIMIT * FIXED_POINT_SCALE));
    let counted = lit & packet.alive;
    let invalid = L::bits(counted & !is_valid);
    if invalid != 0 {
        stats.rejected += u64::from(invalid.count_ones());
    }
    let added = counted & is_valid;
    let nought = l.splat_u(0);
    let add = |sum: L::U, x: L::F| sum + L::select_u(added, L::fixed_point(x), nought);
    packet.sums =
        [add(packet.sums[0], radiance.x), add(packet.sums[1], radiance.y), add(packet.sums[2], radiance.z)];

    // The next sample's place in the sequence, for lanes whose path has ended.
    let counting = l.splat_u(1);
    packet.counter = L::select_u(ended, packet.counter + packet.step, packet.counter);
    packet.remaining = L::select_u(ended, packet.remaining - counting, packet.remaining);
    packet.bounce = L::select_u(ended, nought, packet.bounce + counting);
    let done = L::bits(ended & packet.alive & L::eq_u(packet.remaining, nought));
    if done != 0 {
        deal(l, tables, packet, work, done);
    }

    // One set of numbers serves the camera and the surface alike.
    let with_lens = NEEDS & needs::LENS != 0 && tables.camera.tau > L::Real::default();
    let (u0, u1, jitter) = draw::<L, NEEDS>(l, tables, packet, with_lens);
    let (sine, cosine) = l.sin_cos_turns(u1);
    let rho = L::sqrt(u0 * (one - u0));
    let rho = rho + rho;
    let unit = V3 { x: rho * cosine, y: rho * sine, z: one - (u0 + u0) };

    let jitter = if tables.rules.antialiasing { jitter } else { [l.constant(0.5); 2] };
    let camera = if with_lens {
        let lens_radius = L::sqrt(u0);
        let on_lens = [lens_radius * cosine, lens_radius * sine];
        lens_rays(l, &tables.camera, packet.screen, jitter, on_lens)
    } else {
        pinhole_rays(l, &tables.camera, packet.screen, jitter)
    };

    let incidence = L::max(zero, L::min(one, -(outward_cosine * side)));
    let surface = Surface { weight, index, inverse_index, normal_share };
    let mut bounced = if NEEDS & needs::GLASS != 0 {
        scatter::<L, true>(l, &surface, rules.dielectric, direction, normal, incidence, front, unit, u0)
    } else {
        scatter::<L, false>(l, &surface, rules.dielectric, direction, normal, incidence, front, unit, u0)
    };
    let mut albedo = V3 { x: red, y: green, z: blue };
    if with_rules {
        if rules.diffuse == Diffuse::Hemisphere {
            let is_lambertian = L::lt(zero, weight);
            bounced.direction = select3::<L>(is_lambertian, hemisphere(l, normal, unit), bounced.direction);
        }
        if rules.reflectance_strips {
            let reflectance = strip_reflectance(l, tables, packet.pixel);
            albedo = V3 { x: reflectance, y: reflectance, z: reflectance };
        }
    }
    let next = select3::<L>(ended, camera.direction, bounced.direction);
    let length2 = dot::<L>(next, next);
    let vanishes = L::lt(length2, l.constant(NEAR_ZERO));
    let next = select3::<L>(vanishes, normal, next);
    let next = next.scale(L::select(vanishes, one, one / L::sqrt(length2)));
    // A fuzzy reflection into the surface is absorbed.
    let absorbed = bounced.is_metal & !L::lt(zero, dot::<L>(next, normal)) & !ended;
    let inward = (front & bounced.refracts) | !(front | bounced.refracts);
    let none = l.splat_u(NONE);
    let throughput = packet.throughput.times(albedo);
    packet.rays = Rays {
        origin: select3::<L>(ended, camera.origin, point.position),
        direction: next,
        left: L::select_u(ended | inward, none, hit),
        inside: L::select_u(inward & !ended, hit, none),
    };
    packet.throughput = V3 {
        x: L::select(ended, one, throughput.x),
        y: L::select(ended, one, throughput.y),
        z: L::select(ended, one, throughput.z),
    };
    packet.absorbed = absorbed;
}

/// What a ray brings back where the stage shows something simpler than light: `light` where it misses.
#[inline(always)]
fn shown_at_hit<L: Lanes>(
    l: L,
    tables: &Tables<L::Real>,
    packet: &Packet<L>,
    outward: V3<L::F>,
    miss: L::M,
    light: V3<L::F>,
) -> V3<L::F> {
    let (zero, full) = (l.constant(0.0), l.constant(FIXED_POINT_SCALE));
    let shown = match tables.rules.shading {
        Shading::ImageGradient => {
            let position = pixel_position(l, packet.pixel);
            // A single column or row has no far end: it is 0 everywhere.
            let share = |position: L::F, pixels: u32| {
                position / l.constant(f64::from(pixels.saturating_sub(1).max(1))) * full
            };
            let settings = &tables.settings;
            return V3 {
                x: share(position[0], settings.width),
                y: share(position[1], settings.height),
                z: zero,
            };
        }
        Shading::FirstHitRed => V3 { x: full, y: zero, z: zero },
        Shading::Normals | Shading::Path => {
            let half = l.constant(0.5 * FIXED_POINT_SCALE);
            let shade = |n: L::F| L::max(zero, L::mul_add(n, half, half));
            V3 { x: shade(outward.x), y: shade(outward.y), z: shade(outward.z) }
        }
    };
    select3::<L>(miss, light, shown)
}

/// The reflectance of the picture's strip that a pixel lies in: 10, 30, 50, 70, 90 %.
#[inline(always)]
fn strip_reflectance<L: Lanes>(l: L, tables: &Tables<L::Real>, pixel: L::U) -> L::F {
    let [x, _] = pixel_position(l, pixel);
    let strips = l.constant(5.0 / f64::from(tables.settings.width));
    let strip = (x + l.constant(0.5)) * strips - l.constant(0.5);
    let strip = L::float_of(L::fixed_point(L::max(l.constant(0.0), strip)));
    L::mul_add(strip, l.constant(0.2), l.constant(0.1))
}

/// Column and row from `x | y << 16`.
#[inline(always)]
fn pixel_position<L: Lanes>(l: L, pixel: L::U) -> [L::F; 2] {
    [L::float_of(pixel & l.splat_u(0xFFFF)), L::float_of(L::shr(pixel, 16))]
}

/// The numbers for the next ray: two for a direction or a lens point, and a point in the pixel.
#[inline(always)]
fn draw<L: Lanes, const NEEDS: u32>(
    l: L,
    tables: &Tables<L::Real>,
    packet: &Packet<L>,
    with_lens: bool,
) -> (L::F, L::F, [L::F; 2]) {
    let (first, second) = match tables.settings.sampler {
        SamplerKind::Independent => {
            let seed = l.splat_u(tables.settings.seed);
            let [a, b, c, d] = pcg4d(l, [packet.pixel, packet.counter, packet.bounce, seed]);
            ([a, b], [c, d])
        }
        SamplerKind::Sobol => {
            let first = sobol_pair(l, packet.counter, stream_of(l, packet.key, packet.bounce));
            let second = if with_lens {
                sobol_pair(l, packet.counter, lens_stream_of(l, packet.key, packet.bounce))
            } else {
                first
            };
            (first, second)
        }
    };
    let unit = |u: [L::U; 2]| [unit_float(l, u[0]), unit_float(l, u[1])];
    let [u0, u1] = unit(first);
    let jitter = if with_lens { unit(second) } else { [u0, u1] };
    (u0, u1, jitter)
}

/// Deals the lanes `done` their next blocks of samples.
#[inline(always)]
fn deal<L: Lanes>(l: L, tables: &Tables<L::Real>, packet: &mut Packet<L>, work: &mut Work, done: u32) {
    let mut state = LaneState::default();
    L::store_u(packet.counter, &mut state.counter);
    L::store_u(packet.step, &mut state.step);
    L::store_u(packet.remaining, &mut state.remaining);
    L::store_u(packet.key, &mut state.key);
    L::store_u(packet.pixel, &mut state.pixel);
    for (sum, to) in packet.sums.iter().zip(&mut state.sums) {
        L::store_u(*sum, to);
    }
    let retired = work.deal(done, &mut state, &mut packet.slots);
    packet.counter = l.load_u(&state.counter);
    packet.step = l.load_u(&state.step);
    packet.remaining = l.load_u(&state.remaining);
    packet.key = l.load_u(&state.key);
    packet.pixel = l.load_u(&state.pixel);
    packet.sums = [l.load_u(&state.sums[0]), l.load_u(&state.sums[1]), l.load_u(&state.sums[2])];
    packet.alive = packet.alive & !l.mask(retired);
    let [x, y] = pixel_position(l, packet.pixel);
    packet.screen = screen(l, &tables.camera, x, y);
}
