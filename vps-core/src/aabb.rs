use glamx::{Mat3, Pose3, Vec3};

/// An axis-aligned box, its corners in metres in the frame of whatever it bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// The corner with the smallest coordinates.
    pub min: Vec3,
    /// The corner with the largest coordinates.
    pub max: Vec3,
}

impl Aabb {
    /// The smallest box around `points`; `None` without a point.
    pub fn of_points(points: impl IntoIterator<Item = Vec3>) -> Option<Self> {
        let mut points = points.into_iter();
        let first = points.next()?;
        let start = Self {
            min: first,
            max: first,
        };
        Some(points.fold(start, |b, p| Self {
            min: b.min.min(p),
            max: b.max.max(p),
        }))
    }

    /// The point of the box closest to `point`.
    #[inline]
    pub fn clamp(&self, point: Vec3) -> Vec3 {
        point.max(self.min).min(self.max)
    }

    /// Whether `point` lies in the box or on its surface.
    #[inline]
    pub fn contains(&self, point: Vec3) -> bool {
        point.cmpge(self.min).all() && point.cmple(self.max).all()
    }

    /// Whether all of another box lies in this one; `to_this` takes its coordinates to those of this
    /// one.
    pub fn contains_box(&self, other: &Self, to_this: &Pose3) -> bool {
        let half = other.extents() * 0.5;
        let center = to_this.transform_point(other.center());
        let axes = Mat3::from_quat(to_this.rotation);
        let reach =
            axes.x_axis.abs() * half.x + axes.y_axis.abs() * half.y + axes.z_axis.abs() * half.z;
        (center - reach).cmpge(self.min).all() && (center + reach).cmple(self.max).all()
    }

    /// Distance in metres from `point` to the box, 0 inside it.
    #[inline]
    pub fn distance_outside(&self, point: Vec3) -> f32 {
        point.distance(self.clamp(point))
    }

    /// The middle of the box.
    #[inline]
    pub fn center(&self) -> Vec3 {
        (self.min + self.max) * 0.5
    }

    /// Edge lengths in metres.
    #[inline]
    pub fn extents(&self) -> Vec3 {
        self.max - self.min
    }
}
