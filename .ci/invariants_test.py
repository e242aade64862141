#!/usr/bin/env python3
"""Tests of invariants.py, on small crates written to a temporary folder."""

import sys
import tempfile
import unittest
from contextlib import contextmanager
from pathlib import Path

sys.dont_write_bytecode = True
from invariants import conversions_in, toml_outside_layout


@contextmanager
def crate(name, files):
    with tempfile.TemporaryDirectory() as folder:
        for file, text in files.items():
            path = Path(folder) / name / file
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        yield Path(folder) / name


def toml(name, manifest, code=""):
    with crate(name, {"Cargo.toml": manifest, "src/lib.rs": code}) as path:
        return len(list(toml_outside_layout([path])))


def conversions(code, file="src/verbs/scan.rs"):
    with crate("cli", {file: code}) as path:
        return len(list(conversions_in(path)))


class Toml(unittest.TestCase):
    def test_parsers_are_dependencies_of_layout_and_of_tests_only(self):
        manifest = "[dependencies]\ntoml = '1'\n[target.'cfg(unix)'.dependencies]\ntoml_edit = '1'"
        self.assertEqual(toml("design", manifest), 2)
        self.assertEqual(toml("layout", manifest), 0)
        self.assertEqual(toml("design", "[dev-dependencies]\ntoml = '1'"), 0)

    def test_texts_with_tables_and_keys_are_found(self):
        for code in (
            r'fn f() { format!("format = 1\n") }',
            r'fn f() { w += &format!("\n[[tile]]\nsize_mm = {s:?}\n"); }',
            'const T: &str = r#"\n[volume]\nx_mm = [1, 2]\n"#;',
            'fn f() { format!("\\\n    [ideal]\\n\\\n    wavelength_mm = {w}\\n") }',
        ):
            self.assertEqual(toml("design", "", code), 1, code)

    def test_messages_and_tests_may_name_tables(self):
        for code in (
            'fn f() { "the layout has no [volume] table, which this needs" }',
            'fn f() { format!("{axis} = {value}, must be less than {half} mm") }',
            '/// ```\n/// let text = "format = 1\n";\n/// ```\nfn f() {}',
            'fn f() {}\n#[cfg(test)]\nmod tests { const T: &str = "\n[volume]\n"; }',
        ):
            self.assertEqual(toml("design", "", code), 0, code)


class Conversions(unittest.TestCase):
    def test_factors_and_angles_are_found(self):
        for code in (
            "let mt = 1e3 * b_t;",
            "let ut = noise_t * 1e6;",
            "let mm = metres / 1e-3;",
            "let share = 100.0 * part / whole;",
            "let deg = angle.to_degrees();",
            "let rad = text.map(f64::to_radians);",
            "let mm = error / ideal.wavenumber();",
            "const MT_PER_T: f64 = 3.0;",
        ):
            self.assertEqual(conversions(code), 1, code)

    def test_bounds_texts_comments_and_tests_are_no_conversions(self):
        for code in (
            "if (1e-3..1e5).contains(&value.abs()) {}",
            "const MOST_SAMPLES: f64 = 1e6;",
            'let text = "1e3 * to_degrees";',
            "let x = y; // 1e3 * y",
            "fn f() {}\n#[cfg(test)]\nmod tests { const T: f64 = 1e3 * 2.0; }",
        ):
            self.assertEqual(conversions(code), 0, code)

    def test_the_files_of_units_may_convert(self):
        for file in ("src/units.rs", "src/text/units.rs"):
            self.assertEqual(conversions("value * 1e3", file), 0)


if __name__ == "__main__":
    unittest.main()
