//! Penetration by brute force, independent of the library.

use glamx::DVec3;
use vps_build::Mesh;

/// Penetration of a point in a mesh by brute force. The sign is that of the generalised winding
/// number.
pub(crate) fn exact_penetration(mesh: &Mesh, p: DVec3) -> f64 {
    let (mut closest, mut solid_angle) = (f64::INFINITY, 0.0);
    for corners in mesh.triangles() {
        let t = corners.map(|v| mesh.vertices()[v as usize]);
        closest = closest.min(triangle_distance(t, p));
        let [a, b, c] = t.map(|v| v - p);
        let (la, lb, lc) = (a.length(), b.length(), c.length());
        let denominator = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
        solid_angle += 2.0 * a.dot(b.cross(c)).atan2(denominator);
    }
    let inside = solid_angle > 2.0 * std::f64::consts::PI;
    if inside { closest } else { -closest }
}

/// Independent of the library: the distance to the plane where the projection lies in the triangle,
/// otherwise to the edges.
fn triangle_distance([a, b, c]: [DVec3; 3], p: DVec3) -> f64 {
    let normal = (b - a).cross(c - a);
    let behind = |from: DVec3, to: DVec3| (to - from).cross(p - from).dot(normal) >= 0.0;
    if normal.length() > 0.0 && behind(a, b) && behind(b, c) && behind(c, a) {
        return (p - a).dot(normal.normalize()).abs();
    }
    let edge = |from: DVec3, to: DVec3| {
        let along = to - from;
        let t = ((p - from).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        p.distance(from + along * if t.is_finite() { t } else { 0.0 })
    };
    edge(a, b).min(edge(b, c)).min(edge(c, a))
}
