use glamx::{Mat3, Pose3, Vec3};
use wide::f32x4;

use crate::dispatch::dispatch;
use crate::lanes::Vectors;
use crate::search::{Found, Goal};
use crate::work::{CountWork, Work};
use crate::{DistanceField, PointSphereTree};

/// A shell point found in the field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Which point of the shell it is.
    pub point: u32,
    /// Its position P in metres in the shell frame.
    pub position: Vec3,
    /// Its unit inward normal n in the shell frame: the way the shell's body is pushed (eq. 2).
    pub normal: Vec3,
    /// Its penetration V in metres, positive inside; negative only within a query's margin.
    pub penetration: f32,
}

impl Contact {
    /// That of a point of a shell.
    #[inline(always)]
    pub(crate) fn of(tree: &PointSphereTree<'_>, point: u32, penetration: f32) -> Self {
        Self {
            point,
            position: tree.point(point as usize),
            normal: tree.normal(point as usize),
            penetration,
        }
    }

    /// Whether it comes before another, if there is one, as the deepest: the first of equally deep
    /// ones does.
    #[inline]
    pub(crate) fn is_deeper_than(&self, other: Option<&Self>) -> bool {
        other.is_none_or(|other| {
            self.penetration > other.penetration
                || self.penetration == other.penetration && self.point < other.point
        })
    }
}

/// A pointshell posed in a distance field (sections 2.2 to 2.4).
///
/// A point is in contact when its penetration is at least 0, or at least −margin. Every query
/// gives the same as a test of all points
/// ([`for_each_contact_flat`](Self::for_each_contact_flat)), but looks only at what may matter to
/// it. With a pose that is not finite there are no contacts.
#[derive(Debug)]
pub struct Query<'q, F: ?Sized, W = ()> {
    pub(crate) tree: &'q PointSphereTree<'q>,
    pub(crate) field: &'q F,
    pub(crate) rotation: Mat3,
    pub(crate) translation: Vec3,
    /// Whether the pose is finite.
    pub(crate) is_posed: bool,
    pub(crate) margin: f32,
    pub(crate) motion: Option<f32>,
    /// A point to begin with.
    pub(crate) hint: Option<u32>,
    /// A ball and the points in it are moved by rounding, each on its own.
    pub(crate) ball_slack: f32,
    pub(crate) work: W,
}

impl<F: ?Sized, W: Copy> Clone for Query<'_, F, W> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<F: ?Sized, W: Copy> Copy for Query<'_, F, W> {}

impl<'q, F: DistanceField + ?Sized> Query<'q, F> {
    /// A query for contacts; `shell_to_field` takes shell coordinates to field coordinates.
    pub fn new(tree: &'q PointSphereTree<'q>, field: &'q F, shell_to_field: Pose3) -> Self {
        let translation = shell_to_field.translation;
        let reach = tree.reach() + translation.length();
        Self {
            tree,
            field,
            rotation: Mat3::from_quat(shell_to_field.rotation),
            translation,
            is_posed: shell_to_field.is_finite(),
            margin: 0.0,
            motion: Some(0.0),
            hint: None,
            ball_slack: 16.0 * f32::EPSILON * reach,
            work: (),
        }
    }

    /// The same query, counting what it looks at.
    pub fn counting<'w>(self, work: &'w Work) -> Query<'q, F, &'w Work> {
        Query {
            tree: self.tree,
            field: self.field,
            rotation: self.rotation,
            translation: self.translation,
            is_posed: self.is_posed,
            margin: self.margin,
            motion: self.motion,
            hint: self.hint,
            ball_slack: self.ball_slack,
            work,
        }
    }
}

impl<F: DistanceField + ?Sized, W: CountWork> Query<'_, F, W> {
    /// Also gives the points that are up to `margin` metres away from the solid.
    pub fn with_margin(self, margin: f32) -> Self {
        Self { margin, ..self }
    }

    /// Tells [`manifold`](Self::manifold) how far the shell has come, towards the solid or away, since
    /// the query before, in metres; 0 without it. `None` if it was further away than the margin: then
    /// it is taken to go as far again as its deepest point is away.
    pub fn with_motion(self, motion: Option<f32>) -> Self {
        Self { motion, ..self }
    }

    /// Has [`touches`](Self::touches), [`deepest`](Self::deepest) and
    /// [`manifold`](Self::manifold) begin with a point that is likely to be deep, such as the deepest
    /// of the step before. What they give is the same; of a point there is not, nothing comes.
    pub fn with_hint(self, point: u32) -> Self {
        let hint = Some(point).filter(|&p| (p as usize) < self.tree.point_count());
        Self { hint, ..self }
    }

    /// Calls `visit` with every contact, in the order of the points.
    ///
    /// Algorithm 1, with two differences that change no result: the tree is walked depth first
    /// (which needs no queue), and a parent point is tested once, with the leaf it belongs to.
    pub fn for_each_contact(&self, visit: impl FnMut(Contact)) {
        self.find(All::new(self.margin, visit));
    }

    /// Calls `visit` with every contact, testing every point (MPT99): what the tree is measured
    /// against.
    pub fn for_each_contact_flat(&self, visit: impl FnMut(Contact)) {
        if !self.is_posed {
            return;
        }
        let mut all = All::new(self.margin, visit);
        let range = (0, self.tree.point_count() as u32);
        dispatch(
            #[inline(always)]
            || self.offer_points(range, &mut all),
        );
    }

    /// Whether there is any contact; stops at the first.
    pub fn touches(&self) -> bool {
        let mut any = Any {
            margin: self.margin,
            found: false,
        };
        self.find_from_hint(&mut any);
        any.found
    }

    /// The contact with the largest penetration δ, the first of equally deep ones.
    ///
    /// Branch and bound: clusters that cannot hold a deeper point are left out.
    pub fn deepest(&self) -> Option<Contact> {
        let mut deepest = Deepest::new(self.margin);
        self.find_from_hint(&mut deepest);
        deepest.found
    }

    /// The point of the shell with the largest penetration, however far outside: where the bodies
    /// are closest if they are apart, the negative of its penetration being their separation
    /// (section 2.2), and the [`deepest`](Self::deepest) if they are not. `None` only for a pose
    /// that is not finite.
    pub fn closest(&self) -> Option<Contact>
    where
        W: Copy,
    {
        self.with_margin(f32::INFINITY).deepest()
    }

    /// Searches the whole tree for a goal, and gives what became of it.
    #[inline(always)]
    pub(crate) fn find<G: Goal>(&self, mut goal: G) -> G {
        dispatch(
            #[inline(always)]
            || self.search(TOP, &mut goal),
        );
        goal
    }

    /// The same for goals that may be offered a point twice.
    #[inline(always)]
    pub(crate) fn find_from_hint<G: Goal>(&self, goal: &mut G) {
        dispatch(
            #[inline(always)]
            || {
                let goes_on = match self.hint {
                    Some(point) if self.is_posed => self.offer_points((point, point + 1), goal),
                    _ => true,
                };
                if goes_on {
                    self.search(TOP, goal);
                }
            },
        );
    }

    /// A single point, if it is in contact.
    pub(crate) fn test_point(&self, point: u32) -> Option<Contact> {
        let mut found = Deepest::new(self.margin);
        self.offer_points((point, point + 1), &mut found);
        found.found
    }

    #[inline(always)]
    pub(crate) fn to_field(&self, points: Vectors) -> Vectors {
        points
            .rotated(&self.rotation)
            .plus(Vectors::splat(self.translation))
    }
}

/// The cluster of all points: its level, and its number.
pub(crate) const TOP: (u32, u32) = (1, 0);

/// All contacts, in order.
pub(crate) struct All<V> {
    margin: f32,
    visit: V,
}

impl<V: FnMut(Contact)> All<V> {
    pub(crate) fn new(margin: f32, visit: V) -> Self {
        Self { margin, visit }
    }
}

impl<V: FnMut(Contact)> Goal for All<V> {
    const BEST_FIRST: bool = false;
    const ALL: bool = true;

    #[inline(always)]
    fn least_penetration(&self) -> f32 {
        -self.margin
    }

    #[inline(always)]
    fn offer(&mut self, found: &Found<'_>) -> bool {
        found.each().for_each(&mut self.visit);
        true
    }
}

/// Whether there is a contact.
struct Any {
    margin: f32,
    found: bool,
}

impl Goal for Any {
    const BEST_FIRST: bool = true;

    #[inline(always)]
    fn least_penetration(&self) -> f32 {
        -self.margin
    }

    #[inline(always)]
    fn offer(&mut self, _found: &Found<'_>) -> bool {
        self.found = true;
        false
    }
}

/// The deepest contact.
pub(crate) struct Deepest {
    /// Its penetration; that of the shallowest there may be as long as none is found.
    pub(crate) least: f32,
    pub(crate) found: Option<Contact>,
}

impl Deepest {
    pub(crate) fn new(margin: f32) -> Self {
        Self {
            least: -margin,
            found: None,
        }
    }
}

impl Goal for Deepest {
    const BEST_FIRST: bool = true;

    #[inline(always)]
    fn least_penetration(&self) -> f32 {
        self.least
    }

    #[inline(always)]
    fn offer(&mut self, found: &Found<'_>) -> bool {
        let deep = found.counts & found.penetrations.simd_ge(f32x4::splat(self.least));
        for contact in found.each_in(deep) {
            if contact.is_deeper_than(self.found.as_ref()) {
                self.least = contact.penetration;
                self.found = Some(contact);
            }
        }
        true
    }
}
