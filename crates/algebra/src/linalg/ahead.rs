//! Numbers of a factor are asked for before they are read. Columns are short: where each begins the processor has not yet
//! seen that numbers are read in order, and a pass that waits there reads memory at a third of its rate.

use std::ops::Range;

use super::cholesky::Real;

/// So many numbers lie between those in use and those that are asked for. Half and twice as many do as well: memory needs
/// some microseconds, and what has come is not to leave the innermost cache, of 32 KiB or more, before it is read.
const AHEAD: usize = 4096;
/// Bytes that come at once.
const LINE: usize = 64;

/// Before `used` is read by a pass that ascends.
#[inline(always)]
pub(crate) fn prefetch_behind<T: Real>(values: &[T], used: Range<usize>) {
    ask(&values[behind(used, values.len())]);
}

/// Before `used` is read by a pass that descends.
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

    /// Both passes ask for each number once and before they use it, but for the first ones.
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
