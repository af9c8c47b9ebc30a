//! A distance field over the triangles of a surface near a shape.

use std::sync::atomic::{AtomicUsize, Ordering};

use rapier3d::parry::query::PointQuery;
use vps_core::{Aabb, Discs, DistanceField, LANES, Vec3};

use crate::real::{core_vector, vector};
use crate::surface::{Facet, Seam, Surface};

/// The distance to the closest triangle, its sign by the side of what is closest: a triangle, an edge
/// or a corner, for which the mean of the normals there counts. So a flat ground is flat whatever
/// triangles it is made of.
///
/// What is picked is all that is within `reach` metres of a box. There the field is that of the whole
/// surface as far as it reaches; a solid is asked itself about what is deeper. A surface without an
/// interior is the skin of something `thickness` metres thick behind the side it faces, and beyond
/// its border there is nothing.
pub(crate) struct SurfaceField<'s> {
    surface: Surface<'s>,
    thickness: f32,
    around: Aabb,
    reach: f32,
    facets: Vec<Facet>,
    nodes: Vec<Node>,
    /// How much deeper than below the planes of all triangles a point may be, as a factor: in a
    /// hollow between steep triangles more than on flat ground.
    steepness: f32,
    error: f32,
    /// What was closest to the point before, as a first guess for the next.
    guess: AtomicUsize,
    plane: Option<Plane>,
}

/// All there is to see from within the box, if that is one plane.
struct Plane {
    normal: Vec3,
    /// Of the plane above the origin, along the normal.
    offset: f32,
}

/// A box around facets that follow each other.
struct Node {
    bounds: Aabb,
    /// Of the first facet if there are some, otherwise of the first of the two nodes within.
    first: u32,
    count: u32,
}

/// Most facets of a node that has no nodes within.
const LEAF: usize = 4;

/// By which factor the square of a distance may be off by rounding, amply.
const GUESS: f32 = 1.0 + 1e-4;

/// Deep enough for any number of facets.
const STACK: usize = 64;

/// What is closest to a point.
#[derive(Clone, Copy)]
struct Closest {
    square: f32,
    facet: usize,
    on: On,
    point: Vec3,
}

#[derive(Clone, Copy)]
enum On {
    Face,
    Edge(usize),
    Corner(usize),
}

/// A point seen from the surface.
struct Seen {
    /// Positive inside.
    penetration: f32,
    inward: Vec3,
}

impl<'s> SurfaceField<'s> {
    /// The field of what is within `reach` of a box, both in the frame of the surface in metres.
    pub(crate) fn near(surface: Surface<'s>, thickness: f32, around: Aabb, reach: f32) -> Self {
        let all = surface.bounds();
        let bounds = Aabb {
            min: (around.min - reach).max(all.min),
            max: (around.max + reach).min(all.max),
        };
        let mut facets = surface.facets_in(&bounds);
        let size = |b: &Aabb| b.min.abs().max(b.max.abs()).max_element();
        let error = 16.0 * f32::EPSILON * size(&bounds).max(size(&around).min(size(&all)));
        let mut nodes = Vec::new();
        if !facets.is_empty() {
            nodes.push(Node::of(&facets, 0));
            divide(&mut nodes, 0, &mut facets, 0);
        }
        Self {
            surface,
            thickness,
            around,
            reach,
            steepness: steepness(&facets),
            guess: AtomicUsize::new(0),
            plane: plane(&facets, &around, [reach, thickness], error),
            facets,
            nodes,
            error,
        }
    }

    /// Whether nothing of the surface is further away.
    pub(crate) fn is_all(&self) -> bool {
        let all = self.surface.bounds();
        (self.around.min - self.reach).cmple(all.min).all()
            && all.max.cmple(self.around.max + self.reach).all()
    }

    /// The direction in which penetration grows, if it is the same all over the box.
    pub(crate) fn level_direction(&self) -> Option<Vec3> {
        self.plane.as_ref().map(|plane| -plane.normal)
    }

    fn closest(&self, point: Vec3) -> Option<Closest> {
        // The closest is no further than what was closest to another point; which that was must not
        // matter where two are equally close but for rounding.
        let guess = self.facets.get(self.guess.load(Ordering::Relaxed))?;
        let mut limit = guess.closest(point, 0).square * GUESS + f32::MIN_POSITIVE;
        let mut best: Option<Closest> = None;
        let mut stack = [0_u32; STACK];
        let mut left = 1;
        while left > 0 {
            left -= 1;
            let node = &self.nodes[stack[left] as usize];
            let far = |n: &Node| (n.bounds.clamp(point) - point).length_squared();
            if far(node) >= limit {
                continue;
            }
            if node.count > 0 {
                let range = node.first as usize..(node.first + node.count) as usize;
                for facet in range {
                    let triangle = &self.facets[facet];
                    let height = triangle.height(point);
                    // Nothing of a triangle is closer than its plane.
                    if height * height < limit {
                        let found = triangle.closest(point, facet);
                        if found.square < limit {
                            (best, limit) = (Some(found), found.square);
                        }
                    }
                }
                continue;
            }
            let [mut near, mut other] = [node.first, node.first + 1];
            if far(&self.nodes[other as usize]) < far(&self.nodes[near as usize]) {
                (near, other) = (other, near);
            }
            stack[left] = other;
            stack[left + 1] = near;
            left += 2;
        }
        if let Some(best) = &best {
            self.guess.store(best.facet, Ordering::Relaxed);
        }
        best
    }

    /// How far away something may be and still be known to be the closest.
    fn known(&self, point: Vec3) -> f32 {
        self.reach - self.around.distance_outside(point)
    }

    fn seen_from(&self, point: Vec3) -> Seen {
        let closest = self.closest(point);
        self.solid_beyond(point, closest.as_ref())
            .unwrap_or_else(|| self.seen(point, closest.as_ref()))
    }

    /// What a solid says itself, where something is closer than what was picked.
    fn solid_beyond(&self, point: Vec3, closest: Option<&Closest>) -> Option<Seen> {
        let mesh = self.surface.solid?;
        let is_known = closest.is_some_and(|c| c.square.sqrt() <= self.known(point));
        (!is_known).then(|| {
            let projection = mesh.project_local_point(vector(point), false);
            let outward = point - core_vector(projection.point);
            let distance = outward.length();
            let side = if projection.is_inside { 1.0 } else { -1.0 };
            Seen {
                penetration: side * distance,
                inward: outward.normalize_or_zero() * side,
            }
        })
    }

    fn seen(&self, point: Vec3, closest: Option<&Closest>) -> Seen {
        let Some(closest) = closest else {
            return Seen {
                penetration: f32::NEG_INFINITY,
                inward: Vec3::ZERO,
            };
        };
        let facet = &self.facets[closest.facet];
        let seam = match closest.on {
            On::Face => None,
            On::Edge(edge) => Some(facet.edges[edge]),
            On::Corner(corner) => Some(facet.vertices[corner]),
        };
        let normal = seam.map_or(facet.normal, |s| s.normal);
        let away = point - closest.point;
        let height = away.dot(normal);
        let aside = (away - normal * height).length();
        // Right above or below, rounding alone says where the closest point is.
        let is_flat = seam.is_none_or(|s| s.is_flat() || s.is_border && aside <= self.error);
        let distance = if is_flat { height.abs() } else { away.length() };
        let is_nowhere = self.surface.solid.is_none()
            && (distance > self.thickness || !is_flat && seam.is_some_and(|s| s.is_border));
        let is_inside = height < 0.0 && !is_nowhere;
        let side = if is_inside { 1.0 } else { -1.0 };
        let inward = if is_flat && (is_inside || height >= 0.0) || distance <= self.error {
            -normal
        } else {
            away.normalize_or_zero() * side
        };
        Seen {
            penetration: side * distance,
            inward,
        }
    }

    /// A bound for all points of a piece, of which `reach` says how far it reaches in a direction and
    /// `radius` how far in any.
    fn bound(&self, center: Vec3, radius: f32, reach: impl Fn(Vec3) -> f32) -> f32 {
        let closest = self.closest(center);
        if let Some(seen) = self.solid_beyond(center, closest.as_ref()) {
            return seen.penetration + radius + self.error;
        }
        let Some(distance) = closest.map(|c| c.square.sqrt()) else {
            return f32::NEG_INFINITY;
        };
        let ball = if self.surface.solid.is_some() {
            self.seen(center, closest.as_ref()).penetration + radius
        } else if distance - radius > self.thickness {
            radius - distance
        } else {
            (distance + radius).min(self.thickness)
        };
        // No point of the piece is closer to a triangle than to its plane, nor deeper below it, if it
        // is closest to the triangle and not to an edge in a hollow.
        let mut planes = f32::NEG_INFINITY;
        let within = distance + 2.0 * radius + self.error;
        self.for_each_within(center, within * within, |facet| {
            planes = planes.max(reach(-facet.normal) - facet.height(center));
            planes < ball
        });
        if planes > 0.0 {
            planes *= self.steepness;
        }
        ball.min(planes) + self.error
    }

    /// Visits facets of all boxes within a distance, given as its square, until told to stop.
    fn for_each_within(&self, point: Vec3, square: f32, mut visit: impl FnMut(&Facet) -> bool) {
        let mut stack = [0_u32; STACK];
        let mut left = usize::from(!self.nodes.is_empty());
        while left > 0 {
            left -= 1;
            let node = &self.nodes[stack[left] as usize];
            if (node.bounds.clamp(point) - point).length_squared() > square {
                continue;
            }
            if node.count == 0 {
                stack[left] = node.first;
                stack[left + 1] = node.first + 1;
                left += 2;
                continue;
            }
            let range = node.first as usize..(node.first + node.count) as usize;
            for facet in &self.facets[range] {
                if !visit(facet) {
                    return;
                }
            }
        }
    }
}

impl DistanceField for SurfaceField<'_> {
    #[inline]
    fn penetration(&self, point: Vec3, _normal: Vec3) -> f32 {
        match &self.plane {
            Some(plane) => plane.penetration(point),
            None => self.seen_from(point).penetration,
        }
    }

    fn inward_direction(&self, point: Vec3) -> Vec3 {
        match &self.plane {
            Some(plane) => -plane.normal,
            None => self.seen_from(point).inward,
        }
    }

    fn penetration_bound(&self, center: Vec3, radius: f32) -> f32 {
        match &self.plane {
            Some(plane) => plane.penetration(center) + radius,
            None => self.bound(center, radius, |_| radius),
        }
    }

    #[inline]
    fn penetration_bounds(&self, discs: &Discs) -> [f32; LANES] {
        if let Some(plane) = &self.plane {
            return std::array::from_fn(|lane| {
                let reach = discs.reach(lane, -plane.normal);
                plane.penetration(discs.centers.get(lane)) + reach
            });
        }
        std::array::from_fn(|lane| {
            let reach = |direction| discs.reach(lane, direction);
            self.bound(discs.centers.get(lane), discs.radii[lane], reach)
        })
    }

    fn bounds(&self) -> Aabb {
        self.surface.bounds()
    }

    fn error_bound(&self) -> f32 {
        self.error
    }
}

impl Facet {
    /// How high a point is above the plane.
    fn height(&self, point: Vec3) -> f32 {
        (point - self.corners[0]).dot(self.normal)
    }

    /// The closest of its points, and whether that is one of an edge or a corner.
    fn closest(&self, point: Vec3, facet: usize) -> Closest {
        let (on, closest) = closest_on(self.corners, self.normal, point);
        let square = match on {
            On::Face => self.height(point).powi(2),
            _ => point.distance_squared(closest),
        };
        Closest {
            square,
            facet,
            on,
            point: closest,
        }
    }
}

/// The closest point of a triangle with a unit normal: right below, if that is within all edges, or
/// else on an edge that it is beyond.
fn closest_on(corners: [Vec3; 3], normal: Vec3, p: Vec3) -> (On, Vec3) {
    let mut best = (On::Face, p - normal * (p - corners[0]).dot(normal));
    let mut least = f32::INFINITY;
    for i in 0..3 {
        let (start, along) = (corners[i], corners[(i + 1) % 3] - corners[i]);
        let to_point = p - start;
        if along.cross(to_point).dot(normal) >= 0.0 {
            continue;
        }
        let (ahead, length) = (to_point.dot(along), along.length_squared());
        let found = if ahead <= 0.0 {
            (On::Corner(i), start)
        } else if ahead >= length {
            (On::Corner((i + 1) % 3), corners[(i + 1) % 3])
        } else {
            (On::Edge(i), start + along * (ahead / length))
        };
        let square = p.distance_squared(found.1);
        if square < least {
            (best, least) = (found, square);
        }
    }
    best
}

impl Node {
    fn of(facets: &[Facet], first: usize) -> Self {
        let boxes = facets.iter().map(Facet::bounds);
        let all = boxes.reduce(|a, b| Aabb {
            min: a.min.min(b.min),
            max: a.max.max(b.max),
        });
        Self {
            bounds: all.unwrap_or(Aabb {
                min: Vec3::ZERO,
                max: Vec3::ZERO,
            }),
            first: first as u32,
            count: facets.len() as u32,
        }
    }
}

/// Halves a node, and the halves, until they are small; `first` is where the facets begin.
fn divide(nodes: &mut Vec<Node>, node: usize, facets: &mut [Facet], first: usize) {
    if facets.len() <= LEAF {
        return;
    }
    let extents = nodes[node].bounds.extents();
    let axis = (0..3).fold(0, |a, b| if extents[b] > extents[a] { b } else { a });
    let half = facets.len() / 2;
    let at = |f: &Facet| f.corners[0][axis] + f.corners[1][axis] + f.corners[2][axis];
    facets.select_nth_unstable_by(half, |f, g| {
        at(f).total_cmp(&at(g)).then(f.number.cmp(&g.number))
    });
    let (low, high) = facets.split_at_mut(half);
    let within = nodes.len();
    nodes.push(Node::of(low, first));
    nodes.push(Node::of(high, first + half));
    (nodes[node].first, nodes[node].count) = (within as u32, 0);
    divide(nodes, within, low, first);
    divide(nodes, within + 1, high, first + half);
}

impl Plane {
    #[inline]
    fn penetration(&self, point: Vec3) -> f32 {
        self.offset - point.dot(self.normal)
    }
}

/// The plane that all facets are in, if they end nowhere within `reach` of a box and the box is nowhere
/// deeper below them than they are known to be thick.
fn plane(
    facets: &[Facet],
    around: &Aabb,
    [reach, thickness]: [f32; 2],
    error: f32,
) -> Option<Plane> {
    let first = facets.first()?;
    let normal = first.normal;
    let within = Aabb {
        min: around.min - reach,
        max: around.max + reach,
    };
    let is_level = |f: &Facet| {
        let is_on = |corner: Vec3| first.height(corner).abs() <= error;
        f.corners.into_iter().all(is_on) && f.normal.dot(normal) > 0.0
    };
    let ends = |f: &Facet| {
        let edge = |i: usize| [f.corners[i], f.corners[(i + 1) % 3]];
        (0..3).any(|i| f.edges[i].is_border && meets(edge(i), &within))
    };
    let half = 0.5 * around.extents();
    let lowest = first.height(around.center()) - half.dot(normal.abs());
    let is_plane =
        facets.iter().all(is_level) && lowest >= -reach.min(thickness) && !facets.iter().any(ends);
    is_plane.then(|| Plane {
        normal,
        offset: first.corners[0].dot(normal),
    })
}

/// Whether a segment reaches into a box.
fn meets([start, end]: [Vec3; 2], bounds: &Aabb) -> bool {
    let way = end - start;
    let (mut enter, mut leave) = (0.0_f32, 1.0_f32);
    for axis in 0..3 {
        let (s, w) = (start[axis], way[axis]);
        let (low, high) = (bounds.min[axis], bounds.max[axis]);
        if w == 0.0 {
            if s < low || s > high {
                return false;
            }
            continue;
        }
        let (one, other) = ((low - s) / w, (high - s) / w);
        enter = enter.max(one.min(other));
        leave = leave.min(one.max(other));
    }
    enter <= leave
}

/// A point that is closest to an edge or a corner in a hollow is behind all triangles that meet
/// there, and no deeper than its depth below the mean of them divided by how open it is.
fn steepness(facets: &[Facet]) -> f32 {
    let seams = facets.iter().flat_map(|f| [f.edges, f.vertices]).flatten();
    let hollow = seams.filter(|s: &Seam| s.is_hollow && !s.is_flat());
    let least = hollow.map(|s| s.opening).fold(1.0, f32::min);
    if least > 0.0 {
        1.0 / least
    } else {
        f32::INFINITY
    }
}

#[cfg(test)]
mod tests {
    use glamx::DVec3;
    use proptest::prelude::*;

    use super::*;

    fn vector() -> impl Strategy<Value = Vec3> {
        prop::array::uniform3(-1.0..1.0_f32).prop_map(Vec3::from)
    }

    proptest! {
        /// As in double precision, of slivers, too.
        #[test]
        fn the_closest_point_of_a_triangle_is_closest(
            a in vector(), b in vector(), third in vector(), p in vector(),
            width in prop_oneof![Just(1.0_f32), Just(1e-2), Just(1e-4), Just(1e-6)],
        ) {
            let corners = [a, b, a.midpoint(b) + third * width];
            let [u, v, w] = corners.map(Vec3::as_dvec3);
            let normal = (v - u).cross(w - u);
            prop_assume!(normal != DVec3::ZERO);
            let right = vps_build::closest_point([u, v, w], p.as_dvec3());
            let (_, found) = closest_on(corners, normal.normalize().as_vec3(), p);
            let [right, told] = [right, found.as_dvec3()].map(|q| q.distance(p.as_dvec3()));
            prop_assert!((right - told).abs() < 1e-5, "{right} {told}");
        }
    }
}
