//! Convex hulls of at most so many vertices.

use rapier3d::math::Vector;
use rapier3d::parry::transformation::try_convex_hull;

use crate::convex_hull::support_points;

/// Points of which the convex hull has at most `most` vertices (42 or more) and comes close to the
/// hull of all: starting from support points, the point furthest outside joins until there are
/// enough. `None` if the points lie in a plane.
pub(crate) fn few_hull_vertices(points: &[Vector], most: usize) -> Option<Vec<Vector>> {
    let (all, _) = try_convex_hull(points).ok()?;
    if all.len() <= most {
        return Some(all);
    }
    let mut chosen = support_points(&all);
    while chosen.len() < most {
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
    use crate::single;

    #[test]
    fn a_ball_stays_round() {
        let ball = single(Mesh::icosphere(1.0, 4).unwrap().vertices());
        for most in [42, 100, 300] {
            let few = few_hull_vertices(&ball, most).unwrap();
            assert_eq!(few.len(), most);
            // No direction is cut off by more than a polyhedron with so few corners must.
            for direction in &ball {
                let reach = few.iter().map(|p| p.dot(*direction)).fold(0.0, f32::max);
                assert!(reach > 1.0 - 6.0 / most as f32, "{most}: {reach}");
            }
        }
        assert_eq!(few_hull_vertices(&ball, 9999).unwrap().len(), ball.len());
        assert!(few_hull_vertices(&[Vector::ZERO; 5], 42).is_none());
    }
}
