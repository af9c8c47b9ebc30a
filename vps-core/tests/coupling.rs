//! The virtual coupling: equilibria with springs and walls, energy, and invalid input.

use proptest::prelude::*;
use vps_core::{
    Aabb, Ball, Capsule, CouplingError, CouplingOptions, Cuboid, Cylinder, DistanceField, FieldFn,
    HalfSpace, LinearWrench, Mat3, PointSphereTree, Pose3, Quat, Query, StepError, Tool, Vec3,
    VirtualCoupling, Weight, Wrench,
};

const DT: f32 = 1e-3;

fn vector(size: f32) -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(-size..size).prop_map(Vec3::from_array)
}

fn pose(size: f32, angle: f32) -> impl Strategy<Value = Pose3> {
    (vector(size), vector(angle)).prop_map(|(displacement, turn)| Pose3::new(displacement, turn))
}

/// From 10^`low` to 10^`high`.
fn magnitude(low: f32, high: f32) -> impl Strategy<Value = f32> {
    (low..high).prop_map(|exponent| 10.0_f32.powf(exponent))
}

/// A box of some centimetres with its centre of mass anywhere within, and a mass of 1 g to 0.3 kg.
fn tool() -> impl Strategy<Value = Tool> {
    let edges = prop::array::uniform3(0.02..0.1_f32);
    (edges, vector(0.01), vector(1.0), magnitude(-3.0, -0.5)).prop_map(
        |([x, y, z], center, turn, mass)| {
            let turn = Mat3::from_quat(Quat::from_scaled_axis(turn));
            let moments = Vec3::new(y * y + z * z, x * x + z * z, x * x + y * y);
            let inertia = Mat3::from_diagonal(moments * (mass / 12.0));
            let inertia = turn * inertia * turn.transpose();
            Tool {
                mass,
                inertia,
                center,
            }
        },
    )
}

fn coupling(tool: Tool) -> VirtualCoupling {
    let options = CouplingOptions::critically_damped(&tool, 1000.0, 2.0);
    VirtualCoupling::new(tool, options, Pose3::identity()).unwrap()
}

/// The world is solid below y = 0. Each point of the tool has `stiffness` N/m.
#[derive(Clone, Debug)]
struct Wall {
    points: Vec<Vec3>,
    stiffness: f32,
}

impl Wall {
    /// The wrench of the wall on the tool, in the world.
    fn contact(&self, coupling: &VirtualCoupling) -> LinearWrench {
        let pose = coupling.pose();
        let center = pose.transform_point(coupling.tool().center);
        let mut sum = LinearWrench::ZERO;
        for point in &self.points {
            let point = pose.transform_point(*point);
            let depth = -point.y;
            if depth > 0.0 {
                let (n, m) = (Vec3::Y, (point - center).cross(Vec3::Y));
                sum.wrench.force += depth * n;
                sum.wrench.torque += depth * m;
                let product = |a: Vec3, b: Vec3| Mat3::from_cols(a * b.x, a * b.y, a * b.z);
                sum.translational += product(n, n);
                sum.mixed += product(m, n);
                sum.rotational += product(m, m);
            }
        }
        sum * self.stiffness
    }

    fn depth(&self, coupling: &VirtualCoupling) -> f32 {
        let depths = self
            .points
            .iter()
            .map(|p| -coupling.pose().transform_point(*p).y);
        depths.fold(f32::NEG_INFINITY, f32::max)
    }
}

fn wall() -> impl Strategy<Value = Wall> {
    let points = prop::collection::vec(vector(0.05), 1..6);
    (points, magnitude(2.0, 8.0)).prop_map(|(points, stiffness)| Wall { points, stiffness })
}

/// The same tool at rest elsewhere.
fn placed(coupling: &VirtualCoupling, pose: Pose3) -> VirtualCoupling {
    VirtualCoupling::new(*coupling.tool(), *coupling.options(), pose).unwrap()
}

/// Kinetic energy plus that of the springs, whose forces are limited.
fn energy(coupling: &VirtualCoupling) -> f32 {
    let (tool, options) = (coupling.tool(), coupling.options());
    let (pose, device) = (coupling.pose(), coupling.device());
    let turn = Mat3::from_quat(pose.rotation);
    let angular = turn.transpose() * coupling.angular_velocity();
    let kinetic =
        tool.mass * coupling.velocity().length_squared() + angular.dot(tool.inertia * angular);
    let center = tool.center;
    let offset = device.transform_point(center) - pose.transform_point(center);
    let spring = |stiffness: f32, limit: f32, length: f32| {
        let most = limit / stiffness;
        let within = length.min(most);
        0.5 * stiffness * within * within + limit * (length - within)
    };
    0.5 * kinetic
        + spring(options.stiffness, options.max_force, offset.length())
        + spring(
            options.angular_stiffness,
            options.max_torque,
            pose.rotation.angle_between(device.rotation),
        )
}

fn is_close(a: Vec3, b: Vec3, tolerance: f32) -> bool {
    (a - b).length() <= tolerance
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn in_free_space_the_tool_follows_without_force(
        tool in tool(), device in pose(0.1, 1.0),
    ) {
        let mut coupling = coupling(tool);
        for _ in 0..6000 {
            coupling.step(device, Wrench::default(), DT).unwrap();
        }
        let pose = coupling.pose();
        prop_assert!(is_close(pose.translation, device.translation, 1e-5));
        prop_assert!(pose.rotation.angle_between(device.rotation) < 1e-3);
        let felt = coupling.rendered();
        prop_assert!(felt.force.length() < 1e-2 && felt.torque.length() < 1e-3, "{felt:?}");
    }

    /// Two springs in series.
    #[test]
    fn a_wall_exerts_a_force_proportional_to_the_depth_of_the_device(
        tool in tool(), depth in 1e-4..8e-3_f32, stiffness in magnitude(2.0, 9.0),
        aside in vector(0.1),
    ) {
        let wall = Wall { points: vec![tool.center], stiffness };
        let mut coupling = coupling(tool);
        let aside = Vec3::new(aside.x, 0.0, aside.z);
        let start = aside - tool.center + 1e-3 * Vec3::Y;
        coupling = placed(&coupling, Pose3::from_translation(start));
        let device = Pose3::from_translation(aside - tool.center - depth * Vec3::Y);
        for _ in 0..4000 {
            let contact = wall.contact(&coupling);
            coupling.step(device, contact, DT).unwrap();
        }
        let spring = coupling.options().stiffness;
        let force = depth / (1.0 / spring + 1.0 / stiffness);
        let felt = coupling.rendered().force;
        prop_assert!(is_close(felt, force * Vec3::Y, 0.01 * force + 1e-3), "{felt} {force}");
        let tool_depth = wall.depth(&coupling);
        prop_assert!((tool_depth - force / stiffness).abs() < 0.01 * tool_depth.abs() + 1e-7);
    }

    /// A tool at rest passes the wrench of the contacts on to the device.
    #[test]
    fn at_rest_the_device_renders_the_wrench_of_the_contacts(
        tool in tool(), mut wall in wall(), device in pose(0.02, 0.3),
    ) {
        // Beyond this, the resolution of a 32-bit coordinate times the stiffness is in newtons.
        wall.stiffness = wall.stiffness.min(1e6);
        let start = Pose3::from_translation(Vec3::new(0.0, 0.15, 0.0));
        let mut coupling = placed(&coupling(tool), start);
        let mut contact = LinearWrench::ZERO;
        for _ in 0..8000 {
            contact = wall.contact(&coupling);
            coupling.step(device, contact, DT).unwrap();
        }
        let (felt, is) = (coupling.rendered(), contact.wrench);
        prop_assert!(is_close(felt.force, is.force, 0.01 * is.force.length() + 1e-2), "{felt:?} {is:?}");
        prop_assert!(is_close(felt.torque, is.torque, 0.01 * is.torque.length() + 2e-3), "{felt:?} {is:?}");
    }

    #[test]
    fn with_a_still_device_energy_does_not_grow(
        tool in tool(), wall in wall(), device in pose(0.03, 0.5), from in pose(0.2, 0.5),
    ) {
        let up = Pose3::from_translation(Vec3::new(0.0, 0.35, 0.0));
        let mut coupling = placed(&coupling(tool), up * from);
        // The device is placed there and stays.
        coupling.step(device, Wrench::default(), DT).unwrap();
        let start = energy(&coupling);
        let mut least_free = start;
        for _ in 0..3000 {
            let contact = wall.contact(&coupling);
            let is_free = contact == LinearWrench::ZERO;
            let before = energy(&coupling);
            coupling.step(device, contact, DT).unwrap();
            let after = energy(&coupling);
            // Contacts are detected once the tool has entered them. A single one returns less energy
            // than it took; one of several that began in different steps may return some of another's.
            let most = if wall.points.len() == 1 { 1.001 * least_free } else { 1.25 * start };
            prop_assert!(after <= most + 1e-3 * start + 1e-5, "{after} of {most}");
            if is_free {
                prop_assert!(after <= before * 1.001 + 1e-5, "{after} after {before}");
                least_free = least_free.min(before);
            }
        }
    }

    #[test]
    fn jumps_of_the_device_stay_stable(
        tool in tool(), wall in wall(),
        jumps in prop::collection::vec(pose(1.0, 3.0), 1..20),
    ) {
        let mut coupling = coupling(tool);
        for device in jumps {
            for _ in 0..30 {
                let contact = wall.contact(&coupling);
                let felt = coupling.step(device, contact, DT).unwrap();
                let options = coupling.options();
                prop_assert!(felt.force.length() <= options.max_force * 1.0001);
                prop_assert!(felt.torque.length() <= options.max_torque * 1.0001);
                prop_assert!(coupling.velocity().length() <= options.max_speed * 1.0001);
                prop_assert!(coupling.angular_velocity().length() <= options.max_angular_speed * 1.0001);
                prop_assert!(coupling.pose().is_finite());
            }
        }
    }

    /// For any numbers, a step succeeds and the state is finite, or it fails and the state is
    /// unchanged.
    #[test]
    fn any_numbers_leave_a_finite_state(
        tool in tool(),
        steps in prop::collection::vec(
            (prop::array::uniform7(any::<f32>()), prop::array::uniform32(any::<f32>()), any::<f32>()),
            1..20,
        ),
        usual in any::<bool>(),
    ) {
        let mut coupling = coupling(tool);
        for ([x, y, z, i, j, k, w], c, dt) in steps {
            let device = Pose3::from_parts(Vec3::new(x, y, z), Quat::from_xyzw(i, j, k, w));
            let matrix = |at: usize| Mat3::from_cols_slice(&c[at..at + 9]);
            let contact = LinearWrench {
                wrench: Wrench { force: Vec3::from_slice(&c[..3]), torque: Vec3::from_slice(&c[3..6]) },
                translational: matrix(6), mixed: matrix(14), rotational: matrix(22),
            };
            let before = coupling;
            let dt = if usual { DT } else { dt };
            match coupling.step(device, contact, dt) {
                Ok(felt) => {
                    prop_assert!(felt.force.length() <= coupling.options().max_force * 1.0001);
                    prop_assert!(felt.torque.length() <= coupling.options().max_torque * 1.0001);
                    prop_assert!(coupling.pose().is_finite());
                    prop_assert!(coupling.velocity().is_finite());
                    prop_assert!(coupling.angular_velocity().is_finite());
                }
                Err(_) => prop_assert_eq!(before, coupling),
            }
        }
    }

    /// The same in another world frame.
    #[test]
    fn a_change_of_frame_changes_nothing(
        tool in tool(), wall in wall(), device in pose(0.02, 0.3), motion in pose(0.2, 3.0),
    ) {
        let start = Pose3::from_translation(Vec3::new(0.0, 0.1, 0.0));
        let mut here = placed(&coupling(tool), start);
        let mut there = placed(&here, motion * start);
        for _ in 0..300 {
            // Both get the same contacts, since one that begins a step later makes a difference.
            let contact = wall.contact(&here);
            let felt = here.step(device, contact, DT).unwrap();
            let contact = contact.rotated(motion.rotation);
            let felt_there = there.step(motion * device, contact, DT).unwrap();
            let force = motion.rotation * felt.force;
            let torque = motion.rotation * felt.torque;
            // Of at most 10 N and 0.5 N m; coordinates are rounded differently.
            prop_assert!(is_close(felt_there.force, force, 0.1), "{} {force}", felt_there.force);
            prop_assert!(is_close(felt_there.torque, torque, 5e-3), "{} {torque}", felt_there.torque);
        }
    }

    /// The stability limit for stiffness that is predicted in part or not at all.
    #[test]
    fn contacts_may_be_stiffer_than_predicted(
        mass in magnitude(-3.0, 0.0), predicted in 0.0..3.0_f32, share in 0.1..0.95_f32,
    ) {
        let tool = Tool { mass, inertia: Mat3::from_diagonal(Vec3::splat(1e-4)), center: Vec3::ZERO };
        let mut options = CouplingOptions::critically_damped(&tool, 1000.0, 2.0);
        options.contact_damping = 0.0;
        options.max_speed = 1e6;
        let limit = 4.0 * mass / (DT * DT);
        let predicted = predicted * limit;
        let stiffness = share * (limit + 2.0 * predicted);
        // A bilateral contact, so that it never ends.
        let mut coupling = VirtualCoupling::new(tool, options, Pose3::from_translation(1e-3 * Vec3::Y)).unwrap();
        for _ in 0..5000 {
            let mut contact = LinearWrench::ZERO;
            contact.wrench.force = -stiffness * coupling.pose().translation;
            contact.translational = Mat3::from_diagonal(Vec3::splat(predicted));
            coupling.step(Pose3::identity(), contact, DT).unwrap();
        }
        let displacement = coupling.pose().translation.length();
        prop_assert!(displacement < 1e-3, "{displacement} m");
    }
}

#[test]
fn arguments_that_are_not_finite_are_refused() {
    let tool = Tool {
        mass: 0.01,
        inertia: Mat3::from_diagonal(Vec3::splat(1e-6)),
        center: Vec3::ZERO,
    };
    let mut coupling = coupling(tool);
    let device = Pose3::from_translation(Vec3::new(0.001, 0.0, 0.0));
    let felt = coupling.step(device, Wrench::default(), DT).unwrap();
    assert!(felt.force.x < 0.0, "the tool lags behind: {felt:?}");
    let before = coupling;
    let nan = Pose3::from_translation(Vec3::NAN);
    let none = Wrench::default();
    let broken = Wrench {
        force: Vec3::INFINITY,
        torque: Vec3::ZERO,
    };
    assert_eq!(coupling.step(nan, none, DT), Err(StepError::Device));
    let far = Pose3::from_translation(Vec3::splat(f32::MAX));
    assert_eq!(coupling.step(far, none, DT), Err(StepError::Device));
    let unturned = Pose3::from_parts(Vec3::ZERO, Quat::from_xyzw(0.0, 0.0, 0.0, 0.0));
    assert_eq!(coupling.step(unturned, none, DT), Err(StepError::Device));
    assert_eq!(coupling.step(device, broken, DT), Err(StepError::Contact));
    assert_eq!(
        coupling.step(device, none, 0.0),
        Err(StepError::TimeStep(0.0))
    );
    assert_eq!(coupling, before);
    assert_eq!(coupling.rendered(), felt);
}

#[test]
fn invalid_parameters_are_named() {
    let tool = Tool {
        mass: 0.01,
        inertia: Mat3::from_diagonal(Vec3::splat(1e-6)),
        center: Vec3::ZERO,
    };
    let options = CouplingOptions::critically_damped(&tool, 1000.0, 2.0);
    let new = |tool, options| VirtualCoupling::new(tool, options, Pose3::identity()).unwrap_err();
    let error = new(Tool { mass: 0.0, ..tool }, options);
    assert_eq!(error.to_string(), "mass must be positive and finite, not 0");
    let stiffness = f32::NAN;
    let error = new(
        tool,
        CouplingOptions {
            stiffness,
            ..options
        },
    );
    assert!(error.to_string().starts_with("stiffness must be positive"));
    let damping = -1.0;
    let error = new(tool, CouplingOptions { damping, ..options });
    assert_eq!(
        error.to_string(),
        "damping must be finite and not negative, not -1"
    );
    let flat = Mat3::from_diagonal(Vec3::new(1.0, 1.0, 0.0));
    let skew = Mat3::from_cols(Vec3::X, Vec3::new(0.5, 1.0, 0.0), Vec3::Z);
    for inertia in [Mat3::NAN, flat, skew, -Mat3::IDENTITY] {
        assert_eq!(
            new(Tool { inertia, ..tool }, options),
            CouplingError::Inertia
        );
    }
    let nowhere = Pose3::from_translation(Vec3::NAN);
    let error = VirtualCoupling::new(tool, options, nowhere).unwrap_err();
    assert_eq!(error, CouplingError::Pose);
}

/// A tree of one cluster; each point represents 1 mm².
fn tree_of(points: &[Vec3], normals: &[Vec3]) -> PointSphereTree<'static> {
    PointSphereTree::flat(points, normals, 1e-6).unwrap()
}

/// Half of the width of a box that slides, in metres.
const HALF_WIDTH: f32 = 0.02;

/// The underside of a box: points a millimetre apart, to whose normals `tilt` is added.
fn underside(mut tilt: impl FnMut(Vec3) -> Vec3) -> PointSphereTree<'static> {
    let place = |i: u8| -HALF_WIDTH + f32::from(i) * 1e-3;
    let points = (0..=40).flat_map(|i| (0..=40).map(move |k| (place(i), place(k))));
    let points: Vec<_> = points.map(|(x, z)| Vec3::new(x, 0.0, z)).collect();
    let normals = points.iter().map(|p| (Vec3::Y + tilt(*p)).normalize());
    tree_of(&points, &normals.collect::<Vec<_>>())
}

/// The normals of a box: those of the rims point halfway to the sides.
fn box_normals(point: Vec3) -> Vec3 {
    let rim = |c: f32| {
        if c.abs() > HALF_WIDTH - 1e-4 {
            -c.signum()
        } else {
            0.0
        }
    };
    Vec3::new(rim(point.x), 0.0, rim(point.z))
}

/// The force that the device renders for a tool on level ground of a given stiffness in N/m³, on
/// average over 20 cycles: first pressed on with 1 N, then moved along at 0.1 m/s.
fn felt_in_sliding(
    tree: &PointSphereTree<'_>,
    ground: &impl DistanceField,
    height: f32,
    stiffness: f32,
) -> Vec3 {
    let tool = Tool {
        mass: 0.05,
        inertia: Mat3::from_diagonal(Vec3::splat(1e-5)),
        center: 0.01 * Vec3::Y,
    };
    let start = Pose3::from_translation(Vec3::new(-0.05, height, 0.0));
    let mut coupling = placed(&coupling(tool), start);
    let depth = 1.0 / coupling.options().stiffness;
    let mut felt = Vec3::ZERO;
    for cycle in 0..600 {
        let displacement = 1e-4 * (cycle as f32 - 200.0).max(0.0);
        let device = start.translation + Vec3::new(displacement, -depth, 0.0);
        let pose = coupling.pose();
        let contact = Query::new(tree, ground, pose).linear_wrench(tool.center, Weight::Area);
        let contact = (contact * stiffness).rotated(pose.rotation);
        let device = Pose3::from_translation(device);
        let wrench = coupling.step(device, contact, DT).unwrap();
        if cycle >= 580 {
            felt += wrench.force / 20.0;
        }
    }
    felt
}

#[test]
fn a_box_slides_freely_on_level_ground() {
    let ground = Cuboid::new(Vec3::new(1.0, 0.1, 1.0));
    for stiffness in [1e6, 1e8, 1e10] {
        let felt = felt_in_sliding(&underside(box_normals), &ground, 0.1, stiffness);
        // The device is 1 mm deep, and the tool in a ground of finite stiffness.
        let expected = 1.0 / (1.0 + 1000.0 / (stiffness * 1681e-6));
        assert!((felt.y - expected).abs() < 0.02, "{stiffness}: {felt}");
        assert!(felt.with_y(0.0).length() < 1e-3, "{stiffness}: {felt}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(10))]

    #[test]
    fn a_tool_slides_freely_with_any_normals(
        tilts in prop::collection::vec(vector(2.0), 1..50), stiffness in magnitude(6.0, 10.0),
        is_a_function in any::<bool>(),
    ) {
        let mut tilts = tilts.iter().cycle();
        let tree = underside(|_| tilts.next().unwrap().with_y(0.0));
        let felt = if is_a_function {
            let bounds = Aabb { min: Vec3::splat(-1.0), max: Vec3::splat(1.0) };
            let ground = FieldFn::new(|p: Vec3| -p.y, 1.0, bounds, 0.0);
            felt_in_sliding(&tree, &ground, 0.0, stiffness)
        } else {
            felt_in_sliding(&tree, &HalfSpace::new(Vec3::Y), 0.0, stiffness)
        };
        prop_assert!(felt.y > 0.5, "{}", felt);
        prop_assert!(felt.with_y(0.0).length() < 1e-3, "{}", felt);
    }
}

/// Contacts of random points and normals with a solid: the quadratic potential of their wrench touches
/// the true one at the tool and is nowhere below it. So an implicit step adds no energy.
fn check_potential(
    solid: &impl DistanceField,
    pose: Pose3,
    [points, normals]: [&[Vec3]; 2],
    (displacement, turn): (Vec3, Vec3),
) -> Result<(), TestCaseError> {
    let tree = tree_of(points, normals);
    let center = Vec3::new(0.01, -0.02, 0.005);
    let linear = Query::new(&tree, solid, pose).linear_wrench(center, Weight::Point);
    let [t, m, r] = [linear.translational, linear.mixed, linear.rotational];
    let curved =
        displacement.dot(t * displacement) + 2.0 * turn.dot(m * displacement) + turn.dot(r * turn);
    let given = linear.wrench.force.dot(displacement) + linear.wrench.torque.dot(turn);
    let change = 0.5 * curved - given;

    let turned = Quat::from_scaled_axis(turn);
    let (mut expected, mut tolerance) = (0.0, 1e-9);
    for point in points {
        let arm = *point - center;
        let at = |p: Vec3| {
            solid
                .penetration(pose.transform_point(p), Vec3::ZERO)
                .max(0.0)
        };
        let before = at(*point);
        if before > 0.0 {
            let after = at(center + turned * arm + displacement);
            expected += 0.5 * (after * after - before * before);
            // A rotation differs from a linear displacement by its square.
            let off = 0.5 * turn.length_squared() * arm.length();
            let deepest = before + displacement.length() + turn.length() * arm.length();
            tolerance += deepest * (off + 1e-6) + off * off;
        }
    }
    prop_assert!(
        change >= expected - tolerance,
        "{change} {expected} {tolerance}"
    );
    Ok(())
}

proptest! {
    #[test]
    fn the_potential_of_a_linear_wrench_is_nowhere_below_the_true_one(
        points in prop::collection::vec(vector(0.1), 1..9),
        normals in prop::array::uniform8(vector(1.0)),
        pose in pose(0.1, 3.0), displacement in vector(0.05), turn in vector(0.02), is_turned in any::<bool>(),
    ) {
        let normals = normals.map(|n| n.try_normalize().unwrap_or(Vec3::Y));
        let shell = [&points[..], &normals[..points.len()]];
        let motion = (displacement, if is_turned { turn } else { Vec3::ZERO });
        check_potential(&Ball::new(0.1), pose, shell, motion)?;
        check_potential(&Cuboid::new(Vec3::new(0.1, 0.05, 0.2)), pose, shell, motion)?;
        check_potential(&HalfSpace::new(Vec3::new(1.0, 2.0, 3.0)), pose, shell, motion)?;
        check_potential(&Capsule::new(0.05, 0.08), pose, shell, motion)?;
        check_potential(&Cylinder::new(0.05, 0.1), pose, shell, motion)?;
    }
}
