// SPDX-License-Identifier: Apache-2.0
// @ts-check
// The dieline of the unit that is cut, with where the pulses led the beam, where the model's beam really was, and where the
// camera saw the spot. All in S of that unit, mm.

import { h, say } from '../shared/dom.js';
import { sharpCanvas } from '../view/canvas.js';
import { quantity, roundStep } from '../view/format.js';
import { countUpTo } from '../trace/search.js';

/** @typedef {import('../trace/trace.js').Trace} Trace */

const kTrail_s = 0.06;
const kSeen_s = 1.5; // Measured spots of so long before the cursor are shown.
const kEdge_px = 18;

/** @type {import('../view/panel.js').MakePanel} */
export function dielinePanel({ body, tools, trace, timeline }) {
  const { machine } = trace;
  const surface = h('div', { class: 'tv-surface' });
  const legend = h('div', { class: 'tv-legend' });
  const reading = h('output', { class: 'tv-reading', 'aria-label': 'Distances at the cursor' });
  body.append(surface, h('div', { class: 'tv-panel-foot' }, legend, reading));
  for (const [tone, words, why] of [['commanded', 'commanded', 'Where the counted pulses led the beam'], ['true', 'true (model)', 'Where the beam of the model was: no camera saw it'], ['measured', 'measured', 'Where the spot camera saw it']])
    legend.append(h('span', { class: `tv-key tv-key-${tone}`, title: why }, words));

  let magnify = 1; // 1: the whole unit; more: around the spot.
  const zoom = h('select', { 'aria-label': 'Magnification', on: { change: () => { magnify = Number(zoom.value); canvas.want(); } } },
    [['1', 'Whole unit'], ['4', '4 × at the spot'], ['20', '20 × at the spot'], ['100', '100 × at the spot'], ['400', '400 × at the spot']].map(([value, words]) => h('option', { value }, words)));
  tools.append(zoom);

  const canvas = sharpCanvas(surface, 'Dieline with the spot', (context, width, height, theme) => {
    const { t_s } = timeline.get();
    const now = placesAt(trace, t_s);
    const box = machine.web.unit;
    const fit = Math.min((width - 2 * kEdge_px) / (box.max_mm[0] - box.min_mm[0]), (height - 2 * kEdge_px) / (box.max_mm[1] - box.min_mm[1]));
    const scale = fit * magnify;
    const focus = magnify > 1 && (now.real ?? now.commanded) || [0.5 * (box.min_mm[0] + box.max_mm[0]), 0.5 * (box.min_mm[1] + box.max_mm[1])];
    const to = (/** @type {number[]} */ [x, y]) => /** @type {[number, number]} */ ([width / 2 + scale * (x - focus[0]), height / 2 - scale * (y - focus[1])]);
    drawSheet(context, machine, to, scale, theme);
    drawTrails(context, trace, t_s, now.unit, to, theme);
    drawPlaces(context, now, to, theme);
    drawScale(context, width, height, scale, theme);
  });

  const update = () => {
    const now = placesAt(trace, timeline.get().t_s);
    const apart = (/** @type {number[] | undefined} */ a, /** @type {number[] | undefined} */ b) => (a && b ? Math.hypot(a[0] - b[0], a[1] - b[1]) : NaN);
    const gap = 1000 * apart(now.commanded, now.real);
    say(reading, `unit ${now.unit} · commanded to true ${quantity(gap, 0, 'µm')} · measured deviation ${quantity(1000 * now.deviation_mm, 0, 'µm')}`);
    canvas.want();
  };
  update();
  const stop = [timeline.subscribe((state, before) => state.t_s !== before.t_s && update()), trace.onLoad(update)];
  return { close: () => { for (const end of stop) end(); canvas.close(); } };
}

/**
 * Places at a moment in S of the unit that is cut then.
 * @param {Trace} trace @param {number} t_s
 * @returns {{unit: number, commanded?: number[], real?: number[], lit: boolean, measured?: number[], measured_s?: number, deviation_mm: number}}
 */
export function placesAt(trace, t_s) {
  const { machine } = trace;
  const motion = trace.motionAt(t_s);
  const commanded = trace.commandedAt(t_s);
  const spot = trace.spotAt(t_s);
  const web_mm = motion ? webAt(trace, motion) : undefined;
  const unit = unitAt(trace, t_s, web_mm?.[0]);
  const pitch = unit * machine.web.pitch_mm;
  /** @type {(x: number | undefined, y: number | undefined) => number[] | undefined} */
  const toUnit = (x, y) => (web_mm && x !== undefined && y !== undefined && Number.isFinite(x) && Number.isFinite(y) ? [x - web_mm[0] + pitch, y - web_mm[1]] : undefined);
  return {
    unit, lit: (motion?.lit ?? 0) > 0.5, deviation_mm: NaN,
    commanded: toUnit(commanded?.x_mm, commanded?.y_mm), real: toUnit(motion?.spot_x_mm, motion?.spot_y_mm),
    ...(spot && t_s - spot.t_s < 0.05 && spot.unit === unit ? { measured: onSheet(spot), measured_s: spot.t_s, deviation_mm: spot.deviation_mm } : {}),
  };
}

/** Place of S of unit 0 in W. @param {Trace} trace @param {Record<string, number>} motion */
const webAt = ({ machine }, motion) => [machine.web.start_x_mm + (motion.belt_mm ?? 0) + (motion.slip_x_mm ?? 0), motion.slip_y_mm ?? 0];

/** The unit that is cut, or the one that is nearest to the middle of the field. @param {Trace} trace @param {number} t_s @param {number | undefined} web_x_mm */
function unitAt(trace, t_s, web_x_mm) {
  const line = trace.lineAt(t_s);
  if (line && line.unit >= 0) return line.unit;
  const { web, field } = trace.machine;
  if (!(web.pitch_mm > 0) || web_x_mm === undefined) return 0;
  const middle = 0.5 * (web.unit.min_mm[0] + web.unit.max_mm[0] - field.min_mm[0] - field.max_mm[0]);
  return Math.min(Math.max(0, Math.round((web_x_mm + middle) / web.pitch_mm)), Math.max(0, web.units - 1));
}

/** The measured spot in S, by the pose of the sheet that was measured with it. @param {Record<string, number>} spot */
function onSheet({ x_mm, y_mm, sheet_x_mm, sheet_y_mm, sheet_rad }) {
  const [x, y] = [x_mm - sheet_x_mm, y_mm - sheet_y_mm];
  const place = [Math.cos(sheet_rad) * x + Math.sin(sheet_rad) * y, Math.cos(sheet_rad) * y - Math.sin(sheet_rad) * x];
  return place.every(Number.isFinite) ? place : undefined;
}

/** @param {CanvasRenderingContext2D} context @param {import('../trace/machine.js').Machine} machine @param {(p: number[]) => [number, number]} to @param {number} scale @param {import('../view/theme.js').Theme} theme */
function drawSheet(context, machine, to, scale, theme) {
  const { min_mm, max_mm } = machine.web.unit;
  const [left, bottom] = to(min_mm);
  const [right, top] = to(max_mm);
  context.fillStyle = theme.card;
  context.fillRect(left, top, right - left, bottom - top);
  context.fillStyle = theme.line;
  for (const { x_mm, y_mm, diameter_mm } of machine.web.marks) {
    const [x, y] = to([x_mm, y_mm]);
    context.beginPath();
    context.arc(x, y, Math.max(1.5, (scale * diameter_mm) / 2), 0, 7);
    context.fill();
  }
  context.lineWidth = 1.2;
  context.strokeStyle = theme.mute;
  for (const { points_mm, closed, process } of machine.dieline) {
    context.setLineDash(process === 'cut' ? [] : process === 'perforation' ? [3, 3] : [7, 3]);
    context.beginPath();
    for (const point of points_mm) context.lineTo(...to(point));
    if (closed) context.closePath();
    context.stroke();
  }
  context.setLineDash([]);
}

/** @param {CanvasRenderingContext2D} context @param {Trace} trace @param {number} t_s @param {number} unit @param {(p: number[]) => [number, number]} to @param {import('../view/theme.js').Theme} theme */
function drawTrails(context, trace, t_s, unit, to, theme) {
  const { start_x_mm, pitch_mm } = trace.machine.web;
  const motion = trace.rows('/motion', t_s - kTrail_s, t_s);
  const commanded = trace.rows('/commanded', t_s - kTrail_s, t_s);
  drawMeasured(context, trace, t_s, unit, to, theme);
  for (const [tables, x, y, tone] of /** @type {[import('../trace/tables.js').Table[], string, string, string][]} */ ([[commanded, 'x_mm', 'y_mm', 'commanded'], [motion, 'spot_x_mm', 'spot_y_mm', 'true']])) {
    context.strokeStyle = theme[tone];
    context.lineWidth = tone === 'true' ? 1.8 : 1.2;
    context.beginPath();
    tables.forEach((table, index) => {
      const belt = motion[index]?.columns;
      if (!belt) return;
      const end = countUpTo(table.t_s, t_s);
      for (let i = countUpTo(table.t_s, t_s - kTrail_s); i < end; ++i) {
        const web = start_x_mm + (belt.belt_mm?.[i] ?? 0) + (belt.slip_x_mm?.[i] ?? 0);
        const point = [table.columns[x][i] - web + unit * pitch_mm, table.columns[y][i] - (belt.slip_y_mm?.[i] ?? 0)];
        if (Number.isFinite(point[0] + point[1])) context.lineTo(...to(point));
      }
    });
    context.stroke();
  }
}

/** Spots that were measured on this unit up to now. @param {CanvasRenderingContext2D} context @param {Trace} trace @param {number} t_s @param {number} unit @param {(p: number[]) => [number, number]} to @param {import('../view/theme.js').Theme} theme */
function drawMeasured(context, trace, t_s, unit, to, theme) {
  context.fillStyle = theme.measured;
  context.globalAlpha = 0.5;
  for (const { t_s: times, columns } of trace.rows('/spot', t_s - kSeen_s, t_s)) {
    const end = countUpTo(times, t_s);
    for (let i = 0; i < end; ++i) {
      if (columns.unit[i] !== unit) continue;
      const place = onSheet({ x_mm: columns.x_mm[i], y_mm: columns.y_mm[i], sheet_x_mm: columns.sheet_x_mm[i], sheet_y_mm: columns.sheet_y_mm[i], sheet_rad: columns.sheet_rad[i] });
      if (!place) continue;
      const [x, y] = to(place);
      context.fillRect(x - 0.75, y - 0.75, 1.5, 1.5);
    }
  }
  context.globalAlpha = 1;
}

/** @param {CanvasRenderingContext2D} context @param {ReturnType<typeof placesAt>} now @param {(p: number[]) => [number, number]} to @param {import('../view/theme.js').Theme} theme */
function drawPlaces(context, now, to, theme) {
  if (now.commanded) {
    const [x, y] = to(now.commanded);
    context.strokeStyle = theme.commanded;
    context.lineWidth = 1.5;
    context.beginPath();
    context.moveTo(x - 8, y);
    context.lineTo(x + 8, y);
    context.moveTo(x, y - 8);
    context.lineTo(x, y + 8);
    context.stroke();
  }
  if (now.real) {
    const [x, y] = to(now.real);
    context.beginPath();
    context.arc(x, y, 5, 0, 7);
    context.lineWidth = 1.8;
    context.strokeStyle = theme.true;
    context.fillStyle = theme.true;
    if (now.lit) context.fill();
    context.stroke();
  }
  if (now.measured) {
    const [x, y] = to(now.measured);
    context.strokeStyle = theme.measured;
    context.lineWidth = 1.8;
    context.strokeRect(x - 7, y - 7, 14, 14);
  }
}

/** @param {CanvasRenderingContext2D} context @param {number} width @param {number} height @param {number} scale @param {import('../view/theme.js').Theme} theme */
function drawScale(context, width, height, scale, theme) {
  const length_mm = roundStep(50 / scale);
  const x = width - kEdge_px - length_mm * scale;
  context.fillStyle = theme.mute;
  context.fillRect(x, height - 8, length_mm * scale, 1.5);
  context.font = '11px system-ui, sans-serif';
  context.textAlign = 'right';
  context.textBaseline = 'alphabetic';
  context.fillText(length_mm >= 1 ? `${length_mm} mm` : `${Math.round(1000 * length_mm)} µm`, width - kEdge_px, height - 12);
}
