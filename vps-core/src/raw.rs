//! Parts of assets, and the evaluation of fields at several points at a time. **Unstable**: any version
//! may change them.
//!
//! * **Building assets**: [`TreeParts`] and [`VoxelmapParts`] are the arguments of
//!   [`PointSphereTree::from_parts`](crate::PointSphereTree::from_parts) and
//!   [`Voxelmap::from_parts`](crate::Voxelmap::from_parts), which check them. Their arrays are
//!   [`Storage`], borrowed or owned.
//! * **Fast fields**: a [`DistanceField`](crate::DistanceField) may override three provided methods that
//!   evaluate [`LANES`] points or [`Discs`] at a time: `penetrations`, `penetrations_and_gradients` and
//!   `penetration_bounds`. The documentation of the trait leaves them out, since the number of lanes may
//!   change. They belong to that trait and not to one of their own, so that a query is compiled with the
//!   field's own version, or with the default, for any field.

pub use crate::field::Discs;
pub use crate::map::store::{
    BRICK_VALUES, CELL_EDGE_VOXELS, CellGroup, REFINED_CELL_VALUES, RefinedCell, Store, Values,
    cell_dims, mark_coarse_neighbourhoods,
};
pub use crate::map::{CURVATURE_STEPS, CURVATURE_UNKNOWN, VoxelmapParts};
pub use crate::shell::{ClusterParts, MAX_LEVELS, TreeParts};
pub use crate::simd::{LANES, Points};
pub use crate::storage::Storage;
