//! The bodies that a closed surface bounds, told apart by their fans.

use rustc_hash::FxHashMap;

use super::fans::Fans;
use super::self_contact::gap_tolerance;
use super::winding::ScanlineIndex;
use crate::mesh::Mesh;
use crate::mesh::triangle::{area, middle, signed_volume};
use crate::mesh::union_find::UnionFind;

/// The bodies that a closed surface bounds.
pub(super) struct Bodies {
    body_of: Vec<u32>,
    volumes: Vec<f64>,
    /// The largest triangle of each body.
    largest: Vec<u32>,
    are_unambiguous: bool,
}

impl Bodies {
    pub(super) fn of(mesh: &Mesh) -> Self {
        let fans = Fans::of(mesh, gap_tolerance(mesh));
        let mut roots = UnionFind::new(fans.vertices.len());
        for &[a, b, c] in &fans.of_triangles {
            roots.join(a, b);
            roots.join(b, c);
        }
        let (origin, _) = mesh.bounds();
        let mut numbers = FxHashMap::default();
        let mut bodies = Self {
            body_of: Vec::with_capacity(mesh.triangles().len()),
            volumes: Vec::new(),
            largest: Vec::new(),
            are_unambiguous: fans.are_unambiguous,
        };
        let mut areas = Vec::new();
        for (t, &[fan, ..]) in fans.of_triangles.iter().enumerate() {
            let next = bodies.volumes.len() as u32;
            let body = *numbers.entry(roots.root(fan)).or_insert(next);
            if body == next {
                bodies.volumes.push(0.0);
                bodies.largest.push(t as u32);
                areas.push(0.0);
            }
            bodies.body_of.push(body);
            let corners = mesh.corners(t);
            bodies.volumes[body as usize] += signed_volume(corners, origin);
            let area = area(corners);
            if area > areas[body as usize] {
                areas[body as usize] = area;
                bodies.largest[body as usize] = t as u32;
            }
        }
        bodies
    }

    /// Whether every body has a non-negative volume, and neighbours are unambiguous.
    pub(super) fn face_outwards(&self) -> bool {
        self.are_unambiguous && self.volumes.iter().all(|&volume| volume >= 0.0)
    }

    /// Whether bodies that do not touch are each a boundary of the solid: winding number 0 around
    /// those that face outwards, 1 around those that bound a cavity.
    pub(super) fn are_nested(&self, mesh: &Mesh) -> bool {
        if self.volumes.len() == 1 {
            return self.face_outwards();
        }
        let scanlines = ScanlineIndex::new(mesh);
        (0..).zip(&self.volumes).all(|(body, &volume)| {
            let largest = mesh.corners(self.largest[body as usize] as usize);
            let others = |t: u32| self.body_of[t as usize] != body;
            let around = scanlines.winding(middle(largest), others);
            around == i32::from(volume < 0.0)
        })
    }
}
