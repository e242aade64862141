//! Powers of two: multiplication by them is exact.

/// 2^exponent, for an exponent between -1022 and 1023.
#[inline]
pub const fn power_of_two(exponent: i64) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}

/// The power of two that scales a normal number into [1, 2).
#[inline]
pub fn power_of_two_reciprocal(length: f64) -> f64 {
    f64::from_bits((2046 << 52) - (length.to_bits() & (0x7ff << 52)))
}
