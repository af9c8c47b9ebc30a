//! Two shapes of which at least one is a VPS shape.

use rapier3d::parry::shape::Shape;
use vps_core::{Pose3, Vec3};

use super::edge_sampler::EdgeSampler;
use super::pair_contact::{PairContact, deeper};
use super::shell_in_field::{ContactPoints, Sampling, ShellInField};
use crate::precision::core_real;
use crate::shape::{Role, VpsShape};

/// Thickness of a shape, in spacings of the points of a shell, from which the shell alone finds it.
const MIN_THICKNESS: f32 = 2.0;

/// Cosine between normals above which contacts are of the same surface for a cast.
const SAME_SURFACE_COSINE: f32 = 0.9;

/// The shells, fields and edges that answer queries about a pair of shapes.
pub(crate) struct Pair<'s> {
    /// A shell in the field of the other shape.
    primary: ShellInField<'s>,
    /// The other shell in the other field, for two VPS shapes.
    secondary: Option<ShellInField<'s>>,
    /// Whether the secondary is needed in every pose.
    needs_secondary: bool,
    /// The edges of a shape of parry in the voxelmap of the other.
    edge_sampler: Option<EdgeSampler<'s>>,
    /// Thickness of the thinner of the two in metres; 0 if unknown.
    thickness: f32,
}

impl<'s> Pair<'s> {
    /// `None` if neither shape is a VPS shape.
    pub(crate) fn of(
        g1: &'s dyn Shape,
        g2: &'s dyn Shape,
        sampling: Sampling,
        contact_points: ContactPoints,
    ) -> Option<Self> {
        let vps = |g: &'s dyn Shape| g.as_shape::<VpsShape>();
        match (vps(g1), vps(g2)) {
            (None, None) => None,
            (Some(a), None) => Some(Self::with_parry_shape(a, g2, contact_points, true)),
            (None, Some(b)) => Some(Self::with_parry_shape(b, g1, contact_points, false)),
            (Some(a), Some(b)) => Some(Self::of_vps_shapes(a, b, sampling, contact_points)),
        }
    }

    fn with_parry_shape(
        vps: &'s VpsShape,
        other: &'s dyn Shape,
        contact_points: ContactPoints,
        vps_is_first: bool,
    ) -> Self {
        // parry gives half of the thickness of a box.
        let other_thickness = 2.0 * core_real(other.ccd_thickness());
        Self {
            primary: ShellInField::in_shape(vps, other, contact_points, vps_is_first),
            secondary: None,
            needs_secondary: false,
            edge_sampler: Some(EdgeSampler::new(other, vps, !vps_is_first)),
            thickness: vps.thickness().min(other_thickness),
        }
    }

    fn of_vps_shapes(
        a: &'s VpsShape,
        b: &'s VpsShape,
        sampling: Sampling,
        contact_points: ContactPoints,
    ) -> Self {
        // The finer shell is the primary: few points of a large body meet a small one, if any.
        let density = |s: &VpsShape| (s.spacing(), s.asset().tree.point_count());
        let first_is_shell = match (a.role(), b.role()) {
            (Role::Pointshell, b) if b != Role::Pointshell => true,
            (a, Role::Pointshell) if a != Role::Pointshell => false,
            (Role::Voxelmap, b) if b != Role::Voxelmap => false,
            (a, Role::Voxelmap) if a != Role::Voxelmap => true,
            _ => density(a) <= density(b),
        };
        let (shell, field) = if first_is_shell { (a, b) } else { (b, a) };
        let is_mixed = |s: &VpsShape| s.role() == Role::Mixed;
        let needs_secondary = [a, b].iter().any(|s| s.role() == Role::Both)
            // A thin shape fits between the points of the shell; its own points find it.
            || is_mixed(a)
                && is_mixed(b)
                && field.thickness() < MIN_THICKNESS * shell.spacing();
        Self {
            primary: ShellInField::in_map(shell, field, sampling, contact_points, first_is_shell),
            secondary: Some(ShellInField::in_map(
                field,
                shell,
                sampling,
                contact_points,
                !first_is_shell,
            )),
            needs_secondary,
            edge_sampler: None,
            thickness: a.thickness().min(b.thickness()),
        }
    }

    /// The shells that are needed in every pose.
    fn pose_independent_shells(&self) -> impl Iterator<Item = &ShellInField<'s>> {
        let secondary = self.secondary.as_ref().filter(|_| self.needs_secondary);
        [Some(&self.primary), secondary].into_iter().flatten()
    }

    /// The shells that are needed in a pose.
    pub(crate) fn shells(&self, pos12: &Pose3) -> impl Iterator<Item = &ShellInField<'s>> {
        [Some(&self.primary), self.secondary(pos12)]
            .into_iter()
            .flatten()
    }

    /// The secondary, if it is needed in a pose. It is needed where the field's shape may lie in the
    /// solid of the primary shell, none of whose points then lies in the field's shape.
    pub(crate) fn secondary(&self, pos12: &Pose3) -> Option<&ShellInField<'s>> {
        let secondary = self.secondary.as_ref()?;
        (self.needs_secondary || secondary.may_be_enclosed(pos12)).then_some(secondary)
    }

    /// The edges of a shape of parry, if one of the two is one.
    pub(crate) fn edge_sampler(&self) -> Option<&EdgeSampler<'s>> {
        self.edge_sampler.as_ref()
    }

    /// Whether the shapes touch, `pos12` being the pose of the second in the frame of the first.
    pub(crate) fn touches(&self, pos12: &Pose3) -> bool {
        self.shells(pos12).any(|shell| shell.touches(pos12))
            || self.edge_sampler().is_some_and(|e| e.touches(pos12))
    }

    /// The deepest contact up to `prediction` metres away.
    pub(crate) fn deepest(&self, pos12: &Pose3, prediction: f32) -> Option<PairContact> {
        let by_shells = self
            .shells(pos12)
            .filter_map(|shell| shell.deepest(pos12, prediction));
        let deepest = by_shells.reduce(deeper);
        // Edges further away than a point of the shell are not the deepest.
        let within = deepest.map_or(prediction, |d| -d.penetration);
        let by_edges = self.edge_sampler().and_then(|e| e.deepest(pos12, within));
        deepest.into_iter().chain(by_edges).reduce(deeper)
    }

    /// The deepest contact up to `prediction` metres away, for questions about distance. Its distance is
    /// right also where a voxelmap has a lower bound alone.
    pub(crate) fn closest(&self, pos12: &Pose3, prediction: f32) -> Option<PairContact> {
        let by_shells = self
            .shells(pos12)
            .filter_map(|shell| shell.closest(pos12, prediction));
        let closest = by_shells.reduce(deeper);
        let within = closest.map_or(prediction, |c| -c.penetration);
        let by_edges = self.edge_sampler().and_then(|e| e.closest(pos12, within));
        closest.into_iter().chain(by_edges).reduce(deeper)
    }

    /// The deepest of the contacts up to `prediction` metres away that `accept`s, and whose normal out
    /// of the first shape differs from `excluded_normal`. Visits all contacts. `may_accept` is a cheaper
    /// test for points of shells: of the point and the shell's normal out of the first shape, both in
    /// the frame of the first.
    pub(crate) fn deepest_of(
        &self,
        pos12: &Pose3,
        prediction: f32,
        excluded_normal: Vec3,
        may_accept: &dyn Fn(Vec3, Vec3) -> bool,
        accept: &dyn Fn(&PairContact) -> bool,
    ) -> Option<PairContact> {
        let differs = |normal: Vec3| normal.dot(excluded_normal) < SAME_SURFACE_COSINE;
        let accept = |contact: &PairContact| differs(contact.normals[0]) && accept(contact);
        let mut by_edges = Vec::new();
        if let Some(edge_sampler) = self.edge_sampler() {
            edge_sampler.contacts(pos12, prediction, &mut by_edges);
        }
        let by_shells = self
            .shells(pos12)
            .filter(|shell| {
                let normal = shell.plane_normal(pos12, prediction);
                normal.is_none_or(differs)
            })
            .filter_map(|shell| shell.deepest_of(pos12, prediction, may_accept, &accept));
        let deepest = by_shells.chain(by_edges.into_iter().filter(accept));
        deepest.reduce(deeper)
    }

    /// Distance in metres within which contacts with the same normal are of one deepest point.
    pub(crate) fn merging_distance(&self) -> f32 {
        self.pose_independent_shells()
            .map(ShellInField::merging_distance)
            .fold(f32::INFINITY, f32::min)
    }

    /// The largest size of the voxels of the fields in metres, 0 if all are exact.
    pub(crate) fn resolution(&self) -> f32 {
        let of_edges = self.edge_sampler().map_or(0.0, EdgeSampler::resolution);
        self.pose_independent_shells()
            .map(ShellInField::resolution)
            .fold(of_edges, f32::max)
    }

    /// How far the shapes may move against each other, in metres, and meet in nothing but one plane; 0
    /// if that is unknown.
    pub(crate) fn plane_reach(&self, pos12: &Pose3) -> f32 {
        let reach = self.shells(pos12).map(|shell| shell.plane_reach(pos12));
        reach.fold(f32::INFINITY, f32::min)
    }

    /// Thickness of the thinner of the two in metres, as [`VpsShape::thickness`] measures it; 0 if it is
    /// unknown, as that of a mesh.
    pub(crate) fn thickness(&self) -> f32 {
        self.thickness
    }

    /// The diagonal of the smallest shell needed in every pose, in metres.
    pub(crate) fn size(&self) -> f32 {
        smallest(self.pose_independent_shells())
    }

    /// The diagonal of the smallest shell needed in a pose, in metres.
    pub(crate) fn size_in_pose(&self, pos12: &Pose3) -> f32 {
        smallest(self.shells(pos12))
    }

    /// Error bound of the fields anywhere, in metres.
    pub(crate) fn error(&self) -> f32 {
        let of_edges = self.edge_sampler().map_or(0.0, EdgeSampler::error);
        self.pose_independent_shells()
            .map(ShellInField::error)
            .fold(of_edges, f32::max)
    }
}

/// The diagonal of the smallest shell in metres.
fn smallest<'w, 's: 'w>(shells: impl Iterator<Item = &'w ShellInField<'s>>) -> f32 {
    shells.map(ShellInField::size).fold(f32::INFINITY, f32::min)
}
