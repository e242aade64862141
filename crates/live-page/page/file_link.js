// The file behind a page that `magsplice studio` serves: gestures go to it, and its changes come here.

import { element } from "#format";

/** @typedef {import("#model").Model} Model */

/** @param {Model} model @param {HTMLElement} place where the state of the file is shown
 * @param {string} delivered the text of the file that came with the page */
export async function linkFile(model, place, delivered) {
  const status = element("span", { class: "file", role: "status" });
  place.append(status);
  /** Hash of the file as this page knows it. @type {string} */
  let base = "";
  /** The text of this page when it was last in step with the file. */
  let known = "";
  /** The text of the file while it is broken, and this page shows the film before. @type {string | null} */
  let broken = null;
  let isAsking = false;
  /** @type {Promise<void>} Writes follow each other. */
  let last = Promise.resolve();
  const tell = (/** @type {string} */ text, isBroken = false) => {
    status.textContent = text;
    status.classList.toggle("broken", isBroken);
  };

  /** @param {string} text */
  async function write(text) {
    const body = JSON.stringify({ text, base });
    const response = await fetch("file", { method: "POST", body, headers: { "content-type": "application/json" } });
    const answer = await response.json();
    if (response.ok) {
      [base, known, broken] = [answer.sha256, text, null];
      tell(`saved in ${model.name}`);
    } else if (response.status === 409) {
      await decide(answer);
    } else {
      tell(answer.error ?? "the file cannot be written", true);
    }
  }

  /** The file and the page differ: the user decides. @param {{ text: string, sha256: string }} file */
  async function decide(file) {
    if (isAsking) return;
    isAsking = true;
    const dialog = element("dialog", { "aria-labelledby": "conflict" });
    const choose = (/** @type {string} */ value, /** @type {string} */ text) => element("button", { type: "button", onclick: () => dialog.close(value) }, text);
    dialog.append(
      element("h2", { id: "conflict" }, broken === null ? "The file has changed on both sides" : "The file is broken"),
      element("p", {}, broken === null ? `${model.name} was changed elsewhere while this page has changes of its own.` : `${model.name} was changed elsewhere and breaks a rule. Writing the film of this page replaces that text.`),
      element("div", { class: "buttons" }, choose("file", "Take the file"), choose("page", "Write the film of this page")),
    );
    document.body.append(dialog);
    dialog.showModal();
    const choice = await new Promise((resolve) => dialog.addEventListener("close", () => resolve(dialog.returnValue)));
    dialog.remove();
    isAsking = false;
    if (choice === "page" && model.state) {
      base = file.sha256;
      await write(model.state.text);
    } else if (choice === "file") {
      await take(file);
    } else {
      tell(`the film of this page is not in ${model.name}`, true);
    }
  }

  /** Reads the text of the file. @param {{ text: string, sha256: string }} file */
  async function take(file) {
    [base, known] = [file.sha256, file.text];
    const isRead = await model.open(file.text);
    broken = isRead ? null : file.text;
    // The film before the broken one is no change of this page.
    if (!isRead) known = model.state?.text ?? "";
    tell(isRead ? `as in ${model.name}` : `${model.name} is broken: the last good film stays`, !isRead);
  }

  const events = new EventSource("events");
  events.addEventListener("message", async ({ data }) => {
    const file = JSON.parse(data);
    if (file.error) return tell(file.error, true);
    if (file.sha256 === base) return;
    await last;
    // What the page wrote comes back as a change.
    if (file.sha256 === base) return;
    // Whether it is mended shows when it is read.
    if (file.text !== broken) broken = null;
    const isOwn = model.gesture !== null || (model.state && model.state.text !== known);
    await (isOwn ? decide(file) : take(file));
  });
  events.addEventListener("error", () => tell("the program does not answer: start `magsplice studio` again", true));
  events.addEventListener("open", () => tell(`Every change is saved in ${model.name} at once; Undo takes it back.`));

  const response = await fetch("file");
  const file = await response.json();
  [base, known] = [file.sha256, file.text];
  // It may have changed since the page was delivered.
  if (file.text !== delivered) await take(file);
  model.restListeners.push(() => {
    const text = model.state?.text;
    if (text === undefined || text === known) return;
    // A broken text may be half an edit: it is not replaced unasked.
    const work = () => (broken === null ? write(text) : decide({ text: broken, sha256: base }));
    last = last.then(work).catch(() => tell("the program does not answer", true));
  });
}
