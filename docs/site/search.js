// SPDX-License-Identifier: Apache-2.0
// Search over all sections of the site. Every word must be there; a heading counts more than text, a whole word more than a part.
// @ts-check

/** @typedef {[address: string, page: string, heading: string, text: string]} Section */

const most = 30;

/** @param {string} text */
const folded = (text) => text.normalize("NFKD").replace(/[\u0300-\u036f]/g, "").toLowerCase();

/** How much a page is worth by its kind: what is looked up before what was decided once. @param {string} address */
function worthOf(address) {
  if (/^CHANGELOG|^tests\/|\/decisions\//.test(address)) return 0.4;
  return /^docs\/(reference|how-to|tutorial)\//.test(address) ? 1.5 : 1;
}

/** @param {string} field @param {string} word */
function places(field, word) {
  const found = [];
  for (let at = field.indexOf(word); at >= 0; at = field.indexOf(word, at + word.length)) found.push(at);
  return found;
}

/**
 * How well a section answers; 0: not at all.
 * @param {Section} section @param {string[]} words
 */
function scoreOf(section, words) {
  const [address, page, heading, text] = section.map(folded);
  // In a long text a word says less about what it is on.
  const density = 1 / (1 + text.length / 2000);
  let score = 0;
  for (const word of words) {
    let best = 0;
    for (const [field, worth] of /** @type {[string, number][]} */ ([[heading, 20], [page, 8], [text, 4 * density]])) {
      const found = places(field, word);
      if (found.length === 0) continue;
      const whole = found.some((at) => !/[\p{L}\p{N}_]/u.test((field[at - 1] ?? " ") + (field[at + word.length] ?? " ")));
      best = Math.max(best, worth * (whole ? 2 : 1) * Math.min(3, Math.sqrt(found.length)));
    }
    if (best === 0) return 0;
    score += best;
  }
  const phrase = words.join(" ");
  if (words.length > 1 && (heading.includes(phrase) || text.includes(phrase))) score *= 2;
  return score * worthOf(address);
}

/**
 * The best sections, the best first.
 * @param {Section[]} sections @param {string} question
 */
function search(sections, question) {
  const words = folded(question).split(/\s+/).filter(Boolean);
  if (words.length === 0) return [];
  return sections
    .map((section) => ({ section, score: scoreOf(section, words) }))
    .filter((found) => found.score > 0)
    .sort((a, b) => b.score - a.score)
    .slice(0, most)
    .map((found) => found.section);
}

/** The text around the first word. @param {string} text @param {string} question */
function around(text, question) {
  const at = Math.max(0, folded(text).indexOf(folded(question).split(/\s+/).filter(Boolean)[0] ?? ""));
  return (at > 60 ? "… " : "") + text.slice(Math.max(0, at - 60), at + 140) + (text.length > at + 140 ? " …" : "");
}

function start() {
  const own = /** @type {HTMLScriptElement} */ (document.querySelector("script[data-up]"));
  const words = /** @type {HTMLInputElement} */ (document.getElementById("words"));
  const place = /** @type {HTMLElement} */ (document.getElementById("found"));
  const show = () => {
    const question = words.value;
    const found = search(/** @type {any} */ (globalThis).kerfbenchPages ?? [], question);
    place.hidden = question.trim() === "";
    const list = document.createElement("ol");
    for (const [address, page, heading, text] of found) {
      const link = document.createElement("a");
      link.href = own.dataset.up + address;
      link.textContent = heading === page ? page : `${page}: ${heading}`;
      const words_around = document.createElement("small");
      words_around.textContent = around(text, question);
      const item = document.createElement("li");
      item.append(link, words_around);
      list.append(item);
    }
    place.replaceChildren(found.length === 0 ? "Nothing has all of these words." : list);
  };
  words.addEventListener("input", show);
  document.getElementById("search")?.addEventListener("submit", (event) => {
    event.preventDefault();
    place.querySelector("a")?.click();
  });
  document.addEventListener("keydown", (event) => {
    if (event.key === "/" && document.activeElement !== words) {
      event.preventDefault();
      words.focus();
    } else if (event.key === "Escape" && document.activeElement === words) {
      words.value = "";
      show();
    }
  });
}

if (typeof document === "undefined") module.exports = { search };
else start();
