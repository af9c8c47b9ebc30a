//! Manifolds of compounds with VPS shapes among their parts. parry's own traversal of a compound asks
//! only parry about the parts.

use rapier3d::math::{Pose, Real};
use rapier3d::parry::bounding_volume::BoundingVolume;
use rapier3d::parry::query::{ContactManifold, PersistentQueryDispatcher};
use rapier3d::parry::shape::{Compound, Shape};

use crate::manifolds::warm_start;
use crate::shape::VpsShape;

/// A shape as a compound, if a VPS shape is among its parts.
pub(crate) fn as_compound_with_vps(shape: &dyn Shape) -> Option<&Compound> {
    let compound = shape.as_compound()?;
    let is_vps = |part: &dyn Shape| part.as_shape::<VpsShape>().is_some();
    let has_vps = compound.shapes().iter().any(|(_, part)| is_vps(&**part));
    has_vps.then_some(compound)
}

/// A part of a compound, or a shape of its own.
struct Part<'s> {
    /// Its index and pose in the compound.
    in_compound: Option<(u32, Pose)>,
    shape: &'s dyn Shape,
}

fn parts(shape: &dyn Shape) -> Vec<Part<'_>> {
    let Some(compound) = shape.as_compound() else {
        return vec![Part {
            in_compound: None,
            shape,
        }];
    };
    let parts = (0..).zip(compound.shapes());
    parts
        .map(|(index, (pose, shape))| Part {
            in_compound: Some((index, *pose)),
            shape: &**shape,
        })
        .collect()
}

impl Part<'_> {
    fn pose(&self) -> Pose {
        self.in_compound.map_or(Pose::IDENTITY, |(_, pose)| pose)
    }

    fn index(&self) -> u32 {
        self.in_compound.map_or(0, |(index, _)| index)
    }
}

/// Updates the manifolds of all pairs of parts that are close to each other.
pub(crate) fn update_parts<M: Clone, C: Copy>(
    dispatcher: &dyn PersistentQueryDispatcher<M, C>,
    pos12: &Pose,
    [g1, g2]: [&dyn Shape; 2],
    prediction: Real,
    manifolds: &mut Vec<ContactManifold<M, C>>,
) {
    let mut old = std::mem::take(manifolds);
    let seconds = parts(g2);
    for part1 in parts(g1) {
        let bounds = part1.shape.compute_local_aabb().loosened(prediction);
        for part2 in &seconds {
            let pos = part1.pose().inv_mul(&(*pos12 * part2.pose()));
            if !part2.shape.compute_aabb(&pos).intersects(&bounds) {
                continue;
            }
            let key = [part1.index(), part2.index()];
            let belongs = |m: &ContactManifold<M, C>| {
                (part1.in_compound.is_none() || m.subshape1 == key[0])
                    && (part2.in_compound.is_none() || m.subshape2 == key[1])
            };
            let (mut updated, others) = old.into_iter().partition(belongs);
            old = others;
            let previous = updated.clone();
            // The workspace parry keeps for meshes is lost here: rapier stores one for the pair of
            // compounds, and writes only parry's own types to files.
            let mut workspace = None;
            // parry answers all pairs without a VPS shape.
            let result = dispatcher.contact_manifolds(
                &pos,
                part1.shape,
                part2.shape,
                prediction,
                &mut updated,
                &mut workspace,
            );
            if result.is_err() {
                updated.clear();
            }
            if workspace.is_some() {
                warm_start(&mut updated, &previous);
            }
            for mut manifold in updated {
                if let Some((index, pose)) = part1.in_compound {
                    manifold.subshape1 = index;
                    manifold.set_subshape_pos1(Some(pose));
                }
                if let Some((index, pose)) = part2.in_compound {
                    manifold.subshape2 = index;
                    manifold.set_subshape_pos2(Some(pose));
                }
                manifolds.push(manifold);
            }
        }
    }
}
