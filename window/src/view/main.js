// SPDX-License-Identifier: Apache-2.0
// @ts-check
// The page that shows a trace: the one of its address, `/view?trace=PATH#t=SECONDS`, that of a run that goes on, `/view?run=ID`, or a
// file that is dropped into it.

import { mountLive } from '../live.js';
import { getJson } from '../shared/api.js';
import { h, fill } from '../shared/dom.js';
import { keepHash, mountViewer, timeOfHash } from './mount.js';

const element = /** @type {HTMLElement} */ (document.getElementById('view'));
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

/** A place to drop a trace. @param {string} [fault] */
function offer(fault) {
  const input = h('input', { type: 'file', accept: '.mcap,.part', on: { change: () => input.files?.[0] && void show({ trace: input.files[0], name: input.files[0].name }) } });
  fill(element, h('div', { class: 'tv-offer' }, h('h1', {}, 'Trace'), fault ? h('p', { class: 'fault', role: 'alert' }, `The trace cannot be shown: ${fault}`) : null,
    h('p', {}, 'Drop a trace here (run.mcap of a results folder), or choose one. It stays on this computer.'), h('label', { class: 'file' }, 'Trace ', input)));
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
