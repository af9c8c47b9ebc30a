//! A contact between the surfaces of two shapes, and the choice of a few.

use rapier3d::parry::query::Contact as ParryContact;
use rapier3d::parry::shape::PackedFeatureId;
use vps_core::{Contact, ContactManifold, Pose3, Vec3};

use crate::real::{real, vector};

/// A contact between two surfaces; of each pair one thing is the first shape's and one the second's.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PairContact {
    /// A point on each surface, in the frame of its shape in metres.
    pub(crate) points: [Vec3; 2],
    /// The unit normal out of each shape, in its frame: the two are opposite.
    pub(crate) normals: [Vec3; 2],
    /// The normal out of the first shape as the other's or its own shell has it, in its frame; the
    /// ones above are the field's.
    pub(crate) by_shell: Option<Vec3>,
    /// Whether the point is one of the first shape's shell or edges.
    pub(crate) shell_is_first: bool,
    /// What stays the same from step to step.
    pub(crate) ids: [PackedFeatureId; 2],
    /// In metres, positive inside.
    pub(crate) penetration: f32,
}

impl PairContact {
    /// The same contact seen with the shapes in the other order.
    pub(crate) fn flipped(self) -> Self {
        let flip = |[a, b]: [Vec3; 2]| [b, a];
        Self {
            points: flip(self.points),
            normals: flip(self.normals),
            by_shell: None,
            shell_is_first: !self.shell_is_first,
            ids: [self.ids[1], self.ids[0]],
            penetration: self.penetration,
        }
    }

    /// Gives it another normal out of the first shape, in the frame of the first; the point of the
    /// shell stays where it is.
    fn turn(&mut self, normal: Vec3, pos12: &Pose3) {
        self.normals = [normal, -(pos12.rotation.inverse() * normal)];
        let way = normal * -self.penetration;
        if self.shell_is_first {
            self.points[1] = pos12.inverse_transform_point(self.points[0] + way);
        } else {
            self.points[0] = pos12.transform_point(self.points[1]) - way;
        }
    }

    pub(crate) fn to_parry(self) -> ParryContact {
        let [point1, point2] = self.points.map(vector);
        let [normal1, normal2] = self.normals.map(vector);
        ParryContact::new(point1, point2, normal1, normal2, real(-self.penetration))
    }
}

/// Keeps at most `N`: the deepest first, then those that spread over the largest area, seen along
/// the normal of the deepest (section 3.2); `margin` is how far ahead they were
/// looked for, and `motion` that of [`vps_core::Query::with_motion`].
pub(crate) fn spread<const N: usize>(
    contacts: &mut Vec<PairContact>,
    margin: f32,
    motion: Option<f32>,
) {
    if contacts.len() <= 1 {
        return;
    }
    let numbered = (0..).zip(&*contacts).map(|(point, c)| Contact {
        point,
        position: c.points[0],
        normal: c.normals[0],
        penetration: c.penetration,
    });
    let numbered: Vec<Contact> = numbered.collect();
    let deeper = |a: &Contact, b: &Contact| {
        let by_depth = a.penetration.total_cmp(&b.penetration);
        by_depth.then(b.point.cmp(&a.point))
    };
    let Some(deepest) = numbered.iter().copied().max_by(deeper) else {
        return;
    };
    let picked = ContactManifold::<N>::spread(&numbered, deepest.normal, margin, motion);
    let picked = picked.contacts().iter();
    *contacts = picked.map(|c| contacts[c.point as usize]).collect();
}

/// Most contacts of one normal: what rapier's solver takes of a manifold (and Bullet's, section 3.2).
const MANIFOLD_SIZE: usize = 4;

/// Contacts whose normals differ by less than 5 degrees share a manifold.
const SAME_NORMAL: f32 = 0.996_2;

/// Whether two normals are as good as one.
pub(crate) fn is_same_normal(a: Vec3, b: Vec3) -> bool {
    a.dot(b) > SAME_NORMAL
}

/// Keeps the first contacts of each normal. Where a body lies flat four hold it as well as eight; all
/// around a thread or a tooth they do not.
pub(crate) fn keep_few_of_a_normal(contacts: &mut Vec<PairContact>) {
    let mut groups: Vec<(Vec3, usize)> = Vec::with_capacity(contacts.len());
    contacts.retain(|contact| {
        let normal = contact.normals[0];
        let Some((_, count)) = groups.iter_mut().find(|(n, _)| is_same_normal(*n, normal)) else {
            groups.push((normal, 1));
            return true;
        };
        *count += 1;
        *count <= MANIFOLD_SIZE
    });
}

/// The largest penetration in metres, minus infinity of none.
pub(crate) fn deepest(contacts: &[PairContact]) -> f32 {
    let depths = contacts.iter().map(|c| c.penetration);
    depths.fold(f32::NEG_INFINITY, f32::max)
}

/// Whether contacts of the step before are as good as the ones an engine would get now: as many,
/// almost as deep (but for `tolerance` where all are shallow), and almost as wide apart. Then they
/// stay, so that a body at rest is not handed from one choice among many equal ones to the next.
pub(crate) fn is_as_good(before: &[PairContact], now: &[PairContact], tolerance: f32) -> bool {
    let shallowest = |contacts: &[PairContact]| {
        let depths = contacts.iter().map(|c| c.penetration);
        depths.fold(f32::INFINITY, f32::min)
    };
    let tolerance = tolerance + SHALLOWER * deepest(now).max(0.0);
    before.len() == now.len()
        && deepest(before) >= deepest(now) - tolerance
        && shallowest(before) >= shallowest(now) - tolerance
        && spread_of(before) >= ALMOST * spread_of(now)
}

/// By how much of the depth of the deepest they may be less deep.
const SHALLOWER: f32 = 0.1;

/// How much of the spread of the best contacts is enough.
const ALMOST: f32 = 0.8;

/// The sum of all squared distances between two contacts, in m².
fn spread_of(contacts: &[PairContact]) -> f32 {
    let pairs = (0..contacts.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
    pairs
        .map(|(i, j)| contacts[i].points[0].distance_squared(contacts[j].points[0]))
        .sum()
}

/// How much better the normals of the shell must agree than those of the field to be the measure.
const BETTER: f32 = 1.01;

/// How long the mean of all normals must be to say something about each.
const TOGETHER: f32 = 0.5;

/// Where the normals of field and shell disagree, one of the two has an edge there, and any direction
/// between them is one the other can lie on: takes the one closest to what the contacts say together,
/// by the field or by the shell, whichever agree better among themselves. So a face that lies on a
/// face is not pushed aside where either ends. Contacts all around, as in a thread, keep the normals
/// of the field.
pub(crate) fn settle_normals(contacts: &mut [PairContact], pos12: &Pose3) {
    let (mut by_field, mut by_shell, mut total) = (Vec3::ZERO, Vec3::ZERO, 0.0);
    for contact in &*contacts {
        let of_shell = contact.by_shell.unwrap_or(contact.normals[0]);
        // Those that agree know best.
        let agreement = contact.normals[0].dot(of_shell).max(0.0).powi(4) + LEAST_SAY;
        by_field += contact.normals[0] * agreement;
        by_shell += of_shell * agreement;
        total += agreement;
    }
    let all = if by_shell.length() > BETTER * by_field.length() {
        by_shell
    } else {
        by_field
    };
    if all.length() < TOGETHER * total {
        return;
    }
    for contact in contacts {
        if let Some(by_shell) = contact.by_shell {
            contact.turn(closest_between(contact.normals[0], by_shell, all), pos12);
        }
    }
}

/// How much normals count that do not agree at all, beside those that do.
const LEAST_SAY: f32 = 1e-3;

/// The direction closest to `to` on the way from one to another on the sphere.
fn closest_between(a: Vec3, b: Vec3, to: Vec3) -> Vec3 {
    let across = a.cross(b);
    let in_plane = to - across * (to.dot(across) / across.length_squared().max(f32::MIN_POSITIVE));
    // Past neither end.
    let is_between = a.cross(in_plane).dot(across) > 0.0 && in_plane.cross(b).dot(across) > 0.0;
    let end = if b.dot(to) > a.dot(to) { b } else { a };
    if is_between {
        in_plane.normalize_or(end)
    } else {
        end
    }
}

/// Whether some of the contacts push against each other.
pub(crate) fn are_opposed(contacts: &[PairContact]) -> bool {
    let normals = || contacts.iter().map(|c| c.normals[0]);
    normals().any(|a| normals().any(|b| a.dot(b) < 0.0))
}

/// Turns all contacts to one normal out of the first shape, and leaves out those that push against
/// it; unless all do.
pub(crate) fn turn_all(contacts: &mut Vec<PairContact>, normal: Vec3, pos12: &Pose3) {
    if contacts.iter().all(|c| c.normals[0].dot(normal) <= 0.0) {
        return;
    }
    contacts.retain(|c| c.normals[0].dot(normal) > 0.0);
    for contact in contacts {
        contact.turn(normal, pos12);
    }
}
