// SPDX-License-Identifier: Apache-2.0
// @ts-check
// The page that shows a trace: the one of its address, `/view?trace=PATH#t=SECONDS`, that of a run that goes on, `/view?run=ID`, or a
// file that is dropped into it.

import { mountLive } from '../live.js';
import { getJson } from '../shared/api.js';
import { h, fill } from '../shared/dom.js';
import { whenWords } from '../job/earlier.js';
import { verdictKind } from '../job/run.js';
import { keepHash, mountViewer, timeOfHash } from './mount.js';
import { choicesOf } from './offer.js';

const element = /** @type {HTMLElement} */ (document.getElementById('view'));
/** Traces that are listed. */
const kMostTraces = 40;
/** @type {{close: () => void} | undefined} */
let shown;

/** @param {import('./mount.js').Source} source */
async function show(source) {
  shown?.close();
  shown = undefined;
  try {
    const viewer = await mountViewer(element, source);
    const stop = keepHash(viewer);
    shown = { close: () => { stop(); viewer.close(); } };
  } catch (fault) {
    offer(/** @type {Error} */ (fault).message);
  }
}

/** Traces of the folder as links. @param {Element} list */
async function listTraces(list) {
  const choices = choicesOf(await getJson('/api/files'));
  if (choices.length === 0) {
    fill(list, h('p', { class: 'mute' }, 'This folder has no trace yet. Each run that is started on the page Job leaves one in its results.'));
    return;
  }
  const shown = choices.slice(0, kMostTraces);
  fill(
    list,
    h('h2', {}, 'Traces of this folder, the newest first'),
    h('ul', { class: 'tv-traces' }, shown.map(({ path, title, verdict, when }) => h('li', {},
      h('a', { href: `/view?trace=${encodeURIComponent(path)}`, title: path }, title),
      h('span', { class: `tv-verdict ${verdictKind(verdict)}` }, verdict || 'no verdict'),
      h('time', { datetime: when || null }, when ? whenWords(when) : '')))),
    choices.length > shown.length ? h('p', { class: 'mute' }, `${choices.length - shown.length} older ones are not listed: they are in the folder results.`) : null,
  );
}

/** What there is to look at, and a place to drop a trace. @param {string} [fault] */
function offer(fault) {
  const input = h('input', { type: 'file', accept: '.mcap,.part', class: 'visually-hidden', tabindex: -1, 'aria-hidden': 'true',
    on: { change: () => input.files?.[0] && void show({ trace: input.files[0], name: input.files[0].name }) } });
  const list = h('div', { class: 'tv-offer-list', 'aria-busy': 'true' }, h('p', { role: 'status' }, 'Looking for traces …'));
  fill(element, h('div', { class: 'tv-offer' }, h('h1', {}, 'Trace'), fault ? h('p', { class: 'fault', role: 'alert' }, `The trace cannot be shown: ${fault}`) : null,
    list,
    h('div', { class: 'tv-drop' }, h('p', {}, 'Or drop a trace here (run.mcap of a results folder). It stays on this computer.'),
      h('button', { type: 'button', on: { click: () => input.click() } }, 'Choose a file…'), input)));
  listTraces(list)
    .catch((problem) => fill(list, h('p', { class: 'fault', role: 'alert' }, problem instanceof Error ? problem.message : String(problem))))
    .finally(() => list.removeAttribute('aria-busy'));
}

addEventListener('dragover', (event) => event.preventDefault());
addEventListener('drop', (event) => {
  event.preventDefault();
  const file = event.dataTransfer?.files[0];
  if (file) void show({ trace: file, name: file.name });
});

/** A run that goes on; when it has ended and its trace is there, that. @param {string} id */
function showRun(id) {
  shown = mountLive(element, id, {
    ended: () => void getJson(`/api/runs/${encodeURIComponent(id)}`).then((run) => run.trace && show({ trace: run.trace })),
  });
}

const { trace, run } = Object.fromEntries(new URLSearchParams(location.search));
if (trace) await show({ trace, t_s: timeOfHash(location.hash) });
else if (run) showRun(run);
else offer();
