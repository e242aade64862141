//! What a request asks for: the page, the engine, the file, or its changes.

use std::sync::Arc;

use http_body_util::{BodyExt, LengthLimitError, Limited};
use hyper::body::{Body, Bytes, Incoming};
use hyper::header::CONTENT_TYPE;
use hyper::{HeaderMap, Method, Request, StatusCode};
use magsplice_live_page::{LivePage, PageEngine, live_page};
use serde::Deserialize;
use serde_json::json;
use tokio::sync::mpsc;
use tokio::task::spawn_blocking;

use super::access::Access;
use super::engine::Engine;
use super::events;
use super::layout_file::{LayoutFile, MAX_FILE_BYTES, NotWritten};
use super::reply::{self, Reply};

/// Largest size of a request: that of the file, which it may hold.
const MAX_BODY_BYTES: usize = MAX_FILE_BYTES;

/// Largest length of the name of a client.
const MAX_CLIENT_BYTES: usize = 64;

/// Lines of progress that a client may leave unread before some are lost.
const UNREAD_LINES: usize = 64;

/// The parts of the server that requests share.
pub(super) struct Studio {
    pub(super) access: Access,
    pub(super) file: Arc<LayoutFile>,
    pub(super) engine: Arc<Engine>,
}

/// A text for the file, in place of the one with the hash `base`.
#[derive(Deserialize)]
struct NewText {
    text: String,
    base: String,
}

/// Answers a request.
pub(super) async fn answer(studio: &Studio, request: Request<Incoming>) -> Reply {
    let Some(path) = studio.access.path(request.uri(), request.headers()) else { return forbidden() };
    let is_post = request.method() == Method::POST;
    let is_known = match path {
        "" | "events" => request.method() == Method::GET,
        "file" => is_post || request.method() == Method::GET,
        "engine" => is_post,
        // Nothing else exists, whoever asks.
        _ => return forbidden(),
    };
    if !is_known {
        return reply::error(StatusCode::METHOD_NOT_ALLOWED, "the method must be GET or POST, as the page uses it");
    }
    if is_post && !is_json(request.headers()) {
        return reply::error(StatusCode::UNSUPPORTED_MEDIA_TYPE, "Content-Type must be application/json");
    }
    let answered = match (path, is_post) {
        ("", _) => show_page(studio).await,
        ("events", _) => Ok(follow_file(studio, request.headers())),
        ("file", false) => read_file(studio).await,
        ("file", true) => write_file(studio, request).await,
        _ => evaluate(studio, request).await,
    };
    answered.unwrap_or_else(|refused| refused)
}

fn forbidden() -> Reply {
    reply::error(StatusCode::FORBIDDEN, "forbidden: open the address that the program printed")
}

fn is_json(headers: &HeaderMap) -> bool {
    let kind = headers.get(CONTENT_TYPE).and_then(|value| value.to_str().ok()).and_then(|kind| kind.split(';').next());
    kind.is_some_and(|kind| kind.trim().eq_ignore_ascii_case("application/json"))
}

async fn show_page(studio: &Studio) -> Result<Reply, Reply> {
    let file = studio.file.clone();
    in_background(move || {
        let latest = file.read();
        // The page asks for the file, and then shows why it cannot be read.
        let text = latest.as_ref().as_ref().map_or("", |contents| contents.text.as_str());
        reply::html(live_page(&LivePage { name: &file.name(), text, engine: PageEngine::Server }))
    })
    .await
}

fn follow_file(studio: &Studio, headers: &HeaderMap) -> Reply {
    let last_hash = headers.get("last-event-id").and_then(|hash| hash.to_str().ok());
    reply::events(events::stream(studio.file.states(), last_hash))
}

async fn read_file(studio: &Studio) -> Result<Reply, Reply> {
    let file = studio.file.clone();
    in_background(move || match &*file.read() {
        Ok(contents) => reply::json(StatusCode::OK, contents),
        Err(error) => reply::error(StatusCode::INTERNAL_SERVER_ERROR, error),
    })
    .await
}

async fn write_file(studio: &Studio, request: Request<Incoming>) -> Result<Reply, Reply> {
    let body = body_of(request).await?;
    let NewText { text, base } = serde_json::from_slice(&body)
        .map_err(|error| reply::error(StatusCode::BAD_REQUEST, &format!("the request is broken: {error}")))?;
    let file = studio.file.clone();
    in_background(move || match file.replace(&text, &base) {
        Ok(sha256) => reply::json(StatusCode::OK, &json!({ "sha256": sha256 })),
        Err(NotWritten::Conflict(contents)) => reply::json(StatusCode::CONFLICT, &contents),
        Err(NotWritten::Invalid(error)) => reply::error(StatusCode::UNPROCESSABLE_ENTITY, &error),
        Err(NotWritten::Failed(error)) => reply::error(StatusCode::INTERNAL_SERVER_ERROR, &error),
    })
    .await
}

async fn evaluate(studio: &Studio, request: Request<Incoming>) -> Result<Reply, Reply> {
    let name = request.uri().query().and_then(client_of).map(str::to_owned);
    let rule = "client must have from 1 to 64 letters, digits, - and _";
    let name = name.ok_or_else(|| reply::error(StatusCode::BAD_REQUEST, rule))?;
    let body = body_of(request).await?;
    let client = studio.engine.client(&name);
    let client = client.map_err(|error| reply::error(StatusCode::INTERNAL_SERVER_ERROR, &error))?;
    let (sender, lines) = mpsc::channel(UNREAD_LINES);
    let engine = Arc::clone(&studio.engine);
    spawn_blocking(move || engine.answer(&client, &body, &sender));
    Ok(reply::lines(lines))
}

/// The name of the client in a query.
fn client_of(query: &str) -> Option<&str> {
    let name = query.split('&').find_map(|pair| pair.strip_prefix("client="))?;
    let is_name = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'-' || byte == b'_';
    ((1..=MAX_CLIENT_BYTES).contains(&name.len()) && name.bytes().all(is_name)).then_some(name)
}

/// The body of a request, if it is not too large.
async fn body_of(request: Request<Incoming>) -> Result<Bytes, Reply> {
    let too_large = || {
        let rule = format!("the request must have at most {MAX_BODY_BYTES} bytes");
        reply::error(StatusCode::PAYLOAD_TOO_LARGE, &rule)
    };
    let body = request.into_body();
    if body.size_hint().lower() > MAX_BODY_BYTES as u64 {
        return Err(too_large());
    }
    match Limited::new(body, MAX_BODY_BYTES).collect().await {
        Ok(collected) => Ok(collected.to_bytes()),
        Err(error) if error.is::<LengthLimitError>() => Err(too_large()),
        Err(error) => Err(reply::error(StatusCode::BAD_REQUEST, &format!("the request is broken: {error}"))),
    }
}

/// Does work on a thread of its own, so that other requests are answered meanwhile.
async fn in_background(work: impl FnOnce() -> Reply + Send + 'static) -> Result<Reply, Reply> {
    let failed =
        |_| reply::error(StatusCode::INTERNAL_SERVER_ERROR, "the program failed; standard error has the reason");
    spawn_blocking(work).await.map_err(failed)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_clients_are_short_words() {
        for (query, name) in [
            ("client=page-1_A", Some("page-1_A")),
            ("x=1&client=2", Some("2")),
            ("client=", None),
            ("client=a%20b", None),
            ("client=../x", None),
            ("other=1", None),
        ] {
            assert_eq!(client_of(query), name, "{query}");
        }
        assert_eq!(client_of(&format!("client={}", "a".repeat(65))), None);
    }
}
