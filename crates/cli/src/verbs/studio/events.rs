//! Changes of the file, as server-sent events.

use std::time::Duration;

use hyper::body::Bytes;
use serde_json::json;
use tokio::sync::{mpsc, watch};
use tokio::time::timeout;

use super::layout_file::Latest;

/// Time after which a line shows that the server lives.
const HEARTBEAT: Duration = Duration::from_secs(15);

/// Events that a client may leave unread before it gets no more.
const UNREAD: usize = 4;

/// Each later state of the file, until the receiver is dropped. `last_hash` is the hash of the file
/// when an earlier stream ended: if it is another one now, the state of now is the first event.
pub(super) fn stream(mut states: watch::Receiver<Latest>, last_hash: Option<&str>) -> mpsc::Receiver<Bytes> {
    let (sender, events) = mpsc::channel(UNREAD);
    let now = states.borrow_and_update().clone();
    let first = match last_hash {
        Some(hash) if hash != hash_of(&now) => event(&now),
        // Without data it is no event, but the page returns the hash when it connects again.
        _ => Bytes::from(format!("id: {}\n\n", hash_of(&now))),
    };
    tokio::spawn(async move {
        let mut next = first;
        while sender.send(next).await.is_ok() {
            next = match timeout(HEARTBEAT, states.changed()).await {
                Ok(Ok(())) => event(&states.borrow_and_update()),
                Ok(Err(_)) => return,
                Err(_) => Bytes::from_static(b":\n\n"),
            };
        }
    });
    events
}

fn event(state: &Latest) -> Bytes {
    // JSON has no line ends, which would end an event.
    let data = match &**state {
        Ok(contents) => json!(contents),
        Err(error) => json!({ "error": error }),
    };
    Bytes::from(format!("id: {}\ndata: {data}\n\n", hash_of(state)))
}

/// The hash of the file, or a word in its place: an empty id is none.
fn hash_of(state: &Latest) -> &str {
    state.as_ref().as_ref().map_or("unreadable", |contents| contents.sha256.as_str())
}
