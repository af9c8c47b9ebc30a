//! Points that are found by where they lie.

use glamx::DVec3;
use rustc_hash::FxHashMap;

use crate::places::AROUND;

/// Numbered points by the cells of a lattice they lie in.
pub(crate) struct Cells {
    size: f64,
    origin: DVec3,
    /// The last point of each cell.
    last: FxHashMap<[i32; 3], u32>,
    /// For each point the one before it in its cell, or [`NO_POINT`].
    before: Vec<u32>,
}

const NO_POINT: u32 = u32::MAX;

impl Cells {
    pub(crate) fn new(size: f64, origin: DVec3) -> Self {
        Self {
            size,
            origin,
            last: FxHashMap::default(),
            before: Vec::new(),
        }
    }

    fn cell(&self, point: DVec3) -> [i32; 3] {
        // Far away, where numbers saturate, cells become one.
        let at = (point - self.origin) / self.size;
        at.to_array().map(|c| c.floor() as i32)
    }

    /// Adds the next point.
    pub(crate) fn push(&mut self, point: DVec3) {
        let number = self.before.len() as u32;
        let last = self.last.insert(self.cell(point), number);
        self.before.push(last.unwrap_or(NO_POINT));
    }

    /// A point for which something is so, in the cell of `point` or in the 26 around it: among them
    /// are all that are no further than the size of a cell.
    pub(crate) fn find_near(
        &self,
        point: DVec3,
        mut is_so: impl FnMut(usize) -> bool,
    ) -> Option<usize> {
        let cell = self.cell(point);
        let mut in_cell = |[x, y, z]: [i32; 3]| {
            let near = [
                cell[0].saturating_add(x),
                cell[1].saturating_add(y),
                cell[2].saturating_add(z),
            ];
            let mut number = self.last.get(&near).copied().unwrap_or(NO_POINT);
            while number != NO_POINT {
                if is_so(number as usize) {
                    return Some(number as usize);
                }
                number = self.before[number as usize];
            }
            None
        };
        // What is near lies most often in the same cell.
        in_cell([0; 3]).or_else(|| AROUND.into_iter().find_map(in_cell))
    }
}
