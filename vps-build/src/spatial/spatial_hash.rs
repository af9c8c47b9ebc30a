//! A spatial hash of points.

use glamx::DVec3;
use rustc_hash::FxHashMap;

use super::lattice::NEIGHBOURS_26;

/// Points by the cell of a lattice they lie in, numbered in the order of insertion.
pub(crate) struct SpatialHash {
    size: f64,
    origin: DVec3,
    /// The point inserted last in each cell.
    latest: FxHashMap<[i32; 3], u32>,
    /// For each point the previous one in its cell, or [`NONE`].
    previous: Vec<u32>,
}

const NONE: u32 = u32::MAX;

impl SpatialHash {
    /// Cells have an edge of `size` metres.
    pub(crate) fn new(size: f64, origin: DVec3) -> Self {
        Self {
            size,
            origin,
            latest: FxHashMap::default(),
            previous: Vec::new(),
        }
    }

    fn cell(&self, point: DVec3) -> [i32; 3] {
        // Casts saturate: all cells far away are one.
        let at = (point - self.origin) / self.size;
        at.to_array().map(|c| c.floor() as i32)
    }

    /// Inserts the next point.
    pub(crate) fn insert(&mut self, point: DVec3) {
        let number = self.previous.len() as u32;
        let latest = self.latest.insert(self.cell(point), number);
        self.previous.push(latest.unwrap_or(NONE));
    }

    /// A point that `accept` takes, in the cell of `point` or its 26 neighbours. These hold all points
    /// within `size` metres.
    pub(crate) fn find_near(
        &self,
        point: DVec3,
        mut accept: impl FnMut(usize) -> bool,
    ) -> Option<usize> {
        let cell = self.cell(point);
        let mut in_cell = |[x, y, z]: [i32; 3]| {
            let near = [
                cell[0].saturating_add(x),
                cell[1].saturating_add(y),
                cell[2].saturating_add(z),
            ];
            let mut number = self.latest.get(&near).copied().unwrap_or(NONE);
            while number != NONE {
                if accept(number as usize) {
                    return Some(number as usize);
                }
                number = self.previous[number as usize];
            }
            None
        };
        // A near point is most often in the same cell.
        in_cell([0; 3]).or_else(|| NEIGHBOURS_26.into_iter().find_map(in_cell))
    }
}
