//! Simplification of convex hulls.

use rapier3d::math::Vector;
use rapier3d::parry::transformation::try_convex_hull;

use crate::algorithms::convex_hull::support_points;

/// Points whose convex hull has at most `max_vertices` vertices (42 or more) and approximates the
/// hull of all points: starting from support points, the point furthest outside is added until
/// there are enough. `None` if the points lie in a plane.
pub(super) fn simplify_hull(points: &[Vector], max_vertices: usize) -> Option<Vec<Vector>> {
    let (all, _) = try_convex_hull(points).ok()?;
    if all.len() <= max_vertices {
        return Some(all);
    }
    let mut chosen = support_points(&all);
    while chosen.len() < max_vertices {
        let (corners, faces) = try_convex_hull(&chosen).ok()?;
        let planes: Vec<_> = faces
            .iter()
            .filter_map(|&[a, b, c]| {
                let [a, b, c] = [a, b, c].map(|i| corners[i as usize]);
                Some((a, (b - a).cross(c - a).try_normalize()?))
            })
            .collect();
        let outside = |p: &Vector| {
            let distances = planes.iter().map(|(on, normal)| (*p - *on).dot(*normal));
            distances.fold(f32::NEG_INFINITY, f32::max)
        };
        let furthest = all
            .iter()
            .max_by(|a, b| outside(a).total_cmp(&outside(b)))?;
        if chosen.contains(furthest) {
            break;
        }
        chosen.push(*furthest);
    }
    Some(chosen)
}

#[cfg(test)]
mod tests {
    use vps_build::Mesh;

    use super::*;
    use crate::precision::single;

    #[test]
    fn a_simplified_ball_stays_round() {
        let ball = single(Mesh::icosphere(1.0, 4).unwrap().vertices());
        for most in [42, 100, 300] {
            let few = simplify_hull(&ball, most).unwrap();
            assert_eq!(few.len(), most);
            // The error in any direction is that of a polyhedron with so few vertices.
            for direction in &ball {
                let reach = few.iter().map(|p| p.dot(*direction)).fold(0.0, f32::max);
                assert!(reach > 1.0 - 6.0 / most as f32, "{most}: {reach}");
            }
        }
        assert_eq!(simplify_hull(&ball, 9999).unwrap().len(), ball.len());
        assert!(simplify_hull(&[Vector::ZERO; 5], 42).is_none());
    }
}
