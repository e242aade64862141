//! One HTML page on which a spliced magnet film is edited and evaluated.
//!
//! [`live_page`] puts the modules in `page/` into one file, with the layout, and with the engine if
//! the page has its own. An import map gives the modules their names, so that the page loads no
//! other file and the modules are tested as they are. The page asks its engine for every number,
//! see `crates/page-engine`.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::json;

use crate::html::{escaped, filled, in_script};

/// Text inside a page.
pub mod html;

/// A page to write.
#[derive(Clone, Copy, Debug)]
pub struct LivePage<'a> {
    /// Name of the layout's file, in messages and downloads.
    pub name: &'a str,
    /// The layout, TOML. A broken one is shown with its message.
    pub text: &'a str,
    /// Where the numbers come from.
    pub engine: PageEngine<'a>,
}

/// Where the numbers of a page come from.
#[derive(Clone, Copy, Debug)]
pub enum PageEngine<'a> {
    /// The WebAssembly module of `crates/page-engine`, compressed by xz, inside the page.
    Module(&'a [u8]),
    /// The server of the page: `engine`, `file` and `events` beside it.
    Server,
}

const PAGE: &str = include_str!("../page/page.html");
const STYLE: &str = include_str!("../page/page.css");
/// xz-decompress 0.2.3 of npm, which unpacks the module.
const DECODER: &str = include_str!("../page/vendor/xz-decompress.min.js");

/// The modules by the names under which they import each other.
macro_rules! modules {
    ($($name:literal),* $(,)?) => { [$((concat!("#", $name), include_str!(concat!("../page/", $name, ".js")))),*] };
}
const MODULES: [(&str, &str); 20] = modules![
    "axis",
    "background",
    "causes",
    "colours",
    "curves",
    "cut_list",
    "engine",
    "file_link",
    "film_view",
    "format",
    "improve",
    "link",
    "map_view",
    "model",
    "results",
    "start",
    "surroundings",
    "symmetry",
    "tile_list",
    "toolbar",
];

/// The page as HTML.
pub fn live_page(page: &LivePage) -> String {
    let (engine, module) = match page.engine {
        PageEngine::Module(module) => ("module", STANDARD.encode(module)),
        PageEngine::Server => ("server", String::new()),
    };
    let decoder = if module.is_empty() { String::new() } else { format!("<script>{DECODER}</script>\n") };
    let source = json!({ "name": page.name, "text": page.text, "engine": engine });
    let module_texts: String = MODULES
        .iter()
        .map(|(name, text)| {
            format!("<script type=\"text/plain\" data-module=\"{name}\">\n{}</script>\n", without_comments(text))
        })
        .collect();
    let connect = if engine == "server" { "'self'" } else { "'none'" };
    filled(PAGE, &|placeholder| match placeholder {
        "title" => escaped(page.name),
        "version" => env!("CARGO_PKG_VERSION").to_owned(),
        "style" => STYLE.to_owned(),
        "connect" => connect.to_owned(),
        "modules" => module_texts.clone(),
        "source" => in_script(&source.to_string()),
        "decoder" => decoder.clone(),
        "module" => module.clone(),
        _ => unreachable!("{placeholder} is not a placeholder of the page"),
    })
}

/// A module without lines of comments, which are a fifth of it.
fn without_comments(text: &str) -> String {
    let mut in_comment = false;
    let kept = text.split_inclusive('\n').filter(|line| {
        let line = line.trim();
        let begins = line.starts_with("/**");
        let is_comment =
            in_comment || line.starts_with("//") || begins && (line.ends_with("*/") || !line.contains("*/"));
        in_comment = (in_comment || begins) && !line.contains("*/");
        !is_comment
    });
    kept.collect()
}

/// First bytes of a module that is compressed by xz.
pub const MAGIC: &[u8] = b"\xfd7zXZ\0";

/// The engine that was built into this crate: the module named by `MAGSPLICE_PAGE_ENGINE` when it
/// was compiled. `None` if none was named.
pub fn built_in_engine() -> Option<&'static [u8]> {
    // A constant would be copied into every crate that calls this function.
    static ENGINE: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/engine.wasm.xz"));
    (!ENGINE.is_empty()).then_some(ENGINE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hostile_names_stay_text() {
        let name = "</script><script>alert(1)</script>\"{{module}}";
        let page = live_page(&LivePage { name, text: "</script>{{source}}", engine: PageEngine::Server });
        assert!(!page.contains("alert(1)</script>"), "{page}");
        assert!(page.contains("\\u003c/script>\\u003cscript>alert(1)"));
        assert!(page.contains("&lt;/script&gt;&lt;script&gt;alert(1)"));
        assert!(!page.contains("{{style}}") && page.contains("{{module}}"));
    }

    #[test]
    fn comments_of_modules_stay_in_the_repository() {
        let text = "// a\n/** b */\nconst c = 1; // d\n/** e\n * f */\n  /** @type {any} */ (g).h();\n/** i\n * j\n */\nk();\n";
        assert_eq!(without_comments(text), "const c = 1; // d\n  /** @type {any} */ (g).h();\nk();\n");
        let kept: usize = MODULES.iter().map(|(_, text)| without_comments(text).len()).sum();
        assert!(kept > 50_000, "{kept} bytes");
    }

    /// The text of a module ends where the script element around it ends.
    #[test]
    fn modules_close_no_script() {
        for (name, text) in MODULES {
            assert!(!text.contains("</script") && !text.contains("<!--"), "{name}");
        }
    }

    #[test]
    fn page_holds_the_module() {
        let page = |engine| live_page(&LivePage { name: "film.toml", text: "format = 1", engine });
        assert!(page(PageEngine::Module(&[1, 2, 3])).contains("AQID"));
        assert!(page(PageEngine::Server).contains("\"engine\":\"server\""));
    }
}
