// SPDX-License-Identifier: Apache-2.0
// @ts-check
// The pins over time, as a logic analyser shows them: from the whole run to one tick.

import { h, fill, say } from '../shared/dom.js';
import { panned, zoomed } from '../time/timeline.js';
import { sharpCanvas } from '../view/canvas.js';
import { duration, grouped } from '../view/format.js';
import { axisOf } from './axis.js';
import { levelAt, pulseAt } from './measure.js';
import { countedEdges, drawCounts, drawEdges, edgesBetween, moves, rowsOf } from './rows.js';

/** @typedef {import('../trace/trace.js').Trace} Trace */

export const kGutter_px = 118;
export const kRight_px = 94;
const kAxis_px = 22;
const kRow_px = 20;
const kGroup_px = 7;
export const kDetail_s = 30; // Longer spans are shown by the overview.
const kLeastTicks = 12; // The shortest span: some ticks.
const kStill = { ticks: new Float64Array(0), levelBefore: 0 }; // A pin that never moved.
const kFont = '11px system-ui, sans-serif';

export class Waveform {
  /** @param {import('../view/panel.js').PanelPlace} place */
  constructor({ body: element, tools, trace, timeline }) {
    this.trace = trace;
    this.timeline = timeline;
    this.all = rowsOf(trace.machine);
    const whole = trace.overview.parts(trace.extent_s.from, trace.extent_s.to, 100);
    this.moving = whole.length ? this.all.filter((row) => moves(whole, row.id)) : this.all;
    this.rows = this.moving;
    if (this.moving.length < this.all.length) tools.append(this.#choice());
    this.surface = h('div', { class: 'tv-waveform', tabindex: '0', role: 'group', 'aria-label': 'Pins over time. Plus and minus zoom, A and B set the marks.' });
    this.#stretch();
    this.pulses = h('div', { class: 'tv-pulses', role: 'status', 'aria-label': 'Pulses at the cursor' });
    this.levels = h('output', { class: 'tv-unseen', 'aria-label': 'Levels at the cursor' });
    element.append(h('div', { class: 'tv-waveform-scroll' }, this.surface), this.levels, this.pulses);
    this.canvas = sharpCanvas(this.surface, 'Levels of the pins over time', (...args) => this.#draw(...args));
    this.#listen();
    this.stop = [
      timeline.subscribe((state, before) => {
        this.canvas.want();
        if (state.t_s !== before.t_s) this.#measure();
      }),
      trace.onLoad(() => {
        this.canvas.want();
        this.#measure();
      }),
    ];
    this.#measure();
  }

  /** Whether pins that never move are shown too. */
  #choice() {
    const still = this.all.length - this.moving.length;
    const button = h('button', { type: 'button', 'aria-pressed': 'false', title: `${still} pins never move in this run`, on: { click: () => {
      this.rows = this.rows === this.all ? this.moving : this.all;
      button.setAttribute('aria-pressed', String(this.rows === this.all));
      this.#stretch();
      this.canvas.want();
    } } }, `Still pins (${still})`);
    return button;
  }

  #stretch() {
    const groups = new Set(this.rows.map((row) => row.group)).size;
    this.surface.style.minHeight = `${kAxis_px + this.rows.length * kRow_px + groups * kGroup_px + 2}px`;
  }

  get least_s() {
    return kLeastTicks / this.trace.machine.tick_hz;
  }

  #plotWidth() {
    return Math.max(50, this.surface.clientWidth - kGutter_px - kRight_px);
  }

  /** @param {{clientX: number}} event */
  #timeAt(event) {
    const { span } = this.timeline.get();
    const x = event.clientX - this.surface.getBoundingClientRect().left - kGutter_px;
    return span.from + (x / this.#plotWidth()) * (span.to - span.from);
  }

  #listen() {
    const { surface, timeline } = this;
    surface.addEventListener('wheel', (/** @type {WheelEvent} */ event) => {
      event.preventDefault();
      const { span } = timeline.get();
      if (event.shiftKey || Math.abs(event.deltaX) > Math.abs(event.deltaY)) {
        const delta = event.shiftKey && !event.deltaX ? event.deltaY : event.deltaX;
        timeline.update((state) => panned(state, (delta / this.#plotWidth()) * (span.to - span.from)));
      } else timeline.update((state) => zoomed(state, Math.exp(0.0022 * event.deltaY), this.#timeAt(event), this.least_s));
    }, { passive: false });
    surface.addEventListener('pointerdown', (/** @type {PointerEvent} */ event) => this.#drag(event));
  }

  /** A click sets the cursor, dragging moves the span, with shift it sets both marks. @param {PointerEvent} down */
  #drag(down) {
    if (down.button !== 0) return;
    const { surface, timeline } = this;
    surface.setPointerCapture(down.pointerId);
    const start_s = this.#timeAt(down);
    const { span } = timeline.get();
    let moved = false;
    const move = (/** @type {PointerEvent} */ event) => {
      if (Math.abs(event.clientX - down.clientX) > 3) moved = true;
      if (!moved) return;
      if (down.shiftKey) timeline.update((state) => ({ ...state, a_s: start_s, b_s: this.#timeAt(event) }));
      else {
        const shift_s = ((down.clientX - event.clientX) / this.#plotWidth()) * (span.to - span.from);
        timeline.update((state) => panned({ ...state, span }, shift_s));
      }
    };
    const up = (/** @type {PointerEvent} */ event) => {
      surface.removeEventListener('pointermove', move);
      if (!moved) timeline.go(this.#timeAt(event));
    };
    surface.addEventListener('pointermove', move);
    surface.addEventListener('pointerup', up, { once: true });
  }

  /** What the drives get at the cursor: nearest active edge, set-up, hold, width. */
  #measure() {
    const { machine } = this.trace;
    const { t_s } = this.timeline.get();
    const window = this.trace.pins(t_s - 0.05, t_s + 0.05);
    const hz = machine.tick_hz;
    say(this.levels, window ? this.rows.map(({ id, name }) => `${name} ${levelAt(window.pins.get(id) ?? kStill, t_s * hz) ? 'high' : 'low'}`).join(', ') : '');
    const items = window ? machine.drives.map((drive) => {
      const pul = window.pins.get(drive.pul);
      const dir = window.pins.get(drive.dir);
      const times = pul && dir && pulseAt(pul, dir, drive.active_edge === 'rising', t_s * hz);
      if (!times) return null;
      return h('li', {}, h('b', {}, drive.axis), h('span', {}, 'pulse at ', h('span', { class: 'number' }, offset(times.tick / hz - t_s))),
        told('set-up', times.setup, times.tick - window.from_tick, drive.setup_s, hz), told('hold', times.hold, window.to_tick - times.tick, drive.hold_s, hz),
        told('width', times.width, window.to_tick - times.tick, drive.width_s, hz), told('idle', times.space, times.tick - window.from_tick, drive.space_s, hz));
    }) : [];
    fill(this.pulses, items.some(Boolean) ? h('ul', {}, items) : h('span', { class: 'mute' }, 'No pulse within 50 ms of the cursor.'));
  }

  /** @param {CanvasRenderingContext2D} context @param {number} width @param {number} height @param {import('../view/theme.js').Theme} theme */
  #draw(context, width, height, theme) {
    const { span } = this.timeline.get();
    const plot = width - kGutter_px - kRight_px;
    if (plot < 20) return;
    context.font = kFont;
    context.textBaseline = 'middle';
    this.#drawAxis(context, plot, height, theme);
    const detail = span.to - span.from <= kDetail_s ? this.trace.pins(span.from, span.to) : undefined;
    const parts = detail ? [] : this.trace.overview.parts(span.from, span.to, 2.5 * ((span.to - span.from) / plot));
    const counted = this.#countSpan(detail, parts);
    let y = kAxis_px;
    let group = this.rows[0]?.group;
    for (const row of this.rows) {
      if (row.group !== group) {
        context.fillStyle = theme.line;
        context.fillRect(0, Math.round(y + kGroup_px / 2), width, 1);
        y += kGroup_px;
        group = row.group;
      }
      const at = { x: kGutter_px, y, width: plot, height: kRow_px };
      this.#drawRow(context, at, row, theme, detail, parts);
      context.fillStyle = theme.mute;
      context.textAlign = 'left';
      context.fillText(counted(row), kGutter_px + plot + 8, y + kRow_px / 2 + 1);
      y += kRow_px;
    }
    this.#drawMarks(context, plot, height, theme);
  }

  /** @param {CanvasRenderingContext2D} context @param {{x: number, y: number, width: number, height: number}} at @param {import('./rows.js').Row} row
   * @param {import('../view/theme.js').Theme} theme @param {import('../trace/pins.js').PinWindow | undefined} detail @param {import('../trace/overview.js').OverviewPart[]} parts */
  #drawRow(context, at, row, theme, detail, parts) {
    const { span } = this.timeline.get();
    context.textAlign = 'right';
    context.fillStyle = theme.fg;
    context.fillText(row.name, kGutter_px - 10, at.y + at.height / 2 + 1);
    context.save();
    context.beginPath();
    context.rect(at.x, at.y, at.width, at.height);
    context.clip();
    if (detail) {
      const hz = this.trace.machine.tick_hz;
      const pin = detail.pins.get(row.id) ?? kStill;
      drawEdges(context, at, pin, span.from * hz, ((span.to - span.from) * hz) / at.width, theme[row.tone], theme.fg);
    } else drawCounts(context, at, parts, row.id, span, theme[row.tone], theme.fg);
    context.restore();
  }

  /** How many edges a pin has, between the marks if there are two, else in the span. @param {import('../trace/pins.js').PinWindow | undefined} detail
   * @param {import('../trace/overview.js').OverviewPart[]} parts @returns {(row: import('./rows.js').Row) => string} */
  #countSpan(detail, parts) {
    const { span, a_s, b_s } = this.timeline.get();
    const between = a_s !== null && b_s !== null;
    const [from, to] = between ? [Math.min(a_s, b_s), Math.max(a_s, b_s)] : [span.from, span.to];
    const hz = this.trace.machine.tick_hz;
    const window = between && to - from <= kDetail_s ? this.trace.details && pinsOf(this.trace, from, to, detail, span) : detail;
    return (row) => {
      const pin = window?.pins.get(row.id);
      if (pin) {
        const edges = edgesBetween(pin, from * hz, to * hz);
        return `${grouped(edges)} ${edges === 1 ? 'edge' : 'edges'}`;
      }
      return window ? '0 edges' : `${grouped(countedEdges(parts, row.id, { from, to }))} edges`;
    };
  }

  /** @param {CanvasRenderingContext2D} context @param {number} plot @param {number} height @param {import('../view/theme.js').Theme} theme */
  #drawAxis(context, plot, height, theme) {
    const { span } = this.timeline.get();
    const toX = (/** @type {number} */ t) => kGutter_px + ((t - span.from) / (span.to - span.from)) * plot;
    const axis = axisOf(span, plot);
    const tick_px = plot / ((span.to - span.from) * this.trace.machine.tick_hz);
    context.fillStyle = theme.line;
    if (tick_px > 5) {
      context.globalAlpha = 0.45;
      const hz = this.trace.machine.tick_hz;
      for (let k = Math.ceil(span.from * hz); k <= span.to * hz; ++k) context.fillRect(toX(k / hz), kAxis_px, 0.5, height - kAxis_px);
      context.globalAlpha = 1;
    }
    for (const { t_s, label } of axis.marks) {
      const x = toX(t_s);
      context.fillStyle = theme.line;
      context.fillRect(Math.round(x), kAxis_px - 5, 1, height - kAxis_px + 5);
      context.fillStyle = theme.mute;
      context.textAlign = 'center';
      if (x > kGutter_px + 18 && x < kGutter_px + plot - 12) context.fillText(label, x, kAxis_px / 2 - 1);
    }
    context.textAlign = 'right';
    context.fillStyle = theme.mute;
    if (axis.base) context.fillText(axis.base, kGutter_px - 10, kAxis_px / 2 - 1);
  }

  /** @param {CanvasRenderingContext2D} context @param {number} plot @param {number} height @param {import('../view/theme.js').Theme} theme */
  #drawMarks(context, plot, height, theme) {
    const { t_s, a_s, b_s, span } = this.timeline.get();
    const toX = (/** @type {number} */ t) => kGutter_px + ((t - span.from) / (span.to - span.from)) * plot;
    const inside = (/** @type {number} */ t) => t >= span.from && t <= span.to;
    if (a_s !== null && b_s !== null) {
      const from = Math.max(kGutter_px, toX(Math.min(a_s, b_s)));
      const to = Math.min(kGutter_px + plot, toX(Math.max(a_s, b_s)));
      context.fillStyle = theme.np;
      context.globalAlpha = 0.09;
      if (to > from) context.fillRect(from, kAxis_px, to - from, height);
      context.globalAlpha = 1;
      const words = `${duration(Math.abs(b_s - a_s), 6)}`;
      context.textAlign = 'center';
      if (to - from > 60) badge(context, 0.5 * (from + to), 11, words, theme.np, theme.bg);
    }
    for (const [name, at_s] of /** @type {[string, number | null][]} */ ([['A', a_s], ['B', b_s]])) {
      if (at_s === null || !inside(at_s)) continue;
      context.fillStyle = theme.np;
      context.fillRect(toX(at_s) - 0.5, kAxis_px - 8, 1, height);
      badge(context, toX(at_s), 11, name, theme.np, theme.bg);
    }
    if (inside(t_s)) {
      context.fillStyle = theme.acc;
      context.fillRect(toX(t_s) - 0.75, 4, 1.5, height);
      context.beginPath();
      context.moveTo(toX(t_s) - 5, 2);
      context.lineTo(toX(t_s) + 5, 2);
      context.lineTo(toX(t_s), 9);
      context.fill();
    }
  }

  close() {
    for (const stop of this.stop) stop();
    this.canvas.close();
  }
}

/** Edges between two times: of what is shown, if they lie in it. @param {Trace} trace @param {number} from @param {number} to
 * @param {import('../trace/pins.js').PinWindow | undefined} shown @param {{from: number, to: number}} span */
function pinsOf(trace, from, to, shown, span) {
  return shown && from >= span.from && to <= span.to ? shown : trace.pins(from, to);
}

/** @param {CanvasRenderingContext2D} context @param {number} x @param {number} y @param {string} words @param {string} colour @param {string} ink */
function badge(context, x, y, words, colour, ink) {
  const width = context.measureText(words).width + 9;
  context.fillStyle = colour;
  context.beginPath();
  context.roundRect(x - width / 2, y - 8, width, 16, 4);
  context.fill();
  context.fillStyle = ink;
  context.textAlign = 'center';
  context.fillText(words, x, y + 0.5);
}

/** @param {number} seconds */
const offset = (seconds) => (seconds >= 0 ? '+' : '−') + duration(Math.abs(seconds), 5);

/**
 * A measured time beside what the data sheet asks for.
 * @param {string} name @param {number} ticks measured, Infinity: longer than what was looked at @param {number} seen ticks that were looked at
 * @param {number} least_s @param {number} hz
 */
function told(name, ticks, seen, least_s, hz) {
  const good = ticks >= least_s * hz * (1 - 1e-9);
  const value = Number.isFinite(ticks) ? duration(ticks / hz, 5) : `over ${duration(seen / hz, 2)}`;
  return h('span', { class: good ? 'tv-told' : 'tv-told tv-short' }, `${name} `, h('span', { class: 'number' }, value),
    h('span', { class: 'mute' }, good ? ` ≥ ${duration(least_s)}` : ` below ${duration(least_s)}`));
}
