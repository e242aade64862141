// The film of the page: its text, its tiles, its numbers, the gestures that change them, and their history.

import { EngineError } from "#engine";

/** @typedef {import("#symmetry").Tile} Tile */
/** @typedef {{ path: (string | number)[], value: any }} TextEdit */
/** @typedef {{ text: string, document: any, name: string, description: string | null, tiles: Tile[], sensors_mm: number[][],
 *   head_spacing_mm: number | null, volume: null | { lower_mm: number[], upper_mm: number[], reference_mm: number[] },
 *   brief: any, findings: string[] }} State */

export class Model {
  /** @param {import("#engine").Engine} engine @param {string} name */
  constructor(engine, name) {
    this.engine = engine;
    this.name = name;
    /** @type {State | null} The layout that was read last. */
    this.state = null;
    /** @type {Tile[]} Its tiles, with the changes of a gesture that goes on. */
    this.tiles = [];
    /** @type {any} Its numbers; `null` where it has none, for the reason in `unevaluated`. */
    this.evaluated = null;
    this.unevaluated = "";
    /** @type {any} The numbers that differences are counted from. */
    this.before = null;
    /** @type {null | { text: string, evaluated: any }} */
    this.pinned = null;
    /** @type {number | null} */
    this.selected = null;
    /** @type {Set<number>} Tiles that overlap, which are never kept. */
    this.overlapping = new Set();
    /** Whether gestures keep the symmetry of `[design]`. */
    this.isSymmetric = true;
    /** @type {Gesture | null} */
    this.gesture = null;
    /** @type {string[]} */
    this.texts = [];
    this.at = -1;
    this.message = "";
    /** @type {((model: Model) => void)[]} Called after every change. */
    this.listeners = [];
    /** @type {((model: Model) => void)[]} Called when a gesture has ended, or another layout was read. */
    this.restListeners = [];
    /** @type {Promise<any>} Requests follow each other. */
    this.last = Promise.resolve();
    this.waiting = 0;
    /** @type {(isBusy: boolean) => void} Called when requests begin, and when all are answered. */
    this.onBusy = () => {};
  }

  show() {
    for (const listener of this.listeners) listener(this);
  }

  /** @param {string} message */
  say(message) {
    this.message = message;
    this.show();
  }

  /** @param {number | null} tile */
  select(tile) {
    if (this.selected === tile) return;
    this.selected = tile;
    this.show();
  }

  get symmetry() {
    return this.isSymmetric ? (this.state?.brief?.symmetry ?? "none") : "none";
  }

  get step_mm() {
    return this.state?.brief?.resolution_mm ?? 0.001;
  }

  /** Works on the layout, one after the other. @template T @param {() => Promise<T>} work @returns {Promise<T>} */
  inTurn(work) {
    if (this.waiting++ === 0) this.onBusy(true);
    const done = this.last.then(work).finally(() => {
      if (--this.waiting === 0) this.onBusy(false);
    });
    this.last = done.catch(() => {});
    return done;
  }

  /** Reads a text. A broken one leaves the layout, and its message is shown. Whether it was read.
   * @param {string} text @param {{ remember?: boolean }} [how] @returns {Promise<boolean>} */
  open(text, { remember = true } = {}) {
    return this.inTurn(async () => {
      const isRead = await this.#try(async () => {
        this.#take(await this.engine.ask({ open: { text, name: this.name } }));
        this.message = "";
      });
      if (isRead) {
        if (remember) this.#remember();
        await this.#evaluate(false);
        this.before = this.pinned?.evaluated ?? this.evaluated;
      }
      this.show();
      if (isRead) this.#rest();
      return isRead;
    });
  }

  /** A gesture: steps that are shown at once, and are one step of the history.
   * @returns {Gesture} */
  begin() {
    this.gesture?.end();
    this.gesture = new Gesture(this);
    return this.gesture;
  }

  /** A gesture of one step. @param {Step} step */
  async change(step) {
    const gesture = this.begin();
    gesture.step(step);
    await gesture.end();
  }

  get canUndo() {
    return this.at > 0;
  }

  get canRedo() {
    return this.at + 1 < this.texts.length;
  }

  /** Goes back, or forth, in the history. @param {number} by */
  async go(by) {
    const at = Math.min(this.texts.length - 1, Math.max(0, this.at + by));
    if (at === this.at) return;
    this.at = at;
    await this.open(this.texts[at], { remember: false });
  }

  /** Pins the state that later ones are compared with; or unpins it. */
  pin() {
    this.pinned = this.pinned || !this.state ? null : { text: this.state.text, evaluated: this.evaluated };
    this.before = this.pinned?.evaluated ?? this.evaluated;
    this.show();
  }

  /** Exchanges the state and the pinned one. */
  async exchange() {
    if (!this.pinned || !this.state) return;
    const { text } = this.pinned;
    this.pinned = { text: this.state.text, evaluated: this.evaluated };
    await this.open(text);
  }

  /** @param {Step} step @returns {Promise<void>} */
  async apply({ tiles, edits }) {
    performance.mark("gesture");
    await this.#try(async () => {
      if (edits) this.#take(await this.engine.ask({ set: { edits } }));
      if (tiles) {
        const pairs = await this.engine.ask({ edit: { tiles } });
        this.overlapping = new Set(pairs.flatMap((/** @type {any} */ pair) => pair.tiles));
        this.tiles = [...this.tiles];
        for (const { tile, ...shape } of tiles) this.tiles[tile] = { ...this.tiles[tile], ...shape };
      }
      this.message = "";
      await this.#evaluate(true);
    });
    this.show();
    performance.measure("gesture", "gesture");
  }

  /** Keeps what a gesture changed, or goes back to the state before it.
   * @param {boolean} isChanged */
  async finish(isChanged) {
    if (!this.state || !isChanged) return;
    if (this.overlapping.size > 0) {
      await this.#try(async () => this.#take(await this.engine.ask({ open: { text: this.state?.text, name: this.name } })));
      await this.#evaluate(false);
      this.message = "Tiles overlapped: the change is not kept.";
    } else {
      const hadLattice = Boolean(this.state.document?.lattice);
      const isKept = await this.#try(async () => this.#take(await this.engine.ask("keep")));
      if (!isKept) await this.#try(async () => this.#take(await this.engine.ask({ open: { text: this.state?.text, name: this.name } })));
      await this.#evaluate(false);
      this.#remember();
      if (isKept && hadLattice && !this.state.document?.lattice) {
        this.message = `The lattice is written as ${this.tiles.length} tiles now, and its cut lines are gone. Undo restores it.`;
      }
    }
    this.show();
    this.#rest();
  }

  #rest() {
    for (const listener of this.restListeners) listener(this);
  }

  #remember() {
    if (!this.state || this.texts[this.at] === this.state.text) return;
    this.texts = [...this.texts.slice(0, this.at + 1), this.state.text];
    this.at = this.texts.length - 1;
  }

  /** @param {State} state */
  #take(state) {
    const name = this.selected === null ? null : this.tiles[this.selected]?.name;
    this.state = state;
    this.tiles = state.tiles;
    this.overlapping = new Set();
    const index = state.tiles.findIndex((tile) => tile.name === name);
    this.selected = index < 0 ? null : index;
  }

  /** @param {boolean} rigid */
  async #evaluate(rigid) {
    try {
      this.evaluated = await this.engine.ask({ evaluate: { rigid } });
      this.unevaluated = "";
    } catch (error) {
      if (!(error instanceof EngineError)) throw error;
      this.evaluated = null;
      this.unevaluated = error.message;
    }
  }

  /** Whether the work was done; otherwise its message is shown. @param {() => Promise<void>} work */
  async #try(work) {
    try {
      await work();
      return true;
    } catch (error) {
      if (!(error instanceof EngineError)) throw error;
      this.message = error.message;
      return false;
    }
  }
}

/** @typedef {{ tiles?: any[], edits?: TextEdit[] }} Step changes of tiles, or values set in the text */

export class Gesture {
  /** @param {Model} model */
  constructor(model) {
    this.model = model;
    this.origin = model.tiles;
    this.text = model.state?.text ?? "";
    model.before = model.pinned?.evaluated ?? model.evaluated;
    /** @type {Step | null} */
    this.pending = null;
    this.isChanged = false;
    this.isEnded = false;
    /** @type {Promise<void> | null} */
    this.running = null;
  }

  /** Shows a step. Steps that come while one is computed replace each other. @param {Step} step */
  step(step) {
    if (this.isEnded) return;
    this.pending = step;
    this.isChanged = true;
    this.running ??= this.model.inTurn(async () => {
      while (this.pending) {
        const next = this.pending;
        this.pending = null;
        await this.model.apply(next);
      }
      this.running = null;
    });
  }

  /** Ends the gesture without a change. */
  async cancel() {
    if (this.isEnded) return;
    this.isEnded = true;
    this.pending = null;
    await this.running;
    if (this.model.gesture === this) this.model.gesture = null;
    if (this.isChanged) await this.model.open(this.text, { remember: false });
    else this.model.show();
  }

  /** Ends the gesture: its result is kept if it breaks no rule. */
  async end() {
    if (this.isEnded) return;
    await this.running;
    this.isEnded = true;
    if (this.model.gesture === this) this.model.gesture = null;
    await this.model.inTurn(() => this.model.finish(this.isChanged));
    if (!this.isChanged) this.model.show();
  }
}
