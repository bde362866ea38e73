// SPDX-License-Identifier: Apache-2.0
// The state of the job page, and how it changes. All functions here are pure: state in, state out. What speaks with the server is
// in actions.js, what shows the state in the views.
// @ts-check
import { periodOfLine } from './motion.js';

/** @typedef {import('../shared/api.js').Issue} Issue */
/** @typedef {{ id: number, layer: string, process: string, length_mm: number, line: number, points_mm: [number, number][],
 *   closed: boolean }} Entity */
/** @typedef {{ kind: string, severity: string, message: string, where_mm: [number, number] | null, entities: number[],
 *   line: number, accepted?: boolean }} Finding */
/** An answer of the server that takes a moment. `fault`: the request itself failed.
 * @template T @typedef {{ state: 'none' | 'busy' | 'ready' | 'failed', value: T | null, fault: Fault | null }} Answer */
/** @typedef {{ message: string, issues: Issue[] }} Fault */
/** @typedef {{ path: string, readOnly: boolean, text: string, saved: string, past: string[], future: string[],
 *   gcode: string | null, gcodeSaved: string | null }} Job
 * `gcode`: edited by hand and not saved yet; null: what the server plans or reads. */
/** @typedef {{ id: string, scenario: string, state: string, command: string, what: string, share: number | null,
 *   left_s: number | null, now_s: number | null, verdict: string | null, results: string, report: string, trace: string,
 *   exitCode: number | null, judged: any, log: string[], stopping: boolean, fault: string, of: RunInput | null }} Run */
/** What a run was given, as far as the page shows it: text and G-code that is by hand, and whether the drawing was exchanged since.
 * @typedef {{ text: string, gcode: string | null, outdated: boolean }} RunInput */
/** @typedef {{ session: any, files: any, reference: any[], job: Job | null, check: Answer<any>, plan: Answer<any>,
 *   selected: number[], line: number | null, finding: number | null, period: number, playing: boolean, run: Run | null,
 *   stage: Stage, orderDraft: number[] | null, editing: number, exchanged: number, busy: string, notice: Notice | null, editFault: Record<string, string> }} State */

/** What is told above the page, with what may be done about it.
 * @typedef {{ kind: 'error' | 'done', text: string, issues: Issue[], acts?: { title: string, act: () => void }[] }} Notice */

/** How the drawing is looked at. `measure`: none, one or two places in S.
 * @typedef {{ tool: 'select' | 'move' | 'measure', colour: 'power' | 'speed' | 'reach', jumps: boolean, numbers: boolean, frames: boolean,
 *   measure: [number, number][], show: 'drawing' | 'machine', place: [number, number] | null }} Stage
 * `place`: one that was asked for, in S; it is brought into view and has a ring. */

/** @type {Answer<any>} */
const kNone = Object.freeze({ state: 'none', value: null, fault: null });

/** @returns {State} */
export const initialState = () => ({
  session: null,
  files: { scenarios: [], machines: [], drawings: [], images: [], runs: [], traces: [] },
  reference: [],
  job: null,
  check: kNone,
  plan: kNone,
  selected: [],
  line: null,
  finding: null,
  period: 0,
  playing: false,
  orderDraft: null,
  editing: 0,
  exchanged: 0,
  run: null,
  stage: { tool: 'select', colour: 'power', jumps: true, numbers: false, frames: true, measure: [], show: 'drawing', place: null },
  busy: '',
  notice: null,
  editFault: {},
});

/** @param {string} path */
export const baseName = (path) => path.slice(path.lastIndexOf('/') + 1);

/** What the server ships is read only. @param {string} path */
export const isShipped = (path) => path.startsWith('shipped/');

/** @param {State} state @param {string} path @param {string} text @returns {State} */
export function opened(state, path, text) {
  return {
    ...state,
    job: { path, readOnly: isShipped(path), text, saved: text, past: [], future: [], gcode: null, gcodeSaved: null },
    check: kNone,
    plan: kNone,
    selected: [],
    line: null,
    finding: null,
    period: 0,
    playing: false,
    orderDraft: null,
    run: state.run && isGoing(state.run) ? state.run : null,
    stage: { ...state.stage, measure: [], place: null },
    notice: null,
    editFault: {},
  };
}

const kMostUndo = 200;

/** The scenario's text was changed, by a field or in the editor. @param {State} state @param {string} text @returns {State} */
export function edited(state, text) {
  const { job } = state;
  if (!job || job.text === text) return state;
  return { ...state, job: { ...job, text, past: [...job.past, job.text].slice(-kMostUndo), future: [] } };
}

/** @param {State} state @returns {State} */
export function undone(state) {
  const { job } = state;
  if (!job || job.past.length === 0) return state;
  const past = job.past.slice(0, -1);
  return {
    ...state,
    editFault: {},
    job: { ...job, text: job.past[past.length], past, future: [job.text, ...job.future] },
  };
}

/** @param {State} state @returns {State} */
export function redone(state) {
  const { job } = state;
  if (!job || job.future.length === 0) return state;
  const [text, ...future] = job.future;
  return { ...state, editFault: {}, job: { ...job, text, past: [...job.past, job.text], future } };
}

/** G-code was edited; null: as planned, or as in the file. @param {State} state @param {string | null} gcode @returns {State} */
export function gcodeEdited(state, gcode) {
  if (!state.job || state.job.gcode === gcode) return state;
  return { ...state, job: { ...state.job, gcode } };
}

/** @param {State} state @param {string} path @param {string} text what was written @returns {State} */
export function saved(state, path, text) {
  const { job } = state;
  if (!job) return state;
  return { ...state, job: { ...job, path, readOnly: isShipped(path), saved: text, gcode: null } };
}

/** The drawing's file is another one now: what was said of it is asked for anew. @param {State} state @param {boolean} other are its bytes others? @returns {State} */
export function drawingExchanged(state, other) {
  const run = other && state.run?.of ? { ...state.run, of: { ...state.run.of, outdated: true } } : state.run;
  return { ...state, exchanged: state.exchanged + 1, run };
}

/** @param {Job | null} job */
export const isChanged = (job) => job !== null && (job.text !== job.saved || job.gcode !== null);

/** Is the G-code one that was edited by hand? @param {State} state */
export const isByHand = (state) =>
  state.job !== null && (state.job.gcode !== null || Boolean(state.check.value?.values?.['planner.gcode']));

/** The G-code that is to be shown. @param {State} state @returns {string} */
export const gcodeOf = (state) => state.job?.gcode ?? state.plan.value?.gcode ?? '';

/** @type {readonly number[]} */
const kNobody = Object.freeze([]);
/** The order in which entities are cut: as it was just moved, else as it was planned. @param {State} state @returns {number[]} */
export const orderOf = (state) => state.orderDraft ?? state.plan.value?.order ?? kNobody;

/** An answer is asked for; the last one stays visible. @param {State} state @param {'check' | 'plan'} which @returns {State} */
export const asked = (state, which) => ({ ...state, [which]: { ...state[which], state: 'busy' } });

/** @param {State} state @param {'check' | 'plan'} which @param {any} value @returns {State} */
export function answered(state, which, value) {
  const next = { ...state, [which]: { state: 'ready', value, fault: null } };
  if (which === 'check') {
    const known = new Set((value.drawing?.entities ?? []).map((/** @type {Entity} */ e) => e.id));
    next.selected = state.selected.every((id) => known.has(id))
      ? state.selected
      : state.selected.filter((id) => known.has(id));
    next.finding = null;
  } else {
    const most = Math.max(0, (value.preview?.x_mm.length ?? 1) - 1);
    // A line that is looked at may begin at another time now.
    const begin = state.line === null || state.playing ? null : periodOfLine(value.preview, state.line);
    next.period = begin ?? Math.min(state.period, most);
    if (value.order?.length) next.orderDraft = null;
  }
  return next;
}

/** @param {State} state @param {'check' | 'plan'} which @param {Fault} fault @returns {State} */
export const refused = (state, which, fault) => ({
  ...state,
  [which]: { state: 'failed', value: which === 'check' ? state.check.value : null, fault },
});

/**
 * @param {State} state @param {number[]} ids @param {'only' | 'add' | 'toggle'} [how]
 * @returns {State}
 */
export function selected(state, ids, how = 'only') {
  const before = new Set(how === 'only' ? [] : state.selected);
  for (const id of ids) {
    if (how === 'toggle' && before.has(id)) before.delete(id);
    else before.add(id);
  }
  return { ...state, selected: [...before] };
}

/** A change of how the drawing is looked at. @param {Partial<Stage>} part @returns {(state: State) => State} */
export const looking = (part) => (state) => ({ ...state, stage: { ...state.stage, ...part } });

/** A place is measured from or to; a third one begins anew. @param {State} state @param {[number, number]} at_mm @returns {State} */
export const measuredAt = (state, at_mm) =>
  looking({ measure: state.stage.measure.length === 1 ? [state.stage.measure[0], at_mm] : [at_mm] })(state);

/** A change of part of the state. @param {Partial<State>} part @returns {(state: State) => State} */
export const having = (part) => (state) => ({ ...state, ...part });

/**
 * Is the verdict that is shown that of the job as it stands here? Changes that are taken back make it so again.
 * @param {State} state
 */
export function isOfEarlierJob(state) {
  const { run, job } = state;
  if (!run || !run.of || isGoing(run)) return false;
  if (!job || job.path !== run.scenario || run.of.outdated || job.text !== run.of.text) return true;
  if (run.of.gcode === null) return job.gcode !== null;
  // By hand: what the run had against what stands in the editor, once it is there.
  return job.gcode !== null ? job.gcode !== run.of.gcode : state.plan.state === 'ready' && gcodeOf(state) !== run.of.gcode;
}

/** What a run that is started now is given. @param {State} state @returns {RunInput | null} */
export const runInputOf = (state) =>
  state.job && { text: state.job.text, gcode: isByHand(state) ? gcodeOf(state) : null, outdated: false };

/** @param {string} text @param {Issue[]} [issues] @returns {(state: State) => State} */
export const failed = (text, issues = []) => having({ notice: { kind: 'error', text, issues }, busy: '' });

/** A sentence of the planner without its line, which stands before it already. @param {{ message: string, line?: number }} issue */
export function withoutLine({ message, line = 0 }) {
  const found = line > 0 ? /^(?:(E\d+), )?G-code line \d+:? ?([^]*)$/.exec(message) : null;
  return found ? `${found[1] ? `${found[1]} ` : ''}${found[2]}` : message;
}

/** Errors and warnings of the scenario that belong to a key. @param {State} state @returns {Map<string, Issue[]>} */
export function issuesByKey(state) {
  const of = new Map();
  for (const issue of state.check.value?.issues ?? []) {
    if (!issue.key) continue;
    of.set(issue.key, [...(of.get(issue.key) ?? []), issue]);
  }
  return of;
}

/** @param {Issue} issue */
export const isError = (issue) => (issue.severity ?? 'error') === 'error';

/** Keys whose faults stand beside a choice of the page. */
const isChoice = (/** @type {string} */ key) => /^(dieline|machine|layers|firmware)(\.|$)/.test(key);

/** Errors that have no place beside a field: of other files, of keys that nobody knows, of the text as such. @param {State} state @returns {Issue[]} */
export function unplaced(state) {
  const known = new Set(state.reference.flatMap((section) => section.keys.map((/** @type {any} */ key) => key.path)));
  const { issues = [], drawing = null } = state.check.value ?? {};
  return issues.filter((/** @type {any} */ issue) => {
    if ((issue.severity ?? 'error') !== 'error') return false;
    // Faults of a drawing that cannot be read stand beside it.
    if ((issue.file ?? '') !== '') return drawing !== null;
    const key = issue.key ?? '';
    return key === '' || !(known.has(key) || isChoice(key));
  });
}

/** Is the job planned by the reference planner? A firmware that takes G-code line by line, or holds its job, needs none. @param {State} state */
export const isPlanned = (state) => (state.check.value?.values?.['firmware.dialog'] ?? 'kerfbench') === 'kerfbench';

/** Everything that keeps the job from being run, as sentences. @param {State} state @returns {Issue[]} */
export function obstacles(state) {
  const errors = (/** @type {Issue[]} */ list) => list.filter((i) => (i.severity ?? 'error') === 'error');
  const { check, plan } = state;
  const findings = (check.value?.drawing?.findings ?? []).filter((/** @type {Finding} */ f) => !f.accepted);
  const of_check = [...errors(check.value?.issues ?? []), ...errors(findings)];
  // A job that cannot be read cannot be planned either; its faults are not told twice.
  if (of_check.length > 0) return of_check;
  const faults = [check, ...(isPlanned(state) ? [plan] : [])]
    .filter((a) => a.state === 'failed' && a.fault)
    .map((a) => ({ message: /** @type {Fault} */ (a.fault).message }));
  return [...errors(plan.value?.issues ?? []), ...faults];
}

/** Is an edit, a check or a plan under way? What is known then is known of an earlier text. @param {State} state */
export const isUnsettled = ({ job, editing, check, plan }) =>
  job !== null && (editing > 0 || [check, plan].some(({ state }) => state === 'busy' || state === 'none'));

/**
 * May Start be pressed? While something is under way it may, and waits for it: who leaves a field by pressing Start means the new value.
 * @param {State} state @returns {string} why not, in a sentence; empty: yes
 */
export function whyNotStart(state) {
  if (!state.job) return 'Open a scenario or drop a drawing first.';
  if (state.session && state.session.can_run === false) return 'This server only shows traces.';
  if (state.run && isGoing(state.run)) return 'A run is going on.';
  if (state.job.readOnly && isChanged(state.job)) return 'Save a copy first: what is shipped stays as it is.';
  const count = isUnsettled(state) ? 0 : obstacles(state).length;
  if (count > 0) return count === 1 ? 'One fault must be mended first.' : `${count} faults must be mended first.`;
  return '';
}

/** @param {Run} run */
export const isGoing = (run) => ['starting', 'waiting', 'running'].includes(run.state);
