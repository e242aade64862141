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

/// The state of the file as it is now, and each later one, until the receiver is dropped.
pub(super) fn stream(mut states: watch::Receiver<Latest>) -> mpsc::Receiver<Bytes> {
    let (sender, events) = mpsc::channel(UNREAD);
    tokio::spawn(async move {
        loop {
            let event = match timeout(HEARTBEAT, states.changed()).await {
                Ok(Ok(())) => event(&states.borrow_and_update()),
                Ok(Err(_)) => return,
                Err(_) => Bytes::from_static(b":\n\n"),
            };
            if sender.send(event).await.is_err() {
                return;
            }
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
    Bytes::from(format!("data: {data}\n\n"))
}
