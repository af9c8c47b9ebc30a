//! What a pair keeps from step to step.

use rapier3d::parry::query::{ContactManifoldsWorkspace, TypedWorkspaceData, WorkspaceData};
use vps_core::Pose3;

/// Tells rapier by its presence that the manifolds of the pair may change their order.
#[derive(Clone, Default)]
pub(crate) struct Workspace {
    /// The pose of the second shape in the frame of the first.
    pub(crate) pos12: Option<Pose3>,
    /// What pairs of parts of compounds keep by themselves.
    pub(crate) parts: Vec<([u32; 2], Option<ContactManifoldsWorkspace>)>,
}

impl WorkspaceData for Workspace {
    fn as_typed_workspace_data(&self) -> TypedWorkspaceData<'_> {
        TypedWorkspaceData::Custom
    }

    fn clone_dyn(&self) -> Box<dyn WorkspaceData> {
        Box::new(self.clone())
    }
}

impl Workspace {
    /// Takes out the workspace of a pair, a new one if it is not ours.
    pub(crate) fn take(workspace: &mut Option<ContactManifoldsWorkspace>) -> Self {
        let ours = workspace.as_mut().and_then(|w| w.0.downcast_mut::<Self>());
        ours.map(std::mem::take).unwrap_or_default()
    }

    /// Puts it back.
    pub(crate) fn put(self, workspace: &mut Option<ContactManifoldsWorkspace>) {
        match workspace.as_mut().and_then(|w| w.0.downcast_mut::<Self>()) {
            Some(ours) => *ours = self,
            None => *workspace = Some(self.into()),
        }
    }
}
