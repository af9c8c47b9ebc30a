//! Contact refinement: from a point of the shell to the deepest point of the surface around it.

use glamx::Vec3;

use crate::field::DistanceField;
use crate::query::contact::Contact;
use crate::query::posed::Query;

/// Steps of the ascent at most. Each about squares the error.
const MAX_STEPS: u32 = 4;

/// Gain of penetration below which the ascent ends, relative to the reach.
const NEGLIGIBLE_GAIN: f32 = 1e-3;

/// Newton steps that bring a point back to the surface, of which it is off by the square of a step.
const PROJECTIONS: u32 = 2;

impl<F: DistanceField + ?Sized, O> Query<'_, F, O> {
    /// Moves a contact over the surface of the shell's body to where penetration is largest, within about
    /// `reach` metres of its point; with the spacing of the points as the reach, to the deepest point of
    /// the piece of the surface that it stands for. `surface` is the field of the shell's own body, in
    /// the shell frame.
    ///
    /// The contact is at least as deep as before, and lies on the surface to within
    /// [`error_bound`](DistanceField::error_bound) of `surface`, so that it is no deeper than the deepest
    /// point by more than that. Its normal is that of `surface`. It stays on its side of a thin wall.
    ///
    /// An ascent along the surface with secant steps, until a step gains less than a thousandth of the
    /// reach. Costs one gradient where the surface lies flat in the field, otherwise two or three
    /// evaluations of both fields a step, for one to three steps.
    ///
    /// ```
    /// use vps_core::{Ball, HalfSpace, PointSphereTree, Pose3, Query, Vec3};
    ///
    /// // A point of a ball of 0.5 m, 6 degrees beside its lowest point, which is 10 mm deep.
    /// let beside = 0.5 * Vec3::new(0.1, -1.0, 0.0).normalize();
    /// let tree = PointSphereTree::flat(&[beside], &[-2.0 * beside], 1e-4)?;
    /// let ground = HalfSpace::new(Vec3::Y);
    /// let query = Query::new(&tree, &ground, Pose3::from_translation(0.49 * Vec3::Y));
    /// let sample = query.deepest().unwrap();
    /// assert!(sample.penetration < 0.008);
    /// let contact = query.refine(&sample, &Ball::new(0.5), 0.1);
    /// assert!((contact.penetration - 0.01).abs() < 1e-6);
    /// assert!(contact.position.distance(Vec3::new(0.0, -0.5, 0.0)) < 1e-3);
    /// # Ok::<(), vps_core::TreeError>(())
    /// ```
    pub fn refine<S>(&self, contact: &Contact, surface: &S, reach: f32) -> Contact
    where
        S: DistanceField + ?Sized,
    {
        let ascent = Ascent {
            query: self,
            surface,
            start: contact,
            reach,
        };
        let negligible = NEGLIGIBLE_GAIN * reach;
        let (mut best, mut step) = (*contact, reach);
        for _ in 0..MAX_STEPS {
            let rise = ascent.rise(&best);
            let slope = rise.length();
            if slope.is_nan() || slope * step <= negligible {
                break;
            }
            let direction = rise / slope;
            let ahead = ascent.contact_at(best.position + direction * step);
            let slope_ahead = ascent.rise(&ahead).dot(direction);
            let next = if slope_ahead < 0.0 {
                // Past the deepest point: as far as the slope falls to zero, if it falls evenly.
                step *= slope / (slope - slope_ahead);
                let between = ascent.contact_at(best.position + direction * step);
                if between.is_deeper_than(Some(&ahead)) {
                    between
                } else {
                    ahead
                }
            } else {
                ahead
            };
            if next.penetration > best.penetration {
                best = next;
            } else {
                step *= 0.5;
            }
        }
        best
    }
}

/// The way up from a contact.
struct Ascent<'a, 'q, F: ?Sized, O, S: ?Sized> {
    query: &'a Query<'q, F, O>,
    surface: &'a S,
    start: &'a Contact,
    reach: f32,
}

impl<F: DistanceField + ?Sized, O, S: DistanceField + ?Sized> Ascent<'_, '_, F, O, S> {
    /// Gradient of the penetration along the surface at a contact, in the shell frame.
    fn rise(&self, contact: &Contact) -> Vec3 {
        let query = self.query;
        let at = query.rotation * contact.position + query.translation;
        let gradient = query.rotation.transpose() * query.field.inward_direction(at);
        gradient.reject_from_normalized(contact.normal)
    }

    /// The contact at the point of the surface that is closest to a point in reach; the first contact where
    /// that is on another side.
    fn contact_at(&self, point: Vec3) -> Contact {
        let (query, start) = (self.query, self.start);
        let mut position = start.position + (point - start.position).clamp_length_max(self.reach);
        for _ in 0..PROJECTIONS {
            let inward = self.surface.inward_direction(position);
            position -= inward * self.surface.penetration(position, inward);
        }
        let normal = self.surface.inward_direction(position);
        if normal.dot(start.normal) <= 0.0 {
            return *start;
        }
        let at = query.rotation * position + query.translation;
        Contact {
            position,
            normal,
            penetration: query.field.penetration(at, query.rotation * normal),
            ..*start
        }
    }
}
