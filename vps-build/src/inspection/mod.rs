//! Diagnosis of meshes: a health report, and walls too thin for voxels.

pub(crate) mod health;
pub(crate) mod thin_walls;
