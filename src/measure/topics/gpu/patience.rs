//! Work that is waited for up to a point: a driver that hangs, and a mistake of ours, cost one item and not the report.

use std::{
    any::Any,
    panic::{AssertUnwindSafe, catch_unwind},
    sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel},
    thread,
    time::Instant,
};

/// A listener that hears how far work has come: what it is at, and how many of how many are done.
pub type Watch<'a> = &'a mut dyn FnMut(&str, usize, usize);

/// A message from the thread that works.
enum Sign<T> {
    At(String, usize, usize),
    Done(Result<T, String>),
}

/// Does work on a thread of its own, and waits for it until `until`. Work that has no end by then is left to itself: a driver that does
/// not answer cannot be stopped.
///
/// # Errors
/// The error of the work, a broken rule of the program itself, and that time was up.
pub fn wait<T: Send + 'static>(
    until: Instant,
    watch: Watch<'_>,
    work: impl FnOnce(Watch<'_>) -> Result<T, String> + Send + 'static,
) -> Result<T, String> {
    let start = Instant::now();
    let (sender, signs) = channel();
    let own = move || {
        let watch = &mut |what: &str, done, total| drop(sender.send(Sign::At(what.to_owned(), done, total)));
        let result = caught(|| work(watch));
        finish(&sender, result);
    };
    let thread = thread::Builder::new().name("probe".into()).spawn(own);
    thread.map_err(|error| format!("no thread to work on: {error}"))?;
    heard(&signs, until, watch)
        .unwrap_or_else(|| Err(format!("no answer after {:.0} s; it is left to itself", start.elapsed().as_secs_f64())))
}

fn finish<T>(sender: &Sender<Sign<T>>, result: Result<T, String>) {
    // A receiver that does not wait any more does not listen.
    drop(sender.send(Sign::Done(result)));
}

/// The result of the work at its end; `None` if time is up before.
fn heard<T>(signs: &Receiver<Sign<T>>, until: Instant, watch: Watch<'_>) -> Option<Result<T, String>> {
    loop {
        match signs.recv_timeout(until.saturating_duration_since(Instant::now())) {
            Ok(Sign::At(what, done, total)) => watch(&what, done, total),
            Ok(Sign::Done(result)) => return Some(result),
            Err(RecvTimeoutError::Timeout) => return None,
            Err(RecvTimeoutError::Disconnected) => return Some(Err("it ended without a word".to_owned())),
        }
    }
}

fn caught<T>(work: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic: Box<dyn Any + Send>| {
        let text = panic.downcast_ref::<String>().map(String::as_str).or(panic.downcast_ref::<&str>().copied());
        Err(format!("a mistake of the program: {}", text.unwrap_or("it says nothing")))
    })
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn work_that_hangs_or_breaks_is_told() {
        let soon = || Instant::now() + Duration::from_secs(60);
        let mut heard = Vec::new();
        let done = wait(soon(), &mut |what, done, total| heard.push(format!("{what} {done} {total}")), |watch| {
            watch("a", 1, 2);
            Ok(3)
        });
        assert_eq!((done, heard), (Ok(3), vec!["a 1 2".to_owned()]));
        let mut deaf = |_: &str, _, _| ();
        assert_eq!(wait(soon(), &mut deaf, |_| Err::<(), _>("no".to_owned())), Err("no".to_owned()));
        let broken = wait(soon(), &mut deaf, |_| -> Result<(), String> { panic!("at {}", 7) });
        assert_eq!(broken, Err("a mistake of the program: at 7".to_owned()));
        let (_stay, never) = channel::<()>();
        let hung = wait(Instant::now() + Duration::from_millis(20), &mut deaf, move |_| {
            let _ = never.recv();
            Ok(())
        });
        assert!(hung.unwrap_err().starts_with("no answer after 0 s"));
    }
}
