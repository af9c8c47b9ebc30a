//! Trilinear interpolation between eight values.

use glamx::Vec3;
use wide::f32x4;

use super::value::StoredValue;
use crate::simd::{LANES, Vectors};

/// The eight values around a point in each lane, x fastest, then y, then z.
pub(super) struct TrilinearStencil([f32x4; 8]);

impl TrilinearStencil {
    /// From the four rows along x, each with the pairs of all lanes.
    #[inline(always)]
    pub(super) fn of<T: StoredValue>([low, next, high, last]: [[T::Pair; LANES]; 4]) -> Self {
        let ([a, b], [c, d]) = (T::unzip(low), T::unzip(next));
        let ([e, f], [g, h]) = (T::unzip(high), T::unzip(last));
        Self([a, b, c, d, e, f, g, h])
    }

    /// The same values in all lanes.
    #[inline(always)]
    fn splat<T: StoredValue>([a, b, c, d]: [T::Pair; 4]) -> Self {
        Self::of::<T>([[a; LANES], [b; LANES], [c; LANES], [d; LANES]])
    }

    #[inline(always)]
    pub(super) fn set(&mut self, lane: usize, values: [f32; 8]) {
        for (own, value) in self.0.iter_mut().zip(values) {
            own.as_mut_array()[lane] = value;
        }
    }

    /// Trilinear interpolation at `t`, and its gradient per step of the values.
    #[inline(always)]
    pub(super) fn interpolated(&self, t: Vectors) -> (f32x4, Vectors) {
        let lerp = |a: f32x4, b: f32x4, t: f32x4| a + (b - a) * t;
        let [a, b, c, d, e, f, g, h] = self.0;
        // Slopes along x of the four rows, and the values of the rows at t.x.
        let steps = [b - a, d - c, f - e, h - g];
        let rows = [
            a + steps[0] * t.x,
            c + steps[1] * t.x,
            e + steps[2] * t.x,
            g + steps[3] * t.x,
        ];
        let (low, high) = (lerp(rows[0], rows[1], t.y), lerp(rows[2], rows[3], t.y));
        let slope = Vectors {
            x: lerp(
                lerp(steps[0], steps[1], t.y),
                lerp(steps[2], steps[3], t.y),
                t.z,
            ),
            y: lerp(rows[1] - rows[0], rows[3] - rows[2], t.z),
            z: high - low,
        };
        (lerp(low, high, t.z), slope)
    }
}

/// Interpolates the eight voxels from `first` on between the corners of a cube of `size` voxels. Along
/// axes in `crosses` the next voxel lies beyond the cube, and `first` is used in its place.
#[inline(always)]
pub(super) fn interpolated_voxels<T: StoredValue>(
    corners: [T::Pair; 4],
    first: [usize; 3],
    crosses: [bool; 3],
    size: usize,
) -> [f32; 8] {
    let t = |axis: usize, next: [f32; LANES]| {
        let next = if crosses[axis] { [0.0; LANES] } else { next };
        (f32x4::new(next) + first[axis] as f32) / size as f32
    };
    let corners = TrilinearStencil::splat::<T>(corners);
    let plane = |next: f32| {
        let t = Vectors {
            x: t(0, [0.0, 1.0, 0.0, 1.0]),
            y: t(1, [0.0, 0.0, 1.0, 1.0]),
            z: t(2, [next; LANES]),
        };
        corners.interpolated(t).0
    };
    bytemuck::cast([plane(0.0), plane(1.0)])
}

/// Interpolates a single point between the corners of a cube.
#[inline(always)]
pub(super) fn interpolated_point<T: StoredValue>(corners: [T::Pair; 4], t: Vec3) -> f32 {
    let (value, _) = TrilinearStencil::splat::<T>(corners).interpolated(Vectors::splat(t));
    value.to_array()[0]
}
