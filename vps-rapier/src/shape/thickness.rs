//! The wall thickness of a solid.

use vps_core::{Asset, DistanceField};

/// Points of the shell to measure at, about.
const SAMPLES: usize = 512;

/// One sample in this many may be thinner than the thickness: a thin tip, such as that of a claw, is no
/// thin wall.
const THIN_SAMPLE_RATIO: usize = 20;

/// Thickness of an asset's solid in metres: along the normals of the shell's points, all but a
/// twentieth of them measure at least that. Costs some milliseconds.
pub(crate) fn thickness(asset: &Asset<'_>) -> f32 {
    let (tree, field) = (&asset.tree, asset.voxelmap.trilinear());
    let extents = asset.voxelmap.solid().extents();
    let step = 0.25 * asset.voxelmap.grid().voxel_size();
    let through = |point: usize| {
        let (from, inward) = (tree.point(point), tree.normal(point));
        let mut distance = 2.0 * step;
        while distance < extents.length() {
            let depth = field.penetration(from + inward * distance, inward);
            if depth < 0.0 {
                break;
            }
            // The opposite surface is no closer than the depth.
            distance += depth.max(step);
        }
        distance
    };
    let stride = tree.point_count().div_ceil(SAMPLES).max(1);
    let points = (0..tree.point_count()).step_by(stride);
    let mut distances: Vec<f32> = points.map(through).collect();
    distances.sort_unstable_by(f32::total_cmp);
    let thin = distances.get(distances.len() / THIN_SAMPLE_RATIO);
    thin.map_or(0.0, |thin| thin.min(extents.min_element()))
}
