use glamx::Vec3;
use wide::f32x4;

use crate::dispatch::dispatch;
use crate::lanes::{Vectors, lanes_in};
use crate::query::{Deepest, TOP};
use crate::search::{Found, Goal};
use crate::work::CountWork;
use crate::{Contact, Discs, DistanceField, LANES, PointSphereTree, Points, Query};

/// At which fraction of the margin further outside than the deepest a contact counts half, if the
/// shell hardly moves.
const CLOSE: f32 = 0.01;

/// Contacts that count less than this part of what the deepest does are picked only when no others
/// are left.
const LEAST_WEIGHT: f32 = 1.0 / 2.0;

/// So many contacts hold a body on what is flat, whatever way it falls.
const STANDS_ON: usize = 4;

/// By which part of its distance from the deepest contact another one may be off the plane through
/// that, and the field is flat: what a turn of its normal by 5 degrees makes on the way there.
const BENT: f32 = 0.04;

/// Those that count this part of it or more are kept when such are needed.
const KEPT_WEIGHT: f32 = 1.0 / 256.0;

/// What a contact counts whose normal is square to that of the deepest.
const ASKEW: f32 = 0.25;

/// At most `N` contacts that stand for a contact set: the deepest one first, then those that
/// spread the manifold over the largest area (section 3.2).
///
/// What a point adds to the area counts less the further outside of the solid it is than the
/// deepest, half at a hundredth of the margin: the points a body stands on come before those that
/// lie further apart above the ground, without which it would sink and rise and never rest. Of a
/// body that moves, other points touch the ground in the next step: then contacts count half that
/// are as far away as it has come ([`Query::with_motion`]). Those that count less than half of what
/// the deepest does only fill up what places the others leave, up to four: a body may fall on them
/// next.
///
/// More than four are picked only where the field is bent, that is where the penetrations of those
/// that count enough are not those in a half-space: four hold a body on what is flat, but not in a
/// thread. And a contact counts less the more its normal is askew, down to a quarter: points a
/// little inside of an edge come before those on it, whose normals belong to neither side. Of
/// equally good contacts the first is taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactManifold<const N: usize> {
    contacts: [Contact; N],
    len: usize,
}

impl<const N: usize> ContactManifold<N> {
    const EMPTY: Self = Self {
        contacts: [Contact {
            point: 0,
            position: Vec3::ZERO,
            normal: Vec3::ZERO,
            penetration: 0.0,
        }; N],
        len: 0,
    };

    /// Picks from `contacts`, found by a query with `margin` metres and a `motion`. The area is that
    /// of the polygon of the picked points seen `along` a unit vector in the shell frame, the
    /// direction in which penetration grows at the deepest point. Costs `N` passes.
    ///
    /// [`Query::manifold`] gives the same without a list of all contacts.
    pub fn spread(contacts: &[Contact], along: Vec3, margin: f32, motion: Option<f32>) -> Self {
        let closeness = Closeness { margin, motion };
        let deepest = best(contacts, |c| Some(c.penetration));
        Self::pick(deepest, |_| along, closeness, &mut Listed(contacts))
    }

    fn pick(
        deepest: Option<Contact>,
        along: impl FnOnce(&Contact) -> Vec3,
        closeness: Closeness,
        source: &mut impl Source<N>,
    ) -> Self {
        let mut manifold = Self::EMPTY;
        if N == 0 {
            return manifold;
        }
        let Some(deepest) = deepest else {
            return manifold;
        };
        let mut polygon = Polygon::new(&deepest, along(&deepest), closeness);
        manifold.push(deepest);
        let mut most = N.min(STANDS_ON);
        let mut is_filled_up = false;
        while manifold.len < most {
            let mut picked = source.best(&polygon);
            if picked.is_none() && manifold.len < STANDS_ON && !is_filled_up {
                (polygon.least, is_filled_up) = (-closeness.margin, true);
                picked = source.best(&polygon);
            }
            let Some(next) = picked else {
                break;
            };
            polygon.insert(next.position);
            manifold.push(next);
            let may_go_on = manifold.len == STANDS_ON && STANDS_ON < N && !is_filled_up;
            if may_go_on && source.is_bent(&polygon) {
                most = N;
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

/// Contacts to pick from.
trait Source<const N: usize> {
    /// The one that adds the most to a polygon.
    fn best(&mut self, polygon: &Polygon<N>) -> Option<Contact>;

    /// Whether one that counts enough is off the plane through the deepest.
    fn is_bent(&self, polygon: &Polygon<N>) -> bool;
}

/// All contacts in a list.
struct Listed<'c>(&'c [Contact]);

impl<const N: usize> Source<N> for Listed<'_> {
    fn best(&mut self, polygon: &Polygon<N>) -> Option<Contact> {
        best(self.0, |c| polygon.score(c))
    }

    fn is_bent(&self, polygon: &Polygon<N>) -> bool {
        self.0.iter().any(|c| {
            let position = Vectors::splat(c.position);
            polygon.bent(position, f32x4::splat(c.penetration)).any()
        })
    }
}

/// The contacts of a query, and what is known of them.
struct Searched<'q, 't, F: ?Sized, W> {
    query: &'q Query<'t, F, W>,
    near: Near,
}

impl<F: DistanceField + ?Sized, W: CountWork> Query<'_, F, W> {
    /// The manifold of the contact set, its area seen along the field's normal at the deepest
    /// point: that of [`ContactManifold::spread`], but without looking at all contacts.
    ///
    /// One search finds the deepest contact and those that count enough, and if these are too few a
    /// second one those that count a little; what counts less than them, or does not fit on the
    /// stack, is searched for contact by contact, as far as it could be better.
    pub fn manifold<const N: usize>(&self) -> ContactManifold<N> {
        // Most bodies of a scene are apart; for them not even a place to keep contacts is made.
        if !self.may_touch() {
            return ContactManifold::EMPTY;
        }
        let closeness = Closeness {
            margin: self.margin,
            motion: self.motion,
        };
        let mut near = Near::new(closeness);
        self.find_from_hint(&mut near);
        near.drop_shallow();
        let deepest = near.deepest.found;
        let along = |deepest: &Contact| {
            let at = self.rotation * deepest.position + self.translation;
            let inward = self.rotation.transpose() * self.field.inward_direction(at);
            if inward == Vec3::ZERO {
                -deepest.normal
            } else {
                inward
            }
        };
        let mut source = Searched { query: self, near };
        ContactManifold::pick(deepest, along, closeness, &mut source)
    }
}

impl<F, W, const N: usize> Source<N> for Searched<'_, '_, F, W>
where
    F: DistanceField + ?Sized,
    W: CountWork,
{
    fn best(&mut self, polygon: &Polygon<N>) -> Option<Contact> {
        let near = &mut self.near;
        if polygon.least < near.least && !near.is_full && !near.has_reached {
            near.reach_down();
            dispatch(
                #[inline(always)]
                || self.query.search(TOP, near),
            );
        }
        let mut spread = Spread {
            polygon,
            below: f32::INFINITY,
            least: f32::MIN_POSITIVE,
            found: None,
        };
        if !near.is_full {
            dispatch(
                #[inline(always)]
                || near.offer_to(self.query.tree, &mut spread),
            );
            if near.least <= polygon.least {
                return spread.found;
            }
            spread.below = near.least;
        }
        self.query.find(spread).found
    }

    fn is_bent(&self, polygon: &Polygon<N>) -> bool {
        if self.near.is_full {
            return self.query.find(Bent::new(polygon)).found;
        }
        let mut kept = self.near.kept[..self.near.len].iter();
        kept.any(|group| {
            let positions = group.positions(self.query.tree);
            polygon.bent(positions, group.penetrations()).any()
        })
    }
}

/// How many groups of contacts are kept for the manifold, on the stack.
const KEPT: usize = 256;

/// Points that were tested together.
#[derive(Clone, Copy)]
struct Group {
    /// The first one's number.
    first: u32,
    /// Minus infinity for those that do not count.
    penetrations: [f32; LANES],
}

impl Group {
    #[inline(always)]
    fn positions(&self, tree: &PointSphereTree<'_>) -> Vectors {
        Points::read(tree.points(), self.first as usize).into()
    }

    #[inline(always)]
    fn penetrations(&self) -> f32x4 {
        f32x4::new(self.penetrations)
    }
}

/// The deepest contact, and those that count enough.
struct Near {
    closeness: Closeness,
    /// Contacts less deep are not kept.
    least: f32,
    deepest: Deepest,
    kept: [Group; KEPT],
    len: usize,
    is_full: bool,
    /// Whether those that count a little were asked for.
    has_reached: bool,
}

impl Near {
    fn new(closeness: Closeness) -> Self {
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
    fn offer_to<const N: usize>(&self, tree: &PointSphereTree<'_>, spread: &mut Spread<'_, N>) {
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
    fn reach_down(&mut self) {
        self.least = self.closeness.least_deep(self.deepest.least, KEPT_WEIGHT);
        (self.len, self.has_reached) = (0, true);
    }

    /// Some may have been kept before a deeper one was known.
    #[inline(always)]
    fn drop_shallow(&mut self) {
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

/// How contacts outside of the solid count.
#[derive(Clone, Copy)]
struct Closeness {
    margin: f32,
    motion: Option<f32>,
}

impl Closeness {
    /// What is no distance to speak of, in metres.
    fn close(&self) -> f32 {
        (self.margin * CLOSE).max(f32::MIN_POSITIVE)
    }

    /// How much further outside than the deepest one a contact counts half, in metres.
    fn half(&self, deepest: f32) -> f32 {
        let next = match self.motion {
            Some(motion) => motion,
            // It came from further away than the margin.
            None => outside(deepest),
        };
        next.min(self.margin).max(self.close())
    }

    /// From which penetration on contacts count at least a part of what the deepest does.
    fn least_deep(&self, deepest: f32, part: f32) -> f32 {
        let half = self.half(deepest);
        let further = f32x4::splat(half * half * (1.0 / part - 1.0)).sqrt();
        -(outside(deepest) + further.to_array()[0]).min(self.margin)
    }
}

/// How far outside of the solid something is, in metres.
fn outside(penetration: f32) -> f32 {
    (-penetration).max(0.0)
}

/// The contact that adds the most to a polygon.
struct Spread<'p, const N: usize> {
    polygon: &'p Polygon<N>,
    /// Contacts that are deeper have been considered.
    below: f32,
    least: f32,
    found: Option<Contact>,
}

impl<const N: usize> Goal for Spread<'_, N> {
    const BEST_FIRST: bool = true;

    #[inline(always)]
    fn bounds(&self, discs: &Discs, penetrations: f32x4) -> f32x4 {
        let left = penetrations.fast_min(f32x4::splat(self.below));
        self.polygon.bounds(discs, left)
    }

    #[inline(always)]
    fn least(&self) -> f32 {
        self.least
    }

    #[inline(always)]
    fn least_penetration(&self) -> f32 {
        self.polygon.least
    }

    #[inline(always)]
    fn offer(&mut self, found: &Found<'_>) -> bool {
        let scores = self.polygon.scores(found.positions, found.penetrations);
        for lane in lanes_in(found.counts & scores.simd_ge(f32x4::splat(self.least))) {
            self.consider(found.contact(lane), scores.to_array()[lane]);
        }
        true
    }
}

impl<const N: usize> Spread<'_, N> {
    /// Takes a contact if it is better than what was found; `score` is without its normal.
    fn consider(&mut self, contact: Contact, score: f32) {
        let score = score * self.polygon.facing(contact.normal);
        let is_better = match &self.found {
            Some(best) => score > self.least || score == self.least && contact.point < best.point,
            None => score >= self.least,
        };
        if is_better && !self.polygon.has_corner(contact.position) {
            self.least = score;
            self.found = Some(contact);
        }
    }
}

/// Any contact that is off the plane through the deepest.
struct Bent<'p, const N: usize> {
    polygon: &'p Polygon<N>,
    found: bool,
}

impl<'p, const N: usize> Bent<'p, N> {
    fn new(polygon: &'p Polygon<N>) -> Self {
        Self {
            polygon,
            found: false,
        }
    }
}

impl<const N: usize> Goal for Bent<'_, N> {
    const BEST_FIRST: bool = false;

    #[inline(always)]
    fn least_penetration(&self) -> f32 {
        self.polygon.least
    }

    #[inline(always)]
    fn offer(&mut self, found: &Found<'_>) -> bool {
        let bent = self.polygon.bent(found.positions, found.penetrations);
        self.found = (found.counts & bent).any();
        !self.found
    }
}

/// The picked points as a polygon that grows.
struct Polygon<const N: usize> {
    /// Corners in order, counter-clockwise, which is not the order of picking.
    corners: [Vec3; N],
    /// For each corner the edge to the next one.
    edges: [Edge; N],
    len: usize,
    along: Vec3,
    /// The penetration at the first corner, in metres.
    deepest: f32,
    /// What is no distance to speak of, in metres.
    close: f32,
    /// How much further outside a contact counts half, in metres.
    half: f32,
    /// From which penetration on contacts count enough.
    least: f32,
}

/// An edge of a polygon.
#[derive(Clone, Copy)]
struct Edge {
    /// The outward direction in the plane of the polygon, as long as the edge.
    outward: Vec3,
    /// How far that way the edge is from the first corner, in square metres.
    offset: f32,
    /// In metres.
    length: f32,
}

impl<const N: usize> Polygon<N> {
    fn new(first: &Contact, along: Vec3, closeness: Closeness) -> Self {
        Self {
            corners: [first.position; N],
            edges: [Edge {
                outward: Vec3::ZERO,
                offset: 0.0,
                length: 0.0,
            }; N],
            len: 1,
            along,
            deepest: first.penetration,
            close: closeness.close(),
            half: closeness.half(first.penetration),
            least: closeness.least_deep(first.penetration, LEAST_WEIGHT),
        }
    }

    /// What a contact adds, weighted; `None` if nothing.
    fn score(&self, contact: &Contact) -> Option<f32> {
        if self.has_corner(contact.position) {
            return None;
        }
        let position = Vectors::splat(contact.position);
        let penetration = f32x4::splat(contact.penetration);
        let score = self.scores(position, penetration).to_array()[0];
        (score > 0.0).then_some(score * self.facing(contact.normal))
    }

    /// Which of the contacts that count are off the plane through the first corner, further than
    /// what is flat makes of it.
    #[inline(always)]
    fn bent(&self, positions: Vectors, penetrations: f32x4) -> f32x4 {
        let way = positions.minus(Vectors::splat(self.corners[0]));
        let in_plane = way.dot(Vectors::splat(self.along)) + f32x4::splat(self.deepest);
        let off = (penetrations - in_plane).abs() - f32x4::splat(self.close);
        let counts = penetrations.simd_ge(f32x4::splat(self.least));
        counts & off.simd_gt(way.length() * f32x4::splat(BENT))
    }

    /// Rounding would make area of nothing for those.
    fn has_corner(&self, position: Vec3) -> bool {
        self.corners[..self.len].contains(&position)
    }

    /// How much a contact counts by its normal, up to one: less where the shell bends away.
    fn facing(&self, normal: Vec3) -> f32 {
        let cosine = normal.dot(self.along);
        ASKEW + (1.0 - ASKEW) * (cosine * cosine).min(1.0)
    }

    /// What contacts add, weighted, but for their normals.
    #[inline(always)]
    fn scores(&self, positions: Vectors, penetrations: f32x4) -> f32x4 {
        self.gains(positions, |_| f32x4::ZERO) * self.weights(penetrations)
    }

    /// The highest score of any contact in a disc, whatever its normal.
    #[inline(always)]
    fn bounds(&self, discs: &Discs, penetrations: f32x4) -> f32x4 {
        // More than rounding can make of it.
        const ROUNDED: f32 = 1.0 + 1e-5;
        let centers = Vectors::from(discs.centers);
        let radii = f32x4::new(discs.radii);
        let far = centers.minus(Vectors::splat(self.corners[0])).length() + radii;
        let reach = radii + far * 1e-6;
        self.gains(centers, |edge| reach * edge) * self.weights(penetrations) * ROUNDED
    }

    #[inline(always)]
    fn weights(&self, penetrations: f32x4) -> f32x4 {
        let outside = -penetrations - f32x4::splat(outside(self.deepest));
        let further = outside.fast_max(f32x4::ZERO) / self.half;
        let weights = f32x4::ONE / (further * further + 1.0);
        let counts = penetrations.simd_ge(f32x4::splat(self.least));
        counts & weights
    }

    /// How much points add: a length for a single corner, otherwise twice an area, only what lies
    /// outside of the polygon; `more` is how much more it may be beyond an edge of that length (one
    /// for a single corner).
    #[inline(always)]
    fn gains(&self, points: Vectors, more: impl Fn(f32) -> f32x4) -> f32x4 {
        let from_first = points.minus(Vectors::splat(self.corners[0]));
        if self.len == 1 {
            return from_first.length() + more(1.0);
        }
        let mut most = f32x4::ZERO;
        for edge in &self.edges[..self.len] {
            most = most.fast_max(edge.beyond(from_first) + more(edge.length));
        }
        most
    }

    /// Puts a corner in behind the edge it adds the most to.
    fn insert(&mut self, point: Vec3) {
        let from_first = Vectors::splat(point - self.corners[0]);
        let (mut behind, mut most) = (0, f32::NEG_INFINITY);
        for (i, edge) in self.edges[..self.len].iter().enumerate() {
            let gain = edge.beyond(from_first).to_array()[0];
            if gain > most {
                (behind, most) = (i, gain);
            }
        }
        self.corners.copy_within(behind + 1..self.len, behind + 2);
        self.edges.copy_within(behind + 1..self.len, behind + 2);
        self.corners[behind + 1] = point;
        self.len += 1;
        // With two corners there is an edge each way.
        for i in [behind, behind + 1] {
            self.edges[i] = self.edge(i);
        }
    }

    /// The edge from a corner to the next one.
    fn edge(&self, corner: usize) -> Edge {
        let from = self.corners[corner];
        let to_next = self.corners[(corner + 1) % self.len] - from;
        let outward = to_next.cross(self.along);
        Edge {
            outward,
            offset: outward.dot(from - self.corners[0]),
            length: outward.length(),
        }
    }
}

impl Edge {
    /// Twice the area of the triangles over the edge, positive outside of the polygon; of points
    /// seen from the first corner.
    #[inline(always)]
    fn beyond(&self, from_first: Vectors) -> f32x4 {
        from_first.dot(Vectors::splat(self.outward)) - f32x4::splat(self.offset)
    }
}

/// The first contact with the largest score; those without one are left out.
fn best(contacts: &[Contact], score: impl Fn(&Contact) -> Option<f32>) -> Option<Contact> {
    let mut best: Option<(f32, &Contact)> = None;
    for contact in contacts {
        if let Some(score) = score(contact)
            && best.is_none_or(|(most, _)| score > most)
        {
            best = Some((score, contact));
        }
    }
    best.map(|(_, contact)| *contact)
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
        let manifold = ContactManifold::<N>::spread(contacts, Vec3::Y, 0.1, Some(0.0));
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
        // A little further out, where it counts a third.
        contacts.push(contact(2, 4.5, 0.0, -0.0015));
        assert_eq!(picked::<2>(&contacts), [0, 1]);
        contacts.remove(1);
        assert_eq!(picked::<2>(&contacts), [0, 2]);
        // Where it counts too little, unless nothing else is left.
        contacts[1].penetration = -0.05;
        assert_eq!(picked::<2>(&contacts), [0, 2]);
        contacts.push(contact(3, 0.0, 0.001, 0.0));
        assert_eq!(picked::<2>(&contacts), [0, 3]);
        assert_eq!(picked::<3>(&contacts), [0, 3, 2]);
    }

    #[test]
    fn what_moves_touches_the_next_point_soon() {
        let mut contacts = [
            contact(0, 0.0, 0.0, 0.01),
            contact(1, 4.0, 0.0, 0.0),
            contact(2, 8.0, 0.0, -0.01),
        ];
        let second = |contacts: &[Contact], motion| {
            let manifold = ContactManifold::<2>::spread(contacts, Vec3::Y, 0.1, motion);
            manifold.contacts()[1].point
        };
        assert_eq!(
            [0.0, 0.01, 0.1].map(|m| second(&contacts, Some(m))),
            [1, 1, 2]
        );
        // What touches already may have been put there.
        assert_eq!(second(&contacts, None), 1);
        for contact in &mut contacts {
            contact.penetration -= 0.04;
        }
        assert_eq!(second(&contacts, None), 2);
    }

    #[test]
    fn four_are_enough_on_what_is_flat() {
        let ground: Vec<_> = (0..100)
            .map(|i| contact(i, (i % 10) as f32, (i / 10) as f32, 0.01))
            .collect();
        assert_eq!(picked::<8>(&ground).len(), 4);
        // A slope is flat as well: penetration grows upwards.
        let slope = ground.iter().map(|c| Contact {
            position: c.position.with_y(0.1 * c.position.x),
            penetration: 0.01 + 0.1 * c.position.x,
            ..*c
        });
        assert_eq!(picked::<8>(&slope.collect::<Vec<_>>()).len(), 4);
        // A wall is not: there penetration stays the same upwards.
        let wall = (0..100).map(|i| Contact {
            position: Vec3::new(-1.0, (i % 10) as f32, (i / 10) as f32),
            ..contact(100 + i, 0.0, 0.0, 0.01)
        });
        let both: Vec<_> = ground.iter().copied().chain(wall).collect();
        assert!(picked::<8>(&both).len() > 4);
        assert_eq!(picked::<4>(&both).len(), 4);
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
