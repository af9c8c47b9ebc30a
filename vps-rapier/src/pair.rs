//! Two shapes of which at least one is a VPS shape.

use rapier3d::parry::shape::{PackedFeatureId, Shape};
use vps_core::{Pose3, Vec3};

use crate::contact::{
    PairContact, are_opposed, deepest, is_as_good, keep_few_of_a_normal, settle_normals, spread,
    turn_all,
};
use crate::probe::Probe;
use crate::real::core_real;
use crate::way::{SPREAD_SIZE, Way};
use crate::{Manifolds, Role, Sampling, VpsShape};

/// All ways to look at a pair that are needed for it.
pub(crate) struct Pair<'s> {
    /// A shell in the field of the other shape.
    first_way: Way<'s>,
    /// The other shell in the other field.
    back: Option<Way<'s>>,
    /// Whether it is always looked at that way, too.
    always_back: bool,
    /// The points of a shape of parry in the voxelmap of the other.
    probe: Option<Probe<'s>>,
    /// That of the thinner of the two, in metres; 0 of what has none that is known.
    thickness: f32,
}

/// How many spacings of the points a shape must be thick to be met by points alone.
const THICK: f32 = 2.0;

/// From which part of the size of a shell on it is so deep that the closest surface may be the wrong
/// way out.
const DEEP: f32 = 0.02;

/// How alike the normals of contacts are, as a cosine, that are of one surface.
const ALIKE: f32 = 0.9;

/// By how much of the size of a shell contacts may be less deep than the best there are, and stay.
const STILL: f32 = 1e-4;

impl<'s> Pair<'s> {
    /// `None` if neither shape is a VPS shape.
    pub(crate) fn of(g1: &'s dyn Shape, g2: &'s dyn Shape, sampling: Sampling) -> Option<Self> {
        let vps = |g: &'s dyn Shape| g.as_shape::<VpsShape>();
        match (vps(g1), vps(g2)) {
            (None, None) => None,
            (Some(a), None) => Some(Self {
                first_way: Way::in_shape(a, g2, true),
                back: None,
                always_back: false,
                probe: Some(Probe::new(g2, a, false)),
                thickness: thinner(a, g2),
            }),
            (None, Some(b)) => Some(Self {
                first_way: Way::in_shape(b, g1, false),
                back: None,
                always_back: false,
                probe: Some(Probe::new(g1, b, true)),
                thickness: thinner(b, g1),
            }),
            (Some(a), Some(b)) => Some(Self::of_vps_shapes(a, b, sampling)),
        }
    }

    fn of_vps_shapes(a: &'s VpsShape, b: &'s VpsShape, sampling: Sampling) -> Self {
        // A body that is small beside the other would be met by few points of that, if any.
        let density = |s: &VpsShape| (s.spacing(), s.asset().tree.point_count());
        let first_is_shell = match (a.role(), b.role()) {
            (Role::Pointshell, b) if b != Role::Pointshell => true,
            (a, Role::Pointshell) if a != Role::Pointshell => false,
            (Role::Voxelmap, b) if b != Role::Voxelmap => false,
            (a, Role::Voxelmap) if a != Role::Voxelmap => true,
            _ => density(a) <= density(b),
        };
        let (shell, field) = if first_is_shell { (a, b) } else { (b, a) };
        let is_free = |s: &VpsShape| s.role() == Role::Mixed;
        let both = [a, b].iter().any(|s| s.role() == Role::Both)
            // Between the points of the shell there is room for what is thin; its own points find it.
            || is_free(a) && is_free(b) && field.thickness() < THICK * shell.spacing();
        Self {
            first_way: Way::in_map(shell, field, sampling, first_is_shell),
            back: Some(Way::in_map(field, shell, sampling, !first_is_shell)),
            always_back: both,
            probe: None,
            thickness: a.thickness().min(b.thickness()),
        }
    }

    /// Those that are needed in any pose.
    fn usual_ways(&self) -> impl Iterator<Item = &Way<'s>> {
        let back = self.back.as_ref().filter(|_| self.always_back);
        [Some(&self.first_way), back].into_iter().flatten()
    }

    /// Those that are needed in a pose.
    fn ways(&self, pos12: &Pose3) -> impl Iterator<Item = &Way<'s>> {
        [Some(&self.first_way), self.back(pos12)]
            .into_iter()
            .flatten()
    }

    /// The way back, if it is needed: what lies in the solid of the shell it is looked at with has none
    /// of its points in it.
    fn back(&self, pos12: &Pose3) -> Option<&Way<'s>> {
        let back = self.back.as_ref()?;
        (self.always_back || back.may_be_within(pos12)).then_some(back)
    }

    /// Whether the shapes touch, `pos12` being the pose of the second in the frame of the first.
    pub(crate) fn touches(&self, pos12: &Pose3) -> bool {
        self.ways(pos12).any(|way| way.touches(pos12))
            || self.probe.as_ref().is_some_and(|p| p.touches(pos12))
    }

    /// The deepest contact up to `margin` metres away.
    pub(crate) fn deepest(&self, pos12: &Pose3, margin: f32) -> Option<PairContact> {
        let by_shells = self
            .ways(pos12)
            .filter_map(|way| way.deepest(pos12, margin));
        let deepest = by_shells.reduce(deeper);
        // What is further away than a point of the shell is not the deepest.
        let within = deepest.map_or(margin, |d| -d.penetration);
        let probed = self.probe.as_ref().and_then(|p| p.deepest(pos12, within));
        deepest.into_iter().chain(probed).reduce(deeper)
    }

    /// The same, at its distance also where a voxelmap has a lower bound alone: for those who ask how
    /// far shapes are apart.
    pub(crate) fn closest(&self, pos12: &Pose3, margin: f32) -> Option<PairContact> {
        let by_shells = self
            .ways(pos12)
            .filter_map(|way| way.closest(pos12, margin));
        let closest = by_shells.reduce(deeper);
        let within = closest.map_or(margin, |c| -c.penetration);
        let probed = self.probe.as_ref().and_then(|p| p.closest(pos12, within));
        closest.into_iter().chain(probed).reduce(deeper)
    }

    /// The deepest of all contacts up to `margin` metres away of which something is true, and whose
    /// normal out of the first shape is another one than `beside`. Looks at them all, at those of
    /// shells only if `is_worth` says so of the point and the shell's normal,
    /// both in the frame of the first shape and the normal out of it.
    pub(crate) fn deepest_of(
        &self,
        pos12: &Pose3,
        margin: f32,
        beside: Vec3,
        is_worth: &dyn Fn(Vec3, Vec3) -> bool,
        is_wanted: &dyn Fn(&PairContact) -> bool,
    ) -> Option<PairContact> {
        let is_unlike = |normal: Vec3| normal.dot(beside) < ALIKE;
        let is_wanted = |contact: &PairContact| is_unlike(contact.normals[0]) && is_wanted(contact);
        let mut probed = Vec::new();
        if let Some(probe) = &self.probe {
            probe.contacts(pos12, margin, &mut probed);
        }
        let by_shells = self
            .ways(pos12)
            .filter(|way| way.level_normal(pos12, margin).is_none_or(is_unlike))
            .filter_map(|way| way.deepest_of(pos12, margin, is_worth, &is_wanted));
        let deepest = by_shells.chain(probed.into_iter().filter(is_wanted));
        deepest.reduce(deeper)
    }

    /// The contacts up to `margin` metres away that an engine gets; `before` are the ids of those of
    /// the step before, and `motion` is how far the shapes moved since.
    pub(crate) fn contacts(
        &self,
        pos12: &Pose3,
        margin: f32,
        motion: Option<f32>,
        manifolds: Manifolds,
        before: &[[PackedFeatureId; 2]],
    ) -> Vec<PairContact> {
        let mut found = Vec::new();
        for way in self.ways(pos12) {
            match manifolds {
                Manifolds::Spread => way.manifold(pos12, margin, motion, before, &mut found),
                Manifolds::Segments(level) => way.segments(pos12, margin, level, &mut found),
            }
        }
        let by_shells = found.len();
        if let Some(probe) = &self.probe {
            probe.contacts(pos12, margin, &mut found);
        }
        let has_more = found.len() > by_shells || self.back(pos12).is_some();
        match manifolds {
            Manifolds::Spread => {
                let mut kept = self.again(pos12, before, &found);
                if has_more {
                    spread::<SPREAD_SIZE>(&mut found, margin, motion);
                }
                for contacts in kept.iter_mut().chain([&mut found]) {
                    settle_normals(contacts, pos12);
                    keep_few_of_a_normal(contacts);
                }
                if let Some(kept) = kept
                    && is_as_good(&kept, &found, STILL * smallest(self.ways(pos12)))
                {
                    found = kept;
                }
                self.push_out_of_the_deep(&mut found, pos12);
            }
            Manifolds::Segments(_) if found.len() > by_shells => {
                let mut probed = found.split_off(by_shells);
                spread::<SPREAD_SIZE>(&mut probed, margin, motion);
                found.extend(probed);
            }
            _ => {}
        }
        found
    }

    /// Lets contacts of one pair pull together where what is closest is not the way out.
    fn push_out_of_the_deep(&self, contacts: &mut Vec<PairContact>, pos12: &Pose3) {
        if deepest(contacts) > DEEP * smallest(self.ways(pos12)) && are_opposed(contacts) {
            let push = self
                .ways(pos12)
                .map(|way| way.push_on_first(pos12))
                .sum::<Vec3>();
            if push != Vec3::ZERO {
                turn_all(contacts, -push.normalize(), pos12);
            }
        }
    }

    /// What the contacts of the step before are now, if all can be told; those found again are not
    /// looked at twice.
    fn again(
        &self,
        pos12: &Pose3,
        before: &[[PackedFeatureId; 2]],
        found: &[PairContact],
    ) -> Option<Vec<PairContact>> {
        let one = |&ids: &[PackedFeatureId; 2]| {
            let again = found.iter().find(|c| c.ids == ids).copied();
            again.or_else(|| self.ways(pos12).find_map(|way| way.again(pos12, ids)))
        };
        before.iter().map(one).collect()
    }

    /// How finely the fields are sampled: the largest size of voxels in metres, 0 if exact.
    pub(crate) fn resolution(&self) -> f32 {
        let of_probe = self.probe.as_ref().map_or(0.0, Probe::resolution);
        self.usual_ways()
            .map(Way::resolution)
            .fold(of_probe, f32::max)
    }

    /// How far the shapes may move against each other, in metres, and meet in nothing but one plane; 0
    /// if that is not known.
    pub(crate) fn level_reach(&self, pos12: &Pose3) -> f32 {
        let reach = self.ways(pos12).map(|way| way.level_reach(pos12));
        reach.fold(f32::INFINITY, f32::min)
    }

    /// How thick the thinner of the two is in metres, but for the thinnest parts of a VPS shape; 0 if
    /// that is not known, as of a mesh.
    pub(crate) fn thickness(&self) -> f32 {
        self.thickness
    }

    /// The size of the smallest shell in metres.
    pub(crate) fn size(&self) -> f32 {
        smallest(self.usual_ways())
    }

    /// How far what is found may be off in metres, anywhere.
    pub(crate) fn error(&self) -> f32 {
        let of_probe = self.probe.as_ref().map_or(0.0, Probe::error);
        self.usual_ways().map(Way::error).fold(of_probe, f32::max)
    }
}

/// The size of the smallest shell in metres.
fn smallest<'w, 's: 'w>(ways: impl Iterator<Item = &'w Way<'s>>) -> f32 {
    ways.map(Way::size).fold(f32::INFINITY, f32::min)
}

/// The thickness of the thinner of the two.
fn thinner(vps: &VpsShape, other: &dyn Shape) -> f32 {
    // It is half of what a box is thick.
    vps.thickness().min(2.0 * core_real(other.ccd_thickness()))
}

fn deeper(a: PairContact, b: PairContact) -> PairContact {
    if b.penetration > a.penetration { b } else { a }
}
