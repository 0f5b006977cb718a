//! QR decomposition, singular values and symmetric eigenproblem: our own against faer's, on the
//! sizes that arms and closed chains have. Time (the best of 30 rounds), allocations of a call, and
//! accuracy against the Jacobi decomposition.
//!
//! ```text
//! cargo run --release --manifest-path benches/peers/rust/Cargo.toml \
//!     --features cylindroid,faer --bin linear_algebra
//! ```

use std::alloc::{GlobalAlloc, Layout, System};
use std::hint::black_box;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::time::Instant;

use cylindroid::linalg::{ColumnSpace, Matrix, Qr, Svd, SymmetricEigen, Threshold};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::evd;
use faer::linalg::qr::col_pivoting::factor;
use faer::{Mat, Par, Side};

/// Counts allocations.
struct Counting;

static ALLOCATIONS: AtomicUsize = AtomicUsize::new(0);

// SAFETY: all calls are passed on to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Relaxed);
        // SAFETY: as above.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, place: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(place, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Random numbers in [-1, 1).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as f64 / f64::from(1_u32 << 30) - 1.0
    }
}

fn time<T>(name: &str, mut f: impl FnMut() -> T) {
    for _ in 0..50 {
        black_box(f());
    }
    let before = ALLOCATIONS.load(Relaxed);
    black_box(f());
    let allocations = ALLOCATIONS.load(Relaxed) - before;
    let round = || {
        let start = Instant::now();
        for _ in 0..100 {
            black_box(f());
        }
        start.elapsed().as_secs_f64() / 100.0
    };
    let best = std::iter::repeat_with(round).take(30).fold(f64::INFINITY, f64::min);
    println!("  {name:44} {:8.2} us {allocations:3} allocations", best * 1e6);
}

fn general(m: usize, n: usize, random: &mut Random) {
    let own = Matrix::from_fn(m, n, |_, _| random.next());
    let peer = Mat::from_fn(m, n, |i, j| own[(i, j)]);
    println!("{m} x {n}");
    time("pivoted QR, own", || Qr::pivoted(own.clone()));
    time("pivoted QR, faer", || peer.col_piv_qr());
    let (mut a, mut h) = (peer.clone(), Mat::<f64>::zeros(1, m.min(n)));
    let (mut order, mut inverse) = (vec![0_usize; n], vec![0_usize; n]);
    let need = factor::qr_in_place_scratch::<usize, f64>(m, n, 1, Par::Seq, Default::default());
    let mut memory = MemBuffer::new(need);
    time("pivoted QR, faer in place", || {
        a.copy_from(&peer);
        let stack = MemStack::new(&mut memory);
        let (a, h) = (a.as_mut(), h.as_mut());
        factor::qr_in_place(a, h, &mut order, &mut inverse, Par::Seq, stack, Default::default());
    });
    let threshold = Threshold::Relative(1e-9);
    time("rank (QR and singular values), own", || ColumnSpace::of(&own, threshold).rank());
    time("rank (QR and singular values), faer", || {
        peer.col_piv_qr().thin_R().singular_values().map(|values| values.len())
    });
}

fn symmetric<const N: usize>(random: &mut Random) {
    let mut a = [[0.0; N]; N];
    for i in 0..N {
        for j in i..N {
            a[i][j] = random.next();
            a[j][i] = a[i][j];
        }
    }
    let peer = Mat::from_fn(N, N, |i, j| a[i][j]);
    println!("symmetric {N} x {N}");
    time("eigenproblem, own", || SymmetricEigen::of(a, N).values);
    time("eigenproblem, faer", || peer.self_adjoint_eigen(Side::Lower).map(|e| e.S()[0]));
    let (mut values, mut vectors) = (Mat::<f64>::zeros(N, 1), Mat::<f64>::zeros(N, N));
    let vectors_too = evd::ComputeEigenvectors::Yes;
    let need = evd::self_adjoint_evd_scratch::<f64>(N, vectors_too, Par::Seq, Default::default());
    let mut memory = MemBuffer::new(need);
    time("eigenproblem, faer in place", || {
        let (s, u) = (values.col_mut(0).as_diagonal_mut(), Some(vectors.as_mut()));
        let stack = MemStack::new(&mut memory);
        evd::self_adjoint_evd(peer.as_ref(), s, u, Par::Seq, stack, Default::default()).is_ok()
    });
}

/// Bidiagonal matrices of the tests of singular_values.rs: spread, one cluster, two, graded.
fn accuracy(random: &mut Random) {
    let (mut own_worst, mut peer_worst) = (0.0_f64, 0.0_f64);
    for round in 0..8000_usize {
        let n = 1 + round % 21;
        let width = 10_f64.powi(-((round / 84 % 17) as i32));
        let d: Vec<f64> = (0..n)
            .map(|i| match round / 21 % 4 {
                0 => random.next(),
                1 => 0.7 * (1.0 + width * random.next()),
                2 => (1 + i % 2) as f64 * (1.0 + width * random.next()),
                _ => 10_f64.powf(8.0 * random.next() - 8.0),
            })
            .collect();
        let graded = round / 21 % 4 == 3;
        let above: Vec<f64> =
            d.iter().skip(1).map(|d| random.next() * if graded { *d } else { width }).collect();
        let b = Matrix::from_fn(n, n, |i, j| match j.checked_sub(i) {
            Some(0) => d[i],
            Some(1) => above[i],
            _ => 0.0,
        });
        let expected = Svd::of(&b);
        let own = ColumnSpace::of(&b, Threshold::Relative(0.0));
        let peer = Mat::from_fn(n, n, |i, j| b[(i, j)]).singular_values().unwrap_or_default();
        let error = |values: &[f64]| {
            let errors = values.iter().zip(expected.values()).map(|(a, b)| (a - b).abs());
            errors.fold(0.0, f64::max) / expected.value(0)
        };
        own_worst = own_worst.max(error(own.values()));
        peer_worst = peer_worst.max(if peer.is_empty() { f64::INFINITY } else { error(&peer) });
    }
    println!(
        "worst error of singular values over the largest: own {own_worst:.1e}, faer {peer_worst:.1e}"
    );
    let huge = Mat::from_fn(4, 4, |i, j| if i == j { 1e200 } else { 1e180 });
    println!("entries of 1e200: faer {:?}", huge.singular_values());
    let huge = Matrix::from_fn(4, 4, |i, j| if i == j { 1e200 } else { 1e180 });
    println!(
        "entries of 1e200: own {:?}",
        ColumnSpace::of(&huge, Threshold::Relative(1e-9)).values()
    );
}

fn main() {
    faer::set_global_parallelism(Par::Seq);
    let mut random = Random(3);
    for (m, n) in [(6, 7), (18, 18), (24, 18), (36, 30), (60, 60)] {
        general(m, n, &mut random);
    }
    symmetric::<3>(&mut random);
    symmetric::<6>(&mut random);
    accuracy(&mut random);
}
