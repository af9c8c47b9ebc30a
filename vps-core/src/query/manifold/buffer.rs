//! Candidates buffered on the stack.

use wide::f32x4;

use super::collectors::BestCandidate;
use super::polygon::Polygon;
use super::weighting::{DepthWeighting, MIN_FILL_WEIGHT, MIN_WEIGHT};
use crate::query::collectors::{Collector, DeepestContact, TestedPoints};
use crate::query::contact::Contact;
use crate::shell::PointSphereTree;
use crate::simd::{LANES, Points, Vectors, lanes_in};

/// Capacity of the buffer in batches.
const CAPACITY: usize = 256;

/// Points that were tested together.
#[derive(Clone, Copy)]
pub(super) struct Batch {
    /// Index of the first point.
    first: u32,
    /// In metres; minus infinity for points that are not in contact.
    penetrations: [f32; LANES],
}

impl Batch {
    #[inline(always)]
    pub(super) fn positions(&self, tree: &PointSphereTree<'_>) -> Vectors {
        Points::read(tree.points(), self.first as usize).into()
    }

    #[inline(always)]
    pub(super) fn penetrations(&self) -> f32x4 {
        f32x4::new(self.penetrations)
    }
}

/// The deepest contact, and the contacts of sufficient weight.
pub(super) struct CandidateBuffer {
    weighting: DepthWeighting,
    /// The lowest penetration of buffered contacts, in metres.
    pub(super) threshold: f32,
    pub(super) deepest: DeepestContact,
    pub(super) candidates: [Batch; CAPACITY],
    pub(super) len: usize,
    pub(super) is_full: bool,
    /// Whether contacts of low weight were searched for.
    pub(super) includes_low_weights: bool,
}

impl CandidateBuffer {
    pub(super) fn new(weighting: DepthWeighting) -> Self {
        let empty = Batch {
            first: 0,
            penetrations: [f32::NEG_INFINITY; LANES],
        };
        Self {
            weighting,
            threshold: -weighting.prediction,
            deepest: DeepestContact::new(weighting.prediction),
            candidates: [empty; CAPACITY],
            len: 0,
            is_full: false,
            includes_low_weights: false,
        }
    }

    /// Adds the candidates to a collector. The batch with the highest score before the weight of its
    /// normal comes first, so that few others can exceed the threshold. Scores are computed twice,
    /// which costs less than memory for all of them.
    #[inline(always)]
    pub(super) fn add_to<const N: usize>(
        &self,
        tree: &PointSphereTree<'_>,
        best: &mut BestCandidate<'_, N>,
    ) {
        let candidates = &self.candidates[..self.len];
        let scores_in = |batch: &Batch, polygon: &Polygon<N>| {
            polygon.scores(batch.positions(tree), batch.penetrations())
        };
        let (mut max_score, mut first) = (best.threshold, 0);
        for (i, batch) in candidates.iter().enumerate() {
            let scores = scores_in(batch, best.polygon).to_array();
            let highest = scores.into_iter().fold(max_score, f32::max);
            if highest > max_score {
                (max_score, first) = (highest, i);
            }
        }
        for batch in candidates[first..].iter().chain(&candidates[..first]) {
            let scores = scores_in(batch, best.polygon);
            for lane in lanes_in(scores.simd_ge(f32x4::splat(best.threshold))) {
                let penetration = batch.penetrations[lane];
                let contact = Contact::of(tree, batch.first + lane as u32, penetration);
                best.consider(contact, scores.to_array()[lane]);
            }
        }
    }

    #[inline(always)]
    fn push(&mut self, batch: Batch) {
        if self.len == CAPACITY {
            self.discard_shallow();
        }
        if self.len == CAPACITY {
            self.is_full = true;
            self.threshold = self.deepest.threshold;
            return;
        }
        self.candidates[self.len] = batch;
        self.len += 1;
    }

    /// Empties the buffer and lowers the threshold, for another search that includes contacts of low
    /// weight.
    pub(super) fn lower_threshold(&mut self) {
        self.threshold = self
            .weighting
            .min_penetration(self.deepest.threshold, MIN_FILL_WEIGHT);
        (self.len, self.includes_low_weights) = (0, true);
    }

    /// Discards batches below the threshold, which may have risen since they were buffered.
    #[inline(always)]
    pub(super) fn discard_shallow(&mut self) {
        let mut kept = 0;
        for i in 0..self.len {
            self.candidates[kept] = self.candidates[i];
            let contact_mask = self.candidates[i]
                .penetrations()
                .simd_ge(f32x4::splat(self.threshold));
            kept += usize::from(contact_mask.any());
        }
        self.len = kept;
    }
}

impl Collector for CandidateBuffer {
    const BEST_FIRST: bool = true;

    #[inline(always)]
    fn penetration_threshold(&self) -> f32 {
        self.threshold
    }

    #[inline(always)]
    fn add(&mut self, found: &TestedPoints<'_>) -> bool {
        let previous_threshold = self.deepest.threshold;
        self.deepest.add(found);
        if self.deepest.threshold > previous_threshold {
            self.threshold = if self.is_full {
                self.deepest.threshold
            } else {
                self.weighting
                    .min_penetration(self.deepest.threshold, MIN_WEIGHT)
            };
        }
        if !self.is_full {
            let empty = f32x4::splat(f32::NEG_INFINITY);
            self.push(Batch {
                first: found.first,
                penetrations: found
                    .contact_mask
                    .select(found.penetrations, empty)
                    .to_array(),
            });
        }
        true
    }
}
