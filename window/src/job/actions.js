// SPDX-License-Identifier: Apache-2.0
// What the job page does: it asks the server, and puts the answers into the state. A refusal becomes a sentence in the state, at the
// place to which it belongs.
// @ts-check
import { ApiError, followRun, getBytes, getJson, sendJson } from '../shared/api.js';
import { watch } from '../shared/store.js';
import { takerOf } from './arrivals.js';
import * as S from './state.js';
import { runBegun, runFound, runProgressed, runSaid, runTold } from './run.js';

const kSettle_ms = 250;

/** @param {unknown} error @returns {S.Fault} */
const faultOf = (error) => ({
  message: error instanceof Error ? error.message : String(error),
  issues: error instanceof ApiError ? error.issues : [],
});
const isAbort = (/** @type {unknown} */ error) => error instanceof DOMException && error.name === 'AbortError';
const query = (/** @type {string} */ path) => `?path=${encodeURIComponent(path)}`;
/** @typedef {ReturnType<typeof createActions>} Actions */

/** @param {ReturnType<typeof import('../shared/store.js').createStore<S.State>>} store */
export function createActions(store) {
  const update = store.update;
  const job = () => store.get().job;
  /** @param {unknown} error */
  const complain = (error) => {
    const { message, issues } = faultOf(error);
    update(S.failed(message, issues));
  };

  async function loadFiles() {
    const files = await getJson('/api/files');
    update(S.having({ files }));
  }

  /** @type {Record<string, AbortController | undefined>} */
  const asking = {};
  /** Asks anew for what follows from text and G-code; an answer that is not wanted any more is dropped.
   * @param {'check' | 'plan'} which @param {any} body */
  async function ask(which, body) {
    asking[which]?.abort();
    const mine = new AbortController();
    asking[which] = mine;
    update((state) => S.asked(state, which));
    try {
      const value = await sendJson(`/api/${which}`, body, { signal: mine.signal });
      if (asking[which] === mine) update((state) => S.answered(state, which, value));
    } catch (error) {
      if (!isAbort(error) && asking[which] === mine) update((state) => S.refused(state, which, faultOf(error)));
    }
  }

  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let settling;
  watch(
    store,
    (state) => [state.job?.path, state.job?.text, state.job?.gcode, state.exchanged],
    (state) => {
      clearTimeout(settling);
      if (!state.job) return;
      const fresh = state.check.state === 'none';
      const { text: scenario_text, path, gcode } = state.job;
      // From now on what was said of the text before does not hold: nothing is to be started by it.
      update((s) => S.asked(S.asked(s, 'check'), 'plan'));
      // At once for a scenario that was just opened; while somebody types, when he pauses.
      settling = setTimeout(
        () => {
          ask('check', { scenario_text, path });
          ask('plan', gcode === null ? { scenario_text, path } : { scenario_text, path, gcode });
        },
        fresh ? 0 : kSettle_ms,
      );
    },
  );

  /** @param {string} path */
  async function open(path) {
    update(S.having({ busy: `Opening ${path}` }));
    try {
      const text = await (await getBytes('/api/files/content' + query(path))).text();
      update((state) => ({ ...S.opened(state, path, text), busy: '' }));
    } catch (error) {
      complain(error);
    }
  }

  // Edits come one after the other, each on the text that the one before has left.
  let edits = Promise.resolve();
  /** @param {(job: S.Job) => Promise<void>} edit @returns {Promise<void>} */
  function inTurn(edit) {
    update((state) => ({ ...state, editing: state.editing + 1 }));
    edits = edits.then(async () => {
      const before = job();
      if (before) await edit(before);
      update((state) => ({ ...state, editing: state.editing - 1 }));
    });
    return edits;
  }

  /** Ends when all that was asked for has been answered. @returns {Promise<void>} */
  const settled = () =>
    new Promise((resolve) => {
      const look = () => {
        if (S.isUnsettled(store.get())) return false;
        resolve();
        return true;
      };
      if (look()) return;
      const stop = store.subscribe(() => look() && stop());
    });

  /**
   * Sets keys of the scenario; null removes one. A refusal is shown beside the first key.
   * @param {{ path: string | string[], value: any }[]} set @returns {Promise<void>}
   */
  function setKeys(set) {
    const key = [set[0].path].flat().join('.');
    return inTurn(async (before) => {
      try {
        const { text } = await sendJson('/api/edit', { text: before.text, set });
        update((state) => {
          const { [key]: _, ...editFault } = state.editFault;
          return { ...S.edited(state, text), editFault };
        });
      } catch (error) {
        update((state) => ({ ...state, editFault: { ...state.editFault, [key]: faultOf(error).message } }));
      }
    });
  }

  /**
   * Lays marks and start anew for the size that the drawing has; with a unit the drawing is read in it from then on. One edit, so that
   * one undo takes it back. @param {string} [unit] @returns {Promise<void>}
   */
  function place(unit) {
    return inTurn(async (before) => {
      try {
        const body = { scenario_text: before.text, path: before.path };
        const { text } = await sendJson('/api/place', unit ? { ...body, unit } : body);
        update((state) => S.edited(state, text));
      } catch (error) {
        complain(error);
      }
    });
  }

  /** @param {number[]} order empty: as planned @returns {Promise<void>} */
  function setOrder(order) {
    update(S.having({ orderDraft: order.length > 0 ? order : null }));
    return inTurn(async (before) => {
      try {
        const { text } = await sendJson('/api/order', { scenario_text: before.text, path: before.path, order });
        update((state) => S.edited(state, text));
      } catch (error) {
        complain(error);
      }
    });
  }

  /**
   * Writes scenario and G-code, under another name if one is given. G-code by hand is named in the scenario first.
   * @param {string} [as] path @returns {Promise<boolean>} was it written?
   */
  async function save(as) {
    await edits;
    let before = job();
    if (!before) return false;
    const path = as ?? before.path;
    update(S.having({ busy: `Saving ${path}` }));
    try {
      let { text } = before;
      const gcode = before.gcode;
      if (gcode !== null) {
        const name = path.slice(path.lastIndexOf('/') + 1).replace(/\.ya?ml$/, '') + '.gcode';
        ({ text } = await sendJson('/api/edit', { text, set: [{ path: 'planner.gcode', value: name }] }));
        update((state) => S.edited(state, text));
      }
      const answer = await sendJson('/api/scenario' + query(path), gcode === null ? { text } : { text, gcode }, {
        method: 'PUT',
      });
      update((state) => S.saved({ ...state, busy: '', notice: null }, answer.path ?? path, text));
      loadFiles().catch(complain);
      return true;
    } catch (error) {
      complain(error);
      return false;
    }
  }

  /**
   * A scenario of one's own from a shipped one, as it was changed here: the server rewrites the names of files in it.
   * @param {string} from @param {string} name
   */
  async function copy(from, name) {
    await edits;
    const before = job();
    update(S.having({ busy: `Copying ${from}` }));
    try {
      const text = before && before.text !== before.saved ? { text: before.text } : {};
      await openMade(await sendJson('/api/new', { from, name, ...text }));
      if (before && before.gcode !== null) update((state) => S.gcodeEdited(state, before.gcode));
    } catch (error) {
      complain(error);
    }
  }

  /** @param {{ path: string, text: string }} made by /api/new */
  async function openMade(made) {
    update((state) => ({ ...S.opened(state, made.path, made.text), busy: '' }));
    await loadFiles();
  }

  /** A new scenario for a drawing of the folder. @param {string} drawing @param {string} [machine] */
  async function create(drawing, machine) {
    update(S.having({ busy: `Reading ${drawing}` }));
    try {
      const name = drawing.slice(drawing.lastIndexOf('/') + 1).replace(/\.[^.]*$/, '');
      await openMade(await sendJson('/api/new', machine ? { drawing, name, machine } : { drawing, name }));
    } catch (error) {
      complain(error);
    }
  }

  const take = takerOf(store, { loadFiles, open, create, setKeys, complain });

  /** @type {(() => void) | null} */
  let unfollow = null;
  /** @param {string} id */
  function follow(id) {
    unfollow?.();
    /** @param {(run: S.Run) => S.Run} change */
    const changed = (change) =>
      update((state) => (state.run?.id === id ? { ...state, run: change(state.run) } : state));
    unfollow = followRun(id, {
      progress: (data) => changed((run) => runProgressed(run, data)),
      log: (data) => changed((run) => runSaid(run, data)),
      state: async (data) => {
        const ends = data.state === 'ended' || data.state === 'stopped';
        if (!ends) return changed((run) => runTold(run, data));
        unfollow?.();
        unfollow = null;
        const told = await getJson(`/api/runs/${encodeURIComponent(id)}`).catch(() => data);
        const judged = told.results ? await getJson(resultPath(told.results, 'verdict.json')).catch(() => null) : null;
        changed((run) => ({ ...runTold(run, told), judged, stopping: false }));
        loadFiles().catch(complain);
      },
    });
  }

  async function start() {
    const before = job();
    if (!before) return;
    // The verdict of the run before goes at once, so that nobody takes it for this one's.
    update(S.having({ run: runBegun({ id: '', state: 'starting' }, before.path), notice: null, playing: false }));
    try {
      await settled();
      const { gcode = null } = S.runInputOf(store.get()) ?? {};
      const reason = S.whyNotStart({ ...store.get(), run: null });
      if (reason !== '') throw new Error(reason);
      if (S.isChanged(job()) && !(await save())) return update(S.having({ run: null }));
      const scenario = job()?.path ?? before.path;
      const answer = await sendJson('/api/runs', { scenario, trace: true });
      const of = { text: job()?.text ?? before.text, gcode, outdated: false };
      update(S.having({ run: runBegun(answer, scenario, of) }));
      follow(String(answer.id));
    } catch (error) {
      update(S.having({ run: null }));
      complain(error);
    }
  }

  async function stop() {
    const { run } = store.get();
    if (!run) return;
    update(S.having({ run: { ...run, stopping: true } }));
    try {
      await sendJson(`/api/runs/${encodeURIComponent(run.id)}/stop`, {});
    } catch (error) {
      update((state) => ({ ...state, run: state.run && { ...state.run, stopping: false } }));
      complain(error);
    }
  }

  /**
   * The verdict of a run that has ended, from its results. @param {string} results folder @returns {Promise<void>}
   */
  async function showResult(results) {
    try {
      const text = (/** @type {string} */ name) =>
        getBytes(resultPath(results, name))
          .then((answer) => answer.text())
          .catch(() => null);
      const judged = await getJson(resultPath(results, 'verdict.json'));
      const [scenario, gcode] = await Promise.all([text('scenario.yaml'), text('job.gcode')]);
      const trace = `${results}/run.mcap`;
      const { files } = store.get();
      const found = {
        results,
        scenario: job()?.path ?? '',
        judged,
        trace: (files.traces ?? []).some((/** @type {any} */ t) => t.path === trace) ? trace : '',
        of:
          scenario === null
            ? null
            : { text: scenario, gcode: /\bgcode:\s*\S/.test(scenario) ? gcode : null, outdated: false },
      };
      update(S.having({ run: runFound(found) }));
    } catch (error) {
      complain(error);
    }
  }

  /**
   * Session, files and reference; then the run that goes on, and the scenario and the results that the address names.
   * @param {{ scenario: string, results: string }} wanted
   */
  async function begin({ scenario: wanted, results }) {
    try {
      const [session, reference] = await Promise.all([
        getJson('/api/session'),
        getJson('/api/reference?page=scenario'),
      ]);
      update(S.having({ session, reference: reference.sections }));
      await loadFiles();
      const { runs } = await getJson('/api/runs');
      const going = (runs ?? []).find((/** @type {any} */ run) => run.state === 'running' || run.state === 'waiting');
      const path = wanted || going?.scenario;
      if (path) await open(path);
      if (going) {
        update(S.having({ run: runTold(runBegun(going, going.scenario), going) }));
        follow(String(going.id));
      } else if (results && job()) await showResult(results);
    } catch (error) {
      complain(error);
    }
  }

  return { begin, open, place, setKeys, setOrder, save, copy, create, take, start, stop, loadFiles, showResult };
}

/** @param {string} folder of a run's results @param {string} file */
export const resultPath = (folder, file) =>
  `${folder.startsWith('/') ? '' : folder.startsWith('results/') ? '/' : '/results/'}${folder}/${file}`
    .split('/')
    .map((part) => encodeURIComponent(decodeURIComponent(part)))
    .join('/');
