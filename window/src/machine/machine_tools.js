// SPDX-License-Identifier: Apache-2.0
// @ts-check
// Buttons of the machine's picture: from where it is looked at, whether it follows the spot, whether the dieline is on the sheet.

import { h } from '../shared/dom.js';

/** @typedef {import('./machine_view.js').ViewName} ViewName */

/** @type {[ViewName, string][]} */
const kViews = [['overall', 'Whole'], ['head', 'Head'], ['sheet', 'Sheet'], ['above', 'From above']];

/** @param {import('./machine_view.js').MachineView} view */
export function machineTools(view) {
  const buttons = kViews.map(([name, words]) => h('button', { type: 'button', on: { click: () => look(name) } }, words));
  const look = (/** @type {ViewName} */ name) => {
    view.look(name);
    kViews.forEach(([one], i) => buttons[i].setAttribute('aria-pressed', String(one === name)));
  };
  const follow = toggle('Follow the spot', 'Keep the spot in the middle (O)', false, (on) => view.follow(on));
  const lines = toggle('Dieline', 'The dieline on the sheet', true, (on) => view.showDieline(on));
  look('overall');
  return {
    elements: [h('span', { class: 'tv-choice', role: 'group', 'aria-label': 'View' }, buttons), follow, lines],
    look,
    nextView: () => look(kViews[(kViews.findIndex(([name]) => name === view.view) + 1) % kViews.length][0]),
    toggleFollow: () => follow.click(),
  };
}

/** @param {string} words @param {string} title @param {boolean} pressed @param {(on: boolean) => void} act */
function toggle(words, title, pressed, act) {
  const button = h('button', { type: 'button', 'aria-pressed': String(pressed), title, on: { click: () => {
    const on = button.getAttribute('aria-pressed') !== 'true';
    button.setAttribute('aria-pressed', String(on));
    act(on);
  } } }, words);
  return button;
}
