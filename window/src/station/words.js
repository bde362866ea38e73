// SPDX-License-Identifier: Apache-2.0
// What a station says of runs, in words and figures.
// @ts-check

/** A run as GET /api/runs/ID has it.
 * @typedef {{ id: string, scenario: string, name?: string, state: string, serial_number: string, verdict?: string, report?: string,
 *   trace?: string, results?: string, problem?: string, exit_code?: number, progress: { what: string, share?: number, left_s?: number, now_s?: number },
 *   live: { operator?: string, problems: string[], pins?: Pins } }} Run */
/** @typedef {{ now_s: number, signals: string[], edges: number[], edges_per_s: number[], levels: number[], worst_lag_us: number }} Pins */
/** @typedef {{ address?: string, name?: string, version?: string, folder?: string, problem?: string, runs?: Run[] }} Bench */

/** The run that a bench is at: the one that runs, else the next that waits. @param {Run[]} runs @returns {Run | undefined} */
export const currentOf = (runs) =>
  runs.find(({ state }) => state === 'running') ?? runs.filter(({ state }) => state === 'waiting').at(-1);

/** Those that are over, the newest first. @param {Run[]} runs */
export const overOf = (runs) => runs.filter(({ state }) => state === 'ended' || state === 'stopped');

/**
 * Units that were tested here: runs with a serial number, and those that a station was asked to start without one. All others are
 * runs of scenarios, from the page Job or another one. @param {Run[]} runs @param {ReadonlySet<string>} without ids of the latter
 */
export const testedOf = (runs, without) => runs.filter(({ id, serial_number }) => serial_number !== '' || without.has(id));

/** When a run was judged, in the time of whoever looks: "14:05", with the day where it is another one. The name of the results has it.
 * @param {Run} run @param {Date} now @returns {string} empty: it has no results */
export function timeWords({ results = '' }, now) {
  const found = /(?:^|\/)(\d{4})(\d\d)(\d\d)T(\d\d)(\d\d)(\d\d)Z-[^/]*\/?$/.exec(results);
  if (!found) return '';
  const [year, month, day, hour, minute, second] = found.slice(1).map(Number);
  const at = new Date(Date.UTC(year, month - 1, day, hour, minute, second));
  const two = (/** @type {number} */ n) => String(n).padStart(2, '0');
  const clock = `${two(at.getHours())}:${two(at.getMinutes())}`;
  const date = `${at.getFullYear()}-${two(at.getMonth() + 1)}-${two(at.getDate())}`;
  return at.toDateString() === now.toDateString() ? clock : `${date} ${clock}`;
}

/** What pressing Start does while a run goes on, in a sentence; empty: it starts at once. @param {Run | undefined} current */
export const queueWords = (current) =>
  current ? 'A run goes on: the next one waits in a queue and starts when the ones before it have ended.' : '';

/** What a station is called: the folder that it serves, and the computer if that says something. @param {{ name?: string, folder?: string }} bench */
export const stationName = ({ name = '', folder = '' }) => folder || name || 'This bench';

/** What stands for the outcome of a run. @param {Run} run @returns {string} */
export function outcomeOf(run) {
  if (run.verdict) return run.verdict;
  if (run.state === 'stopped') return 'stopped';
  if (run.state === 'ended') return 'no verdict';
  return run.state;
}

/** Class of a verdict. @param {string} outcome */
export const classOf = (outcome) =>
  ({ PASS: 'pass', FAIL: 'fail', INVALID: 'inv', 'NOT PROVEN': 'np' })[outcome] ?? 'none';

/** "12.3 k/s": three digits, so that a column of rates can be read at a glance. @param {number} per_s */
export function rateWords(per_s) {
  if (per_s < 1e3) return `${Math.round(per_s)} /s`;
  const [value, unit] = per_s < 1e6 ? [per_s / 1e3, 'k/s'] : [per_s / 1e6, 'M/s'];
  return `${value.toPrecision(3)} ${unit}`;
}

/** "2 min 5 s left". @param {number | undefined} left_s on the wall clock */
export function leftWords(left_s) {
  if (left_s === undefined) return '';
  const s = Math.max(0, Math.round(left_s));
  return s < 60 ? `${s} s left` : `${Math.floor(s / 60)} min ${s % 60} s left`;
}

/** What the operator has to do, in one sentence. @param {Run | undefined} current @param {Run | undefined} last */
export function nextStep(current, last) {
  if (current?.live.operator) return current.live.operator;
  if (current?.state === 'running') return 'A run goes on.';
  if (current?.state === 'waiting') return 'A run waits for the one before.';
  if (!last) return 'Enter or scan the serial number of what is tested, and start.';
  const what = last.serial_number ? `number ${last.serial_number}` : 'this one';
  if (last.verdict === 'PASS') return `PASS: ${what} may go on. Enter the next serial number.`;
  if (last.verdict === 'FAIL') return `FAIL: set ${what} apart. The report says what is wrong.`;
  if (last.verdict) return `${last.verdict}: test ${what} again. The report says what the evidence lacks.`;
  return `No verdict: test ${what} again.`;
}

/** The scenario that a station starts with: the one of the last run, as long as it is there.
 * @param {{ path: string }[]} scenarios @param {Run[]} runs @returns {string} */
export function firstScenario(scenarios, runs) {
  const last = runs[0]?.scenario;
  return scenarios.some(({ path }) => path === last) ? last : (scenarios[0]?.path ?? '');
}
