// SPDX-License-Identifier: Apache-2.0
// The steps of a calibration or a check by hand (steps.json, written by `kerfbench calibrate`), and what to say of them.
// @ts-check

/** @typedef {{ id: string, sheet: string, title: string, text: string[], state: 'done' | 'now' | 'later',
 *   files: { path: string, what: string }[], found: string[], wrong: string[] }} Step */
/** @typedef {{ version: number, kind: string, machine: string, date: string, command: string, headline: string, verdict: string,
 *   steps: Step[] }} Steps */

/** Kind of a verdict for its colour. @param {string} verdict @returns {'pass' | 'fail' | 'unproven' | 'none'} */
export function kindOf(verdict) {
  if (verdict === 'GOOD' || verdict === 'HOLDS') return 'pass';
  if (verdict === 'NOT GOOD' || verdict === 'DOES NOT HOLD') return 'fail';
  return verdict === '' ? 'none' : 'unproven';
}

/** How far it is. @param {Steps} steps */
export function progressOf({ steps }) {
  const done = steps.filter((step) => step.state === 'done').length;
  return { done, count: steps.length, now: steps.find((step) => step.state === 'now') ?? null };
}

/** Steps by sheet, in their order; what is of no sheet stands by itself. @param {Steps} steps @returns {{ sheet: string, steps: Step[] }[]} */
export function bySheet({ steps }) {
  /** @type {{ sheet: string, steps: Step[] }[]} */
  const groups = [];
  for (const step of steps) {
    const last = groups[groups.length - 1];
    if (last && last.sheet === step.sheet) last.steps.push(step);
    else groups.push({ sheet: step.sheet, steps: [step] });
  }
  return groups;
}

/** "1-grid" → "Sheet 1: grid". @param {string} sheet */
export function sheetWords(sheet) {
  const found = /^(\d+)-(.+)$/.exec(sheet);
  return found ? `Sheet ${found[1]}: ${found[2].replace(/-/g, ' ')}` : sheet === '' ? 'Then' : sheet;
}
