use glamx::Vec3;

use crate::Contact;

/// At which fraction of the margin outside of the solid a contact counts half.
const CLOSE: f32 = 0.01;

/// At most `N` contacts that stand for a contact set: the deepest one first, then those that
/// spread the manifold over the largest area (section 3.2).
#[derive(Clone, Copy, Debug)]
pub struct ContactManifold<const N: usize> {
    contacts: [Contact; N],
    len: usize,
}

impl<const N: usize> ContactManifold<N> {
    /// Picks from `contacts`, found by a query with `margin` metres. The area is that of the polygon
    /// of the picked points seen `along` a direction in the shell frame, such as the normal of the
    /// field at the deepest point.
    ///
    /// What a point adds to the area counts less the further outside of the solid it is, half at a
    /// hundredth of the margin: the points a body stands on come before those that lie further
    /// apart above the ground, without which it would sink and rise and never rest. Of equally
    /// good contacts the first is taken. Costs `N` passes.
    pub fn spread(contacts: &[Contact], along: Vec3, margin: f32) -> Self {
        let nothing = Contact {
            point: 0,
            position: Vec3::ZERO,
            normal: Vec3::ZERO,
            penetration: 0.0,
        };
        let mut manifold = Self {
            contacts: [nothing; N],
            len: 0,
        };
        let Some(&deepest) = best(contacts, |c| Some(c.penetration)) else {
            return manifold;
        };
        let close = (margin * CLOSE).max(f32::MIN_POSITIVE);
        // Corners of the polygon in order, which is not the order of picking.
        let mut ring = [Vec3::ZERO; N];
        if N > 0 {
            manifold.push(deepest);
            ring[0] = deepest.position;
        }
        while manifold.len < N {
            let corners = &ring[..manifold.len];
            let gain = |c: &Contact| {
                let (_, area) = best_edge(corners, c.position, along);
                let outside = (-c.penetration).max(0.0);
                let far = outside / close;
                let weight = 1.0 / (1.0 + far * far);
                (area * weight > 0.0).then_some(area * weight)
            };
            let Some(&next) = best(contacts, gain) else {
                break;
            };
            let (edge, _) = best_edge(corners, next.position, along);
            ring.copy_within(edge + 1..manifold.len, edge + 2);
            ring[edge + 1] = next.position;
            manifold.push(next);
            if manifold.len == 3 && doubled_area(ring[0], ring[1], ring[2], along) < 0.0 {
                // From here on the polygon runs counter-clockwise.
                ring.swap(1, 2);
            }
        }
        manifold
    }

    /// The picked contacts, deepest first.
    pub fn contacts(&self) -> &[Contact] {
        &self.contacts[..self.len]
    }

    fn push(&mut self, contact: Contact) {
        self.contacts[self.len] = contact;
        self.len += 1;
    }
}

/// The first contact with the largest score; those without one are left out.
fn best(contacts: &[Contact], score: impl Fn(&Contact) -> Option<f32>) -> Option<&Contact> {
    let mut best: Option<(f32, &Contact)> = None;
    for contact in contacts {
        if let Some(score) = score(contact)
            && best.is_none_or(|(most, _)| score > most)
        {
            best = Some((score, contact));
        }
    }
    best.map(|(_, contact)| contact)
}

/// The edge of a polygon behind which `point` adds the most, and how much: a length for a single
/// corner, otherwise twice an area, only what lies outside of the polygon.
fn best_edge(corners: &[Vec3], point: Vec3, normal: Vec3) -> (usize, f32) {
    match *corners {
        [a] => (0, point.distance(a)),
        [a, b] => (1, doubled_area(a, b, point, normal).abs()),
        _ => {
            let gain = |i: usize| {
                let next = corners[(i + 1) % corners.len()];
                // Negative on the outer side of a counter-clockwise edge.
                -doubled_area(corners[i], next, point, normal)
            };
            (0..corners.len())
                .map(|i| (i, gain(i)))
                .fold(
                    (0, 0.0),
                    |most, edge| if edge.1 > most.1 { edge } else { most },
                )
        }
    }
}

/// Twice the area of a triangle seen along `normal`, positive when it runs counter-clockwise.
fn doubled_area(a: Vec3, b: Vec3, c: Vec3, normal: Vec3) -> f32 {
    (b - a).cross(c - a).dot(normal)
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::*;

    fn contact(point: u32, x: f32, z: f32, penetration: f32) -> Contact {
        Contact {
            point,
            position: Vec3::new(x, 0.0, z),
            normal: Vec3::Y,
            penetration,
        }
    }

    fn picked<const N: usize>(contacts: &[Contact]) -> Vec<u32> {
        let manifold = ContactManifold::<N>::spread(contacts, Vec3::Y, 0.1);
        manifold.contacts().iter().map(|c| c.point).collect()
    }

    #[test]
    fn the_deepest_comes_first_and_the_corners_follow() {
        // A 5 x 5 grid of contacts, deepest in the middle of one side.
        let contacts: Vec<_> = (0..25)
            .map(|i| {
                let (x, z) = ((i % 5) as f32, (i / 5) as f32);
                contact(i, x, z, if i == 2 { 1.0 } else { 0.5 })
            })
            .collect();
        let mut four = picked::<4>(&contacts);
        assert_eq!(four[0], 2);
        four.sort_unstable();
        // (2, 0) with a far corner, and two more that span the largest quadrilateral.
        assert_eq!(four.len(), 4);
        assert!(four.contains(&20) && four.contains(&24));
        let mut five = picked::<5>(&contacts);
        five.sort_unstable();
        assert_eq!(five, [0, 2, 4, 20, 24]);
    }

    #[test]
    fn a_point_that_touches_comes_before_one_above_it() {
        let mut contacts = std::vec![contact(0, 0.0, 0.0, 0.01), contact(1, 4.0, 0.0, 0.0)];
        // A little further out, and half of the margin away.
        contacts.push(contact(2, 4.5, 0.0, -0.05));
        assert_eq!(picked::<2>(&contacts), [0, 1]);
        contacts.remove(1);
        assert_eq!(picked::<2>(&contacts), [0, 2]);
    }

    #[test]
    fn points_that_add_no_area_are_not_picked() {
        let line: Vec<_> = (0..9).map(|i| contact(i, i as f32, 0.0, 0.1)).collect();
        assert_eq!(picked::<4>(&line), [0, 8]);
        assert_eq!(picked::<4>(&[contact(3, 0.0, 0.0, 0.1); 7]), [3]);
        assert_eq!(picked::<4>(&[]), []);
        assert_eq!(picked::<0>(&line), []);
    }
}
