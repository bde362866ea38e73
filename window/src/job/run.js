// SPDX-License-Identifier: Apache-2.0
// A run as the page knows it, from the server's events and answers; and what to say of it.
// @ts-check

/** @typedef {import('./state.js').Run} Run */

const kMostLog = 500;

/** @param {any} answer of POST /api/runs @param {string} scenario @param {import('./state.js').RunInput | null} [of] @returns {Run} */
export const runBegun = (answer, scenario, of = null) => ({
  id: String(answer.id),
  scenario,
  state: answer.state ?? 'starting',
  command: answer.command ?? '',
  what: 'Starting',
  share: null,
  left_s: null,
  now_s: null,
  verdict: null,
  results: '',
  report: '',
  trace: '',
  exitCode: null,
  judged: null,
  log: [],
  stopping: false,
  fault: '',
  of,
});

/**
 * A run that ended before, from its results.
 * @param {{ results: string, scenario: string, judged: any, trace: string, of: import('./state.js').RunInput | null }} found @returns {Run}
 */
export const runFound = ({ results, scenario, judged, trace, of }) => ({
  ...runBegun({ id: '', state: 'ended' }, scenario, of),
  verdict: judged?.verdict ?? null,
  exitCode: judged?.exit_code ?? null,
  results,
  trace,
  judged,
});

/** @param {Run} run @param {any} progress {now_s, share?, what, left_s?} @returns {Run} */
export const runProgressed = (run, progress) => ({
  ...run,
  what: progress.what ?? run.what,
  share: progress.share ?? null,
  left_s: progress.left_s ?? null,
  now_s: progress.now_s ?? run.now_s,
});

/** @param {Run} run @param {any} words {text} or a line @returns {Run} */
export function runSaid(run, words) {
  const line = typeof words === 'string' ? words : (words.line ?? words.text ?? '');
  return line === '' ? run : { ...run, log: [...run.log, line].slice(-kMostLog) };
}

/** @param {Run} run @param {any} answer of GET /api/runs/ID or the event `state` @returns {Run} */
export function runTold(run, answer) {
  const next = {
    ...run,
    state: answer.state ?? run.state,
    command: answer.command ?? run.command,
    verdict: answer.verdict ?? run.verdict,
    results: answer.results ?? run.results,
    report: answer.report ?? run.report,
    trace: answer.trace ?? run.trace,
    exitCode: answer.exit_code ?? run.exitCode,
    fault: answer.problem ?? run.fault,
  };
  return answer.progress ? runProgressed(next, answer.progress) : next;
}

/** Seconds as people say them: "8 s", "2 min 5 s". @param {number} s */
export function duration(s) {
  const whole = Math.max(0, Math.round(s));
  if (whole < 60) return `${whole} s`;
  const min = Math.floor(whole / 60);
  return min < 60 ? `${min} min ${whole % 60} s` : `${Math.floor(min / 60)} h ${min % 60} min`;
}

/** What goes on, as one line for the eye. @param {Run} run */
export function progressWords(run) {
  if (run.stopping) return 'Stopping: the laser goes off, the belt runs out, then the run ends.';
  if (run.state === 'waiting') return 'Waiting for the run before it to end.';
  const what = run.what || 'Running';
  const parts = [what[0].toUpperCase() + what.slice(1)];
  // One percentage is enough: the bar shows the share as well.
  if (run.share !== null && !what.includes('%')) parts.push(`${Math.floor(run.share * 100)} %`);
  if (run.left_s !== null && run.left_s >= 0.5) parts.push(`about ${duration(run.left_s)} left`);
  return parts.join(' · ');
}

/**
 * The same for a live region: spoken in steps of a quarter, so that it does not speak all the time.
 * @param {Run} run
 */
export function spokenProgress(run) {
  if (run.stopping) return 'Stopping the run.';
  if (run.state === 'waiting') return 'Waiting for the run before it.';
  const quarter = run.share === null ? 0 : Math.floor(run.share * 4) * 25;
  return `${run.what || 'Running'}, ${quarter} percent.`;
}

/** Kind of a verdict for its colour. @param {string | null} verdict @returns {'pass' | 'fail' | 'unproven' | 'invalid' | 'none'} */
export function verdictKind(verdict) {
  if (verdict === 'PASS') return 'pass';
  if (verdict === 'FAIL') return 'fail';
  if (verdict === 'NOT PROVEN') return 'unproven';
  return verdict === 'INVALID' ? 'invalid' : 'none';
}

/** Three digits are enough to compare; the limit is shown as it was set. */
const digits = (/** @type {number} */ value) =>
  Math.abs(value) >= 100 ? value.toFixed(0) : value === 0 ? '0' : Number(value.toPrecision(3)).toString();

/** @param {any} check of verdict.json: "0.0795 mm, limit 0.1500 mm" */
export function figureWords(check) {
  if (check.value === null || check.value === undefined || Number.isNaN(check.value)) return '';
  const unit = check.unit ? ` ${check.unit}` : '';
  const limit =
    check.limit === null || check.limit === undefined
      ? ''
      : `, limit ${check.limit_is === 'lower' ? 'at least ' : ''}${check.limit}${unit}`;
  const u = check.expanded_uncertainty;
  const within = typeof u === 'number' && u > 0 ? ` ± ${digits(u)}` : '';
  return `${check.value_is === 'at_least' ? 'at least ' : ''}${digits(check.value)}${within}${unit}${limit}`;
}

/**
 * Place of a check's worst value on the sheet: null where it has neither an entity nor a place.
 * @param {any} check @returns {{ entity: number | null, at: [number, number] | null } | null}
 */
export function placeOf(check) {
  const { entity, x_mm, y_mm } = check.where ?? {};
  const id = typeof entity === 'number' && entity >= 0 ? entity : null;
  const at = typeof x_mm === 'number' && typeof y_mm === 'number' ? /** @type {[number, number]} */ ([x_mm, y_mm]) : null;
  return id === null && at === null ? null : { entity: id, at };
}

/** Checks that are no PASS, the worst kind first. @param {any} judged verdict.json */
export function badChecks(judged) {
  const rank = { FAIL: 0, INVALID: 1, 'NOT PROVEN': 2 };
  const of = (/** @type {any} */ c) => /** @type {any} */ (rank)[c.verdict] ?? 3;
  return (judged?.checks ?? [])
    .filter((/** @type {any} */ c) => c.verdict !== 'PASS')
    .sort((/** @type {any} */ a, /** @type {any} */ b) => of(a) - of(b));
}

/**
 * The same, each with what it brings along (`along_with` of verdict.json): one fault is one entry. What is brought along by a check
 * that is not among them stands for itself.
 * @param {any} judged verdict.json @returns {{ check: any, along: any[] }[]}
 */
export function groupedChecks(judged) {
  const bad = badChecks(judged);
  const byName = new Map(bad.map((/** @type {any} */ c) => [c.name, c]));
  const leaderOf = (/** @type {any} */ check) => {
    const seen = new Set([check]);
    let at = check;
    for (let next = byName.get(at.along_with); next && !seen.has(next); next = byName.get(at.along_with)) {
      seen.add(next);
      at = next;
    }
    // A circle has no beginning: then nothing is folded away.
    return byName.has(at.along_with) ? check : at;
  };
  const leads = new Map(bad.map((/** @type {any} */ c) => [c, leaderOf(c)]));
  return bad
    .filter((/** @type {any} */ c) => leads.get(c) === c)
    .map((/** @type {any} */ check) => ({
      check,
      along: bad.filter((/** @type {any} */ c) => c !== check && leads.get(c) === check),
    }));
}

/**
 * A text of the bench with the titles of checks in place of their names: "PASS stray" becomes "PASS Nothing is burnt beside the dieline".
 * Names that are words of the language are replaced only after a verdict, where they can be nothing else.
 * @param {string} text @param {any} judged verdict.json
 */
export function withTitles(text, judged) {
  const titles = new Map(
    [...(judged?.checks ?? []), ...(judged?.not_judged ?? [])].map((/** @type {any} */ c) => [c.name, c.title]),
  );
  if (titles.size === 0) return text;
  const of = (/** @type {string} */ whole, /** @type {string} */ before, /** @type {string} */ name) =>
    titles.has(name) ? `${before}${titles.get(name)}` : whole;
  return text
    .replace(/^(\s*(?:PASS|FAIL|INVALID|NOT PROVEN|-)[ \t]+)([a-z][a-z_]*)\b/gm, of)
    .replace(/()\b([a-z]+(?:_[a-z]+)+)\b/g, of);
}

/** The run's end in a sentence, where there is no verdict.json. @param {Run} run */
export function endWords(run) {
  if (run.state === 'stopped')
    return 'The run was stopped. The laser was off before it ended; there is no verdict and no results folder.';
  if (run.fault) return run.fault;
  if (run.exitCode === 65) return 'The input was refused. What is wrong is in the lines below.';
  if (run.exitCode !== null) return `The bench ended with exit code ${run.exitCode} and without a verdict.`;
  return '';
}
