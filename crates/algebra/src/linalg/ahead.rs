//! Prefetching of factors. Columns are short: at each beginning the processor has not yet recognised sequential access,
//! and a pass that waits there runs at a third of the memory rate.

use std::ops::Range;

use super::cholesky::Real;

/// Prefetch distance in numbers; insensitive to a factor of two. Memory latency is some microseconds, and prefetched
/// data must fit in the innermost cache, 32 KiB or more.
const AHEAD: usize = 4096;
/// Bytes of a cache line.
const LINE: usize = 64;

/// For an ascending pass, before `used` is read.
#[inline(always)]
pub(crate) fn prefetch_behind<T: Real>(values: &[T], used: Range<usize>) {
    ask(&values[behind(used, values.len())]);
}

/// For a descending pass, before `used` is read.
#[inline(always)]
pub(crate) fn prefetch_before<T: Real>(values: &[T], used: Range<usize>) {
    ask(&values[before(used)]);
}

#[inline(always)]
fn behind(used: Range<usize>, end: usize) -> Range<usize> {
    (used.start + AHEAD).min(end)..(used.end + AHEAD).min(end)
}

#[inline(always)]
fn before(used: Range<usize>) -> Range<usize> {
    used.start.saturating_sub(AHEAD)..used.end.saturating_sub(AHEAD)
}

#[inline(always)]
fn ask<T: Real>(values: &[T]) {
    for line in values.chunks(LINE / size_of::<T>()) {
        branches::prefetch_read_data::<T, 0>(line.as_ptr());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Except for the first ones, each number is prefetched once and before use.
    #[test]
    fn every_number_is_asked_for_once() {
        let blocks = [0..7, 7..1000, 1000..1004, 1004..9000, 9000..9001, 9001..20_000];
        let end = 20_000;
        let mut next = AHEAD;
        for used in blocks.clone() {
            let asked = behind(used.clone(), end);
            assert!(asked.start == next && asked.start >= used.start);
            next = asked.end;
        }
        assert_eq!(next, end);
        let mut next = end - AHEAD;
        for used in blocks.into_iter().rev() {
            let asked = before(used.clone());
            assert!(asked.end == next && asked.end <= used.end);
            next = asked.start;
        }
        assert_eq!(next, 0);
    }
}
