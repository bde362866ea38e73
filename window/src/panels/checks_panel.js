// SPDX-License-Identifier: Apache-2.0
// @ts-check
// The checks of the verdict, worst first, each with a jump to its moment.

import { h, mark } from '../shared/dom.js';
import { moment, quantity } from '../view/format.js';

/** @typedef {import('../trace/machine.js').Check} Check */

/** @type {Check['outcome'][]} */
const kOrder = ['FAIL', 'INVALID', 'NOT PROVEN', 'PASS'];
const kSpan_s = 0.1; // What is shown around a moment: the report shows the same.

/** @type {import('../view/panel.js').MakePanel} */
export function checksPanel({ body, trace, timeline }) {
  const checks = [...trace.checks].sort((a, b) => kOrder.indexOf(a.outcome) - kOrder.indexOf(b.outcome));
  const items = checks.map((check) => {
    const { time_s } = check;
    const go = () => {
      if (time_s === null) return;
      timeline.update((state) => aroundMoment(state, time_s));
    };
    return h('li', { class: 'tv-check' },
      h('div', { class: 'tv-check-words' }, h('span', { class: `outcome ${toneOf(check.outcome)}` }, check.outcome), ' ', h('strong', {}, check.title || check.name),
        h('span', { class: 'mute' }, ` ${check.name}`), h('p', {}, check.sentence)),
      h('div', { class: 'tv-check-size' }, h('span', { class: 'number' }, valueWords(check)),
        time_s === null ? h('span', { class: 'mute' }, 'no moment') : h('button', { type: 'button', class: 'tv-jump', on: { click: go } }, `at ${moment(time_s)} s`)));
  });
  body.append(checks.length ? h('ol', { class: 'tv-checks', tabindex: '0', 'aria-label': 'Checks' }, items)
    : h('p', { class: 'tv-empty' }, trace.file.complete ? 'This run was not judged.' : 'The trace was cut off before the run was judged.'));
  const update = () => checks.forEach((check, i) => mark(items[i], 'aria-current', check.time_s !== null && Math.abs(check.time_s - timeline.get().t_s) < 1e-6 ? 'true' : null));
  update();
  return { close: timeline.subscribe(update) };
}

/** The cursor at a moment, with so much around it that causes can be seen. @param {import('../time/timeline.js').TimeState} state @param {number} t_s */
export function aroundMoment(state, t_s) {
  const { extent } = state;
  const length = Math.min(kSpan_s, extent.to - extent.from);
  const from = Math.min(Math.max(extent.from, t_s - length / 2), extent.to - length);
  return { ...state, playing: false, t_s: Math.min(Math.max(t_s, extent.from), extent.to), span: { from, to: from + length } };
}

/** @param {Check['outcome']} outcome */
export const toneOf = (outcome) => ({ PASS: 'pass', FAIL: 'fail', 'NOT PROVEN': 'np', INVALID: 'inv' })[outcome] ?? 'inv';

/** @param {Check} check */
function valueWords({ value, limit, upper, unit }) {
  if (value === null) return '–';
  const places = Math.abs(value) >= 100 ? 1 : 3;
  return `${quantity(value, places)}${limit === null ? '' : ` (at ${upper ? 'most' : 'least'} ${quantity(limit, places)})`} ${unit}`;
}
