// SPDX-License-Identifier: Apache-2.0
// The one time of the viewer: cursor, span, steps.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { nextOf, onGrid, pulsesOf } from '../src/time/steps.js';
import { faster, kSpeeds, movedTo, panned, played, startState, zoomed } from '../src/time/timeline.js';
import { numbers } from './random.mjs';

const extent = { from: 0, to: 20 };
const inside = ({ span }) => span.from >= extent.from - 1e-12 && span.to <= extent.to + 1e-12 && span.to > span.from;

test('whatever is done, cursor and span stay within the run', () => {
  const next = numbers(5);
  let state = startState(extent, 3);
  for (let i = 0; i < 4000; ++i) {
    const act = Math.floor(5 * next());
    if (act === 0) state = movedTo(state, 30 * next() - 5);
    if (act === 1) state = zoomed(state, Math.exp(6 * next() - 3), state.span.from + next() * (state.span.to - state.span.from), 1e-6);
    if (act === 2) state = panned(state, 10 * next() - 5);
    if (act === 3) state = played({ ...state, playing: true }, next());
    if (act === 4) state = faster(state, next() < 0.5 ? 1 : -1);
    assert.ok(inside(state), JSON.stringify(state));
    assert.ok(state.t_s >= extent.from && state.t_s <= extent.to);
    assert.ok(kSpeeds.includes(state.speed));
  }
});

test('zooming keeps the time under the pointer where it is', () => {
  const state = { ...startState(extent), span: { from: 4, to: 8 } };
  const near = zoomed(state, 0.25, 5, 1e-6);
  assert.deepEqual(near.span, { from: 4.75, to: 5.75 });
  assert.ok(Math.abs((5 - near.span.from) / (near.span.to - near.span.from) - 0.25) < 1e-12);
  assert.deepEqual(zoomed(state, Infinity, 5, 1e-6).span, extent, 'all of the run');
  const { span } = zoomed(state, 0, 5, 1e-3);
  assert.ok(Math.abs(span.to - span.from - 1e-3) < 1e-12, 'never shorter than the least');
});

test('the span follows a cursor that leaves it, and stays otherwise', () => {
  const state = { ...startState(extent), t_s: 5, span: { from: 4, to: 6 } };
  assert.equal(movedTo(state, 5.5).span, state.span);
  assert.deepEqual(movedTo(state, 11).span, { from: 10, to: 12 });
  const playing = movedTo({ ...state, playing: true }, 6.1);
  assert.ok(playing.t_s > playing.span.from && playing.t_s < playing.span.from + 0.3, 'what plays enters at the left');
});

test('playing goes on by speed times time, and ends at the end', () => {
  const state = { ...startState(extent), t_s: 19, speed: 0.3, playing: true };
  assert.ok(Math.abs(played(state, 2).t_s - 19.6) < 1e-12);
  const end = played(state, 10);
  assert.deepEqual([end.t_s, end.playing], [20, false]);
  assert.equal(played({ ...state, playing: false }, 1).t_s, 19);
});

test('periods: forth and back is where it was, and each step is one period', () => {
  const period = 0.0008;
  let t = 0;
  for (let k = 1; k <= 5000; ++k) {
    t = onGrid(t, period, 1);
    assert.ok(Math.abs(t - k * period) < 1e-9, `${k}`);
  }
  for (let k = 4999; k >= 0; --k) {
    t = onGrid(t, period, -1);
    assert.ok(Math.abs(t - k * period) < 1e-9, `${k}`);
  }
  assert.equal(onGrid(0, period, -1), 0);
  assert.ok(Math.abs(onGrid(0.00081, period, -1) - period) < 1e-12, 'from between, to the one before');
});

test('the next of a list is the nearest that is not where the cursor is', () => {
  const times = [1, 2, 2.5, 7];
  assert.equal(nextOf(times, 2, 1), 2.5);
  assert.equal(nextOf(times, 2, -1), 1);
  assert.equal(nextOf(times, 2.2, -1), 2);
  assert.equal(nextOf(times, 7, 1), undefined);
  assert.equal(nextOf(times, 1, -1), undefined);
  assert.equal(nextOf(times, 2.5 - 1e-9, 1), 7, 'what differs by rounding is the same moment');
});

test('pulses are the active edges of each drive, whichever those are', () => {
  const pins = new Map([[3, { ticks: Float64Array.of(10, 14, 30, 35), firstLevel: 1 }], [5, { ticks: Float64Array.of(12, 20, 28), firstLevel: 1 }]]);
  assert.deepEqual(pulsesOf(pins, [{ pul: 3, active_edge: 'rising' }, { pul: 5, active_edge: 'falling' }, { pul: 9, active_edge: 'rising' }], 1), [10, 20, 30]);
});
