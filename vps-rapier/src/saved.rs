use std::collections::BTreeMap;
use std::path::PathBuf;

use rapier3d::geometry::{ColliderHandle, ColliderSet, SharedShape};
use serde::{Deserialize, Serialize};

use crate::{Role, ShapeError, VpsShape};

/// The VPS shapes of a world by the files of their assets, to be saved beside it.
///
/// rapier cannot write shapes it does not know. Take them out of a copy of the colliders, write
/// both, and put them back into what was read:
///
/// ```no_run
/// # use vps_rapier::rapier3d::prelude::*;
/// # use vps_rapier::SavedShapes;
/// # fn of(world: &PhysicsWorld) -> Result<(), Box<dyn std::error::Error>> {
/// let mut colliders = world.colliders.clone();
/// let shapes = SavedShapes::take_out(&mut colliders)?;
/// let text = serde_json::to_string(&(colliders, shapes))?;
///
/// let (mut colliders, shapes): (ColliderSet, SavedShapes) = serde_json::from_str(&text)?;
/// shapes.put_back(&mut colliders)?;
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SavedShapes {
    files: Vec<PathBuf>,
    shapes: Vec<SavedShape>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct SavedShape {
    collider: ColliderHandle,
    /// Position among the files.
    file: usize,
    role: Role,
}

/// Why the shapes of a world cannot be saved.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SaveError {
    /// The asset has been built in memory.
    #[error(
        "the asset of collider {0:?} is in no file: read it with VpsShape::from_file, or build it \
         with VpsShapeBuilder::cached_in"
    )]
    NoFile(ColliderHandle),
    /// A compound is written with its parts.
    #[error("the VPS shape of collider {0:?} is inside of a compound: use several colliders")]
    Compound(ColliderHandle),
}

impl SavedShapes {
    /// Puts a small ball in the place of each VPS shape.
    ///
    /// # Errors
    /// When one has no file; then nothing is changed.
    pub fn take_out(colliders: &mut ColliderSet) -> Result<Self, SaveError> {
        let mut numbers = BTreeMap::new();
        let mut saved = Self::default();
        for (handle, collider) in colliders.iter() {
            if crate::compound::compound_of_vps(collider.shape()).is_some() {
                return Err(SaveError::Compound(handle));
            }
            let Some(shape) = collider.shape().as_shape::<VpsShape>() else {
                continue;
            };
            let file = shape.file().ok_or(SaveError::NoFile(handle))?;
            let file = *numbers.entry(file.to_path_buf()).or_insert_with_key(|f| {
                saved.files.push(f.clone());
                saved.files.len() - 1
            });
            saved.shapes.push(SavedShape {
                collider: handle,
                file,
                role: shape.role(),
            });
        }
        for shape in &saved.shapes {
            if let Some(collider) = colliders.get_mut(shape.collider) {
                collider.set_shape(SharedShape::ball(1e-3));
            }
        }
        Ok(saved)
    }

    /// Reads each file once and gives the colliders their shapes; those that are gone are left out.
    ///
    /// # Errors
    /// When a file cannot be read; then nothing is changed.
    pub fn put_back(&self, colliders: &mut ColliderSet) -> Result<(), ShapeError> {
        let read = self.files.iter().map(|file| VpsShape::from_file(file));
        let read: Vec<VpsShape> = read.collect::<Result<_, _>>()?;
        for saved in &self.shapes {
            let shape = read.get(saved.file);
            if let (Some(shape), Some(collider)) = (shape, colliders.get_mut(saved.collider)) {
                collider.set_shape(shape.clone().with_role(saved.role).into());
            }
        }
        Ok(())
    }
}
