// SPDX-License-Identifier: Apache-2.0
// Paints what lies around the drawing (frames.js).
// @ts-check
import { freePlace, toScreen } from './geometry.js';

/** @typedef {import('./geometry.js').View} View */

const kArrow_px = 46;
const kFont = '600 12px system-ui, "DejaVu Sans", sans-serif';

const kWord_px = 16;

/**
 * A word on a ground of its own, so that lines below it do not strike it through, at the first of some places where it covers nothing.
 * @param {CanvasRenderingContext2D} g @param {Record<string, string>} colours
 * @param {{ text: string, ink: string, at: (w: number) => [number, number][] }} word `at`: upper left corners for its width
 * @param {import('./geometry.js').Rect[]} taken what is not to be covered; the word is added
 */
function word(g, colours, { text, ink, at }, taken) {
  g.font = kFont;
  g.textAlign = 'left';
  g.textBaseline = 'middle';
  const w = g.measureText(text).width + 4;
  const place = freePlace({ w, h: kWord_px }, at(w), taken);
  taken.push(place);
  g.fillStyle = colours.stage;
  g.fillRect(place.x, place.y, w, kWord_px);
  g.fillStyle = ink;
  g.fillText(text, place.x + 2, place.y + kWord_px / 2 + 0.5);
}

/** What labels are not to lie on: print marks, axes, the beam at rest. @param {View} view @param {import('./frames.js').Frames} frames @returns {import('./geometry.js').Rect[]} */
function takenBy(view, { marks, rest }) {
  const around = (/** @type {[number, number]} */ at_mm, /** @type {number} */ r) => {
    const [x, y] = toScreen(view, at_mm);
    return { x: x - r, y: y - r, w: 2 * r, h: 2 * r };
  };
  const [x, y] = toScreen(view, [0, 0]);
  return [
    ...marks.map(({ x_mm, y_mm, diameter_mm }) => around([x_mm, y_mm], Math.max(2.5, (view.scale * diameter_mm) / 2) + 2)),
    { x: x - 6, y: y - kArrow_px, w: 12, h: kArrow_px + 6 },
    { x: x - 6, y: y - 6, w: kArrow_px + 6, h: 12 },
    ...(rest ? [around(rest, 12)] : []),
  ];
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
export function paintAxes(g, view, colours, frames) {
  const { sheet, field, rest } = frames;
  const taken = takenBy(view, frames);
  const [x, y] = toScreen(view, [0, 0]);
  g.strokeStyle = g.fillStyle = colours.fg;
  g.lineWidth = 1.6;
  arrow(g, x, y, kArrow_px, 0);
  arrow(g, x, y, 0, -kArrow_px);
  word(g, colours, { text: 'x', ink: colours.fg, at: () => [[x + kArrow_px + 5, y - 8]] }, taken);
  word(g, colours, { text: 'y', ink: colours.fg, at: () => [[x - 6, y - kArrow_px - 18]] }, taken);
  if (field) {
    const at = boxPath(g, view, field);
    g.strokeStyle = colours.jump;
    g.lineWidth = 1.4;
    g.setLineDash([8, 4]);
    g.stroke();
    g.setLineDash([]);
    const [left, top] = [Math.max(at.x + 6, 6), Math.max(at.y, 0) + 4];
    word(g, colours, { text: 'field', ink: colours.acc, at: () => [[left, top], [left, top + 20], [left + 60, top]] }, taken);
  }
  if (sheet) {
    const [x0, y0] = toScreen(view, [sheet.x0, sheet.y1]);
    const [x1, y1] = toScreen(view, [sheet.x1, sheet.y0]);
    // Outside of its edges, where nothing is drawn.
    const at = (/** @type {number} */ w) =>
      /** @type {[number, number][]} */ ([[x0, y0 - 18], [x1 - w, y0 - 18], [x0, y1 + 2], [x1 - w, y1 + 2]]);
    word(g, colours, { text: 'sheet', ink: colours.mute, at }, taken);
  }
  if (rest) paintRest(g, colours, toScreen(view, rest), taken);
}

/** @param {CanvasRenderingContext2D} g @param {Record<string, string>} colours @param {[number, number]} at @param {import('./geometry.js').Rect[]} taken */
function paintRest(g, colours, [x, y], taken) {
  g.strokeStyle = colours.acc;
  g.lineWidth = 1.6;
  g.beginPath();
  g.arc(x, y, 6, 0, 2 * Math.PI);
  g.moveTo(x - 11, y);
  g.lineTo(x + 11, y);
  g.moveTo(x, y - 11);
  g.lineTo(x, y + 11);
  g.stroke();
  const at = (/** @type {number} */ w) =>
    /** @type {[number, number][]} */ ([
      [x + 14, y + 6],
      [x - 14 - w, y + 6],
      [x + 14, y - 22],
      [x - 14 - w, y - 22],
      [x - w / 2, y + 30],
      [x - w / 2, y - 46],
    ]);
  word(g, colours, { text: 'beam at rest: x_W = 0', ink: colours.acc, at }, taken);
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
