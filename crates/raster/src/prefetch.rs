//! Asking for memory before it is needed.
//!
//! A step of the greedy loop visits hundreds of places scattered over tens of megabytes, all
//! known beforehand; waiting for one after the other is most of what it would do.

/// What the ablation bench can switch off, for the whole process.
#[cfg(feature = "ablation")]
pub mod switches {
    use std::sync::atomic::AtomicBool;

    /// Nothing is asked for ahead anywhere.
    pub static IS_OFF: AtomicBool = AtomicBool::new(false);
    /// The lists of the A-buffer are not asked for ahead.
    pub static IS_OFF_FOR_LISTS: AtomicBool = AtomicBool::new(false);
}

#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn is_on() -> bool {
    #[cfg(feature = "ablation")]
    return !switches::IS_OFF.load(std::sync::atomic::Ordering::Relaxed);
    #[cfg(not(feature = "ablation"))]
    true
}

/// Whether the lists of the A-buffer are asked for ahead.
#[inline(always)]
pub(crate) fn is_on_for_lists() -> bool {
    #[cfg(feature = "ablation")]
    return !switches::IS_OFF_FOR_LISTS.load(std::sync::atomic::Ordering::Relaxed);
    #[cfg(not(feature = "ablation"))]
    true
}

/// Asks for the cache line of `slice[index]`; does nothing where there is no
/// such element or the processor is not known.
#[inline(always)]
pub fn prefetch<T>(slice: &[T], index: usize) {
    #[cfg(target_arch = "x86_64")]
    if is_on()
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
pub fn prefetch_range<T>(slice: &[T], start: usize, len: usize) {
    let per_line = (64 / size_of::<T>()).max(1);
    for k in (0..len).step_by(per_line) {
        prefetch(slice, start + k);
    }
    prefetch(slice, (start + len).saturating_sub(1));
}
