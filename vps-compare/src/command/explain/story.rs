//! The story of a pair: counts, the contacts that remain, and why others do not.

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;
use vps_core::Event;
use vps_rapier::{ContactEvent, PairContact, PairEvent};

use super::names::{self, KEPT, MERGED, NO_CONTACT, UNTESTED};
use super::scene::{Scene, mesh_name, point_index};

#[derive(Serialize)]
pub(super) struct Story {
    version: &'static str,
    pub(super) mesh_a: String,
    pub(super) mesh_b: String,
    pub(super) poses_file: String,
    /// The row of the pose, counted from 1.
    pub(super) row: usize,
    /// x, y, z in metres, and qx, qy, qz, qw.
    pub(super) pose: [f64; 7],
    pub(super) prediction_m: f64,
    /// The shells that were asked.
    pub(super) shells: Vec<ShellStory>,
    /// The contacts that an engine gets.
    pub(super) contacts: Vec<KeptContact>,
}

/// What happened to a shell.
#[derive(Serialize)]
pub(super) struct ShellStory {
    /// The mesh it belongs to.
    pub(super) shell: &'static str,
    #[serde(skip)]
    pub(super) is_first: bool,
    pub(super) searches: u32,
    pub(super) levels: Vec<LevelCounts>,
    /// Number of all its points.
    pub(super) points: usize,
    /// Number of points that a search tested.
    pub(super) points_tested: usize,
    /// Number of tests; a point may be tested by several searches.
    pub(super) tests: usize,
    /// Number of points by what became of them.
    pub(super) outcomes: BTreeMap<&'static str, usize>,
    /// What became of each point.
    #[serde(skip)]
    pub(super) outcome_of_points: Vec<&'static str>,
}

/// The clusters of a level of a tree, and how often they were bounded, pruned and descended into.
#[derive(Clone, Serialize)]
pub(super) struct LevelCounts {
    pub(super) level: u32,
    pub(super) clusters: usize,
    pub(super) bounded: usize,
    pub(super) pruned: usize,
    pub(super) descended: usize,
}

#[derive(Serialize)]
pub(super) struct KeptContact {
    pub(super) shell: &'static str,
    pub(super) point: Option<u32>,
    pub(super) penetration_m: f32,
    /// Its point on the surface of the shell's mesh, in the frame of A.
    pub(super) position_m: [f64; 3],
    /// Unit normal out of A, in the frame of A.
    pub(super) normal: [f32; 3],
    /// Why its normal is not that of the field, if it is not.
    pub(super) normal_turned: Option<&'static str>,
}

impl Story {
    pub(super) fn of(scene: &Scene, events: &[PairEvent]) -> Self {
        let pose = scene.pose;
        let [x, y, z] = pose.translation.to_array();
        let [qx, qy, qz, qw] = pose.rotation.to_array();
        let [mesh_a, mesh_b] = scene.files.clone();
        let shells = [true, false].map(|is_first| ShellStory::of(scene, events, is_first));
        Self {
            version: env!("CARGO_PKG_VERSION"),
            mesh_a,
            mesh_b,
            poses_file: scene.poses_file.clone(),
            row: scene.row,
            pose: [x, y, z, qx, qy, qz, qw],
            prediction_m: scene.prediction_m,
            shells: shells.into_iter().filter(|s| s.searches > 0).collect(),
            contacts: kept_contacts(scene, events),
        }
    }
}

impl ShellStory {
    fn of(scene: &Scene, events: &[PairEvent], is_first: bool) -> Self {
        let tree = scene.tree(is_first);
        let levels = 1..=tree.level_count();
        let mut levels: Vec<_> = levels
            .map(|level| LevelCounts {
                level,
                clusters: tree.level(level).len(),
                bounded: 0,
                pruned: 0,
                descended: 0,
            })
            .collect();
        let mut outcome_of_points = vec![UNTESTED; tree.point_count()];
        let (mut searches, mut tests, mut tested) = (0, 0, BTreeSet::new());
        for event in events {
            match *event {
                PairEvent::ShellQuery {
                    shell_is_first,
                    event,
                } if shell_is_first == is_first => match event {
                    Event::SearchStarted { .. } => searches += 1,
                    Event::SearchEnded => {}
                    Event::ClusterBounded { level, .. } => levels[level as usize - 1].bounded += 1,
                    Event::ClusterPruned { level, .. } => levels[level as usize - 1].pruned += 1,
                    Event::ClusterDescended { level, .. } => {
                        levels[level as usize - 1].descended += 1;
                    }
                    Event::PointTested { point_index, .. } => {
                        tests += 1;
                        tested.insert(point_index);
                        outcome_of_points[point_index as usize] = NO_CONTACT;
                    }
                    Event::ContactReduced { contact, fate } => {
                        outcome_of_points[contact.point_index as usize] = names::of_fate(fate);
                    }
                },
                PairEvent::Contact { contact, event, .. } if contact.shell_is_first == is_first => {
                    let outcome = match event {
                        ContactEvent::Found | ContactEvent::NormalTurned { .. } => continue,
                        ContactEvent::Merged => MERGED,
                        ContactEvent::Dropped(reason) => names::of_drop(reason),
                        ContactEvent::Kept => KEPT,
                    };
                    if let Some(point) = point_index(&contact) {
                        outcome_of_points[point as usize] = outcome;
                    }
                }
                _ => {}
            }
        }
        let mut outcomes = BTreeMap::new();
        for outcome in &outcome_of_points {
            *outcomes.entry(*outcome).or_default() += 1;
        }
        Self {
            shell: mesh_name(is_first),
            is_first,
            searches,
            levels,
            points: tree.point_count(),
            points_tested: tested.len(),
            tests,
            outcomes,
            outcome_of_points,
        }
    }
}

fn kept_contacts(scene: &Scene, events: &[PairEvent]) -> Vec<KeptContact> {
    let mut turned = Vec::new();
    let mut kept = Vec::new();
    for event in events {
        let PairEvent::Contact { contact, event, .. } = event else {
            continue;
        };
        match event {
            ContactEvent::NormalTurned { reason, .. } => turned.push((contact.ids, reason)),
            ContactEvent::Kept => kept.push(contact),
            _ => {}
        }
    }
    let reason = |contact: &PairContact| {
        // The last turn counts.
        let turn = turned.iter().rev().find(|(ids, _)| *ids == contact.ids);
        turn.map(|(_, reason)| names::of_turn(**reason))
    };
    kept.into_iter()
        .map(|contact| {
            let is_first = contact.shell_is_first;
            let on_shell = contact.points[usize::from(!is_first)];
            KeptContact {
                shell: mesh_name(is_first),
                point: point_index(contact),
                penetration_m: contact.penetration,
                position_m: scene.position(is_first, on_shell).to_array(),
                normal: contact.normals[0].to_array(),
                normal_turned: reason(contact),
            }
        })
        .collect()
}
