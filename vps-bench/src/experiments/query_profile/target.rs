//! The process that callgrind counts.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};
use vps_build::read_asset;
use vps_core::{Asset, DistanceField, Pose3, Quat, Query, Vec3, Work};

use crate::experiments::shared::query_field::cuboid;
use crate::experiments::shared::tree_query::TreeQuery;

/// The hidden verb of the command line that executes a target.
pub(crate) const VERB: &str = "execute-queries";

/// A query at all poses of a shell in a box.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub(crate) struct Target {
    /// The file of the shell's asset.
    pub(super) shell: PathBuf,
    /// The file of the voxelmap; without it the box is exact.
    pub(super) map: Option<PathBuf>,
    /// Edge lengths of the box.
    pub(super) extents_m: [f64; 3],
    pub(super) query: TreeQuery,
    /// Whether the body is in the middle of the box; otherwise it stands on it.
    pub(super) is_inside: bool,
    pub(super) poses: u32,
    /// Depth of the lowest point.
    pub(super) depth_m: f32,
    pub(super) prediction_m: f32,
}

impl std::str::FromStr for Target {
    type Err = serde_json::Error;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        serde_json::from_str(text)
    }
}

impl Target {
    /// Executes the query at each pose so many `times`, counting its work if asked to.
    pub(crate) fn execute(&self, times: u32, work: Option<&Work>) -> Result<(), String> {
        let shell = read_asset(&self.shell).map_err(|e| e.to_string())?;
        match &self.map {
            None => self.execute_in(&shell, &cuboid(self.extents_m), times, work),
            Some(map) => {
                let map = read_asset(map).map_err(|e| e.to_string())?;
                self.execute_in(&shell, &map.voxelmap.trilinear(), times, work);
            }
        }
        Ok(())
    }

    /// The function that callgrind counts, which finds it by its name.
    #[inline(never)]
    fn execute_in<F: DistanceField>(
        &self,
        shell: &Asset<'_>,
        field: &F,
        times: u32,
        work: Option<&Work>,
    ) {
        for number in 0..self.poses {
            let pose = self.pose(shell, number);
            let query = Query::new(&shell.tree, field, pose).with_prediction(self.prediction_m);
            for _ in 0..times {
                match work {
                    None => self.query.execute(&query),
                    Some(work) => self.query.execute(&query.observed_by(work)),
                }
            }
        }
    }

    /// Turned by the golden angle from pose to pose.
    fn pose(&self, shell: &Asset<'_>, number: u32) -> Pose3 {
        let turn = Quat::from_scaled_axis(Vec3::new(1.0, 0.5, 0.3) * (2.4 * number as f32));
        let mut pose = Pose3::from_parts(-(turn * shell.mass.center()), turn);
        if !self.is_inside {
            let points = shell.tree.points().iter();
            let low = points.map(|&p| pose.transform_point(p.into()).y);
            let low = low.fold(f32::INFINITY, f32::min);
            pose.translation.y += 0.5 * self.extents_m[1] as f32 - self.depth_m - low;
        }
        pose
    }
}

#[cfg(test)]
mod tests {
    use vps_build::{BuildOptions, Mesh, PointCount, Resolution, build};

    use super::*;

    #[test]
    fn bodies_stand_in_the_ground_or_are_inside_the_box() {
        let options = BuildOptions {
            resolution: Resolution::VoxelsAlongLongest(10),
            points: PointCount::About(50),
            ..BuildOptions::default()
        };
        let mesh = Mesh::cuboid([0.2, 0.1, 0.1]).unwrap();
        let shell = build(&mesh, &options, &|_| ()).unwrap().asset;
        for is_inside in [false, true] {
            let target = Target {
                shell: PathBuf::new(),
                map: None,
                extents_m: [0.4; 3],
                query: TreeQuery::Deepest,
                is_inside,
                poses: 5,
                depth_m: 0.001,
                prediction_m: 0.0,
            };
            for number in 0..target.poses {
                let pose = target.pose(&shell, number);
                let field = cuboid(target.extents_m);
                let query = Query::new(&shell.tree, &field, pose);
                let mut contacts = 0;
                query.for_each_contact(|_| contacts += 1);
                if is_inside {
                    assert_eq!(contacts, shell.tree.point_count());
                } else {
                    let deepest = query.deepest().unwrap().penetration;
                    assert!((deepest - target.depth_m).abs() < 1e-6, "{deepest}");
                }
            }
        }
    }
}
