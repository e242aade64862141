//! `report --live`, and the live page in the folder of a report.

use std::fs;

use crate::{Sandbox, shipped};

/// The first bytes of a file that is compressed by xz.
const XZ: &[u8] = b"\xfd7zXZ\0 engine";

#[test]
fn page_holds_the_layout_and_the_engine_of_a_file() {
    let sandbox = Sandbox::new();
    fs::write(sandbox.path("engine.wasm.xz"), XZ).expect("writable");
    let layout = shipped("published-film");
    let said = sandbox.run(&["report", &layout, "--live", "--engine", "engine.wasm.xz"]);
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    let page = sandbox.read("published-film.html");
    assert!(page.contains("/Td6WFoAIGVuZ2luZQ=="), "the engine in base64");
    assert!(page.contains("[[lattice]]") && page.contains("The film of Dai et al."));
    let said = sandbox.run(&["report", &layout, "-o", "out", "--engine", "engine.wasm.xz"]);
    assert_eq!((said.status, said.stderr.as_str()), (0, ""));
    assert_eq!(sandbox.read("out/live.html"), page);
    assert!(sandbox.read("out/report.html").contains("href=\"live.html\""));
}

#[test]
fn files_that_are_no_engine_are_refused_and_nothing_is_written() {
    let sandbox = Sandbox::new();
    sandbox.write("engine.wasm", "\0asm");
    let (layout, other) = (shipped("published-film"), shipped("robust-in-plane"));
    for (arguments, message) in [
        (vec!["report", &layout, "--live", "--engine", "engine.wasm"], "engine.wasm: is not compressed by xz"),
        (vec!["report", &layout, "--live", "--engine", "none.xz"], "none.xz"),
        (vec!["report", &layout, &other, "--live"], "--live shows one film: give one layout"),
    ] {
        let said = sandbox.run(&arguments);
        assert_eq!(said.status, 2, "{arguments:?}");
        assert!(said.stderr.contains(message), "{}", said.stderr);
    }
    assert!(!sandbox.path("published-film.html").exists());
}
