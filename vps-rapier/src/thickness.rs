//! How thick a solid is where it is thin.

use vps_core::{Asset, DistanceField};

/// Points of the shell that are looked at.
const LOOKED_AT: usize = 512;

/// How many of them may be where the solid is thinner still, one in so many: the tip of a claw is no
/// thin wall.
const THINNER: usize = 20;

/// How thick an asset's solid is below all but a twentieth of its points, along their normals, in
/// metres. Costs some milliseconds.
pub(crate) fn thickness(asset: &Asset<'_>) -> f32 {
    let (tree, field) = (&asset.tree, asset.voxelmap.trilinear());
    let extents = asset.voxelmap.solid().extents();
    let step = 0.25 * asset.voxelmap.grid().voxel_size();
    let through = |point: usize| {
        let (from, inward) = (tree.point(point), tree.normal(point));
        let mut way = 2.0 * step;
        while way < extents.length() {
            let depth = field.penetration(from + inward * way, inward);
            if depth < 0.0 {
                break;
            }
            // The other side is no closer than that.
            way += depth.max(step);
        }
        way
    };
    let stride = tree.point_count().div_ceil(LOOKED_AT).max(1);
    let points = (0..tree.point_count()).step_by(stride);
    let mut ways: Vec<f32> = points.map(through).collect();
    ways.sort_unstable_by(f32::total_cmp);
    let thin = ways.get(ways.len() / THINNER);
    thin.map_or(0.0, |thin| thin.min(extents.min_element()))
}
