// SPDX-License-Identifier: Apache-2.0
// @ts-check
// The one time of the page: the cursor, the span that waveform and plots show, two marks, and whether and how fast it plays.
// States change by pure functions; every view follows the store.

import { createStore } from '../shared/store.js';

/**
 * @typedef {{from: number, to: number}} Span s
 * @typedef {{t_s: number, extent: Span, span: Span, playing: boolean, speed: number, a_s: number | null, b_s: number | null}} TimeState
 */

/** Simulated seconds for a second of the viewer's. */
export const kSpeeds = [0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1, 3, 10];
const kWhole = 1.0000001; // A span is the whole run from here on.

/** @param {number} value @param {number} least @param {number} most */
const within = (value, least, most) => Math.min(Math.max(value, least), most);

/** @param {Span} extent @param {number} [t_s] @returns {TimeState} */
export function startState(extent, t_s = extent.from) {
  const t = within(t_s, extent.from, extent.to);
  return { t_s: t, extent, span: { ...extent }, playing: false, speed: 0.1, a_s: null, b_s: null };
}

/** Moves the cursor; the span follows where the cursor would leave it. @param {TimeState} state @param {number} t_s @returns {TimeState} */
export function movedTo(state, t_s) {
  const t = within(t_s, state.extent.from, state.extent.to);
  if (t === state.t_s) return state;
  return { ...state, t_s: t, span: following(state, t) };
}

/** @param {TimeState} state @param {number} t_s @returns {Span} */
function following({ span, extent, playing }, t_s) {
  if (t_s >= span.from && t_s <= span.to) return span;
  const length = span.to - span.from;
  // What plays enters the span at its left, to be seen for long; a jump lands in its middle.
  const from = within(t_s - (playing ? 0.08 : 0.5) * length, extent.from, Math.max(extent.from, extent.to - length));
  return { from, to: from + length };
}

/** Goes on by a time of the viewer's. Ends at the end of the run. @param {TimeState} state @param {number} elapsed_s @returns {TimeState} */
export function played(state, elapsed_s) {
  if (!state.playing) return state;
  const moved = movedTo(state, state.t_s + state.speed * elapsed_s);
  return moved.t_s >= moved.extent.to ? { ...moved, playing: false } : moved;
}

/**
 * Lengthens or shortens the span around a time that keeps its place.
 * @param {TimeState} state @param {number} factor of its length @param {number} around_s @param {number} least_s
 * @returns {TimeState}
 */
export function zoomed(state, factor, around_s, least_s) {
  const { span, extent } = state;
  const whole = extent.to - extent.from;
  const length = within(factor * (span.to - span.from), Math.min(least_s, whole), whole);
  if (length * kWhole >= whole) return { ...state, span: { ...extent } };
  const share = (around_s - span.from) / (span.to - span.from);
  const from = within(around_s - share * length, extent.from, extent.to - length);
  return { ...state, span: { from, to: from + length } };
}

/** Moves the span. @param {TimeState} state @param {number} shift_s @returns {TimeState} */
export function panned(state, shift_s) {
  const { span, extent } = state;
  const length = span.to - span.from;
  const from = within(span.from + shift_s, extent.from, extent.to - length);
  return { ...state, span: { from, to: from + length } };
}

/** The next speed of the list. @param {TimeState} state @param {1 | -1} direction @returns {TimeState} */
export function faster(state, direction) {
  const at = kSpeeds.indexOf(state.speed);
  return { ...state, speed: kSpeeds[within(at + direction, 0, kSpeeds.length - 1)] };
}

/**
 * The store, with a clock that runs while it plays.
 * @param {Span} extent @param {number} [t_s]
 */
export function createTimeline(extent, t_s) {
  const store = createStore(startState(extent, t_s));
  let last_ms = 0;
  const frame = (/** @type {number} */ now_ms) => {
    if (!store.get().playing) return;
    const elapsed_s = Math.min(0.25, (now_ms - last_ms) / 1000); // A page that was hidden does not jump when it is back.
    last_ms = now_ms;
    store.update((state) => played(state, Math.max(0, elapsed_s)));
    requestAnimationFrame(frame);
  };
  return {
    ...store,
    /** @param {number} to_s */
    go: (to_s) => store.update((state) => movedTo(state, to_s)),
    play(on = !store.get().playing) {
      if (on === store.get().playing) return;
      // At the end it begins anew.
      store.update((state) => ({ ...(on && state.t_s >= state.extent.to ? movedTo(state, state.extent.from) : state), playing: on }));
      last_ms = performance.now();
      if (on) requestAnimationFrame(frame);
    },
  };
}
