//! Two bodies, each of which may be the shell in the field of the other.

use glamx::{Pose3, Vec3};

use crate::asset::Asset;
use crate::field::{DistanceField, Trilinear};
use crate::force::wrench::{Weight, Wrench};
use crate::query::contact::Contact;
use crate::query::posed::Query;
use crate::shell::PointSphereTree;

/// A body with a shell and a field, both in its own frame.
///
/// ```
/// use vps_core::{Ball, Body, BodyPair, PointSphereTree, Pose3, Vec3};
///
/// let tree = PointSphereTree::flat(&[Vec3::Y * 0.1], &[Vec3::NEG_Y], 1e-4)?;
/// let ball = Body { tree: &tree, field: Ball::new(0.1) };
/// // The second ball lies above the first, 20 mm too deep.
/// let pose = Pose3::from_translation(Vec3::Y * 0.18);
/// let pair = BodyPair::new(ball, ball, pose);
/// assert!(pair.touches());
/// # Ok::<(), vps_core::TreeError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Body<'q, F> {
    /// The pointshell.
    pub tree: &'q PointSphereTree<'q>,
    /// The field.
    pub field: F,
}

impl<'q> Body<'q, Trilinear<'q>> {
    /// An asset, its voxelmap interpolated.
    pub fn of_asset(asset: &'q Asset<'q>) -> Self {
        Self {
            tree: &asset.tree,
            field: asset.voxelmap.trilinear(),
        }
    }
}

/// Which of two bodies provides the shell for the field of the other.
///
/// ```
/// use vps_core::{Ball, Body, BodyPair, PointSphereTree, Pose3, Shells, Vec3};
///
/// let tree = PointSphereTree::flat(&[Vec3::Y * 0.1], &[Vec3::NEG_Y], 1e-4)?;
/// let ball = Body { tree: &tree, field: Ball::new(0.1) };
/// // The second ball lies above the first, 20 mm too deep.
/// let pose = Pose3::from_translation(Vec3::Y * 0.18);
/// let pair = BodyPair::new(ball, ball, pose).with_shells(Shells::Second);
/// // The only point of the second body is on its other side.
/// assert!(!pair.touches());
/// # Ok::<(), vps_core::TreeError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shells {
    /// The body with fewer points, the first one if both have as many: the paper's rule. If the
    /// smaller body may lie within the box of the other one, and thus in its solid, it is the
    /// smaller body: the shell of the other one would not meet it.
    #[default]
    FewerPoints,
    /// The first body.
    First,
    /// The second body.
    Second,
    /// Both, one after the other. Finds contacts that only one shell meets, such as an edge of one
    /// body between the points of the other. Each counts half in a force.
    Both,
}

/// One of two bodies.
///
/// ```
/// use vps_core::{Ball, Body, BodyPair, PointSphereTree, Pose3, Side, Vec3};
///
/// let tree = PointSphereTree::flat(&[Vec3::Y * 0.1], &[Vec3::NEG_Y], 1e-4)?;
/// let ball = Body { tree: &tree, field: Ball::new(0.1) };
/// // The second ball lies above the first, 20 mm too deep.
/// let pose = Pose3::from_translation(Vec3::Y * 0.18);
/// let pair = BodyPair::new(ball, ball, pose);
/// assert_eq!(pair.deepest().unwrap().shell, Side::First);
/// # Ok::<(), vps_core::TreeError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The first.
    First,
    /// The second.
    Second,
}

/// A contact of two bodies.
///
/// ```
/// use vps_core::{Ball, Body, BodyPair, PointSphereTree, Pose3, Vec3};
///
/// let tree = PointSphereTree::flat(&[Vec3::Y * 0.1], &[Vec3::NEG_Y], 1e-4)?;
/// let ball = Body { tree: &tree, field: Ball::new(0.1) };
/// // The second ball lies above the first, 20 mm too deep.
/// let pose = Pose3::from_translation(Vec3::Y * 0.18);
/// let pair = BodyPair::new(ball, ball, pose);
/// let contact = pair.deepest().unwrap();
/// assert_eq!((contact.position, contact.push), (Vec3::Y * 0.1, Vec3::NEG_Y));
/// # Ok::<(), vps_core::TreeError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairContact {
    /// The body whose shell it was found with.
    pub shell: Side,
    /// Index of the point in that shell.
    pub point_index: u32,
    /// Its position in metres in the frame of the first body.
    pub position: Vec3,
    /// Unit direction in which the first body is pushed, in its frame; the second is pushed in the
    /// opposite one.
    pub push: Vec3,
    /// Its penetration in metres, positive inside.
    pub penetration: f32,
}

/// Two bodies in a relative pose.
///
/// ```
/// use vps_core::{Ball, Body, BodyPair, PointSphereTree, Pose3, Vec3};
///
/// let tree = PointSphereTree::flat(&[Vec3::Y * 0.1], &[Vec3::NEG_Y], 1e-4)?;
/// let ball = Body { tree: &tree, field: Ball::new(0.1) };
/// // The second ball lies above the first, 20 mm too deep.
/// let pose = Pose3::from_translation(Vec3::Y * 0.18);
/// let pair = BodyPair::new(ball, ball, pose);
/// assert!((pair.deepest().unwrap().penetration - 0.02).abs() < 1e-6);
/// # Ok::<(), vps_core::TreeError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct BodyPair<'q, A, B> {
    first: Body<'q, A>,
    second: Body<'q, B>,
    second_to_first: Pose3,
    shells: Shells,
    prediction: f32,
}

impl<'q, A: DistanceField, B: DistanceField> BodyPair<'q, A, B> {
    /// Two bodies; the pose transforms coordinates of the second to those of the first.
    pub fn new(first: Body<'q, A>, second: Body<'q, B>, second_to_first: Pose3) -> Self {
        Self {
            first,
            second,
            second_to_first,
            shells: Shells::default(),
            prediction: 0.0,
        }
    }

    /// Selects the shells.
    pub fn with_shells(self, shells: Shells) -> Self {
        Self { shells, ..self }
    }

    /// Speculative distance (`prediction` of parry and rapier): points up to `prediction` metres outside
    /// of the other solid count as contacts too; 0 by default.
    pub fn with_prediction(self, prediction: f32) -> Self {
        Self { prediction, ..self }
    }

    /// The query of the first body's shell in the field of the second.
    pub fn first_in_second(&self) -> Query<'_, B> {
        let pose = self.second_to_first.inverse();
        Query::new(self.first.tree, &self.second.field, pose).with_prediction(self.prediction)
    }

    /// The query of the second body's shell in the field of the first.
    pub fn second_in_first(&self) -> Query<'_, A> {
        Query::new(self.second.tree, &self.first.field, self.second_to_first)
            .with_prediction(self.prediction)
    }

    /// Calls `visit` with every contact, those of the first shell before those of the second.
    pub fn for_each_contact(&self, mut visit: impl FnMut(PairContact)) {
        let (first, second) = self.uses_shells();
        if first {
            self.first_in_second()
                .for_each_contact(|c| visit(self.first_contact(&c)));
        }
        if second {
            self.second_in_first()
                .for_each_contact(|c| visit(self.second_contact(&c)));
        }
    }

    /// Whether the bodies touch.
    pub fn touches(&self) -> bool {
        let (first, second) = self.uses_shells();
        first && self.first_in_second().touches() || second && self.second_in_first().touches()
    }

    /// The deepest contact; of equally deep ones that of the first shell.
    pub fn deepest(&self) -> Option<PairContact> {
        self.deepest_within(self.prediction)
    }

    /// The closest point if the bodies are apart, otherwise the deepest: see [`Query::closest`].
    pub fn closest(&self) -> Option<PairContact> {
        self.deepest_within(f32::INFINITY)
    }

    /// Penalty force and torque on the first body about `center`, all in its frame; the second body
    /// takes the opposite wrench.
    pub fn wrench_on_first(&self, center: Vec3, weight: Weight) -> Wrench {
        let (first, second) = self.uses_shells();
        let part = if first && second { 0.5 } else { 1.0 };
        let mut wrench = Wrench::default();
        if !self.second_to_first.is_finite() {
            return wrench;
        }
        if first {
            let on_first = self.first_in_second().wrench(center, weight);
            wrench.force += part * on_first.force;
            wrench.torque += part * on_first.torque;
        }
        if second {
            let to_first = self.second_to_first;
            let center = to_first.inverse_transform_point(center);
            let on_second = self.second_in_first().wrench(center, weight);
            wrench.force -= part * (to_first.rotation * on_second.force);
            wrench.torque -= part * (to_first.rotation * on_second.torque);
        }
        wrench
    }

    /// Whether the first shell is used, and whether the second one is.
    fn uses_shells(&self) -> (bool, bool) {
        match self.shells {
            Shells::FewerPoints => {
                let first = self.first_is_within().unwrap_or_else(|| {
                    self.first.tree.point_count() <= self.second.tree.point_count()
                });
                (first, !first)
            }
            Shells::First => (true, false),
            Shells::Second => (false, true),
            Shells::Both => (true, true),
        }
    }

    /// Whether the first or the second body may lie within the other one; `None` if neither may.
    fn first_is_within(&self) -> Option<bool> {
        let (first, second) = (&self.first, &self.second);
        // A body within another one has no larger bounding ball.
        let [first_radius, second_radius] =
            [first.tree, second.tree].map(|t| t.clusters()[0].radius());
        let first_is_smaller = first_radius < second_radius;
        let may_be_within = if first_is_smaller {
            let to_second = self.second_to_first.inverse();
            second
                .field
                .bounds()
                .may_contain(&first.tree.bounds(), &to_second)
        } else {
            let to_first = &self.second_to_first;
            let bounds = first.field.bounds();
            second_radius < first_radius && bounds.may_contain(&second.tree.bounds(), to_first)
        };
        may_be_within.then_some(first_is_smaller)
    }

    fn deepest_within(&self, prediction: f32) -> Option<PairContact> {
        let (first, second) = self.uses_shells();
        let of_first = || self.first_in_second().with_prediction(prediction).deepest();
        let of_second = || self.second_in_first().with_prediction(prediction).deepest();
        let found_first = first.then(of_first).flatten();
        let found_second = second.then(of_second).flatten();
        match (found_first, found_second) {
            (Some(a), Some(b)) if b.penetration > a.penetration => Some(self.second_contact(&b)),
            (Some(a), _) => Some(self.first_contact(&a)),
            (None, b) => b.map(|b| self.second_contact(&b)),
        }
    }

    fn first_contact(&self, contact: &Contact) -> PairContact {
        PairContact {
            shell: Side::First,
            point_index: contact.point_index,
            position: contact.position,
            push: contact.normal,
            penetration: contact.penetration,
        }
    }

    fn second_contact(&self, contact: &Contact) -> PairContact {
        PairContact {
            shell: Side::Second,
            point_index: contact.point_index,
            position: self.second_to_first.transform_point(contact.position),
            push: -(self.second_to_first.rotation * contact.normal),
            penetration: contact.penetration,
        }
    }
}
