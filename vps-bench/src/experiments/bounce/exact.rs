//! The exact motion of a bouncing ball: parabolas of decreasing height.

/// A ball above a rigid ground.
#[derive(Clone, Copy, Debug)]
pub(super) struct ExactBounce {
    pub(super) radius_m: f64,
    /// Height of the centre at the start, at rest.
    pub(super) drop_height_m: f64,
    pub(super) gravity_m_s2: f64,
    /// Speed after an impact over that before it.
    pub(super) restitution: f64,
}

/// Below this speed the ball rests on the ground, in m/s: bounces are lower than 1e-13 m.
const RESTING_M_S: f64 = 1e-6;

impl ExactBounce {
    fn fall_m(&self) -> f64 {
        self.drop_height_m - self.radius_m
    }

    /// Largest height of the centre after the first impact.
    pub(super) fn first_apex_m(&self) -> f64 {
        self.radius_m + self.restitution * self.restitution * self.fall_m()
    }

    /// Time of the first impact.
    pub(super) fn first_impact_s(&self) -> f64 {
        (2.0 * self.fall_m() / self.gravity_m_s2).sqrt()
    }

    /// Height of the centre.
    pub(super) fn height_m(&self, time_s: f64) -> f64 {
        let g = self.gravity_m_s2;
        let mut since = time_s - self.first_impact_s();
        if since < 0.0 {
            return self.drop_height_m - 0.5 * g * time_s * time_s;
        }
        let mut speed = self.restitution * (2.0 * g * self.fall_m()).sqrt();
        while speed > RESTING_M_S {
            let flight = 2.0 * speed / g;
            if since < flight {
                return self.radius_m + since * (speed - 0.5 * g * since);
            }
            since -= flight;
            speed *= self.restitution;
        }
        self.radius_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ball(restitution: f64) -> ExactBounce {
        ExactBounce {
            radius_m: 0.5,
            drop_height_m: 1.0,
            gravity_m_s2: 10.0,
            restitution,
        }
    }

    /// Compared with a fine numerical integration of the motion.
    #[test]
    fn it_moves_as_an_integration_says() {
        for restitution in [0.1, 0.5, 0.9] {
            let exact = ball(restitution);
            let (mut height, mut velocity) = (exact.drop_height_m, 0.0_f64);
            let step = 1e-6;
            let mut highest: f64 = 0.0;
            for i in 0..1_500_000 {
                let time = f64::from(i) * step;
                let error = (exact.height_m(time) - height).abs();
                assert!(error < 1e-4, "c = {restitution}, {time} s: {error}");
                if time > exact.first_impact_s() + 1e-3 {
                    highest = highest.max(height);
                }
                velocity -= exact.gravity_m_s2 * step;
                height += velocity * step;
                if height < exact.radius_m && velocity < 0.0 {
                    height = exact.radius_m;
                    velocity *= -restitution;
                }
            }
            assert!((highest - exact.first_apex_m()).abs() < 1e-4);
        }
    }

    #[test]
    fn it_comes_to_rest_and_never_enters_the_ground() {
        // All flights take 2 c v / (1 − c) / g.
        let exact = ball(0.5);
        let rests_s = exact.first_impact_s() * (1.0 + 2.0 * 0.5 / (1.0 - 0.5));
        assert!(exact.height_m(rests_s - 1e-3) > 0.5);
        assert_eq!(exact.height_m(rests_s + 1e-3), 0.5);
        assert_eq!(ball(0.0).height_m(1.0), 0.5);
        for i in 0..3000 {
            assert!(ball(0.9).height_m(f64::from(i) * 1e-3) >= 0.5);
        }
    }
}
