// SPDX-License-Identifier: Apache-2.0
// @ts-check
// The whole run as a strip: when the laser was lit, where checks have their moments, which span is shown, where the cursor is.
// Dragging on it moves the cursor.

import { h, mark } from '../shared/dom.js';
import { toneOf } from '../panels/checks_panel.js';
import { axisOf } from '../waveform/axis.js';
import { sharpCanvas } from './canvas.js';
import { moment } from './format.js';

const kEdge_px = 12;

/** @param {import('../trace/trace.js').Trace} trace @param {ReturnType<typeof import('../time/timeline.js').createTimeline>} timeline */
export function strip(trace, timeline) {
  const { extent } = timeline.get();
  const length = extent.to - extent.from || 1;
  const element = h('div', {
    class: 'tv-strip', role: 'slider', tabindex: '0', 'aria-label': 'Time', 'aria-valuemin': extent.from, 'aria-valuemax': extent.to,
  });
  const timeAt = (/** @type {PointerEvent} */ event) => {
    const box = element.getBoundingClientRect();
    return extent.from + ((event.clientX - box.left - kEdge_px) / (box.width - 2 * kEdge_px)) * length;
  };
  element.addEventListener('pointerdown', (/** @type {PointerEvent} */ down) => {
    if (down.button !== 0) return;
    element.setPointerCapture(down.pointerId);
    timeline.play(false);
    timeline.go(timeAt(down));
    const move = (/** @type {PointerEvent} */ event) => timeline.go(timeAt(event));
    element.addEventListener('pointermove', move);
    element.addEventListener('pointerup', () => element.removeEventListener('pointermove', move), { once: true });
  });

  const canvas = sharpCanvas(element, '', (context, width, height, theme) => {
    const { t_s, span } = timeline.get();
    const plot = width - 2 * kEdge_px;
    const toX = (/** @type {number} */ t) => kEdge_px + ((t - extent.from) / length) * plot;
    context.font = '11px system-ui, sans-serif';
    context.textBaseline = 'alphabetic';
    context.fillStyle = theme.card;
    context.fillRect(kEdge_px, 4, plot, height - 20);
    drawLit(context, trace, toX, height, theme.gate);
    context.fillStyle = theme.acc;
    context.globalAlpha = 0.14;
    context.fillRect(toX(span.from), 4, Math.max(2, toX(span.to) - toX(span.from)), height - 20);
    context.globalAlpha = 1;
    for (const { t_s: at, label } of axisOf(extent, plot, 110).marks) {
      context.fillStyle = theme.line;
      context.fillRect(Math.round(toX(at)), height - 16, 1, 4);
      context.fillStyle = theme.mute;
      context.textAlign = 'center';
      if (toX(at) > 20 && toX(at) < width - 20) context.fillText(label, toX(at), height - 3);
    }
    for (const check of trace.checks) {
      if (check.time_s === null || check.outcome === 'PASS') continue;
      context.fillStyle = theme[toneOf(check.outcome)];
      context.beginPath();
      context.arc(toX(check.time_s), 8, 4, 0, 7);
      context.fill();
    }
    context.fillStyle = theme.acc;
    context.fillRect(toX(t_s) - 1, 2, 2, height - 17);
  });
  const tell = () => {
    const { t_s } = timeline.get();
    mark(element, 'aria-valuenow', t_s.toFixed(7));
    mark(element, 'aria-valuetext', `${moment(t_s)} s`);
    canvas.want();
  };
  tell();
  const stop = [timeline.subscribe(tell), trace.onLoad(canvas.want)];
  return { element, close: () => { for (const end of stop) end(); canvas.close(); } };
}

/** How much of each interval the laser was lit. @param {CanvasRenderingContext2D} context @param {import('../trace/trace.js').Trace} trace
 * @param {(t: number) => number} toX @param {number} height @param {string} colour */
function drawLit(context, trace, toX, height, colour) {
  const { from, to } = trace.extent_s;
  const step_s = Math.max(0.1, (2 * (to - from)) / 1200);
  const base = height - 16;
  context.fillStyle = colour;
  context.globalAlpha = 0.55;
  for (const part of trace.overview.parts(from, to, step_s)) {
    for (let row = 0; row < part.rows; ++row) {
      const share = Math.min(1, part.lit_s[row] / part.step_s);
      const x = toX(part.from_s + row * part.step_s);
      const size = share * (height - 22);
      if (share > 0) context.fillRect(x, base - size, Math.max(1, toX(part.from_s + (row + 1) * part.step_s) - x), size);
    }
  }
  context.globalAlpha = 1;
}
