//! Checks of values in settings; errors name the key.

/// Checks that a value is positive and finite.
pub(crate) fn positive(key: &str, value: f64) -> Result<(), String> {
    if value > 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err(format!("{key} must be positive, not {value}"))
    }
}

/// Checks that a value is zero or positive, and finite.
pub(crate) fn not_negative(key: &str, value: f64) -> Result<(), String> {
    if value >= 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err(format!("{key} must not be negative, but is {value}"))
    }
}
