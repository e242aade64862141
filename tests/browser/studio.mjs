// `magsplice studio` in a browser: the page and an editor keep one file.
// Usage: node studio.mjs PROGRAM BROWSER FOLDER
// The layout is written into FOLDER.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { readFileSync, renameSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import { createInterface } from "node:readline";

import { changeFilm, checkAccess, gestureTimes, opened as openedFilm } from "./live_film.mjs";

const { chromium } = createRequire(import.meta.url)("playwright-core");
const [program, executablePath, folder] = process.argv.slice(2);
const layout = "layouts/designed-displacement.toml";
const PATIENCE_MS = 20_000;
// An edit in the editor shows within this time.
const PROMPT_MS = 200;

const file = join(folder, "film.toml");
const comment = "# A comment of the editor.\n";
const original = comment + readFileSync(layout, "utf8");
writeFileSync(file, original);
writeFileSync(join(folder, "published-film.toml"), readFileSync("layouts/published-film.toml").toString().replace(/^field = .*\n/m, ""));
async function served(name) {
  const server = spawn(program, ["studio", name, "--quiet"], { cwd: folder, stdio: ["ignore", "pipe", "inherit"] });
  const url = await new Promise((resolve) => createInterface(server.stdout).once("line", resolve));
  return { server, url };
}
const { server, url } = await served("film.toml");
const published = await served("published-film.toml");
const browser = await chromium.launch({ executablePath, args: ["--no-sandbox"] });

const failures = [];
async function opened(prepare = async () => {}) {
  const page = await browser.newPage();
  page.on("pageerror", (error) => failures.push(String(error)));
  page.on("console", (message) => message.type() === "error" && failures.push(message.text()));
  page.on("request", (request) => {
    if (!request.url().startsWith(url) && !/^(data|blob):/.test(request.url())) failures.push(request.url());
  });
  page.setDefaultTimeout(PATIENCE_MS);
  await prepare(page);
  await page.goto(url);
  await page.waitForSelector("html[data-ready=true]");
  return page;
}
const named = (name) => original.replace(/^name = .*$/m, `name = "${name}"`);
const titled = (page, name) => page.waitForFunction((name) => document.getElementById("title").textContent === name, name);
// An editor that replaces the file.
const save = (text) => {
  writeFileSync(`${file}~`, text);
  renameSync(`${file}~`, file);
};
async function until(holds, what) {
  const begun = Date.now();
  while (!holds()) {
    assert(Date.now() - begun < PATIENCE_MS, what);
    await new Promise((resolve) => setTimeout(resolve, 10));
  }
}
// Chooses the first tile and moves it by a step.
async function move(page, key) {
  await page.focus("[role=listbox]");
  await page.keyboard.press("Home");
  await page.keyboard.press(key);
}

try {
  const page = await opened();
  const tiles = await page.locator("[role=option]").count();
  assert(tiles > 0, "no tiles");

  // An edit in the editor shows in the page. The fastest of five: other work may take the processors.
  const times = [];
  for (const name of ["one", "two", "three", "four", "five"]) {
    const shown = page.evaluate(
      (name) =>
        new Promise((resolve) => {
          const title = document.getElementById("title");
          const observer = new MutationObserver(() => {
            if (title.textContent !== name) return;
            observer.disconnect();
            requestAnimationFrame(() => resolve(Date.now()));
          });
          observer.observe(title, { childList: true, characterData: true, subtree: true });
        }),
      name,
    );
    // The observer is there before the file is saved.
    await page.evaluate(() => {});
    const begun = Date.now();
    save(named(name));
    times.push((await shown) - begun);
  }
  assert(Math.min(...times) <= PROMPT_MS, `an edit takes ${times.join(", ")} ms`);

  // A broken layout shows its message, and the last good film stays.
  save("format = ");
  await page.waitForFunction(() => document.getElementById("file").textContent.includes("the last good film stays"));
  assert.match(await page.locator("#message").textContent(), /TOML parse error at line 1/);
  assert.equal(await page.locator("[role=option]").count(), tiles);
  // A gesture does not replace the broken text unasked.
  await move(page, "ArrowRight");
  await page.locator("dialog").waitFor();
  assert.equal(readFileSync(file, "utf8"), "format = ");
  await page.getByRole("button", { name: "Take the file" }).click();
  await page.locator("dialog").waitFor({ state: "detached" });
  save(named("mended"));
  await titled(page, "mended");
  await page.waitForFunction(() => document.getElementById("message").hidden);

  // A gesture goes to the file, with its comments, and to another page.
  const other = await opened();
  await titled(other, "mended");
  await move(page, "ArrowRight");
  await until(() => readFileSync(file, "utf8") !== named("mended"), "the gesture is not written");
  const written = readFileSync(file, "utf8");
  assert(written.startsWith(comment), written);
  await page.waitForFunction(() => document.getElementById("file").textContent.includes("saved"));
  await other.waitForFunction(() => document.getElementById("file").textContent.startsWith("as in"));

  // A file that changed on both sides: the page asks. Here it hears of no changes of the file.
  const deaf = await opened((page) => page.route("**/events", (route) => route.abort()));
  save(named("edited"));
  await titled(page, "edited");
  await move(deaf, "ArrowLeft");
  await deaf.locator("dialog").waitFor();
  assert.equal(readFileSync(file, "utf8"), named("edited"));
  await deaf.getByRole("button", { name: "Take the file" }).click();
  await titled(deaf, "edited");
  await deaf.close();
  assert.equal(readFileSync(file, "utf8"), named("edited"));

  // The failures of `deaf` alone: it had no events, and its text was not written.
  assert.deepEqual(failures.filter((failure) => !/net::ERR_FAILED|409 \(Conflict\)/.test(failure)), []);
  server.kill("SIGINT");
  const status = await new Promise((resolve) => server.once("exit", resolve));
  assert.equal(status, 0);
  await page.waitForFunction(() => document.getElementById("file").textContent.includes("start `magsplice studio` again"));

  // The program answers as the module in a page does: everything that changes a film.
  const context = await browser.newContext({ viewport: { width: 1280, height: 1000 }, acceptDownloads: true });
  const film = await openedFilm(context, published.url);
  await changeFilm(film);
  await checkAccess(film);
  console.log(`studio: a gesture takes ${(await gestureTimes(film)).toFixed(1)} ms (median)`);
  console.log(`studio: an edit of ${layout} shows after ${Math.min(...times)} ms (${times.join(", ")} ms)`);
} finally {
  for (const { server: each } of [{ server }, published]) each.kill("SIGKILL");
  await browser.close();
}
