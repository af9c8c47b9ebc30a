//! The linear system of a step.

use core::array::from_fn;

use glamx::{DMat3, DVec3};

/// Six equations for the velocities: a symmetric matrix in blocks, and the right-hand side.
pub(super) struct System {
    pub(super) linear: DMat3,
    pub(super) mixed: DMat3,
    pub(super) angular: DMat3,
    pub(super) momentum: DVec3,
    pub(super) angular_momentum: DVec3,
}

impl System {
    /// Solves by an LDLᵀ decomposition. `mass` and `inertia` are lower bounds on the pivots, enforced
    /// against rounding.
    pub(super) fn solved(&self, mass: f64, inertia: f64) -> (DVec3, DVec3) {
        let mut matrix: [[f64; 6]; 6] = from_fn(|row| {
            from_fn(|column| match (row / 3, column / 3) {
                (0, 0) => self.linear.col(column)[row],
                (1, 0) => self.mixed.col(column)[row - 3],
                (1, 1) => self.angular.col(column - 3)[row - 3],
                // Only the lower triangle is read.
                _ => 0.0,
            })
        });
        let mut x = [0.0; 6];
        x[..3].copy_from_slice(&self.momentum.to_array());
        x[3..].copy_from_slice(&self.angular_momentum.to_array());
        for j in 0..6 {
            let min_pivot = if j < 3 { mass } else { inertia };
            matrix[j][j] = matrix[j][j].max(min_pivot);
            for i in j + 1..6 {
                let factor = matrix[i][j] / matrix[j][j];
                for row in &mut matrix[i..] {
                    row[i] -= factor * row[j];
                }
                x[i] -= factor * x[j];
            }
        }
        for j in (0..6).rev() {
            let eliminated: f64 = (j + 1..6).map(|i| matrix[i][j] * x[i]).sum();
            x[j] = (x[j] - eliminated) / matrix[j][j];
        }
        (DVec3::from_slice(&x[..3]), DVec3::from_slice(&x[3..]))
    }
}
