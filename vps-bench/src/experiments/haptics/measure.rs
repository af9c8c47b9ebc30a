//! The haptic loop: its cycles in real time, and the same queries asked again afterwards.

use std::hint::black_box;
use std::time::{Duration, Instant};

use serde::Serialize;
use vps_core::{Pose3, Query, VirtualCoupling, Weight, Wrench};

use super::real_time::{Cycle, DT, in_real_time};
use super::scenes::Scene;

/// Cycles before those that count.
const WARM_UP: usize = 500;

/// A cycle: what was felt, and the time it took.
#[derive(Clone, Debug, Default, Serialize)]
pub(super) struct Row {
    time_s: f64,
    device_x_m: f32,
    device_y_m: f32,
    device_z_m: f32,
    device_qx: f32,
    device_qy: f32,
    device_qz: f32,
    device_qw: f32,
    tool_x_m: f32,
    tool_y_m: f32,
    tool_z_m: f32,
    tool_qx: f32,
    tool_qy: f32,
    tool_qz: f32,
    tool_qw: f32,
    force_x_n: f32,
    force_y_n: f32,
    force_z_n: f32,
    torque_x_n_m: f32,
    torque_y_n_m: f32,
    torque_z_n_m: f32,
    /// Of the deepest contact; 0 without contacts.
    penetration_m: f32,
    contacts: usize,
    collision_ns: u128,
    collision_replayed_ns: u128,
    /// Of force and torque alone.
    wrench_replayed_ns: u128,
    cycle_ns: u128,
    late_ns: u128,
}

/// The result of a cycle.
#[derive(Clone, Copy, Debug, Default)]
struct Felt {
    device: Pose3,
    /// The tool when contacts were asked for.
    tool: Pose3,
    /// Exerted by the device.
    wrench: Wrench,
    collision: Duration,
}

/// The loop without anything to do.
pub(super) fn idle(cycles: usize) -> Vec<Row> {
    let all = in_real_time(cycles, |_| Felt::default());
    all.iter().enumerate().map(|(i, c)| row(i, c)).collect()
}

impl Scene {
    /// Runs the loop, and asks each query again `replays` times, of which the shortest counts.
    ///
    /// # Errors
    /// When the coupling refuses its options or a pose.
    pub(super) fn measure(&self, cycles: usize, replays: u32) -> Result<Vec<Row>, String> {
        let cycles = self.run(cycles)?;
        let rows = cycles.iter().enumerate();
        Ok(rows
            .map(|(i, c)| self.replay(row(i, c), c, replays))
            .collect())
    }

    fn run(&self, cycles: usize) -> Result<Vec<Cycle<Felt>>, String> {
        let field = self.solid.voxelmap.trilinear();
        let center = self.body.center;
        let before = self.device.len().saturating_sub(WARM_UP);
        let coupling = VirtualCoupling::new(self.body, self.coupling, self.device[before]);
        let mut coupling = coupling.map_err(|e| e.to_string())?;
        let mut refused = None;
        let mut cycle = |i: usize| {
            let device = self.device[i % self.device.len()];
            let pose = coupling.pose();
            let asked = Instant::now();
            let contact =
                Query::new(&self.tool.tree, &field, pose).linear_wrench(center, Weight::Area);
            let collision = asked.elapsed();
            let contact = (contact * self.contact_stiffness_n_m3).rotated(pose.rotation);
            let stepped = coupling.step(device, contact, DT);
            refused = refused.or(stepped.err());
            Felt {
                device,
                tool: pose,
                wrench: coupling.rendered(),
                collision,
            }
        };
        // The end of the loop leads to its beginning.
        for i in before..self.device.len() {
            cycle(i);
        }
        let all = in_real_time(cycles, cycle);
        match refused {
            Some(error) => Err(error.to_string()),
            None => Ok(all),
        }
    }

    /// Asks the queries of a cycle again, without a deadline.
    fn replay(&self, row: Row, cycle: &Cycle<Felt>, replays: u32) -> Row {
        let field = self.solid.voxelmap.trilinear();
        let center = self.body.center;
        let query = Query::new(&self.tool.tree, &field, cycle.result.tool);
        let linear = || _ = black_box(query.linear_wrench(center, Weight::Area));
        let wrench = || _ = black_box(query.wrench(center, Weight::Area));
        let mut contacts = 0;
        query.for_each_contact(|_| contacts += 1);
        Row {
            penetration_m: query.deepest().map_or(0.0, |c| c.penetration),
            contacts,
            collision_replayed_ns: shortest(replays, linear).as_nanos(),
            wrench_replayed_ns: shortest(replays, wrench).as_nanos(),
            ..row
        }
    }
}

fn row(number: usize, cycle: &Cycle<Felt>) -> Row {
    let felt = &cycle.result;
    let of = |pose: Pose3| (pose.translation.to_array(), pose.rotation.to_array());
    let ([device_x_m, device_y_m, device_z_m], [device_qx, device_qy, device_qz, device_qw]) =
        of(felt.device);
    let ([tool_x_m, tool_y_m, tool_z_m], [tool_qx, tool_qy, tool_qz, tool_qw]) = of(felt.tool);
    let [force_x_n, force_y_n, force_z_n] = felt.wrench.force.to_array();
    let [torque_x_n_m, torque_y_n_m, torque_z_n_m] = felt.wrench.torque.to_array();
    Row {
        time_s: number as f64 / 1000.0,
        device_x_m,
        device_y_m,
        device_z_m,
        device_qx,
        device_qy,
        device_qz,
        device_qw,
        tool_x_m,
        tool_y_m,
        tool_z_m,
        tool_qx,
        tool_qy,
        tool_qz,
        tool_qw,
        force_x_n,
        force_y_n,
        force_z_n,
        torque_x_n_m,
        torque_y_n_m,
        torque_z_n_m,
        collision_ns: felt.collision.as_nanos(),
        cycle_ns: cycle.duration.as_nanos(),
        late_ns: cycle.late.as_nanos(),
        ..Row::default()
    }
}

/// The shortest time of several.
fn shortest(times: u32, ask: impl Fn()) -> Duration {
    let once = |_| {
        let asked = Instant::now();
        ask();
        asked.elapsed()
    };
    (0..times).map(once).min().unwrap_or_default()
}
