//! Inertia of solids.

use rapier3d::math::{Matrix, Vector};

/// The inertia tensor of a solid ball about its centre.
pub(crate) fn ball_inertia(mass_kg: f64, radius_m: f64) -> Matrix {
    Matrix::from_diagonal(Vector::splat((0.4 * mass_kg * radius_m * radius_m) as f32))
}
