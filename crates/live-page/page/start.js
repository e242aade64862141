// The page: its parts, its engine, and the layout that it begins with.

import { showCauses } from "#causes";
import { showCurves } from "#curves";
import { showCutList } from "#cut_list";
import { moduleEngine, serverEngine, unpackedModule, workerEngine } from "#engine";
import { linkFile } from "#file_link";
import { showFilm } from "#film_view";
import { element, set } from "#format";
import { showImprove } from "#improve";
import { textIn } from "#link";
import { showMap } from "#map_view";
import { Model } from "#model";
import { showResults } from "#results";
import { showSurroundings } from "#surroundings";
import { showTileList } from "#tile_list";
import { showToolbar } from "#toolbar";

const part = (/** @type {string} */ id) => /** @type {HTMLElement} */ (document.getElementById(id));

async function start() {
  const source = JSON.parse(part("source").textContent ?? "{}");
  const isServed = source.engine === "server";
  const module = isServed ? null : await unpackedModule((part("module").textContent ?? "").trim());
  part("module").remove();
  const engine = module ? moduleEngine(module) : serverEngine();
  const newEngine = () => (module ? workerEngine(module) : serverEngine());
  const model = new Model(engine, source.name);

  model.onBusy = (isBusy) => set(part("main"), { "aria-busy": String(isBusy) });
  const message = part("message");
  model.listeners.push(() => {
    message.textContent = model.message;
    set(message, { hidden: model.message === "" });
    if (!model.state) return;
    part("title").textContent = model.state.name;
    part("description").textContent = model.state.description ?? "";
    part("findings").replaceChildren(...model.state.findings.map((finding) => element("li", {}, finding)));
  });
  const film = showFilm(model, part("film"));
  showToolbar(model, part("toolbar"), film, isServed);
  showImprove(model, part("toolbar"), newEngine);
  showResults(model, part("results"));
  showCurves(model, part("results"));
  showCauses(model, part("causes"), newEngine);
  showSurroundings(model, part("surroundings"));
  showTileList(model, part("tiles"));
  showCutList(model, part("tiles"));
  showMap(model, part("map"));

  const linked = isServed ? null : await textIn(location.hash);
  await model.open(source.text);
  if (linked !== null && linked !== source.text) await model.open(linked);
  if (isServed) await linkFile(model, part("file"), source.text);
  performance.mark("ready");
  document.documentElement.dataset.ready = "true";
}

start().catch((error) => {
  const message = part("message");
  message.hidden = false;
  message.textContent = `The page needs a browser with WebAssembly and DecompressionStream: ${error.message}`;
});
