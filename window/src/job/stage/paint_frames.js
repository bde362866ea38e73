// SPDX-License-Identifier: Apache-2.0
// Paints what lies around the drawing (frames.js).
// @ts-check
import { toScreen } from './geometry.js';

/** @typedef {import('./geometry.js').View} View */

const kArrow_px = 46;
const kFont = '600 12px system-ui, "DejaVu Sans", sans-serif';

/** A word on a ground of its own, so that lines below it do not strike it through.
 * @param {CanvasRenderingContext2D} g @param {Record<string, string>} colours @param {string} text @param {number} x @param {number} y @param {string} ink */
function word(g, colours, text, x, y, ink) {
  g.font = kFont;
  g.textAlign = 'left';
  g.textBaseline = 'middle';
  const w = g.measureText(text).width;
  g.fillStyle = colours.stage;
  g.fillRect(x - 2, y - 8, w + 4, 16);
  g.fillStyle = ink;
  g.fillText(text, x, y + 0.5);
}

/** @param {CanvasRenderingContext2D} g @param {View} view @param {import('./geometry.js').Box} box */
function boxPath(g, view, box) {
  const [x0, y0] = toScreen(view, [box.x0, box.y1]);
  const [x1, y1] = toScreen(view, [box.x1, box.y0]);
  g.beginPath();
  g.rect(Math.round(x0) + 0.5, Math.round(y0) + 0.5, Math.round(x1 - x0), Math.round(y1 - y0));
  return { x: x0, y: y0 };
}

/** Below the drawing: sheet and marks. @param {CanvasRenderingContext2D} g @param {View} view @param {Record<string, string>} colours @param {import('./frames.js').Frames} frames */
export function paintSheetAndMarks(g, view, colours, { sheet, marks }) {
  if (sheet) {
    boxPath(g, view, sheet);
    g.strokeStyle = colours.edge;
    g.lineWidth = 1.4;
    g.setLineDash([]);
    g.stroke();
  }
  g.fillStyle = colours.mute;
  for (const { x_mm, y_mm, diameter_mm } of marks) {
    const [x, y] = toScreen(view, [x_mm, y_mm]);
    g.beginPath();
    g.arc(x, y, Math.max(2.5, (view.scale * diameter_mm) / 2), 0, 2 * Math.PI);
    g.fill();
  }
}

/** Above it: axes of the sheet, the beam at rest, and the names of the frames. @param {CanvasRenderingContext2D} g @param {View} view
 * @param {Record<string, string>} colours @param {import('./frames.js').Frames} frames */
export function paintAxes(g, view, colours, { sheet, field, rest }) {
  if (field) {
    const at = boxPath(g, view, field);
    g.strokeStyle = colours.jump;
    g.lineWidth = 1.4;
    g.setLineDash([8, 4]);
    g.stroke();
    g.setLineDash([]);
    word(g, colours, 'field', Math.max(at.x + 6, 6), Math.max(at.y, 0) + 12, colours.acc);
  }
  if (sheet) {
    const [x, y] = toScreen(view, [sheet.x0, sheet.y0]);
    word(g, colours, 'sheet', Math.max(x + 6, 6), y - 11, colours.mute);
  }
  const [x, y] = toScreen(view, [0, 0]);
  g.strokeStyle = g.fillStyle = colours.fg;
  g.lineWidth = 1.6;
  arrow(g, x, y, kArrow_px, 0);
  arrow(g, x, y, 0, -kArrow_px);
  word(g, colours, 'x', x + kArrow_px + 7, y, colours.fg);
  word(g, colours, 'y', x - 4, y - kArrow_px - 10, colours.fg);
  if (!rest) return;
  const [rx, ry] = toScreen(view, rest);
  g.strokeStyle = colours.acc;
  g.lineWidth = 1.6;
  g.beginPath();
  g.arc(rx, ry, 6, 0, 2 * Math.PI);
  g.moveTo(rx - 11, ry);
  g.lineTo(rx + 11, ry);
  g.moveTo(rx, ry - 11);
  g.lineTo(rx, ry + 11);
  g.stroke();
  word(g, colours, 'beam at rest: x_W = 0', rx + 14, ry + 14, colours.acc);
}

/** @param {CanvasRenderingContext2D} g @param {number} x @param {number} y @param {number} dx @param {number} dy */
function arrow(g, x, y, dx, dy) {
  const [ex, ey] = [x + dx, y + dy];
  const l = Math.hypot(dx, dy);
  const [ux, uy] = [dx / l, dy / l];
  g.beginPath();
  g.moveTo(x, y);
  g.lineTo(ex - 6 * ux, ey - 6 * uy);
  g.stroke();
  g.beginPath();
  g.moveTo(ex, ey);
  g.lineTo(ex - 8 * ux - 4 * uy, ey - 8 * uy + 4 * ux);
  g.lineTo(ex - 8 * ux + 4 * uy, ey - 8 * uy - 4 * ux);
  g.fill();
}

/** A ring around a place that was asked for. @param {CanvasRenderingContext2D} g @param {View} view @param {Record<string, string>} colours @param {[number, number]} at_mm */
export function paintPlace(g, view, colours, at_mm) {
  const [x, y] = toScreen(view, at_mm);
  for (const [colour, width] of /** @type {[string, number][]} */ ([
    [colours.stage, 6],
    [colours.fail, 3],
  ])) {
    g.beginPath();
    g.arc(x, y, 13, 0, 2 * Math.PI);
    g.strokeStyle = colour;
    g.lineWidth = width;
    g.stroke();
  }
}
