//! Bytes in words.

/// Bytes as lower-case hexadecimal digits, two each: how hashes are told.
pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
