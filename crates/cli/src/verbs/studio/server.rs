//! Connections.

use std::convert::Infallible;
use std::io;
use std::net::TcpListener;
use std::sync::Arc;
use std::time::Duration;

use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper_util::rt::{TokioIo, TokioTimer};
use tokio::runtime::Builder;

use super::{Studio, routes};

/// Pause after a connection that could not be accepted, such as without free file descriptors.
const PAUSE: Duration = Duration::from_millis(100);

/// Answers requests until the program ends. One thread serves all connections; work that takes time
/// has threads of its own.
pub(super) fn serve(listener: TcpListener, studio: Studio) -> io::Result<()> {
    let runtime = Builder::new_current_thread().enable_io().enable_time().build()?;
    listener.set_nonblocking(true)?;
    let studio = Arc::new(studio);
    runtime.block_on(async {
        let listener = tokio::net::TcpListener::from_std(listener)?;
        loop {
            let Ok((stream, _)) = listener.accept().await else {
                tokio::time::sleep(PAUSE).await;
                continue;
            };
            // Events and lines of progress are small, and must not wait for each other.
            let _ = stream.set_nodelay(true);
            let studio = studio.clone();
            let service = service_fn(move |request| {
                let studio = studio.clone();
                async move { Ok::<_, Infallible>(routes::answer(&studio, request).await) }
            });
            // The error of a connection is that the client has left, or sends no HTTP.
            tokio::spawn(async move {
                let connection =
                    http1::Builder::new().timer(TokioTimer::new()).serve_connection(TokioIo::new(stream), service);
                let _ = connection.await;
            });
        }
    })
}
