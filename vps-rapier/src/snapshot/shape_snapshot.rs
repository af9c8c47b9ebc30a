//! The VPS shapes of colliders, apart from the rest of a world.

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

use rapier3d::dynamics::RigidBodySet;
use rapier3d::geometry::{ColliderHandle, ColliderSet, SharedShape};
use serde::{Deserialize, Serialize};
use vps_core::Asset;

use super::exchange::{exchange_shapes, replace_parts};
use crate::compound::as_compound_with_vps;
use crate::shape::builder::ShapeError;
use crate::shape::{Role, VpsShape};

/// The VPS shapes of colliders, for programs that save the parts of a world separately; see
/// [`Snapshot`](crate::Snapshot).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ShapeSnapshot {
    assets: Vec<SavedAsset>,
    shapes: Vec<SavedShape>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
enum SavedAsset {
    File(PathBuf),
    /// The bytes of a `.vps` file.
    Bytes(Vec<u8>),
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct SavedShape {
    collider: ColliderHandle,
    /// Index of the part, in a compound.
    part: Option<usize>,
    /// Index among the assets.
    asset: usize,
    role: Role,
}

impl ShapeSnapshot {
    /// Replaces each VPS shape by a small ball. rapier does not see that as a change.
    pub fn extract(colliders: &mut ColliderSet, bodies: &RigidBodySet) -> Self {
        let mut saved = Self::default();
        let mut indices = HashMap::new();
        let mut replaced = Vec::new();
        for (handle, collider) in colliders.iter() {
            let mut take = |shape: &SharedShape, part| {
                let vps = shape.as_shape::<VpsShape>()?;
                let address: *const Asset<'_> = vps.asset();
                let asset = *indices.entry(address).or_insert_with(|| {
                    saved.assets.push(match vps.file() {
                        Some(file) => SavedAsset::File(file.into()),
                        None => SavedAsset::Bytes(vps.asset().to_bytes()),
                    });
                    saved.assets.len() - 1
                });
                saved.shapes.push(SavedShape {
                    collider: handle,
                    part,
                    asset,
                    role: vps.role(),
                });
                Some(SharedShape::ball(1e-3))
            };
            let shape = collider.shared_shape();
            if let Some(ball) = take(shape, None) {
                replaced.push((handle, ball));
            } else if as_compound_with_vps(&**shape).is_some() {
                let parts = replace_parts(shape, |i, part| take(part, Some(i)));
                replaced.push((handle, parts));
            }
        }
        exchange_shapes(colliders, bodies, replaced);
        saved
    }

    /// Reads each asset once and gives the colliders their shapes. Colliders that no longer exist are
    /// left out. rapier does not see that as a change.
    ///
    /// # Errors
    /// When an asset cannot be read. Then nothing is changed.
    pub fn restore(
        &self,
        colliders: &mut ColliderSet,
        bodies: &RigidBodySet,
    ) -> Result<(), ShapeError> {
        let read = self.assets.iter().map(SavedAsset::read);
        let read: Vec<VpsShape> = read.collect::<Result<_, _>>()?;
        let mut restored: Vec<(ColliderHandle, SharedShape)> = Vec::new();
        for saved in &self.shapes {
            let shape = read.get(saved.asset).zip(colliders.get(saved.collider));
            let Some((shape, collider)) = shape else {
                continue;
            };
            let shape: SharedShape = shape.clone().with_role(saved.role).into();
            let Some(part) = saved.part else {
                restored.push((saved.collider, shape));
                continue;
            };
            if restored
                .last()
                .is_none_or(|(handle, _)| *handle != saved.collider)
            {
                restored.push((saved.collider, collider.shared_shape().clone()));
            }
            if let Some((_, compound)) = restored.last_mut() {
                *compound = replace_parts(compound, |i, _| (i == part).then(|| shape.clone()));
            }
        }
        exchange_shapes(colliders, bodies, restored);
        Ok(())
    }
}

impl SavedAsset {
    fn read(&self) -> Result<VpsShape, ShapeError> {
        match self {
            Self::File(file) => VpsShape::from_file(file),
            Self::Bytes(bytes) => {
                // An asset is used in place, which requires an alignment of 8 bytes.
                let mut words = vec![0_u64; bytes.len().div_ceil(8)];
                let aligned = &mut bytemuck::cast_slice_mut(&mut words)[..bytes.len()];
                aligned.copy_from_slice(bytes);
                let asset = Asset::from_bytes(aligned)?.into_owned();
                Ok(VpsShape::new(Arc::new(asset)))
            }
        }
    }
}
