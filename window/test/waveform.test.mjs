// SPDX-License-Identifier: Apache-2.0
// The waveform's arithmetic: what a column shows, what an axis says, what a pulse measures.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { axisOf } from '../src/waveform/axis.js';
import { edgesPerColumn, runsOf } from '../src/waveform/bins.js';
import { levelAt, pulseAt } from '../src/waveform/measure.js';
import { numbers } from './random.mjs';

/** Ascending whole ticks, some of them close together and some far apart. */
function someEdges(next, count) {
  const ticks = [];
  let at = Math.floor(500 * next());
  for (let i = 0; i < count; ++i) ticks.push((at += next() < 0.5 ? 1 + Math.floor(4 * next()) : 20 + Math.floor(300 * next())));
  return Float64Array.from(ticks);
}

/** Level before a tick, by counting every edge. */
const levelBefore = (ticks, level, tick) => level ^ (ticks.filter((edge) => edge < tick).length & 1);

test('columns have as many edges as a count of each edge gives', () => {
  const next = numbers(1);
  for (let round = 0; round < 200; ++round) {
    const ticks = someEdges(next, Math.floor(80 * next()));
    const from = Math.floor(3000 * next()) - 200;
    const perPixel = 0.05 + 40 * next();
    const width = 1 + Math.floor(120 * next());
    const counted = new Array(width).fill(0);
    for (const tick of ticks) {
      for (let x = 0; x < width; ++x) if (tick >= from + x * perPixel && tick < from + (x + 1) * perPixel) ++counted[x];
    }
    assert.deepEqual([...edgesPerColumn(ticks, from, perPixel, width)], counted);
  }
});

test('runs cover all columns, and what is drawn as a line has an edge a column at most', () => {
  const next = numbers(2);
  let dense = 0;
  for (let round = 0; round < 300; ++round) {
    const ticks = someEdges(next, Math.floor(120 * next()));
    const before = next() < 0.5 ? 0 : 1;
    const from = Math.floor(2000 * next());
    const perPixel = 0.1 + 30 * next();
    const width = 1 + Math.floor(150 * next());
    const counts = edgesPerColumn(ticks, from, perPixel, width);
    let x = 0;
    for (const run of runsOf(ticks, before, from, perPixel, width)) {
      assert.equal(run.from_px, x, 'runs follow each other');
      assert.ok(run.to_px > run.from_px);
      assert.equal(run.level, levelBefore(ticks, before, from + run.from_px * perPixel), 'level at its left');
      const inside = ticks.filter((tick) => tick >= from + run.from_px * perPixel && tick < from + run.to_px * perPixel);
      assert.equal(run.edges, inside.length);
      if (inside.length) assert.equal(ticks[run.first], inside[0]);
      if (!run.dense) for (let column = run.from_px; column < run.to_px; ++column) assert.ok(counts[column] <= 1);
      else assert.ok(counts.subarray(run.from_px, run.to_px).some((count) => count > 1));
      dense += run.dense ? 1 : 0;
      x = run.to_px;
    }
    assert.equal(x, width);
  }
  assert.ok(dense > 100, 'dense stretches were among them');
});

/** The same by looking at the level of each tick, for one active edge after the other. */
function pulsesByTicks(pul, dir, rising, last) {
  const level = (pin, tick) => pin.levelBefore ^ (pin.ticks.filter((edge) => edge <= tick).length & 1);
  const active = [];
  for (let tick = 1; tick <= last; ++tick) if (level(pul, tick) !== level(pul, tick - 1) && level(pul, tick) === (rising ? 1 : 0)) active.push(tick);
  return active.map((tick) => {
    const way = (pin, from, step) => {
      for (let at = from; at >= 0 && at <= last; at += step) if (level(pin, at) !== level(pin, at - 1)) return at;
      return undefined;
    };
    const [dirBefore, dirAfter, end, start] = [way(dir, tick, -1), way(dir, tick + 1, 1), way(pul, tick + 1, 1), way(pul, tick - 1, -1)];
    const apart = (a, b) => (a === undefined || b === undefined ? Infinity : a - b);
    return { tick, setup: apart(tick, dirBefore), hold: apart(dirAfter, tick), width: apart(end, tick), space: apart(tick, start), dir: level(dir, tick) };
  });
}

test('set-up, hold, width and idle time are those that each tick shows', () => {
  const next = numbers(3);
  for (let round = 0; round < 60; ++round) {
    const ascending = (count) => [...new Set(Array.from({ length: count }, () => 1 + Math.floor(398 * next())))].sort((a, b) => a - b);
    const pul = { ticks: Float64Array.from(ascending(14)), levelBefore: next() < 0.5 ? 0 : 1 };
    const dir = { ticks: Float64Array.from(ascending(6)), levelBefore: next() < 0.5 ? 0 : 1 };
    const rising = next() < 0.5;
    const pulses = pulsesByTicks(pul, dir, rising, 400);
    for (const pulse of pulses) assert.deepEqual(pulseAt(pul, dir, rising, pulse.tick), pulse);
    for (let i = 0; i < 20; ++i) {
      const tick = 400 * next();
      const found = pulseAt(pul, dir, rising, tick);
      const nearest = Math.min(...pulses.map((pulse) => Math.abs(pulse.tick - tick)));
      assert.equal(found === undefined, pulses.length === 0);
      if (found) assert.equal(Math.abs(found.tick - tick), nearest);
    }
  }
});

test('a change of DIR at the very tick of the edge leaves no set-up', () => {
  const pul = { ticks: Float64Array.of(100, 140), levelBefore: 0 };
  const dir = { ticks: Float64Array.of(100), levelBefore: 0 };
  assert.deepEqual(pulseAt(pul, dir, true, 100), { tick: 100, setup: 0, hold: Infinity, width: 40, space: Infinity, dir: 1 });
  assert.equal(levelAt(dir, 99), 0);
  assert.equal(levelAt(dir, 100), 1);
});

test('marks of the axis are round, apart, and within the span, from an hour to a tick', () => {
  for (const length of [3600, 130, 7, 0.31, 0.012, 9e-5, 1e-6, 62.5e-9 * 12]) {
    const span = { from: 1234.5678, to: 1234.5678 + length };
    const { marks, base } = axisOf(span, 900);
    assert.ok(marks.length >= 3 && marks.length <= 11, `${marks.length} marks for ${length} s`);
    for (const { t_s } of marks) assert.ok(t_s >= span.from - 1e-9 && t_s <= span.to + 1e-9);
    const step = marks[1].t_s - marks[0].t_s;
    const digit = step / 10 ** Math.floor(Math.log10(step) + 1e-6);
    assert.ok([1, 2, 5, 10].some((one) => Math.abs(digit - one) < 1e-3), `${step} is round`);
    assert.equal(new Set(marks.map(({ label }) => label)).size, marks.length, 'no two have the same words');
    assert.equal(base !== undefined, length < 0.008, 'small steps are counted from a moment that is told');
  }
});
