// SPDX-License-Identifier: Apache-2.0
// @ts-check
// What the spot camera saw last: the windows that were read out of its picture, at their places.

import { h, say } from '../shared/dom.js';
import { timeOfFrame } from '../time/steps.js';
import { sharpCanvas } from '../view/canvas.js';
import { duration, quantity } from '../view/format.js';

/**
 * @typedef {{timestamp: {sec: number, nsec: number}, sequence: number, start_s: number, exposure_s: number, data: string, format: string,
 *   windows: {x_px: number, y_px: number, width_px: number, height_px: number}[], width_px: number, height_px: number}} Frame
 */

const kKeep = 40;
const kTwin_s = 1e-6; // A frame and its measurement have the same time.

/** @type {import('../view/panel.js').MakePanel} */
export function framesPanel({ body, tools, trace, timeline }) {
  const surface = h('div', { class: 'surface dark' });
  const reading = h('output', { class: 'reading', 'aria-label': 'Frame and measured spot' });
  body.append(surface, h('div', { class: 'panel-foot' }, reading));
  let whole = false;
  const choice = h('button', { type: 'button', 'aria-pressed': 'false', title: 'The place of the windows in the whole picture', on: { click: () => {
    whole = !whole;
    choice.setAttribute('aria-pressed', String(whole));
    canvas.want();
  } } }, 'Whole picture');
  tools.append(choice);
  const pictures = new Pictures(() => canvas.want());
  /** @type {Frame[]} */
  let shown = [];
  const canvas = sharpCanvas(surface, 'Windows of the spot camera', (context, width, height, theme) => {
    drawFrame(context, width, height, shown, pictures, whole, theme, spotOf(trace, shown[0]));
  });
  const update = () => {
    shown = framesAt(trace, timeline.get().t_s);
    say(reading, words(trace, shown, timeline.get().t_s));
    canvas.want();
  };
  update();
  const stop = [timeline.subscribe((state, before) => state.t_s !== before.t_s && update()), trace.onLoad(update)];
  return { shown: () => shown, close: () => { for (const end of stop) end(); canvas.close(); } };
}

/** Windows of the last frame up to a moment. @param {import('../trace/trace.js').Trace} trace @param {number} t_s @returns {Frame[]} */
export function framesAt(trace, t_s) {
  const chunks = trace.file.chunksOf('/frames', -Infinity, t_s);
  for (const index of chunks.slice(-2).reverse()) {
    const { start_s, end_s } = trace.file.chunks[index];
    const frames = /** @type {Frame[]} */ (trace.messages('/frames', start_s, end_s)).filter((frame) => timeOfFrame(frame) <= t_s + kTwin_s);
    const last = frames[frames.length - 1];
    if (last) return frames.filter((frame) => frame.sequence === last.sequence);
  }
  return [];
}

/** The measurement of a frame. @param {import('../trace/trace.js').Trace} trace @param {Frame | undefined} frame */
function spotOf(trace, frame) {
  if (!frame) return undefined;
  const t_s = timeOfFrame(frame);
  const spot = trace.spotAt(t_s + kTwin_s);
  return spot && Math.abs(spot.t_s - t_s) < frame.exposure_s + kTwin_s ? spot : undefined;
}

/** @param {import('../trace/trace.js').Trace} trace @param {Frame[]} shown @param {number} t_s */
function words(trace, [frame], t_s) {
  if (!frame) return trace.file.has('/frames') ? 'No frame up to here.' : 'This trace has no frames.';
  const spot = spotOf(trace, frame);
  const seen = spot && Number.isFinite(spot.x_mm)
    ? `spot at x ${quantity(spot.x_mm, 3)} y ${quantity(spot.y_mm, 3, 'mm')} ± ${quantity(1000 * spot.sigma_mm, 0, 'µm')}` : 'no spot measured';
  return `frame ${frame.sequence}, ${duration(Math.max(0, t_s - timeOfFrame(frame)), 3)} before the cursor · exposed ${duration(frame.exposure_s, 3)} · ${seen}`;
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

/** @param {CanvasRenderingContext2D} context @param {number} width @param {number} height @param {Frame[]} frames @param {Pictures} pictures
 * @param {boolean} whole @param {import('../view/theme.js').Theme} theme @param {Record<string, number> | undefined} spot */
function drawFrame(context, width, height, frames, pictures, whole, theme, spot) {
  const [first] = frames;
  if (!first) return;
  const windows = frames.flatMap((frame) => frame.windows);
  const box = whole ? { x: 0, y: 0, w: first.width_px, h: first.height_px } : around(windows);
  const scale = Math.min((width - 12) / box.w, (height - 12) / box.h);
  const toX = (/** @type {number} */ x) => width / 2 + scale * (x - box.x - box.w / 2);
  const toY = (/** @type {number} */ y) => height / 2 + scale * (y - box.y - box.h / 2);
  context.imageSmoothingEnabled = scale < 1;
  if (whole) {
    context.strokeStyle = '#5a6472';
    context.strokeRect(toX(0), toY(0), scale * box.w, scale * box.h);
  }
  for (const frame of frames) {
    const [place] = frame.windows;
    const picture = pictures.of(frame);
    if (!place) continue;
    if (picture) context.drawImage(picture, toX(place.x_px), toY(place.y_px), scale * picture.width, scale * picture.height);
    if (whole || frames.length > 1) {
      context.strokeStyle = '#8d99a8';
      context.strokeRect(toX(place.x_px) - 0.5, toY(place.y_px) - 0.5, scale * place.width_px + 1, scale * place.height_px + 1);
    }
  }
  if (!spot || !Number.isFinite(spot.x_px)) return;
  // Pixel (0, 0) has its centre at 0: its edge is half a pixel before.
  const [x, y] = [toX(spot.x_px + 0.5), toY(spot.y_px + 0.5)];
  context.strokeStyle = theme.measured;
  context.lineWidth = 1.5;
  context.beginPath();
  for (const [dx, dy] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) {
    context.moveTo(x + 5 * dx, y + 5 * dy);
    context.lineTo(x + 13 * dx, y + 13 * dy);
  }
  context.stroke();
}

/** @param {Frame['windows']} windows */
function around(windows) {
  const x = Math.min(...windows.map((one) => one.x_px));
  const y = Math.min(...windows.map((one) => one.y_px));
  return { x, y, w: Math.max(...windows.map((one) => one.x_px + one.width_px)) - x, h: Math.max(...windows.map((one) => one.y_px + one.height_px)) - y };
}
