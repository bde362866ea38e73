// SPDX-License-Identifier: Apache-2.0
// @ts-check
// The page that stands alone: a trace, or a clip of one, that is in the page itself. It opens from disk and asks for nothing.

import { fill, h } from './shared/dom.js';
import { keepHash, mountViewer, timeOfHash } from './view/mount.js';

const element = /** @type {HTMLElement} */ (document.getElementById('view'));
const base64 = document.getElementById('trace')?.textContent?.trim() ?? '';
const told = Number(document.querySelector('meta[name=kerfbench-moment]')?.getAttribute('content'));

try {
  const trace = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
  const viewer = await mountViewer(element, { trace, name: document.title, t_s: timeOfHash(location.hash) ?? (Number.isFinite(told) && told > 0 ? told : undefined) });
  keepHash(viewer);
} catch (fault) {
  fill(element, h('p', { class: 'fault', role: 'alert' }, `The trace of this page cannot be shown: ${/** @type {Error} */ (fault).message}`));
}
