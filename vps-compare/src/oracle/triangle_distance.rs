//! The distance of two triangles.

use glamx::DVec3;
use vps_build::closest_point;

/// The squared distance between two triangles, 0 if they meet: between a corner and the other
/// triangle, or between two edges.
pub(super) fn squared_distance(a: [DVec3; 3], b: [DVec3; 3]) -> f64 {
    let meets = |of: [DVec3; 3], other| edges(of).any(|edge| passes(edge, other));
    if meets(a, b) || meets(b, a) {
        return 0.0;
    }
    let to_corners = |from: [DVec3; 3], to: [DVec3; 3]| {
        let distance = |p: DVec3| closest_point(from, p).distance_squared(p);
        to.map(distance).into_iter().fold(f64::INFINITY, f64::min)
    };
    let mut least = to_corners(a, b).min(to_corners(b, a));
    for first in edges(a) {
        for second in edges(b) {
            least = least.min(between_segments(first, second));
        }
    }
    least
}

fn edges([a, b, c]: [DVec3; 3]) -> impl Iterator<Item = [DVec3; 2]> {
    [[a, b], [b, c], [c, a]].into_iter()
}

/// Whether a segment goes from one side of a triangle's plane to the other, through the triangle.
fn passes([from, to]: [DVec3; 2], [a, b, c]: [DVec3; 3]) -> bool {
    let normal = (b - a).cross(c - a);
    let (before, behind) = (normal.dot(from - a), normal.dot(to - a));
    if before == behind || before * behind > 0.0 {
        return false;
    }
    let at = from + (to - from) * (before / (before - behind));
    edges([a, b, c]).all(|[p, q]| (q - p).cross(at - p).dot(normal) >= 0.0)
}

/// Ericson, Real-Time Collision Detection, 5.1.9.
fn between_segments([p1, q1]: [DVec3; 2], [p2, q2]: [DVec3; 2]) -> f64 {
    let (d1, d2, r) = (q1 - p1, q2 - p2, p1 - p2);
    let (a, e, f) = (d1.length_squared(), d2.length_squared(), d2.dot(r));
    let share = |part: f64, whole: f64| {
        if whole > 0.0 {
            (part / whole).clamp(0.0, 1.0)
        } else {
            0.0
        }
    };
    let (b, c) = (d1.dot(d2), d1.dot(r));
    // The parameter of the first segment where the lines are closest, then that of the second, then
    // the first again for an end of the second.
    let s = share(b * f - c * e, a * e - b * b);
    let t = share(b * s + f, e);
    let s = share(b * t - c, a);
    (p1 + d1 * s).distance_squared(p2 + d2 * t)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn triangle() -> impl Strategy<Value = [DVec3; 3]> {
        let corner = || prop::array::uniform3(-1.0..1.0_f64).prop_map(DVec3::from_array);
        prop::array::uniform3(corner())
    }

    /// By alternating projections: the distance of convex sets has a single minimum.
    fn by_alternating_projections(a: [DVec3; 3], b: [DVec3; 3]) -> f64 {
        let mut on_a = (a[0] + a[1] + a[2]) / 3.0;
        let mut on_b = on_a;
        for _ in 0..20_000 {
            on_b = closest_point(b, on_a);
            on_a = closest_point(a, on_b);
        }
        on_a.distance(on_b)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(300))]
        #[test]
        fn the_distance_is_that_of_the_closest_points(a in triangle(), b in triangle(), up in 0.0..2.0_f64) {
            let b = b.map(|p| p + DVec3::Z * up);
            let found = squared_distance(a, b).sqrt();
            prop_assert!((found - squared_distance(b, a).sqrt()).abs() < 1e-9);
            let expected = by_alternating_projections(a, b);
            prop_assert!(found <= expected + 1e-12, "{} {}", found, expected);
            // Alternating projections converge slowly where the triangles meet.
            prop_assert!(expected - found < 2e-2, "{} {}", found, expected);
            if found > 0.1 {
                prop_assert!(expected - found < 1e-4, "{} {}", found, expected);
            }
        }
    }

    #[test]
    fn parallel_crossing_and_touching() {
        let flat = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let at = |offset: DVec3| flat.map(|p| p + offset);
        assert_eq!(squared_distance(flat, at(DVec3::Z * 0.5)), 0.25);
        assert_eq!(squared_distance(flat, at(DVec3::X * 3.0)), 4.0);
        assert_eq!(squared_distance(flat, at(DVec3::X * 0.2)), 0.0);
        let through = [
            DVec3::new(0.2, 0.2, -1.0),
            DVec3::new(0.2, 0.2, 1.0),
            DVec3::new(5.0, 5.0, 0.5),
        ];
        assert_eq!(squared_distance(flat, through), 0.0);
        assert_eq!(squared_distance(through, flat), 0.0);
    }
}
