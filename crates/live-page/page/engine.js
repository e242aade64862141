// Engines answer requests for numbers: a WebAssembly module in the page or in a worker, or a server.

/** @typedef {{ ask(request: any, observe?: (line: any) => void): Promise<any>, close(): void }} Engine */

/** A request that has no answer: a rule that the layout breaks, for example. */
export class EngineError extends Error {}

/** @param {string} text @returns {any} */
function answerIn(text) {
  const answer = JSON.parse(text);
  if (answer.error !== undefined) throw new EngineError(answer.error);
  return answer.ok;
}

/** Answers of a module, as JSON text. It needs nothing around it, so that a worker can have its source.
 * @param {WebAssembly.Module} module @returns {(request: string) => string} */
function answering(module) {
  const load = () => /** @type {any} */ (new WebAssembly.Instance(module, {}).exports);
  let { reserve, answer, address, memory } = load();
  return (request) => {
    try {
      const bytes = new TextEncoder().encode(request);
      // Room for the request may move the memory.
      const at = reserve(bytes.length);
      new Uint8Array(memory.buffer, at, bytes.length).set(bytes);
      const length = answer();
      return new TextDecoder().decode(new Uint8Array(memory.buffer, address(), length));
    } catch (error) {
      // A module that stopped is in no known state.
      ({ reserve, answer, address, memory } = load());
      return JSON.stringify({ error: `the engine stopped: ${error}` });
    }
  };
}

/** The module of a page. @param {string} base64 its bytes, compressed by xz @returns {Promise<WebAssembly.Module>} */
export async function unpackedModule(base64) {
  const packed = Uint8Array.from(atob(base64), (character) => character.charCodeAt(0));
  // A library beside the modules of the page: browsers unpack only formats that are a third larger.
  const { XzReadableStream } = /** @type {any} */ (globalThis)["xz-decompress"];
  const stream = new XzReadableStream(new Blob([packed]).stream());
  return WebAssembly.compile(await new Response(stream).arrayBuffer());
}

/** An engine in the page, which answers at once. @param {WebAssembly.Module} module @returns {Engine} */
export function moduleEngine(module) {
  const answer = answering(module);
  return { ask: async (request) => answerIn(answer(JSON.stringify(request))), close() {} };
}

/** An engine in a worker, for work that takes longer than a frame. Closing it ends the work.
 * @param {WebAssembly.Module} module @returns {Engine} */
export function workerEngine(module) {
  const source = `${answering}
    let answer;
    onmessage = ({ data }) => {
      if (data instanceof WebAssembly.Module) answer = answering(data);
      else postMessage(answer(data));
    };`;
  const url = URL.createObjectURL(new Blob([source], { type: "text/javascript" }));
  const worker = new Worker(url);
  worker.postMessage(module);
  /** @type {{ resolve: (answer: any) => void, reject: (error: Error) => void }[]} */
  const waiting = [];
  worker.onmessage = ({ data }) => {
    const first = waiting.shift();
    if (!first) return;
    try {
      first.resolve(answerIn(data));
    } catch (error) {
      first.reject(/** @type {Error} */ (error));
    }
  };
  worker.onerror = (event) => {
    for (const { reject } of waiting.splice(0)) reject(new EngineError(`the worker stopped: ${event.message}`));
  };
  return {
    ask: (request) =>
      new Promise((resolve, reject) => {
        waiting.push({ resolve, reject });
        worker.postMessage(JSON.stringify(request));
      }),
    close() {
      worker.terminate();
      URL.revokeObjectURL(url);
      for (const { reject } of waiting.splice(0)) reject(new EngineError("stopped"));
    },
  };
}

/** An engine in the program that serves the page. Each has its own layout. @returns {Engine} */
export function serverEngine() {
  const client = crypto.randomUUID();
  const closed = new AbortController();
  return {
    async ask(request, observe) {
      const body = JSON.stringify(request);
      const headers = { "content-type": "application/json" };
      let text;
      try {
        const response = await fetch(`engine?client=${client}`, { method: "POST", body, headers, signal: closed.signal });
        text = await response.text();
        if (!response.ok) throw new EngineError(text || `the program refused the request: ${response.status}`);
      } catch (error) {
        if (error instanceof EngineError) throw error;
        throw new EngineError(closed.signal.aborted ? "stopped" : "the program does not answer: start `magsplice studio` again");
      }
      const lines = text.trimEnd().split("\n");
      for (const line of lines.slice(0, -1)) observe?.(JSON.parse(line).progress);
      return answerIn(lines[lines.length - 1]);
    },
    close: () => closed.abort(),
  };
}
