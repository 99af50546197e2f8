//! A job's tables as packets read them: what every lane needs, spread out in memory, so that an instruction takes it
//! from there.

use super::lanes::{MAX_LANES, Wide};
use super::sphere::WideSphere;
use crate::kernel::{CameraTable, ROW_COLUMNS, Real};
use crate::tables::Tables;

/// Tables, and the parts of them that are read in every step.
#[derive(Clone, Debug)]
pub struct WideTables<R> {
    /// All of them.
    pub tables: Tables<R>,
    /// `tables.opaque`.
    pub opaque: Vec<WideSphere<R>>,
    /// `tables.two_root`, unless there is a hierarchy over them.
    pub two_root: Vec<WideSphere<R>>,
    /// `tables.camera`.
    pub camera: CameraTable<Wide<R>>,
    /// `tables.sky_middle`.
    pub sky_middle: [Wide<R>; 3],
    /// `tables.sky_slope`.
    pub sky_slope: [Wide<R>; 3],
    /// The first of `tables.rows` by column, for kernels that hold a column in a register.
    pub columns: Box<[Wide<R>; ROW_COLUMNS]>,
}

impl<R: Real> WideTables<R> {
    /// Spreads what is to be spread.
    pub fn new(tables: Tables<R>) -> Self {
        let numbered = |spheres: &[[R; 4]], first: usize| {
            let wide = |(index, sphere): (usize, &[R; 4])| WideSphere::new(*sphere, (first + index) as u32);
            spheres.iter().enumerate().map(wide).collect()
        };
        let listed = if tables.hierarchy.is_some() { &[][..] } else { &tables.two_root };
        let mut columns = Box::new([Wide::default(); ROW_COLUMNS]);
        for (index, row) in tables.rows.iter().take(MAX_LANES).enumerate() {
            for (column, number) in columns.iter_mut().zip(row.0) {
                column.0[index] = number;
            }
        }
        WideTables {
            opaque: numbered(&tables.opaque, 0),
            two_root: numbered(listed, tables.opaque.len()),
            camera: tables.camera.map(Wide::splat),
            sky_middle: tables.sky_middle.map(Wide::splat),
            sky_slope: tables.sky_slope.map(Wide::splat),
            columns,
            tables,
        }
    }
}
