//! A triangle and a point: the closest point, and the volume between them.

use glamx::DVec3;

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
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return a + ab * (d1 / (d1 - d3));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return b + (c - b) * t;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return a + ac * (d2 / (d2 - d6));
    }
    let inverse = 1.0 / (va + vb + vc);
    a + ab * (vb * inverse) + ac * (vc * inverse)
}

/// Of the tetrahedron between a triangle and a point, in m³.
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
            let area = |a: DVec3, b: DVec3, c: DVec3| (b - a).cross(c - a).length();
            let parts = area(closest, a, b) + area(closest, b, c) + area(closest, c, a);
            prop_assert!((parts - area(a, b, c)).abs() < 1e-9);
        }
    }
}
