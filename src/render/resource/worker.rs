//! Making pipelines off the frame.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
        mpsc::{Receiver, Sender, channel},
    },
    thread::JoinHandle,
};

use crate::render::resource::{
    key::Key,
    pipeline::{Maker, Modules, Pipeline},
};

/// Modules that it keeps for pipelines that share them.
const MOST_MODULES: usize = 256;

/// A thread that makes pipelines. Dropping it waits for the one in hand: a driver that is torn down while it compiles may
/// crash.
#[derive(Debug)]
pub struct Worker {
    /// `None` once no more are wanted.
    pub wanted: Option<Sender<Key>>,
    /// Those that are made.
    pub ready: Receiver<(Key, Pipeline)>,
    is_over: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Drop for Worker {
    fn drop(&mut self) {
        self.is_over.store(true, Ordering::Relaxed);
        self.wanted = None;
        if let Some(thread) = self.thread.take() {
            // A thread that panicked has said so.
            let _ = thread.join();
        }
    }
}

impl Worker {
    /// `None` where the system gives no thread.
    pub fn start(maker: Maker) -> Option<Self> {
        let (wanted, orders) = channel::<Key>();
        let (deliveries, ready) = channel();
        let is_over = Arc::new(AtomicBool::new(false));
        let is_enough = is_over.clone();
        let work = move || {
            let mut modules = Modules::default();
            for key in orders {
                if is_enough.load(Ordering::Relaxed) {
                    return;
                }
                if modules.len() >= MOST_MODULES {
                    modules.clear();
                }
                let pipeline = maker.make(&mut modules, &*key);
                if deliveries.send((key, pipeline)).is_err() {
                    return;
                }
            }
        };
        let thread = std::thread::Builder::new().name("pipelines".to_owned()).spawn(work).ok()?;
        Some(Self { wanted: Some(wanted), ready, is_over, thread: Some(thread) })
    }
}
