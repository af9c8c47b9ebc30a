use glamx::{Mat3, Pose3, Vec3};

use crate::{DistanceField, MAX_LEVELS, PointSphereTree};

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

/// The penalty force and torque of a contact set (eqs. 2 and 3).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrench {
    /// Sum of Vn over the contacts, in metres: newtons once multiplied by a stiffness in N/m. In
    /// the shell frame, acting on the shell's body.
    pub force: Vec3,
    /// Sum of r × Vn with r from the point the torque is about, in square metres, in the shell
    /// frame.
    pub torque: Vec3,
}

/// A pointshell posed in a distance field (sections 2.2 and 2.3).
///
/// A point is in contact when its penetration is at least 0, or at least −margin. Every query
/// gives the same contacts: [`for_each_contact_flat`](Self::for_each_contact_flat) tests all
/// points, the others only those in balls that may reach the field. With a pose that is not
/// finite there are none.
#[derive(Clone, Copy, Debug)]
pub struct Query<'q, F: ?Sized> {
    tree: &'q PointSphereTree<'q>,
    field: &'q F,
    rotation: Mat3,
    translation: Vec3,
    margin: f32,
    ball_slack: f32,
}

impl<'q, F: DistanceField + ?Sized> Query<'q, F> {
    /// A query for contacts; `shell_to_field` takes shell coordinates to field coordinates.
    pub fn new(tree: &'q PointSphereTree<'q>, field: &'q F, shell_to_field: Pose3) -> Self {
        // A NaN is in contact with nothing, an infinity might be.
        let translation = if shell_to_field.is_finite() {
            shell_to_field.translation
        } else {
            Vec3::NAN
        };
        let bounds = tree.bounds();
        let size = bounds.min.abs().max(bounds.max.abs()).length();
        let reach = size + translation.length();
        Self {
            tree,
            field,
            rotation: Mat3::from_quat(shell_to_field.rotation),
            translation,
            margin: 0.0,
            // A ball and the points in it are moved by rounding, each on its own.
            ball_slack: 16.0 * f32::EPSILON * reach,
        }
    }

    /// Also gives the points that are up to `margin` metres away from the solid.
    pub fn with_margin(self, margin: f32) -> Self {
        Self { margin, ..self }
    }

    /// Calls `visit` with every contact, in the order of the points.
    ///
    /// Algorithm 1, with two differences that change no result: the tree is walked depth first
    /// (which needs no queue), and a parent point is tested once, with the leaf it belongs to.
    pub fn for_each_contact(&self, mut visit: impl FnMut(Contact)) {
        self.search(|contact| {
            visit(contact);
            true
        });
    }

    /// Calls `visit` with every contact, testing every point (MPT99): what the tree is measured
    /// against.
    pub fn for_each_contact_flat(&self, mut visit: impl FnMut(Contact)) {
        for index in 0..self.tree.point_count() {
            if let Some(contact) = self.test_point(index) {
                visit(contact);
            }
        }
    }

    /// Whether there is any contact; stops at the first.
    pub fn touches(&self) -> bool {
        let mut found = false;
        self.search(|_| {
            found = true;
            false
        });
        found
    }

    /// The contact with the largest penetration δ, the first of equally deep ones.
    pub fn deepest(&self) -> Option<Contact> {
        let mut deepest: Option<Contact> = None;
        self.for_each_contact(|contact| {
            if deepest.is_none_or(|d| contact.penetration > d.penetration) {
                deepest = Some(contact);
            }
        });
        deepest
    }

    /// Penalty force and torque about `center` (shell frame), for stiffness one (eqs. 2 and 3).
    /// Points within the margin but outside of the solid add nothing.
    pub fn wrench(&self, center: Vec3) -> Wrench {
        let mut wrench = Wrench::default();
        self.for_each_contact(|contact| {
            let force = contact.penetration.max(0.0) * contact.normal;
            wrench.force += force;
            wrench.torque += (contact.position - center).cross(force);
        });
        wrench
    }

    /// Walks the tree until `visit` returns false.
    fn search(&self, mut visit: impl FnMut(Contact) -> bool) {
        let leaf_level = self.tree.level_count() as usize;
        // The children of one cluster a level that are still to be looked at.
        let mut open = [(0_u32, 0_u32); MAX_LEVELS + 1];
        let mut level = 1;
        open[level] = (0, 1);
        while level > 0 {
            let (next, end) = open[level];
            if next == end {
                level -= 1;
                continue;
            }
            open[level].0 += 1;
            let cluster = self.tree.level(level as u32)[next as usize];
            let center = self.to_field(Vec3::from_array(cluster.center));
            let radius = cluster.radius + self.ball_slack;
            // Written so that a NaN from a broken pose ends the search.
            let may_touch = self.field.penetration_bound(center, radius) >= -self.margin;
            if !may_touch {
                continue;
            }
            let children = (cluster.first, cluster.first + cluster.count);
            if level < leaf_level {
                level += 1;
                open[level] = children;
                continue;
            }
            for index in children.0..children.1 {
                if let Some(contact) = self.test_point(index as usize)
                    && !visit(contact)
                {
                    return;
                }
            }
        }
    }

    fn test_point(&self, index: usize) -> Option<Contact> {
        let position = self.tree.point(index);
        let normal = self.tree.normal(index);
        let penetration = self
            .field
            .penetration(self.to_field(position), self.rotation * normal);
        (penetration >= -self.margin).then_some(Contact {
            point: index as u32,
            position,
            normal,
            penetration,
        })
    }

    fn to_field(&self, point: Vec3) -> Vec3 {
        self.rotation * point + self.translation
    }
}
