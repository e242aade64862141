//! Loops on the thread that calls them, under the names of rayon.

use std::error::Error;
use std::fmt::{self, Display, Formatter};
use std::iter::Sum;
use std::slice::{Chunks, ChunksMut, Iter, IterMut};

/// The traits whose methods begin a loop.
pub mod prelude {
    pub use super::{IntoParallelIterator, ParallelExtend, ParallelSlice, ParallelSliceMut};
}

/// The number of threads.
pub fn current_num_threads() -> usize {
    1
}

/// A loop over the items of an iterator.
#[derive(Clone, Debug)]
pub struct OneThread<I>(I);

impl<I: Iterator> IntoIterator for OneThread<I> {
    type Item = I::Item;
    type IntoIter = I;

    fn into_iter(self) -> I {
        self.0
    }
}

#[expect(missing_docs, reason = "the names and the order of the results are those of rayon")]
impl<I: Iterator> OneThread<I> {
    pub fn collect<C: FromIterator<I::Item>>(self) -> C {
        self.0.collect()
    }

    pub fn copied<'a, T: Copy + 'a>(self) -> OneThread<impl Iterator<Item = T>>
    where
        I: Iterator<Item = &'a T>,
    {
        OneThread(self.0.copied())
    }

    pub fn enumerate(self) -> OneThread<impl Iterator<Item = (usize, I::Item)>> {
        OneThread(self.0.enumerate())
    }

    pub fn filter_map<T>(self, f: impl FnMut(I::Item) -> Option<T>) -> OneThread<impl Iterator<Item = T>> {
        OneThread(self.0.filter_map(f))
    }

    pub fn flat_map_iter<T: IntoIterator>(
        self,
        f: impl FnMut(I::Item) -> T,
    ) -> OneThread<impl Iterator<Item = T::Item>> {
        OneThread(self.0.flat_map(f))
    }

    pub fn flatten(self) -> OneThread<impl Iterator<Item = <I::Item as IntoIterator>::Item>>
    where
        I::Item: IntoIterator,
    {
        OneThread(self.0.flatten())
    }

    pub fn for_each(self, f: impl FnMut(I::Item)) {
        self.0.for_each(f);
    }

    pub fn map<T>(self, f: impl FnMut(I::Item) -> T) -> OneThread<impl Iterator<Item = T>> {
        OneThread(self.0.map(f))
    }

    pub fn map_init<S, T>(
        self,
        init: impl FnOnce() -> S,
        mut f: impl FnMut(&mut S, I::Item) -> T,
    ) -> OneThread<impl Iterator<Item = T>> {
        let mut state = init();
        OneThread(self.0.map(move |item| f(&mut state, item)))
    }

    pub fn reduce(self, identity: impl FnOnce() -> I::Item, f: impl FnMut(I::Item, I::Item) -> I::Item) -> I::Item {
        self.0.reduce(f).unwrap_or_else(identity)
    }

    pub fn skip(self, n: usize) -> OneThread<impl Iterator<Item = I::Item>> {
        OneThread(self.0.skip(n))
    }

    pub fn sum<S: Sum<I::Item>>(self) -> S {
        self.0.sum()
    }

    pub fn take(self, n: usize) -> OneThread<impl Iterator<Item = I::Item>> {
        OneThread(self.0.take(n))
    }

    pub fn with_min_len(self, _: usize) -> OneThread<I> {
        self
    }

    pub fn zip<T: IntoIterator>(self, other: T) -> OneThread<impl Iterator<Item = (I::Item, T::Item)>> {
        OneThread(self.0.zip(other))
    }
}

/// Loops over the items of a range or a list.
pub trait IntoParallelIterator: IntoIterator + Sized {
    /// Loops over the items.
    fn into_par_iter(self) -> OneThread<Self::IntoIter> {
        OneThread(self.into_iter())
    }
}

impl<T: IntoIterator> IntoParallelIterator for T {}

/// Loops over the elements of a list.
pub trait ParallelSlice<T> {
    /// Loops over the elements.
    fn par_iter(&self) -> OneThread<Iter<'_, T>>;
    /// Loops over groups of so many elements.
    fn par_chunks(&self, size: usize) -> OneThread<Chunks<'_, T>>;
}

impl<T> ParallelSlice<T> for [T] {
    fn par_iter(&self) -> OneThread<Iter<'_, T>> {
        OneThread(self.iter())
    }

    fn par_chunks(&self, size: usize) -> OneThread<Chunks<'_, T>> {
        OneThread(self.chunks(size))
    }
}

/// Loops that change the elements of a list.
pub trait ParallelSliceMut<T> {
    /// Loops over the elements.
    fn par_iter_mut(&mut self) -> OneThread<IterMut<'_, T>>;
    /// Loops over groups of so many elements.
    fn par_chunks_mut(&mut self, size: usize) -> OneThread<ChunksMut<'_, T>>;
}

impl<T> ParallelSliceMut<T> for [T] {
    fn par_iter_mut(&mut self) -> OneThread<IterMut<'_, T>> {
        OneThread(self.iter_mut())
    }

    fn par_chunks_mut(&mut self, size: usize) -> OneThread<ChunksMut<'_, T>> {
        OneThread(self.chunks_mut(size))
    }
}

/// Lists that take the items of a loop.
pub trait ParallelExtend<T>: Extend<T> {
    /// Adds the items.
    fn par_extend(&mut self, items: impl IntoIterator<Item = T>) {
        self.extend(items);
    }
}

impl<T, L: Extend<T>> ParallelExtend<T> for L {}

/// Starts threads: there are none to start.
#[derive(Debug, Default)]
pub struct ThreadPoolBuilder;

/// Threads: the one that calls.
#[derive(Debug)]
pub struct ThreadPool;

/// Why threads cannot be started. It does not happen.
#[derive(Debug)]
pub struct ThreadPoolBuildError;

impl Display for ThreadPoolBuildError {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str("there are no threads")
    }
}

impl Error for ThreadPoolBuildError {}

impl ThreadPoolBuilder {
    /// As [`ThreadPoolBuilder::default`].
    pub fn new() -> ThreadPoolBuilder {
        ThreadPoolBuilder
    }

    /// Any number is one.
    pub fn num_threads(self, _: usize) -> ThreadPoolBuilder {
        self
    }

    /// The thread that calls.
    ///
    /// # Errors
    /// None.
    pub fn build(self) -> Result<ThreadPool, ThreadPoolBuildError> {
        Ok(ThreadPool)
    }

    /// The thread that calls.
    ///
    /// # Errors
    /// None.
    pub fn build_global(self) -> Result<(), ThreadPoolBuildError> {
        Ok(())
    }
}

impl ThreadPool {
    /// Calls `f`.
    pub fn install<T>(&self, f: impl FnOnce() -> T) -> T {
        f()
    }
}

#[cfg(test)]
mod tests {
    /// The results of the same loops, with the traits of a library.
    macro_rules! results {
        ($prelude:path) => {{
            use $prelude::*;

            let mut halves = vec![1_u64, 2, 3, 4, 5];
            halves.par_iter_mut().with_min_len(2).for_each(|n| *n *= 2);
            halves.par_chunks_mut(2).enumerate().skip(1).take(1).for_each(|(i, pair)| pair[0] += i as u64);
            let mut all: Vec<u64> = halves.par_iter().filter_map(|n| (n % 4 == 0).then_some(*n)).collect();
            all.par_extend((0..4_u64).into_par_iter().map(|n| n * n));
            let reversed = halves.par_chunks(2).flat_map_iter(|pair| pair.iter().copied().rev());
            all.extend(reversed.collect::<Vec<_>>());
            all.extend(vec![Some(7), None].into_par_iter().flatten().collect::<Vec<u64>>());
            all.extend(halves.par_iter().zip(&halves).map(|(a, b)| a * b).collect::<Vec<_>>());
            all.push(halves.par_iter().map_init(|| 3, |shift, n| n + *shift).reduce(|| 0, u64::max));
            all.push(halves[..0].par_iter().copied().reduce(|| 5, u64::max));
            all.push(halves.par_iter().map(|n| n + 1).sum());
            let short: Result<Vec<u64>, u64> =
                halves.par_iter().map(|n| if *n < 7 { Ok(*n) } else { Err(9) }).collect();
            (all, short)
        }};
    }

    #[test]
    fn loops_give_the_results_of_rayon() {
        assert_eq!(results!(crate::one_thread::prelude), results!(rayon::prelude));
    }
}
