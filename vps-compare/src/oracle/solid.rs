//! The exact penetration of two solids.

use glamx::DPose3;
use rapier3d::math::Pose;
use vps_build::ExactSolid;

use super::depth_search::DepthSearch;
use super::indexed_solid::IndexedSolid;
use super::surface_distance::surface_distance;

/// The exact penetration of two solids, whatever their shape.
///
/// Apart, it is their distance, negative: of all pairs of triangles the closest, in 64 bits.
/// Overlapping, it is how deep the deepest point of either surface is in the other solid, as its
/// distance from the other surface. All points of all triangles count, not the vertices alone: the
/// triangles are subdivided where a point could be deeper than those found, until none can be by
/// more than the tolerance.
///
/// For bodies that overlap a little this is the separating translation as well. For those deep in
/// each other the shortest separating translation is longer, also for convex solids.
///
/// Nothing is exact of a mesh that [is open](Self::is_open).
pub struct SolidOracle {
    ground: IndexedSolid,
    body: IndexedSolid,
    tolerance: f64,
}

/// An exact penetration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExactPenetration {
    /// In metres, positive when the solids overlap.
    pub penetration_m: f64,
    /// How much larger the true value may be, in metres; finite. More than the
    /// [tolerance](SolidOracle::tolerance_m) if the search was given up.
    pub uncertainty_m: f64,
}

/// Tolerance of a depth, relative to the size of the smaller solid.
const TOLERANCE: f64 = 1e-5;

/// Distance relative to their size below which surfaces may cross, because of rounding.
const ROUNDING: f64 = 1e-12;

impl SolidOracle {
    /// An oracle for two solids.
    pub fn new(ground: ExactSolid, body: ExactSolid) -> Self {
        let (ground, body) = (IndexedSolid::new(ground), IndexedSolid::new(body));
        Self {
            tolerance: TOLERANCE * ground.size.min(body.size),
            ground,
            body,
        }
    }

    /// The largest uncertainty of the penetration if the search ended, in metres.
    pub fn tolerance_m(&self) -> f64 {
        self.tolerance
    }

    /// Whether the surfaces of ground and body have holes that were left open. Inside and outside
    /// of such a surface, and so distances, are estimates.
    pub fn is_open(&self) -> [bool; 2] {
        [&self.ground, &self.body].map(|side| side.solid.repairs().left_open)
    }

    /// The distance of the two solids in metres, 0 if they meet.
    pub fn separation(&self, body_in_ground: &Pose) -> f64 {
        self.distance(&to_double(body_in_ground)).unwrap_or(0.0)
    }

    /// The penetration for a pose of the body in the ground's frame.
    pub fn penetration(&self, body_in_ground: &Pose) -> ExactPenetration {
        let pose = to_double(body_in_ground);
        if let Some(distance) = self.distance(&pose) {
            return ExactPenetration {
                penetration_m: -distance,
                uncertainty_m: 0.0,
            };
        }
        let mut search = DepthSearch::new(self.tolerance);
        let bounds = [
            search.deepest_point(&self.body, &self.ground.solid, &pose),
            search.deepest_point(&self.ground, &self.body.solid, &pose.inverse()),
        ];
        let bound = bounds[0].max(bounds[1]);
        ExactPenetration {
            penetration_m: search.deepest(),
            uncertainty_m: (bound - search.deepest()).max(0.0),
        }
    }

    /// The distance of the solids, if they do not overlap.
    fn distance(&self, pose: &DPose3) -> Option<f64> {
        let distance = surface_distance(&self.ground, &self.body, pose);
        let (ground, body) = (&self.ground.solid, &self.body.solid);
        // Without a crossing a part is inside as a whole or not at all.
        let is_apart = distance > ROUNDING * self.ground.size.max(self.body.size)
            && !body.parts().iter().any(|p| ground.contains(*pose * *p))
            && !ground
                .parts()
                .iter()
                .any(|p| body.contains(pose.inverse() * *p));
        is_apart.then_some(distance)
    }
}

/// A pose in 64 bits, its rotation normalized to that precision.
fn to_double(pose: &Pose) -> DPose3 {
    let pose = DPose3::from(*pose);
    DPose3::from_parts(pose.translation, pose.rotation.normalize())
}
