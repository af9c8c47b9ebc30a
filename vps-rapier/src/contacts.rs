//! From the contacts of a query to manifolds of parry.

use rapier3d::math::Pose;
use rapier3d::parry::query::{
    ContactManifold as ParryManifold, ContactManifoldsWorkspace, TrackedContact,
    TypedWorkspaceData, WorkspaceData,
};
use rapier3d::parry::shape::{FeatureId, PackedFeatureId};
use vps_core::{Contact, Vec3};

use crate::pair::Pair;

/// Contacts whose normals differ by less than 5 degrees share a manifold.
const SAME_NORMAL: f32 = 0.996_2;

/// Most contacts a pair gives: what rapier's solver takes of one manifold (and Bullet's, section
/// 3.2).
const MANIFOLD_SIZE: usize = 4;

/// Tells rapier by its presence that the manifolds of the pair may change their order.
#[derive(Clone)]
struct Workspace;

impl WorkspaceData for Workspace {
    fn as_typed_workspace_data(&self) -> TypedWorkspaceData<'_> {
        TypedWorkspaceData::Custom
    }

    fn clone_dyn(&self) -> Box<dyn WorkspaceData> {
        Box::new(Self)
    }
}

/// A contact between two surfaces.
pub(crate) struct SurfaceContact {
    /// Where the shell touches, in the shell frame.
    pub(crate) on_shell: Vec3,
    /// The closest point of the field's surface, in the field frame.
    pub(crate) on_field: Vec3,
    /// Unit normal out of the field, in the field frame.
    pub(crate) field_normal: Vec3,
    /// The same direction reversed, out of the shell, in the shell frame.
    pub(crate) shell_normal: Vec3,
}

impl SurfaceContact {
    /// Takes the normal of the field, which does not depend on how the shell was sampled; where
    /// the field has none, that of the shell.
    pub(crate) fn new(pair: &Pair<'_>, shell_to_field: &Pose, contact: &Contact) -> Self {
        let in_field = shell_to_field.transform_point(contact.position);
        let mut inward = pair.inward_direction(in_field);
        if inward == Vec3::ZERO {
            inward = -(shell_to_field.rotation * contact.normal);
        }
        Self {
            on_shell: contact.position,
            on_field: in_field - inward * contact.penetration,
            field_normal: -inward,
            shell_normal: shell_to_field.rotation.inverse() * inward,
        }
    }
}

/// Finds the contacts of a pair and replaces its manifolds by them: the deepest first, then up to
/// three that spread over the largest area, in one manifold for each normal. What the engine
/// remembers of a contact stays with the point of the shell.
pub(crate) fn update_manifolds<M: Default + Clone, C: Default + Copy>(
    pair: &Pair<'_>,
    pos12: &Pose,
    prediction: f32,
    manifolds: &mut Vec<ParryManifold<M, C>>,
    workspace: &mut Option<ContactManifoldsWorkspace>,
) {
    let is_ours = |w: &ContactManifoldsWorkspace| w.0.downcast_ref::<Workspace>().is_some();
    if !workspace.as_ref().is_some_and(is_ours) {
        *workspace = Some(Workspace.into());
    }
    let mut old = std::mem::take(manifolds);
    let shell_to_field = pair.shell_to_field(pos12);
    let first = old.first().and_then(|m| m.points.first());
    let deepest = first.map(|c| pair.in_order(c.fid1, c.fid2).0.unpack());
    let hint = match deepest {
        Some(FeatureId::Vertex(point)) => Some(point),
        _ => None,
    };
    let picked = pair.manifold::<MANIFOLD_SIZE>(pos12, prediction, hint);
    for contact in picked.contacts() {
        let surface = SurfaceContact::new(pair, &shell_to_field, contact);
        let (n1, n2) = pair.in_order(surface.shell_normal, surface.field_normal);
        let (p1, p2) = pair.in_order(surface.on_shell, surface.on_field);
        let shell_point = PackedFeatureId::vertex(contact.point);
        let (id1, id2) = pair.in_order(shell_point, PackedFeatureId::UNKNOWN);
        let mut tracked = TrackedContact::new(p1, p2, id1, id2, -contact.penetration);
        let known = old.iter().flat_map(|m| m.contacts());
        if let Some(same) = known.into_iter().find(|o| (o.fid1, o.fid2) == (id1, id2)) {
            tracked.data = same.data;
        }
        let fits = |m: &&mut ParryManifold<M, C>| m.local_n1.dot(n1) > SAME_NORMAL;
        if let Some(manifold) = manifolds.iter_mut().find(fits) {
            manifold.points.push(tracked);
            continue;
        }
        // The n-th manifold goes on with what the engine keeps of the n-th one.
        let mut manifold = ParryManifold::<M, C>::new();
        if let Some(before) = old.get_mut(manifolds.len()) {
            manifold.data = before.data.clone();
        }
        (manifold.local_n1, manifold.local_n2) = (n1, n2);
        manifold.points.push(tracked);
        manifolds.push(manifold);
    }
}
