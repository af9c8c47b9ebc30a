//! Meshes that are not clean solids are repaired to the intended solid.

use crate::brute_force::exact_penetration;
use crate::support::bumpy_mesh;
use glamx::{DQuat, DVec3, EulerRot};
use proptest::prelude::*;
use vps_build::{
    BuildError, BuildOptions, BuildOutput, Density, Mesh, PointCount, Repairs, Resolution, Sign,
    build,
};
use vps_core::DistanceField;

fn options(sign: Sign) -> BuildOptions {
    BuildOptions {
        resolution: Resolution::VoxelsAlongLongest(24),
        points: PointCount::About(50),
        density: Density::Dense,
        sign,
        ..BuildOptions::default()
    }
}

fn built(mesh: &Mesh, sign: Sign) -> BuildOutput {
    build(mesh, &options(sign), &|_| ()).unwrap()
}

/// Triangles of one mesh after those of another.
fn together(a: &Mesh, b: &Mesh) -> Mesh {
    let vertices = [a.vertices(), b.vertices()].concat();
    let shift = a.vertices().len() as u32;
    let shifted = b.triangles().iter().map(|t| t.map(|v| v + shift));
    let triangles: Vec<_> = a.triangles().iter().copied().chain(shifted).collect();
    Mesh::new(&vertices, &triangles).unwrap()
}

fn moved(mesh: &Mesh, by: DVec3) -> Mesh {
    let vertices: Vec<_> = mesh.vertices().iter().map(|&v| v + by).collect();
    Mesh::new(&vertices, mesh.triangles()).unwrap()
}

fn turned(mesh: &Mesh) -> Mesh {
    let triangles: Vec<_> = mesh
        .triangles()
        .iter()
        .map(|&[a, b, c]| [a, c, b])
        .collect();
    Mesh::new(mesh.vertices(), &triangles).unwrap()
}

/// Checks the penetration of all voxels against `exact`, to within `error` metres, except for
/// voxels that `skip` selects.
fn check(
    built: &BuildOutput,
    error: f64,
    exact: impl Fn(DVec3) -> f64,
    skip: impl Fn(DVec3) -> bool,
) -> Result<(), TestCaseError> {
    let map = &built.asset.voxelmap;
    let grid = map.grid();
    let [nx, ny, nz] = grid.dims();
    for i in (0..nx * ny * nz).step_by(37) {
        let voxel = [i % nx, i / nx % ny, i / (nx * ny)];
        let center = grid.center(voxel).as_dvec3();
        if !skip(center) {
            let (stored, exact) = (f64::from(map.center_penetration(voxel)), exact(center));
            prop_assert!(
                (stored - exact).abs() <= error,
                "{voxel:?}: {stored}, exact {exact}"
            );
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Duplicate, reversed and degenerate triangles change nothing at all.
    #[test]
    fn clutter_is_cleared(
        mesh in bumpy_mesh(),
        doubled in prop::collection::vec(any::<prop::sample::Index>(), 0..8),
        flipped in prop::collection::hash_set(0..1280_usize, 0..400),
        inside_out in any::<bool>(),
    ) {
        let mut triangles = mesh.triangles().to_vec();
        for &t in &flipped {
            triangles[t].reverse();
        }
        if inside_out {
            triangles.iter_mut().for_each(|t| t.reverse());
        }
        for index in &doubled {
            triangles.push(mesh.triangles()[index.index(1280)]);
        }
        triangles.push([5, 5, 9]);
        let cluttered = Mesh::new(mesh.vertices(), &triangles).unwrap();
        let found = built(&cluttered, Sign::Winding);
        let expected = built(&mesh, Sign::Winding);
        prop_assert_eq!(
            found.asset.to_bytes().len(), expected.asset.to_bytes().len());
        prop_assert_eq!(found.repairs.removed_faces, doubled.len() + 1);
        prop_assert_eq!((found.repairs.closed_holes, found.repairs.hidden_faces), (0, 0));
        let near = f64::from(found.asset.voxelmap.error_bounds().in_band);
        check(&found, near, |p| exact_penetration(&mesh, p), |_| false)?;
        let filled = built(&cluttered, Sign::Fill);
        prop_assert_eq!(filled.asset.mass.volume > 0.0, true);
    }

    /// Away from a hole the solid is the same as without it, for any shape of the hole.
    #[test]
    fn holes_are_closed(mesh in bumpy_mesh(), at in 0..1280_usize, size in 0.02..0.25_f64) {
        let middle = |t: &[u32; 3]| {
            t.iter().map(|&v| mesh.vertices()[v as usize]).sum::<DVec3>() / 3.0
        };
        let center = middle(&mesh.triangles()[at]);
        let (gone, left): (Vec<_>, Vec<_>) =
            mesh.triangles().iter().partition(|t| middle(t).distance(center) < size);
        prop_assume!(!gone.is_empty());
        let holed = Mesh::new(mesh.vertices(), &left).unwrap();
        let built = built(&holed, Sign::Winding);
        prop_assert!(built.repairs.closed_holes >= 1 && built.repairs.turned_faces == 0);
        // Signs may differ only where the removed part of the surface, or the fan in its stead, is
        // closer than the rest. Both lie in the ball around the removed part.
        let reach = gone.iter().flatten().map(|&v| mesh.vertices()[v as usize].distance(center));
        let reach = reach.fold(0.0, f64::max);
        let near = f64::from(built.asset.voxelmap.error_bounds().in_band);
        check(&built, near, |p| exact_penetration(&mesh, p), |p| {
            p.distance(center) - reach <= exact_penetration(&mesh, p).abs() + 1e-9
        })?;
    }
}

#[test]
fn a_cavity_stays_hollow_and_an_inner_part_is_swallowed() {
    let outer = Mesh::icosphere(0.5, 3).unwrap();
    let inner = Mesh::icosphere(0.2, 2).unwrap();
    let hollow = built(&together(&outer, &turned(&inner)), Sign::Winding);
    assert!(hollow.repairs.is_none());
    let solid = built(&together(&outer, &inner), Sign::Winding);
    assert!(solid.repairs.merged);
    let filled = built(&together(&outer, &turned(&inner)), Sign::Fill);
    assert_eq!(filled.repairs.hidden_faces, inner.triangles().len());
    let at_center = |built: &BuildOutput| {
        let map = &built.asset.voxelmap;
        map.center_penetration(map.grid().voxel_at(vps_core::Vec3::ZERO))
    };
    assert!(at_center(&hollow) < -0.1);
    assert!(at_center(&solid) > 0.4 && at_center(&filled) > 0.4);
    let volume = |built: &BuildOutput| built.asset.mass.volume;
    let expected = volume(&built(&outer, Sign::Winding));
    let hole = volume(&built(&inner, Sign::Winding));
    assert!((volume(&hollow) - (expected - hole)).abs() < 1e-4 * expected);
    assert!((volume(&filled) - expected).abs() < 1e-4 * expected);
    assert!((volume(&solid) - expected).abs() < 1e-4 * expected);
}

#[test]
fn parts_beside_each_other_are_each_turned_outwards() {
    let ball = Mesh::icosphere(0.3, 2).unwrap();
    let apart = together(&ball, &turned(&moved(&ball, DVec3::X)));
    let built = built(&apart, Sign::Winding);
    assert_eq!(built.repairs.turned_faces, ball.triangles().len());
    let exact =
        |p: DVec3| exact_penetration(&ball, p).max(exact_penetration(&moved(&ball, DVec3::X), p));
    let near = f64::from(built.asset.voxelmap.error_bounds().in_band);
    check(&built, near, exact, |_| false).unwrap();
}

/// Two boxes that overlap are one solid, without walls of either inside the other.
#[test]
fn overlapping_parts_are_one_solid() {
    let a = Mesh::cuboid([1.0, 0.4, 0.4]).unwrap();
    let b = Mesh::cuboid([0.4, 1.0, 0.4 - 1e-3]).unwrap();
    let built = built(&together(&a, &b), Sign::Winding);
    assert!(built.repairs.merged);
    let map = &built.asset.voxelmap;
    let center = map.center_penetration(map.grid().voxel_at(vps_core::Vec3::ZERO));
    // The inner walls would be 0.2 m away, too, but not along the arms.
    assert!((center - 0.2).abs() < 0.03);
    let arm = map.center_penetration(map.grid().voxel_at(vps_core::Vec3::new(0.19, 0.0, 0.0)));
    assert!(arm > 0.15, "{arm}");
    let volume = 0.16 + 0.399 * (0.4 - 0.16);
    assert!((built.asset.mass.volume / volume - 1.0).abs() < 1e-5);
}

/// A wall of randomly oriented triangles is a solid by flood fill, not by winding numbers.
#[test]
fn faces_apart_and_turned_at_random_are_filled() {
    let ball = Mesh::icosphere(0.5, 3).unwrap();
    // No two triangles share a vertex position: each is shrunk a little about its centroid.
    let mut vertices = Vec::new();
    for (i, t) in ball.triangles().iter().enumerate() {
        let corners = t.map(|v| ball.vertices()[v as usize]);
        let middle = corners.iter().sum::<DVec3>() / 3.0;
        let mut corners = corners.map(|v| middle + (v - middle) * (1.0 - 1e-6));
        if i % 3 == 0 {
            corners.reverse();
        }
        vertices.extend(corners);
    }
    let triangles: Vec<_> = (0..vertices.len() as u32 / 3)
        .map(|t| [3 * t, 3 * t + 1, 3 * t + 2])
        .collect();
    let soup = Mesh::new(&vertices, &triangles).unwrap();
    let filled = built(&soup, Sign::Fill);
    assert_eq!(filled.repairs.turned_faces, triangles.len().div_ceil(3));
    assert!(filled.repairs.left_open);
    assert!((filled.asset.mass.volume / (std::f32::consts::PI / 6.0) - 1.0).abs() < 0.03);
    let near = f64::from(filled.asset.voxelmap.error_bounds().in_band) + 1e-6;
    check(
        &filled,
        near,
        |p| exact_penetration(&ball, p),
        |p| (p.length() - 0.5).abs() < 0.005,
    )
    .unwrap();
}

/// A box from one corner to another, in an oblique direction. Its faces are cut along the other
/// diagonal if `flipped`.
fn askew_box(low: [f64; 3], high: [f64; 3], flipped: bool) -> Mesh {
    let turn = DQuat::from_euler(EulerRot::XYZ, 0.3, 0.7, 1.1);
    let (low, high) = (DVec3::from_array(low), DVec3::from_array(high));
    let cuboid = Mesh::cuboid((high - low).to_array()).unwrap();
    let vertices = cuboid.vertices().iter();
    let vertices: Vec<_> = vertices.map(|&v| turn * (v + low.midpoint(high))).collect();
    let quads = cuboid
        .triangles()
        .chunks_exact(2)
        .map(|t| [t[0][0], t[0][1], t[0][2], t[1][2]]);
    let triangles: Vec<_> = quads
        .flat_map(|[a, b, c, d]| {
            if flipped {
                [[a, b, d], [b, c, d]]
            } else {
                [[a, b, c], [a, c, d]]
            }
        })
        .collect();
    Mesh::new(&vertices, &triangles).unwrap()
}

fn depth(built: &BuildOutput, place: [f64; 3]) -> f64 {
    let turn = DQuat::from_euler(EulerRot::XYZ, 0.3, 0.7, 1.1);
    let place = (turn * DVec3::from_array(place)).as_vec3();
    f64::from(-built.asset.voxelmap.trilinear().signed_distance(place))
}

/// Boxes that share a face, or a part of it with corners of both, whichever way its two sides are
/// cut, have no wall between them.
#[test]
fn boxes_that_share_corners_have_no_wall_between_them() {
    let first = askew_box([0.0; 3], [1.0; 3], false);
    for (high, joint, right) in [
        ([2.0, 1.0, 1.0], [1.0, 0.5, 0.5], 0.5),
        ([2.0, 0.5, 1.0], [1.0, 0.25, 0.5], 0.25),
        ([2.0, 0.5, 0.5], [1.0, 0.25, 0.25], 0.25),
    ] {
        for flipped in [false, true] {
            let second = askew_box([1.0, 0.0, 0.0], high, flipped);
            let both = built(&together(&first, &second), Sign::Auto);
            let voxel = f64::from(both.asset.voxelmap.grid().voxel_size());
            let found = depth(&both, joint);
            assert!((found - right).abs() < voxel, "{high:?} {flipped}: {found}");
            let volume = 1.0 + (high[0] - 1.0) * high[1] * high[2];
            assert!((f64::from(both.asset.mass.volume) - volume).abs() < 1e-4 * volume);
        }
    }
}

/// Mirrored bodies are turned even if others are open, share a face with them or enclose them.
#[test]
fn mirrored_bodies_are_turned_beside_open_ones() {
    let volume = |mesh: &Mesh| f64::from(built(mesh, Sign::Auto).asset.mass.volume);
    let unit = askew_box([0.0; 3], [1.0; 3], false);
    for flipped in [false, true] {
        let beside = turned(&askew_box([1.0, 0.0, 0.0], [2.0, 1.0, 1.0], flipped));
        let both = together(&unit, &beside);
        let both = volume(&both);
        assert!((both - 2.0).abs() < 1e-3, "{flipped}: {both}");
    }
    let away = turned(&askew_box([3.0, 0.2, 0.2], [4.0, 0.8, 0.8], false));
    let cavity = turned(&askew_box([0.25; 3], [0.75; 3], false));
    let core = turned(&askew_box([0.4; 3], [0.6; 3], false));
    for face in 0..6 {
        let left = (0..12)
            .filter(|t| t / 2 != face)
            .map(|t| unit.triangles()[t]);
        let open = Mesh::new(unit.vertices(), &left.collect::<Vec<_>>()).unwrap();
        let both = volume(&together(&open, &away));
        assert!((both - 1.36).abs() < 1e-3, "{face}: {both}");
        let hollow = together(&open, &cavity);
        assert!((volume(&hollow) - 0.875).abs() < 1e-3, "{face}");
        assert!((volume(&turned(&hollow)) - 0.875).abs() < 1e-3, "{face}");
        assert!(
            (volume(&together(&hollow, &core)) - 0.883).abs() < 1e-3,
            "{face}"
        );
    }
}

/// A leading facet of zero extent encloses nothing and closes nothing.
#[test]
fn a_collapsed_facet_may_stand_before_an_open_box() {
    let unit = askew_box([0.0; 3], [1.0; 3], false);
    let vertices = [&[DVec3::ZERO, DVec3::splat(0.5)], unit.vertices()].concat();
    let box_ = unit.triangles()[1..].iter().map(|t| t.map(|v| v + 2));
    let triangles: Vec<_> = [[0, 0, 1]].into_iter().chain(box_).collect();
    let built = built(&Mesh::new(&vertices, &triangles).unwrap(), Sign::Auto);
    assert!((built.asset.mass.volume - 1.0).abs() < 1e-5);
}

/// A surface with two coincident sides encloses nothing, however it is cut. Nor does an open one
/// that is flat up to noise, wherever the voxels lie.
#[test]
fn meshes_without_an_inside_are_refused() {
    let (outside, inside) = (
        askew_box([0.0; 3], [1.0; 3], false),
        askew_box([0.0; 3], [1.0; 3], true),
    );
    let both = together(&outside, &turned(&inside));
    let error = build(&both, &options(Sign::Auto), &|_| ()).err();
    assert!(matches!(error, Some(BuildError::NotSolid)), "{error:?}");
    for (noise, turn) in [(1e-6, 0.0), (1e-4, 0.0), (1e-4, 0.3), (1e-2, 0.0)] {
        let turn = DQuat::from_rotation_x(turn);
        let n = 12;
        let at = |i: u32, j: u32| {
            let up = noise * f64::from((7 * i + 5 * j) % 3);
            turn * DVec3::new(f64::from(i) / f64::from(n), f64::from(j) / f64::from(n), up)
        };
        let vertices: Vec<_> = (0..=n)
            .flat_map(|i| (0..=n).map(move |j| at(i, j)))
            .collect();
        let cells = (0..n).flat_map(|i| (0..n).map(move |j| i * (n + 1) + j));
        let triangles = cells.flat_map(|v| [[v, v + n + 1, v + 1], [v + 1, v + n + 1, v + n + 2]]);
        let sheet = Mesh::new(&vertices, &triangles.collect::<Vec<_>>()).unwrap();
        let error = build(&sheet, &options(Sign::Auto), &|_| ()).err();
        let is_refused = matches!(error, Some(BuildError::NotSolid | BuildError::Sheet { .. }));
        assert!(is_refused, "{noise}: {error:?}");
    }
}

/// Parts joined across a gap leave no slivers on which a point could not project, and no spurious
/// walls.
#[test]
fn parts_joined_across_rounding_have_points_and_no_thin_walls() {
    let rounded = |mesh: Mesh| {
        let vertices = mesh.vertices().iter().map(|&v| (v * 1e9).round() / 1e9);
        Mesh::new(&vertices.collect::<Vec<_>>(), mesh.triangles()).unwrap()
    };
    let first = askew_box([0.0; 3], [1.0; 3], false);
    let second = askew_box([1.0, 0.2, 0.2], [2.0, 0.5, 0.5], false);
    let both = rounded(together(&first, &second));
    for points in [200, 1000, 10_000] {
        let options = BuildOptions {
            points: PointCount::About(points),
            ..options(Sign::Auto)
        };
        let built = build(&both, &options, &|_| ()).unwrap();
        assert!(built.repairs.merged);
        assert!(
            built.thin_walls.lost_fraction < 1e-3,
            "{:?}",
            built.thin_walls
        );
    }
}

#[test]
fn the_union_of_many_triangles_is_refused_before_it_takes_the_memory() {
    let ball = Mesh::icosphere(0.5, 5).unwrap();
    let both = together(&ball, &moved(&ball, DVec3::X * 0.4));
    let options = BuildOptions {
        memory_limit: 16 << 20,
        ..options(Sign::Auto)
    };
    let error = build(&both, &options, &|_| ()).err();
    assert!(
        matches!(error, Some(BuildError::UnionMemory { .. })),
        "{error:?}"
    );
}

#[test]
fn a_sheet_is_no_solid() {
    let v = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let sheet = Mesh::new(&v, &[[0, 1, 2]]).unwrap();
    for sign in [Sign::Auto, Sign::Winding, Sign::Generalized, Sign::Fill] {
        let error = build(&sheet, &options(sign), &|_| ()).err();
        assert!(matches!(error, Some(BuildError::Sheet { .. })), "{error:?}");
    }
    let none = Repairs::default();
    assert!(none.is_none());
}
