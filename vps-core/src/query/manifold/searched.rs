//! Contact reduction during the search, without a list of all contacts.

use glamx::Vec3;

use super::ContactManifold;
use super::buffer::CandidateBuffer;
use super::collectors::{BestCandidate, OffPlane};
use super::polygon::Polygon;
use super::source::CandidateSource;
use super::weighting::DepthWeighting;
use crate::field::DistanceField;
use crate::query::contact::Contact;
use crate::query::observer::Observer;
use crate::query::posed::Query;
use crate::query::search::ROOT;

/// The contacts of a query, some of them buffered.
struct SearchedCandidates<'q, 't, F: ?Sized, O> {
    query: &'q Query<'t, F, O>,
    buffer: CandidateBuffer,
}

impl<F: DistanceField + ?Sized, O: Observer> Query<'_, F, O> {
    /// The manifold of the contact set, its area seen along the field's normal at the deepest
    /// point. It equals that of [`ContactManifold::reduce`], but not all contacts are visited.
    ///
    /// One search finds the deepest contact and those of sufficient weight. If these are too few, a
    /// second search finds those of low weight. Contacts of even lower weight, or that do not fit
    /// on the stack, are searched for one by one as far as they could have a higher score.
    ///
    /// ```
    /// use vps_core::{HalfSpace, PointSphereTree, Pose3, Query, Vec3};
    ///
    /// // The ends of a peg that stands on the ground, one of them 10 mm too deep.
    /// let (low, high) = (Vec3::new(0.0, -0.01, 0.0), Vec3::new(0.0, 0.2, 0.0));
    /// let tree = PointSphereTree::flat(&[low, high], &[Vec3::Y, Vec3::NEG_Y], 1e-4)?;
    /// let ground = HalfSpace::new(Vec3::Y);
    /// let manifold = Query::new(&tree, &ground, Pose3::IDENTITY).with_prediction(1.0).manifold::<4>();
    /// assert_eq!(manifold.contacts()[0].point_index, 0);
    /// # Ok::<(), vps_core::TreeError>(())
    /// ```
    pub fn manifold<const N: usize>(&self) -> ContactManifold<N> {
        // Most bodies of a scene are apart: the buffer is not initialised for them.
        if !self.may_touch() {
            return ContactManifold::EMPTY;
        }
        let weighting = DepthWeighting {
            prediction: self.prediction,
            approach: self.approach,
        };
        let mut source = SearchedCandidates {
            query: self,
            buffer: CandidateBuffer::new(weighting),
        };
        self.collect_from_hint(&mut source.buffer);
        source.buffer.discard_shallow();
        let deepest = source.buffer.deepest.found;
        let along = |deepest: &Contact| {
            let at = self.rotation * deepest.position + self.translation;
            let inward = self.rotation.transpose() * self.field.inward_direction(at);
            if inward == Vec3::ZERO {
                -deepest.normal
            } else {
                inward
            }
        };
        ContactManifold::select(deepest, along, weighting, &mut source, &self.observer)
    }
}

impl<F, O, const N: usize> CandidateSource<N> for SearchedCandidates<'_, '_, F, O>
where
    F: DistanceField + ?Sized,
    O: Observer,
{
    fn best(&mut self, polygon: &Polygon<N>) -> Option<Contact> {
        let buffer = &mut self.buffer;
        if polygon.penetration_threshold < buffer.threshold
            && !buffer.is_full
            && !buffer.includes_low_weights
        {
            buffer.lower_threshold();
            self.query.multiversion(
                #[inline(always)]
                || self.query.search(ROOT, buffer),
            );
        }
        let mut best = BestCandidate {
            polygon,
            added_from: f32::INFINITY,
            threshold: f32::MIN_POSITIVE,
            found: None,
        };
        if !buffer.is_full {
            self.query.multiversion(
                #[inline(always)]
                || buffer.add_to(self.query.tree, &mut best),
            );
            if buffer.threshold <= polygon.penetration_threshold {
                return best.found;
            }
            best.added_from = buffer.threshold;
        }
        self.query.collect(best).found
    }

    fn is_curved(&self, polygon: &Polygon<N>) -> bool {
        if self.buffer.is_full {
            return self.query.collect(OffPlane::new(polygon)).found;
        }
        let mut candidates = self.buffer.candidates[..self.buffer.len].iter();
        candidates.any(|batch| {
            let positions = batch.positions(self.query.tree);
            polygon.off_plane(positions, batch.penetrations()).any()
        })
    }

    fn for_each(&self, visit: impl FnMut(Contact)) {
        self.query.observed_by(()).for_each_contact(visit);
    }
}
