use std::sync::Arc;

use rapier3d::geometry::{ContactData, ContactManifoldData};
use rapier3d::math::Pose;
use rapier3d::parry::query::{PersistentQueryDispatcher, Unsupported};
use rapier3d::parry::shape::SharedShape;

use crate::contacts::Contacts;
use crate::memory::Memory;

/// A query dispatcher of parry with the contact data of rapier.
pub type Dispatcher = dyn PersistentQueryDispatcher<ContactManifoldData, ContactData>;

/// A scene prepared by an algorithm.
#[derive(Clone)]
pub struct Prepared {
    /// The body's shape, in the frame of its mesh.
    pub body: SharedShape,
    /// The ground's shape.
    pub ground: SharedShape,
    /// The dispatcher of queries between the two shapes.
    pub dispatcher: Arc<Dispatcher>,
    /// Size of the body's shape by name, such as a number of points.
    pub size: Size,
    /// Size of the ground's shape if it was a mesh; empty if it is a box.
    pub ground_size: Size,
    /// Memory of both shapes.
    pub memory: Memory,
}

/// Numbers by name.
pub type Size = Vec<(&'static str, usize)>;

impl Prepared {
    /// Updates the contacts for a pose of the body in the frame of the ground, up to a separation
    /// of `prediction` metres.
    ///
    /// # Errors
    /// When the dispatcher cannot answer for this pair of shapes.
    pub fn query(
        &self,
        body_in_ground: &Pose,
        prediction: f32,
        contacts: &mut Contacts,
    ) -> Result<(), Unsupported> {
        self.dispatcher.contact_manifolds(
            body_in_ground,
            &*self.ground,
            &*self.body,
            prediction,
            &mut contacts.manifolds,
            &mut contacts.workspace,
        )
    }
}
