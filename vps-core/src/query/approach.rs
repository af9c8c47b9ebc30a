//! The motion of a shell since the previous query.

/// How a shell came to its pose: the distance ahead of it within which contacts of the next step count
/// in a [`ContactManifold`](crate::ContactManifold).
///
/// ```
/// use vps_core::Approach;
///
/// // The shell moved 2 mm towards the solid since the previous step.
/// let approach = Approach::Moved(0.002);
/// assert_ne!(approach, Approach::RESTING);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Approach {
    /// It has moved this far since the previous query, towards the solid or away from it, in metres.
    /// It is assumed to move as far in the next step.
    Moved(f32),
    /// Its motion is unknown: at the previous query it was further away than the prediction distance,
    /// or there was none. It is assumed to move on by the separation of its deepest point.
    Unknown,
}

impl Approach {
    /// The shell has not moved.
    pub const RESTING: Self = Self::Moved(0.0);
}
