//! The stages in the book's order. Section numbers and scene values follow v4.0.2.

mod camera;
mod diffuse;
mod materials;
mod rays;
mod setups;

use super::Stage;

/// All stages by file.
const FILES: [&[Stage]; 4] = [rays::STAGES, diffuse::STAGES, materials::STAGES, camera::STAGES];

pub(super) const STAGES: &[Stage] = &chained::<{ count() }>();

const fn count() -> usize {
    let (mut count, mut file) = (0, 0);
    while file < FILES.len() {
        count += FILES[file].len();
        file += 1;
    }
    count
}

const fn chained<const COUNT: usize>() -> [Stage; COUNT] {
    let mut stages = [FILES[0][0]; COUNT];
    let (mut next, mut file) = (0, 0);
    while file < FILES.len() {
        let mut index = 0;
        while index < FILES[file].len() {
            stages[next] = FILES[file][index];
            next += 1;
            index += 1;
        }
        file += 1;
    }
    stages
}
