//! Numbers as options of a command line: in range, or a sentence of what to write.

/// A number that passes a test; `what` says which ones do.
///
/// # Errors
/// The sentence `write a number {what}`.
pub fn number(text: &str, is_right: fn(f64) -> bool, what: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number| is_right(*number));
    number.ok_or_else(|| format!("write a number {what}"))
}

/// A share, 0 to 1.
///
/// # Errors
/// What to write instead.
pub fn share(text: &str) -> Result<f64, String> {
    number(text, |n| (0.0..=1.0).contains(&n), "from 0 to 1")
}

/// A finite number, 0 or more.
///
/// # Errors
/// What to write instead.
pub fn from_zero(text: &str) -> Result<f64, String> {
    number(text, |n| n.is_finite() && n >= 0.0, "from 0 upwards")
}

/// A finite number above 0.
///
/// # Errors
/// What to write instead.
pub fn above_zero(text: &str) -> Result<f64, String> {
    number(text, |n| n.is_finite() && n > 0.0, "above 0")
}
