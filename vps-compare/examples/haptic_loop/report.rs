//! What is written of the runs.

use std::fmt::Write;
use std::path::Path;
use std::time::Duration;

use vps_build::write_atomically;

use crate::scenes::Scene;
use crate::{DT, Error, PERIOD, Replayed, Sample};

/// A scene, cycle by cycle.
pub(crate) struct Run<'s> {
    pub(crate) scene: &'s Scene,
    pub(crate) samples: Vec<Sample>,
    pub(crate) replayed: Vec<Replayed>,
}

/// How the operating system schedules this thread, and how busy it is.
pub(crate) struct Scheduling {
    policy: Option<u32>,
    /// How many threads ran or waited to, in the last minute.
    load: Option<f64>,
}

impl Scheduling {
    pub(crate) fn of_this_thread() -> Self {
        let read = |file| std::fs::read_to_string(file).unwrap_or_default();
        // The 41st number of what Linux says of a thread, 39 behind its name in brackets.
        let stat = read("/proc/thread-self/stat");
        let (_, behind) = stat.rsplit_once(')').unwrap_or_default();
        let policy = behind.split_whitespace().nth(38);
        let load = read("/proc/loadavg");
        Self {
            policy: policy.and_then(|n| n.parse().ok()),
            load: load.split(' ').next().and_then(|n| n.parse().ok()),
        }
    }

    fn text(&self) -> String {
        let policy = match self.policy {
            Some(0) => "as any other program",
            Some(1 | 2) => "with real-time priority (`just haptics 10 \"chrt -f 50\"`)",
            _ => "in a way that is not known",
        };
        match self.load {
            Some(load) => format!("{policy};\nload average of the minute before: {load:.1}"),
            None => policy.into(),
        }
    }
}

/// The last of the shortest times that make up this share of all.
fn percentile(times: impl Iterator<Item = Duration>, share: f64) -> Duration {
    let mut times: Vec<_> = times.collect();
    times.sort_unstable();
    let rank = (share * times.len() as f64).ceil() as usize;
    times[rank.clamp(1, times.len()) - 1]
}

/// In µs.
fn micros(time: Duration) -> f64 {
    time.as_secs_f64() * 1e6
}

pub(crate) fn write(
    folder: &Path,
    nothing: &[Sample],
    runs: &[Run<'_>],
    scheduling: &Scheduling,
) -> Result<(), Error> {
    std::fs::create_dir_all(folder)?;
    for run in runs {
        let name = format!("trace_{}_{}.csv", run.scene.name, run.scene.store);
        write_atomically(&folder.join(name), trace(run)?.as_bytes())?;
    }
    let text = readme(nothing, runs, scheduling)?;
    write_atomically(&folder.join("README.md"), text.as_bytes())?;
    print!("{text}");
    Ok(())
}

fn trace(run: &Run<'_>) -> Result<String, Error> {
    let mut csv = String::from(
        "time_s,device_x_m,device_y_m,device_z_m,device_qx,device_qy,device_qz,device_qw,\
         tool_x_m,tool_y_m,tool_z_m,tool_qx,tool_qy,tool_qz,tool_qw,\
         force_x_n,force_y_n,force_z_n,torque_x_n_m,torque_y_n_m,torque_z_n_m,\
         penetration_m,contacts,collision_ns,collision_replayed_ns,cycle_ns,late_ns\n",
    );
    for (i, (sample, replayed)) in run.samples.iter().zip(&run.replayed).enumerate() {
        let felt = &sample.felt;
        write!(csv, "{:.3}", i as f64 * f64::from(DT))?;
        for pose in [&felt.device, &felt.tool] {
            let [x, y, z] = pose.translation.to_array();
            let [i, j, k, w] = pose.rotation.to_array();
            write!(csv, ",{x:.7},{y:.7},{z:.7},{i:.6},{j:.6},{k:.6},{w:.6}")?;
        }
        let [x, y, z] = felt.wrench.force.to_array();
        let [i, j, k] = felt.wrench.torque.to_array();
        writeln!(
            csv,
            ",{x:.5},{y:.5},{z:.5},{i:.6},{j:.6},{k:.6},{:.8},{},{},{},{},{}",
            replayed.penetration,
            replayed.contacts,
            felt.collision.as_nanos(),
            replayed.collision.as_nanos(),
            sample.cycle.as_nanos(),
            sample.late.as_nanos(),
        )?;
    }
    Ok(csv)
}

fn readme(nothing: &[Sample], runs: &[Run<'_>], scheduling: &Scheduling) -> Result<String, Error> {
    let seconds = nothing.len() / 1000;
    let (cpu, cores) = (cpu(), std::thread::available_parallelism()?);
    let mut text = format!(
        "# A haptic loop of 1 kHz\n\n\
         `just haptics` made this on {cpu} ({cores} threads), the loop being scheduled {}.\n\
         Each row is {seconds} s of real time. In each cycle the contacts of the tool are found, with\n\
         force, torque and stiffness (`Query::linear_wrench`), and the virtual coupling makes a step\n\
         (`VirtualCoupling::step`); poses of the device are scripted.\n\n",
        scheduling.text(),
    );
    for run in runs.iter().step_by(2) {
        let scene = run.scene;
        writeln!(
            text,
            "* **{}**: {}. {} points, {:.0} g, {:.1e} N/m³.",
            scene.name,
            scene.about,
            scene.tool.tree.point_count(),
            1e3 * scene.coupling.tool.mass,
            scene.stiffness,
        )?;
    }
    let options = &runs[0].scene.coupling.options;
    writeln!(
        text,
        "\nSprings of {} N/m and {} N m/rad, critically damped, at most {} N and {} N m.\n\n\
         ## Deadlines\n\n\
         A cycle is missed if it ends later than the next is due, 1 ms after it was itself. The first row\n\
         is the same loop with nothing to do: what it misses, the machine does. One that wakes late makes\n\
         those behind it late as well, until it has caught up. Aim: none is missed.\n\n\
         | scene | voxelmap | cycles | missed | latest end | woken late: 99.9 % | most | \
         longest cycle | took more than 1 ms |\n|---|---|---|---|---|---|---|---|---|",
        options.stiffness, options.angular_stiffness, options.max_force, options.max_torque,
    )?;
    deadlines(&mut text, "nothing", "", nothing)?;
    for run in runs {
        deadlines(&mut text, run.scene.name, run.scene.store, &run.samples)?;
    }
    text += "\n## The collision part\n\n\
         As the loop had it, whatever else the machine did then; and the same queries asked again\n\
         afterwards, the shortest of 5 times counting, which leaves what computing takes. Aim: 99.9 % below\n\
         100 µs. The last column is force and torque alone (`Query::wrench`).\n\n\
         | scene | voxelmap | median | 99.9 % | most | asked again: median | 99.9 % | most | contacts, most | without stiffness: median |\n\
         |---|---|---|---|---|---|---|---|---|---|\n";
    for run in runs {
        let live = || run.samples.iter().map(|s| s.felt.collision);
        let again = || run.replayed.iter().map(|r| r.collision);
        let [a, b, c] = [0.5, 0.999, 1.0].map(|share| micros(percentile(live(), share)));
        let [d, e, f] = [0.5, 0.999, 1.0].map(|share| micros(percentile(again(), share)));
        let contacts = run.replayed.iter().map(|r| r.contacts).max().unwrap_or(0);
        writeln!(
            text,
            "| {} | {} | {a:.1} µs | {b:.1} µs | {c:.1} µs | {d:.1} µs | {e:.1} µs | {f:.1} µs | {contacts} | {:.1} µs |",
            run.scene.name,
            run.scene.store,
            micros(percentile(run.replayed.iter().map(|r| r.wrench), 0.5)),
        )?;
    }
    text += "\n## What is felt\n\n\
         Second by second, the largest of each; cycle by cycle in `trace_*.csv`, which are not kept in\n\
         the repository. The jump is the largest change of the force from one cycle to the next. With\n\
         dense voxelmaps; sparse ones are further down.\n\n\
         | scene | s | force | jump | torque | the tool is in the solid | contacts |\n\
         |---|---|---|---|---|---|---|\n";
    for run in runs.iter().step_by(2) {
        felt(&mut text, run)?;
    }
    text.push('\n');
    for pair in runs.chunks(2) {
        let [dense, sparse] = [0, 1].map(|i| pair[i].samples.iter().map(|s| s.felt.wrench));
        let differences = dense.zip(sparse).map(|(a, b)| a.force.distance(b.force));
        writeln!(
            text,
            "Forces on the {} with the sparse voxelmap differ from these by {:.3} N at most.",
            pair[0].scene.name,
            differences.fold(0.0, f32::max),
        )?;
    }
    Ok(text)
}

fn deadlines(text: &mut String, name: &str, store: &str, samples: &[Sample]) -> Result<(), Error> {
    let late = || samples.iter().map(|s| s.late);
    let ends = samples.iter().map(|s| s.late + s.cycle);
    writeln!(
        text,
        "| {name} | {store} | {} | {} | {:.0} µs | {:.1} µs | {:.0} µs | {:.0} µs | {} |",
        samples.len(),
        samples.iter().filter(|s| s.is_miss()).count(),
        micros(percentile(ends, 1.0)),
        micros(percentile(late(), 0.999)),
        micros(percentile(late(), 1.0)),
        micros(percentile(samples.iter().map(|s| s.cycle), 1.0)),
        samples.iter().filter(|s| s.cycle > PERIOD).count(),
    )?;
    Ok(())
}

fn felt(text: &mut String, run: &Run<'_>) -> Result<(), Error> {
    let force = |i: usize| run.samples[i].felt.wrench.force;
    let cycles: Vec<usize> = (0..run.samples.len()).collect();
    for (second, cycles) in cycles.chunks(1000).enumerate() {
        let largest = |of: &dyn Fn(usize) -> f32| cycles.iter().map(|&i| of(i)).fold(0.0, f32::max);
        let jump = |i: usize| force(i).distance(force(i.saturating_sub(1)));
        writeln!(
            text,
            "| {} | {second} | {:.2} N | {:.2} N | {:.3} N m | {:.3} mm | {} |",
            run.scene.name,
            largest(&|i| force(i).length()),
            largest(&jump),
            largest(&|i| run.samples[i].felt.wrench.torque.length()),
            1e3 * largest(&|i| run.replayed[i].penetration),
            largest(&|i| run.replayed[i].contacts as f32),
        )?;
    }
    Ok(())
}

fn cpu() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = info
        .lines()
        .find_map(|line| line.strip_prefix("model name"));
    let name = name.map(|n| n.trim_start_matches([' ', '\t', ':']));
    name.map_or_else(|| "an unknown processor".into(), |n| format!("\"{n}\""))
}
