// SPDX-License-Identifier: Apache-2.0
// @ts-check
// What the spot camera saw last: the windows that were read out of its picture, side by side or at their places in it. Few pictures are
// kept and each frame is measured, so where the spot has got to since the picture is marked as well.

import { h, say } from '../shared/dom.js';
import { timeOfFrame } from '../time/steps.js';
import { countUpTo } from '../trace/search.js';
import { sharpCanvas } from '../view/canvas.js';
import { duration, quantity } from '../view/format.js';
import { aroundOne, drawNow, drawSpot, drawWay, drawWindows, inPicture, originOf, Pictures, sideBySide, windowOf } from './frames_drawing.js';

/**
 * @typedef {{x_px: number, y_px: number, width_px: number, height_px: number}} Window
 * @typedef {{timestamp: {sec: number, nsec: number}, sequence: number, start_s: number, exposure_s: number, data: string, format: string,
 *   windows: Window[], width_px: number, height_px: number}} Frame one message: a window of a frame
 */

const kSame_s = 1e-6;

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
    const way = wayTo(trace, shown[0], timeline.get().t_s);
    if (whole && places[0]) drawWay(context, originOf(shown[0], places[0]), places[0].scale, way, theme.acc);
    else drawNow(context, shown, places, way, { home: at, colour: theme.acc });
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
  return trace.lastIn('/frames', t_s, (/** @type {Frame[]} */ part) => {
    const last = part.findLast((frame) => timeOfFrame(frame) <= t_s + kSame_s);
    return last && part.filter((frame) => frame.sequence === last.sequence);
  }) ?? [];
}

/** The first frame that was kept after a moment; undefined also while it comes. @param {import('../trace/trace.js').Trace} trace @param {number} t_s @returns {Frame | undefined} */
export function nextFrame(trace, t_s) {
  const { chunks } = trace.file;
  // The chunk of the moment itself, and the first one that begins after it.
  const indexes = trace.file.chunksOf('/frames', t_s, Infinity);
  const upTo = indexes.findIndex((index) => chunks[index].start_s > t_s);
  for (const index of upTo < 0 ? indexes : indexes.slice(0, upTo + 1)) {
    const found = trace.details.peekPart('/frames', index)?.find((/** @type {Frame} */ frame) => timeOfFrame(frame) > t_s + kSame_s);
    if (found) return found;
  }
  return undefined;
}

/**
 * Where the spot was measured from a frame on up to a moment, in pixels of the whole picture; frames in which it was dark are left out.
 * @param {import('../trace/trace.js').Trace} trace @param {Frame | undefined} frame @param {number} t_s @returns {{x_px: number, y_px: number}[]}
 */
export function wayTo(trace, frame, t_s) {
  /** @type {{x_px: number, y_px: number}[]} */
  const way = [];
  if (!frame || !trace.file.has('/spot')) return way;
  for (const { t_s: times, columns } of trace.rows('/spot', frame.start_s, t_s)) {
    const end = countUpTo(times, t_s + kSame_s);
    for (let i = countUpTo(times, frame.start_s - kSame_s); i < end; ++i)
      if (Number.isFinite(columns.x_px[i])) way.push({ x_px: columns.x_px[i], y_px: columns.y_px[i] });
  }
  return way;
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
  const now = trace.spotAt(t_s);
  const moved = !now || now.t_s <= frame.start_s + frame.exposure_s ? ''
    : ` · by the cursor ${Number.isFinite(now.x_mm) ? `at x ${quantity(now.x_mm, 3)}, y ${quantity(now.y_mm, 3, 'mm')}` : 'dark'}`;
  return `frame ${frame.sequence}, ${duration(Math.max(0, t_s - frame.start_s), 3)} before the cursor${nextWords(trace, frame, t_s)} · exposed ${duration(frame.exposure_s, 3)} · ${seen}${moved}`;
}

/** Why no nearer frame is shown. @param {import('../trace/trace.js').Trace} trace @param {Frame} frame @param {number} t_s */
function nextWords(trace, frame, t_s) {
  const next = nextFrame(trace, t_s);
  if (!next) return '';
  const every = next.sequence - frame.sequence;
  return `, next in ${duration(timeOfFrame(next) - t_s, 3)}${every > 1 ? ` (one of ${every} was kept)` : ''}`;
}
