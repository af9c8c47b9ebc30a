use rapier3d::geometry::ContactManifold;
use rapier3d::parry::query::ContactManifoldsWorkspace;

/// Contacts of a pair, which persist from query to query as in an engine.
#[derive(Default)]
pub struct Contacts {
    /// Manifolds; the ground is the first shape.
    pub manifolds: Vec<ContactManifold>,
    pub(crate) workspace: Option<ContactManifoldsWorkspace>,
}

impl Contacts {
    /// The number of points in all manifolds and the deepest penetration in metres, negative if
    /// nothing touches yet; `None` without a point.
    pub fn count_and_deepest(&self) -> (usize, Option<f32>) {
        count_and_deepest(self.manifolds.iter())
    }
}

/// The number of points in manifolds and their deepest penetration in metres.
pub fn count_and_deepest<'m>(
    manifolds: impl Iterator<Item = &'m ContactManifold>,
) -> (usize, Option<f32>) {
    let points = manifolds.flat_map(|m| m.points.iter());
    points.fold((0, None), |(count, deepest), point| {
        let depth = -point.dist;
        (
            count + 1,
            Some(deepest.map_or(depth, |d: f32| d.max(depth))),
        )
    })
}
