// Work that takes longer than a frame, on an engine of its own.

export class Background {
  /** @param {() => import("#engine").Engine} newEngine */
  constructor(newEngine) {
    this.newEngine = newEngine;
    /** @type {import("#engine").Engine | null} */
    this.engine = null;
  }

  get isRunning() {
    return this.engine !== null;
  }

  /** Works on a layout. Earlier work ends without a result. @template T
   * @param {{ text: string, name: string }} layout @param {(engine: import("#engine").Engine) => Promise<T>} work
   * @returns {Promise<T>} */
  async run({ text, name }, work) {
    this.stop();
    const engine = this.newEngine();
    this.engine = engine;
    try {
      await engine.ask({ open: { text, name } });
      return await work(engine);
    } finally {
      engine.close();
      if (this.engine === engine) this.engine = null;
    }
  }

  stop() {
    this.engine?.close();
    this.engine = null;
  }
}
