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

/** @typedef {{ path: string, kind: string, id?: string, date?: string }} ServiceFile */

const kKinds = {
  scan: ['scan', 'scans'],
  photograph: ['photograph', 'photographs'],
  tiles: ['list of pictures (tiles.yaml)', 'lists of pictures (tiles.yaml)'],
  'scan-list': ['description of a scan (scan.yaml)', 'descriptions of scans (scan.yaml)'],
  table: ['correction table', 'correction tables'],
};

/** What a folder of a calibration has: "2 scans, 1 correction table"; empty: nothing yet. @param {ServiceFile[]} files @param {string} folder */
export function holdsWords(files, folder) {
  const own = files.filter(({ path }) => path.startsWith(`${folder}/`));
  return Object.entries(kKinds)
    .map(([kind, [one, several]]) => [own.filter((file) => file.kind === kind).length, one, several])
    .filter(([count]) => Number(count) > 0)
    .map(([count, one, several]) => `${count} ${count === 1 ? one : several}`)
    .join(', ');
}

/** Calibrations of cameras and scanners, and targets, that are the user's own: the shipped ones belong to shipped machines. @param {ServiceFile[]} files */
export const ownCalibrations = (files) =>
  files.filter(({ path, kind }) => ['camera', 'scanner', 'target'].includes(kind) && !path.startsWith('shipped/'));

/** "glass.yaml: scanner glass-1 of 2026-11-21". @param {ServiceFile} file */
export const calibrationWords = ({ path, kind, id, date }) =>
  `${path}: ${kind}${id ? ` ${id}` : ''}${date ? ` of ${date}` : ''}`;
