// SPDX-License-Identifier: Apache-2.0
// The preview as a motion over the program's own periods: where the beam is, how fast, with which power, and where "one line on"
// leads. Places are mm in S, those of /api/plan as they are: nothing is planned anew here.
// @ts-check

/** @typedef {{ line: number, entity: number | null, first: number, last: number }} Stretch periods (first, last] of one line */

/** Period at which a line begins, by the run lengths of the preview. @param {any} preview @param {number} line @returns {number | null} */
export function periodOfLine(preview, line) {
  let at = 0;
  for (const [value, count] of preview?.line ?? []) {
    // The place at which the motion starts is one before the first period of the line.
    if (value === line) return Math.max(at - 1, 0);
    at += count;
  }
  return null;
}

/** @param {[number, number][]} runs run-length coded @param {number} n */
function spread(runs, n) {
  const of = new Int32Array(n).fill(-1);
  let i = 0;
  for (const [value, count] of runs ?? []) for (let k = 0; k < count && i < n; ++k) of[i++] = value;
  return of;
}

/** @param {any} preview of /api/plan @param {number} full_power_w */
export function makeMotion(preview, full_power_w) {
  const n = preview.x_mm.length;
  const line = spread(preview.line, n);
  const entity = spread(preview.entity, n);
  const cut_mm = new Float64Array(n);
  const jump_mm = new Float64Array(n);
  let mostSpeed = 0;
  let mostPower = 1;
  const lit = new Uint8Array(n);
  for (let i = 0; i < n; ++i) {
    lit[i] = preview.power[i] > 0 && (preview.gate?.[i] ?? 1) ? 1 : 0;
    mostPower = Math.max(mostPower, preview.power[i]);
    mostSpeed = Math.max(mostSpeed, preview.speed_mm_s[i]);
    if (i === 0) continue;
    const way = Math.hypot(preview.x_mm[i] - preview.x_mm[i - 1], preview.y_mm[i] - preview.y_mm[i - 1]);
    cut_mm[i] = cut_mm[i - 1] + (lit[i] ? way : 0);
    jump_mm[i] = jump_mm[i - 1] + (lit[i] ? 0 : way);
  }
  /** @type {Stretch[]} */
  const stretches = [];
  for (let i = 1; i < n; ++i) {
    const last = stretches[stretches.length - 1];
    if (last && last.line === line[i]) last.last = i;
    else stretches.push({ line: line[i], entity: entity[i] >= 0 ? entity[i] : null, first: i - 1, last: i });
  }
  const step_s = preview.period_s * (preview.stride ?? 1);
  return {
    n,
    line,
    entity,
    lit,
    cut_mm,
    jump_mm,
    stretches,
    step_s,
    mostSpeed,
    mostPower,
    full_power_w,
    x: preview.x_mm,
    y: preview.y_mm,
    power: preview.power,
    speed: preview.speed_mm_s,
    field: preview.field ?? null,
    duration_s: Math.max(0, n - 1) * step_s,
  };
}
/** @typedef {ReturnType<typeof makeMotion>} Motion */

/** What is to be told of a moment. @param {Motion} motion @param {number} period a whole number or between two */
export function momentAt(motion, period) {
  const at = Math.min(Math.max(period, 0), Math.max(motion.n - 1, 0));
  // Between two periods it is the one that comes next: what stands at the begin of a line belongs to that line.
  const i = Math.min(Math.floor(at + 1e-9) + 1, motion.n - 1);
  const from = Math.max(i - 1, 0);
  const w = i > 0 ? at - from : 0;
  const mix = (/** @type {ArrayLike<number>} */ a) => a[from] + w * (a[i] - a[from]);
  return {
    period: i,
    t_s: at * motion.step_s,
    x_mm: mix(motion.x),
    y_mm: mix(motion.y),
    lit: motion.lit[i] === 1,
    power_w: (motion.lit[i] ? motion.power[i] / 255 : 0) * motion.full_power_w,
    speed_mm_s: motion.speed[i],
    line: motion.line[i],
    entity: motion.entity[i] >= 0 ? motion.entity[i] : null,
    cut_mm: mix(motion.cut_mm),
    jump_mm: mix(motion.jump_mm),
  };
}

/** Period at which the next line ends, or the one before begins. @param {Motion} motion @param {number} period @param {1 | -1} sense */
export function lineOn(motion, period, sense) {
  if (sense > 0) return motion.stretches.find((s) => s.last > period + 1e-9)?.last ?? motion.n - 1;
  for (let k = motion.stretches.length; k-- > 0;)
    if (motion.stretches[k].first < period - 1e-9) return motion.stretches[k].first;
  return 0;
}

/** Period at which a line of G-code begins; null if no period has it. @param {Motion} motion @param {number} line */
export const startOfLine = (motion, line) => motion.stretches.find((s) => s.line === line)?.first ?? null;

/** Reach of the beam on the sheet at a period, as the belt takes the sheet along. @param {Motion} motion @param {number} period */
export function reachAt(motion, period) {
  const { field } = motion;
  if (!field) return null;
  const shift = field.ref_x_mm + field.belt_mm_s * period * motion.step_s;
  return { x0: field.min_mm[0] - shift, x1: field.max_mm[0] - shift, y0: field.min_mm[1], y1: field.max_mm[1] };
}

/**
 * How far the beam is out, as a share of the way from the middle of its field to the edge: 1 is at the edge, more is beyond it.
 * @param {Motion} motion @param {number} period
 */
export function reachShare(motion, period) {
  const reach = reachAt(motion, period);
  if (!reach) return 0;
  const out = (/** @type {number} */ at, /** @type {number} */ a, /** @type {number} */ b) =>
    Math.abs(at - (a + b) / 2) / Math.max((b - a) / 2, 1e-9);
  return Math.max(out(motion.x[period], reach.x0, reach.x1), out(motion.y[period], reach.y0, reach.y1));
}

/** What colours a period, 0 … 1; above 1 it is out of reach. @param {Motion} motion @param {number} i @param {'power' | 'speed' | 'reach'} by */
export function shareAt(motion, i, by) {
  if (by === 'reach') return reachShare(motion, i);
  return by === 'speed' ? motion.speed[i] / Math.max(motion.mostSpeed, 1e-9) : motion.power[i] / motion.mostPower;
}

/** The playing speed that shows the whole job in some twelve seconds. @param {number} duration_s @param {number[]} speeds */
export const usualSpeed = (duration_s, speeds) => {
  const off = (/** @type {number} */ speed) => Math.abs(Math.log(Math.max(duration_s, 1e-3) / speed / 12));
  return speeds.reduce((best, speed) => (off(speed) < off(best) ? speed : best));
};

// Violet over red to amber. All of it has a contrast of 3 on the light stage and on the dark one, which leaves the hue to tell.
const kRamp = [
  [122, 92, 214],
  [184, 74, 168],
  [220, 72, 88],
  [220, 104, 24],
  [176, 120, 8],
];
/** @param {number} share 0 … 1 */
export function rampColour(share) {
  const u = Math.min(Math.max(share, 0), 1) * (kRamp.length - 1);
  const i = Math.min(Math.floor(u), kRamp.length - 2);
  return `rgb(${kRamp[i].map((c, k) => Math.round(c + (u - i) * (kRamp[i + 1][k] - c))).join(',')})`;
}
