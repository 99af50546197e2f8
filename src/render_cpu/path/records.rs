//! The shading records of the spheres that were hit.

use super::{Packet, is_small};
use crate::kernel::{ANCHORED_GROUP, Columns, GROUP, NONE, RECORD_COLUMNS, parts};
use crate::prepared::PreparedScene;
use crate::render_cpu::broadcast::BroadcastScene;
use crate::render_cpu::lanes::{Lanes, Unsigned, V3, rows_of};

/// Column groups of a record.
const GROUPS: usize = RECORD_COLUMNS / GROUP;

/// The record of the sphere that each lane has hit. Fields are loaded by name: [`crate::kernel::LoadShading`].
pub(super) struct HitRecords<L: Lanes> {
    groups: [[L::F; GROUP]; GROUPS],
}

impl<L: Lanes> HitRecords<L> {
    /// Loads the records. A lane without a hit gets an arbitrary record.
    #[inline(always)]
    pub fn load<const PARTS: u32>(l: L, broadcast: &BroadcastScene<L::Real>, packet: &Packet<L>) -> Self {
        let (prepared, hit) = (&broadcast.prepared, packet.nearest.sphere);
        let with_anchored = PARTS & parts::EXTREMES != 0 && prepared.features.anchored;
        let is_needed = |group: usize| group != ANCHORED_GROUP || with_anchored;
        let mut groups = [[l.constant(0.0); GROUP]; GROUPS];
        if is_permuted::<L, PARTS>(prepared) {
            for (group, loaded) in groups.iter_mut().enumerate() {
                if is_needed(group) {
                    for (column, number) in loaded.iter_mut().enumerate() {
                        *number = l.permute(&broadcast.columns[GROUP * group + column], hit);
                    }
                }
            }
        } else {
            let rows = rows_of::<L>(&prepared.records, l.keep(!hit.eq(l.splat_u(NONE)), hit));
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
        HitRecords { groups }
    }
}

/// Whether the records are so few that a column fits a register. An instruction then loads a field of all lanes, and to
/// load it again costs less than to keep it.
#[inline(always)]
pub(super) fn is_permuted<L: Lanes, const PARTS: u32>(prepared: &PreparedScene<L::Real>) -> bool {
    // With one lane there are no such columns. The general kernel asks all the same: compiled without the question, it
    // takes 1.07 times as long on the book.
    !is_small::<L, PARTS>() && prepared.records.len() <= L::PERMUTED_ROWS
}

impl<L: Lanes> Columns<L::Real> for HitRecords<L> {
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
