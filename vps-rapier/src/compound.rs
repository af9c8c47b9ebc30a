//! Compounds with VPS shapes among their parts: parry's own way through a compound asks only parry
//! about its parts.

use rapier3d::math::{Pose, Real};
use rapier3d::parry::bounding_volume::BoundingVolume;
use rapier3d::parry::query::{ContactManifold, PersistentQueryDispatcher};
use rapier3d::parry::shape::{Compound, Shape};

use crate::VpsShape;
use crate::manifolds::remember;

/// The compound a shape is, if a VPS shape is among its parts.
pub(crate) fn compound_of_vps(shape: &dyn Shape) -> Option<&Compound> {
    let compound = shape.as_compound()?;
    let is_vps = |part: &dyn Shape| part.as_shape::<VpsShape>().is_some();
    let has_vps = compound.shapes().iter().any(|(_, part)| is_vps(&**part));
    has_vps.then_some(compound)
}

/// A part of a shape: its number and pose, if the shape is a compound.
struct Part<'s> {
    place: Option<(u32, Pose)>,
    shape: &'s dyn Shape,
}

fn parts(shape: &dyn Shape) -> Vec<Part<'_>> {
    let Some(compound) = shape.as_compound() else {
        return vec![Part { place: None, shape }];
    };
    let parts = (0..).zip(compound.shapes());
    parts
        .map(|(number, (pose, shape))| Part {
            place: Some((number, *pose)),
            shape: &**shape,
        })
        .collect()
}

impl Part<'_> {
    fn pose(&self) -> Pose {
        self.place.map_or(Pose::IDENTITY, |(_, pose)| pose)
    }

    fn number(&self) -> u32 {
        self.place.map_or(0, |(number, _)| number)
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
        let around = part1.shape.compute_local_aabb().loosened(prediction);
        for part2 in &seconds {
            let pos = part1.pose().inv_mul(&(*pos12 * part2.pose()));
            if !part2.shape.compute_aabb(&pos).intersects(&around) {
                continue;
            }
            let key = [part1.number(), part2.number()];
            let is_theirs = |m: &ContactManifold<M, C>| {
                (part1.place.is_none() || m.subshape1 == key[0])
                    && (part2.place.is_none() || m.subshape2 == key[1])
            };
            let (mut theirs, others) = old.into_iter().partition(is_theirs);
            old = others;
            let before = theirs.clone();
            // What parry keeps beside the manifolds of meshes cannot be kept here: rapier has room for
            // the pair of compounds alone, and for nothing but parry's own in a file.
            let mut workspace = None;
            // All pairs of shapes that are no VPS shapes have been asked of parry.
            let asked = dispatcher.contact_manifolds(
                &pos,
                part1.shape,
                part2.shape,
                prediction,
                &mut theirs,
                &mut workspace,
            );
            if asked.is_err() {
                theirs.clear();
            }
            if workspace.is_some() {
                remember(&mut theirs, &before);
            }
            for mut manifold in theirs {
                if let Some((number, pose)) = part1.place {
                    manifold.subshape1 = number;
                    manifold.set_subshape_pos1(Some(pose));
                }
                if let Some((number, pose)) = part2.place {
                    manifold.subshape2 = number;
                    manifold.set_subshape_pos2(Some(pose));
                }
                manifolds.push(manifold);
            }
        }
    }
}
