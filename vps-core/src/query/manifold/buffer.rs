//! Candidates kept on the stack.

use wide::f32x4;

use super::collectors::Spread;
use super::weighting::{Closeness, KEPT_WEIGHT, LEAST_WEIGHT};
use crate::query::collectors::Deepest;
use crate::query::contact::Contact;
use crate::query::search::{Found, Goal};
use crate::shell::PointSphereTree;
use crate::simd::{LANES, Points, Vectors, lanes_in};

/// How many groups of contacts are kept for the manifold, on the stack.
const KEPT: usize = 256;

/// Points that were tested together.
#[derive(Clone, Copy)]
pub(super) struct Group {
    /// The first one's number.
    first: u32,
    /// Minus infinity for those that do not count.
    penetrations: [f32; LANES],
}

impl Group {
    #[inline(always)]
    pub(super) fn positions(&self, tree: &PointSphereTree<'_>) -> Vectors {
        Points::read(tree.points(), self.first as usize).into()
    }

    #[inline(always)]
    pub(super) fn penetrations(&self) -> f32x4 {
        f32x4::new(self.penetrations)
    }
}

/// The deepest contact, and those that count enough.
pub(super) struct Near {
    closeness: Closeness,
    /// Contacts less deep are not kept.
    pub(super) least: f32,
    pub(super) deepest: Deepest,
    pub(super) kept: [Group; KEPT],
    pub(super) len: usize,
    pub(super) is_full: bool,
    /// Whether those that count a little were asked for.
    pub(super) has_reached: bool,
}

impl Near {
    pub(super) fn new(closeness: Closeness) -> Self {
        let none = Group {
            first: 0,
            penetrations: [f32::NEG_INFINITY; LANES],
        };
        Self {
            closeness,
            least: -closeness.margin,
            deepest: Deepest::new(closeness.margin),
            kept: [none; KEPT],
            len: 0,
            is_full: false,
            has_reached: false,
        }
    }

    /// Offers what was kept, first what is best but for its normal: little of the rest is left then
    /// that could be better.
    #[inline(always)]
    pub(super) fn offer_to<const N: usize>(
        &self,
        tree: &PointSphereTree<'_>,
        spread: &mut Spread<'_, N>,
    ) {
        let kept = &self.kept[..self.len];
        let mut scores = [f32x4::ZERO; KEPT];
        let mut most = f32x4::splat(spread.least);
        for (group, scores) in kept.iter().zip(&mut scores) {
            *scores = spread
                .polygon
                .scores(group.positions(tree), group.penetrations());
            most = most.fast_max(*scores);
        }
        let most = most.to_array().into_iter().fold(spread.least, f32::max);
        for is_rest in [false, true] {
            for (group, scores) in kept.iter().zip(scores) {
                let from = if is_rest { spread.least } else { most };
                for lane in lanes_in(scores.simd_ge(f32x4::splat(from))) {
                    let penetration = group.penetrations[lane];
                    let contact = Contact::of(tree, group.first + lane as u32, penetration);
                    spread.consider(contact, scores.to_array()[lane]);
                }
            }
        }
    }

    #[inline(always)]
    fn keep(&mut self, group: Group) {
        if self.len == KEPT {
            self.drop_shallow();
        }
        if self.len == KEPT {
            self.is_full = true;
            self.least = self.deepest.least;
            return;
        }
        self.kept[self.len] = group;
        self.len += 1;
    }

    /// Forgets what was kept, to be offered all contacts again, also those that count a little.
    pub(super) fn reach_down(&mut self) {
        self.least = self.closeness.least_deep(self.deepest.least, KEPT_WEIGHT);
        (self.len, self.has_reached) = (0, true);
    }

    /// Some may have been kept before a deeper one was known.
    #[inline(always)]
    pub(super) fn drop_shallow(&mut self) {
        let mut left = 0;
        for i in 0..self.len {
            self.kept[left] = self.kept[i];
            let counts = self.kept[i]
                .penetrations()
                .simd_ge(f32x4::splat(self.least));
            left += usize::from(counts.any());
        }
        self.len = left;
    }
}

impl Goal for Near {
    const BEST_FIRST: bool = true;

    #[inline(always)]
    fn least_penetration(&self) -> f32 {
        self.least
    }

    #[inline(always)]
    fn offer(&mut self, found: &Found<'_>) -> bool {
        let before = self.deepest.least;
        self.deepest.offer(found);
        if self.deepest.least > before {
            self.least = if self.is_full {
                self.deepest.least
            } else {
                self.closeness.least_deep(self.deepest.least, LEAST_WEIGHT)
            };
        }
        if !self.is_full {
            let none = f32x4::splat(f32::NEG_INFINITY);
            self.keep(Group {
                first: found.first,
                penetrations: found.counts.select(found.penetrations, none).to_array(),
            });
        }
        true
    }
}
