// SPDX-License-Identifier: Apache-2.0
import assert from 'node:assert/strict';
import test from 'node:test';
import * as G from '../src/job/stage/geometry.js';

const square = {
  id: 1,
  closed: true,
  points_mm: [
    [0, 0],
    [10, 0],
    [10, 10],
    [0, 10],
    [0, 0],
  ],
};
const line = {
  id: 2,
  closed: false,
  points_mm: [
    [20, 0],
    [30, 5],
  ],
};
const view = { scale: 4, dx: 100, dy: 300 };
const near = (a, b) => a.forEach((x, i) => assert.ok(Math.abs(x - b[i]) < 1e-9, `${a} ${b}`));

test('sheet to screen and back', () => {
  for (const p of [
    [0, 0],
    [3.5, -2],
    [-100, 40],
  ])
    near(G.toSheet(view, G.toScreen(view, p)), p);
  assert.deepEqual(G.toScreen(view, [1, 1]), [104, 296], 'y goes up on the sheet and down on the screen');
});

test('zooming leaves the place below the pointer where it is', () => {
  const at = [333, 77];
  near(G.toSheet(G.zoomed(view, 1.7, at), at), G.toSheet(view, at));
  near(G.toScreen(G.panned(view, 5, -3), [2, 2]), [113, 289]);
});

test('what is fitted lies within the margin', () => {
  const v = G.fitted(G.boxOfCurves([square, line]), 400, 200, 20);
  for (const p of [...square.points_mm, ...line.points_mm]) {
    const [x, y] = G.toScreen(v, p);
    assert.ok(x >= 20 - 1e-9 && x <= 380 + 1e-9 && y >= 20 - 1e-9 && y <= 180 + 1e-9);
  }
  assert.ok(Number.isFinite(G.fitted(null, 400, 200).scale));
  assert.ok(Number.isFinite(G.fitted({ x0: 1, y0: 1, x1: 1, y1: 1 }, 400, 200).scale), 'a point has no size');
});

test('the nearest curve is chosen, within the catch alone', () => {
  assert.equal(G.hit([square, line], [5, 0.4], 0.5), 1);
  assert.equal(G.hit([square, line], [24, 2], 0.5), 2);
  assert.equal(G.hit([square, line], [5, 5], 0.5), null);
  assert.equal(G.hit([], [5, 5], 99), null);
});

test('a rubber band takes what lies wholly in it', () => {
  assert.deepEqual(G.inside([square, line], G.boxBetween([11, 11], [-1, -1])), [1]);
  assert.deepEqual(G.inside([square, line], G.boxBetween([5, -1], [40, 11])), [2]);
});

test('measuring catches ends and corners before lines, and nothing far away', () => {
  assert.deepEqual(G.snapped([square], [9.6, 0.3], 1), { at: [10, 0], kind: 'end' });
  assert.deepEqual(G.snapped([square], [5, 0.3], 1), { at: [5, 0], kind: 'line' });
  assert.deepEqual(G.snapped([square], [5, 5], 1), { at: [5, 5], kind: 'free' });
});

test('points of a flattened arc are no corners', () => {
  const arc = {
    id: 3,
    closed: false,
    points_mm: Array.from({ length: 40 }, (_, i) => [Math.cos(i / 20), Math.sin(i / 20)]),
  };
  assert.equal(G.cornersOf(arc).length, 2);
  assert.equal(G.cornersOf(square).length, 5);
});

test('distance and angle', () => {
  const m = G.measured([1, 1], [4, 5]);
  assert.equal(m.distance_mm, 5);
  assert.deepEqual([m.dx_mm, m.dy_mm], [3, 4]);
  assert.ok(Math.abs(G.measured([0, 0], [0, 2]).angle_deg - 90) < 1e-12);
});

test('a scale bar is 1, 2 or 5 times a power of ten, and fits', () => {
  for (const scale of [0.013, 0.5, 1, 3.7, 88, 4000]) {
    const { mm, px } = G.scaleBar({ scale, dx: 0, dy: 0 }, 120);
    assert.ok(px <= 120 + 1e-9 && px > 120 / 2.6);
    assert.ok(['1', '2', '5'].includes(mm.toExponential()[0]));
  }
});

test('marks on one place stand side by side, and others stay where they are', () => {
  const at = G.apart([[10, 10], [10, 10], [12, 14], [200, 10]], 21);
  assert.deepEqual(at[0], [10, 10]);
  assert.deepEqual(at[3], [200, 10]);
  for (const [i, [x, y]] of at.entries())
    for (const [ox, oy] of at.slice(0, i)) assert.ok(Math.abs(x - ox) >= 21 || Math.abs(y - oy) >= 21, `${at}`);
});

test('a label takes the first place that covers nothing', () => {
  const size = { w: 40, h: 16 };
  const mark = { x: 0, y: 0, w: 10, h: 10 };
  assert.deepEqual(G.freePlace(size, [[5, 5], [20, 20]], [mark]), { x: 20, y: 20, ...size });
  assert.deepEqual(G.freePlace(size, [[5, 5]], [mark]), { x: 5, y: 5, ...size }, 'rather over something than not at all');
});
