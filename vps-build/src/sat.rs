//! Overlap of a triangle and a cube by the separating axis theorem (Akenine-Möller, 2001).

use glamx::DVec3;

/// Whether the triangle and the cube around `center` share a point.
///
/// `half` is half the edge of the cube. A touch counts, and rounding is decided in favour of an
/// overlap.
pub(crate) fn overlaps(triangle: [DVec3; 3], center: DVec3, half: f64) -> bool {
    let half = half * (1.0 + 1e-9);
    let [a, b, c] = triangle.map(|v| v - center);
    let low = a.min(b).min(c);
    let high = a.max(b).max(c);
    if low.max_element() > half || high.min_element() < -half {
        return false;
    }
    let edges = [b - a, c - b, a - c];
    let normal = edges[0].cross(edges[1]);
    if normal.dot(a).abs() > half * normal.abs().element_sum() {
        return false;
    }
    for edge in edges {
        for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
            let direction = axis.cross(edge);
            let along = [a, b, c].map(|v| direction.dot(v));
            let low = along[0].min(along[1]).min(along[2]);
            let high = along[0].max(along[1]).max(along[2]);
            let reach = half * direction.abs().element_sum();
            if low > reach || high < -reach {
                return false;
            }
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::triangle::closest_point;

    fn vector(size: f64) -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-size..size).prop_map(DVec3::from_array)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4000))]
        /// Against alternating projections, which converge to the distance of two convex sets.
        #[test]
        fn agrees_with_alternating_projections(t in prop::array::uniform3(vector(3.0))) {
            let mut p = t[0];
            for _ in 0..2000 {
                let in_cube = p.clamp(DVec3::splat(-1.0), DVec3::splat(1.0));
                p = closest_point(t, in_cube).0;
            }
            let gap = p.distance(p.clamp(DVec3::splat(-1.0), DVec3::splat(1.0)));
            // Close to touching, the projections may not have arrived.
            prop_assume!(!(1e-12..1e-2).contains(&gap));
            prop_assert_eq!(overlaps(t, DVec3::ZERO, 1.0), gap < 1e-12);
        }
    }
}
