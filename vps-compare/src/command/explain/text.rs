//! The story as text, for people.

use std::fmt::Write;

use super::event_row::EventRow;
use super::names::{KEPT, meaning};
use super::story::{ShellStory, Story};

pub(super) fn text(story: &Story, events: &[EventRow]) -> String {
    let mut text = String::new();
    let _ = writeln!(text, "A: {}\nB: {}", story.mesh_a, story.mesh_b);
    let [x, y, z, qx, qy, qz, qw] = story.pose;
    let _ = writeln!(
        text,
        "pose {} of {}: B at ({x}, {y}, {z}) m, turned by ({qx}, {qy}, {qz}, {qw}); \
         prediction {:.3e} m",
        story.row, story.poses_file, story.prediction_m,
    );
    for shell in &story.shells {
        write_counts(&mut text, shell);
    }
    let _ = writeln!(text, "\n{} events", events.len());
    for event in events {
        write_event(&mut text, event);
    }
    let _ = writeln!(text, "\n{} contacts remain", story.contacts.len());
    for contact in &story.contacts {
        let ([x, y, z], [nx, ny, nz]) = (contact.position_m, contact.normal);
        let point = contact
            .point
            .map_or(String::new(), |p| format!(" point {p}"));
        let turned = contact.normal_turned.map_or(String::new(), |reason| {
            format!(", turned from that of the field: {reason}")
        });
        let _ = writeln!(
            text,
            "{}{point}: penetration {:.3e} m at ({x:.6}, {y:.6}, {z:.6}) m, normal out of A \
             ({nx:.4}, {ny:.4}, {nz:.4}){turned}",
            contact.shell, contact.penetration_m,
        );
    }
    for shell in &story.shells {
        let _ = writeln!(text, "\nother points of {}", shell.shell);
        for (outcome, count) in shell
            .outcomes
            .iter()
            .filter(|(outcome, _)| **outcome != KEPT)
        {
            let _ = writeln!(text, "{count:>8}  {outcome}: {}", meaning(outcome));
        }
    }
    text
}

fn write_counts(text: &mut String, shell: &ShellStory) {
    let _ = writeln!(
        text,
        "\nshell of {}: {} searches, {} of {} points tested, {} tests\n\
         level  clusters  bounded   pruned  descended",
        shell.shell, shell.searches, shell.points_tested, shell.points, shell.tests,
    );
    for level in &shell.levels {
        let _ = writeln!(
            text,
            "{:>5}  {:>8}  {:>7}  {:>7}  {:>9}",
            level.level, level.clusters, level.bounded, level.pruned, level.descended,
        );
    }
}

/// The values an event has, after its name.
fn write_event(text: &mut String, event: &EventRow) {
    let _ = write!(text, "{}", event.shell);
    if let Some(search) = event.search {
        let _ = write!(text, " search {search}");
    }
    let _ = write!(text, " {}", event.event);
    let integers = [
        ("level", event.level),
        ("cluster", event.cluster),
        ("point", event.point),
    ];
    for (name, value) in integers {
        if let Some(value) = value {
            let _ = write!(text, " {name} {value}");
        }
    }
    let numbers = [
        ("bound", event.bound),
        ("penetration", event.penetration_m),
        ("threshold", event.threshold),
    ];
    for (name, value) in numbers {
        if let Some(value) = value {
            let _ = write!(text, " {name} {value:.3e}");
        }
    }
    let _ = writeln!(text, " {}", event.reason);
    text.truncate(text.trim_end().len());
    text.push('\n');
}
