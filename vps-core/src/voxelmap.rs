use glamx::Vec3;

use crate::{Aabb, DistanceField, Grid, Store};

/// Half the diagonal of a voxel, in voxels.
const HALF_DIAGONAL: f32 = 0.866_025_4;

/// How far the values of a [`Voxelmap`] may be from the exact penetration of the voxel centres in
/// the solid.
///
/// Queries by the tree find what a test of all points finds for margins up to `band_m` less two
/// voxels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accuracy {
    /// Largest error in metres where the value lies within `band_m` of zero.
    pub near_m: f32,
    /// Largest error in metres anywhere else.
    pub far_m: f32,
    /// Where near ends, in metres.
    pub band_m: f32,
}

/// A signed distance field on a grid: one value v a voxel, times σ, is the penetration of the
/// voxel's centre (section 2.1.1).
///
/// With σ = s, the voxel size, the values are layers; with σ = λ = 10^-p they are distances
/// truncated to the precision p (eq. 1); with σ = 1 m they are floating-point distances. A map is
/// sampled through one of its views, which differ in what they make of a point between the
/// centres: [`local`](Self::local) and [`trilinear`](Self::trilinear).
#[derive(Clone, Debug)]
pub struct Voxelmap<'a> {
    grid: Grid,
    sigma: f32,
    solid: Aabb,
    accuracy: Accuracy,
    store: Store<'a>,
}

/// Why a [`Voxelmap`] was refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum VoxelmapError {
    /// Each voxel of a dense store needs a value, a sparse one what its cells say.
    #[error("{values} values in a store that needs {expected}")]
    ValueCount {
        /// Values given.
        values: usize,
        /// Values needed.
        expected: usize,
    },
    /// The cells of a sparse store are not counted right.
    #[error("the cells of the sparse store do not fit together")]
    Cells,
    /// A value is no number.
    #[error("a stored distance is not finite")]
    NotFinite,
    /// The store is for another grid.
    #[error("values for {store:?} voxels on a grid of {grid:?}")]
    Dims {
        /// Voxels along each axis of the store.
        store: [u32; 3],
        /// And of the grid.
        grid: [u32; 3],
    },
    /// σ means nothing.
    #[error("the value of one step must be positive and finite, not {0} m")]
    Sigma(f32),
    /// An error bound means nothing.
    #[error("error bounds must be finite and not negative, near not above far: {0:?}")]
    Accuracy(Accuracy),
    /// The solid must be inside of the grid.
    #[error("the solid {0:?} is not inside of the grid")]
    Solid(Aabb),
}

impl<'a> Voxelmap<'a> {
    /// A map over `grid` with the values of `store`, each worth `sigma` metres; `solid` is a box
    /// around the mesh the map was made from.
    ///
    /// # Errors
    /// When the parts do not fit together.
    pub fn new(
        grid: Grid,
        sigma: f32,
        solid: Aabb,
        accuracy: Accuracy,
        store: Store<'a>,
    ) -> Result<Self, VoxelmapError> {
        if store.dims() != grid.dims() {
            return Err(VoxelmapError::Dims {
                store: store.dims(),
                grid: grid.dims(),
            });
        }
        if !(sigma > 0.0 && sigma.is_finite()) {
            return Err(VoxelmapError::Sigma(sigma));
        }
        let Accuracy {
            near_m,
            far_m,
            band_m,
        } = accuracy;
        if !(near_m >= 0.0 && near_m <= far_m && far_m.is_finite() && band_m >= 0.0) {
            return Err(VoxelmapError::Accuracy(accuracy));
        }
        let bounds = grid.bounds();
        let tolerance = 0.01 * grid.voxel_size();
        let inside = (solid.min - bounds.min).min_element() >= -tolerance
            && (bounds.max - solid.max).min_element() >= -tolerance
            && (solid.max - solid.min).min_element() >= 0.0;
        if !inside {
            return Err(VoxelmapError::Solid(solid));
        }
        Ok(Self {
            grid,
            sigma,
            solid,
            accuracy,
            store,
        })
    }

    /// The grid of the map, in the field frame.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// What one step of a value is worth in metres: s for layers, λ for scaled distances (eq. 4).
    pub fn sigma(&self) -> f32 {
        self.sigma
    }

    /// The box around the mesh, in the field frame.
    pub fn solid(&self) -> Aabb {
        self.solid
    }

    /// What is known about the error of the values.
    pub fn accuracy(&self) -> Accuracy {
        self.accuracy
    }

    /// Where the values v are; positive inside.
    pub fn store(&self) -> &Store<'a> {
        &self.store
    }

    /// V of a voxel's centre in metres.
    pub fn center_penetration(&self, voxel: [u32; 3]) -> f32 {
        self.store.value(voxel) * self.sigma
    }

    /// The map sampled as in eq. 4: the value of the voxel plus the depth within the voxel along
    /// the normal of the shell point.
    pub fn local(&self) -> LocalPenetration<'_> {
        LocalPenetration(self)
    }

    /// The map sampled by trilinear interpolation of the eight values around a point: continuous
    /// from voxel to voxel, and independent of the normal.
    pub fn trilinear(&self) -> Trilinear<'_> {
        Trilinear(self)
    }

    /// The same map owning its values.
    #[cfg(feature = "alloc")]
    pub fn into_owned(self) -> Voxelmap<'static> {
        Voxelmap {
            grid: self.grid,
            sigma: self.sigma,
            solid: self.solid,
            accuracy: self.accuracy,
            store: self.store.into_owned(),
        }
    }

    /// An upper bound on what any sampling within `sampling_error` metres of the exact
    /// penetration can give in the ball.
    fn penetration_bound(&self, center: Vec3, radius: f32, sampling_error: f32) -> f32 {
        let at_center = if self.grid.bounds().contains(center) {
            let voxel = self.grid.voxel_at(center);
            let stored = self.center_penetration(voxel);
            let error = if stored.abs() > self.accuracy.band_m {
                self.accuracy.far_m
            } else {
                self.accuracy.near_m
            };
            // The exact penetration changes by no more than the way from the voxel's centre.
            stored + error + center.distance(self.grid.center(voxel))
        } else {
            // No point of the solid is closer than its box.
            -self.solid.distance_outside(center)
        };
        let mut bound = at_center + radius + sampling_error;
        if bound > 0.0 {
            // Points deep in the solid may be given deeper than they are by as much as this.
            bound += self.accuracy.far_m;
        }
        bound
    }

    fn inward_direction(&self, point: Vec3) -> Vec3 {
        let point = self.grid.bounds().clamp(point);
        let step = self.grid.voxel_size();
        let field = self.trilinear();
        let slope = |axis: Vec3| {
            field.penetration(point + axis * step, Vec3::ZERO)
                - field.penetration(point - axis * step, Vec3::ZERO)
        };
        Vec3::new(slope(Vec3::X), slope(Vec3::Y), slope(Vec3::Z)).normalize_or_zero()
    }
}

/// A [`Voxelmap`] sampled as in eq. 4: V(P) = n·e + vσ with e = C − P.
///
/// One value is read a point. The error is the map's plus at most the diagonal of a voxel, √3 s:
/// the centre C is up to half of it away, and so is the local part n·e.
#[derive(Clone, Copy, Debug)]
pub struct LocalPenetration<'m>(&'m Voxelmap<'m>);

impl LocalPenetration<'_> {
    /// Edge length s of a voxel in metres.
    pub fn voxel_size(&self) -> f32 {
        self.0.grid.voxel_size()
    }
}

impl DistanceField for LocalPenetration<'_> {
    fn penetration(&self, point: Vec3, normal: Vec3) -> f32 {
        let map = self.0;
        let inside = map.grid.bounds().clamp(point);
        let voxel = map.grid.voxel_at(inside);
        let to_center = map.grid.center(voxel) - inside;
        normal.dot(to_center) + map.center_penetration(voxel) - point.distance(inside)
    }

    fn inward_direction(&self, point: Vec3) -> Vec3 {
        self.0.inward_direction(point)
    }

    fn penetration_bound(&self, center: Vec3, radius: f32) -> f32 {
        self.0.penetration_bound(center, radius, self.error_bound())
    }

    fn bounds(&self) -> Aabb {
        self.0.solid
    }

    fn error_bound(&self) -> f32 {
        self.0.accuracy.near_m + 2.0 * HALF_DIAGONAL * self.0.grid.voxel_size()
    }
}

/// A [`Voxelmap`] sampled by trilinear interpolation.
///
/// Eight values are read a point. The error is the map's plus at most half the diagonal of a
/// voxel, √3/2 s; over a flat part of the surface it is the map's alone.
#[derive(Clone, Copy, Debug)]
pub struct Trilinear<'m>(&'m Voxelmap<'m>);

impl Trilinear<'_> {
    /// Edge length s of a voxel in metres.
    pub fn voxel_size(&self) -> f32 {
        self.0.grid.voxel_size()
    }
}

impl Trilinear<'_> {
    /// How far [`penetration`](DistanceField::penetration) at `point` may be from the exact one, in
    /// metres: the error bound of the field close to the surface, more far from it, and twice the
    /// way to the grid more outside of the grid.
    pub fn error_bound_at(&self, point: Vec3) -> f32 {
        let map = self.0;
        let way = map.grid.center_bounds().distance_outside(point);
        // Beyond the band no value around the point may be taken for a near one.
        let reach = 2.0 * HALF_DIAGONAL * map.grid.voxel_size();
        let depth = self.penetration(point, Vec3::ZERO) + way;
        let beyond = if depth.abs() + reach > map.accuracy.band_m {
            map.accuracy.far_m - map.accuracy.near_m
        } else {
            0.0
        };
        self.error_bound() + beyond + 2.0 * way
    }
}

impl DistanceField for Trilinear<'_> {
    fn penetration(&self, point: Vec3, _normal: Vec3) -> f32 {
        let map = self.0;
        let inside = map.grid.center_bounds().clamp(point);
        let (corner, t) = map.grid.cell_at(inside);
        map.store.interpolated(corner, t) * map.sigma - point.distance(inside)
    }

    fn inward_direction(&self, point: Vec3) -> Vec3 {
        self.0.inward_direction(point)
    }

    fn penetration_bound(&self, center: Vec3, radius: f32) -> f32 {
        self.0.penetration_bound(center, radius, self.error_bound())
    }

    fn bounds(&self) -> Aabb {
        self.0.solid
    }

    fn error_bound(&self) -> f32 {
        self.0.accuracy.near_m + HALF_DIAGONAL * self.0.grid.voxel_size()
    }
}
