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

/// Runs `work` on a thread of the current pool, with the others awake: from there on a parallel loop is
/// a call, where from outside it would be a message to the pool and a wait for its answer, and its
/// helpers need not be woken, which takes longer than many a loop (in a browser above all).
pub(crate) fn in_pool<R: Send>(work: impl FnOnce() -> R + Send) -> R {
    #[cfg(feature = "parallel")]
    if rayon::current_num_threads() > 1 {
        return rayon::scope(|scope| awake::while_running(scope, work));
    }
    work()
}

#[cfg(feature = "parallel")]
mod awake {
    use core::sync::atomic::{AtomicBool, Ordering};
    use std::sync::Arc;

    /// What the threads know of the work they wait for.
    struct Shared {
        done: AtomicBool,
        /// Which threads work or wait for work already: a thread must not begin to wait on top of a task
        /// of the very work whose end it would wait for.
        taken: Vec<AtomicBool>,
    }

    impl Shared {
        /// Is this thread the first to be marked as its number?
        fn take(&self) -> bool {
            let thread = rayon::current_thread_index().and_then(|i| self.taken.get(i));
            thread.is_some_and(|taken| !taken.swap(true, Ordering::Relaxed))
        }
    }

    /// Ends the waiting, also when the work panics.
    struct Finish(Arc<Shared>);

    impl Drop for Finish {
        fn drop(&mut self) {
            self.0.done.store(true, Ordering::Release);
        }
    }

    /// Runs `work` here, while the other threads take what parallel work comes up without falling asleep.
    pub fn while_running<R>(scope: &rayon::Scope, work: impl FnOnce() -> R) -> R {
        let threads = rayon::current_num_threads();
        let shared = Arc::new(Shared {
            done: AtomicBool::new(false),
            taken: (0..threads).map(|_| AtomicBool::new(false)).collect(),
        });
        shared.take();
        for _ in 1..threads {
            let shared = shared.clone();
            scope.spawn(move |_| {
                if shared.take() {
                    while !shared.done.load(Ordering::Acquire) {
                        if rayon::yield_now() != Some(rayon::Yield::Executed) {
                            core::hint::spin_loop();
                        }
                    }
                }
            });
        }
        let _finish = Finish(shared);
        work()
    }
}

/// Threads of the current pool.
pub(crate) fn threads() -> usize {
    #[cfg(feature = "parallel")]
    return rayon::current_num_threads();
    #[cfg(not(feature = "parallel"))]
    1
}
