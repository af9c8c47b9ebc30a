//! VPS shapes in rapier's debug renderer, which itself leaves custom shapes out.

use rapier3d::geometry::{Collider, ColliderHandle, ColliderSet};
use rapier3d::math::{Pose, Vector};
use rapier3d::pipeline::{DebugColor, DebugRenderBackend, DebugRenderObject};

use crate::precision::vector;
use crate::shape::VpsShape;

/// Draws the VPS shapes of all colliders, also those in compounds, by the edges of their
/// [surfaces](VpsShape::surface_mesh). The colour is in HSLA, hue from 0 to 360 and the rest from 0 to
/// 1, and goes to the backend as it is. Call it beside `DebugRenderPipeline::render`, which leaves VPS
/// shapes out.
pub fn debug_render(
    backend: &mut impl DebugRenderBackend,
    colliders: &ColliderSet,
    color: DebugColor,
) {
    for (handle, collider) in colliders.iter() {
        let object = DebugRenderObject::Collider(handle, collider);
        if !backend.filter_object(object) {
            continue;
        }
        if let Some(shape) = collider.shape().as_shape::<VpsShape>() {
            draw(
                backend,
                (handle, collider),
                shape,
                collider.position(),
                color,
            );
        }
        let parts = collider
            .shape()
            .as_compound()
            .map_or(&[][..], |c| c.shapes());
        for (pose, part) in parts {
            if let Some(shape) = part.as_shape::<VpsShape>() {
                let pose = *collider.position() * *pose;
                draw(backend, (handle, collider), shape, &pose, color);
            }
        }
    }
}

fn draw(
    backend: &mut impl DebugRenderBackend,
    (handle, collider): (ColliderHandle, &Collider),
    shape: &VpsShape,
    pose: &Pose,
    color: DebugColor,
) {
    let mesh = shape.surface_mesh();
    let vertices: Vec<Vector> = mesh.vertices.iter().map(|&v| vector(v)).collect();
    let object = DebugRenderObject::Collider(handle, collider);
    backend.draw_polyline(object, &vertices, &mesh.edges(), pose, Vector::ONE, color);
}
