// SPDX-License-Identifier: Apache-2.0
// @ts-check
// Windows of a camera's frame on a canvas: where each goes, its picture, the spot that was measured in it and where that has got to since.

/**
 * @typedef {import('./frames_panel.js').Window} Window
 * @typedef {import('./frames_panel.js').Frame} Frame
 * @typedef {{x: number, y: number, scale: number}} Placed place of a window's corner on the canvas, and its enlargement
 */

const kKeep = 60;
const kGap_px = 8;
const kLabel_px = 15;
const kStill_px = 0.05; // A spot that has moved by less is where it was.

/** Decoded pictures, the latest ones. */
export class Pictures {
  /** @type {Map<string, ImageBitmap | null>} */
  #all = new Map();
  /** @param {() => void} ready */
  constructor(ready) {
    this.ready = ready;
  }
  /** @param {Frame} frame */
  of(frame) {
    const key = `${frame.sequence} ${frame.windows[0]?.x_px} ${frame.windows[0]?.y_px}`;
    const known = this.#all.get(key);
    if (known !== undefined) return known;
    this.#all.set(key, null);
    const bytes = Uint8Array.from(atob(frame.data), (letter) => letter.charCodeAt(0));
    createImageBitmap(new Blob([bytes], { type: `image/${frame.format}` })).then((picture) => {
      this.#all.set(key, picture);
      this.ready();
    }, () => undefined); // A picture that cannot be read stays dark.
    if (this.#all.size > kKeep) this.#all.delete(this.#all.keys().next().value ?? '');
    return null;
  }
}

/** @param {Frame[]} frames @param {number} width @param {number} height @returns {Placed[]} */
export function inPicture(frames, width, height) {
  const [first] = frames;
  if (!first) return [];
  const scale = Math.min((width - 2 * kGap_px) / first.width_px, (height - 2 * kGap_px) / first.height_px);
  return frames.map(({ windows: [place] }) => ({
    x: width / 2 + scale * (place.x_px - first.width_px / 2), y: height / 2 + scale * (place.y_px - first.height_px / 2), scale,
  }));
}

/**
 * In rows, as large as they all fit.
 * @param {Frame[]} frames @param {number} width @param {number} height @returns {Placed[]}
 */
export function sideBySide(frames, width, height) {
  if (!frames.length) return [];
  const across = Math.max(...frames.map(({ windows: [place] }) => place.width_px));
  const down = Math.max(...frames.map(({ windows: [place] }) => place.height_px));
  let best = { columns: 1, scale: 0 };
  for (let columns = 1; columns <= frames.length; ++columns) {
    const rows = Math.ceil(frames.length / columns);
    const scale = Math.min(((width - kGap_px) / columns - kGap_px) / across, ((height - kGap_px) / rows - kGap_px - kLabel_px) / down);
    if (scale > best.scale) best = { columns, scale };
  }
  const { columns, scale } = best;
  const rows = Math.ceil(frames.length / columns);
  const [cell, row] = [scale * across + kGap_px, scale * down + kGap_px + kLabel_px];
  const [left, top] = [(width - columns * cell + kGap_px) / 2, (height - rows * row + kGap_px) / 2];
  return frames.map((_, i) => ({ x: left + (i % columns) * cell, y: top + Math.floor(i / columns) * row, scale }));
}

/**
 * One window as large as the height allows, the others small beside it.
 * @param {Frame[]} frames @param {number} at which one is large @param {number} width @param {number} height @returns {Placed[]}
 */
export function aroundOne(frames, at, width, height) {
  const [place] = frames[at].windows;
  const others = frames.filter((_, i) => i !== at);
  const share = others.length ? 0.6 : 1;
  const scale = Math.min((height - 2 * kGap_px - kLabel_px) / place.height_px, (share * width - 2 * kGap_px) / place.width_px);
  const used = scale * place.width_px + 2 * kGap_px;
  const beside = sideBySide(others, width - used, height);
  const large = { x: others.length ? kGap_px : (width - used) / 2 + kGap_px, y: (height - kLabel_px - scale * place.height_px) / 2, scale };
  return frames.map((_, i) => (i === at ? large : { ...beside[i < at ? i : i - 1], x: used + beside[i < at ? i : i - 1].x }));
}

/** @param {CanvasRenderingContext2D} context @param {Frame[]} frames @param {Placed[]} places @param {Pictures} pictures @param {boolean} whole */
export function drawWindows(context, frames, places, pictures, whole) {
  context.font = '11px system-ui, sans-serif';
  context.textAlign = 'left';
  context.textBaseline = 'top';
  if (whole && frames[0]) {
    const [{ windows: [place], width_px, height_px }] = frames;
    const { x, y, scale } = places[0];
    context.strokeStyle = '#4a5462';
    context.strokeRect(x - scale * place.x_px, y - scale * place.y_px, scale * width_px, scale * height_px);
  }
  frames.forEach((frame, i) => {
    const { x, y, scale } = places[i];
    const [{ x_px, y_px, width_px, height_px }] = frame.windows;
    const picture = pictures.of(frame);
    context.imageSmoothingEnabled = scale < 1;
    if (picture) context.drawImage(picture, x, y, scale * picture.width, scale * picture.height);
    context.strokeStyle = '#4a5462';
    context.strokeRect(x - 0.5, y - 0.5, scale * width_px + 1, scale * height_px + 1);
    if (whole || context.measureText(`${x_px}, ${y_px}`).width > scale * width_px) return;
    context.fillStyle = '#a9b4c2';
    context.fillText(`${x_px}, ${y_px}`, x, y + scale * height_px + 3);
  });
}

/** Which window has the measured spot; -1: none. @param {Frame[]} frames @param {{x_px: number, y_px: number} | Record<string, number> | undefined} spot */
export function windowOf(frames, spot) {
  if (!spot || !Number.isFinite(spot.x_px)) return -1;
  const inside = (/** @type {number} */ at, /** @type {number} */ from, /** @type {number} */ length) => at >= from - 0.5 && at < from + length - 0.5;
  return frames.findIndex(({ windows: [place] }) => inside(spot.x_px, place.x_px, place.width_px) && inside(spot.y_px, place.y_px, place.height_px));
}

/** Where the pixel (0, 0) of the whole picture is on the canvas. @param {Frame} frame @param {Placed} placed of its window */
export function originOf({ windows: [place] }, { x, y, scale }) {
  return { x: x - scale * (place.x_px - 0.5), y: y - scale * (place.y_px - 0.5) };
}

/** @param {CanvasRenderingContext2D} context @param {{x: number, y: number}} origin @param {number} scale @param {{x_px: number, y_px: number}[]} way @param {string} colour */
export function drawWay(context, origin, scale, way, colour) {
  const now = way[way.length - 1];
  if (!now) return;
  context.strokeStyle = colour;
  context.lineWidth = 1;
  context.beginPath();
  for (const { x_px, y_px } of way) context.lineTo(origin.x + scale * x_px, origin.y + scale * y_px);
  context.stroke();
  ring(context, origin.x + scale * now.x_px, origin.y + scale * now.y_px);
}

/**
 * Where the spot is by the cursor: a ring in the window that has it, else an arrow out of the one in which it was.
 * @param {CanvasRenderingContext2D} context @param {Frame[]} frames @param {Placed[]} places @param {{x_px: number, y_px: number}[]} way
 * @param {{home: number, colour: string}} look home: the window in which it was
 */
export function drawNow(context, frames, places, way, { home, colour }) {
  const [was, now] = [way[0], way[way.length - 1]];
  if (!now || Math.hypot(now.x_px - was.x_px, now.y_px - was.y_px) < kStill_px) return;
  context.strokeStyle = context.fillStyle = colour;
  context.lineWidth = 1.5;
  const at = windowOf(frames, now);
  if (at >= 0) {
    const origin = originOf(frames[at], places[at]);
    return ring(context, origin.x + places[at].scale * now.x_px, origin.y + places[at].scale * now.y_px);
  }
  if (home < 0) return undefined;
  const { x, y, scale } = places[home];
  const [{ width_px, height_px }] = frames[home].windows;
  const origin = originOf(frames[home], places[home]);
  const [middle_x, middle_y] = [x + 0.5 * scale * width_px, y + 0.5 * scale * height_px];
  const [dx, dy] = [origin.x + scale * now.x_px - middle_x, origin.y + scale * now.y_px - middle_y];
  const share = Math.min((0.5 * scale * width_px) / Math.abs(dx || 1e-9), (0.5 * scale * height_px) / Math.abs(dy || 1e-9));
  return arrow(context, middle_x + share * dx, middle_y + share * dy, Math.atan2(dy, dx));
}

/** @param {CanvasRenderingContext2D} context @param {number} x @param {number} y */
function ring(context, x, y) {
  context.beginPath();
  context.arc(x, y, 9, 0, 7);
  context.stroke();
}

/** With its tip there. @param {CanvasRenderingContext2D} context @param {number} x @param {number} y @param {number} angle_rad */
function arrow(context, x, y, angle_rad) {
  context.save();
  context.translate(x, y);
  context.rotate(angle_rad);
  context.beginPath();
  context.moveTo(0, 0);
  context.lineTo(-11, -6);
  context.lineTo(-11, 6);
  context.fill();
  context.restore();
}

/** @param {CanvasRenderingContext2D} context @param {Window} place @param {Placed} placed @param {Record<string, number>} spot @param {string} colour */
export function drawSpot(context, place, placed, spot, colour) {
  // The centre of the pixel (0, 0) is at 0: its edge is half a pixel before.
  const x = placed.x + placed.scale * (spot.x_px + 0.5 - place.x_px);
  const y = placed.y + placed.scale * (spot.y_px + 0.5 - place.y_px);
  context.strokeStyle = colour;
  context.lineWidth = 1.5;
  context.beginPath();
  for (const [dx, dy] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) {
    context.moveTo(x + 6 * dx, y + 6 * dy);
    context.lineTo(x + 16 * dx, y + 16 * dy);
  }
  context.stroke();
}
