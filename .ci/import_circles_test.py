#!/usr/bin/env python3
"""Tests of import_circles.py, on small crates written to a temporary folder."""

import sys
import tempfile
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
from import_circles import circles, imports_of, told


def crate(files):
    """The imports of a crate with these files, as `{(file, file): names}` below its `src`."""
    with tempfile.TemporaryDirectory() as folder:
        for name, text in files.items():
            file = Path(folder) / name
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text)
        _, edges = imports_of(Path(folder) / "lib.rs")
        relative = lambda file: str(file.relative_to(folder))
        return {(relative(one), relative(other)): names for (one, other), names in edges.items()}


class ImportCircles(unittest.TestCase):
    def test_circle_of_three_files_is_found_and_named(self):
        edges = crate({
            "lib.rs": "mod a; mod b; mod c; mod d;",
            "a.rs": "use crate::b::Second; pub struct First;",
            "b.rs": "use super::c::{third, THIRD}; pub struct Second;",
            "c.rs": "pub const THIRD: u8 = 3; pub fn third() -> crate::a::First { loop {} }",
            "d.rs": "use crate::a::First;",
        })
        self.assertEqual(circles(edges), [["a.rs", "b.rs", "c.rs"]])
        self.assertEqual(
            told("here", circles(edges)[0], edges),
            "here: 3 members\n  a.rs -> b.rs: Second\n  b.rs -> c.rs: THIRD, third\n"
            "  c.rs -> a.rs: First",
        )

    def test_tree_without_circle_passes(self):
        edges = crate({
            "lib.rs": "mod a; mod b; mod c;",
            "a.rs": "pub struct A;",
            "b.rs": "use crate::a::A; pub struct B(A);",
            "c.rs": "use crate::{a::A, b::B}; struct C(A, B);",
        })
        self.assertEqual(set(edges), {("b.rs", "a.rs"), ("c.rs", "a.rs"), ("c.rs", "b.rs")})
        self.assertEqual(circles(edges), [])

    def test_two_circles_are_told_apart(self):
        edges = crate({
            "lib.rs": "mod a; mod b; mod c; mod d;",
            "a.rs": "use crate::b::B; pub struct A;",
            "b.rs": "use crate::{a::A, c::C}; pub struct B;",
            "c.rs": "use crate::d::D; pub struct C;",
            "d.rs": "use crate::c::C; pub struct D;",
        })
        self.assertEqual(circles(edges), [["a.rs", "b.rs"], ["c.rs", "d.rs"]])

    def test_mod_lines_and_re_exports_of_a_parent_are_no_imports(self):
        edges = crate({
            "lib.rs": "mod room; pub use room::{Table, Chair as Seat}; pub use room::chair::*;",
            "room/mod.rs": "mod chair; mod table; pub struct Wall;\n"
            "pub use chair::Chair; pub(crate) use table::Table;",
            "room/chair.rs": "use super::Wall; pub struct Chair;",
            "room/table.rs": "use super::Wall; pub struct Table;",
        })
        chair, table, parent = "room/chair.rs", "room/table.rs", "room/mod.rs"
        self.assertEqual(set(edges), {(chair, parent), (table, parent)})

    def test_parent_that_needs_what_it_re_exports_imports_it(self):
        edges = crate({
            "lib.rs": "mod room; pub use room::Chair; pub struct House { chair: Chair }",
            "room.rs": "use crate::House; pub struct Chair;",
        })
        self.assertEqual(circles(edges), [["lib.rs", "room.rs"]])

    def test_parent_that_calls_a_child_imports_it(self):
        edges = crate({
            "lib.rs": "mod child; pub struct Parent; pub fn run() { child::run(Parent) }",
            "child.rs": "pub fn run(_: super::Parent) {}",
        })
        self.assertEqual(circles(edges), [["child.rs", "lib.rs"]])

    def test_re_export_of_a_sibling_is_an_import(self):
        edges = crate({
            "lib.rs": "mod a; mod b;",
            "a.rs": "pub use super::b::B; pub struct A;",
            "b.rs": "use super::a::A; pub struct B;",
        })
        self.assertEqual(circles(edges), [["a.rs", "b.rs"]])

    def test_re_exports_are_followed_to_the_defining_file(self):
        edges = crate({
            "lib.rs": "mod room; mod user; pub use room::Chair; pub use room as salon;",
            "room/mod.rs": "mod chair; mod legs; pub use chair::Chair; pub use legs::*;",
            "room/chair.rs": "pub struct Chair;",
            "room/legs.rs": "pub struct Leg;",
            "user.rs": "use crate::{Chair, salon::Leg};",
        })
        chair, legs = ("user.rs", "room/chair.rs"), ("user.rs", "room/legs.rs")
        self.assertEqual(edges, {chair: {"Chair"}, legs: {"Leg"}})

    def test_nested_use_trees_over_several_lines_are_read(self):
        edges = crate({
            "lib.rs": "mod a; mod b; mod c;",
            "a.rs": "pub mod deep { pub mod deeper { pub fn f() {} } pub struct D; } pub struct A;",
            "b.rs": "pub struct B;",
            "c.rs": "use crate::{\n    a::{self as first, deep::{deeper::f, D as Alias, self}},\n"
            "    b::B,\n};",
        })
        self.assertEqual(edges, {("c.rs", "a.rs"): {"f", "D"}, ("c.rs", "b.rs"): {"B"}})

    def test_super_climbs_through_inline_and_nested_modules(self):
        edges = crate({
            "lib.rs": "mod outer; mod target;",
            "outer.rs": "mod middle;",
            "outer/middle.rs": "mod inner; mod inline { use super::super::super::target::One; }",
            "outer/middle/inner.rs": "fn f() { super::super::super::target::two() }",
            "target.rs": "pub struct One; pub fn two() {}",
        })
        self.assertEqual(
            edges,
            {
                ("outer/middle.rs", "target.rs"): {"One"},
                ("outer/middle/inner.rs", "target.rs"): {"two"},
            },
        )

    def test_paths_in_code_are_imports(self):
        edges = crate({
            "lib.rs": "mod a; mod b; mod c; mod d;",
            "a.rs": "pub fn f() {} pub struct A; pub struct X;",
            "b.rs": "fn g() { let _ = Vec::<crate::a::A>::new(); { crate::a::f::<u8>(); } }",
            "c.rs": "use super::a; fn g(x: &mut a::X) { std::mem::take(x); }",
            "d.rs": "fn g() { use crate::a::f; f() }",
        })
        self.assertEqual(
            edges, {("b.rs", "a.rs"): {"A", "f"}, ("c.rs", "a.rs"): {"X"}, ("d.rs", "a.rs"): {"f"}}
        )

    def test_glob_import_counts_for_the_names_it_brings(self):
        edges = crate({
            "lib.rs": "mod a; mod b;",
            "a.rs": "pub struct A; pub struct Other;",
            "b.rs": "use super::a::*; fn f(_: A) {}",
        })
        self.assertEqual(edges, {("b.rs", "a.rs"): {"A"}})

    def test_test_modules_do_not_count(self):
        edges = crate({
            "lib.rs": "mod a; mod b; #[cfg(test)] mod tests;\n"
            "#[cfg(all(test, unix))] mod more { use crate::a::A; }",
            "a.rs": "use crate::b::B; pub struct A;\n"
            "#[cfg(test)]\nmod tests { use super::*; use crate::b::B; }",
            "b.rs": "pub struct B;\n#[cfg(test)] #[allow(unused)] use crate::a::{A};\n"
            "#[cfg(test)] pub(crate) fn f() -> crate::a::A { loop {} }",
            "tests.rs": "use crate::a::A;",
        })
        self.assertEqual(edges, {("a.rs", "b.rs"): {"B"}})

    def test_code_that_is_left_out_of_tests_counts(self):
        edges = crate({
            "lib.rs": "mod a; mod b;",
            "a.rs": "#[cfg(not(test))] use crate::b::B; pub struct A;",
            "b.rs": "pub struct B;",
        })
        self.assertEqual(edges, {("a.rs", "b.rs"): {"B"}})

    def test_comments_strings_and_other_crates_do_not_count(self):
        edges = crate({
            "lib.rs": "mod a; mod b; mod glam;",
            "a.rs": "// use crate::b::B;\n/* crate::b::B /* */ crate::b::B */\n"
            "/// [`crate::b::B`]\n"
            """pub const A: (&str, char, char) = (r#"" crate::b::B"#, '"', '\\'');\n"""
            'pub const B: &str = "use crate::b::B; \\" crate::b::B";\n'
            "fn f<'a>(x: &'a str) -> &'a str { x }\nuse ::glam::DVec3; use std::f64;",
            "b.rs": "pub struct B;",
            "glam.rs": "pub struct DVec3;",
        })
        self.assertEqual(edges, {})

    def test_path_attribute_is_followed(self):
        edges = crate({
            "lib.rs": '#[path = "elsewhere/x.rs"] mod a; mod b;',
            "elsewhere/x.rs": "use crate::b::B; pub struct A;",
            "b.rs": "use crate::a::A; pub struct B;",
        })
        self.assertEqual(circles(edges), [["b.rs", "elsewhere/x.rs"]])

    def test_crates_that_need_each_other_are_a_circle(self):
        edges = {("one", "two"): {"normal"}, ("two", "one"): {"dev"}, ("three", "one"): {"normal"}}
        self.assertEqual(circles(edges), [["one", "two"]])


if __name__ == "__main__":
    unittest.main()
