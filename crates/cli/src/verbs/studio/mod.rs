//! `magsplice studio`: a live page of one layout file, served to this machine alone.

/// Who may ask: token, Host and Origin.
mod access;
/// The browser of the user.
mod browser;
/// The sessions in which layouts are evaluated.
mod engine;
/// Changes of the file, as events of a page.
mod events;
/// The file that is shown and kept.
mod layout_file;
/// Answers with their headers.
mod reply;
/// What a request asks for.
mod routes;
/// Connections.
mod server;

use std::net::{Ipv4Addr, TcpListener};
use std::path::PathBuf;
use std::sync::Arc;
use std::thread;

use crate::failure::{self, Failure};
use crate::interrupt;
use crate::output::destination;
use access::Access;
use engine::Engine;
use layout_file::LayoutFile;
use routes::Studio;

/// Show a layout as a live page: drag tiles, watch the field, keep the file.
///
/// Prints the address of the page, which only this machine can reach and which contains a random
/// token. Keep it to yourself: who has the address can change the layout. The page and an editor
/// work on the same file: a change saved in the editor appears in the page, and a change in the
/// page is written to the file, with its comments. If both have changed, the page asks. A broken
/// layout shows its faults, and the last good film stays.
///
/// Nothing but this file is written, and nothing is read but this file and the files that it refers
/// to. Ctrl-C ends the program.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  magsplice studio film.toml\n  magsplice studio film.toml --open")]
pub(crate) struct StudioArgs {
    /// Layout file
    layout: PathBuf,
    /// Open the page in the browser
    #[arg(long)]
    open: bool,
    /// Port of the page, from 1024 to 65535 [default: a free one]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1024..))]
    port: Option<u16>,
}

pub(crate) fn run(args: &StudioArgs, quiet: bool) -> Result<(), Failure> {
    interrupt::expect();
    let file = Arc::new(LayoutFile::open(&args.layout)?);
    let listener =
        TcpListener::bind((Ipv4Addr::LOCALHOST, args.port.unwrap_or(0))).map_err(|error| unbound(args, &error))?;
    let port = listener.local_addr().map_err(|error| unbound(args, &error))?.port();
    let access = Access::new(port).map_err(|error| Failure::Refused(format!("cannot make a random token: {error}")))?;
    let url = access.url();
    let watch = file.watch()?;
    let kept = file.clone();
    thread::spawn(move || kept.follow(&watch));
    destination::print(&format!("{url}\n"))?;
    if !quiet {
        failure::tell(&format_args!("serving {}; Ctrl-C ends", args.layout.display()));
    }
    if args.open
        && let Err(error) = browser::open(&url)
    {
        failure::tell(&format_args!("warning: cannot open a browser: {error}; open the address by hand"));
    }
    let studio = Studio { access, engine: Arc::new(Engine::new(file.clone())), file };
    server::serve(listener, studio).map_err(|error| Failure::Refused(format!("cannot serve {url}: {error}")))
}

fn unbound(args: &StudioArgs, error: &std::io::Error) -> Failure {
    let hint = if args.port.is_some() { "; give another --port, or none" } else { "" };
    Failure::Refused(format!("cannot serve on 127.0.0.1:{}: {error}{hint}", args.port.unwrap_or(0)))
}
