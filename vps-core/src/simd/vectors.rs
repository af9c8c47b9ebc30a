//! Points, vectors and voxels of all lanes.

use glamx::{Mat3, Vec3};
use wide::{f32x4, i32x4};

use crate::aabb::Aabb;
use crate::simd::lanes::{LANES, padded};

/// Coordinates of [`LANES`] points in metres, as a structure of arrays.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Points {
    /// All x.
    pub x: [f32; LANES],
    /// All y.
    pub y: [f32; LANES],
    /// All z.
    pub z: [f32; LANES],
}

impl Points {
    /// The same point in all lanes.
    #[inline(always)]
    pub fn splat(point: Vec3) -> Self {
        Self {
            x: [point.x; LANES],
            y: [point.y; LANES],
            z: [point.z; LANES],
        }
    }

    /// Reads [`LANES`] of `points` from index `first` on. If there are fewer, the last one is
    /// repeated.
    ///
    /// # Panics
    /// If there is no point from there on.
    #[inline(always)]
    pub fn read(points: &[[f32; 3]], first: usize) -> Self {
        padded(
            &points[first..],
            #[inline(always)]
            |[a, b, c, d]| Self {
                x: [a[0], b[0], c[0], d[0]],
                y: [a[1], b[1], c[1], d[1]],
                z: [a[2], b[2], c[2], d[2]],
            },
        )
    }

    /// The point of a lane.
    #[inline(always)]
    pub fn get(&self, lane: usize) -> Vec3 {
        Vec3::new(self.x[lane], self.y[lane], self.z[lane])
    }

    /// Puts a point into a lane.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, point: Vec3) {
        (self.x[lane], self.y[lane], self.z[lane]) = (point.x, point.y, point.z);
    }
}

/// [`LANES`] vectors in SIMD registers.
#[derive(Clone, Copy)]
pub(crate) struct Vectors {
    pub(crate) x: f32x4,
    pub(crate) y: f32x4,
    pub(crate) z: f32x4,
}

impl Vectors {
    /// Zero; as masks, no coordinate.
    pub(crate) const ZERO: Self = Self {
        x: f32x4::ZERO,
        y: f32x4::ZERO,
        z: f32x4::ZERO,
    };

    #[inline(always)]
    pub(crate) fn splat(v: Vec3) -> Self {
        Self {
            x: f32x4::splat(v.x),
            y: f32x4::splat(v.y),
            z: f32x4::splat(v.z),
        }
    }

    #[inline(always)]
    pub(crate) fn dot(self, other: Self) -> f32x4 {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    #[inline(always)]
    pub(crate) fn cross(self, other: Self) -> Self {
        Self {
            x: self.y * other.z - self.z * other.y,
            y: self.z * other.x - self.x * other.z,
            z: self.x * other.y - self.y * other.x,
        }
    }

    /// The sum over all lanes.
    #[inline(always)]
    pub(crate) fn sum(self) -> Vec3 {
        let sum = |axis: f32x4| {
            let [a, b, c, d] = axis.to_array();
            (a + b) + (c + d)
        };
        Vec3::new(sum(self.x), sum(self.y), sum(self.z))
    }

    #[inline(always)]
    pub(crate) fn length(self) -> f32x4 {
        self.dot(self).sqrt()
    }

    #[inline(always)]
    pub(crate) fn times(self, factor: f32x4) -> Self {
        Self {
            x: self.x * factor,
            y: self.y * factor,
            z: self.z * factor,
        }
    }

    #[inline(always)]
    pub(crate) fn minus(self, other: Self) -> Self {
        Self {
            x: self.x - other.x,
            y: self.y - other.y,
            z: self.z - other.z,
        }
    }

    #[inline(always)]
    pub(crate) fn plus(self, other: Self) -> Self {
        Self {
            x: self.x + other.x,
            y: self.y + other.y,
            z: self.z + other.z,
        }
    }

    #[inline(always)]
    pub(crate) fn negated(self) -> Self {
        Self {
            x: -self.x,
            y: -self.y,
            z: -self.z,
        }
    }

    #[inline(always)]
    pub(crate) fn abs(self) -> Self {
        Self {
            x: self.x.abs(),
            y: self.y.abs(),
            z: self.z.abs(),
        }
    }

    #[inline(always)]
    pub(crate) fn at_least_zero(self) -> Self {
        Self {
            x: self.x.fast_max(f32x4::ZERO),
            y: self.y.fast_max(f32x4::ZERO),
            z: self.z.fast_max(f32x4::ZERO),
        }
    }

    /// Masks of the coordinates that are smaller than those of another vector.
    #[inline(always)]
    pub(crate) fn is_less(self, than: Self) -> Self {
        Self {
            x: self.x.simd_lt(than.x),
            y: self.y.simd_lt(than.y),
            z: self.z.simd_lt(than.z),
        }
    }

    /// The lanes in which the mask of any coordinate is set; `self` holds masks.
    #[inline(always)]
    pub(crate) fn any(self) -> f32x4 {
        self.x | self.y | self.z
    }

    /// Selects between `yes` and `no` coordinate by coordinate; `self` holds masks.
    #[inline(always)]
    pub(crate) fn select(self, yes: Self, no: Self) -> Self {
        Self {
            x: self.x.select(yes.x, no.x),
            y: self.y.select(yes.y, no.y),
            z: self.z.select(yes.z, no.z),
        }
    }

    /// Each coordinate, which must not be negative, with the sign of the same coordinate of `other`.
    #[inline(always)]
    pub(crate) fn with_signs_of(self, other: Self) -> Self {
        Self {
            x: self.x.copysign(other.x),
            y: self.y.copysign(other.y),
            z: self.z.copysign(other.z),
        }
    }

    /// All vectors rotated.
    #[inline(always)]
    pub(crate) fn rotated(self, rotation: &Mat3) -> Self {
        Self::splat(rotation.x_axis)
            .times(self.x)
            .plus(Self::splat(rotation.y_axis).times(self.y))
            .plus(Self::splat(rotation.z_axis).times(self.z))
    }

    /// The closest points of a box; its lowest corner for a NaN.
    #[inline(always)]
    pub(crate) fn clamped(self, bounds: &Aabb) -> Self {
        let (min, max) = (Self::splat(bounds.min), Self::splat(bounds.max));
        Self {
            x: self.x.fast_max(min.x).fast_min(max.x),
            y: self.y.fast_max(min.y).fast_min(max.y),
            z: self.z.fast_max(min.z).fast_min(max.z),
        }
    }
}

impl Vectors {
    /// The distance to the nearest face of a box, negative outside of the box.
    #[inline(always)]
    pub(crate) fn depth_in(self, bounds: &Aabb) -> f32x4 {
        let low = self.minus(Self::splat(bounds.min));
        let high = Self::splat(bounds.max).minus(self);
        let smallest = |v: Self| v.x.fast_min(v.y).fast_min(v.z);
        smallest(low).fast_min(smallest(high))
    }
}

impl From<Points> for Vectors {
    #[inline(always)]
    fn from(p: Points) -> Self {
        Self {
            x: f32x4::new(p.x),
            y: f32x4::new(p.y),
            z: f32x4::new(p.z),
        }
    }
}

impl From<Vectors> for Points {
    #[inline(always)]
    fn from(v: Vectors) -> Self {
        Self {
            x: v.x.to_array(),
            y: v.y.to_array(),
            z: v.z.to_array(),
        }
    }
}

/// Coordinates of [`LANES`] voxels in a grid, in SIMD registers.
#[derive(Clone, Copy)]
pub(crate) struct Voxels {
    pub(crate) x: i32x4,
    pub(crate) y: i32x4,
    pub(crate) z: i32x4,
}

impl Voxels {
    /// Indices in an array of `dims` values, x fastest, then y, then z.
    #[inline(always)]
    pub(crate) fn linear(self, dims: [u32; 3]) -> [usize; LANES] {
        let [nx, ny] = [i32x4::splat(dims[0] as i32), i32x4::splat(dims[1] as i32)];
        let [a, b, c, d] = ((self.z * ny + self.y) * nx + self.x).to_array();
        [
            a as u32 as usize,
            b as u32 as usize,
            c as u32 as usize,
            d as u32 as usize,
        ]
    }

    /// The blocks of `1 << bits` voxels along each axis that contain the voxels.
    #[inline(always)]
    pub(crate) fn blocks(self, bits: i32) -> Self {
        Self {
            x: self.x >> bits,
            y: self.y >> bits,
            z: self.z >> bits,
        }
    }

    /// The coordinates within those blocks: the bits of `mask`.
    #[inline(always)]
    pub(crate) fn within(self, mask: i32) -> Vectors {
        let mask = i32x4::splat(mask);
        Vectors {
            x: (self.x & mask).round_float(),
            y: (self.y & mask).round_float(),
            z: (self.z & mask).round_float(),
        }
    }

    #[inline(always)]
    pub(crate) fn get(self, lane: usize) -> [u32; 3] {
        let at = |axis: i32x4| axis.to_array()[lane] as u32;
        [at(self.x), at(self.y), at(self.z)]
    }
}
