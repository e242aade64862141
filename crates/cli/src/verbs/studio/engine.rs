//! The sessions in which layouts are evaluated: one for each client, and several clients at a time.

use std::ops::ControlFlow;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use hyper::body::Bytes;
use magsplice::threads;
use magsplice_page_engine::Session;
use rayon::ThreadPool;
use tokio::sync::mpsc::Sender;
use tokio::sync::mpsc::error::TrySendError;

use super::layout_file::LayoutFile;

/// Largest number of sessions. A page has two: one for gestures, and one for long work.
const MAX_SESSIONS: usize = 16;

/// The sessions of all clients.
pub(super) struct Engine {
    file: Arc<LayoutFile>,
    /// The clients with their names; the one that asked last is at the end.
    clients: Mutex<Vec<(String, Arc<Client>)>>,
}

/// A session with threads of its own, so that long work of one client does not delay another.
pub(super) struct Client {
    session: Mutex<Session>,
    threads: ThreadPool,
}

impl Engine {
    /// An engine without clients.
    pub(super) fn new(file: Arc<LayoutFile>) -> Engine {
        Engine { file, clients: Mutex::default() }
    }

    /// The client of this name, which may be new. Too many clients end the session of the one that
    /// has not asked for the longest time.
    pub(super) fn client(&self, name: &str) -> Result<Arc<Client>, String> {
        let mut clients = self.clients.lock().unwrap_or_else(PoisonError::into_inner);
        let client = match clients.iter().position(|(known, _)| known == name) {
            Some(at) => clients.remove(at).1,
            None => Arc::new(Client::new()?),
        };
        if clients.len() == MAX_SESSIONS {
            clients.remove(0);
        }
        clients.push((name.to_owned(), client.clone()));
        Ok(client)
    }

    /// Answers a request of a client: lines of progress, and the answer as the last line. The work
    /// ends when the receiver of the lines is dropped.
    pub(super) fn answer(&self, client: &Client, request: &[u8], lines: &Sender<Bytes>) {
        let session = &mut *client.session();
        // The client may have left while another request was answered.
        if lines.is_closed() {
            return;
        }
        let files = self.file.readable_files();
        let mut report = |line: &str| match lines.try_send(with_end(&format!("{{\"progress\":{line}}}"))) {
            Err(TrySendError::Closed(_)) => ControlFlow::Break(()),
            // A line of progress may be lost where the client reads slowly.
            Ok(()) | Err(TrySendError::Full(_)) => ControlFlow::Continue(()),
        };
        let answer = client.threads.install(|| {
            session.allow(files);
            session.answer_reporting(request, &mut report)
        });
        // Nobody waits for the answer if this fails.
        let _ = lines.blocking_send(with_end(&answer));
    }
}

impl Client {
    fn new() -> Result<Client, String> {
        let threads = threads::pool(Some(rayon::current_num_threads()));
        let threads = threads.map_err(|error| format!("cannot start threads: {error}"))?;
        Ok(Client { session: Mutex::default(), threads })
    }

    /// The session, or a new one after a panic.
    fn session(&self) -> MutexGuard<'_, Session> {
        self.session.lock().unwrap_or_else(|poisoned| {
            self.session.clear_poison();
            let mut session = poisoned.into_inner();
            *session = Session::default();
            session
        })
    }
}

fn with_end(line: &str) -> Bytes {
    Bytes::from(format!("{line}\n"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn oldest_client_leaves_when_there_are_too_many() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("film.toml");
        std::fs::write(&path, "").expect("writable");
        let engine = Engine::new(Arc::new(LayoutFile::open(&path).expect("a file")));
        let first = engine.client("0").expect("a client");
        let second = engine.client("1").expect("a client");
        for name in 2..MAX_SESSIONS {
            engine.client(&name.to_string()).expect("a client");
        }
        // The first has asked again, so the second is the oldest.
        assert!(Arc::ptr_eq(&engine.client("0").expect("a client"), &first));
        engine.client("one more").expect("a client");
        assert!(Arc::ptr_eq(&engine.client("0").expect("a client"), &first));
        assert!(!Arc::ptr_eq(&engine.client("1").expect("a client"), &second));
        assert_eq!(engine.clients.lock().expect("no panic").len(), MAX_SESSIONS);
    }
}
