// SPDX-License-Identifier: Apache-2.0
// Tables of columns: moments out of them, pins joined from them, curves thinned for a picture, burnt paths.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { burntFrom, segmentsOf } from '../src/machine/burnt_paths.js';
import { aroundOne, sideBySide, windowOf } from '../src/panels/frames_drawing.js';
import { speedOf, spotSpeed, thinned } from '../src/panels/series.js';
import { joinedPins } from '../src/trace/pins.js';
import { lastUpTo, momentOf } from '../src/trace/rows.js';
import { countBefore, countUpTo, valueAt } from '../src/trace/search.js';
import { duration, grouped, moment, quantity, speedWords } from '../src/view/format.js';
import { numbers } from './random.mjs';

const table = (t_s, columns) => ({ t_s: Float64Array.from(t_s), columns: Object.fromEntries(Object.entries(columns).map(([name, values]) => [name, Float64Array.from(values)])) });

test('searches are those of counting', () => {
  const next = numbers(21);
  for (let round = 0; round < 200; ++round) {
    const values = Array.from({ length: Math.floor(20 * next()) }, () => Math.floor(15 * next())).sort((a, b) => a - b);
    const at = Math.floor(17 * next()) - 1;
    assert.equal(countUpTo(values, at), values.filter((value) => value <= at).length);
    assert.equal(countBefore(values, at), values.filter((value) => value < at).length);
  }
});

test('a moment lies on the line between its rows, also where they are in two chunks; power and light are steps', () => {
  const tables = [table([1, 2], { belt_mm: [10, 30], power_w: [0, 5], lit: [0, 1] }), table([3, 4], { belt_mm: [40, 40], power_w: [7, 9], lit: [1, 0] })];
  assert.deepEqual(momentOf(tables, 1.25), { belt_mm: 15, power_w: 5, lit: 1 });
  assert.deepEqual(momentOf(tables, 2), { belt_mm: 30, power_w: 5, lit: 1 });
  assert.deepEqual(momentOf(tables, 2.5), { belt_mm: 35, power_w: 7, lit: 1 });
  assert.deepEqual(momentOf(tables, 0.5), { belt_mm: 10, power_w: 0, lit: 0 }, 'before the first row, that');
  assert.deepEqual(momentOf(tables, 9), { belt_mm: 40, power_w: 9, lit: 0 }, 'after the last row, that');
  assert.equal(momentOf([], 1), undefined);
  const dark = [table([1, 2, 3], { spot_x_mm: [5, NaN, 7] })];
  assert.ok(Number.isNaN(momentOf(dark, 1.5)?.spot_x_mm), 'between a place and none there is none');
});

test('a row that holds until the next is found in whichever chunk it is', () => {
  const tables = [table([1, 4], { line: [3, 5] }), table([], { line: [] }), table([9], { line: [8] })];
  assert.equal(lastUpTo(tables, 0.9), undefined);
  assert.deepEqual(lastUpTo(tables, 3.9), { t_s: 1, line: 3 });
  assert.deepEqual(lastUpTo(tables, 8.9), { t_s: 4, line: 5 });
  assert.deepEqual(lastUpTo(tables, 9), { t_s: 9, line: 8 });
});

test('pins of chunks are those of all edges together, with the right level before the first', () => {
  const next = numbers(22);
  for (let round = 0; round < 100; ++round) {
    const all = [...new Set(Array.from({ length: 40 }, () => Math.floor(1000 * next())))].sort((a, b) => a - b);
    const cuts = [0, 200 + Math.floor(100 * next()), 600, 1000];
    const parts = cuts.slice(1).map((to, i) => {
      const ticks = all.filter((tick) => tick >= cuts[i] && tick < to);
      const before = all.filter((tick) => tick < cuts[i]).length;
      return new Map(ticks.length ? [[4, { ticks: Float64Array.from(ticks), firstLevel: (before + 1) & 1 }]] : []);
    });
    const from = Math.floor(500 * next());
    const to = from + 1 + Math.floor(400 * next());
    const levels = new Map([[4, all.filter((tick) => tick < from).length & 1]]);
    const pin = joinedPins(parts, levels, from, to).pins.get(4);
    assert.deepEqual([...pin.ticks], all.filter((tick) => tick >= from && tick < to));
    assert.equal(pin.levelBefore, levels.get(4));
  }
});

test('a thinned curve has the least and the greatest of each column, in order of time', () => {
  const next = numbers(23);
  const t_s = Float64Array.from({ length: 5000 }, (_, i) => i * 0.001);
  const value = Float64Array.from(t_s, () => (next() < 0.05 ? NaN : next()));
  const thin = thinned({ t_s, value }, { from: 0, to: 5 }, 100);
  assert.ok(thin.t_s.length <= 400);
  assert.ok(thin.t_s.every((t, i) => i === 0 || t > thin.t_s[i - 1]));
  for (let column = 0; column < 100; ++column) {
    const inside = (t) => Math.floor(t / 0.05) === column;
    const known = [...value].filter((v, i) => inside(t_s[i]) && !Number.isNaN(v));
    const kept = thin.value.filter((v, i) => inside(thin.t_s[i]) && v !== null);
    assert.equal(Math.min(...kept), Math.min(...known));
    assert.equal(Math.max(...kept), Math.max(...known));
  }
  assert.deepEqual(thinned({ t_s: [0, 1], value: [NaN, NaN] }, { from: 0, to: 2 }, 2), { t_s: [0, 1], value: [null, null] }, 'a gap stays a gap');
});

test('speed over the sheet is that of the circle that is cut, however fast the belt runs', () => {
  const t_s = Array.from({ length: 400 }, (_, i) => i * 0.0005);
  const [radius, omega, belt] = [20, 15, 60];
  const motion = table(t_s, {
    belt_mm: t_s.map((t) => belt * t), slip_x_mm: t_s.map(() => 0), slip_y_mm: t_s.map((t) => 0.1 * t),
    spot_x_mm: t_s.map((t) => radius * Math.cos(omega * t) + belt * t), spot_y_mm: t_s.map((t) => radius * Math.sin(omega * t) + 0.1 * t),
  });
  const { value } = spotSpeed(motion);
  assert.ok(Number.isNaN(value[0]));
  for (const speed of value.slice(1)) assert.ok(Math.abs(speed - radius * omega) < 0.01);
  for (const speed of speedOf(motion, 'belt_mm').value.slice(1)) assert.ok(Math.abs(speed - belt) < 1e-6);
});

test('a value is read off between its neighbours, and nowhere else', () => {
  assert.equal(valueAt([1, 2, 4], [10, 20, 40], 3), 30);
  assert.equal(valueAt([1, 2, 4], [10, 20, 40], 4), 40);
  assert.ok(Number.isNaN(valueAt([1, 2, 4], [10, 20, 40], 0.9)));
  assert.ok(Number.isNaN(valueAt([1, 2, 4], [10, 20, 40], 4.1)));
});

test('burnt paths from the motion are where the lit spot was on the sheet, and break where it was dark', () => {
  const motion = [table([1, 2, 3], { spot_x_mm: [10, 20, 30], spot_y_mm: [0, 0, 0], belt_mm: [1, 2, 3], slip_x_mm: [0, 0, 0], slip_y_mm: [0, 0, 0.5], lit: [0, 1, 1] }),
    table([4, 5, 6], { spot_x_mm: [40, 50, 60], spot_y_mm: [0, 0, NaN], belt_mm: [4, 5, 6], slip_x_mm: [0, 0, 0], slip_y_mm: [0, 0, 0], lit: [0, 1, 1] })];
  const { t_s, columns } = burntFrom(motion, 1.5, 100);
  assert.deepEqual([...t_s], [2, 3, 5]);
  assert.deepEqual([...columns.x_mm], [-82, -73, -55]);
  assert.deepEqual([...columns.y_mm], [0, -0.5, 0]);
  assert.deepEqual([...columns.start], [1, 0, 1]);
  const segments = segmentsOf([{ t_s, columns }]);
  assert.deepEqual([...segments.starts_s], [2]);
  assert.deepEqual([...segments.ends_s], [3]);
  assert.deepEqual([...segments.points].map((value) => Math.round(100 * value) / 100), [-82, 0, 0.12, -73, -0.5, 0.12]);
});

test('windows side by side do not overlap and stay within the panel', () => {
  const next = numbers(24);
  for (let round = 0; round < 60; ++round) {
    const frames = Array.from({ length: 1 + Math.floor(7 * next()) }, () => ({ windows: [{ x_px: 0, y_px: 0, width_px: 8 + Math.floor(90 * next()), height_px: 8 + Math.floor(90 * next()) }] }));
    const [width, height] = [200 + 600 * next(), 120 + 300 * next()];
    const places = round % 2 ? sideBySide(frames, width, height) : aroundOne(frames, Math.floor(frames.length * next()), width, height);
    const boxes = places.map(({ x, y, scale }, i) => ({ x, y, right: x + scale * frames[i].windows[0].width_px, low: y + scale * frames[i].windows[0].height_px }));
    boxes.forEach((a, i) => {
      assert.ok(a.x >= 0 && a.y >= 0 && a.right <= width && a.low <= height);
      for (const b of boxes.slice(i + 1)) assert.ok(a.right <= b.x || b.right <= a.x || a.low <= b.y || b.low <= a.y);
    });
  }
});

test('the window of the spot is the one that has its pixel', () => {
  const frames = [[0, 0], [100, 40]].map(([x_px, y_px]) => ({ windows: [{ x_px, y_px, width_px: 10, height_px: 20 }] }));
  assert.equal(windowOf(frames, { x_px: 104.6, y_px: 59.4 }), 1);
  assert.equal(windowOf(frames, { x_px: -0.5, y_px: 0 }), 0);
  assert.equal(windowOf(frames, { x_px: 109.5, y_px: 50 }), -1);
  assert.equal(windowOf(frames, { x_px: NaN, y_px: NaN }), -1);
  assert.equal(windowOf(frames, undefined), -1);
});

test('numbers are told as people read them', () => {
  const plain = (text) => text.replaceAll('\u2009', ' ');
  assert.equal(plain(grouped(1234567)), '1 234 567');
  assert.equal(plain(duration(0.0000625)), '62.5 µs');
  assert.equal(plain(duration(-2.5e-8)), '-25 ns');
  assert.equal(plain(duration(0)), '0 s');
  assert.equal(plain(duration(Infinity)), '–');
  assert.equal(plain(moment(3.2105124)), '3.210 512 4');
  assert.equal(plain(quantity(-0.04, 1, 'mm')), '0.0 mm');
  assert.equal(plain(quantity(null, 1, 'mm')), '–');
  assert.deepEqual([0.001, 0.1, 3].map(speedWords), ['1/1000', '1/10', '3×']);
});
