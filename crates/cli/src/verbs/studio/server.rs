//! Connections.

use std::convert::Infallible;
use std::io;
use std::net::TcpListener;
use std::sync::Arc;
use std::time::Duration;

use hyper::Request;
use hyper::body::Incoming;
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper_util::rt::{TokioIo, TokioTimer};
use tokio::net::TcpStream;
use tokio::runtime::Builder;

use super::reply::Reply;
use super::routes::{self, Studio};

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
            let studio = studio.clone();
            tokio::spawn(converse(stream, move |request| {
                let studio = studio.clone();
                async move { routes::answer(&studio, request).await }
            }));
        }
    })
}

/// Answers the requests of one connection. The body of an answer is dropped when the client leaves.
async fn converse<A: Future<Output = Reply>>(stream: TcpStream, answer: impl Fn(Request<Incoming>) -> A) {
    // Events and lines of progress are small, and must not wait for each other.
    let _ = stream.set_nodelay(true);
    let service = service_fn(|request| {
        let answer = answer(request);
        async { Ok::<_, Infallible>(answer.await) }
    });
    // A connection fails if the client leaves, or sends no HTTP.
    let _ = http1::Builder::new().timer(TokioTimer::new()).serve_connection(TokioIo::new(stream), service).await;
}

#[cfg(test)]
mod tests {
    use std::io::{BufRead, BufReader, Write};
    use std::thread;

    use hyper::body::Bytes;
    use tokio::sync::mpsc;

    use super::super::reply;
    use super::*;

    /// The work of an answer that has sent nothing yet, or one line, ends when the client leaves.
    #[test]
    fn answer_is_dropped_when_the_client_leaves() {
        for sent in [None, Some("{}\n")] {
            let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
            let address = listener.local_addr().expect("an address");
            let client = thread::spawn(move || {
                let mut stream = std::net::TcpStream::connect(address).expect("a server");
                stream.write_all(b"GET / HTTP/1.1\r\nHost: x\r\n\r\n").expect("sent");
                let mut lines = BufReader::new(&stream).lines();
                // The head, and the line in a chunk.
                let line = lines.by_ref().map_while(Result::ok).find(|line| line == sent.map_or("", str::trim_end));
                assert!(line.is_some());
            });
            let runtime = Builder::new_current_thread().enable_io().enable_time().build().expect("a runtime");
            let left = runtime.block_on(async {
                listener.set_nonblocking(true).expect("a listener");
                let listener = tokio::net::TcpListener::from_std(listener).expect("a listener");
                let (stream, _) = listener.accept().await.expect("a client");
                let (sender, lines) = mpsc::channel(1);
                if let Some(line) = sent {
                    sender.try_send(Bytes::from(line)).expect("room");
                }
                let lines = std::sync::Mutex::new(Some(lines));
                let answer = move |_| {
                    let lines = lines.lock().expect("no panic").take().expect("one request");
                    async { reply::lines(lines) }
                };
                tokio::spawn(converse(stream, answer));
                tokio::time::timeout(Duration::from_secs(30), sender.closed()).await
            });
            assert!(left.is_ok(), "{sent:?}");
            client.join().expect("a client");
        }
    }
}
