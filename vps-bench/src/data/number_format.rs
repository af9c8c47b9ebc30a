//! Numbers as text.

/// Digits in groups of three.
pub(crate) fn group_digits(digits: &str) -> String {
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

/// Three significant digits; a dash if there is no finite number.
pub(crate) fn significant(value: impl Into<Option<f64>>) -> String {
    match value.into() {
        // Below the last digit that would be written.
        Some(value) if value.abs() < 5e-10 => "0".into(),
        Some(value) if value.is_finite() => {
            let magnitude = value.abs().max(1e-12).log10().floor() as i32;
            let digits = (2 - magnitude).clamp(0, 9) as usize;
            format!("{value:.digits$}")
        }
        _ => "–".into(),
    }
}

/// A fixed number of digits after the point; a dash if there is no finite number.
pub(crate) fn fixed(value: impl Into<Option<f64>>, digits: usize) -> String {
    match value.into() {
        Some(value) if value.is_finite() => format!("{value:.digits$}"),
        _ => "–".into(),
    }
}
