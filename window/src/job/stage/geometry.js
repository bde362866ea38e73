// SPDX-License-Identifier: Apache-2.0
// Places on the sheet (mm, y up) and on the screen (px, y down), and what lies near a place.
// @ts-check

/** @typedef {[number, number]} Point */
/** @typedef {{ x0: number, y0: number, x1: number, y1: number }} Box */
/** Screen = (dx + scale·x, dy − scale·y). @typedef {{ scale: number, dx: number, dy: number }} View */
/** @typedef {{ id: number, points_mm: Point[], closed: boolean }} Curve */

/** @param {View} view @param {Point} at_mm @returns {Point} */
export const toScreen = (view, [x, y]) => [view.dx + view.scale * x, view.dy - view.scale * y];
/** @param {View} view @param {Point} at_px @returns {Point} */
export const toSheet = (view, [x, y]) => [(x - view.dx) / view.scale, (view.dy - y) / view.scale];

/** @param {Iterable<Point>} points @returns {Box | null} */
export function boxOf(points) {
  let box = null;
  for (const [x, y] of points) {
    if (!box) box = { x0: x, y0: y, x1: x, y1: y };
    box.x0 = Math.min(box.x0, x);
    box.y0 = Math.min(box.y0, y);
    box.x1 = Math.max(box.x1, x);
    box.y1 = Math.max(box.y1, y);
  }
  return box;
}

/** @param {Curve[]} curves */
export const boxOfCurves = (curves) =>
  boxOf(
    (function* all() {
      for (const c of curves) yield* c.points_mm;
    })(),
  );

/**
 * The view that shows a box with a margin all around.
 * @param {Box | null} box @param {number} width_px @param {number} height_px @param {number} [margin_px] @returns {View}
 */
export function fitted(box, width_px, height_px, margin_px = 36) {
  const b = box ?? { x0: -50, y0: -50, x1: 50, y1: 50 };
  const w = Math.max(b.x1 - b.x0, 1e-3);
  const h = Math.max(b.y1 - b.y0, 1e-3);
  const scale = Math.min(Math.max(width_px - 2 * margin_px, 20) / w, Math.max(height_px - 2 * margin_px, 20) / h, 2000);
  return { scale, dx: (width_px - (b.x0 + b.x1) * scale) / 2, dy: (height_px + (b.y0 + b.y1) * scale) / 2 };
}

/** Enlarges about a place of the screen, which stays where it is. @param {View} view @param {number} by @param {Point} about_px @returns {View} */
export function zoomed(view, by, [px, py]) {
  const scale = Math.min(Math.max(view.scale * by, 0.01), 20000);
  const k = scale / view.scale;
  return { scale, dx: px - (px - view.dx) * k, dy: py - (py - view.dy) * k };
}

/** @param {View} view @param {number} dx_px @param {number} dy_px @returns {View} */
export const panned = (view, dx_px, dy_px) => ({ ...view, dx: view.dx + dx_px, dy: view.dy + dy_px });

/** Nearest place of a stretch a–b. @param {Point} p @param {Point} a @param {Point} b @returns {Point} */
export function nearestOfLine([px, py], [ax, ay], [bx, by]) {
  const vx = bx - ax;
  const vy = by - ay;
  const length2 = vx * vx + vy * vy;
  const u = length2 > 0 ? Math.min(Math.max(((px - ax) * vx + (py - ay) * vy) / length2, 0), 1) : 0;
  return [ax + u * vx, ay + u * vy];
}

/** Nearest place of a curve, and how far it is. @param {Curve} curve @param {Point} p */
export function nearestOfCurve(curve, p) {
  const { points_mm: points } = curve;
  let best = {
    at: points[0],
    distance: points.length ? Math.hypot(p[0] - points[0][0], p[1] - points[0][1]) : Infinity,
  };
  for (let i = 1; i < points.length; ++i) {
    const at = nearestOfLine(p, points[i - 1], points[i]);
    const distance = Math.hypot(p[0] - at[0], p[1] - at[1]);
    if (distance < best.distance) best = { at, distance };
  }
  return best;
}

/** @type {WeakMap<Curve, Box | null>} */
const boxes = new WeakMap();
/** Box of a curve, which is kept. @param {Curve} curve @returns {Box | null} */
export function boxOfCurve(curve) {
  let box = boxes.get(curve);
  if (box === undefined) boxes.set(curve, (box = boxOf(curve.points_mm)));
  return box;
}

/** May a curve be this near to a place? @param {Curve} curve @param {Point} p @param {number} within_mm */
function mayBeNear(curve, [x, y], within_mm) {
  const box = boxOfCurve(curve);
  return (
    box !== null &&
    x >= box.x0 - within_mm &&
    x <= box.x1 + within_mm &&
    y >= box.y0 - within_mm &&
    y <= box.y1 + within_mm
  );
}

/** The curve that is nearest to a place, within a distance; null if none. @param {Curve[]} curves @param {Point} p @param {number} within_mm */
export function hit(curves, p, within_mm) {
  let best = null;
  for (const curve of curves) {
    if (!mayBeNear(curve, p, within_mm)) continue;
    const { distance } = nearestOfCurve(curve, p);
    if (distance <= within_mm && (!best || distance < best.distance)) best = { id: curve.id, distance };
  }
  return best?.id ?? null;
}

/** Ids of the curves that lie wholly in a box. @param {Curve[]} curves @param {Box} box */
export const inside = (curves, box) =>
  curves
    .filter(
      (c) =>
        c.points_mm.length > 0 &&
        c.points_mm.every(([x, y]) => x >= box.x0 && x <= box.x1 && y >= box.y0 && y <= box.y1),
    )
    .map((c) => c.id);

/** @param {Point} a @param {Point} b @returns {Box} */
export const boxBetween = (a, b) => ({
  x0: Math.min(a[0], b[0]),
  y0: Math.min(a[1], b[1]),
  x1: Math.max(a[0], b[0]),
  y1: Math.max(a[1], b[1]),
});

/**
 * Where measuring catches: ends before middles of stretches before the line itself, within a distance; else the place itself.
 * Polylines of flattened curves have many points: only their ends and corners count as ends.
 * @param {Curve[]} curves @param {Point} p @param {number} within_mm
 * @returns {{ at: Point, kind: 'end' | 'line' | 'free' }}
 */
export function snapped(curves, p, within_mm) {
  let end = null;
  let line = null;
  for (const curve of curves) {
    if (!mayBeNear(curve, p, within_mm)) continue;
    const near = nearestOfCurve(curve, p);
    if (near.distance > within_mm) continue;
    if (!line || near.distance < line.distance) line = near;
    for (const at of cornersOf(curve)) {
      const distance = Math.hypot(p[0] - at[0], p[1] - at[1]);
      if (distance <= within_mm && (!end || distance < end.distance)) end = { at, distance };
    }
  }
  if (end) return { at: end.at, kind: 'end' };
  return line ? { at: line.at, kind: 'line' } : { at: p, kind: 'free' };
}

/** Ends of a curve and the places where it turns by more than 20°. @param {Curve} curve @returns {Point[]} */
export function cornersOf({ points_mm: points }) {
  return points.filter((p, i) => {
    if (i === 0 || i === points.length - 1) return true;
    const a = Math.atan2(p[1] - points[i - 1][1], p[0] - points[i - 1][0]);
    const b = Math.atan2(points[i + 1][1] - p[1], points[i + 1][0] - p[0]);
    return Math.abs(Math.atan2(Math.sin(b - a), Math.cos(b - a))) > Math.PI / 9;
  });
}

/** @param {Point} a @param {Point} b */
export function measured(a, b) {
  const dx = b[0] - a[0];
  const dy = b[1] - a[1];
  return { distance_mm: Math.hypot(dx, dy), dx_mm: dx, dy_mm: dy, angle_deg: (Math.atan2(dy, dx) * 180) / Math.PI };
}

/** Length that a scale bar of at most so many px stands for: 1, 2 or 5 times a power of ten. @param {View} view @param {number} most_px */
export function scaleBar(view, most_px) {
  const most_mm = most_px / view.scale;
  const power = 10 ** Math.floor(Math.log10(most_mm));
  const mm = [5, 2, 1].map((k) => k * power).find((length) => length <= most_mm) ?? power;
  return { mm, px: mm * view.scale };
}

/** @typedef {{ x: number, y: number, w: number, h: number }} Rect on the screen */

/** @param {Rect} a @param {Rect} b */
const overlap = (a, b) => a.x < b.x + b.w && b.x < a.x + a.w && a.y < b.y + b.h && b.y < a.y + a.h;

/**
 * The first place of some at which a label lies over nothing; the first of all if there is none.
 * @param {{ w: number, h: number }} size @param {[number, number][]} candidates upper left corners @param {Rect[]} taken @returns {Rect}
 */
export function freePlace({ w, h }, candidates, taken) {
  const rects = candidates.map(([x, y]) => ({ x, y, w, h }));
  return rects.find((rect) => !taken.some((other) => overlap(rect, other))) ?? rects[0];
}

/**
 * Places at which marks of one size do not hide each other: one that would lie on an earlier one moves to its right.
 * @param {[number, number][]} places @param {number} size @returns {[number, number][]}
 */
export function apart(places, size) {
  /** @type {Map<string, [number, number][]>} */
  const cells = new Map();
  const cell = (/** @type {number} */ v) => Math.floor(v / size);
  /** @param {number} x @param {number} y */
  const near = (x, y) => {
    for (let i = cell(x) - 1; i <= cell(x) + 1; ++i)
      for (let j = cell(y) - 1; j <= cell(y) + 1; ++j)
        for (const [ox, oy] of cells.get(`${i} ${j}`) ?? [])
          if (Math.abs(ox - x) < size && Math.abs(oy - y) < size) return ox;
    return null;
  };
  return places.map(([x, y]) => {
    let at = x;
    for (let other = near(at, y); other !== null; other = near(at, y)) at = other + size;
    const key = `${cell(at)} ${cell(y)}`;
    cells.set(key, [...(cells.get(key) ?? []), [at, y]]);
    return [at, y];
  });
}
