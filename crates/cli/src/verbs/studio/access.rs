//! Who may ask: token, Host and Origin.
//!
//! Pages of other sites can send requests to this machine, and names of other sites can lead to it.
//! The token keeps out both, and users of this machine who do not have it. Host and Origin keep out
//! other sites even with a token.

use std::fmt::Write;

use hyper::header::{HOST, ORIGIN};
use hyper::{HeaderMap, Uri};

/// Bytes of a token: 128 random bits.
const TOKEN_BYTES: usize = 16;

/// The address of the page, and the requests that it may send.
pub(super) struct Access {
    token: String,
    port: u16,
}

impl Access {
    /// A new token from the operating system, for a server on this port.
    pub(super) fn new(port: u16) -> Result<Access, getrandom::Error> {
        let mut bytes = [0; TOKEN_BYTES];
        getrandom::fill(&mut bytes)?;
        let token = bytes.iter().fold(String::new(), |mut token, byte| {
            let _ = write!(token, "{byte:02x}");
            token
        });
        Ok(Access { token, port })
    }

    /// The address of the page.
    pub(super) fn url(&self) -> String {
        format!("http://127.0.0.1:{}/{}/", self.port, self.token)
    }

    /// The path below the token. `None` if the request must be refused.
    pub(super) fn path<'u>(&self, uri: &'u Uri, headers: &HeaderMap) -> Option<&'u str> {
        if uri.authority().is_some() || !self.is_own_page(headers) {
            return None;
        }
        let (token, path) = uri.path().strip_prefix('/')?.split_once('/')?;
        is_equal(token.as_bytes(), self.token.as_bytes()).then_some(path)
    }

    /// Whether the headers are those of a request from the page, or of its first request.
    fn is_own_page(&self, headers: &HeaderMap) -> bool {
        let mut hosts = headers.get_all(HOST).iter();
        let (Some(host), None) = (hosts.next(), hosts.next()) else { return false };
        let hosts = [format!("127.0.0.1:{}", self.port), format!("localhost:{}", self.port)];
        let Some(host) = hosts.iter().find(|own| host.as_bytes().eq_ignore_ascii_case(own.as_bytes())) else {
            return false;
        };
        let origin = format!("http://{host}");
        headers.get_all(ORIGIN).iter().all(|given| given.as_bytes() == origin.as_bytes())
            && headers.get_all("sec-fetch-site").iter().all(|site| site == "same-origin" || site == "none")
    }
}

/// Compares all bytes, so that the time does not depend on the first difference.
fn is_equal(given: &[u8], own: &[u8]) -> bool {
    given.len() == own.len() && given.iter().zip(own).fold(0, |differences, (a, b)| differences | (a ^ b)) == 0
}

#[cfg(test)]
mod tests {
    use hyper::header::{HeaderName, HeaderValue};

    use super::*;

    fn headers(of: &[(&str, &str)]) -> HeaderMap {
        let mut headers = HeaderMap::new();
        for (name, value) in of {
            let name = name.parse::<HeaderName>().expect("a name");
            headers.append(name, HeaderValue::from_str(value).expect("a value"));
        }
        headers
    }

    #[test]
    fn tokens_are_random_and_hexadecimal() {
        let [first, second] = [0, 0].map(|_| Access::new(1).expect("random bits").token);
        assert_ne!(first, second);
        assert!(first.len() == 32 && first.bytes().all(|byte| byte.is_ascii_hexdigit()), "{first}");
    }

    #[test]
    fn only_requests_of_the_page_are_allowed() {
        let access = Access { token: "a1b2".to_owned(), port: 4000 };
        assert_eq!(access.url(), "http://127.0.0.1:4000/a1b2/");
        let path = |uri: &str, of: &[(&str, &str)]| {
            let uri: Uri = uri.parse().expect("a path");
            access.path(&uri, &headers(of)).map(str::to_owned)
        };
        let host = ("host", "127.0.0.1:4000");
        for (uri, allowed) in [
            ("/a1b2/", Some("")),
            ("/a1b2/engine?client=1", Some("engine")),
            ("/a1b2/../x", Some("../x")),
            ("/", None),
            ("/a1b2", None),
            ("/a1b/", None),
            ("/a1b3/", None),
            ("/a1b22/", None),
            ("/A1B2/", None),
            ("//a1b2/", None),
            ("/x/../a1b2/", None),
            ("/%61%31b2/", None),
            ("http://127.0.0.1:4000/a1b2/", None),
        ] {
            assert_eq!(path(uri, &[host]).as_deref(), allowed, "{uri}");
        }
        let origin = |origin| ("origin", origin);
        let site = |site| ("sec-fetch-site", site);
        for allowed in [
            &[host, origin("http://127.0.0.1:4000"), site("same-origin")][..],
            &[("host", "localhost:4000"), origin("http://localhost:4000")],
            &[("host", "LOCALHOST:4000"), site("none")],
        ] {
            assert_eq!(path("/a1b2/", allowed).as_deref(), Some(""), "{allowed:?}");
        }
        for refused in [
            &[][..],
            &[host, host],
            &[("host", "127.0.0.1")],
            &[("host", "127.0.0.1:4001")],
            &[("host", "[::1]:4000")],
            &[("host", "example.org:4000")],
            &[("host", "127.0.0.1:4000.example.org")],
            &[host, origin("null")],
            &[host, origin("https://127.0.0.1:4000")],
            &[host, origin("http://localhost:4000")],
            &[host, origin("http://127.0.0.1:4000"), origin("http://example.org")],
            &[host, site("cross-site")],
            &[host, site("same-site")],
        ] {
            assert_eq!(path("/a1b2/", refused), None, "{refused:?}");
        }
    }
}
