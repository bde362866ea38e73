// SPDX-License-Identifier: Apache-2.0
// @ts-check
// Marks of a time axis: round, not too close, and readable from an hour down to one tick of the pins.

import { duration, roundStep } from '../view/format.js';

/**
 * @param {{from: number, to: number}} span s @param {number} width_px @param {number} [apart_px] least distance
 * @returns {{marks: {t_s: number, label: string}[], base?: string}} base: what all labels are counted from, where it is not 0
 */
export function axisOf(span, width_px, apart_px = 92) {
  const perPixel = (span.to - span.from) / width_px;
  const step = roundStep(apart_px * perPixel);
  const relative = step < 0.999e-3;
  // Labels within a millisecond are counted from it: nobody reads eleven digits.
  const unit = relative ? 1000 * step : 1;
  const from = relative ? Math.floor(span.from / unit) * unit : 0;
  const marks = [];
  for (let k = Math.ceil((span.from - from) / step - 1e-9); from + k * step <= span.to + 1e-9 * step; ++k) {
    const offset = k * step;
    marks.push({ t_s: from + offset, label: relative ? `+${duration(offset)}` : seconds(offset, step) });
  }
  return relative ? { marks, base: `${from.toFixed(Math.max(0, Math.ceil(-Math.log10(unit) - 1e-9)))} s` } : { marks };
}

/** @param {number} t_s @param {number} step */
function seconds(t_s, step) {
  const places = Math.max(0, Math.ceil(-Math.log10(step) - 1e-9));
  if (t_s < 60 || places > 0) return `${t_s.toFixed(places)} s`;
  const whole = Math.round(t_s);
  const text = (/** @type {number} */ n) => String(n).padStart(2, '0');
  const clock = `${text(Math.floor(whole / 60) % 60)}:${text(whole % 60)}`;
  return whole >= 3600 ? `${Math.floor(whole / 3600)}:${clock}` : clock;
}
