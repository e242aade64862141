// The engine of the page against the program: node page_engine.mjs MODULE PACKED PROGRAM LAYOUT...
// The module imports nothing, its numbers are those of the program, and hostile requests leave it usable.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync, statSync } from "node:fs";

// The program computes with fused multiplications, the module without: round-off differs. The text of the program has
// six decimals.
const ROUND_OFF = 1e-11;

const [module, packed, program, ...layouts] = process.argv.slice(2);
const code = readFileSync(module);
const { instance, module: compiled } = await WebAssembly.instantiate(code, {});
assert.deepEqual(WebAssembly.Module.imports(compiled), []);
const { reserve, answer, address, memory } = instance.exports;

function ask(request) {
    const bytes = new TextEncoder().encode(typeof request === "string" ? request : JSON.stringify(request));
    // Room for it may move the memory.
    const at = reserve(bytes.length);
    new Uint8Array(memory.buffer, at, bytes.length).set(bytes);
    const length = answer();
    return JSON.parse(new TextDecoder().decode(new Uint8Array(memory.buffer, address(), length)));
}

// The numbers that differ by more than round-off. Places of extremes are left out: by symmetry there are several.
function differing(known, found, path = "") {
    if (typeof known === "number") {
        const scale = Math.max(Math.abs(known), 1e-3);
        return Math.abs(known - found) <= ROUND_OFF * scale ? [] : [`${path}: ${known}, not ${found}`];
    }
    if (known === null || typeof known !== "object") return [];
    const keys = Object.keys(known).filter((key) => !/_at|index|location|place/.test(key));
    return keys.flatMap((key) => differing(known[key], found?.[key], `${path}/${key}`));
}

assert.match(ask({ evaluate: { rigid: true } }).error, /no layout is open/);
let compared = 0;
for (const layout of layouts) {
    const text = readFileSync(layout, "utf8");
    const opened = ask({ open: { text, name: layout } });
    assert.ok(opened.ok, `${layout}: ${opened.error}`);
    const { ok: found, error } = ask({ evaluate: { rigid: false } });
    if (error) {
        assert.match(error, /has no \[(ideal|volume)\] table/, layout);
        continue;
    }
    const known = JSON.parse(execFileSync(program, ["decouple", layout, "--format", "json"]));
    const { displacement_rmse_mm, uniformity_rmse, comparison, ideal_rmse } = known;
    const numbers = { displacement_rmse_mm, uniformity_rmse, comparison, ideal_rmse };
    assert.deepEqual(differing(numbers, found.evaluation), [], layout);
    compared += 1;
}
assert.ok(compared > 20, `${compared} layouts compared`);

// A tile that is dragged, and every request that a page should not send.
const film = readFileSync("layouts/published-film.toml", "utf8");
for (const hostile of ["", "null", "{", '{"edit":{"tiles":[{"tile":-1}]}}', `{"open":{"text":"${"[".repeat(9999)}","name":"x"}}`]) {
    assert.ok(ask(hostile).error, hostile.slice(0, 40));
}
assert.ok(ask({ open: { text: film, name: "published film" } }).ok);
const times = [];
for (let step = 0; step < 101; step += 1) {
    const begun = performance.now();
    ask({ edit: { tiles: [{ tile: 3, position_mm: [-9.575, 7.4 + 0.01 * (step % 9), 0.5] }] } });
    assert.ok(ask({ evaluate: { rigid: true } }).ok);
    times.push(performance.now() - begun);
}
times.sort((a, b) => a - b);
const [size, bytes] = [module, packed].map((file) => statSync(file).size);
console.log(
    `${compared} layouts agree with the program; a drag takes ${times[50].toFixed(1)} ms (median); the module has ` +
        `${(size / 1e6).toFixed(1)} MB, ${(bytes / 1e6).toFixed(2)} MB compressed`,
);
// A frame is 16 ms.
assert.ok(times[50] < 3 * 16, `a drag takes ${times[50]} ms`);
// The page of the published film stays below 1.2 MB.
assert.ok(bytes < 0.81e6, `${bytes} bytes compressed`);
