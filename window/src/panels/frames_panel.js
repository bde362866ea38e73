// SPDX-License-Identifier: Apache-2.0
// @ts-check
// What the spot camera saw last: the windows that were read out of its picture, side by side or at their places in it.

import { h, say } from '../shared/dom.js';
import { timeOfFrame } from '../time/steps.js';
import { sharpCanvas } from '../view/canvas.js';
import { duration, quantity } from '../view/format.js';

/**
 * @typedef {{x_px: number, y_px: number, width_px: number, height_px: number}} Window
 * @typedef {{timestamp: {sec: number, nsec: number}, sequence: number, start_s: number, exposure_s: number, data: string, format: string,
 *   windows: Window[], width_px: number, height_px: number}} Frame one message: a window of a frame
 * @typedef {{x: number, y: number, scale: number}} Placed place of a window's corner on the canvas, and its enlargement
 */

const kKeep = 60;
const kSame_s = 1e-6;
const kGap_px = 8;
const kLabel_px = 15;

/** @type {import('../view/panel.js').MakePanel} */
export function framesPanel({ body, tools, trace, timeline }) {
  const surface = h('div', { class: 'tv-surface dark' });
  const reading = h('output', { class: 'tv-reading', 'aria-label': 'Frame and measured spot' });
  body.append(surface, h('div', { class: 'tv-panel-foot' }, reading));
  let whole = false;
  const choice = h('button', { type: 'button', 'aria-pressed': 'false', title: 'The windows at their places in the whole picture', on: { click: () => {
    whole = !whole;
    choice.setAttribute('aria-pressed', String(whole));
    canvas.want();
  } } }, 'Whole picture');
  tools.append(choice);
  const pictures = new Pictures(() => canvas.want());
  /** @type {Frame[]} */
  let shown = [];
  const canvas = sharpCanvas(surface, 'Windows of the spot camera', (context, width, height, theme) => {
    const spot = spotOf(trace, shown[0]);
    const at = windowOf(shown, spot);
    const places = whole ? inPicture(shown, width, height) : at < 0 ? sideBySide(shown, width, height) : aroundOne(shown, at, width, height);
    drawWindows(context, shown, places, pictures, whole);
    if (spot && at >= 0) drawSpot(context, shown[at].windows[0], places[at], spot, theme.measured);
  });
  const update = () => {
    shown = framesAt(trace, timeline.get().t_s);
    say(reading, wordsOf(trace, shown, timeline.get().t_s));
    canvas.want();
  };
  update();
  const stop = [timeline.subscribe((state, before) => state.t_s !== before.t_s && update()), trace.onLoad(update)];
  return { shown: () => shown, close: () => { for (const end of stop) end(); canvas.close(); } };
}

/** Windows of the last frame that had begun by a moment. @param {import('../trace/trace.js').Trace} trace @param {number} t_s @returns {Frame[]} */
export function framesAt(trace, t_s) {
  const chunks = trace.file.chunksOf('/frames', -Infinity, t_s);
  for (const index of chunks.slice(-2).reverse()) {
    const { start_s, end_s } = trace.file.chunks[index];
    const frames = /** @type {Frame[]} */ (trace.messages('/frames', start_s, end_s)).filter((frame) => timeOfFrame(frame) <= t_s + kSame_s);
    const last = frames[frames.length - 1];
    if (last) return frames.filter((frame) => frame.sequence === last.sequence);
  }
  return [];
}

/** The measurement of a frame: it has the time of the middle of the exposure. @param {import('../trace/trace.js').Trace} trace @param {Frame | undefined} frame */
function spotOf(trace, frame) {
  if (!frame) return undefined;
  const middle_s = frame.start_s + 0.5 * frame.exposure_s;
  const spot = trace.spotAt(middle_s + kSame_s);
  return spot && Math.abs(spot.t_s - middle_s) < 2 * kSame_s ? spot : undefined;
}

/** @param {import('../trace/trace.js').Trace} trace @param {Frame[]} shown @param {number} t_s */
function wordsOf(trace, [frame], t_s) {
  if (!frame) return trace.file.has('/frames') ? 'No frame was kept up to here.' : 'This trace has no frames.';
  const spot = spotOf(trace, frame);
  const seen = spot && Number.isFinite(spot.x_mm)
    ? `spot at x ${quantity(spot.x_mm, 3)}, y ${quantity(spot.y_mm, 3, 'mm')} ± ${quantity(1000 * spot.sigma_mm, 0, 'µm')}` : 'no spot measured';
  return `frame ${frame.sequence}, ${duration(Math.max(0, t_s - frame.start_s), 3)} before the cursor · exposed ${duration(frame.exposure_s, 3)} · ${seen}`;
}

/** Decoded pictures, the latest ones. */
class Pictures {
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
function inPicture(frames, width, height) {
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
function drawWindows(context, frames, places, pictures, whole) {
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

/** Which window has the measured spot; -1: none. @param {Frame[]} frames @param {Record<string, number> | undefined} spot */
export function windowOf(frames, spot) {
  if (!spot || !Number.isFinite(spot.x_px)) return -1;
  const inside = (/** @type {number} */ at, /** @type {number} */ from, /** @type {number} */ length) => at >= from - 0.5 && at < from + length - 0.5;
  return frames.findIndex(({ windows: [place] }) => inside(spot.x_px, place.x_px, place.width_px) && inside(spot.y_px, place.y_px, place.height_px));
}

/** @param {CanvasRenderingContext2D} context @param {Window} place @param {Placed} placed @param {Record<string, number>} spot @param {string} colour */
function drawSpot(context, place, placed, spot, colour) {
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
