// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import test from 'node:test';
import {
  lineOn,
  makeMotion,
  momentAt,
  rampColour,
  reachAt,
  reachShare,
  startOfLine,
  usualSpeed,
} from '../src/job/motion.js';

/** A jump of two periods, then a cut of three along x, on a belt. */
const preview = () => ({
  period_s: 0.001,
  stride: 1,
  x_mm: [0, 0, 0, 1, 2, 4],
  y_mm: [0, 1, 2, 2, 2, 2],
  power: [0, 0, 0, 100, 200, 255],
  gate: [0, 0, 0, 1, 1, 1],
  speed_mm_s: [0, 1000, 1000, 1000, 1000, 2000],
  line: [
    [2, 3],
    [3, 3],
  ],
  entity: [
    [-1, 3],
    [7, 3],
  ],
  field: { min_mm: [-10, -5], max_mm: [10, 5], ref_x_mm: 2, belt_mm_s: 100 },
});

test('a motion has the periods of the program as they are', () => {
  const motion = makeMotion(preview(), 200);
  assert.equal(motion.duration_s, 0.005);
  for (let i = 0; i < motion.n; ++i) {
    const now = momentAt(motion, i);
    assert.equal(now.x_mm, preview().x_mm[i]);
    assert.equal(now.y_mm, preview().y_mm[i]);
  }
  assert.deepEqual(motion.stretches, [
    { line: 2, entity: null, first: 0, last: 2 },
    { line: 3, entity: 7, first: 2, last: 5 },
  ]);
});

test('between two periods the place is on the way, power and speed are those of the period under way', () => {
  const motion = makeMotion(preview(), 200);
  const now = momentAt(motion, 4.5);
  assert.equal(now.x_mm, 3);
  assert.equal(now.speed_mm_s, 2000);
  assert.equal(now.power_w, 200);
  assert.ok(now.lit);
  assert.ok(Math.abs(now.t_s - 0.0045) < 1e-15);
});

test('cut and jump lengths add up to the whole way', () => {
  const motion = makeMotion(preview(), 200);
  const end = momentAt(motion, Infinity);
  assert.equal(end.cut_mm, 4);
  assert.equal(end.jump_mm, 2);
});

test('a closed gate is no cut, whatever power is commanded', () => {
  const dark = { ...preview(), gate: [0, 0, 0, 0, 0, 0] };
  const end = momentAt(makeMotion(dark, 200), 5);
  assert.equal(end.cut_mm, 0);
  assert.equal(end.power_w, 0);
});

test('the start of a line shows that line', () => {
  const motion = makeMotion(preview(), 200);
  assert.equal(startOfLine(motion, 3), 2);
  assert.equal(momentAt(motion, 2).line, 3);
  assert.equal(momentAt(motion, 2).entity, 7);
  assert.equal(startOfLine(motion, 99), null);
});

test('lines on and back lead to each end once and stop at the ends of the job', () => {
  const motion = makeMotion(preview(), 200);
  const on = [];
  for (let p = 0; p < motion.n - 1; p = lineOn(motion, p, 1)) on.push(p);
  assert.deepEqual(on, [0, 2]);
  assert.equal(lineOn(motion, 5, 1), 5);
  assert.equal(lineOn(motion, 5, -1), 2);
  assert.equal(lineOn(motion, 2.5, -1), 2);
  assert.equal(lineOn(motion, 0, -1), 0);
});

test('the reach goes back on the sheet as the belt goes on', () => {
  const motion = makeMotion(preview(), 200);
  assert.deepEqual(reachAt(motion, 0), { x0: -12, x1: 8, y0: -5, y1: 5 });
  assert.ok(Math.abs(reachAt(motion, 5).x0 - -12.5) < 1e-12);
  assert.equal(reachAt(makeMotion({ ...preview(), field: null }, 200), 0), null);
});

test('a beam beyond its reach has a share above 1', () => {
  const far = makeMotion({ ...preview(), x_mm: [0, 0, 0, 1, 2, 9] }, 200);
  assert.ok(reachShare(far, 4) < 1);
  assert.ok(reachShare(far, 5) > 1);
});

test('a motion of every second period counts time by its stride', () => {
  assert.equal(makeMotion({ ...preview(), stride: 2 }, 200).duration_s, 0.01);
});

test('the usual speed shows a job in about twelve seconds', () => {
  const speeds = [0.01, 0.1, 1, 10];
  assert.equal(usualSpeed(12, speeds), 1);
  assert.equal(usualSpeed(1.1, speeds), 0.1);
  assert.equal(usualSpeed(0, speeds), 0.01);
});

test('the ramp stays within its ends', () => {
  assert.equal(rampColour(-1), rampColour(0));
  assert.equal(rampColour(2), rampColour(1));
});
