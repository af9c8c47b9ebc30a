//! Every query against a brute-force test of all points.

use proptest::prelude::*;
use vps_build::{Encoding, Mesh};
use vps_core::raw::Points;
use vps_core::{
    Approach, Asset, Ball, Body, BodyPair, Capsule, Contact, ContactManifold, Cuboid, Cylinder,
    DistanceField, FieldFn, HalfSpace, LinearWrench, Mat3, Pose3, Query, Shells, Sweep, Vec3,
    Voxelmap, Weight, Work, Wrench,
};

use crate::poses::pose;
use crate::support::{asset, asset_of, bumpy_mesh, cases, density, encoding, vector};

fn contacts<F: DistanceField + ?Sized>(query: &Query<'_, F>) -> Vec<Contact> {
    let mut contacts = Vec::new();
    query.for_each_contact(|c| contacts.push(c));
    contacts
}

fn flat_contacts<F: DistanceField + ?Sized>(query: &Query<'_, F>) -> Vec<Contact> {
    let mut contacts = Vec::new();
    query.for_each_contact_flat(|c| contacts.push(c));
    contacts
}

/// The deepest contact, the first of equally deep ones.
fn deepest<'c>(contacts: impl IntoIterator<Item = &'c Contact>) -> Option<Contact> {
    let deeper = |best: Option<Contact>, c: &Contact| match best {
        Some(b) if b.penetration >= c.penetration => Some(b),
        _ => Some(*c),
    };
    contacts.into_iter().fold(None, deeper)
}

/// Eqs. 2 and 3 in 64 bits, and the magnitude of the summands.
fn wrench_of(
    shell: &Asset<'_>,
    contacts: &[Contact],
    center: Vec3,
    weight: Weight,
) -> (Wrench, f32) {
    let (mut force, mut torque, mut size) = (glamx::DVec3::ZERO, glamx::DVec3::ZERO, 0.0);
    for c in contacts.iter().filter(|c| c.penetration > 0.0) {
        let weight = match weight {
            Weight::Point => 1.0,
            Weight::Area => f64::from(shell.tree.area(c.point_index as usize)),
        };
        let f = c.normal.as_dvec3() * f64::from(c.penetration) * weight;
        force += f;
        torque += (c.position - center).as_dvec3().cross(f);
        size += f.length();
    }
    let wrench = Wrench {
        force: force.as_vec3(),
        torque: torque.as_vec3(),
    };
    (wrench, size as f32)
}

/// The manifold found by the search is the one reduced from a list of all contacts.
fn check_manifold<F: DistanceField + ?Sized, const N: usize>(
    query: &Query<'_, F>,
    field: &F,
    pose: Pose3,
    prediction: f32,
    flat: &[Contact],
) -> Result<(), TestCaseError> {
    let Some(deepest) = deepest(flat) else {
        prop_assert!(query.manifold::<N>().contacts().is_empty());
        return Ok(());
    };
    // Rotated as in the query, to the bit.
    let rotation = Mat3::from_quat(pose.rotation);
    let at = rotation * deepest.position + pose.translation;
    let inward = rotation.transpose() * field.inward_direction(at);
    let along = if inward == Vec3::ZERO {
        -deepest.normal
    } else {
        inward
    };
    let approaches = [
        Approach::RESTING,
        Approach::Moved(0.3 * prediction),
        Approach::Unknown,
    ];
    for approach in approaches {
        let listed = ContactManifold::<N>::reduce(flat, along, prediction, approach);
        prop_assert_eq!(query.with_approach(approach).manifold::<N>(), listed);
    }
    Ok(())
}

/// All queries of one field agree with brute force.
fn check_query<F: DistanceField + ?Sized>(
    shell: &Asset<'_>,
    field: &F,
    pose: Pose3,
    prediction: f32,
) -> Result<(), TestCaseError> {
    let tree = &shell.tree;
    let query = Query::new(tree, field, pose).with_prediction(prediction);
    let flat = flat_contacts(&query);
    // The batch query of all points agrees with that of each point.
    let tolerance = 1e-5;
    let mut expected = flat.iter().peekable();
    for i in 0..tree.point_count() {
        let at = pose.transform_point(tree.point(i));
        let alone = field.penetration(at, pose.rotation * tree.normal(i));
        if let Some(c) = expected.next_if(|c| c.point_index as usize == i) {
            // Where the field jumps between voxels, rounding of the position may decide.
            let off = (alone - c.penetration).abs();
            prop_assert!(
                off <= tolerance + field.error_bound(),
                "{i}: {alone}, {c:?}"
            );
        } else {
            prop_assert!(alone <= -prediction + tolerance + field.error_bound());
        }
    }
    prop_assert_eq!(&contacts(&query), &flat);
    prop_assert_eq!(query.touches(), !flat.is_empty());
    prop_assert_eq!(query.deepest(), deepest(&flat));
    let all = flat_contacts(&query.with_prediction(f32::INFINITY));
    prop_assert_eq!(query.closest(), deepest(&all));

    for level in 1..=tree.level_count() {
        let mut found = Vec::new();
        query.for_each_segment(level, |segment, contact| found.push((segment, contact)));
        let mut expected = Vec::new();
        for (segment, cluster) in tree.level(level).iter().enumerate() {
            let below = tree.points_below(level, cluster);
            let own = flat
                .iter()
                .filter(|c| below.contains(&(c.point_index as usize)));
            expected.extend(deepest(own).map(|c| (segment as u32, c)));
        }
        prop_assert_eq!(found, expected);
    }

    let center = shell.mass.center();
    for weight in [Weight::Point, Weight::Area] {
        let (expected, size) = wrench_of(shell, &flat, center, weight);
        let wrench = query.wrench(center, weight);
        let tolerance = 1e-5 * size;
        prop_assert!((wrench.force - expected.force).length() <= tolerance);
        prop_assert!((wrench.torque - expected.torque).length() <= tolerance);
        let linear = query.linear_wrench(center, weight);
        check_linear_wrench(&linear, shell, field, pose, &flat, center, weight)?;
    }

    check_manifold::<_, 5>(&query, field, pose, prediction, &flat)?;
    let manifold = query.manifold::<5>();
    let deep = query.deepest().map_or(u32::MAX, |c| c.point_index);
    for hint in [0, tree.point_count() as u32 / 2, deep] {
        let hinted = query.with_hint(hint);
        prop_assert_eq!(hinted.touches(), query.touches());
        prop_assert_eq!(hinted.deepest(), query.deepest());
        prop_assert_eq!(hinted.manifold::<5>(), manifold);
    }
    check_time_critical(&query, center, &flat)?;

    let work = Work::default();
    prop_assert_eq!(query.observed_by(&work).deepest(), query.deepest());
    prop_assert!(work.spheres() > 0 && work.points() <= tree.point_count() as u64);
    Ok(())
}

/// Forces along the gradients of the field, and their derivatives, contact by contact.
fn check_linear_wrench<F: DistanceField + ?Sized>(
    linear: &LinearWrench,
    shell: &Asset<'_>,
    field: &F,
    pose: Pose3,
    contacts: &[Contact],
    center: Vec3,
    weight: Weight,
) -> Result<(), TestCaseError> {
    let (displacement, turn) = (Vec3::new(0.3, -0.5, 0.8), Vec3::new(-0.7, 0.2, 0.4));
    // Rotated as in the query, to the bit.
    let rotation = Mat3::from_quat(pose.rotation);
    let zero = glamx::DVec3::ZERO;
    let (mut force, mut torque, mut size) = (zero, zero, 0.0);
    let (mut pushed, mut turned, mut pushed_size) = (zero, zero, 0.0);
    for c in contacts.iter().filter(|c| c.penetration > 0.0) {
        let at = Points::splat(rotation * c.position + pose.translation);
        let normal = Points::splat(rotation * c.normal);
        let gradient = field.penetrations_and_gradients(&at, &normal).1.get(0);
        let normal = (rotation.transpose() * -gradient).as_dvec3();
        let weight = match weight {
            Weight::Point => 1.0,
            Weight::Area => f64::from(shell.tree.area(c.point_index as usize)),
        };
        let arm = (c.position - center).as_dvec3();
        let f = weight * f64::from(c.penetration) * normal;
        pushed += f;
        turned += arm.cross(f);
        pushed_size += f.length();
        let moved = displacement.as_dvec3() + turn.as_dvec3().cross(arm);
        let f = -weight * normal.dot(moved) * normal;
        force += f;
        torque += arm.cross(f);
        size += weight;
    }
    let tolerance = 1e-5 * pushed_size as f32;
    prop_assert!((linear.wrench.force - pushed.as_vec3()).length() <= tolerance);
    prop_assert!((linear.wrench.torque - turned.as_vec3()).length() <= tolerance);
    let tolerance = 1e-4 * size as f32;
    let [t, m, r] = [linear.translational, linear.mixed, linear.rotational];
    let changed = -(t * displacement + m.transpose() * turn);
    prop_assert!((changed - force.as_vec3()).length() <= tolerance);
    let changed = -(m * displacement + r * turn);
    prop_assert!((changed - torque.as_vec3()).length() <= tolerance);
    Ok(())
}

/// More time never gives less, and enough time gives everything.
fn check_time_critical<F: DistanceField + ?Sized>(
    query: &Query<'_, F>,
    center: Vec3,
    flat: &[Contact],
) -> Result<(), TestCaseError> {
    let deepest = deepest(flat);
    let (mut depth, mut bound, mut level) = (f32::NEG_INFINITY, f32::INFINITY, 0);
    for budget in [0, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, u64::MAX] {
        let estimate = query.time_critical(center, |tested| tested < budget);
        let found = estimate
            .deepest
            .map_or(f32::NEG_INFINITY, |d| d.penetration);
        prop_assert!(
            found >= depth && estimate.penetration_bound <= bound && estimate.level >= level
        );
        (depth, bound, level) = (found, estimate.penetration_bound, estimate.level);
        if let Some(deepest) = deepest {
            prop_assert!(bound >= deepest.penetration);
        }
        if budget == u64::MAX {
            prop_assert!(estimate.is_complete);
        }
        if estimate.is_complete {
            prop_assert_eq!(estimate.deepest, deepest);
            prop_assert_eq!(estimate.wrench, query.wrench(center, Weight::Area));
        }
    }
    Ok(())
}

/// All samplings of a map, and other kinds of fields.
fn check_all_fields(
    shell: &Asset<'_>,
    map: &Voxelmap<'_>,
    pose: Pose3,
    prediction: f32,
) -> Result<(), TestCaseError> {
    let bounds = Ball::new(0.4).bounds();
    let function = FieldFn::new(|p: Vec3| 0.4 - p.length(), 1.0, bounds, 1e-6);
    // One is compiled as a whole, the others are called dynamically.
    check_query(shell, &map.trilinear(), pose, prediction)?;
    let others: [&dyn DistanceField; 9] = [
        &map.local(),
        &map.linear(),
        &map.trilinear(),
        &Ball::new(0.4),
        &Cuboid::new(Vec3::new(0.5, 0.1, 0.4)),
        &HalfSpace::new(Vec3::new(0.1, 1.0, 0.0)),
        &Capsule::new(0.3, 0.2),
        &Cylinder::new(0.2, 0.4),
        &function,
    ];
    for field in others {
        check_query(shell, field, pose, prediction)?;
    }
    Ok(())
}

proptest! {
    #![proptest_config(cases(48))]

    #[test]
    fn all_queries_give_what_brute_force_gives(
        shell in bumpy_mesh(),
        field in bumpy_mesh(),
        points in 1..600_u32,
        encoding in encoding(),
        density in density(),
        poses in prop::collection::vec((pose(0.9), 0.0..0.05_f32), 8),
    ) {
        let shell = asset(&shell, points, Encoding::Distances(None));
        let field = asset_of(&field, 10, encoding, density);
        for (pose, prediction) in poses {
            check_all_fields(&shell, &field.voxelmap, pose, prediction)?;
        }
    }

    /// With many contacts, not all are kept while the deepest is searched for.
    #[test]
    fn manifolds_of_thousands_of_contacts_are_those_of_a_list(
        shell in bumpy_mesh(),
        poses in prop::collection::vec((pose(0.9), 0.0..0.3_f32), 8),
    ) {
        let shell = asset(&shell, 5000, Encoding::Distances(None));
        let map = shell.voxelmap.trilinear();
        let cuboid = Cuboid::new(Vec3::splat(0.8));
        for (pose, prediction) in poses {
            let query = Query::new(&shell.tree, &map, pose).with_prediction(prediction);
            check_manifold::<_, 8>(&query, &map, pose, prediction, &flat_contacts(&query))?;
            let query = Query::new(&shell.tree, &cuboid, pose).with_prediction(prediction);
            check_manifold::<_, 8>(&query, &cuboid, pose, prediction, &flat_contacts(&query))?;
        }
    }

    /// Moving both bodies together changes nothing, up to rounding.
    #[test]
    fn a_common_motion_changes_nothing(
        shell in bumpy_mesh(), field in bumpy_mesh(),
        a in pose(0.6), b in pose(0.6), motion in pose(5.0),
    ) {
        let shell = asset(&shell, 400, Encoding::Distances(None));
        let field = asset(&field, 10, Encoding::Distances(None));
        let trilinear = field.voxelmap.trilinear();
        let before = Query::new(&shell.tree, &trilinear, b.inv_mul(&a));
        let (moved_a, moved_b) = (motion * a, motion * b);
        let after = Query::new(&shell.tree, &trilinear, moved_b.inv_mul(&moved_a));
        let tolerance = 1e-4;
        let (before_all, after_all) = (contacts(&before), contacts(&after));
        for (these, those) in [(&before_all, &after_all), (&after_all, &before_all)] {
            for c in these.iter().filter(|c| c.penetration > tolerance) {
                let same = those.iter().find(|d| d.point_index == c.point_index);
                prop_assert!(same.is_some_and(|d| (d.penetration - c.penetration).abs() < tolerance));
            }
        }
        let [w, v] = [before, after].map(|q| q.wrench(Vec3::ZERO, Weight::Point));
        let tolerance = tolerance * (1 + before_all.len()) as f32;
        prop_assert!((w.force - v.force).length() < tolerance);
        prop_assert!((w.torque - v.torque).length() < tolerance);
    }

    /// The second body feels the reaction to the force on the first one.
    #[test]
    fn swapping_the_bodies_negates_the_force(
        a in bumpy_mesh(), b in bumpy_mesh(), pose in pose(0.6), prediction in 0.0..0.05_f32,
    ) {
        let a = asset(&a, 300, Encoding::Distances(None));
        let b = asset(&b, 200, Encoding::Distances(None));
        let back = pose.inverse();
        for shells in [Shells::FewerPoints, Shells::First, Shells::Second, Shells::Both] {
            let swapped = match shells {
                Shells::First => Shells::Second,
                Shells::Second => Shells::First,
                other => other,
            };
            let ab = BodyPair::new(Body::of_asset(&a), Body::of_asset(&b), pose)
                .with_shells(shells)
                .with_prediction(prediction);
            let ba = BodyPair::new(Body::of_asset(&b), Body::of_asset(&a), back)
                .with_shells(swapped)
                .with_prediction(prediction);
            let (mut these, mut those) = (0, 0);
            ab.for_each_contact(|_| these += 1);
            ba.for_each_contact(|_| those += 1);
            // Contacts just within the prediction distance may be lost to rounding.
            let near = i32::abs(these - those);
            prop_assert!(near <= 3);
            let on_a = ab.wrench_on_first(Vec3::ZERO, Weight::Area);
            // About the same point, in the frame of the other body, and back.
            let on_b = ba.wrench_on_first(back.translation, Weight::Area);
            let tolerance = 1e-5;
            prop_assert!((on_a.force + pose.rotation * on_b.force).length() < tolerance);
            prop_assert!((on_a.torque + pose.rotation * on_b.torque).length() < tolerance);
            let depth = |c: Option<vps_core::PairContact>| c.map_or(-prediction, |c| c.penetration);
            prop_assert!((depth(ab.deepest()) - depth(ba.deepest())).abs() < 1e-5);
            prop_assert_eq!(ab.touches(), ab.deepest().is_some());
        }
    }

    /// No contact along the motion is missed, and none is found too late.
    #[test]
    fn sweeps_find_the_first_contact(
        shell in bumpy_mesh(), field in bumpy_mesh(), start in pose(1.5), displacement in vector(3.0),
        turn in pose(0.1),
    ) {
        let shell = asset(&shell, 150, Encoding::Distances(None));
        let field = asset(&field, 10, Encoding::Distances(None));
        let field = field.voxelmap.trilinear();
        let end = Pose3::from_parts(start.translation + displacement, turn.rotation * start.rotation);
        let sweep = Sweep::new(&shell.tree, &field, start, end);
        let reached = sweep.pose_at(1.0);
        prop_assert!(reached.translation.distance(end.translation) < 1e-5);
        prop_assert!(reached.rotation.dot(end.rotation).abs() > 0.9999);
        let touches = |time: f32| {
            Query::new(&shell.tree, &field, sweep.pose_at(time)).touches()
        };
        let first = (0..=200).map(|i| i as f32 / 200.0).find(|&t| touches(t));
        let tolerance = 1e-3;
        match (sweep.first_contact(tolerance), first) {
            (None, first) => prop_assert_eq!(first, None),
            (Some(impact), None) => {
                // Between two sampled times, or grazing.
                let gap = -impact.closest.penetration;
                prop_assert!(gap < 0.1, "{gap}");
            }
            (Some(impact), Some(first)) => {
                prop_assert!(impact.time <= first);
                prop_assert!(!touches(0.0) || impact.time == 0.0);
                // Free up to there.
                let before = (0..50).map(|i| impact.time * i as f32 / 50.0);
                prop_assert!(impact.time == 0.0 || before.into_iter().all(|t| !touches(t)));
                // And close to the solid: interpolation is steeper by √3 at most.
                prop_assert!(impact.closest.penetration > -2.0 * tolerance);
            }
        }
    }
}

/// The shell of the inner body is queried, whichever has fewer points.
#[test]
fn a_body_within_another_is_found() {
    let block = Mesh::cuboid([1.0, 0.8, 0.6]).unwrap();
    let ball = Mesh::icosphere(0.08, 3).unwrap();
    let mut corners = block.vertices().to_vec();
    corners.extend(block.scaled(0.7).unwrap().vertices());
    let turned = block
        .triangles()
        .iter()
        .map(|&[a, b, c]| [a + 8, c + 8, b + 8]);
    let triangles: Vec<_> = block.triangles().iter().copied().chain(turned).collect();
    let hollow = Mesh::new(&corners, &triangles).unwrap();
    for (of_outer, of_inner) in [(100, 900), (900, 100)] {
        let [outer, hollow] =
            [&block, &hollow].map(|m| asset(m, of_outer, Encoding::Distances(None)));
        let inner = asset(&ball, of_inner, Encoding::Distances(None));
        // 0.15 m below a face: its lowest point is 0.23 m deep. In the hollow one it touches
        // nothing.
        let at = Pose3::from_translation(Vec3::new(0.05, 0.25, -0.02));
        let middle = Pose3::from_translation(Vec3::new(0.02, 0.01, 0.0));
        for swapped in [false, true] {
            let pair = |outer: &'_ Asset<'_>, pose: Pose3| {
                let (a, b) = (Body::of_asset(outer), Body::of_asset(&inner));
                let pair = if swapped {
                    BodyPair::new(b, a, pose.inverse())
                } else {
                    BodyPair::new(a, b, pose)
                };
                let up = pair.wrench_on_first(Vec3::ZERO, Weight::Area).force.y;
                (pair.touches(), pair.closest().unwrap().penetration, up)
            };
            let (touches, depth, up) = pair(&outer, at);
            let error = outer.voxelmap.trilinear().error_bound();
            assert!(touches && (depth - 0.23).abs() < error, "{depth}");
            // The body in the block goes up, the block goes down.
            assert!(if swapped { up > 0.0 } else { up < 0.0 }, "{up}");
            // Turned, and just below the face.
            let turn = vps_core::Quat::from_euler(glamx::EulerRot::XYZ, 0.8, 0.3, 0.6);
            let shallow = Pose3::from_parts(Vec3::new(0.05, 0.31, -0.02), turn);
            let (touches, depth, _) = pair(&outer, shallow);
            assert!(touches && (depth - 0.17).abs() < error, "{depth}");
            let (touches, depth, up) = pair(&hollow, middle);
            assert!(!touches && (depth + 0.13).abs() < error, "{depth}");
            assert_eq!(up, 0.0);
        }
    }
}

#[test]
fn broken_poses_give_no_contact() {
    let asset = asset(
        &Mesh::icosphere(0.5, 2).unwrap(),
        100,
        Encoding::Distances(None),
    );
    for broken in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let pose = Pose3::from_translation(Vec3::new(0.0, broken, 0.0));
        let turned =
            Pose3::from_parts(Vec3::ZERO, vps_core::Quat::from_xyzw(broken, 0.0, 0.0, 1.0));
        for pose in [pose, turned] {
            check_broken(&asset, &asset.voxelmap.trilinear(), pose);
            check_broken(&asset, &asset.voxelmap.linear(), pose);
            check_broken(&asset, &asset.voxelmap.local(), pose);
            check_broken(&asset, &HalfSpace::new(Vec3::Y), pose);
            check_broken(&asset, &Cuboid::new(Vec3::ONE), pose);
            let field = asset.voxelmap.trilinear();
            let sweep = Sweep::new(&asset.tree, &field, Pose3::IDENTITY, pose);
            assert_eq!(sweep.first_contact(1e-3), None);
            let sweep = Sweep::new(&asset.tree, &field, pose, Pose3::IDENTITY);
            assert_eq!(sweep.first_contact(1e-3), None);
        }
    }
}

fn check_broken(asset: &Asset<'_>, field: &dyn DistanceField, pose: Pose3) {
    for prediction in [0.0, 0.1, f32::INFINITY] {
        let query = Query::new(&asset.tree, field, pose).with_prediction(prediction);
        assert_eq!(query.deepest(), None);
        assert_eq!(query.closest(), None);
        assert!(!query.touches());
        assert!(contacts(&query).is_empty() && flat_contacts(&query).is_empty());
        assert!(query.manifold::<4>().contacts().is_empty());
        assert_eq!(query.wrench(Vec3::ZERO, Weight::Area), Wrench::default());
        assert_eq!(query.time_critical(Vec3::ZERO, |_| true).deepest, None);
        query.for_each_segment(2, |_, _| panic!("a contact"));
    }
}
