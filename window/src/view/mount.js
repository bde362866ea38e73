// SPDX-License-Identifier: Apache-2.0
// @ts-check
// From an address, a file or bytes to a viewer in the page, with the time in the address of the page.

import { h, fill } from '../shared/dom.js';
import { BlobReadable, BytesReadable, HttpReadable } from '../trace/readable.js';
import { Trace } from '../trace/trace.js';
import { movedTo } from '../time/timeline.js';
import { Viewer } from './viewer.js';

/**
 * @typedef {{trace: string | Blob | Uint8Array, name?: string, t_s?: number}} Source a path of the folder that is served, a file, or the bytes
 */

/**
 * Opens a trace and shows it.
 * @param {HTMLElement} element @param {Source} source
 * @returns {Promise<Viewer>} @throws {Error} that says why it cannot be shown
 */
export async function mountViewer(element, { trace, name, t_s }) {
  performance.mark('kerfbench-trace-asked');
  fill(element, h('div', { class: 'tv-opening', role: 'status' }, h('p', {}, 'Opening the trace …'), h('progress', { 'aria-label': 'Opening the trace' })));
  const opened = await Trace.open(readableOf(trace));
  const title = name ?? (typeof trace === 'string' ? trace : '');
  const viewer = new Viewer(element, opened, { t_s, name: title });
  performance.mark('kerfbench-trace-opened');
  document.title = `${opened.machine.scenario}: trace · Kerfbench`;
  return viewer;
}

/** @param {Source['trace']} trace */
function readableOf(trace) {
  if (typeof trace === 'string') return new HttpReadable(`/api/trace?path=${encodeURIComponent(trace)}`);
  return trace instanceof Blob ? new BlobReadable(trace) : new BytesReadable(trace);
}

/** Time in an address's fragment, `#t=1.234`. @param {string} hash @returns {number | undefined} */
export function timeOfHash(hash) {
  const found = new URLSearchParams(hash.replace(/^#/, '')).get('t');
  const t_s = Number(found);
  return found && Number.isFinite(t_s) ? t_s : undefined;
}

/**
 * Keeps the cursor's time in the page's address, and follows it when it is changed there.
 * @param {Viewer} viewer @returns {() => void} ends it
 */
export function keepHash(viewer) {
  const { timeline } = viewer;
  let timer = 0;
  const write = () => history.replaceState(null, '', `#t=${timeline.get().t_s.toFixed(7)}`);
  const stop = timeline.subscribe((state, before) => {
    if (state.t_s === before.t_s) return;
    // Browsers refuse an address that changes many times a second.
    clearTimeout(timer);
    timer = setTimeout(write, 250);
  });
  const follow = () => {
    const t_s = timeOfHash(location.hash);
    if (t_s !== undefined) timeline.update((state) => movedTo(state, t_s));
  };
  addEventListener('hashchange', follow);
  return () => {
    clearTimeout(timer);
    stop();
    removeEventListener('hashchange', follow);
  };
}
