//! The table's rows of what was hit: positions, normals, materials.

use super::{Packet, needs};
use crate::render_cpu::lanes::{Lanes, V3, WideU, select3};
use crate::render_cpu::sphere::{
    NONE, SurfacePoint, anchored_surface_point, book_point, speck_surface_point, surface_point,
};
use crate::render_cpu::wide::WideTables;
use crate::stages::Surface;
use crate::tables::Tables;

/// Which row of the table each lane looks up.
pub(super) enum Rows<L: Lanes> {
    /// Few enough that a column fits a register.
    Permuted(L::U),
    /// By their number in memory.
    Gathered(WideU),
}

impl<L: Lanes> Rows<L> {
    /// A lane without a `hit` gets some row.
    #[inline(always)]
    pub fn of(l: L, tables: &Tables<L::Real>, hit: L::U) -> Self {
        if tables.rows.len() <= L::PERMUTED_ROWS {
            return Rows::Permuted(hit);
        }
        let mut stored = WideU::default();
        L::store_u(l.keep(!L::eq_u(hit, l.splat_u(NONE)), hit), &mut stored);
        Rows::Gathered(stored)
    }

    /// Columns `4 group ..`.
    #[inline(always)]
    pub fn columns(&self, l: L, wide: &WideTables<L::Real>, group: usize) -> [L::F; 4] {
        match self {
            Rows::Permuted(numbers) => {
                let column = |offset: usize| l.permute(&wide.columns[4 * group + offset], *numbers);
                [column(0), column(1), column(2), column(3)]
            }
            Rows::Gathered(stored) => l.gather(&wide.tables.rows, stored, group),
        }
    }
}

/// Whether what was hit holds every ray, so that it is met from inside whatever rounding says.
#[inline(always)]
pub(super) fn is_cavity<L: Lanes>(l: L, wide: &WideTables<L::Real>, rows: &Rows<L>) -> L::M {
    let [.., is_anchored] = rows.columns(l, wide, 3);
    L::lt(l.constant(1.0), is_anchored)
}

/// The points that were hit, where anything was.
#[inline(always)]
pub(super) fn hit_points<L: Lanes, const NEEDS: u32>(
    l: L,
    wide: &WideTables<L::Real>,
    packet: &Packet<L>,
    rows: &Rows<L>,
) -> SurfacePoint<L> {
    let [cx, cy, cz, curvature] = rows.columns(l, wide, 0);
    let [radius, ..] = rows.columns(l, wide, 2);
    let reference = V3 { x: cx, y: cy, z: cz };
    let t = packet.nearest.distance();
    if NEEDS & needs::RULES != 0 && wide.tables.rules.surface != Surface::Exact {
        return book_point(&packet.rays, t, reference, curvature);
    }
    if NEEDS & needs::EXTREMES == 0 || !wide.is_extreme {
        return surface_point(l, &packet.rays, t, reference, curvature, radius);
    }
    let mut point = if wide.tables.has_specks {
        speck_surface_point(l, &packet.rays, t, reference, curvature, radius)
    } else {
        surface_point(l, &packet.rays, t, reference, curvature, radius)
    };
    if !wide.tables.anchored.is_empty() {
        let [mx, my, mz, is_anchored] = rows.columns(l, wide, 3);
        let inward = V3 { x: mx, y: my, z: mz };
        let far = anchored_surface_point(l, &packet.rays, t, reference, inward, curvature);
        let is_anchored = L::lt(l.constant(0.0), is_anchored);
        point.position = select3::<L>(is_anchored, far.position, point.position);
        point.outward = select3::<L>(is_anchored, far.outward, point.outward);
    }
    point
}
