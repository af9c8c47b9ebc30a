//! The constants of the reduction.

/// Contacts of a pair, and of each of its shells, at most. All around a thread or a tooth four do not
/// hold a body.
pub(super) const MAX_CONTACTS: usize = 8;

/// Contacts of one normal at most: the size of a manifold in rapier's solver (and in Bullet's, section
/// 3.2). Four support a body on a plane as well as eight.
pub(super) const MAX_CONTACTS_PER_NORMAL: usize = 4;

/// Cosine above which normals share a manifold: 5 degrees.
pub(super) const SAME_NORMAL_COSINE: f32 = 0.996_2;

/// Depth by which persistent contacts may be shallower than new ones where all are shallow, relative to
/// the diagonal of the smallest shell.
pub(super) const PERSISTENCE_TOLERANCE: f32 = 1e-4;

/// Depth by which persistent contacts may be shallower besides, relative to the deepest new contact.
pub(super) const PERSISTENCE_DEPTH_FRACTION: f32 = 0.1;

/// Spread that persistent contacts need, relative to that of the new ones.
pub(super) const PERSISTENCE_SPREAD_FRACTION: f32 = 0.8;

/// Cosine between normals above which a new contact takes over the warm start of an old one with
/// another id.
pub(super) const WARM_START_COSINE: f32 = 0.9;

/// Factor by which the normals of the shell must agree better among themselves than those of the field
/// to be the reference.
pub(super) const SHELL_ADVANTAGE: f32 = 1.01;

/// Length of the mean of all normals, 0 to 1, from which it says something about each of them. It is
/// shorter where contacts lie all around, as in a thread.
pub(super) const MIN_MEAN_NORMAL: f32 = 0.5;

/// Weight in that mean of a contact whose normals of field and shell are perpendicular or opposed; it
/// is 1 more where they are equal.
pub(super) const MIN_NORMAL_WEIGHT: f32 = 1e-3;

/// Depth, relative to the diagonal of the smallest shell, beyond which the nearest surface may not be
/// the way out.
pub(super) const DEEP_PENETRATION: f32 = 0.02;
