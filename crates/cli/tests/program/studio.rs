//! `studio`: a page that only its own address reaches, and the file that it keeps.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{Shutdown, TcpStream};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc;
use std::thread;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::{Sandbox, shipped};

/// Longest wait for anything.
const PATIENCE: Duration = Duration::from_secs(60);

/// Time within which a change of the file arrives in the page.
const PROMPT: Duration = Duration::from_millis(200);

/// A layout with a comment on a line of its own, and one behind a value.
const LAYOUT: &str = "# A film with comments.\nformat = 1\nname = \"one\" # short\n\n# Its tile.\n[[tile]]\n\
                      position_mm = [0, 0, 0]\nsize_mm = [1.5, 1, 1] # length\npolarization_t = [0, 0, 1]\n";

/// A running server.
struct Studio {
    child: Child,
    port: u16,
    token: String,
}

/// An answer of the server.
#[derive(Debug)]
struct Answer {
    status: u16,
    head: String,
    body: String,
}

impl Answer {
    #[track_caller]
    fn json(&self) -> Value {
        serde_json::from_str(&self.body).unwrap_or_else(|error| panic!("{error}: {}", self.body))
    }
}

impl Drop for Studio {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Studio {
    fn start(sandbox: &Sandbox, arguments: &[&str]) -> Studio {
        let mut program = Command::new(env!("CARGO_BIN_EXE_magsplice"));
        program.arg("studio").args(arguments).current_dir(sandbox.path(""));
        Studio::of(&mut program)
    }

    fn of(program: &mut Command) -> Studio {
        let mut child =
            program.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().expect("it starts");
        let mut url = String::new();
        BufReader::new(child.stdout.take().expect("piped")).read_line(&mut url).expect("a line");
        let rest = url.trim_end().strip_prefix("http://127.0.0.1:").unwrap_or_else(|| panic!("{url:?}"));
        let (port, token) = rest.strip_suffix('/').and_then(|rest| rest.split_once('/')).expect("a port and a token");
        assert!(token.len() == 32 && token.bytes().all(|byte| byte.is_ascii_hexdigit()), "{url}");
        Studio { child, port: port.parse().expect("a port"), token: token.to_owned() }
    }

    fn host(&self) -> String {
        format!("127.0.0.1:{}", self.port)
    }

    fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(self.host()).expect("a server");
        stream.set_read_timeout(Some(PATIENCE)).expect("a timeout");
        stream
    }

    /// Sends a head without its last lines, and a body.
    fn send(&self, head: &str, body: &[u8]) -> Answer {
        let mut stream = self.connect();
        let head = format!("{head}\r\nConnection: close\r\nContent-Length: {}\r\n\r\n", body.len());
        stream.write_all(head.as_bytes()).expect("sent");
        // A server that refuses the head may not read the body.
        let _ = stream.write_all(body);
        answer(stream)
    }

    fn get(&self, path: &str) -> Answer {
        self.send(&format!("GET /{}/{path} HTTP/1.1\r\nHost: {}", self.token, self.host()), b"")
    }

    fn post(&self, path: &str, body: &Value) -> Answer {
        self.post_text(path, &body.to_string())
    }

    fn post_text(&self, path: &str, body: &str) -> Answer {
        let (token, host) = (&self.token, self.host());
        let head = format!(
            "POST /{token}/{path} HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\nSec-Fetch-Site: same-origin\r\n\
             Content-Type: application/json"
        );
        self.send(&head, body.as_bytes())
    }

    /// The last line of the answer of the engine.
    fn ask(&self, client: &str, request: &Value) -> Value {
        let answer = self.post(&format!("engine?client={client}"), request);
        assert!(answer.status == 200 && answer.head.contains("content-type: application/x-ndjson"), "{answer:?}");
        let lines: Vec<&str> = answer.body.lines().collect();
        assert!(answer.body.ends_with('\n') && !lines.is_empty(), "{answer:?}");
        serde_json::from_str(lines[lines.len() - 1]).expect("JSON")
    }

    /// The events of the file from now on, each with the time at which it came. `more` is further
    /// headers.
    fn events_after(&self, more: &str) -> mpsc::Receiver<(Instant, Value)> {
        let mut stream = self.connect();
        let (token, host) = (&self.token, self.host());
        write!(stream, "GET /{token}/events HTTP/1.1\r\nHost: {host}{more}\r\n\r\n").expect("sent");
        let mut lines = BufReader::new(stream).lines().map_while(Result::ok);
        assert!(lines.by_ref().any(|line| line.starts_with("id: ")));
        let (sender, events) = mpsc::channel();
        thread::spawn(move || {
            let data = lines.filter_map(|line| line.strip_prefix("data: ").map(str::to_owned));
            data.map(|data| (Instant::now(), serde_json::from_str(&data).expect("JSON")))
                .try_for_each(|event| sender.send(event))
        });
        events
    }

    fn events(&self) -> mpsc::Receiver<(Instant, Value)> {
        self.events_after("")
    }

    fn file_hash(&self) -> Value {
        self.get("file").json()["sha256"].clone()
    }
}

/// Reads an answer to its end.
fn answer(mut stream: TcpStream) -> Answer {
    let mut bytes = Vec::new();
    // A server that has not read the whole request ends the connection with an error.
    let _ = stream.read_to_end(&mut bytes);
    let text = String::from_utf8(bytes).expect("UTF-8");
    let (head, mut rest) = text.split_once("\r\n\r\n").unwrap_or_else(|| panic!("{text:?}"));
    let head = head.to_lowercase();
    let status = head.split(' ').nth(1).and_then(|status| status.parse().ok()).expect("a status");
    let mut body = String::new();
    if head.contains("transfer-encoding: chunked") {
        while let Some((size, after)) = rest.split_once("\r\n") {
            let size = usize::from_str_radix(size, 16).expect("a size");
            body += &after[..size];
            rest = &after[size + 2..];
        }
    } else {
        body = rest.to_owned();
    }
    Answer { status, head, body }
}

fn opened(text: &str) -> Value {
    json!({ "open": { "text": text, "name": "film" } })
}

/// Measured errors in a file.
fn measured(file: &str) -> String {
    format!("{LAYOUT}[tolerance]\nposition_mm = {{ file = \"{file}\" }}\n")
}

#[test]
fn requests_of_others_are_forbidden() {
    let sandbox = Sandbox::new();
    sandbox.write("film.toml", LAYOUT);
    sandbox.write("x", "secret");
    let studio = Studio::start(&sandbox, &["film.toml"]);
    let (token, host) = (studio.token.as_str(), studio.host());
    let wrong = format!("{}{}", if token.starts_with('0') { '1' } else { '0' }, &token[1..]);
    let own = format!("Host: {host}");
    let json = "Content-Type: application/json";
    let mut heads = Vec::new();
    for path in ["", "file", "events", "engine?client=1"] {
        for target in [format!("/{wrong}/{path}"), format!("/{}/{path}", &token[1..]), format!("/{path}")] {
            heads.extend(["GET", "POST"].map(|method| format!("{method} {target} HTTP/1.1\r\n{own}\r\n{json}")));
        }
        for headers in [
            "Host: example.org".to_owned(),
            format!("Host: example.org:{}", studio.port),
            "Host: 127.0.0.1".to_owned(),
            format!("Host: 127.0.0.1:{}", studio.port ^ 1),
            format!("Host: [::1]:{}", studio.port),
            format!("{own}\r\nHost: example.org"),
            format!("{own}\r\nOrigin: null"),
            format!("{own}\r\nOrigin: http://example.org"),
            format!("{own}\r\nOrigin: https://{host}"),
            format!("{own}\r\nOrigin: http://localhost:{}", studio.port),
            format!("{own}\r\nSec-Fetch-Site: cross-site"),
            format!("{own}\r\nSec-Fetch-Site: same-site"),
        ] {
            for method in ["GET", "POST", "OPTIONS"] {
                heads.push(format!("{method} /{token}/{path} HTTP/1.1\r\n{headers}\r\n{json}"));
            }
        }
    }
    for path in ["../x", "x", "./file", "file/", "//file", "%2e%2e/x", "..%2fx", "file/../x", "%66ile", "/etc/passwd"] {
        heads.push(format!("GET /{token}/{path} HTTP/1.1\r\n{own}"));
    }
    heads.push(format!("GET /{token} HTTP/1.1\r\n{own}"));
    heads.push(format!("GET http://{host}/{token}/file HTTP/1.1\r\n{own}"));
    heads.push("GET /favicon.ico HTTP/1.1\r\nHost: localhost".to_owned());
    let body = json!({ "text": LAYOUT.replace("1.5", "2.5"), "base": studio.file_hash() }).to_string();
    for head in &heads {
        let answer = studio.send(head, if head.starts_with("POST") { body.as_bytes() } else { b"" });
        assert_eq!(answer.status, 403, "{head}");
        assert!(!answer.body.contains("secret") && !answer.body.contains("polarization"), "{answer:?}");
    }
    assert_eq!(sandbox.read("film.toml"), LAYOUT);
    // The page itself, under both names of this machine.
    for host in [host, format!("localhost:{}", studio.port)] {
        let answer = studio.send(&format!("GET /{token}/ HTTP/1.1\r\nHost: {host}\r\nSec-Fetch-Site: none"), b"");
        assert_eq!(answer.status, 200);
        for header in [
            "content-type: text/html",
            "content-security-policy: default-src 'none'; script-src 'unsafe-inline' data: blob: 'wasm-unsafe-eval'; \
             worker-src blob: data:; style-src 'unsafe-inline'; img-src data: blob:; connect-src 'self' data: blob:; \
             base-uri 'none'; form-action 'none'",
            "x-content-type-options: nosniff",
            "referrer-policy: no-referrer",
            "cache-control: no-store",
        ] {
            assert!(answer.head.contains(header), "{header}: {}", answer.head);
        }
        assert!(answer.body.contains("film.toml"));
    }
}

#[test]
fn text_of_the_page_is_written_unless_the_file_has_changed() {
    let sandbox = Sandbox::new();
    sandbox.write("film.toml", LAYOUT);
    let studio = Studio::start(&sandbox, &["film.toml"]);
    let read = studio.get("file");
    assert_eq!((read.status, read.json()["text"].as_str()), (200, Some(LAYOUT)));
    let first = studio.file_hash();
    let longer = LAYOUT.replace("1.5", "2.5");
    let written = studio.post("file", &json!({ "text": longer, "base": first }));
    assert_eq!(written.status, 200, "{written:?}");
    // To the last byte, comments included.
    assert_eq!(sandbox.read("film.toml"), longer);
    assert_eq!(written.json()["sha256"], studio.file_hash());

    // Both sides changed: the file stays.
    let edited = LAYOUT.replace("1.5", "3.5");
    sandbox.write("film.toml", &edited);
    for base in [&first, &written.json()["sha256"], &json!("")] {
        let conflict = studio.post("file", &json!({ "text": LAYOUT.replace("1.5", "4.5"), "base": base }));
        assert_eq!((conflict.status, conflict.json()["text"].as_str()), (409, Some(edited.as_str())));
        assert_eq!(conflict.json()["sha256"], studio.file_hash());
    }
    // Broken texts, and texts that refer to files that the one on disk does not refer to.
    sandbox.write("secret.csv", "0.1\n0.2\n");
    let base = studio.file_hash();
    for (text, message) in [
        ("format = ".to_owned(), "film.toml: TOML parse error at line 1"),
        (LAYOUT.replace("1.5", "-1"), "film.toml: line 6: tile \"tile-1\": size_mm[0] = -1, must be greater than 0"),
        (measured("secret.csv"), "film.toml: refers to \"secret.csv\", must refer only to files"),
        (measured("/etc/passwd"), "film.toml: refers to \"/etc/passwd\", must"),
        (format!("{LAYOUT}[expect]\nfield = {{ file = \"secret.csv\", within = 1 }}\n"), "refers to \"secret.csv\""),
    ] {
        let refused = studio.post("file", &json!({ "text": text, "base": base }));
        assert_eq!(refused.status, 422, "{refused:?}");
        assert!(refused.json()["error"].as_str().expect("a message").contains(message), "{refused:?}");
    }
    assert_eq!(sandbox.read("film.toml"), edited);
    // A file that cannot be read is written by nobody.
    fs::remove_file(sandbox.path("film.toml")).expect("a file");
    let missing = studio.post("file", &json!({ "text": LAYOUT, "base": base }));
    assert_eq!(missing.status, 500);
    assert!(missing.json()["error"].as_str().expect("a message").starts_with("cannot read film.toml: "), "{missing:?}");
    assert_eq!(sandbox.files(), ["secret.csv"]);
}

#[cfg(unix)]
#[test]
fn links_and_permissions_are_kept() {
    use std::os::unix::fs::{PermissionsExt, symlink};

    let sandbox = Sandbox::new();
    fs::create_dir(sandbox.path("films")).expect("a folder");
    sandbox.write("films/film.toml", LAYOUT);
    // The mask of new files would take away the right of the group to write.
    fs::set_permissions(sandbox.path("films/film.toml"), fs::Permissions::from_mode(0o660)).expect("permissions");
    symlink("films/film.toml", sandbox.path("link.toml")).expect("a link");
    let studio = Studio::start(&sandbox, &["link.toml"]);
    let events = studio.events();
    let longer = LAYOUT.replace("1.5", "2.5");
    let written = studio.post("file", &json!({ "text": longer, "base": studio.file_hash() }));
    assert_eq!(written.status, 200, "{written:?}");
    assert_eq!(sandbox.read("films/film.toml"), longer);
    assert!(sandbox.path("link.toml").is_symlink());
    let mode = fs::metadata(sandbox.path("films/film.toml")).expect("a file").permissions().mode();
    assert_eq!(mode & 0o777, 0o660);
    // What the page wrote is told to all clients, and so is a change at the end of the link.
    assert_eq!(events.recv_timeout(PATIENCE).expect("an event").1["text"], longer);
    sandbox.write("films/film.toml", LAYOUT);
    assert_eq!(events.recv_timeout(PATIENCE).expect("an event").1["text"], LAYOUT);

    fs::set_permissions(sandbox.path("films/film.toml"), fs::Permissions::from_mode(0o440)).expect("permissions");
    let refused = studio.post("file", &json!({ "text": longer, "base": studio.file_hash() }));
    assert_eq!((refused.status, refused.json()), (500, json!({ "error": "cannot write link.toml: it is read-only" })));
    assert_eq!(sandbox.read("films/film.toml"), LAYOUT);
}

#[test]
fn changes_on_disk_arrive_as_events() {
    let sandbox = Sandbox::new();
    sandbox.write("film.toml", LAYOUT);
    let studio = Studio::start(&sandbox, &["film.toml"]);
    let events = studio.events();
    let next = || events.recv_timeout(PATIENCE).expect("an event");
    let mut times = Vec::new();
    for (index, length) in ["2.5", "3.5", "4.5", "5.5", "6.5", "7.5"].into_iter().enumerate() {
        let text = LAYOUT.replace("1.5", length);
        let begun = Instant::now();
        if index % 2 == 0 {
            sandbox.write("film.toml", &text);
        } else {
            // An editor that replaces the file.
            sandbox.write("film.toml~", &text);
            fs::rename(sandbox.path("film.toml~"), sandbox.path("film.toml")).expect("renamed");
        }
        let (came, event) = next();
        assert_eq!(event["text"], text);
        assert_eq!(event["sha256"], studio.file_hash());
        times.push(came - begun);
    }
    // Other tests may take the processors for a while.
    times.sort_unstable();
    assert!(times[1] <= PROMPT, "{times:?}");
    // A page that has lost its connection gets what it missed, and nothing if it missed nothing.
    let hash = studio.file_hash();
    let returned = |hash: &str| studio.events_after(&format!("\r\nLast-Event-ID: {hash}"));
    let missed = returned("0").recv_timeout(PATIENCE).expect("an event");
    assert_eq!(missed.1, studio.get("file").json());
    assert!(returned(hash.as_str().expect("a hash")).recv_timeout(Duration::from_millis(300)).is_err());
    // The text of a broken layout is sent: the engine finds its faults.
    sandbox.write("film.toml", "format = ");
    assert_eq!(next().1["text"], "format = ");
    fs::write(sandbox.path("film.toml"), b"\xff").expect("written");
    let error = |event: &Value| event["error"].as_str().expect("an error").to_owned();
    assert!(error(&next().1).starts_with("film.toml: not UTF-8 text: "));
    fs::remove_file(sandbox.path("film.toml")).expect("removed");
    assert!(error(&next().1).starts_with("cannot read film.toml: "));
    // Files beside it and a saved file without a change send nothing.
    sandbox.write("film.toml", LAYOUT);
    assert_eq!(next().1["text"], LAYOUT);
    sandbox.write("other.toml", "");
    sandbox.write("film.toml", LAYOUT);
    let more = events.recv_timeout(Duration::from_millis(500));
    assert!(more.is_err(), "{more:?}");
}

#[test]
fn engine_has_a_session_for_each_client() {
    let sandbox = Sandbox::new();
    let published = fs::read_to_string(shipped("published-film")).expect("readable");
    sandbox.write("film.toml", &published);
    let studio = Studio::start(&sandbox, &["film.toml"]);
    assert_eq!(studio.ask("page", &json!("keep")), json!({ "error": "no layout is open" }));
    let answer = studio.ask("page", &opened(&published));
    assert_eq!(answer["ok"]["name"], "published film", "{answer}");
    let answer = studio.ask("page", &json!({ "evaluate": { "rigid": false } }));
    let text = sandbox.run(&["decouple", "film.toml", "--format", "json"]).stdout;
    let known: Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(answer["ok"]["evaluation"]["uniformity_rmse"], known["uniformity_rmse"]);
    assert!(known["uniformity_rmse"].is_object());
    assert_eq!(studio.ask("worker", &json!("keep")), json!({ "error": "no layout is open" }));
    let refused = studio.ask("worker", &opened("format = "));
    assert!(refused["error"].as_str().expect("a message").starts_with("film: TOML parse error"), "{refused}");
    assert_eq!(studio.ask("page", &json!("keep"))["ok"]["text"], published);
}

#[test]
fn engine_reads_only_files_of_the_layout_on_disk() {
    let sandbox = Sandbox::new();
    fs::create_dir(sandbox.path("films")).expect("a folder");
    sandbox.write("films/film.toml", LAYOUT);
    for name in ["films/x.csv", "x.csv"] {
        sandbox.write(name, "0.1\n0.2\n");
    }
    let studio = Studio::start(&sandbox, &["films/film.toml"]);
    let events = studio.events();
    for file in ["x.csv", "../x.csv", "/etc/passwd"] {
        let refused = studio.ask("1", &opened(&measured(file)));
        let known = format!("film: refers to \"{file}\", must refer only to files");
        assert!(refused["error"].as_str().expect("a message").starts_with(&known), "{refused}");
    }
    // In a value that is set in the text, too.
    assert!(studio.ask("1", &opened(LAYOUT))["ok"].is_object());
    let set = |path: Value, value: Value| json!({ "set": { "edits": [{ "path": path, "value": value }] } });
    for request in [
        set(json!(["tolerance", "position_mm", "file"]), json!("x.csv")),
        set(json!(["tolerance", "position_mm"]), json!({ "file": "x.csv" })),
        set(json!(["tolerance"]), json!({ "position_mm": [{ "normal": 1 }, { "normal": 1 }, { "file": "x.csv" }] })),
        set(json!(["tolerance", "neighbour"]), json!({ "layout": "x.csv", "position_mm": [0, 0, -9] })),
    ] {
        let refused = studio.ask("1", &request);
        assert!(refused["error"].as_str().expect("a message").contains("refers to \"x.csv\""), "{refused}");
    }
    // Added with an editor. The folder is that of the layout, whatever name the request gives.
    sandbox.write("films/film.toml", &measured("x.csv"));
    events.recv_timeout(PATIENCE).expect("an event");
    let read = studio.ask("1", &opened(&measured("x.csv")));
    assert!(read["ok"].is_object(), "{read}");
    let other = json!({ "open": { "text": measured("x.csv").replace("x.csv", "../x.csv"), "name": "../film.toml" } });
    assert!(studio.ask("1", &other)["error"].is_string());
    // While the file is broken, its last references count.
    sandbox.write("films/film.toml", "format = ");
    events.recv_timeout(PATIENCE).expect("an event");
    assert!(studio.ask("1", &opened(&measured("x.csv")))["ok"].is_object());
    assert!(studio.ask("1", &opened(&measured("../x.csv")))["error"].is_string());
}

/// The work of one client, and requests of another while it lasts.
#[test]
fn long_work_of_a_client_delays_no_other() {
    let sandbox = Sandbox::new();
    let published = fs::read_to_string(shipped("published-film")).expect("readable");
    sandbox.write("film.toml", &published);
    let studio = Studio::start(&sandbox, &["film.toml", "--threads", "1"]);
    let step = published.lines().find(|line| line.starts_with("step_mm")).expect("a step");
    let fine = published.replace(step, "step_mm = 0.03");
    assert!(studio.ask("worker", &opened(&fine))["ok"].is_object());
    assert!(studio.ask("page", &opened(&published))["ok"].is_object());
    thread::scope(|scope| {
        let (sender, done) = mpsc::channel();
        let worker = sender.clone();
        let studio = &studio;
        scope.spawn(move || {
            let answer = studio.ask("worker", &json!({ "evaluate": { "rigid": false } }));
            worker.send(("worker", answer)).expect("a receiver");
        });
        // Long enough to begin with the work, which takes a second or more.
        thread::sleep(Duration::from_millis(100));
        sender.send(("page", studio.ask("page", &json!({ "evaluate": { "rigid": false } })))).expect("a receiver");
        let [first, second] = [0, 0].map(|_| done.recv_timeout(PATIENCE).expect("an answer"));
        assert_eq!((first.0, second.0), ("page", "worker"));
        for (_, answer) in [first, second] {
            assert!(answer["ok"]["evaluation"].is_object(), "{answer}");
        }
    });
}

/// A search ends long before its usual end, and the session is free for the next request.
#[test]
fn work_ends_when_its_client_leaves() {
    let sandbox = Sandbox::new();
    let published = fs::read_to_string(shipped("published-film")).expect("readable");
    sandbox.write("film.toml", &published);
    let studio = Studio::start(&sandbox, &["film.toml"]);
    let search = json!({ "improve": { "steps": 1_000_000_000 } });
    assert!(studio.ask("1", &opened(&published))["ok"].is_object());
    let begun = Instant::now();
    assert!(studio.ask("1", &search)["ok"].is_object());
    let whole = begun.elapsed();

    assert!(studio.ask("1", &opened(&published))["ok"].is_object());
    let mut stream = studio.connect();
    let (token, host, body) = (&studio.token, studio.host(), search.to_string());
    write!(
        stream,
        "POST /{token}/engine?client=1 HTTP/1.1\r\nHost: {host}\r\nContent-Type: application/json\r\n\
         Content-Length: {}\r\n\r\n{body}",
        body.len()
    )
    .expect("sent");
    let mut lines = BufReader::new(&stream).lines().map_while(Result::ok);
    assert!(lines.any(|line| line.starts_with("{\"progress\":")));
    drop(stream);
    let begun = Instant::now();
    assert!(studio.ask("1", &json!("keep"))["ok"].is_object());
    assert!(begun.elapsed() < whole / 2, "{:?} of {whole:?}", begun.elapsed());
}

#[test]
fn broken_requests_are_refused() {
    let sandbox = Sandbox::new();
    sandbox.write("film.toml", LAYOUT);
    let studio = Studio::start(&sandbox, &["film.toml"]);
    let (token, host) = (studio.token.as_str(), studio.host());
    let head =
        |method: &str, path: &str, more: &str| format!("{method} /{token}/{path} HTTP/1.1\r\nHost: {host}{more}");
    for (method, path) in
        [("POST", ""), ("GET", "engine?client=1"), ("PUT", "file"), ("DELETE", "file"), ("POST", "events")]
    {
        assert_eq!(studio.send(&head(method, path, ""), b"").status, 405, "{method} {path}");
    }
    for kind in ["", "\r\nContent-Type: text/plain", "\r\nContent-Type: application/jsonp"] {
        for path in ["file", "engine?client=1"] {
            assert_eq!(studio.send(&head("POST", path, kind), b"{}").status, 415, "{kind} {path}");
        }
    }
    for path in ["engine", "engine?client=", "engine?client=../x", &format!("engine?client={}", "a".repeat(65))] {
        assert_eq!(studio.post(path, &json!("keep")).status, 400, "{path}");
    }
    for body in ["", "{", "[]", "{\"text\":1}", "{\"text\":\"\"}"] {
        assert_eq!(studio.post_text("file", body).status, 400, "{body}");
        let answer = studio.post_text("engine?client=1", body);
        assert!(answer.status == 200 && answer.json()["error"].is_string(), "{answer:?}");
    }
    // Too large by its own account, and found to be too large.
    let kind = "\r\nContent-Type: application/json";
    let mut stream = studio.connect();
    write!(stream, "{}\r\nContent-Length: {}\r\n\r\n", head("POST", "file", kind), (16 << 20) + 1).expect("sent");
    stream.shutdown(Shutdown::Write).expect("shut down");
    assert_eq!(answer(stream).status, 413);
    let mut stream = studio.connect();
    write!(stream, "{}\r\nTransfer-Encoding: chunked\r\n\r\n", head("POST", "engine?client=1", kind)).expect("sent");
    let chunk = [b"10000\r\n", vec![b' '; 1 << 16].as_slice(), b"\r\n"].concat();
    // The server ends the connection in between.
    while stream.write_all(&chunk).is_ok() {}
    assert_eq!(sandbox.read("film.toml"), LAYOUT);
    assert_eq!(studio.get("file").status, 200);
}

#[test]
fn layouts_that_cannot_be_kept_are_refused() {
    let sandbox = Sandbox::new();
    fs::create_dir(sandbox.path("films")).expect("a folder");
    for (layout, message) in [
        ("nowhere.toml", "cannot read nowhere.toml: "),
        ("films", "cannot read films: it is a folder, must be a layout file"),
        ("-", "cannot read -: studio keeps a file, must be the path of a layout file"),
    ] {
        sandbox.run(&["studio", layout]).refuses(message);
    }
    #[cfg(unix)]
    sandbox
        .run(&["studio", "/dev/null"])
        .refuses("cannot read /dev/null: it is not a regular file, must be a layout file");
    sandbox.write("film.toml", "format = ");
    sandbox.run(&["studio", "film.toml", "--port", "80"]).refuses_arguments("80 is not in 1024..=65535");
    // A broken layout is served.
    let studio = Studio::start(&sandbox, &["film.toml"]);
    assert_eq!(studio.get("").status, 200);
    assert_eq!(studio.get("file").json()["text"], "format = ");
    let port = studio.port.to_string();
    let taken = format!("cannot serve on 127.0.0.1:{port}: ");
    sandbox.run(&["studio", "film.toml", "--port", &port]).refuses(&taken);
    drop(studio);
    assert_eq!(Studio::start(&sandbox, &["film.toml", "--port", &port]).port.to_string(), port);
}

#[cfg(target_os = "linux")]
#[test]
fn interruption_ends_with_success() {
    use rustix::process::{Pid, Signal, kill_process};

    let sandbox = Sandbox::new();
    sandbox.write("film.toml", LAYOUT);
    for signal in [Signal::INT, Signal::TERM] {
        let mut studio = Studio::start(&sandbox, &["film.toml"]);
        let _events = studio.events();
        kill_process(Pid::from_child(&studio.child), signal).expect("it runs");
        assert_eq!(studio.child.wait().expect("it ends").code(), Some(0));
    }
    assert_eq!(sandbox.files(), ["film.toml"]);
}

#[cfg(target_os = "linux")]
#[test]
fn browser_opens_the_address() {
    use std::os::unix::fs::PermissionsExt;

    let sandbox = Sandbox::new();
    sandbox.write("film.toml", LAYOUT);
    let opener = sandbox.write("xdg-open", "#!/bin/sh\nprintf %s \"$1\" > address.part && mv address.part address\n");
    fs::set_permissions(opener, fs::Permissions::from_mode(0o755)).expect("permissions");
    let path = format!("{}:{}", sandbox.path("").display(), std::env::var("PATH").expect("a path"));
    let mut program = Command::new(env!("CARGO_BIN_EXE_magsplice"));
    program.args(["studio", "film.toml", "--open"]).current_dir(sandbox.path("")).env("PATH", path);
    let studio = Studio::of(&mut program);
    let begun = Instant::now();
    while !sandbox.path("address").exists() {
        assert!(begun.elapsed() < PATIENCE, "no browser");
        thread::sleep(Duration::from_millis(10));
    }
    assert_eq!(sandbox.read("address"), format!("http://{}/{}/", studio.host(), studio.token));
}
