// SPDX-License-Identifier: Apache-2.0
// What lies around the drawing: sheet, print marks, axes, the beam at rest and the field that it reaches. All in the sheet's frame S.
// @ts-check
import { reachAt } from '../motion.js';
import { boxOfCurves } from './geometry.js';

/** @typedef {import('./geometry.js').Box} Box */
/** @typedef {{ x_mm: number, y_mm: number, diameter_mm: number }} Mark */
/** @typedef {{ sheet: Box | null, marks: Mark[], field: Box | null, rest: [number, number] | null, start_mm: number | null }} Frames
 * `rest`: the place on the sheet below the beam at rest, which is where x_W and y_W are 0; `start_mm`: x_W of the sheet's origin. */

/** The sheet is drawn so far beyond drawing and marks: nothing says how large it is. */
const kEdge_mm = 4;

/** @param {Box | null} a @param {Box | null} b @returns {Box | null} */
export const unionOf = (a, b) =>
  !a || !b
    ? (a ?? b)
    : { x0: Math.min(a.x0, b.x0), y0: Math.min(a.y0, b.y0), x1: Math.max(a.x1, b.x1), y1: Math.max(a.y1, b.y1) };

/** Box around print marks. @param {Mark[]} marks @returns {Box | null} */
const boxOfMarks = (marks) =>
  marks.reduce(
    (/** @type {Box | null} */ box, { x_mm: x, y_mm: y, diameter_mm }) => {
      const r = diameter_mm / 2;
      return unionOf(box, { x0: x - r, y0: y - r, x1: x + r, y1: y + r });
    },
    /** @type {Box | null} */ (null),
  );

/** @type {WeakMap<object, Box | null>} */
const boxes = new WeakMap();
/** Box around all lines of a drawing, which is kept. @param {any} drawing @returns {Box | null} */
function boxOfDrawing(drawing) {
  if (!drawing) return null;
  let box = boxes.get(drawing);
  if (box === undefined) boxes.set(drawing, (box = boxOfCurves(drawing.entities)));
  return box;
}

/** Where the sheet's origin lies under the head, x_W. @param {any} check @param {import('../motion.js').Motion | null} motion @param {number} period */
function startOf(check, motion, period) {
  const field = motion?.field;
  if (motion && field) return field.ref_x_mm + field.belt_mm_s * period * motion.step_s;
  return check?.sheet?.start_x_mm ?? null;
}

/**
 * @param {any} check answer of /api/check @param {import('../motion.js').Motion | null} motion of the preview @param {number} period
 * @returns {Frames}
 */
export function framesOf(check, motion, period) {
  const marks = check?.sheet?.marks ?? [];
  const around = unionOf(boxOfDrawing(check?.drawing), boxOfMarks(marks));
  const sheet = around && {
    x0: around.x0 - kEdge_mm,
    y0: around.y0 - kEdge_mm,
    x1: around.x1 + kEdge_mm,
    y1: around.y1 + kEdge_mm,
  };
  const start_mm = startOf(check, motion, period);
  const told = check?.machine?.field;
  const at_rest =
    told && start_mm !== null
      ? { x0: told.min_mm[0] - start_mm, x1: told.max_mm[0] - start_mm, y0: told.min_mm[1], y1: told.max_mm[1] }
      : null;
  return {
    sheet,
    marks,
    field: (motion && reachAt(motion, period)) ?? at_rest,
    rest: start_mm === null ? null : [-start_mm, 0],
    start_mm,
  };
}

/** What is to be seen when all is shown: the sheet with drawing and marks; the field only where there is no sheet. @param {Frames} frames @returns {Box | null} */
export const wholeOf = ({ sheet, field }) => sheet ?? field;

const inBox = (/** @type {Box} */ inner, /** @type {Box} */ outer) =>
  inner.x0 >= outer.x0 && inner.x1 <= outer.x1 && inner.y0 >= outer.y0 && inner.y1 <= outer.y1;

/** So far from the drawing a mark is still one of it. */
const kMarkNear_mm = 40;

/**
 * Why marks and start should be laid anew, in a sentence; empty: they need not. Only what a click can mend is told: a sheet at rest.
 * @param {any} check answer of /api/check @param {any} plan answer of /api/plan
 */
export function misplaced(check, plan) {
  const cut = (check?.drawing?.entities ?? []).filter((/** @type {any} */ e) => e.process !== 'ignore');
  const drawn = boxOfCurves(cut);
  const { sheet } = check ?? {};
  if (!drawn || !sheet || sheet.moves || sheet.start_x_mm === null) return '';
  const { field, marks } = framesOf(check, null, 0);
  const room = field && { w: field.x1 - field.x0, h: field.y1 - field.y0 };
  if (room && (drawn.x1 - drawn.x0 > room.w || drawn.y1 - drawn.y0 > room.h)) return '';
  if (field && !inBox(drawn, field)) return 'The drawing lies partly outside of the field.';
  const near = { x0: drawn.x0 - kMarkNear_mm, y0: drawn.y0 - kMarkNear_mm, x1: drawn.x1 + kMarkNear_mm, y1: drawn.y1 + kMarkNear_mm };
  if (marks.some(({ x_mm, y_mm }) => !inBox({ x0: x_mm, y0: y_mm, x1: x_mm, y1: y_mm }, near)))
    return 'The print marks are those of a drawing of another size.';
  const on = marks.find(({ x_mm: x, y_mm: y, diameter_mm: d }) => cut.some((/** @type {any} */ e) => touches(e, x, y, d / 2)));
  if (on) return 'A print mark lies on a line that is cut.';
  return plan && !plan.fits && (plan.issues ?? []).some((/** @type {any} */ i) => /x_W/.test(i.message))
    ? 'The drawing does not lie in the field.'
    : '';
}

/** Does a line pass through a mark? @param {any} entity @param {number} x @param {number} y @param {number} r */
function touches({ points_mm: points }, x, y, r) {
  for (let i = 1; i < points.length; ++i) {
    const [ax, ay] = points[i - 1];
    const [bx, by] = points[i];
    const [vx, vy] = [bx - ax, by - ay];
    const l2 = vx * vx + vy * vy;
    const u = l2 > 0 ? Math.min(Math.max(((x - ax) * vx + (y - ay) * vy) / l2, 0), 1) : 0;
    if (Math.hypot(x - ax - u * vx, y - ay - u * vy) < r) return true;
  }
  return false;
}

/**
 * How large the drawing is against the field, where it cannot lie in it, in a sentence that says what to change; empty: it can.
 * @param {any} check answer of /api/check
 */
export function tooLarge(check) {
  const drawn = boxOfCurves((check?.drawing?.entities ?? []).filter((/** @type {any} */ e) => e.process !== 'ignore'));
  const field = check?.machine?.field;
  if (!drawn || !field) return '';
  const size = [drawn.x1 - drawn.x0, drawn.y1 - drawn.y0];
  const room = [field.max_mm[0] - field.min_mm[0], field.max_mm[1] - field.min_mm[1]];
  const moves = check.sheet?.moves;
  // A belt brings what is longer than the field.
  if (size[1] <= room[1] && (moves || size[0] <= room[0])) return '';
  const words = (/** @type {number[]} */ [w, h]) => `${w.toFixed(1)} × ${h.toFixed(1)} mm`;
  return `The drawing is ${words(size)}, the field of ${check.machine.name} ${words(room)}: choose a machine with a larger field, a smaller unit or scale, or cut a part of it (select).`;
}

/** What x_W is, with the numbers of this job. @param {Frames} frames @param {string} machine */
export function frameWords({ rest, start_mm, field }, machine) {
  const mm = (/** @type {number} */ v) => `${Number(v.toFixed(3))} mm`;
  const words = [
    'x and y are places on the sheet, from the 0, 0 of the drawing; x is the way that the belt runs.',
    'x_W and y_W are places under the machine, from the beam at rest.',
  ];
  if (rest && start_mm !== null) words.push(`Now x_W is x ${start_mm < 0 ? '−' : '+'} ${mm(Math.abs(start_mm))}.`);
  else words.push('The belt takes the sheet along, so x_W grows while x stays.');
  if (field)
    words.push(`The field is what the beam of ${machine || 'the machine'} reaches: ${mm(field.x1 - field.x0)} along x, ${mm(field.y1 - field.y0)} along y.`);
  return words.join(' ');
}
