// SPDX-License-Identifier: Apache-2.0
// Paints the drawing, the preview and what is measured onto a canvas.
// @ts-check
import { momentAt, rampColour, reachAt, shareAt } from '../motion.js';
import { boxOfCurve, measured, scaleBar, toScreen } from './geometry.js';

/** @typedef {import('./geometry.js').View} View */
/** @typedef {import('./geometry.js').Curve} Curve */
/** @typedef {import('../motion.js').Motion} Motion */

const kDash = { cut: [], 'half-cut': [9, 3, 2, 3], crease: [7, 4], perforation: [3, 3], ignore: [1, 4] };
const kColours = [
  'cut',
  'crease',
  'half-cut',
  'perforation',
  'ignore',
  'acc',
  'fail',
  'jump',
  'field',
  'fg',
  'mute',
  'line',
  'edge',
  'bg',
  'stage',
];

/** The page's colours, as they are in the present scheme. @param {Element} element @returns {Record<string, string>} */
export function coloursOf(element) {
  const style = getComputedStyle(element);
  return Object.fromEntries(kColours.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]));
}

/** Points nearer than this to the one before are not painted: nobody sees them. */
const kFinest_px = 0.7;
/** Curves that are stroked at once. More make a path that takes a rasteriser without a GPU too long. */
const kBatch = 400;
/** Points of a drawing above which its lines are no longer dashed: it shows as a texture then anyway. */
const kMostDashed = 40000;

/**
 * Strokes the curves that are in sight, as fine as the screen.
 * @param {CanvasRenderingContext2D} g @param {View} view @param {Iterable<Curve>} curves
 * @param {{ colour: string, width: number, dash?: number[] }} look
 */
export function strokeCurves(g, view, curves, { colour, width, dash = [] }) {
  const { width: w, height: h } = g.canvas;
  g.lineWidth = width;
  g.setLineDash(dash);
  g.lineCap = dash.length > 0 ? 'butt' : 'round';
  g.lineJoin = 'round';
  g.strokeStyle = colour;
  let count = 0;
  g.beginPath();
  for (const curve of curves) {
    const box = boxOfCurve(curve);
    if (!box) continue;
    const [x0, y0] = toScreen(view, [box.x0, box.y1]);
    const [x1, y1] = toScreen(view, [box.x1, box.y0]);
    if (x1 < -width || y1 < -width || x0 > w + width || y0 > h + width) continue;
    traceCurve(g, view, curve.points_mm);
    if (++count % kBatch === 0) {
      g.stroke();
      g.beginPath();
    }
  }
  g.stroke();
  g.setLineDash([]);
}

/** @param {CanvasRenderingContext2D} g @param {View} view @param {[number, number][]} points */
function traceCurve(g, view, points) {
  let [x, y] = toScreen(view, points[0]);
  g.moveTo(x, y);
  const last = points.length - 1;
  for (let i = 1; i <= last; ++i) {
    const [px, py] = toScreen(view, points[i]);
    if (i < last && Math.abs(px - x) < kFinest_px && Math.abs(py - y) < kFinest_px) continue;
    g.lineTo(px, py);
    x = px;
    y = py;
  }
  if (last === 0) g.lineTo(x, y);
}

/** Curves by their process. @param {import('../state.js').Entity[]} entities */
export function byProcess(entities) {
  /** @type {Map<string, Curve[]>} */
  const of = new Map();
  let points = 0;
  for (const entity of entities) {
    const list = of.get(entity.process);
    if (list) list.push(entity);
    else of.set(entity.process, [entity]);
    points += entity.points_mm.length;
  }
  return { groups: [...of], dashed: points <= kMostDashed };
}

/** What is travelled with the laser off, as curves. @param {Motion} motion @returns {Curve[]} */
export function jumpsOf(motion) {
  /** @type {Curve[]} */
  const jumps = [];
  for (let i = 1; i < motion.n; ++i) {
    if (motion.lit[i]) continue;
    if (i === 1 || motion.lit[i - 1])
      jumps.push({ id: jumps.length, closed: false, points_mm: [[motion.x[i - 1], motion.y[i - 1]]] });
    jumps[jumps.length - 1].points_mm.push([motion.x[i], motion.y[i]]);
  }
  return jumps;
}

/**
 * The sheet before anything runs: origin, lines by process, jumps.
 * @param {CanvasRenderingContext2D} g @param {View} view @param {Record<string, string>} colours
 * @param {{ drawn: ReturnType<typeof byProcess>, jumps: Curve[] }} what
 */
export function paintSheet(g, view, colours, { drawn, jumps }) {
  const [x, y] = toScreen(view, [0, 0]);
  g.strokeStyle = colours.line;
  g.lineWidth = 1;
  g.beginPath();
  g.moveTo(0, Math.round(y) + 0.5);
  g.lineTo(g.canvas.width, Math.round(y) + 0.5);
  g.moveTo(Math.round(x) + 0.5, 0);
  g.lineTo(Math.round(x) + 0.5, g.canvas.height);
  g.stroke();
  strokeCurves(g, view, jumps, { colour: colours.jump, width: 1, dash: jumps.length < kBatch ? [4, 4] : [] });
  for (const [process, curves] of drawn.groups)
    strokeCurves(g, view, curves, {
      colour: colours[process] ?? colours.ignore,
      width: process === 'ignore' ? 1 : 1.6,
      dash: drawn.dashed ? (/** @type {any} */ (kDash)[process] ?? kDash.ignore) : [],
    });
}

const kSteps = 24;
/**
 * Adds the periods (from, to] of the way that has been run, coloured by power, speed or reach.
 * @param {CanvasRenderingContext2D} g @param {View} view @param {Record<string, string>} colours @param {Motion} motion
 * @param {{ from: number, to: number, by: 'power' | 'speed' | 'reach', jumps: boolean }} what
 */
export function paintRun(g, view, colours, motion, { from, to, by, jumps }) {
  g.lineCap = g.lineJoin = 'round';
  const kind = (/** @type {number} */ i) =>
    motion.lit[i] ? 1 + Math.min(Math.ceil(kSteps * shareAt(motion, i, by)), kSteps + 1) : 0;
  const at = (/** @type {number} */ i) => toScreen(view, [motion.x[i], motion.y[i]]);
  let i = from;
  let here = at(i);
  // The next period that is to be seen: one that is a step on the screen away, or switches the laser.
  const next = () => {
    let k = i + 1;
    for (; k < to && motion.lit[k + 1] === motion.lit[i + 1]; ++k) {
      const [x, y] = at(k);
      if (Math.abs(x - here[0]) >= kFinest_px || Math.abs(y - here[1]) >= kFinest_px) break;
    }
    return k;
  };
  while (i < to) {
    let k = next();
    const colour = kind(k);
    g.beginPath();
    g.moveTo(...here);
    do {
      i = k;
      here = at(i);
      g.lineTo(...here);
      if (i < to) k = next();
    } while (i < to && kind(k) === colour);
    if (colour === 0 && !jumps) continue;
    g.setLineDash(colour === 0 ? [4, 4] : []);
    g.lineWidth = colour === 0 ? 1.4 : 3;
    g.strokeStyle =
      colour === 0 ? colours.jump : colour > kSteps + 1 ? colours.fail : rampColour((colour - 1) / kSteps);
    g.stroke();
  }
  g.setLineDash([]);
}

/** @param {CanvasRenderingContext2D} g @param {View} view @param {Record<string, string>} colours @param {Motion} motion @param {number} period */
export function paintReach(g, view, colours, motion, period) {
  const reach = reachAt(motion, period);
  if (!reach) return;
  const [x0, y0] = toScreen(view, [reach.x0, reach.y1]);
  const [x1, y1] = toScreen(view, [reach.x1, reach.y0]);
  g.fillStyle = colours.field;
  g.fillRect(x0, y0, x1 - x0, y1 - y0);
  g.strokeStyle = colours.jump;
  g.lineWidth = 1;
  g.strokeRect(x0, y0, x1 - x0, y1 - y0);
}

/** @param {CanvasRenderingContext2D} g @param {View} view @param {Record<string, string>} colours @param {Motion} motion @param {number} period */
export function paintBeam(g, view, colours, motion, period) {
  const now = momentAt(motion, period);
  const [x, y] = toScreen(view, [now.x_mm, now.y_mm]);
  g.beginPath();
  g.arc(x, y, 6, 0, 2 * Math.PI);
  g.fillStyle = now.lit ? colours.acc : colours.bg;
  g.strokeStyle = now.lit ? colours.bg : colours.acc;
  g.lineWidth = 2;
  g.fill();
  g.stroke();
  g.beginPath();
  g.arc(x, y, 7.5, 0, 2 * Math.PI);
  g.strokeStyle = colours.acc;
  g.lineWidth = 1.2;
  g.stroke();
}

/** @param {CanvasRenderingContext2D} g @param {View} view @param {Curve[]} curves @param {Record<string, string>} colours */
export function paintSelected(g, view, curves, colours) {
  strokeCurves(g, view, curves, { colour: colours.stage, width: 6.5 });
  strokeCurves(g, view, curves, { colour: colours.acc, width: 3.6 });
}

/**
 * Numbers of the order, left out where they would lie on each other.
 * @param {CanvasRenderingContext2D} g @param {View} view @param {Record<string, string>} colours @param {{ at: [number, number], text: string }[]} labels
 */
export function paintNumbers(g, view, colours, labels) {
  /** @type {number[][]} */
  const taken = [];
  g.font = '600 11px system-ui, "DejaVu Sans", sans-serif';
  g.textBaseline = 'middle';
  g.textAlign = 'center';
  for (const { at, text } of labels) {
    const [x, y] = toScreen(view, at);
    const w = g.measureText(text).width + 8;
    if (taken.some((q) => Math.abs(q[0] - x) < (q[2] + w) / 2 + 1 && Math.abs(q[1] - y) < 16)) continue;
    taken.push([x, y, w]);
    g.beginPath();
    g.roundRect(x - w / 2, y - 8, w, 16, 3);
    g.fillStyle = colours.bg;
    g.fill();
    g.strokeStyle = colours.mute;
    g.lineWidth = 1;
    g.stroke();
    g.fillStyle = colours.fg;
    g.fillText(text, x, y + 0.5);
  }
}

/**
 * @param {CanvasRenderingContext2D} g @param {View} view @param {Record<string, string>} colours
 * @param {{ from: [number, number], to: [number, number] | null, cursor: [number, number] | null, kind: string }} what
 */
export function paintMeasure(g, view, colours, { from, to, cursor, kind }) {
  const end = to ?? cursor;
  g.strokeStyle = g.fillStyle = colours.acc;
  g.lineWidth = 1.4;
  if (from && end) {
    const [ax, ay] = toScreen(view, from);
    const [bx, by] = toScreen(view, end);
    g.beginPath();
    g.moveTo(ax, ay);
    g.lineTo(bx, by);
    g.stroke();
    const text = `${measured(from, end).distance_mm.toFixed(3)} mm`;
    g.font = '600 12px system-ui, "DejaVu Sans", sans-serif';
    g.textAlign = 'center';
    g.textBaseline = 'middle';
    const w = g.measureText(text).width + 12;
    g.fillStyle = colours.acc;
    g.beginPath();
    g.roundRect((ax + bx - w) / 2, (ay + by) / 2 - 26, w, 20, 4);
    g.fill();
    g.fillStyle = colours.bg;
    g.fillText(text, (ax + bx) / 2, (ay + by) / 2 - 15.5);
  }
  for (const at of [from, to]) {
    if (!at) continue;
    const [x, y] = toScreen(view, at);
    g.beginPath();
    g.arc(x, y, 3.5, 0, 2 * Math.PI);
    g.fillStyle = colours.acc;
    g.fill();
  }
  if (!cursor) return;
  const [x, y] = toScreen(view, cursor);
  g.beginPath();
  g.moveTo(x - 9, y);
  g.lineTo(x + 9, y);
  g.moveTo(x, y - 9);
  g.lineTo(x, y + 9);
  g.stroke();
  if (kind === 'end') g.strokeRect(x - 5, y - 5, 10, 10);
  if (kind === 'line') {
    g.beginPath();
    g.arc(x, y, 5, 0, 2 * Math.PI);
    g.stroke();
  }
}

/** @param {CanvasRenderingContext2D} g @param {View} view @param {Record<string, string>} colours @param {number} width_px */
export function paintScale(g, view, colours, width_px) {
  const { mm, px } = scaleBar(view, 120);
  const x = width_px - 16;
  const y = 22;
  g.strokeStyle = colours.mute;
  g.fillStyle = colours.mute;
  g.lineWidth = 1.2;
  g.beginPath();
  g.moveTo(x - px, y - 4);
  g.lineTo(x - px, y);
  g.lineTo(x, y);
  g.lineTo(x, y - 4);
  g.stroke();
  g.font = '12px system-ui, "DejaVu Sans", sans-serif';
  g.textAlign = 'right';
  g.textBaseline = 'bottom';
  g.fillText(`${mm >= 0.001 ? Number(mm.toPrecision(1)) : mm.toExponential(0)} mm`, x, y - 6);
}
