use vps_build::Mesh;

/// Two solids: a body and a ground.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'m> {
    /// The moving body: a closed mesh in metres.
    pub body: &'m Mesh,
    /// The ground it meets.
    pub ground: Ground<'m>,
}

/// The ground of a scene.
#[derive(Clone, Copy, Debug)]
pub enum Ground<'m> {
    /// A box around the origin of the ground's frame, by its edge lengths in metres. It stays a box
    /// whatever the algorithm.
    Cuboid([f64; 3]),
    /// A closed mesh in metres, treated as the body is.
    Mesh(&'m Mesh),
}
