//! What stages show in place of light, and the book's strips of reflectance.

use super::rows::{Rows, hit_points};
use super::{Packet, pixel_position};
use crate::film::FIXED_POINT_SCALE;
use crate::render_cpu::lanes::{Lanes, V3, select3};
use crate::render_cpu::wide::WideTables;
use crate::stages::Shading;
use crate::tables::Tables;

/// What a ray brings back where the stage shows something simpler than light: `light` where it misses.
#[inline(always)]
pub(super) fn shown_at_hit<L: Lanes, const NEEDS: u32>(
    l: L,
    wide: &WideTables<L::Real>,
    packet: &Packet<L>,
    miss: L::M,
    light: V3<L::F>,
) -> V3<L::F> {
    let tables = &wide.tables;
    let (zero, full) = (l.constant(0.0), l.constant(FIXED_POINT_SCALE));
    let shown = match tables.rules.shading {
        Shading::ImageGradient => {
            let position = pixel_position(l, l.load_u(&packet.blocks.pixel));
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
            let outward =
                hit_points::<L, NEEDS>(l, wide, packet, &Rows::of(l, tables, packet.nearest.sphere)).outward;
            let shade = |n: L::F| L::max(zero, L::mul_add(n, half, half));
            V3 { x: shade(outward.x), y: shade(outward.y), z: shade(outward.z) }
        }
    };
    select3::<L>(miss, light, shown)
}

/// The reflectance of the picture's strip that a pixel lies in: 10, 30, 50, 70, 90 %.
#[inline(always)]
pub(super) fn strip_reflectance<L: Lanes>(l: L, tables: &Tables<L::Real>, pixel: L::U) -> L::F {
    let [x, _] = pixel_position(l, pixel);
    let strips = l.constant(5.0 / f64::from(tables.settings.width));
    let strip = (x + l.constant(0.5)) * strips - l.constant(0.5);
    let strip = L::float_of(l.fixed_point(L::max(l.constant(0.0), strip)));
    L::mul_add(strip, l.constant(0.2), l.constant(0.1))
}
