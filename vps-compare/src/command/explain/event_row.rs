//! Events as rows of a table.

use glamx::DVec3;
use serde::Serialize;
use vps_core::{Event, Score, Vec3};
use vps_rapier::{ContactEvent, PairContact, PairEvent};

use super::names::{self, KEPT, MERGED};
use super::scene::{Scene, mesh_name, point_index};

/// An event. What it does not have is empty.
#[derive(Clone, Debug, Default, Serialize)]
pub(super) struct EventRow {
    /// The mesh whose shell it is about.
    pub(super) shell: &'static str,
    /// The search of that shell it belongs to, counted from 1.
    pub(super) search: Option<u32>,
    pub(super) event: &'static str,
    pub(super) level: Option<u32>,
    /// Index of a cluster among all of the shell.
    pub(super) cluster: Option<u32>,
    /// Index of a point of the shell.
    pub(super) point: Option<u32>,
    /// Upper bound of the scores in a cluster, in metres for a search by penetration.
    pub(super) bound: Option<f32>,
    /// The lowest score or penetration that mattered.
    pub(super) threshold: Option<f32>,
    pub(super) penetration_m: Option<f32>,
    /// Why, or what a search goes by.
    pub(super) reason: &'static str,
    /// A point of the shell or, of a contact, of the surface it samples; in the frame of A.
    pub(super) x_m: Option<f64>,
    pub(super) y_m: Option<f64>,
    pub(super) z_m: Option<f64>,
    /// The normal of a contact out of A, in the frame of A; the new one if it is turned.
    pub(super) nx: Option<f32>,
    pub(super) ny: Option<f32>,
    pub(super) nz: Option<f32>,
}

impl EventRow {
    /// All events.
    pub(super) fn all(scene: &Scene, events: &[PairEvent]) -> Vec<Self> {
        let mut searches = [0, 0];
        let mut rows = Vec::new();
        for event in events {
            match *event {
                PairEvent::ShellQuery {
                    shell_is_first,
                    event,
                } => {
                    let search = &mut searches[usize::from(!shell_is_first)];
                    if let Event::SearchStarted { .. } = event {
                        *search += 1;
                    }
                    rows.push(Self::of_query(scene, shell_is_first, *search, event));
                }
                PairEvent::Contact { contact, event, .. } => {
                    rows.push(Self::of_contact(scene, &contact, event));
                }
            }
        }
        rows
    }

    fn of_query(scene: &Scene, shell_is_first: bool, search: u32, event: Event) -> Self {
        let row = Self {
            shell: mesh_name(shell_is_first),
            search: Some(search),
            ..Self::default()
        };
        let at = |row: Self, position: Vec3| row.at(scene.position(shell_is_first, position));
        match event {
            Event::SearchStarted {
                cluster,
                level,
                score,
                ..
            } => Self {
                event: "search_started",
                cluster: Some(cluster),
                level: Some(level),
                reason: match score {
                    Score::Penetration => "by_penetration",
                    Score::Gain => "by_gain",
                },
                ..row
            },
            Event::SearchEnded => Self {
                event: "search_ended",
                ..row
            },
            Event::ClusterBounded {
                cluster,
                level,
                bound,
            } => row.of_cluster("cluster_bounded", level, cluster, bound, None),
            Event::ClusterPruned {
                cluster,
                level,
                bound,
                threshold,
            } => row.of_cluster("cluster_pruned", level, cluster, bound, Some(threshold)),
            Event::ClusterDescended {
                cluster,
                level,
                bound,
                threshold,
            } => row.of_cluster("cluster_descended", level, cluster, bound, Some(threshold)),
            Event::PointTested {
                point_index,
                penetration,
                threshold,
                is_kept,
            } => {
                let row = Self {
                    event: "point_tested",
                    point: Some(point_index),
                    penetration_m: Some(penetration),
                    threshold: Some(threshold),
                    reason: if is_kept { KEPT } else { "below_threshold" },
                    ..row
                };
                at(row, scene.tree(shell_is_first).point(point_index as usize))
            }
            Event::ContactReduced { contact, fate } => {
                let row = Self {
                    search: None,
                    event: "contact_reduced",
                    point: Some(contact.point_index),
                    penetration_m: Some(contact.penetration),
                    reason: names::of_fate(fate),
                    ..row
                };
                at(row, contact.position)
            }
        }
    }

    fn of_contact(scene: &Scene, contact: &PairContact, event: ContactEvent) -> Self {
        let (name, reason, normal) = match event {
            ContactEvent::Found => ("contact_found", "", contact.normals[0]),
            ContactEvent::Merged => ("contact_merged", MERGED, contact.normals[0]),
            ContactEvent::NormalTurned { normal, reason } => {
                ("normal_turned", names::of_turn(reason), normal)
            }
            ContactEvent::Dropped(reason) => (
                "contact_dropped",
                names::of_drop(reason),
                contact.normals[0],
            ),
            ContactEvent::Kept => ("contact_kept", KEPT, contact.normals[0]),
        };
        let is_first = contact.shell_is_first;
        let on_shell = contact.points[usize::from(!is_first)];
        let row = Self {
            shell: mesh_name(is_first),
            event: name,
            point: point_index(contact),
            penetration_m: Some(contact.penetration),
            reason,
            nx: Some(normal.x),
            ny: Some(normal.y),
            nz: Some(normal.z),
            ..Self::default()
        };
        row.at(scene.position(is_first, on_shell))
    }

    fn of_cluster(
        self,
        event: &'static str,
        level: u32,
        cluster: u32,
        bound: f32,
        threshold: Option<f32>,
    ) -> Self {
        Self {
            event,
            level: Some(level),
            cluster: Some(cluster),
            bound: Some(bound),
            threshold,
            ..self
        }
    }

    fn at(self, position: DVec3) -> Self {
        Self {
            x_m: Some(position.x),
            y_m: Some(position.y),
            z_m: Some(position.z),
            ..self
        }
    }
}
