//! Observers see exactly what queries do, and change nothing.

use std::cell::RefCell;

use proptest::prelude::*;
use vps_build::Encoding;
use vps_core::{
    Approach, Contact, ContactManifold, Cuboid, DistanceField, DropReason, Event, Fate,
    PointSphereTree, Pose3, Query, Score, Vec3, Weight, Work,
};

use crate::poses::pose;
use crate::support::{asset, bumpy_mesh, cases};

/// The events of a query, and its answer.
fn observed<T>(
    query: &Query<'_, dyn DistanceField + '_>,
    ask: impl FnOnce(&Query<'_, dyn DistanceField + '_, &dyn Fn(Event)>) -> T,
) -> (Vec<Event>, T) {
    let events = RefCell::new(Vec::new());
    let observer = |event| events.borrow_mut().push(event);
    let answer = ask(&query.observed_by(&observer as &dyn Fn(Event)));
    (events.into_inner(), answer)
}

/// The events of each search without those of searches within it, in the order in which they start.
fn searches(events: &[Event]) -> Vec<Vec<Event>> {
    let (mut searches, mut open) = (Vec::new(), Vec::new());
    for event in events {
        if let Event::SearchStarted { .. } = event {
            open.push(searches.len());
            searches.push(Vec::new());
        }
        // A hint is tested before any search, and contacts are reduced after all of them.
        if let Some(search) = open.last() {
            let events: &mut Vec<_> = &mut searches[*search];
            events.push(*event);
        }
        if *event == Event::SearchEnded {
            assert!(open.pop().is_some(), "a search ends that did not start");
        }
    }
    assert!(open.is_empty(), "a search does not end");
    searches
}

/// The points below a cluster, given by its index among all.
fn points_below(tree: &PointSphereTree<'_>, level: u32, cluster: u32) -> std::ops::Range<usize> {
    let clusters = tree.level_starts()[level as usize - 1]..tree.level_starts()[level as usize];
    assert!(
        clusters.contains(&cluster),
        "level {level} has no cluster {cluster}"
    );
    tree.points_below(level, &tree.clusters()[cluster as usize])
}

/// Each point is tested or below a pruned cluster, once; clusters are pruned and descended into for the
/// reason told.
fn check_search(tree: &PointSphereTree<'_>, events: &[Event]) -> Result<(), TestCaseError> {
    let Some(&Event::SearchStarted {
        cluster,
        level,
        last_level,
        ..
    }) = events.first()
    else {
        panic!("{events:?}");
    };
    prop_assert_eq!(last_level, tree.level_count());
    let mut times = vec![0; tree.point_count()];
    let mut decided = vec![false; tree.clusters().len()];
    for event in events {
        match *event {
            Event::ClusterPruned {
                cluster,
                level,
                bound,
                threshold,
            } => {
                prop_assert!(bound.is_nan() || bound < threshold);
                prop_assert!(!std::mem::replace(&mut decided[cluster as usize], true));
                points_below(tree, level, cluster).for_each(|point| times[point] += 1);
            }
            Event::ClusterDescended {
                cluster,
                level,
                bound,
                threshold,
            } => {
                prop_assert!(bound >= threshold);
                prop_assert!(!std::mem::replace(&mut decided[cluster as usize], true));
                points_below(tree, level, cluster);
            }
            Event::PointTested {
                point_index,
                penetration,
                threshold,
                is_kept,
            } => {
                prop_assert_eq!(is_kept, penetration >= threshold);
                times[point_index as usize] += 1;
            }
            _ => {}
        }
    }
    let below = points_below(tree, level, cluster);
    for (point, times) in times.into_iter().enumerate() {
        prop_assert_eq!(
            times,
            usize::from(below.contains(&point)),
            "point {}",
            point
        );
    }
    Ok(())
}

/// The fates of all contacts, in the order of the points.
fn check_fates<const N: usize>(
    events: &[Event],
    contacts: &[Contact],
    manifold: &ContactManifold<N>,
) -> Result<(), TestCaseError> {
    let fates: Vec<_> = events
        .iter()
        .filter_map(|event| match event {
            Event::ContactReduced { contact, fate } => Some((*contact, *fate)),
            _ => None,
        })
        .collect();
    let reduced: Vec<_> = fates.iter().map(|(contact, _)| *contact).collect();
    prop_assert_eq!(&reduced[..], contacts);
    let mut kept = vec![None; manifold.contacts().len()];
    let len = kept.len();
    for (contact, fate) in fates {
        match fate {
            Fate::Kept { rank } => {
                prop_assert_eq!(kept[rank as usize].replace(contact), None);
            }
            Fate::Merged { rank } => {
                prop_assert_eq!(
                    manifold.contacts()[rank as usize].position,
                    contact.position
                );
            }
            Fate::Dropped(DropReason::Full) => prop_assert_eq!(len, N),
            Fate::Dropped(DropReason::Planar) => prop_assert!(len == 4 && N > 4),
            Fate::Dropped(DropReason::LowWeight) => {
                let deepest = manifold.contacts()[0].penetration;
                prop_assert!(len >= N.min(4) && contact.penetration < deepest);
            }
            Fate::Dropped(_) => {}
        }
    }
    let kept: Vec<_> = kept.into_iter().flatten().collect();
    prop_assert_eq!(&kept[..], manifold.contacts());
    Ok(())
}

/// All queries of one field with and without an observer.
fn check(
    tree: &PointSphereTree<'_>,
    field: &dyn DistanceField,
    pose: Pose3,
    prediction: f32,
) -> Result<(), TestCaseError> {
    let query = Query::new(tree, field, pose).with_prediction(prediction);
    let mut contacts = Vec::new();
    query.for_each_contact(|contact| contacts.push(contact));

    let mut found = Vec::new();
    let (events, ()) = observed(&query, |q| {
        q.for_each_contact(|contact| found.push(contact));
    });
    prop_assert_eq!(&found, &contacts);
    prop_assert_eq!(searches(&events).len(), 1);
    check_search(tree, &events)?;
    // All that are kept are contacts.
    let kept = events.iter().filter_map(|event| match *event {
        Event::PointTested {
            point_index,
            is_kept: true,
            ..
        } => Some(point_index),
        _ => None,
    });
    let indices = contacts.iter().map(|contact| contact.point_index);
    prop_assert!(kept.eq(indices));

    let (events, deepest) = observed(&query, |q| q.deepest());
    prop_assert_eq!(deepest, query.deepest());
    check_search(tree, &events)?;
    let work = Work::default();
    query.observed_by(&work).deepest();
    let count = |is_it: fn(&Event) -> bool| events.iter().filter(|e| is_it(e)).count() as u64;
    prop_assert_eq!(
        work.spheres(),
        count(|e| matches!(e, Event::ClusterBounded { .. }))
    );
    prop_assert_eq!(
        work.points(),
        count(|e| matches!(e, Event::PointTested { .. }))
    );

    prop_assert_eq!(observed(&query, |q| q.touches()).1, query.touches());
    let weight = Weight::Area;
    let wrench = query.wrench(Vec3::ZERO, weight);
    prop_assert_eq!(observed(&query, |q| q.wrench(Vec3::ZERO, weight)).1, wrench);
    let estimate = query.time_critical(Vec3::ZERO, |tested| tested < 50);
    let (_, same) = observed(&query, |q| {
        q.time_critical(Vec3::ZERO, |tested| tested < 50)
    });
    prop_assert_eq!(same, estimate);

    // The outer search of segments goes down to their level, and the inner ones begin there.
    let (mut segments, mut same) = (Vec::new(), Vec::new());
    query.for_each_segment(2, |segment, contact| segments.push((segment, contact)));
    let (events, ()) = observed(&query, |q| q.for_each_segment(2, |s, c| same.push((s, c))));
    prop_assert_eq!(same, segments);
    for events in &searches(&events)[1..] {
        check_search(tree, events)?;
    }

    for approach in [Approach::RESTING, Approach::Unknown] {
        let query = query.with_approach(approach);
        check_manifold::<3>(tree, &query, &contacts)?;
        check_manifold::<4>(tree, &query, &contacts)?;
        check_manifold::<8>(tree, &query, &contacts)?;
    }
    Ok(())
}

fn check_manifold<const N: usize>(
    tree: &PointSphereTree<'_>,
    query: &Query<'_, dyn DistanceField + '_>,
    contacts: &[Contact],
) -> Result<(), TestCaseError> {
    let (events, manifold) = observed(query, |q| q.manifold::<N>());
    prop_assert_eq!(manifold, query.manifold::<N>());
    check_fates(&events, contacts, &manifold)?;
    let searches = searches(&events);
    // Whether the bodies may touch.
    let Event::SearchStarted {
        last_level: 1,
        score: Score::Penetration,
        ..
    } = searches[0][0]
    else {
        panic!("{events:?}");
    };
    for events in &searches[1..] {
        check_search(tree, events)?;
    }
    Ok(())
}

proptest! {
    #![proptest_config(cases(24))]

    #[test]
    fn observers_see_what_queries_do(
        mesh in bumpy_mesh(),
        points in 20..600_u32,
        pose in pose(0.9),
        prediction in prop_oneof![Just(0.0_f32), 0.0..0.3_f32],
    ) {
        let asset = asset(&mesh, points, Encoding::Distances(None));
        let tree = &asset.tree;
        check(tree, &asset.voxelmap.trilinear(), pose, prediction)?;
        check(tree, &asset.voxelmap.local(), pose, prediction)?;
        check(tree, &Cuboid::new(Vec3::new(0.7, 0.3, 0.7)), pose, prediction)?;
    }
}
