//! Function multiversioning: the one module that depends on the processor, and the one with unsafe
//! code.
#![allow(unsafe_code)]

/// Runs `work` with the best supported instruction set of this processor.
///
/// All code inlined into `work` is compiled twice: for the target of the crate, and for x86-64 with
/// AVX2 and bit manipulation. Neither version contracts or reorders floating-point operations, so
/// both give the same bits. With `std` the version is chosen at run time, without it by the target.
#[inline(always)]
pub(crate) fn multiversion<R>(work: impl FnOnce() -> R) -> R {
    #[cfg(all(feature = "std", target_arch = "x86_64", not(target_feature = "avx2")))]
    if has_avx2() {
        // SAFETY: the processor has the features the function is compiled for.
        return unsafe { avx2(work) };
    }
    work()
}

#[cfg(all(feature = "std", target_arch = "x86_64", not(target_feature = "avx2")))]
#[inline(always)]
fn has_avx2() -> bool {
    extern crate std;
    #[cfg(test)]
    if tests::BASELINE_ONLY.load(core::sync::atomic::Ordering::Relaxed) {
        return false;
    }
    use std::is_x86_feature_detected as has;
    has!("avx2") && has!("bmi1") && has!("bmi2") && has!("lzcnt") && has!("popcnt")
}

/// # Safety
/// The processor must have the named features.
#[cfg(all(feature = "std", target_arch = "x86_64", not(target_feature = "avx2")))]
#[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
fn avx2<R>(work: impl FnOnce() -> R) -> R {
    work()
}

#[cfg(all(test, feature = "std", target_arch = "x86_64"))]
mod tests {
    use core::sync::atomic::{AtomicBool, Ordering};
    use std::string::String;
    use std::vec::Vec;
    use std::{format, vec};

    use proptest::prelude::*;

    use crate::raw::{
        BRICK_VALUES, CellGroup, ClusterParts, REFINED_CELL_VALUES, RefinedCell, Store, TreeParts,
        Values, VoxelmapParts, mark_coarse_neighbourhoods,
    };
    use crate::*;

    /// Whether only the target's instruction set is used.
    pub(super) static BASELINE_ONLY: AtomicBool = AtomicBool::new(false);

    const RINGS: usize = 16;
    const POINTS_PER_RING: usize = 32;

    /// A bumpy ball: rings of points, four in a leaf, as a tree of three levels.
    fn shell() -> PointSphereTree<'static> {
        let (mut points, mut normals) = (Vec::new(), Vec::new());
        for i in 0..RINGS * POINTS_PER_RING {
            let up = core::f32::consts::PI * ((i / POINTS_PER_RING) as f32 + 0.5) / RINGS as f32;
            let round =
                core::f32::consts::TAU * (i % POINTS_PER_RING) as f32 / POINTS_PER_RING as f32;
            let out = Vec3::new(up.sin() * round.cos(), up.cos(), up.sin() * round.sin());
            points.push((out * (1.0 + 0.1 * (7.0 * round).sin())).to_array());
            normals.push((-out).to_array());
        }
        let cluster = |first: usize, count: usize, below: core::ops::Range<usize>| {
            let points = points[below.clone()].iter().map(|&p| Vec3::from_array(p));
            let center = points.clone().sum::<Vec3>() / below.len() as f32;
            let mut cluster = ClusterParts {
                center: center.to_array(),
                radius: points
                    .clone()
                    .map(|p| center.distance(p))
                    .fold(0.0, f32::max),
                normal: normals[below.start],
                half_thickness: 0.0,
                apex: 0.01,
                half_curvature: 0.3,
                first: first as u32,
                count: count as u32,
                parent_point: below.start as u32,
                area: below.len() as f32,
            };
            cluster.half_thickness = points
                .map(|p| cluster.distance_from_paraboloid(p))
                .fold(0.0, f32::max);
            Cluster::from(cluster)
        };
        let all = RINGS * POINTS_PER_RING;
        let mut clusters = vec![cluster(0, RINGS, 0..all)];
        for (size, children) in [(POINTS_PER_RING, POINTS_PER_RING / 4), (4, 4)] {
            let parts = (0..all / size).map(|i| (i * children, i * size..(i + 1) * size));
            clusters.extend(parts.map(|(first, below)| cluster(first, children, below)));
        }
        let starts = vec![0, 1, 1 + RINGS as u32, clusters.len() as u32];
        let areas = vec![1.0; all];
        PointSphereTree::from_parts(TreeParts {
            points: points.into(),
            normals: normals.into(),
            areas: areas.into(),
            clusters: clusters.into(),
            level_starts: starts.into(),
        })
        .unwrap()
    }

    /// A sparse, a dense and a floating-point map of random values.
    fn maps(mut random: impl FnMut() -> u64) -> [Voxelmap<'static>; 3] {
        let dims = [20, 17, 30];
        let grid = Grid::new(Vec3::splat(-1.3), 0.13, dims).unwrap();
        let mut groups = vec![CellGroup {
            refined: random() & ((1 << 36) - 1),
            ..CellGroup::default()
        }];
        mark_coarse_neighbourhoods(dims, &mut groups);
        let mut bricks = 0;
        let mut cell = || {
            let cell = RefinedCell {
                bricks: random() & random(),
                first_brick: bricks,
                reserved: 0,
            };
            bricks += cell.bricks.count_ones();
            cell
        };
        let cells: Vec<_> = (0..groups[0].refined.count_ones())
            .map(|_| cell())
            .collect();
        let stored = 4 * 4 * 5 + cells.len() * REFINED_CELL_VALUES + bricks as usize * BRICK_VALUES;
        let mut value = || (random() % 2000) as i16 - 1000;
        let sparse: Vec<_> = (0..stored).map(|_| value()).collect();
        let dense: Vec<_> = (0..20 * 17 * 30).map(|_| value()).collect();
        let floats: Vec<_> = dense.iter().map(|&v| f32::from(v) * 0.9).collect();
        let curvature_bounds: Vec<_> = (0..36).map(|_| (random() % 256) as u8).collect();
        let integers = |values: Vec<i16>| Values::Integers(values.into());
        [
            Store::sparse(dims, groups.into(), cells.into(), integers(sparse)),
            Store::dense(dims, integers(dense)),
            Store::dense(dims, Values::Floats(floats.into())),
        ]
        .map(|store| {
            let error_bounds = ErrorBounds {
                in_band: 1e-3,
                beyond: 0.1,
                narrow_band: 0.5,
            };
            let solid = Aabb {
                min: Vec3::splat(-0.7),
                max: Vec3::splat(0.7),
            };
            Voxelmap::from_parts(VoxelmapParts {
                grid,
                sigma: 1e-3,
                solid,
                error_bounds,
                store: store.unwrap(),
                curvature_bounds: curvature_bounds.clone().into(),
            })
            .unwrap()
        })
    }

    /// The results of all queries, to the bit.
    fn results(field: &impl DistanceField, tree: &PointSphereTree<'_>, pose: Pose3) -> String {
        let query = Query::new(tree, field, pose).with_prediction(0.05);
        let (mut all, mut segments) = (Vec::new(), Vec::new());
        query.for_each_contact(|c| all.push(c));
        query.for_each_segment(2, |segment, c| segments.push((segment, c)));
        let wrenches = (
            query.wrench(Vec3::ONE, Weight::Area),
            query.linear_wrench(Vec3::ONE, Weight::Area),
        );
        let estimate = query.time_critical(Vec3::ZERO, |tested| tested < 100);
        let answers = (query.touches(), query.deepest(), query.closest());
        let manifold = query.manifold::<4>();
        format!("{all:?} {segments:?} {wrenches:?} {estimate:?} {answers:?} {manifold:?}")
    }

    // Compares nothing on a processor without AVX2.
    proptest! {
        #[test]
        fn all_instruction_sets_give_the_same_bits(
            seed in any::<u64>(),
            translation in prop::array::uniform3(-1.5_f32..1.5),
            rotation in prop::array::uniform3(-2.0_f32..2.0),
        ) {
            let mut state = seed | 1;
            let random = || {
                // Xorshift.
                state ^= state << 13;
                state ^= state >> 7;
                state ^= state << 17;
                state
            };
            let rotation = Quat::from_scaled_axis(Vec3::from_array(rotation));
            let pose = Pose3::from_parts(Vec3::from_array(translation), rotation);
            let tree = shell();
            let [sparse, dense, floats] = maps(random);
            let all_results = || {
                vec![
                    results(&sparse.trilinear(), &tree, pose),
                    results(&dense.trilinear(), &tree, pose),
                    results(&dense.linear(), &tree, pose),
                    results(&dense.local(), &tree, pose),
                    results(&floats.trilinear(), &tree, pose),
                    results(&Cuboid::new(Vec3::new(0.4, 0.7, 0.5)), &tree, pose),
                    results(&Ball::new(0.6), &tree, pose),
                    results(&Capsule::new(0.5, 0.3), &tree, pose),
                    results(&Cylinder::new(0.5, 0.3), &tree, pose),
                    results(&HalfSpace::new(Vec3::ONE), &tree, pose),
                ]
            };
            let widest = all_results();
            BASELINE_ONLY.store(true, Ordering::Relaxed);
            let baseline = all_results();
            BASELINE_ONLY.store(false, Ordering::Relaxed);
            prop_assert_eq!(widest, baseline);
        }
    }
}
