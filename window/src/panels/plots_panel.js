// SPDX-License-Identifier: Apache-2.0
// @ts-check
// Curves over the same span of time as the waveform: deviation of the measured spot, speed, power, speed of the belt.

import uPlot from 'uplot';
import { h, say } from '../shared/dom.js';
import { joined } from '../trace/tables.js';
import { valueAt } from '../trace/search.js';
import { quantity } from '../view/format.js';
import { onTheme, themeOf } from '../view/theme.js';
import { kDetail_s, kGutter_px, kRight_px } from '../waveform/waveform.js';
import { overviewCurve, overviewSpeed, speedOf, spotSpeed, thinned } from './series.js';

/**
 * @typedef {import('../trace/trace.js').Trace} Trace
 * @typedef {import('./series.js').Curve} Curve
 * @typedef {{from: number, to: number}} Span
 * @typedef {{title: string, unit: string, places: number, tone: string, least: number, dots?: boolean, exact: (trace: Trace, span: Span) => Curve | undefined,
 *   coarse?: (trace: Trace, span: Span, step_s: number) => Curve}} Kind
 */

const kHeight_px = 76;
const kMotion = ['belt_mm', 'slip_x_mm', 'slip_y_mm', 'spot_x_mm', 'spot_y_mm', 'power_w'];

/** @param {Trace} trace @param {Span} span */
const motionOf = (trace, span) => joined(trace.rows('/motion', span.from, span.to), kMotion);

/** @type {Kind[]} */
const kKinds = [
  { title: 'Deviation', unit: 'µm', places: 0, tone: 'measured', least: 10, dots: true,
    exact: (trace, span) => {
      const { t_s, columns } = joined(trace.rows('/spot', span.from, span.to), ['deviation_mm']);
      return { t_s, value: columns.deviation_mm.map((value) => 1000 * value) };
    } },
  { title: 'Spot speed', unit: 'mm/s', places: 0, tone: 'acc', least: 20, exact: (trace, span) => spotSpeed(motionOf(trace, span)) },
  { title: 'Power', unit: 'W', places: 1, tone: 'gate', least: 5,
    exact: (trace, span) => {
      const { t_s, columns } = motionOf(trace, span);
      return { t_s, value: columns.power_w };
    },
    coarse: (trace, span, step_s) => overviewCurve(trace.overview.parts(span.from, span.to, step_s), 'power_w') },
  { title: 'Belt speed', unit: 'mm/s', places: 1, tone: 'sensor', least: 1, exact: (trace, span) => speedOf(motionOf(trace, span), 'belt_mm'),
    coarse: (trace, span, step_s) => overviewSpeed(trace.overview.parts(span.from - step_s, span.to, step_s), 'belt_mm') },
];

/** One curve with its axis, and its value at the cursor. */
class Plot {
  /** @param {Kind} kind @param {HTMLElement} parent @param {import('../view/panel.js').PanelPlace} place */
  constructor(kind, parent, { trace, timeline }) {
    this.kind = kind;
    this.trace = trace;
    this.timeline = timeline;
    this.value = h('output', { class: 'tv-plot-value number', 'aria-label': `${kind.title} at the cursor` });
    this.note = h('span', { class: 'tv-plot-note mute' });
    this.holder = h('div', { class: 'tv-plot' });
    this.element = h('div', { class: 'tv-plot-row', role: 'group', 'aria-label': kind.title },
      h('div', { class: 'tv-plot-name' }, h('span', {}, kind.title), h('span', { class: 'mute' }, kind.unit)), this.holder, this.value, this.note);
    parent.append(this.element);
    /** @type {Curve} */
    this.curve = { t_s: [], value: [] };
    this.make();
  }

  make() {
    this.plot?.destroy();
    const theme = themeOf();
    const stroke = theme[this.kind.tone];
    const line = { stroke: theme.line, width: 1 };
    this.plot = new uPlot({
      width: 300, height: kHeight_px, padding: [6, 0, 4, 0], legend: { show: false },
      cursor: { show: false },
      scales: { x: { time: false, range: () => [this.timeline.get().span.from, this.timeline.get().span.to] }, y: { range: (_, low, high) => rangeOf(low, high, this.kind.least) } },
      axes: [{ show: false, grid: line }, { size: kGutter_px, stroke: theme.mute, font: '11px system-ui, sans-serif', grid: line, ticks: { show: false }, gap: 8, splits: (_, __, low, high) => splitsOf(low, high) }],
      series: [{}, { stroke, width: 1.4, spanGaps: false, points: this.kind.dots ? { show: true, size: 3, fill: stroke, width: 0 } : { show: false }, ...(this.kind.dots ? { paths: () => null } : {}) }],
      hooks: { draw: [(plot) => drawCursor(plot, this.timeline.get(), theme.acc)] },
    }, [[], []], this.holder);
    this.resize();
  }

  resize() {
    const width = this.element.clientWidth - kRight_px;
    if (width > kGutter_px + 20 && this.plot && this.plot.width !== width) this.plot.setSize({ width, height: kHeight_px });
  }

  /** Takes the curve of the span anew. */
  data() {
    const { span } = this.timeline.get();
    const plot = /** @type {uPlot} */ (this.plot);
    const columns = Math.max(50, plot.width - kGutter_px);
    const long = span.to - span.from > kDetail_s;
    const curve = long ? this.kind.coarse?.(this.trace, span, (2 * (span.to - span.from)) / columns) : this.kind.exact(this.trace, span);
    say(this.note, long && !curve ? `shown for spans up to ${kDetail_s} s` : '');
    this.curve = curve ?? { t_s: [], value: [] };
    const thin = thinned(this.curve, span, columns);
    plot.setData([thin.t_s, thin.value]);
    this.cursor();
  }

  cursor() {
    const { t_s } = this.timeline.get();
    say(this.value, quantity(this.kind.dots ? nearest(this.curve, t_s) : valueAt(this.curve.t_s, this.curve.value, t_s), this.kind.places, this.kind.unit));
    this.plot?.redraw(false);
  }
}

/** @type {import('../view/panel.js').MakePanel} */
export function plotsPanel(place) {
  const { body, trace, timeline } = place;
  const holder = h('div', { class: 'tv-plots' });
  body.append(holder);
  const plots = kKinds.filter((kind) => kind.title !== 'Deviation' || trace.file.has('/spot')).map((kind) => new Plot(kind, holder, place));
  let wanted = false;
  let stale = true;
  const want = (/** @type {boolean} */ data) => {
    stale ||= data;
    if (wanted) return;
    wanted = true;
    requestAnimationFrame(() => {
      wanted = false;
      for (const plot of plots) stale ? plot.data() : plot.cursor();
      stale = false;
    });
  };
  const resizing = new ResizeObserver(() => {
    for (const plot of plots) plot.resize();
    want(true);
  });
  resizing.observe(holder);
  const stop = [
    timeline.subscribe((state, before) => want(state.span !== before.span)), trace.onLoad(() => want(true)),
    onTheme(() => { for (const plot of plots) plot.make(); want(true); }),
  ];
  want(true);
  return { close: () => { for (const end of stop) end(); resizing.disconnect(); for (const plot of plots) plot.plot?.destroy(); } };
}

/** At least so long that noise is not taken for a curve. @param {number | null} low @param {number | null} high @param {number} least @returns {[number, number]} */
function rangeOf(low, high, least) {
  if (low === null || high === null || !Number.isFinite(low)) return [0, least];
  if (low >= 0 && low < 0.5 * high) return [0, Math.max(1.08 * high, least)];
  const half = Math.max(0.58 * (high - low), 0.5 * least);
  const middle = 0.5 * (low + high);
  return [middle - half, middle + half];
}

/** Two or three round values of an axis. @param {number} low @param {number} high */
function splitsOf(low, high) {
  const power = 10 ** Math.floor(Math.log10((high - low) / 2));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((one) => (high - low) / one <= 4) ?? 10 * power;
  const splits = [];
  for (let k = Math.ceil(low / step); k * step <= high; ++k) splits.push(k * step + 0); // Without the sign of a negative zero.
  return splits;
}

/** Value of the row nearest to a time, within a tenth of a second. @param {Curve} curve @param {number} t_s */
function nearest({ t_s: times, value }, t_s) {
  let best = NaN;
  let away = 0.1;
  for (let i = 0; i < times.length; ++i) {
    if (Number.isNaN(value[i]) || Math.abs(times[i] - t_s) >= away) continue;
    away = Math.abs(times[i] - t_s);
    best = value[i];
  }
  return best;
}

/** @param {uPlot} plot @param {import('../time/timeline.js').TimeState} state @param {string} colour */
function drawCursor(plot, { t_s, span }, colour) {
  if (t_s < span.from || t_s > span.to) return;
  const x = plot.valToPos(t_s, 'x', true);
  plot.ctx.fillStyle = colour;
  plot.ctx.fillRect(x - 0.75 * devicePixelRatio, plot.bbox.top, 1.5 * devicePixelRatio, plot.bbox.height);
}
