#!/usr/bin/env python3
"""Fails when files of one crate import each other in a circle, or when crates of the workspace do.

A file imports another one when a `use` or a path in its code names an item that the other file
defines. Re-exports are followed to the defining file. These do not count as imports: `mod` lines,
a `pub use` of a name from below the same module that the file itself does not need, everything
under `#[cfg(test)]`, comments, strings. Crates may not form a circle by dev-dependencies either.
"""

import json
import re
import subprocess
import sys
from pathlib import Path

TOKEN = re.compile(
    r"""(?P<space>\s+|//[^\n]*)
    | (?P<block>/\*)
    | (?P<raw>(?:br|cr|r)(?P<hashes>\#*)"(?P<raw_text>.*?)"(?P=hashes))
    | (?P<str>[bc]?"(?P<text>(?:\\.|[^"\\])*)")
    | (?P<char>b?'(?:\\(?:u\{[^}]*\}|x..|.)|[^'\\])')
    | (?P<lifetime>'\w+)
    | (?P<word>(?:r\#)?[^\W\d]\w*)
    | (?P<number>\d\w*)
    | (?P<mark>::|.)""",
    re.VERBOSE | re.DOTALL,
)
ITEM_KEYWORDS = {"fn", "struct", "enum", "union", "trait", "type", "const", "static"}
OPENING, CLOSING = {"(", "[", "{"}, {")", "]", "}"}


def tokens_of(text):
    """The tokens of Rust source without comments, lifetimes and numbers; strings start with `"`."""
    found, at = [], 0
    while at < len(text):
        match = TOKEN.match(text, at)
        at = match.end()
        kind = match.lastgroup if match.lastgroup not in ("hashes", "raw_text", "text") else None
        if match["block"]:
            depth = 1
            while depth and (edge := re.compile(r"/\*|\*/").search(text, at)):
                depth += 1 if edge[0] == "/*" else -1
                at = edge.end()
        elif match["raw"] is not None:
            found.append('"' + match["raw_text"])
        elif match["str"] is not None:
            found.append('"' + match["text"])
        elif kind == "word":
            found.append(match["word"].removeprefix("r#"))
        elif kind == "mark":
            found.append(match["mark"])
        elif kind in ("char", "number"):
            found.append("0")
    return found


def is_word(token):
    return re.match(r"[^\W\d]", token) is not None


def after_group(tokens, start):
    """The index behind the bracket that closes the one at `start`."""
    depth = 0
    for at in range(start, len(tokens)):
        depth += (tokens[at] in OPENING) - (tokens[at] in CLOSING)
        if depth == 0:
            return at + 1
    return len(tokens)


def after_item(tokens, start):
    """The index behind the item, field or statement that begins at `start`."""
    at = start
    while at < len(tokens) and tokens[at] == "#":
        at = after_group(tokens, at + 1)
    while tokens[at : at + 1] == ["pub"]:
        at = after_group(tokens, at + 1) if tokens[at + 1] == "(" else at + 1
    ends_in_semicolon = tokens[at : at + 1] in (["use"], ["static"], ["type"], ["let"]) or (
        tokens[at : at + 1] == ["const"] and tokens[at + 1 : at + 2] not in (["fn"], ["unsafe"])
    )
    while at < len(tokens):
        if tokens[at] in (";", ","):
            return at + 1
        if tokens[at] in CLOSING:
            return at
        if tokens[at] in OPENING:
            is_body = tokens[at] == "{"
            at = after_group(tokens, at)
            if is_body and not ends_in_semicolon:
                return at
        else:
            at += 1
    return at


def use_tree(tokens, at, prefix):
    """The leaves `(path, alias)` of the use tree at `at`, and the index behind it."""
    leaves, path = [], list(prefix)
    while at < len(tokens):
        token = tokens[at]
        if token == "{":
            at += 1
            while tokens[at] != "}":
                inner, at = use_tree(tokens, at, path)
                leaves += inner
                at += tokens[at] == ","
            return leaves, at + 1
        if token == "*":
            return [(path, "*")], at + 1
        if token == "as":
            return [(path, tokens[at + 1])], at + 2
        if token == "::":
            if not path:
                path.append("::")
        elif is_word(token):
            if token == "self" and path:
                renamed = tokens[at + 1] == "as"
                return [(path, tokens[at + 2] if renamed else path[-1])], at + (3 if renamed else 1)
            path.append(token)
        else:
            break
        at += 1
    return [(path, path[-1])], at


class Module:
    """A module: its place, what it defines, what it brings into scope, the paths in its code."""

    def __init__(self, file, folder, parent):
        self.file, self.folder, self.parent = file, folder, parent
        self.children, self.items, self.bindings = {}, set(), {}
        self.globs, self.imports, self.paths, self.words = [], [], [], set()

    def root(self):
        return self.parent.root() if self.parent else self

    def is_within(self, other):
        return self is other or (self.parent is not None and self.parent.is_within(other))

    def resolve(self, path, seen=frozenset()):
        """What a path means here: modules, and pairs of a defining module and a name."""
        key = (id(self), tuple(path))
        if key in seen or not path:
            return []
        seen = seen | {key}
        first, rest = path[0], path[1:]
        if first in ("crate", "self", "super"):
            start = {"crate": self.root(), "self": self, "super": self.parent}[first]
            if start is None:
                return []
            return start.descend(rest, seen) if rest else [start]
        return [] if first == "::" else self.descend(path, seen, strict=True)

    def descend(self, path, seen, strict=False):
        """As `resolve`, but the first word is a name of this module, not of the language."""
        if path[0] in ("self", "super"):
            return self.resolve(path, seen)
        found = []
        for meant in self.look_up(path[0], seen, strict):
            if isinstance(meant, Module) and len(path) > 1:
                found += meant.descend(path[1:], seen)
            else:
                found.append(meant)
        return found

    def look_up(self, name, seen, strict):
        found = list(self.children.get(name, []))
        if name in self.items:
            found.append((self, name))
        for path in self.bindings.get(name, []):
            found += self.resolve(path, seen)
        if not found and name not in self.bindings:
            for path in self.globs:
                for place in self.resolve(path, seen):
                    if isinstance(place, Module) and ("glob", id(place), name) not in seen:
                        found += place.look_up(name, seen | {("glob", id(place), name)}, True)
            # An item that a macro makes has no definition to be seen: its module stands for it.
            if not found and not strict:
                found.append((self, name))
        return found


def read_module(file, folder, parent, modules):
    """Reads a file and, below it, the modules that its `mod` lines name."""
    tokens = tokens_of(file.read_text())
    module = Module(file, folder, parent)
    modules.append(module)
    open_modules = [(module, 0)]
    depth, at, path_attribute = 0, 0, None
    while at < len(tokens):
        token, following = tokens[at], tokens[at + 1 : at + 3]
        module, ground = open_modules[-1]
        if token == "#" and following[:1] in (["["], ["!"]):
            inner = following[0] == "!"
            behind = after_group(tokens, at + 1 + inner)
            attribute = tokens[at + 2 + inner : behind - 1]
            needs_test = "test" in attribute and not {"not", "any"} & set(attribute)
            if attribute[:1] == ["cfg"] and needs_test:
                if inner:
                    modules.remove(module)
                    return None
                behind = after_item(tokens, behind)
            elif attribute[:2] == ["path", "="]:
                path_attribute = attribute[2][1:]
            at = behind
        elif token == "use" and following[:1] != ["<"]:
            leaves, behind = use_tree(tokens, at + 1, [])
            before = tokens[at - 1] if at else ""
            is_public = before == "pub" or (before == ")" and depth == ground)
            for path, alias in leaves:
                if alias == "*":
                    module.globs.append(path)
                elif alias != "_":
                    module.bindings.setdefault(alias, []).append(path)
                module.imports.append((path, alias, is_public))
            at = behind
        elif token == "mod" and depth == ground and following[1:] == [";"]:
            name, path = following[0], path_attribute
            if path is not None:
                child_file = module.file.parent / path
            else:
                child_file = module.folder / f"{name}.rs"
                if not child_file.exists():
                    child_file = module.folder / name / "mod.rs"
            in_own_folder = path is not None or child_file.name == "mod.rs"
            child_folder = child_file.parent if in_own_folder else module.folder / name
            child = read_module(child_file, child_folder, module, modules)
            if child:
                module.children.setdefault(name, []).append(child)
            path_attribute = None
            at += 3
        elif token == "mod" and depth == ground and following[1:] == ["{"]:
            child = Module(module.file, module.folder / following[0], module)
            module.children.setdefault(following[0], []).append(child)
            modules.append(child)
            depth += 1
            open_modules.append((child, depth))
            at += 3
        elif token in ITEM_KEYWORDS and depth == ground and following and is_word(following[0]):
            name = following[1] if following[0] == "mut" else following[0]
            if name not in ITEM_KEYWORDS | {"unsafe", "extern", "async"}:
                module.items.add(name)
            at += 1 if name in ITEM_KEYWORDS else 2
        elif token == "macro_rules" and following[:1] == ["!"]:
            module.items.add(tokens[at + 2])
            at += 3
        elif is_word(token):
            path = [token]
            before = tokens[at - 1] if at else ""
            while tokens[at + 1 : at + 2] == ["::"] and is_word("".join(tokens[at + 2 : at + 3])):
                path.append(tokens[at + 2])
                at += 2
            if before not in (".", "::"):
                module.words.add(path[0])
                if len(path) > 1:
                    module.paths.append(path)
            at += 1
        else:
            depth += (token in OPENING) - (token in CLOSING)
            if depth < ground:
                open_modules.pop()
            at += 1
    return open_modules[0][0]


def imports_of(root_file):
    """All modules of the crate with this root, and by pair of files the names imported."""
    modules, edges = [], {}
    read_module(root_file, root_file.parent, None, modules)

    def note(module, meant):
        if isinstance(meant, tuple) and meant[0].file != module.file:
            edges.setdefault((module.file, meant[0].file), set()).add(meant[1])

    def is_re_export(module, alias, meant):
        own = [other for other in modules if other.file == module.file]
        below = isinstance(meant, tuple) and any(meant[0].is_within(other) for other in own)
        return below and not any(alias in other.words for other in own)

    for module in modules:
        for path, alias, is_public in module.imports:
            for meant in module.resolve(path):
                if alias == "*" and isinstance(meant, Module):
                    if not is_public:
                        for word in module.words - module.items - set(module.bindings):
                            for named in meant.look_up(word, frozenset(), strict=True):
                                note(module, named)
                elif not (is_public and is_re_export(module, alias, meant)):
                    note(module, meant)
        for path in module.paths:
            for meant in module.resolve(path):
                note(module, meant)
    return modules, edges


def circles(edges):
    """The strongly connected components of more than one node (Tarjan), each in sorted order."""
    nexts = {}
    for one, other in edges:
        nexts.setdefault(one, set()).add(other)
    order, low, stack, found = {}, {}, [], []

    def visit(node):
        order[node] = low[node] = len(order)
        stack.append(node)
        for other in sorted(nexts.get(node, ())):
            if other not in order:
                visit(other)
            if other in stack:
                low[node] = min(low[node], low[other])
        if low[node] == order[node]:
            members = stack[stack.index(node) :]
            del stack[stack.index(node) :]
            if len(members) > 1 or (node, node) in edges:
                found.append(sorted(members))

    for node in sorted(nexts):
        if node not in order:
            visit(node)
    return sorted(found)


def told(title, circle, edges):
    """The circle in words: each of its imports, with the names."""
    lines = [f"{title}: {len(circle)} members"]
    for (one, other), names in sorted(edges.items()):
        if one in circle and other in circle:
            lines.append(f"  {one} -> {other}: {', '.join(sorted(names))}")
    return "\n".join(lines)


def main():
    command = ["cargo", "metadata", "--no-deps", "--format-version", "1"]
    metadata = json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)
    top = Path(metadata["workspace_root"])
    findings, files, crate_edges = [], set(), {}
    names = {package["name"] for package in metadata["packages"]}
    for package in metadata["packages"]:
        for dependency in package["dependencies"]:
            if dependency["name"] in names:
                kind = dependency["kind"] or "normal"
                crate_edges.setdefault((package["name"], dependency["name"]), set()).add(kind)
        for target in package["targets"]:
            modules, edges = imports_of(Path(target["src_path"]))
            files |= {module.file for module in modules}
            short = {
                (one.relative_to(top), other.relative_to(top)): taken
                for (one, other), taken in edges.items()
            }
            title = f"import circle in {package['name']}, {target['kind'][0]} {target['name']}"
            findings += [told(title, circle, short) for circle in circles(short)]
    findings += [told("circle of crates", circle, crate_edges) for circle in circles(crate_edges)]
    print("\n".join(findings) or f"{len(files)} files of {len(names)} crates: no circle of imports")
    return 1 if findings or not files else 0


if __name__ == "__main__":
    sys.exit(main())
