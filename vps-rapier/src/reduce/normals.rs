//! Contact normals where field and shell disagree.

use vps_core::{Observer, Pose3, Vec3};

use super::parameters::{MIN_MEAN_NORMAL, MIN_NORMAL_WEIGHT, SAME_NORMAL_COSINE, SHELL_ADVANTAGE};
use crate::query::event::{ContactObserver, PairEvent, TurnReason};
use crate::query::pair_contact::PairContact;

/// Whether contacts with these unit normals share a manifold.
pub(crate) fn is_same_normal(a: Vec3, b: Vec3) -> bool {
    a.dot(b) > SAME_NORMAL_COSINE
}

/// Resolves the normals of contacts where field and shell disagree. One of the two has an edge there,
/// and the other can rest on it in any direction between the two normals. The one closest to the mean
/// of all contacts is taken, of the field's normals or of the shell's, whichever agree better among
/// themselves. A face that lies on a face is thus not pushed aside where either ends. Contacts all
/// around, as in a thread, keep the normals of the field.
pub(super) fn resolve_normals(
    contacts: &mut [PairContact],
    pos12: &Pose3,
    observer: &ContactObserver<'_, impl Observer<PairEvent>>,
) {
    let (mut field_sum, mut shell_sum, mut total) = (Vec3::ZERO, Vec3::ZERO, 0.0);
    for contact in &*contacts {
        let field_normal = contact.normals[0];
        let shell_normal = contact.shell_normal.unwrap_or(field_normal);
        // Contacts whose normals agree weigh most.
        let weight = field_normal.dot(shell_normal).max(0.0).powi(4) + MIN_NORMAL_WEIGHT;
        field_sum += field_normal * weight;
        shell_sum += shell_normal * weight;
        total += weight;
    }
    let mean = if shell_sum.length() > SHELL_ADVANTAGE * field_sum.length() {
        shell_sum
    } else {
        field_sum
    };
    if mean.length() < MIN_MEAN_NORMAL * total {
        return;
    }
    for contact in contacts {
        if let Some(shell_normal) = contact.shell_normal {
            let normal = closest_between(contact.normals[0], shell_normal, mean);
            observer.observe_turn(contact, normal, TurnReason::Resolved);
            contact.set_normal(normal, pos12);
        }
    }
}

/// The direction closest to `to` on the great-circle arc from `a` to `b`.
fn closest_between(a: Vec3, b: Vec3, to: Vec3) -> Vec3 {
    let across = a.cross(b);
    let in_plane = to - across * (to.dot(across) / across.length_squared().max(f32::MIN_POSITIVE));
    // Beyond neither end of the arc.
    let is_between = a.cross(in_plane).dot(across) > 0.0 && in_plane.cross(b).dot(across) > 0.0;
    let end = if b.dot(to) > a.dot(to) { b } else { a };
    if is_between {
        in_plane.normalize_or(end)
    } else {
        end
    }
}
