//! Answers with their headers.

use std::convert::Infallible;
use std::pin::Pin;
use std::task::{Context, Poll};

use http_body_util::combinators::BoxBody;
use http_body_util::{BodyExt, Full};
use hyper::body::{Body, Bytes, Frame};
use hyper::header::{CACHE_CONTROL, CONTENT_SECURITY_POLICY, CONTENT_TYPE, HeaderName, HeaderValue};
use hyper::header::{REFERRER_POLICY, X_CONTENT_TYPE_OPTIONS};
use hyper::{Response, StatusCode};
use serde::Serialize;
use serde_json::json;
use tokio::sync::mpsc;

pub(super) type Reply = Response<BoxBody<Bytes, Infallible>>;

/// What the page may load: itself, the worker that it makes, and the engine.
const CONTENT_POLICY: &str = "default-src 'none'; script-src 'unsafe-inline' data: blob: 'wasm-unsafe-eval'; \
                              worker-src blob: data:; style-src 'unsafe-inline'; img-src data: blob:; \
                              connect-src 'self' data: blob:; base-uri 'none'; form-action 'none'; \
                              frame-ancestors 'none'";

/// A page of HTML.
pub(super) fn html(text: String) -> Reply {
    let mut reply = reply(StatusCode::OK, "text/html; charset=utf-8", full(text));
    reply.headers_mut().insert(CONTENT_SECURITY_POLICY, HeaderValue::from_static(CONTENT_POLICY));
    reply
}

/// A value as JSON.
pub(super) fn json(status: StatusCode, value: &impl Serialize) -> Reply {
    // Texts and objects of texts can always be written as JSON.
    reply(status, "application/json", full(json!(value).to_string()))
}

/// An error as JSON.
pub(super) fn error(status: StatusCode, error: &str) -> Reply {
    json(status, &json!({ "error": error }))
}

/// Lines of JSON as they come.
pub(super) fn lines(lines: mpsc::Receiver<Bytes>) -> Reply {
    reply(StatusCode::OK, "application/x-ndjson", Pieces(lines).boxed())
}

/// Server-sent events as they come.
pub(super) fn events(events: mpsc::Receiver<Bytes>) -> Reply {
    reply(StatusCode::OK, "text/event-stream", Pieces(events).boxed())
}

fn full(text: String) -> BoxBody<Bytes, Infallible> {
    Full::new(Bytes::from(text)).boxed()
}

fn reply(status: StatusCode, content_type: &'static str, body: BoxBody<Bytes, Infallible>) -> Reply {
    let mut reply = Response::new(body);
    *reply.status_mut() = status;
    for (name, value) in [
        (CONTENT_TYPE, content_type),
        (CACHE_CONTROL, "no-store"),
        (REFERRER_POLICY, "no-referrer"),
        (X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
    ] {
        reply.headers_mut().insert(name, HeaderValue::from_static(value));
    }
    reply
}

/// A body that is sent piece by piece. It is dropped when the client leaves.
struct Pieces(mpsc::Receiver<Bytes>);

impl Body for Pieces {
    type Data = Bytes;
    type Error = Infallible;

    fn poll_frame(self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Option<Result<Frame<Bytes>, Infallible>>> {
        self.get_mut().0.poll_recv(context).map(|piece| piece.map(|piece| Ok(Frame::data(piece))))
    }
}
