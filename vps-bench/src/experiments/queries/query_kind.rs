//! The queries that are timed, by name.

use std::hint::black_box;

use vps_core::{DistanceField, Observer, PointSphereTree, Query};

use crate::experiments::shared::tree_query::TreeQuery;

/// A query that is timed.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) enum QueryKind {
    Tree(TreeQuery),
    /// The deepest contact of each segment of a level as in section 2.4: all contacts are listed, and
    /// each replaces that of its segment if it is deeper.
    Listed(u32),
    /// All contacts.
    Contacts,
}

/// For each level of a tree, the first points behind its segments.
pub(super) struct SegmentEnds(Vec<Vec<usize>>);

impl SegmentEnds {
    pub(super) fn of(tree: &PointSphereTree<'_>) -> Self {
        let ends = |level: u32| {
            let end = |cluster| tree.points_below(level, cluster).end;
            tree.level(level).iter().map(end).collect()
        };
        Self((1..=tree.level_count()).map(ends).collect())
    }

    /// The ends at a level, or at the lowest one if there are fewer.
    fn at(&self, level: u32) -> &[usize] {
        &self.0[(level as usize).min(self.0.len()) - 1]
    }
}

impl QueryKind {
    /// Those that are compared by field and by clustering.
    pub(super) const ALL: [Self; 10] = [
        Self::Tree(TreeQuery::Touches),
        Self::Tree(TreeQuery::Deepest),
        Self::Tree(TreeQuery::Manifold),
        Self::Tree(TreeQuery::Wrench),
        Self::Tree(TreeQuery::Segments(2)),
        Self::Tree(TreeQuery::Segments(3)),
        Self::Tree(TreeQuery::Segments(4)),
        Self::Tree(TreeQuery::Segments(5)),
        Self::Listed(1),
        Self::Listed(5),
    ];

    /// Those that are compared by number of points.
    pub(super) const BY_POINTS: [Self; 4] = [
        Self::Contacts,
        Self::Tree(TreeQuery::Deepest),
        Self::Tree(TreeQuery::Segments(4)),
        Self::Tree(TreeQuery::Manifold),
    ];

    /// Those that are compared by number of triangles.
    pub(super) const BY_TRIANGLES: [Self; 2] = [
        Self::Tree(TreeQuery::Manifold),
        Self::Tree(TreeQuery::Wrench),
    ];

    pub(super) fn name(self) -> String {
        match self {
            Self::Tree(TreeQuery::Touches) => "touches".into(),
            Self::Tree(TreeQuery::Deepest) => "deepest".into(),
            Self::Tree(TreeQuery::Manifold) => "manifold".into(),
            Self::Tree(TreeQuery::Wrench) => "wrench".into(),
            Self::Tree(TreeQuery::Segments(level)) => format!("segments_{level}"),
            Self::Listed(level) => format!("listed_{level}"),
            Self::Contacts => "contacts".into(),
        }
    }

    pub(super) fn label(self) -> String {
        match self {
            Self::Tree(TreeQuery::Touches) => "touches".into(),
            Self::Tree(TreeQuery::Deepest) => "deepest".into(),
            Self::Tree(TreeQuery::Manifold) => "manifold of 4".into(),
            Self::Tree(TreeQuery::Wrench) => "force and torque".into(),
            Self::Tree(TreeQuery::Segments(level)) => format!("segments, L = {level}"),
            Self::Listed(level) => format!("segments by listing, L = {level}"),
            Self::Contacts => "all contacts".into(),
        }
    }

    /// Executes the query; its result is computed and dropped.
    pub(super) fn execute<F: DistanceField, W: Observer + Copy>(
        self,
        query: &Query<'_, F, W>,
        ends: &SegmentEnds,
    ) {
        match self {
            Self::Tree(kind) => kind.execute(query),
            Self::Listed(level) => _ = black_box(listed(query, ends.at(level))),
            Self::Contacts => {
                let mut sum = 0.0;
                query.for_each_contact(|contact| sum += contact.penetration);
                _ = black_box(sum);
            }
        }
    }
}

/// The sum of the deepest penetrations of all segments, by listing all contacts. `ends` has the first
/// point behind each segment.
fn listed<F: DistanceField, W: Observer>(query: &Query<'_, F, W>, ends: &[usize]) -> f32 {
    let mut segment = 0;
    let (mut deepest, mut sum) = (0.0_f32, 0.0);
    query.for_each_contact(|contact| {
        let point = contact.point_index as usize;
        if point >= ends[segment] {
            segment += ends[segment..].partition_point(|&end| end <= point);
            sum += deepest;
            deepest = 0.0;
        }
        deepest = deepest.max(contact.penetration);
    });
    sum + deepest
}
