//! rayon, and in WebAssembly the same names on one thread.
//!
//! A WebAssembly module has no threads. rayon runs there too, on the thread that calls it, but each
//! of its loops is compiled with the code that divides it among threads.
//!
//! # Example
//! ```
//! use magsplice_parallel::prelude::*;
//!
//! let squares: Vec<i32> = [1, 2, 3].par_iter().map(|n| n * n).collect();
//! assert_eq!(squares, [1, 4, 9]);
//! ```

#[cfg(not(target_family = "wasm"))]
pub use rayon::*;

#[cfg(target_family = "wasm")]
pub use one_thread::*;

/// The names of rayon that the crates of magsplice use.
#[cfg(any(target_family = "wasm", test))]
pub mod one_thread;
