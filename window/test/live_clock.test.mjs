// SPDX-License-Identifier: Apache-2.0
// The clock of a run that goes on: even, a little behind, never ahead of what has come.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { arrived, startClock, ticked } from '../src/live/clock.js';
import { numbers } from './random.mjs';

/**
 * A run that is shown at 60 pictures a second, of which something comes in lumps.
 * @param {(at_s: number) => number} newestAt simulated time of the run at the viewer's
 * @param {() => number} pause until the next lump, s
 */
function shown(newestAt, pause, seconds) {
  let clock = startClock();
  const steps = [];
  let lump_s = 0;
  for (let frame = 0; frame < 60 * seconds; ++frame) {
    const at_s = frame / 60;
    if (at_s >= lump_s) {
      clock = arrived(clock, at_s, newestAt(at_s));
      lump_s = at_s + pause();
    }
    const before_s = clock.t_s;
    clock = ticked(clock, 1 / 60, false);
    assert.ok(clock.t_s <= clock.newest_s, 'never what has not come');
    assert.ok(clock.t_s >= before_s, 'never backwards');
    steps.push({ at_s, t_s: clock.t_s, step_s: clock.t_s - before_s, behind_s: newestAt(at_s) - clock.t_s });
  }
  return steps;
}

for (const rate of [0.05, 1, 7]) {
  test(`a run at ${rate} of real time that comes in lumps is shown evenly, a quarter of a second behind`, () => {
    const next = numbers(31);
    const steps = shown((at_s) => rate * at_s, () => 0.03 + 0.08 * next(), 8).filter(({ at_s }) => at_s > 3);
    for (const { step_s, behind_s } of steps) {
      assert.ok(Math.abs(step_s * 60 - rate) < 0.35 * rate, `speed ${step_s * 60} of ${rate}`);
      assert.ok(behind_s < 0.35 * rate && behind_s > 0, `${behind_s / rate} s behind`);
    }
  });
}

test('a run that becomes slower is still shown in step, and one that stands is not overtaken', () => {
  const newest = (at_s) => (at_s < 4 ? at_s : 4 + 0.2 * (at_s - 4));
  const steps = shown(newest, () => 0.05, 10);
  assert.ok(steps[steps.length - 1].behind_s < 0.1);
  const still = shown((at_s) => Math.min(at_s, 2), () => 0.05, 6);
  assert.ok(still.every(({ t_s }) => Number.isNaN(t_s) || t_s <= 2));
});

test('when the run has ended, all of it is shown', () => {
  let clock = arrived(arrived(startClock(), 0, 0), 1, 1);
  for (let i = 0; i < 600; ++i) clock = ticked(clock, 1 / 60, true);
  assert.ok(Math.abs(clock.t_s - 1) < 1e-6);
});

test('after the page was hidden it jumps to the present', () => {
  let clock = startClock();
  for (let i = 0; i <= 100; ++i) clock = arrived(clock, i / 10, i / 10);
  clock = ticked(clock, 1 / 60, false);
  assert.ok(clock.newest_s - clock.t_s < 0.3);
});
