// A link that holds the layout: its text, compressed, after the # of the address.

const KEY = "#layout=";

/** @param {ReadableStream} stream @returns {Promise<Uint8Array>} */
const bytesOf = async (stream) => new Uint8Array(await new Response(stream).arrayBuffer());

/** @param {string} text @returns {Promise<string>} what follows the address of the page */
export async function fragmentOf(text) {
  const packed = await bytesOf(new Blob([text]).stream().pipeThrough(new CompressionStream("deflate-raw")));
  let binary = "";
  for (const byte of packed) binary += String.fromCharCode(byte);
  return KEY + btoa(binary).replace(/\+/g, "-").replace(/\//g, "_").replace(/=+$/, "");
}

// A layout of a thousand tiles has 100 kB; a fragment that unpacks to far more is no layout.
const MOST_BYTES = 4e6;

/** The layout of a fragment; `null` if it holds none. @param {string} fragment @returns {Promise<string | null>} */
export async function textIn(fragment) {
  if (!fragment.startsWith(KEY)) return null;
  try {
    const binary = atob(fragment.slice(KEY.length).replace(/-/g, "+").replace(/_/g, "/"));
    const packed = Uint8Array.from(binary, (character) => character.charCodeAt(0));
    const reader = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate-raw")).getReader();
    const parts = [];
    for (let size = 0; ; ) {
      const { done, value } = await reader.read();
      if (done) break;
      size += value.length;
      if (size > MOST_BYTES) return null;
      parts.push(value);
    }
    return await new Blob(parts).text();
  } catch {
    return null;
  }
}
