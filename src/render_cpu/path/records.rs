//! The shading records of the spheres that were hit.

use super::context::Context;
use super::packet::{Packet, is_small};
use crate::kernel::{ANCHORED_GROUP, Columns, GROUP, LoadShading, NONE, RECORD_COLUMNS};
use crate::render_cpu::lanes::{Float, Lanes, Unsigned, V3, rows_of};

/// Column groups of a record.
const GROUPS: usize = RECORD_COLUMNS / GROUP;

/// The [`crate::kernel::ShadingRecord`] of the sphere that each lane has hit. Fields are loaded by name: [`LoadShading`].
pub(super) struct ShadingRecords<L: Lanes> {
    groups: [[L::F; GROUP]; GROUPS],
}

impl<L: Lanes> ShadingRecords<L> {
    /// Loads the records. A lane without a hit gets an arbitrary record.
    #[inline(always)]
    pub fn load<const PARTS: u32>(context: Context<L, PARTS>, packet: &Packet<L>) -> Self {
        let (Context { l, broadcast }, hit) = (context, packet.nearest.sphere);
        let with_anchored = context.features().anchored();
        let is_needed = |group: usize| group != ANCHORED_GROUP || with_anchored;
        let mut groups = [[l.constant(0.0); GROUP]; GROUPS];
        if is_permuted(context) {
            for (group, loaded) in groups.iter_mut().enumerate() {
                if is_needed(group) {
                    for (column, number) in loaded.iter_mut().enumerate() {
                        *number = l.permute(&broadcast.columns[GROUP * group + column], hit);
                    }
                }
            }
        } else {
            let rows = rows_of::<L>(&broadcast.prepared.records, l.keep(!hit.eq(l.splat_u(NONE)), hit));
            // Not a loop, because the compiler would not unroll it.
            if is_needed(0) {
                groups[0] = l.gather(&rows, 0);
            }
            if is_needed(1) {
                groups[1] = l.gather(&rows, 1);
            }
            if is_needed(2) {
                groups[2] = l.gather(&rows, 2);
            }
            if is_needed(3) {
                groups[3] = l.gather(&rows, 3);
            }
        }
        ShadingRecords { groups }
    }

    /// Lanes whose sphere is anchored.
    #[inline(always)]
    pub fn is_anchored(&self, l: L) -> L::M {
        l.constant(0.0).lt(self.anchoring())
    }

    /// Lanes whose sphere encloses every ray.
    #[inline(always)]
    pub fn is_cavity(&self, l: L) -> L::M {
        l.constant(1.0).lt(self.anchoring())
    }
}

/// Whether the records are so few that a column fits a register. An instruction then loads a field of all lanes, and
/// reloading it costs less than keeping it.
#[inline(always)]
pub(super) fn is_permuted<L: Lanes, const PARTS: u32>(context: Context<L, PARTS>) -> bool {
    // With one lane there are no such columns. The general kernel asks anyway: compiled without the question, it takes
    // 1.07 times as long on the book.
    !is_small::<L, PARTS>() && context.broadcast.prepared.records.len() <= L::PERMUTED_ROWS
}

impl<L: Lanes> Columns<L::Real> for ShadingRecords<L> {
    type Number = L::F;
    type Vector = V3<L::F>;

    #[inline(always)]
    fn number(&self, column: usize) -> L::F {
        self.groups[column / GROUP][column % GROUP]
    }

    #[inline(always)]
    fn vector(&self, column: usize) -> V3<L::F> {
        V3 { x: self.number(column), y: self.number(column + 1), z: self.number(column + 2) }
    }
}
