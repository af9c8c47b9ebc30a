//! The comparison as text, for people.

use std::fmt::Write;

use super::comparison::{AlgorithmSummary, Comparison, MeshSummary};

const HEADER: [&str; 10] = [
    "algorithm",
    "size A / B",
    "prepare_s",
    "memory_KiB",
    "median_us",
    "p99_us",
    "contacts",
    "error_median_m",
    "error_max_m",
    "wrong",
];

pub(super) fn text(comparison: &Comparison) -> String {
    let mut text = String::new();
    for (name, mesh) in [("A", &comparison.mesh_a), ("B", &comparison.mesh_b)] {
        let _ = writeln!(text, "{name}: {}", of_mesh(mesh));
    }
    let _ = writeln!(
        text,
        "{} poses, {} overlapping, {} apart; prediction {:.3e} m, tolerance {:.3e} m\n",
        comparison.poses,
        comparison.overlapping,
        comparison.apart,
        comparison.prediction_m,
        comparison.tolerance_m,
    );
    if let Some(why) = &comparison.inexact {
        let _ = writeln!(
            text,
            "The exact penetration is known at {} of {} poses: {why}. Errors and wrong answers are \
             counted where it is known\n",
            comparison.exact, comparison.poses,
        );
    }
    let rows: Vec<_> = comparison.algorithms.iter().map(cells).collect();
    let widths: Vec<usize> = (0..HEADER.len())
        .map(|c| {
            let cells = rows.iter().map(|row| row[c].chars().count());
            cells.fold(HEADER[c].len(), usize::max)
        })
        .collect();
    let mut line = |cells: &[String]| {
        for (c, (cell, width)) in cells.iter().zip(&widths).enumerate() {
            // Names to the left, numbers to the right.
            let _ = if c < 2 {
                write!(text, "{cell:<width$}  ")
            } else {
                write!(text, "{cell:>width$}  ")
            };
        }
        text.truncate(text.trim_end().len());
        text.push('\n');
    };
    line(&HEADER.map(str::to_owned));
    for row in &rows {
        line(row);
    }
    for algorithm in comparison.algorithms.iter().filter(|a| a.status != "ok") {
        let AlgorithmSummary {
            algorithm: name,
            answered,
            status,
            ..
        } = algorithm;
        let _ = writeln!(
            text,
            "{name}: {answered} of {} answered: {status}",
            comparison.poses
        );
    }
    let uncertain = comparison
        .exact_uncertainty_m
        .map_or_else(String::new, |most| {
            format!("; the exact one is uncertain by up to {most:.1e} m")
        });
    let _ = writeln!(
        text,
        "\nerror: deepest contact against the exact penetration, where there is a contact{uncertain}\n\
         wrong: overlaps missed + false touches; \
         ~: memory as counted by parry, or estimated from the elements of its shapes",
    );
    text
}

fn of_mesh(mesh: &MeshSummary) -> String {
    let [x, y, z] = mesh.extents_m.map(|extent| {
        if (0.001..1e5).contains(&extent) {
            format!("{extent:.4}")
        } else {
            format!("{extent:.3e}")
        }
    });
    let repaired = if mesh.watertight {
        ""
    } else if mesh.open {
        ", open: nothing is exact"
    } else {
        ", not watertight: exact values are those of the repaired mesh"
    };
    format!(
        "{}, {} triangles, {x} x {y} x {z} m{repaired}",
        mesh.file, mesh.triangles
    )
}

fn cells(algorithm: &AlgorithmSummary) -> [String; 10] {
    let number = |value: Option<f64>, decimals: usize| {
        value.map_or_else(|| "–".into(), |v| format!("{v:.decimals$}"))
    };
    let metres = |value: Option<f64>| value.map_or_else(|| "–".into(), |v| format!("{v:.1e}"));
    let is_estimate = algorithm.memory_is_estimate == Some(true);
    let memory = algorithm.memory_bytes.map_or_else(
        || "–".into(),
        |bytes| {
            let about = if is_estimate { "~" } else { "" };
            format!("{about}{}", bytes.div_ceil(1024))
        },
    );
    let size = match (algorithm.size_a.first(), algorithm.size_b.first()) {
        (Some((what, a)), Some((_, b))) => format!("{a} / {b} {what}"),
        _ => "–".into(),
    };
    let AlgorithmSummary {
        answered,
        judged,
        missed,
        false_touches,
        ..
    } = algorithm;
    let wrong = match judged {
        0 => "–".into(),
        _ if judged == answered => format!("{missed} + {false_touches}"),
        _ => format!("{missed} + {false_touches} of {judged}"),
    };
    [
        algorithm.algorithm.clone(),
        size,
        format!("{:.2}", algorithm.prepare_s),
        memory,
        number(algorithm.query_median_ns.map(|ns| ns / 1000.0), 1),
        number(algorithm.query_p99_ns.map(|ns| ns / 1000.0), 1),
        number(algorithm.contacts_mean, 1),
        metres(algorithm.error_median_m),
        metres(algorithm.error_max_m),
        wrong,
    ]
}
