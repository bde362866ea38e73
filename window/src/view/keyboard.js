// SPDX-License-Identifier: Apache-2.0
// @ts-check
// All of the viewer by keys. A key that an element needs itself (a text, a list, a slider of the layout) is left to it.

import { faster, kSpeeds, movedTo, zoomed } from '../time/timeline.js';

/** @type {[string, string][]} */
export const kHelp = [
  ['Space', 'play or pause'],
  ['← →', 'a period back or on; with Shift ten'],
  ['Alt ← →', 'a pulse back or on'],
  [', .', 'a frame of the camera back or on'],
  ['↑ ↓', 'a line of the program back or on'],
  ['Page Up, Page Down', 'a check back or on'],
  ['Home, End', 'start and end of the run'],
  ['1 … 9', 'speed, from 1/1000 to 10×'],
  ['[ ]', 'slower, faster'],
  ['+ −', 'zoom into the time and out; 0: the whole run'],
  ['A B', 'set the marks at the cursor; X: remove them'],
  ['V', 'next view of the machine'],
  ['O', 'follow the spot'],
  ['?', 'these keys'],
];

/**
 * @param {{timeline: ReturnType<typeof import('../time/timeline.js').createTimeline>, step: (kind: import('../time/steps.js').StepKind,
 *   direction: import('../time/steps.js').Direction, count?: number) => void, least_s: number, nextView: () => void, follow: () => void, help: () => void}} page
 * @returns {() => void} ends it
 */
export function listenToKeys({ timeline, step, least_s, nextView, follow, help }) {
  const zoom = (/** @type {number} */ factor) => timeline.update((state) => zoomed(state, factor, middleOf(state), least_s));
  /** @type {Record<string, (event: KeyboardEvent) => void>} */
  const acts = {
    ' ': () => timeline.play(),
    ArrowLeft: (event) => step(event.altKey ? 'pulse' : 'period', -1, event.shiftKey ? 10 : 1),
    ArrowRight: (event) => step(event.altKey ? 'pulse' : 'period', 1, event.shiftKey ? 10 : 1),
    ',': () => step('frame', -1),
    '.': () => step('frame', 1),
    ArrowUp: () => step('line', -1),
    ArrowDown: () => step('line', 1),
    PageUp: () => step('check', -1),
    PageDown: () => step('check', 1),
    Home: () => timeline.update((state) => movedTo(state, state.extent.from)),
    End: () => timeline.update((state) => movedTo(state, state.extent.to)),
    '[': () => timeline.update((state) => faster(state, -1)),
    ']': () => timeline.update((state) => faster(state, 1)),
    '+': () => zoom(0.5),
    '=': () => zoom(0.5),
    '-': () => zoom(2),
    0: () => zoom(Infinity),
    a: () => timeline.update((state) => ({ ...state, a_s: state.t_s })),
    b: () => timeline.update((state) => ({ ...state, b_s: state.t_s })),
    x: () => timeline.update((state) => ({ ...state, a_s: null, b_s: null })),
    v: nextView,
    o: follow,
    '?': help,
  };
  kSpeeds.forEach((speed, i) => { acts[String(i + 1)] = () => timeline.update((state) => ({ ...state, speed })); });
  const listen = (/** @type {KeyboardEvent} */ event) => {
    if (event.ctrlKey || event.metaKey || event.defaultPrevented || keepsKey(event)) return;
    const act = acts[event.key] ?? acts[event.key.toLowerCase()];
    if (!act) return;
    event.preventDefault();
    act(event);
  };
  addEventListener('keydown', listen);
  return () => removeEventListener('keydown', listen);
}

/** Around the cursor, or around the middle where the cursor is out of sight. @param {import('../time/timeline.js').TimeState} state */
const middleOf = ({ t_s, span }) => (t_s >= span.from && t_s <= span.to ? t_s : 0.5 * (span.from + span.to));

/** @param {KeyboardEvent} event */
function keepsKey({ target, key }) {
  if (!(target instanceof HTMLElement)) return false;
  if (target.closest('dialog')) return true;
  if (target.matches('input:not([type=checkbox]), textarea, [contenteditable]')) return true;
  if (target.matches('select')) return key !== ' ' ? /^(Arrow|Page|Home|End|.$)/.test(key) : true;
  if (target.matches('button, a, summary, input')) return key === ' ' || key === 'Enter';
  if (target.matches('.tv-rows, .tv-checks')) return /^(ArrowUp|ArrowDown|Page)/.test(key);
  return false;
}
