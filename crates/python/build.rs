//! Linker arguments for macOS: the interpreter that loads the module provides the symbols of
//! libpython.

fn main() {
    pyo3_build_config::add_extension_module_link_args();
}
