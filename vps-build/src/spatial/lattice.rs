//! Cubical lattices: the neighbours of a cell, and the cells that a triangle overlaps.

use glamx::{DVec3, I64Vec3};

use super::triangle_box;

/// The steps to the 26 neighbours of a cell, those that share a face first.
pub(crate) const NEIGHBOURS_26: [[i32; 3]; 26] = neighbours_26();

const fn neighbours_26() -> [[i32; 3]; 26] {
    let mut steps = [[0; 3]; 26];
    let (mut filled, mut shared) = (0, 1);
    while shared <= 3 {
        let mut i = 0;
        while i < 27 {
            let step = [i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1];
            let length = step[0] * step[0] + step[1] * step[1] + step[2] * step[2];
            if length == shared {
                steps[filled] = step;
                filled += 1;
            }
            i += 1;
        }
        shared += 1;
    }
    steps
}

/// Calls `visit` with every cell that shares a point with the triangle, and with its centre. `origin`
/// is the lowest corner of cell (0, 0, 0) and `size` the edge of a cell, in metres. Costs time
/// proportional to those cells, not to the bounding box of the triangle.
pub(crate) fn for_each_overlapped_cell(
    triangle: [DVec3; 3],
    origin: DVec3,
    size: f64,
    mut visit: impl FnMut([i64; 3], DVec3),
) {
    let [a, b, c] = triangle.map(|v| (v - origin) / size);
    let nudge = DVec3::splat(1e-9);
    let low = (a.min(b).min(c) - nudge).floor().as_i64vec3();
    let high = (a.max(b).max(c) + nudge).floor().as_i64vec3();
    let steps = high - low;
    // A triangle within one row of cells passes through all of them.
    if steps.to_array().into_iter().filter(|&n| n > 0).count() <= 1 {
        for i in 0..=steps.max_element() {
            let cell = (low + i).min(high);
            visit(cell.to_array(), origin + (cell.as_dvec3() + 0.5) * size);
        }
        return;
    }
    // Octree descent through cubes of 2^level cells.
    let level = (steps.max_element() as u64 + 1)
        .next_power_of_two()
        .trailing_zeros();
    let mut cubes = vec![(low, level)];
    while let Some((first, level)) = cubes.pop() {
        let cells = (1_i64 << level) as f64;
        let center = origin + (first.as_dvec3() + 0.5 * cells) * size;
        if first.cmpgt(high).any() || !triangle_box::overlaps(triangle, center, 0.5 * cells * size)
        {
            continue;
        }
        if level == 0 {
            visit(first.to_array(), center);
            continue;
        }
        let half = 1_i64 << (level - 1);
        cubes.extend((0..8_i64).rev().map(|i| {
            let step = I64Vec3::new(i & 1, i >> 1 & 1, i >> 2 & 1) * half;
            (first + step, level - 1)
        }));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The descent finds the cells that a scan of the whole box finds.
    #[test]
    fn the_cells_of_a_triangle_are_found() {
        let point = |seed: f64| {
            DVec3::new(
                (seed * 12.9).sin(),
                (seed * 78.2).sin(),
                (seed * 37.7).sin(),
            ) * 6.0
        };
        for i in 0..200 {
            let t = f64::from(i) * 3.0;
            let mut triangle = [point(t), point(t + 1.0), point(t + 2.0)];
            if i % 4 == 0 {
                // A needle.
                triangle[2] = triangle[0].lerp(triangle[1], 0.3);
            }
            let (origin, size) = (DVec3::splat(-7.0), 0.5);
            let mut found = Vec::new();
            for_each_overlapped_cell(triangle, origin, size, |cell, center| {
                assert!(
                    center.distance(origin + (I64Vec3::from(cell).as_dvec3() + 0.5) * size) < 1e-12
                );
                found.push(cell);
            });
            let mut expected = Vec::new();
            for z in 0..28 {
                for y in 0..28 {
                    for x in 0..28 {
                        let center = origin + (I64Vec3::new(x, y, z).as_dvec3() + 0.5) * size;
                        if triangle_box::overlaps(triangle, center, 0.5 * size) {
                            expected.push([x, y, z]);
                        }
                    }
                }
            }
            found.sort_unstable();
            expected.sort_unstable();
            assert_eq!(found, expected);
        }
    }
}
