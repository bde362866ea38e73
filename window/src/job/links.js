// SPDX-License-Identifier: Apache-2.0
// Drawing, G-code and preview show the same thing: what is chosen in one of them is chosen in all.
// @ts-check
import { periodOfLine } from './motion.js';
import { selected } from './state.js';

/** @typedef {{ entity: number, line_first: number, line_last: number }} EntityLines */
/** @typedef {import('./state.js').State} State */

/** @param {EntityLines[] | undefined} entityLines @param {number} line @returns {number | null} */
export const entityOfLine = (entityLines, line) =>
  (entityLines ?? []).find((e) => e.line_first <= line && line <= e.line_last)?.entity ?? null;

/** Lines of G-code of these entities. @param {EntityLines[] | undefined} entityLines @param {number[]} ids @returns {number[]} */
export function linesOfEntities(entityLines, ids) {
  const wanted = new Set(ids);
  return (entityLines ?? [])
    .filter((e) => wanted.has(e.entity))
    .flatMap((e) => Array.from({ length: e.line_last - e.line_first + 1 }, (_, i) => e.line_first + i));
}

/**
 * Entities were chosen in the drawing or in the order: the first of their lines is shown, and the preview stands at it.
 * @param {State} state @param {number[]} ids @param {'only' | 'add' | 'toggle'} [how] @returns {State}
 */
export function entitiesChosen(state, ids, how = 'only') {
  const next = selected(state, ids, how);
  const plan = state.plan.value;
  const last =
    ids.length > 0 && next.selected.includes(ids[ids.length - 1])
      ? ids[ids.length - 1]
      : next.selected[next.selected.length - 1];
  const line = last === undefined ? null : (linesOfEntities(plan?.entity_lines, [last])[0] ?? null);
  const period = line === null || state.playing ? state.period : (periodOfLine(plan?.preview, line) ?? state.period);
  return { ...next, line, period, stage: next.stage.place ? { ...next.stage, place: null } : next.stage };
}

/**
 * The place of a check was chosen: its entity in drawing, order and G-code, and the place itself, which the drawing shows.
 * @param {State} state @param {{ entity: number | null, at: [number, number] | null }} where @returns {State}
 */
export function checkChosen(state, { entity, at }) {
  const next = entitiesChosen(state, entity === null ? [] : [entity]);
  return { ...next, finding: null, stage: { ...next.stage, show: 'drawing', place: at } };
}

/** A line of G-code was chosen. @param {State} state @param {number} line @returns {State} */
export function lineChosen(state, line) {
  if (state.line === line) return state;
  const plan = state.plan.value;
  // G-code that was edited since it was planned has other lines.
  const fits = state.plan.state === 'ready';
  const entity = fits ? entityOfLine(plan?.entity_lines, line) : null;
  const period = fits && !state.playing ? (periodOfLine(plan?.preview, line) ?? state.period) : state.period;
  return { ...state, line, selected: entity === null ? [] : [entity], period };
}
