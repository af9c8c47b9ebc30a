//! Triangles: normal, area, closest point, distance and volume.

use glamx::DVec3;

/// The unit normal of a triangle, counter-clockwise seen from its tip; zero without an area.
pub(crate) fn normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a).normalize_or_zero()
}

/// The centroid of a triangle.
pub(crate) fn middle(corners: [DVec3; 3]) -> DVec3 {
    corners.iter().sum::<DVec3>() / 3.0
}

/// The area of a triangle in m².
pub(crate) fn area([a, b, c]: [DVec3; 3]) -> f64 {
    0.5 * (b - a).cross(c - a).length()
}

/// The smallest height of a triangle in metres.
pub(crate) fn width([a, b, c]: [DVec3; 3]) -> f64 {
    let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
    2.0 * area([a, b, c]) / longest.max(f64::MIN_POSITIVE)
}

/// The point of the triangle closest to `p`, by the Voronoi regions of its features (Ericson,
/// Real-Time Collision Detection, 5.1.5).
pub fn closest_point([a, b, c]: [DVec3; 3], p: DVec3) -> DVec3 {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return a;
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return b;
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return c;
    }
    let vc = d1 * d4 - d3 * d2;
    // An edge of zero length is left to the others.
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 && d1 > d3 {
        return a + ab * (d1 / (d1 - d3));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 && d4 - d3 + (d5 - d6) > 0.0 {
        let t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return b + (c - b) * t;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 && d2 > d6 {
        return a + ac * (d2 / (d2 - d6));
    }
    let sum = va + vb + vc;
    let longest = ab.length_squared().max(ac.length_squared());
    // A bound of the rounding error of the squared double area.
    let rounding = f64::EPSILON * longest * longest.max(ap.length_squared());
    if sum * CERTAIN > rounding {
        return a + ab * (vb / sum) + ac * (vc / sum);
    }
    // Degenerate: the closest point of its edges.
    let edges = [(a, b), (b, c), (c, a)].map(|(from, to)| closest_on_segment(from, to, p));
    let nearer = |u: DVec3, v: DVec3| {
        if v.distance_squared(p) < u.distance_squared(p) {
            v
        } else {
            u
        }
    };
    edges.into_iter().fold(a, nearer)
}

/// Largest relative error of the closest point.
const CERTAIN: f64 = 1e-3;

fn closest_on_segment(from: DVec3, to: DVec3, p: DVec3) -> DVec3 {
    let along = to - from;
    let part = (p - from).dot(along) / along.length_squared();
    // NaN for zero length: either end will do.
    from + along
        * if part.is_finite() {
            part.clamp(0.0, 1.0)
        } else {
            0.0
        }
}

/// The distance of two triangles that do not cross, in metres.
pub(crate) fn distance(p: [DVec3; 3], q: [DVec3; 3]) -> f64 {
    let from_corners = p.map(|v| closest_point(q, v) - v);
    let to_corners = q.map(|v| v - closest_point(p, v));
    let edges = |[a, b, c]: [DVec3; 3]| [(a, b), (b, c), (c, a)];
    let between_edges = edges(p)
        .into_iter()
        .flat_map(|e| edges(q).map(|f| between_segments(e, f)));
    let displacements = from_corners.into_iter().chain(to_corners);
    let squares = displacements
        .chain(between_edges)
        .map(DVec3::length_squared);
    squares.fold(f64::INFINITY, f64::min).sqrt()
}

/// The shortest vector between two segments of non-zero length (Ericson, Real-Time Collision
/// Detection, 5.1.9).
fn between_segments((p1, q1): (DVec3, DVec3), (p2, q2): (DVec3, DVec3)) -> DVec3 {
    let (d1, d2, r) = (q1 - p1, q2 - p2, p1 - p2);
    let (a, e, f) = (d1.dot(d1), d2.dot(d2), d2.dot(r));
    let (b, c) = (d1.dot(d2), d1.dot(r));
    let parallel = a * e - b * b;
    let s = if parallel > 0.0 {
        ((b * f - c * e) / parallel).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let t = (b * s + f) / e;
    let (s, t) = match t {
        t if t < 0.0 => ((-c / a).clamp(0.0, 1.0), 0.0),
        t if t > 1.0 => (((b - c) / a).clamp(0.0, 1.0), 1.0),
        t => (s, t),
    };
    p2 + d2 * t - (p1 + d1 * s)
}

/// The signed volume in m³ of the tetrahedron between a triangle and a point.
pub(crate) fn signed_volume(corners: [DVec3; 3], point: DVec3) -> f64 {
    let [a, b, c] = corners.map(|v| v - point);
    a.dot(b.cross(c)) / 6.0
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn vector() -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-2.0..2.0).prop_map(DVec3::from_array)
    }

    proptest! {
        /// No two sampled points of two triangles are closer.
        #[test]
        fn the_distance_of_triangles_is_the_smallest(
            p in prop::array::uniform3(vector()), q in prop::array::uniform3(vector()),
        ) {
            let q = q.map(|v| v + DVec3::X * 4.5);
            let distance = super::distance(p, q);
            let points = |[a, b, c]: [DVec3; 3]| {
                let at = move |i: i32, j: i32| {
                    a + (b - a) * (f64::from(i) / 8.0) + (c - a) * (f64::from(j) / 8.0)
                };
                (0..=8).flat_map(move |i| (0..=8 - i).map(move |j| at(i, j)))
            };
            for a in points(p) {
                for b in points(q) {
                    prop_assert!(distance <= a.distance(b) + 1e-12);
                }
            }
            let least = points(p).map(|a| closest_point(q, a).distance(a)).fold(f64::MAX, f64::min);
            prop_assert!(distance <= least + 1e-12 && distance >= 0.5 * least - 1.0);
        }

        /// With two equal corners, the closest point is that of the remaining edge.
        #[test]
        fn triangles_may_be_edges(a in vector(), b in vector(), p in vector()) {
            let along = ((p - a).dot(b - a) / a.distance_squared(b)).clamp(0.0, 1.0);
            let expected = p.distance(a + (b - a) * along);
            for t in [[a, a, b], [a, b, b], [b, a, b], [b, b, a], [b, a, a], [a, b, a]] {
                prop_assert!((p.distance(closest_point(t, p)) - expected).abs() < 1e-9);
            }
            prop_assert_eq!(closest_point([a; 3], p), a);
        }

        /// A sliver has the closest point of its edge.
        #[test]
        fn slivers_are_as_good_as_edges(a in vector(), b in vector(), p in vector(), ulps in 0..4_i32) {
            let near = f64::EPSILON * f64::from(ulps);
            for c in [b * (1.0 + near), b - DVec3::X * near, a.midpoint(b) + DVec3::Y * near] {
                let expected = closest_on_segment(a, b, p).distance(p);
                let found = closest_point([a, b, c], p);
                prop_assert!((found.distance(p) - expected).abs() < 1e-6, "{found}");
            }
        }

        /// No sampled point of the triangle is closer, and the point lies in the triangle.
        #[test]
        fn the_closest_point_is_closest(t in prop::array::uniform3(vector()), p in vector()) {
            let closest = closest_point(t, p);
            let [a, b, c] = t;
            for i in 0..=20 {
                for j in 0..=20 - i {
                    let (u, v) = (f64::from(i) / 20.0, f64::from(j) / 20.0);
                    let q = a + (b - a) * u + (c - a) * v;
                    prop_assert!(p.distance(closest) <= p.distance(q) + 1e-12);
                }
            }
            // It lies in the triangle: the three parts around it make up the whole.
            let parts = area([closest, a, b]) + area([closest, b, c]) + area([closest, c, a]);
            prop_assert!((parts - area(t)).abs() < 1e-9);
        }
    }
}
