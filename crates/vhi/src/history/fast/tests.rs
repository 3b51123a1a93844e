//! Interpolated sums against direct ones.

use super::super::{Memory, Trapezoid};
use super::*;
use crate::law::Summed;

struct By(fn(f64) -> f64);
impl MemoryKernel for By {
    fn value(&self, lag: f64) -> f64 {
        self.0(lag)
    }
}

/// Largest difference to the direct sum over the largest sum; `fast` uses `interpolated`, the direct sum `kernel`.
fn difference(fast: &mut FastConvolution, interpolated: &By, kernel: &By, grid: &TimeGrid) -> f64 {
    let mut direct = Memory::direct();
    let (mut a, mut b, mut worst, mut size) = ([0.0; 2], [0.0; 2], 0f64, 0f64);
    for n in 0..=grid.steps() {
        direct.past(kernel, &Trapezoid, grid, &mut a);
        fast.past(interpolated, grid, &mut b);
        for i in 0..2 {
            worst = larger(worst, (a[i] - b[i]).abs());
            size = size.max(a[i].abs());
        }
        let t = grid.time(n);
        let u = [(7.0 * t).sin() + 0.2, t * t - 0.3];
        direct.commit(grid, &u);
        fast.commit(grid, &u);
    }
    worst / size
}

const KERNELS: [By; 4] = [
    By(|lag| -1.0 / (1.0 + lag / 0.1).powf(1.5)),
    By(|lag| lag.sqrt()),
    By(|lag| (-20.0 * lag).exp()),
    By(|lag| (9.0 * lag).cos()),
];

#[test]
fn interpolated_sums_are_the_direct_ones_on_any_grid() {
    for kernel in &KERNELS {
        for grid in [
            TimeGrid::uniform(1.0, 1000),
            TimeGrid::graded(2.0, 700, 2.0),
            TimeGrid::random(1.0, 531, 3),
            TimeGrid::uniform(1.0, 768),
            TimeGrid::uniform(1.0, 30),
        ] {
            let mut fast = FastConvolution::new(kernel, &grid, 2, 1e-13).expect("smooth kernels");
            assert!(fast.error <= 1e-13);
            // The error of the kernel, and rounding of a thousand terms.
            let off = difference(&mut fast, kernel, kernel, &grid);
            assert!(off < 1e-12, "{off} N = {}", grid.steps());
        }
    }
}

/// The measured error bounds that of the sums, even with too few nodes.
#[test]
fn the_stated_error_is_that_of_the_sums() {
    let (kernel, grid) = (&KERNELS[1], TimeGrid::uniform(1.0, 1200));
    let mut coarse = FastConvolution::with_nodes(6, &grid, 0);
    let stated = coarse.largest_error(kernel, &grid);
    let mut coarse = FastConvolution::with_nodes(6, &grid, 2);
    let off = difference(&mut coarse, kernel, kernel, &grid);
    // Errors of either sign add up to less than the largest, which may lie between the check points.
    assert!(off < 2.0 * stated && off > 1e-3 * stated, "{off} {stated}");
    assert!(stated > 1e-8);
}

#[test]
fn steps_are_counted_as_they_are_committed() {
    let grid = TimeGrid::uniform(1.0, 100);
    let mut fast = FastConvolution::new(&KERNELS[2], &grid, 1, 1e-13).expect("a smooth kernel");
    for n in 0..5 {
        assert_eq!(fast.committed(), n);
        fast.past(&KERNELS[2], &grid, &mut [0.0]);
        fast.commit(&grid, &[1.0]);
    }
}

/// The error is relative to the kernel: unchanged for a thousand times the kernel, zero for none.
#[test]
fn the_stated_error_has_no_unit() {
    let grid = TimeGrid::uniform(1.0, 1000);
    let stated =
        |kernel: By| FastConvolution::with_nodes(6, &grid, 1).largest_error(&kernel, &grid);
    let once = stated(By(|lag| 1.0 / (1.0 + lag / 0.1)));
    let thousand = stated(By(|lag| 1e3 / (1.0 + lag / 0.1)));
    // Roundings of values of order one, against an error of 1e-8 and more.
    assert!(once > 1e-9 && (thousand - once).abs() < 1e-14, "{once} {thousand}");
    assert_eq!(stated(By(|_| 0.0)), 0.0);
}

/// A looser tolerance takes fewer nodes and has a real error, within what is stated and allowed.
#[test]
fn looser_sums_are_as_loose_as_they_say_and_cheaper() {
    let grid = TimeGrid::uniform(1.0, 1000);
    for (i, kernel) in KERNELS.iter().enumerate() {
        let mut held = usize::MAX;
        for tolerance in [1e-13, 1e-9, 1e-6, 1e-3] {
            let mut fast = FastConvolution::new(kernel, &grid, 2, tolerance).expect("smooth");
            assert!(fast.error <= tolerance && fast.pays());
            assert!(fast.numbers() <= held, "kernel {i}, {tolerance:e}");
            held = fast.numbers();
            let stated = fast.error;
            // The largest sum has the largest kernel value times a part of the grid: a fifth for the fastest of them.
            let off = difference(&mut fast, kernel, kernel, &grid);
            assert!(off <= 20.0 * stated + 1e-12, "kernel {i}, {tolerance:e}: {off:e}");
            // Some kernels are much better than 1e-9 with the nodes that this asks for.
            assert!(tolerance < 1e-8 || off > 1e-13, "kernel {i}, {tolerance:e}: {off:e}");
        }
        // Two numbers a vector.
        assert!(held < 2 * FastConvolution::vectors(1000, 16));
    }
}

/// The kernel's tolerance decides; without one the sum is direct, however long the grid.
#[test]
fn a_kernel_says_how_its_past_is_summed() {
    let summed = |interpolated_to, steps| {
        let kernel = Summed { kernel: Box::new(By(|lag| lag.sqrt())), interpolated_to };
        let grid = TimeGrid::uniform(1.0, steps);
        match Memory::new(&kernel, &Trapezoid, &grid, 1) {
            Memory::Fast(fast) => Some(fast.nodes),
            _ => None,
        }
    };
    assert_eq!(summed(None, 2000), None);
    assert!(summed(Some(1e-3), 2000) < summed(Some(1e-13), 2000));
    let from = FastConvolution::least_steps(1e-3) as u32;
    assert_eq!(summed(Some(1e-3), from - 1), None);
    assert!(summed(Some(1e-3), 2 * from).is_some());
    assert_eq!(summed(Some(1e-13), 300), None);
}

/// A kernel with a kink away from lag zero stays with the direct sum.
#[test]
fn kernels_that_are_not_smooth_are_refused() {
    let kink = By(|lag| (lag - 0.37).abs());
    let grid = TimeGrid::uniform(1.0, 1000);
    assert!(FastConvolution::new(&kink, &grid, 1, 1e-13).is_none());
    assert!(matches!(Memory::new(&kink, &Trapezoid, &grid, 1), Memory::Direct { .. }));
    let nan = By(|lag| if lag > 0.5 { f64::NAN } else { 1.0 });
    assert!(FastConvolution::new(&nan, &grid, 1, 1e-13).is_none());
    assert!(matches!(Memory::new(&KERNELS[0], &Trapezoid, &grid, 1), Memory::Fast(_)));
}

/// The comparison above detects a kernel that is off by 1e-9.
#[test]
fn a_wrong_kernel_is_seen() {
    let wrong = By(|lag| lag.sqrt() * (1.0 + 1e-9));
    let grid = TimeGrid::uniform(1.0, 1000);
    let mut fast = FastConvolution::new(&wrong, &grid, 2, 1e-13).expect("a smooth kernel");
    assert!(difference(&mut fast, &wrong, &KERNELS[1], &grid) > 1e-10);
}

#[test]
fn memory_grows_with_the_logarithm_of_the_steps() {
    let bytes = |steps: u32| {
        let grid = TimeGrid::uniform(1.0, steps);
        FastConvolution::with_nodes(16, &grid, 3).numbers() / 3
    };
    assert_eq!([1024, 4096, 16384].map(bytes), [464, 624, 784]);
    assert_eq!(FastConvolution::vectors(4096, 16), 624);
    // 64 smallest clusters of 32 levels: five sizes have more than three, of five vectors per node; 64 of the
    // neighbours.
    let grid = TimeGrid::uniform(1.0, 2016);
    assert_eq!(FastConvolution::with_nodes(16, &grid, 3).numbers() / 3, 5 * 5 * 16 + 64);
    assert_eq!(FastConvolution::vectors(2016, 16), 5 * 5 * 16 + 64);
}
