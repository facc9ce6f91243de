//! Asking for memory before it is needed.
//!
//! A step visits hundreds of places scattered over tens of megabytes, all known
//! beforehand; waiting for one after the other is most of what it would do.

use super::switches::{Mechanism, is_on};

/// Asks for the cache line of `slice[index]`; does nothing where there is no
/// such element or the processor is not known.
#[inline(always)]
pub(super) fn prefetch<T>(slice: &[T], index: usize) {
    #[cfg(target_arch = "x86_64")]
    if is_on(Mechanism::Prefetch)
        && let Some(element) = slice.get(index)
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: a prefetch of a valid reference reads nothing and faults never.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(std::ptr::from_ref(element).cast()) };
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (slice, index);
}

/// Asks for all cache lines of `slice[start..start + len]`.
#[inline(always)]
pub(super) fn prefetch_range<T>(slice: &[T], start: usize, len: usize) {
    let per_line = (64 / size_of::<T>()).max(1);
    for k in (0..len).step_by(per_line) {
        prefetch(slice, start + k);
    }
    prefetch(slice, (start + len).saturating_sub(1));
}
