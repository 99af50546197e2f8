//! The path loop: packets of rays that are always full.
//!
//! A lane owns a pixel and walks through a block of its samples. When its path ends it starts its next sample at
//! once, and when its block is done it is dealt the next (block, pixel) of the tile; so a packet never waits for
//! its longest path. A lane's sums stay in 32-bit registers until its block is done. Several packets take turns
//! in three phases, intersect, collect and send on, so that the latency of one hides behind the others.
//!
//! Twin: shaders/path.wgsl

mod draw;
mod rows;
mod simpler;
mod single;

pub use single::SinglePath;

use super::bvh::{EMPTY_STACK, Stack, traverse};
use super::camera::{lens_rays, pinhole_rays, screen};
use super::lanes::{Lanes, V3, dot, mul_add3, select3};
use super::material::{Incidence, Scatter, Surface, hemisphere, refracted, scatter};
use super::sphere::{EYE, NONE, Nearest, Rays, Spheres, anchored_root, book_root, near_root, nearest_root};
use super::wide::WideTables;
use super::work::{LaneBlocks, TileStats, Work};
use crate::film::{FIXED_POINT_SCALE, RADIANCE_LIMIT};
use crate::stages::{Diffuse, Shading, Surface as SurfaceRule};
use crate::tables::{NEAR_ZERO, Tables};
use draw::{Draw, draw, has_lens, strides};
use rows::{Rows, hit_points, is_cavity};
use simpler::{shown_at_hit, strip_reflectance};

/// Code that a kernel may carry, as bits of its constant parameter.
pub mod needs {
    /// Spheres with both roots, and refraction.
    pub const GLASS: u32 = 1;
    /// A lens of some size.
    pub const LENS: u32 = 2;
    /// What few scenes need: anchored spheres, specks, steep glass.
    pub const EXTREMES: u32 = 4;
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
    /// Squared sine between a ray inside steep glass and the normal where it starts, and so where it ends.
    sine2: L::F,
    /// The sampler's counter: which sample.
    counter: L::U,
    /// The sampler's stream: which ray of it.
    stream: L::U,
    screen: [L::F; 2],
    /// Lanes that have work.
    alive: L::M,
    /// Lanes whose path was absorbed: it ends at its next shading, adds nothing and is not counted as a ray.
    absorbed: L::M,
    /// Lanes whose path ends where it is; they go on from the camera.
    ended: L::M,
    draw: Draw<L>,
    blocks: LaneBlocks,
}

impl<L: Lanes> Packet<L> {
    /// All lanes at the end of a block of nothing, so that the first shading deals them work.
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
            sine2: zero,
            counter: nought,
            stream: nought,
            screen: [zero; 2],
            alive: l.mask(u32::MAX >> (32 - L::WIDTH)),
            absorbed: l.mask(0),
            ended: l.mask(0),
            draw: Draw { pair: [zero; 2], sine: zero, cosine: zero, jitter: [zero; 2] },
            blocks: LaneBlocks::default(),
        }
    }
}

/// Traces all of `work` with the code that `NEEDS` names; the job must need no other.
#[inline(always)]
pub fn trace<L: Lanes, const NEEDS: u32>(l: L, wide: &WideTables<L::Real>, work: &mut Work) -> TileStats {
    let mut packets: [Packet<L>; PACKETS] =
        [Packet::idle(l), Packet::idle(l), Packet::idle(l), Packet::idle(l)];
    let mut stats = TileStats::default();
    let mut stack = EMPTY_STACK;
    shade::<L, NEEDS>(l, wide, &mut packets, work, &mut stats);
    loop {
        let mut alive = 0;
        for packet in &mut packets {
            alive |= intersect::<L, NEEDS>(l, wide, packet, &mut stack, &mut stats);
        }
        if alive == 0 {
            return stats;
        }
        stats.offered_lanes += (PACKETS * L::WIDTH) as u64;
        shade::<L, NEEDS>(l, wide, &mut packets, work, &mut stats);
    }
}

/// Ends the paths of packets or sends them on.
#[inline(always)]
fn shade<L: Lanes, const NEEDS: u32>(
    l: L,
    wide: &WideTables<L::Real>,
    packets: &mut [Packet<L>],
    work: &mut Work,
    stats: &mut TileStats,
) {
    for packet in &mut *packets {
        collect::<L, NEEDS>(l, wide, packet, work, stats);
    }
    for packet in packets {
        send_on::<L, NEEDS>(l, wide, packet);
    }
}

/// Finds what the rays of a packet meet first. Returns the lanes that are alive.
#[inline(always)]
fn intersect<L: Lanes, const NEEDS: u32>(
    l: L,
    wide: &WideTables<L::Real>,
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
    let (rays, tables) = (&packet.rays, &wide.tables);
    let mut nearest = Nearest::nothing(l);
    let book_t_min = if NEEDS & needs::RULES != 0 { tables.rules.surface.smallest_distance() } else { None };
    if let Some(t_min) = book_t_min {
        let t_min = l.constant(t_min);
        for sphere in wide.opaque.iter().chain(&wide.two_root) {
            let sphere = Spheres::load(l, sphere);
            nearest.take(book_root(l, rays, &sphere, t_min), sphere.number);
        }
    } else {
        for sphere in &wide.opaque {
            let sphere = Spheres::load(l, sphere);
            nearest.take(near_root(l, rays, &sphere), sphere.number);
        }
        match &tables.hierarchy {
            Some(hierarchy) if NEEDS & needs::HIERARCHY != 0 => {
                traverse(l, hierarchy, &tables.two_root, rays, active, stack, &mut nearest);
            }
            _ if NEEDS & needs::GLASS != 0 => {
                for sphere in &wide.two_root {
                    let sphere = Spheres::load(l, sphere);
                    nearest.take(nearest_root(l, rays, &sphere), sphere.number);
                }
            }
            _ => {}
        }
        if NEEDS & needs::EXTREMES != 0 {
            let one = l.splat_u(1);
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

/// Adds the light that arrives, ends paths, starts the next sample where one has ended, and draws the numbers of
/// the next rays.
#[inline(always)]
fn collect<L: Lanes, const NEEDS: u32>(
    l: L,
    wide: &WideTables<L::Real>,
    packet: &mut Packet<L>,
    work: &mut Work,
    stats: &mut TileStats,
) {
    let (zero, tables) = (l.constant(0.0), &wide.tables);
    let miss = L::eq_u(packet.nearest.sphere, l.splat_u(NONE));
    let (stride, last) = strides(tables);
    let is_last = L::eq_u(packet.stream, l.load_u(&packet.blocks.key) + l.splat_u(last));
    let mut ended = miss | is_last | packet.absorbed;
    let mut lit = miss & !packet.absorbed;
    let height = packet.rays.direction.y;
    let sky = |channel: usize| {
        let (middle, slope) = (l.load(&wide.sky_middle[channel]), l.load(&wide.sky_slope[channel]));
        L::max(zero, L::mul_add(slope, height, middle))
    };
    let mut light = V3 { x: sky(0), y: sky(1), z: sky(2) };
    if NEEDS & needs::RULES != 0 && tables.rules.shading != Shading::Path {
        light = shown_at_hit::<L, NEEDS>(l, wide, packet, miss, light);
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
    let mut add = |channel: usize, x: L::F| {
        let sum = &mut packet.blocks.sums[channel];
        L::store_u(l.load_u(sum) + l.keep(added, l.fixed_point(x)), sum);
    };
    add(0, radiance.x);
    add(1, radiance.y);
    add(2, radiance.z);

    // Lanes whose path has ended go on to the next sample, or to the next block.
    let next = packet.counter + l.load_u(&packet.blocks.step);
    packet.counter = L::select_u(ended, next, packet.counter);
    let at_end = L::eq_u(packet.counter, l.load_u(&packet.blocks.end));
    let done = L::bits(ended & packet.alive & at_end);
    if done != 0 {
        deal(l, wide, packet, work, done);
    }
    packet.stream = L::select_u(ended, l.load_u(&packet.blocks.key), packet.stream + l.splat_u(stride));
    packet.ended = ended;
    packet.draw = draw::<L, NEEDS>(l, tables, packet);
}

/// Sends paths on, or the next ones from the camera where they have ended.
#[inline(always)]
fn send_on<L: Lanes, const NEEDS: u32>(l: L, wide: &WideTables<L::Real>, packet: &mut Packet<L>) {
    let (zero, one) = (l.constant(0.0), l.constant(1.0));
    let with_rules = NEEDS & needs::RULES != 0;
    let (tables, rules) = (&wide.tables, &wide.tables.rules);
    let (hit, ended) = (packet.nearest.sphere, packet.ended);
    let direction = packet.rays.direction;

    // What was hit, where, and from which side.
    let rows = Rows::of(l, tables, hit);
    let [red, green, blue, weight] = rows.columns(l, wide, 1);
    let [_, index, inverse_index, normal_share] = rows.columns(l, wide, 2);
    let point = hit_points::<L, NEEDS>(l, wide, packet, &rows);
    let outward_cosine = dot::<L>(direction, point.outward);
    let mut front = L::lt(outward_cosine, zero);
    if !with_rules || rules.surface == SurfaceRule::Exact {
        front = front & !L::eq_u(packet.rays.inside, hit);
    }
    if NEEDS & needs::EXTREMES != 0 && wide.is_eye_in_cavity {
        front = front & !is_cavity(l, wide, &rows);
    }
    let normal = point.outward.scale(L::select(front, one, l.constant(-1.0)));

    // One set of numbers serves the camera and the surface alike.
    let [u0, u1] = packet.draw.pair;
    let (sine, cosine) = (packet.draw.sine, packet.draw.cosine);
    let rho = L::sqrt(u0 * (one - u0));
    let rho = rho + rho;
    let unit = V3 { x: rho * cosine, y: one - (u0 + u0), z: rho * sine };
    let with_lens = has_lens::<L, NEEDS>(tables);
    let jitter = match (tables.rules.antialiasing, with_lens) {
        (false, _) => [l.constant(0.5); 2],
        (true, false) => [u0, u1],
        (true, true) => packet.draw.jitter,
    };
    let camera = if with_lens {
        let lens_radius = L::sqrt(u0);
        let on_lens = [lens_radius * cosine, lens_radius * sine];
        lens_rays(l, &wide.camera, packet.screen, jitter, on_lens)
    } else {
        pinhole_rays(l, &wide.camera, packet.screen, jitter)
    };

    let incidence = Incidence::of(l, outward_cosine);
    let surface = Surface { weight, index, inverse_index, normal_share };
    let mut bounced = if NEEDS & needs::GLASS == 0 {
        scatter::<L, false>(l, &surface, rules.dielectric, direction, normal, &incidence, front, unit, u0)
    } else if NEEDS & needs::EXTREMES != 0 && tables.has_steep_glass {
        scatter_steeply(l, tables, packet, &surface, normal, &incidence, front, unit)
    } else {
        scatter::<L, true>(l, &surface, rules.dielectric, direction, normal, &incidence, front, unit, u0)
    };
    let mut albedo = V3 { x: red, y: green, z: blue };
    if with_rules {
        if rules.diffuse == Diffuse::Hemisphere {
            let is_lambertian = L::lt(zero, weight);
            bounced.direction = select3::<L>(is_lambertian, hemisphere(l, normal, unit), bounced.direction);
        }
        if rules.reflectance_strips {
            let reflectance = strip_reflectance(l, tables, l.load_u(&packet.blocks.pixel));
            albedo = V3 { x: reflectance, y: reflectance, z: reflectance };
        }
    }
    let next = select3::<L>(ended, camera.direction, bounced.direction);
    let length2 = dot::<L>(next, next);
    let vanishes = L::lt(length2, l.constant(NEAR_ZERO));
    let next = select3::<L>(vanishes, normal, next);
    let next = next.scale(one / L::sqrt(L::select(vanishes, one, length2)));
    // A fuzzy reflection into the surface is absorbed.
    packet.absorbed = bounced.is_metal & !L::lt(zero, dot::<L>(next, normal)) & !ended;
    let inward = (front & bounced.refracts) | !(front | bounced.refracts);
    let mut left = l.fill(ended | inward, hit);
    if NEEDS & needs::EXTREMES != 0 && wide.is_eye_on_surface {
        left = L::select_u(ended, l.splat_u(EYE), left);
    }
    packet.rays = Rays {
        origin: select3::<L>(ended, camera.origin, point.position),
        direction: next,
        left,
        inside: l.fill(ended | !inward, hit),
    };
    let throughput = packet.throughput.times(albedo);
    packet.throughput = select3::<L>(ended, V3 { x: one, y: one, z: one }, throughput);
}

/// Scatters where the angle of incidence must be known better than from its cosine. A ray inside glass meets it under
/// the angle under which it started: that is remembered, so that total reflection lasts.
#[inline(always)]
fn scatter_steeply<L: Lanes>(
    l: L,
    tables: &Tables<L::Real>,
    packet: &mut Packet<L>,
    surface: &Surface<L>,
    normal: V3<L::F>,
    incidence: &Incidence<L>,
    front: L::M,
    unit: V3<L::F>,
) -> Scatter<L> {
    let direction = packet.rays.direction;
    let across = mul_add3::<L>(normal, incidence.cosine, direction);
    let runs_own_chord = L::eq_u(packet.rays.inside, packet.nearest.sphere);
    let is_known = runs_own_chord & L::lt(l.constant(0.0), surface.index);
    let incidence = Incidence::of_sine2(l, L::select(is_known, packet.sine2, dot::<L>(across, across)));
    let coin = packet.draw.pair[0];
    let laws = tables.rules.dielectric;
    let mut bounced = scatter::<L, true>(l, surface, laws, direction, normal, &incidence, front, unit, coin);
    let through = refracted(l, across, normal, bounced.ratio, incidence.sine2);
    bounced.direction = select3::<L>(bounced.refracts, through, bounced.direction);
    let refracted_sine2 = bounced.ratio * bounced.ratio * incidence.sine2;
    packet.sine2 = L::select(bounced.refracts, refracted_sine2, incidence.sine2);
    bounced
}

/// Column and row from `x | y << 16`.
#[inline(always)]
fn pixel_position<L: Lanes>(l: L, pixel: L::U) -> [L::F; 2] {
    [L::float_of(pixel & l.splat_u(0xFFFF)), L::float_of(L::shr(pixel, 16))]
}

/// Deals the lanes `done` their next blocks of samples.
#[inline(always)]
fn deal<L: Lanes>(l: L, wide: &WideTables<L::Real>, packet: &mut Packet<L>, work: &mut Work, done: u32) {
    let retired = work.deal(done, &mut packet.blocks);
    packet.counter = L::select_u(l.mask(done), l.load_u(&packet.blocks.start), packet.counter);
    packet.alive = packet.alive & !l.mask(retired);
    let [x, y] = pixel_position(l, l.load_u(&packet.blocks.pixel));
    packet.screen = screen(l, &wide.camera, x, y);
}
