//! Overlap of a triangle and a cube by the separating axis theorem (Akenine-Möller, 2001).

use glamx::DVec3;

/// Whether the triangle and the cube around `center` share a point. `half` is half the edge of the
/// cube. Touching counts, and rounding favours an overlap.
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

    fn vector(size: f64) -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-size..size).prop_map(DVec3::from_array)
    }

    /// Whether the triangle clipped to the cube is not empty (Sutherland and Hodgman).
    fn left_of(triangle: [DVec3; 3], half: f64) -> bool {
        let mut polygon = triangle.to_vec();
        for axis in 0..3 {
            for side in [-1.0, 1.0] {
                let depth = |p: DVec3| half - side * p[axis];
                let mut cut = Vec::new();
                for (i, &from) in polygon.iter().enumerate() {
                    let to = polygon[(i + 1) % polygon.len()];
                    if depth(from) >= 0.0 {
                        cut.push(from);
                    }
                    if (depth(from) >= 0.0) != (depth(to) >= 0.0) {
                        cut.push(from.lerp(to, depth(from) / (depth(from) - depth(to))));
                    }
                }
                polygon = cut;
            }
        }
        !polygon.is_empty()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(4000))]
        #[test]
        fn agrees_with_clipping(t in prop::array::uniform3(vector(3.0))) {
            let (tight, wide) = (left_of(t, 1.0 - 1e-6), left_of(t, 1.0 + 1e-6));
            // Touching is ambiguous.
            prop_assume!(tight == wide);
            prop_assert_eq!(overlaps(t, DVec3::ZERO, 1.0), tight);
        }
    }
}
