//! Data parallelism that does not change results: with the feature `parallel` the work of fixed
//! blocks goes to rayon's current pool, without it the same blocks run in order.

/// Runs `each(index, block, output)` over blocks paired with chunks of `output` of `chunk` entries.
pub(crate) fn for_each_block<B: Send, T: Send>(
    blocks: &mut [B],
    output: &mut [T],
    chunk: usize,
    each: impl Fn(usize, &mut B, &mut [T]) + Sync + Send,
) {
    #[cfg(feature = "parallel")]
    if rayon::current_num_threads() > 1 {
        use rayon::prelude::*;
        blocks
            .par_iter_mut()
            .zip(output.par_chunks_mut(chunk))
            .enumerate()
            .for_each(|(i, (b, o))| each(i, b, o));
        return;
    }
    for (i, (b, o)) in blocks.iter_mut().zip(output.chunks_mut(chunk)).enumerate() {
        each(i, b, o);
    }
}

/// Runs `each(index, chunk)` over chunks of `output` of `chunk` entries.
pub(crate) fn for_each_chunk<T: Send>(
    output: &mut [T],
    chunk: usize,
    each: impl Fn(usize, &mut [T]) + Sync + Send,
) {
    #[cfg(feature = "parallel")]
    if rayon::current_num_threads() > 1 {
        use rayon::prelude::*;
        output
            .par_chunks_mut(chunk)
            .enumerate()
            .for_each(|(i, o)| each(i, o));
        return;
    }
    for (i, o) in output.chunks_mut(chunk).enumerate() {
        each(i, o);
    }
}

/// Runs both, at the same time where there are threads.
pub(crate) fn join<A: Send, B: Send>(
    a: impl FnOnce() -> A + Send,
    b: impl FnOnce() -> B + Send,
) -> (A, B) {
    #[cfg(feature = "parallel")]
    if rayon::current_num_threads() > 1 {
        return rayon::join(a, b);
    }
    (a(), b())
}

/// Runs `work` on a thread of the current pool: from there on every parallel loop is a call, where
/// from outside it would be a message to the pool and a wait for its answer.
pub(crate) fn in_pool<R: Send>(work: impl FnOnce() -> R + Send) -> R {
    #[cfg(feature = "parallel")]
    if rayon::current_num_threads() > 1 {
        return rayon::scope(|_| work());
    }
    work()
}

/// Threads of the current pool.
pub(crate) fn threads() -> usize {
    #[cfg(feature = "parallel")]
    return rayon::current_num_threads();
    #[cfg(not(feature = "parallel"))]
    1
}
