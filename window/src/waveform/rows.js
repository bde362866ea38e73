// SPDX-License-Identifier: Apache-2.0
// @ts-check
// Which pins are shown, in which order and colour, and what is drawn for each.

import { countBefore } from '../trace/search.js';
import { grouped } from '../view/format.js';
import { runsOf } from './bins.js';

/**
 * @typedef {{id: number, name: string, tone: string, group: number, pulse: boolean}} Row
 * @typedef {import('../view/theme.js').Theme} Theme
 */

/**
 * Rows of a machine: drives first, PUL above DIR, then the laser, then what the machine's sensors say.
 * @param {import('../trace/machine.js').Machine} machine @returns {Row[]}
 */
export function rowsOf(machine) {
  const pulses = new Set(machine.drives.map((drive) => drive.pul));
  const place = (/** @type {import('../trace/machine.js').SignalInfo} */ { id, name, from }) => {
    if (from === 'machine') return { group: 2, tone: 'sensor' };
    if (id === machine.laser.gate) return { group: 1, tone: 'gate' };
    if (id === machine.laser.pwm) return { group: 1, tone: 'pwm' };
    return { group: /laser/.test(name) ? 1 : 0, tone: 'pul' };
  };
  return machine.signals
    .map((signal) => ({ id: signal.id, name: signal.name, pulse: pulses.has(signal.id), ...place(signal) }))
    .sort((a, b) => a.group - b.group);
}

/** Whether a pin ever moves in a run. @param {import('../trace/overview.js').OverviewPart[]} parts of the whole run @param {number} id */
export const moves = (parts, id) => parts.some((part) => part.pins.some((pin) => pin.id === id && pin.edges.some((edges) => edges > 0)));

const kHigh = 0.2; // Shares of a row's height, from its top.
const kLow = 0.82;

/**
 * Draws a pin whose edges are all known.
 * @param {CanvasRenderingContext2D} context @param {{x: number, y: number, width: number, height: number}} at
 * @param {import('../trace/pins.js').Pin} pin @param {number} from tick at the left @param {number} perPixel ticks @param {string} colour @param {string} ink
 */
export function drawEdges(context, at, pin, from, perPixel, colour, ink) {
  const width = Math.floor(at.width);
  const y = (/** @type {number} */ level) => at.y + at.height * (level ? kHigh : kLow);
  for (const run of runsOf(pin.ticks, pin.levelBefore, from, perPixel, width)) {
    if (run.dense) drawDense(context, at, run.from_px, run.to_px, run.edges, colour, ink);
    else {
      const line = new Path2D();
      const fill = new Path2D();
      let level = run.level;
      let x = at.x + run.from_px;
      line.moveTo(x, y(level));
      const upTo = (/** @type {number} */ next) => {
        line.lineTo(next, y(level));
        if (level) fill.rect(x, y(1), next - x, y(0) - y(1));
        x = next;
      };
      for (let i = run.first; i < run.first + run.edges; ++i) {
        upTo(at.x + (pin.ticks[i] - from) / perPixel);
        level ^= 1;
        line.lineTo(x, y(level));
      }
      upTo(at.x + run.to_px);
      context.fillStyle = colour;
      context.globalAlpha = 0.1;
      context.fill(fill);
      context.globalAlpha = 1;
      context.strokeStyle = colour;
      context.lineWidth = 1.25;
      context.stroke(line);
    }
  }
}

/**
 * A stretch of which only the number of edges can be shown.
 * @param {CanvasRenderingContext2D} context @param {{x: number, y: number, height: number}} at
 * @param {number} from_px @param {number} to_px @param {number} edges @param {string} colour @param {string} ink of the number
 */
function drawDense(context, at, from_px, to_px, edges, colour, ink) {
  const top = at.y + at.height * kHigh;
  const height = at.height * (kLow - kHigh);
  const width = Math.max(1, to_px - from_px);
  context.fillStyle = colour;
  context.globalAlpha = 0.2 + 0.3 * Math.min(1, Math.log10(1 + edges / width) / 2);
  context.fillRect(at.x + from_px, top, width, height);
  context.globalAlpha = 1;
  context.fillRect(at.x + from_px, top - 0.5, width, 1);
  context.fillRect(at.x + from_px, top + height - 0.5, width, 1);
  const label = grouped(edges);
  if (width < 9 + 6.5 * label.length) return;
  context.fillStyle = ink;
  context.textAlign = 'center';
  context.fillText(label, at.x + 0.5 * (from_px + to_px), top + 0.5 * height + 0.5);
}

/**
 * Draws a pin by the overview: numbers of edges in intervals, and the level at the end of each.
 * @param {CanvasRenderingContext2D} context @param {{x: number, y: number, width: number, height: number}} at
 * @param {import('../trace/overview.js').OverviewPart[]} parts @param {number} id @param {{from: number, to: number}} span @param {string} colour @param {string} ink
 */
export function drawCounts(context, at, parts, id, span, colour, ink) {
  const toX = (/** @type {number} */ t) => Math.min(at.width, Math.max(0, ((t - span.from) / (span.to - span.from)) * at.width));
  /** @type {{from: number, to: number, edges: number} | undefined} */
  let band;
  const close = () => {
    if (band) drawDense(context, at, band.from, band.to, band.edges, colour, ink);
    band = undefined;
  };
  let level = 0;
  for (const part of parts) {
    const pin = part.pins.find((one) => one.id === id);
    if (!pin) continue;
    for (let row = 0; row < part.rows; ++row) {
      const from = toX(part.from_s + row * part.step_s);
      const to = toX(part.from_s + (row + 1) * part.step_s);
      if (to <= from) {
        level = pin.level[row];
        continue;
      }
      if (pin.edges[row] > 0) {
        // Neighbours that differ by more than twice are bands of their own: how dense it is stays visible.
        const ratio = band && (pin.edges[row] / (to - from)) / (band.edges / (band.to - band.from));
        if (band && ratio && (ratio > 2 || ratio < 0.5)) close();
        band = band ? { from: band.from, to, edges: band.edges + pin.edges[row] } : { from, to, edges: pin.edges[row] };
      } else {
        close();
        level = pin.level[row];
        context.fillStyle = colour;
        context.fillRect(at.x + from, at.y + at.height * (level ? kHigh : kLow) - 0.6, to - from + 0.5, 1.25);
      }
      level = pin.level[row];
    }
  }
  close();
}

/** Number of edges in [from, to) ticks. @param {import('../trace/pins.js').Pin} pin @param {number} from @param {number} to */
export const edgesBetween = (pin, from, to) => countBefore(pin.ticks, to) - countBefore(pin.ticks, from);

/** Number of edges by the overview, of the intervals that begin in a span. @param {import('../trace/overview.js').OverviewPart[]} parts @param {number} id @param {{from: number, to: number}} span */
export function countedEdges(parts, id, span) {
  let sum = 0;
  for (const part of parts) {
    const pin = part.pins.find((one) => one.id === id);
    for (let row = 0; pin && row < part.rows; ++row) {
      const at = part.from_s + row * part.step_s;
      if (at >= span.from - 0.5 * part.step_s && at < span.to - 1e-9) sum += pin.edges[row];
    }
  }
  return sum;
}
