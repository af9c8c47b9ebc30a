//! Minimal enclosing balls of points.

use glamx::DVec3;

/// The smallest ball that holds all points: its centre and radius in metres.
///
/// Starting from one point, the furthest point outside joins the support of the ball. The smallest ball
/// of these points, at most five, is found by trying all subsets. The radius grows with every
/// iteration, so the search ends, usually after a dozen iterations of one pass each.
///
/// # Panics
/// When there are no points.
pub fn minimal_ball(points: &[DVec3]) -> (DVec3, f64) {
    let mut support = vec![points[0]];
    let mut ball = (points[0], 0.0);
    loop {
        let distance = |p: &DVec3| p.distance_squared(ball.0);
        let furthest = *points
            .iter()
            .max_by(|a, b| distance(a).total_cmp(&distance(b)))
            .expect("the ball of nothing");
        if furthest.distance(ball.0) <= ball.1 * (1.0 + 1e-12) {
            return ball;
        }
        support.push(furthest);
        let (next, next_support) = smallest_ball_of(&support);
        if next.1 <= ball.1 {
            // The ball cannot grow, by rounding: enlarge it to the last point.
            return (ball.0, furthest.distance(ball.0));
        }
        (ball, support) = (next, next_support);
    }
}

/// The smallest ball of at most five points, and its support.
fn smallest_ball_of(points: &[DVec3]) -> ((DVec3, f64), Vec<DVec3>) {
    let size = points
        .iter()
        .map(|p| p.distance(points[0]))
        .fold(0.0, f64::max);
    let mut smallest = ((points[0], f64::INFINITY), Vec::new());
    for subset in 1_u32..1 << points.len() {
        if subset.count_ones() > 4 {
            continue;
        }
        let chosen: Vec<_> = (0..points.len())
            .filter(|i| subset >> i & 1 == 1)
            .map(|i| points[i])
            .collect();
        let Some((center, radius)) = circumscribed(&chosen) else {
            continue;
        };
        let holds_all = points
            .iter()
            .all(|p| p.distance(center) <= radius + 1e-12 * size);
        if radius < smallest.0.1 && holds_all {
            smallest = ((center, radius), chosen);
        }
    }
    if smallest.1.is_empty() {
        // All spanning subsets are degenerate to rounding: any ball will do.
        let center = points.iter().sum::<DVec3>() / points.len() as f64;
        let radius = points
            .iter()
            .map(|p| p.distance(center))
            .fold(0.0, f64::max);
        smallest = ((center, radius), points[..points.len().min(4)].to_vec());
    }
    smallest
}

/// The smallest ball with up to four points on its surface; `None` if they are affinely dependent.
fn circumscribed(points: &[DVec3]) -> Option<(DVec3, f64)> {
    let origin = points[0];
    let edges: Vec<_> = points[1..].iter().map(|&p| p - origin).collect();
    let n = edges.len();
    // The centre is origin + Σ x_i e_i with 2 e_j · Σ x_i e_i = e_j · e_j for every j.
    let mut rows: Vec<Vec<f64>> = edges
        .iter()
        .map(|a| {
            let gram = edges.iter().map(|b| 2.0 * a.dot(*b));
            gram.chain([a.length_squared()]).collect()
        })
        .collect();
    for column in 0..n {
        let pivot = (column..n).max_by(|&a, &b| {
            let size = |row: usize| rows[row][column].abs();
            size(a).total_cmp(&size(b))
        })?;
        rows.swap(column, pivot);
        let head = rows[column].clone();
        if head[column].abs()
            <= 1e-14 * edges.iter().map(|e| e.length_squared()).fold(0.0, f64::max)
        {
            return None;
        }
        for (r, row) in rows.iter_mut().enumerate() {
            if r != column {
                let factor = row[column] / head[column];
                for (value, from) in row.iter_mut().zip(&head) {
                    *value -= factor * from;
                }
            }
        }
    }
    let center = (0..n)
        .map(|i| edges[i] * (rows[i][n] / rows[i][i]))
        .sum::<DVec3>();
    let radius = points
        .iter()
        .map(|p| p.distance(origin + center))
        .fold(0.0, f64::max);
    (center.is_finite()).then_some((origin + center, radius))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The smallest enclosing ball among the balls of all subsets of up to four points.
    fn brute_force(points: &[DVec3]) -> f64 {
        let mut smallest = f64::INFINITY;
        let n = points.len();
        for subset in 1_u32..1 << n {
            if subset.count_ones() > 4 {
                continue;
            }
            let chosen: Vec<_> = (0..n)
                .filter(|i| subset >> i & 1 == 1)
                .map(|i| points[i])
                .collect();
            if let Some((center, radius)) = circumscribed(&chosen)
                && points
                    .iter()
                    .all(|p| p.distance(center) <= radius * (1.0 + 1e-9) + 1e-12)
            {
                smallest = smallest.min(radius);
            }
        }
        smallest
    }

    fn holds(points: &[DVec3], (center, radius): (DVec3, f64)) -> bool {
        points
            .iter()
            .all(|p| p.distance(center) <= radius * (1.0 + 1e-9) + 1e-15)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(1000))]
        /// Coordinates on a coarse grid make most points duplicate, collinear, coplanar or
        /// cospherical.
        #[test]
        fn as_small_as_the_slow_one(
            coarse in any::<bool>(),
            points in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 1..11)
        ) {
            let snap = |c: f64| if coarse { (2.0 * c).round() } else { c };
            let points: Vec<_> = points.into_iter().map(|p| DVec3::from_array(p.map(snap))).collect();
            let ball = minimal_ball(&points);
            prop_assert!(holds(&points, ball));
            prop_assert!((ball.1 - brute_force(&points)).abs() <= 1e-9, "{} {}", ball.1, brute_force(&points));
        }

        #[test]
        fn many_points_are_held(points in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 100..1000)) {
            let points: Vec<_> = points.into_iter().map(DVec3::from_array).collect();
            let ball = minimal_ball(&points);
            prop_assert!(holds(&points, ball));
            // Dense points on a unit sphere have the unit ball.
            let on_sphere: Vec<_> = points.iter().map(|p| p.normalize_or(DVec3::X)).collect();
            let ball = minimal_ball(&on_sphere);
            prop_assert!(holds(&on_sphere, ball) && ball.1 <= 1.0 + 1e-9 && ball.1 > 0.9);
        }
    }

    #[test]
    fn degenerate_sets_have_balls() {
        let x = DVec3::X;
        assert_eq!(minimal_ball(&[x]), (x, 0.0));
        assert_eq!(minimal_ball(&[x; 9]), (x, 0.0));
        let line: Vec<_> = (0..9).map(|i| x * f64::from(i)).collect();
        assert_eq!(minimal_ball(&line), (x * 4.0, 4.0));
        // Nearly the same point.
        let near: Vec<_> = (0..9)
            .map(|i| x + DVec3::Y * (1e-17 * f64::from(i)))
            .collect();
        assert!(holds(&near, minimal_ball(&near)));
    }
}
