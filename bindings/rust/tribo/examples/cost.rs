//! What a call costs in Rust: see cost.c beside the bindings. Prints a line of the table.

use std::hint::black_box;
use std::time::Instant;
use tribo::{batch_solve, solve, Isa};

const COUNT: usize = 10_000;

fn main() {
    let mut state = 1_u64;
    let mut unit = || {
        state = state.wrapping_add(0x9e3779b97f4a7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58476d1ce4e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d049bb133111eb);
        z ^= z >> 31;
        (z >> 11) as f64 / 9007199254740992.0
    };
    let (mut w, mut b, mut mu) = (vec![], vec![], vec![]);
    for _ in 0..COUNT {
        w.push(std::array::from_fn(|i| {
            let side = 2.0 * unit() - 1.0;
            if matches!(i, 0 | 3 | 5) { 2.0 + side } else { 0.5 * side }
        }));
        b.push(std::array::from_fn(|_| 2.0 * unit() - 1.0));
        let mu_s = 2.0 * unit();
        mu.push([mu_s, unit() * mu_s]);
        unit();
    }
    let (mut p, mut modes) = (vec![[0.0; 3]; COUNT], vec![0; COUNT]);
    let (mut single, mut batch) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..50 {
        let start = Instant::now();
        for k in 0..COUNT {
            p[k] = black_box(solve(&w[k], &b[k], mu[k][0], mu[k][1])).unwrap_or_default();
        }
        single = single.min(start.elapsed().as_nanos() as f64 / COUNT as f64);
        let start = Instant::now();
        batch_solve(Isa::Best, &w, &b, &mu, &mut p, Some(&mut modes), None).expect("a batch");
        batch = batch.min(start.elapsed().as_nanos() as f64 / COUNT as f64);
    }
    println!("Rust\t{single:.1}\t{batch:.1}");
}
