//! Contact refinement: from a point of the shell to the deepest point of the surface around it.

use glamx::Vec3;

use crate::field::DistanceField;
use crate::query::contact::Contact;
use crate::query::posed::Query;

/// Steps of the ascent at most. Two or three suffice on a ball.
const MAX_STEPS: u32 = 6;

/// Gain of penetration below which the ascent ends, relative to the spacing.
const NEGLIGIBLE_GAIN: f32 = 1e-3;

/// Largest distance of the point where the slope vanishes, in steps, at which the field counts as curved.
const MAX_STRIDE: f32 = 16.0;

/// Newton steps that bring a point back to the surface after a step along its tangent.
const PROJECTIONS: u32 = 2;

impl<F: DistanceField + ?Sized, O> Query<'_, F, O> {
    /// Moves a contact over the surface of the shell's body to where penetration is largest. `surface` is
    /// the field of the shell's own body, in the shell frame, and `spacing` that of the points of the shell
    /// in metres.
    ///
    /// Where the surface is curved in the field, as that of a ball on the ground, a contact comes to the
    /// local maximum of penetration, as do those of other points around it. Where penetration rises
    /// evenly, as on a face that is tilted against the ground, it stays within `spacing` of its point, in
    /// the piece of the surface that the point stands for.
    ///
    /// The contact is at least as deep as before. It lies on the surface of `surface` to within its
    /// [`error_bound`](DistanceField::error_bound), with its normal, and faces the same side.
    ///
    /// An ascent along the surface with secant steps, until a step gains less than a thousandth of the
    /// spacing. Costs one gradient where the surface lies flat in the field, otherwise one or two points of
    /// the surface a step for up to six steps; a point takes six evaluations of the fields.
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
    pub fn refine<S>(&self, contact: &Contact, surface: &S, spacing: f32) -> Contact
    where
        S: DistanceField + ?Sized,
    {
        let ascent = Ascent {
            query: self,
            surface,
            start: contact,
        };
        let (mut best, mut step) = (*contact, spacing);
        for _ in 0..MAX_STEPS {
            let rise = ascent.rise(&best);
            let slope = rise.length();
            if slope.is_nan() || slope * step <= NEGLIGIBLE_GAIN * spacing {
                break;
            }
            let direction = rise / slope;
            let at = |distance: f32| ascent.contact_at(best.position + direction * distance);
            let travelled = best.position.distance(contact.position);
            let Some(ahead) = at(step) else {
                step *= 0.5;
                continue;
            };
            // Where the slope vanishes if it falls evenly.
            let fall = slope - ascent.rise(&ahead).dot(direction);
            let to_top = step * slope / fall;
            let next = if fall > 0.0 && to_top <= MAX_STRIDE * step {
                step = 0.5 * step.min(to_top);
                let top = at(to_top);
                let is_top_deeper = |top: &Contact| top.penetration > ahead.penetration;
                Some(top.filter(is_top_deeper).unwrap_or(ahead))
            } else {
                let is_near = travelled + step <= 1.01 * spacing;
                step *= 0.5;
                is_near.then_some(ahead)
            };
            if let Some(next) = next.filter(|next| next.penetration > best.penetration) {
                best = next;
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
}

impl<F: DistanceField + ?Sized, O, S: DistanceField + ?Sized> Ascent<'_, '_, F, O, S> {
    /// Gradient of the penetration along the surface at a contact, in the shell frame.
    fn rise(&self, contact: &Contact) -> Vec3 {
        let query = self.query;
        let at = query.rotation * contact.position + query.translation;
        let gradient = query.rotation.transpose() * query.field.inward_direction(at);
        gradient.reject_from_normalized(contact.normal)
    }

    /// The contact at the point of the surface that is closest to a point, if it is found and faces the
    /// side of the first contact.
    fn contact_at(&self, point: Vec3) -> Option<Contact> {
        let (query, start) = (self.query, self.start);
        let mut position = point;
        for _ in 0..PROJECTIONS {
            let inward = self.surface.inward_direction(position);
            position -= inward * self.surface.penetration(position, inward);
        }
        let normal = self.surface.inward_direction(position);
        let off = self.surface.penetration(position, normal).abs();
        let rounding = f32::EPSILON * position.length();
        let is_found = off <= self.surface.error_bound() + rounding;
        if !is_found || normal.dot(start.normal) <= 0.0 {
            return None;
        }
        let at = query.rotation * position + query.translation;
        Some(Contact {
            position,
            normal,
            penetration: query.field.penetration(at, query.rotation * normal),
            ..*start
        })
    }
}
