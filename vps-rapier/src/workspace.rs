//! The workspace of a pair, by which rapier knows that its manifolds may change their order.

use rapier3d::parry::query::ContactManifoldsWorkspace;
use rapier3d::parry::query::details::VoxelsShapeContactManifoldsWorkspace;

/// Marks a pair by the presence of a workspace. The state of a pair is in its manifolds, so the
/// workspace is an empty one of parry's own, which serde can write and read.
pub(crate) fn mark(workspace: &mut Option<ContactManifoldsWorkspace>) {
    let is_marked = |w: &ContactManifoldsWorkspace| w.0.downcast_ref::<Empty>().is_some();
    if !workspace.as_ref().is_some_and(is_marked) {
        *workspace = Some(Empty::new().into());
    }
}

type Empty = VoxelsShapeContactManifoldsWorkspace<2>;
