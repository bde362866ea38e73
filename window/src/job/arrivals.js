// SPDX-License-Identifier: Apache-2.0
// Files that are dropped or chosen: a drawing becomes a scenario, G-code the job's own, an image the release. Nothing is written twice,
// and nothing replaced that the user has not said.
// @ts-check
import { ApiError, putFile } from '../shared/api.js';
import { nameInScenario } from './paths.js';
import * as S from './state.js';

const kDrawings = ['dxf', 'svg', 'cf2', 'pdf', 'ai'];
const kJobs = ['gcode', 'nc', 'ngc', 'tap'];

/** @param {string} path */
export const endingOf = (path) => path.slice(path.lastIndexOf('.') + 1).toLowerCase();
/** A name that the server takes: letters, digits, space, point, underscore, hyphen. @param {string} name */
export function tameName(name) {
  const tame = name
    .normalize('NFKD')
    .replace(/[\u0300-\u036f]/g, '')
    .replace(/[^A-Za-z0-9 ._-]+/g, '-')
    .replace(/^[. -]+/, '');
  return tame === '' ? 'drawing' : tame;
}

/** A name in the folder that nothing has yet: `label.yaml`, `label-2.yaml`. @param {string} path @param {Set<string>} taken */
export function freeName(path, taken) {
  const at = path.lastIndexOf('.');
  for (let k = 1; ; ++k) {
    const name = k === 1 ? path : `${path.slice(0, at)}-${k}${path.slice(at)}`;
    if (!taken.has(name)) return name;
  }
}

/**
 * What takes files, with what it needs of the page's actions.
 * @param {ReturnType<typeof import('../shared/store.js').createStore<S.State>>} store
 * @param {{ loadFiles: () => Promise<void>, open: (path: string) => Promise<void>, create: (drawing: string) => Promise<void>,
 *   setKeys: (set: { path: string | string[], value: any }[]) => Promise<void>, complain: (error: unknown) => void }} actions
 * @returns {(files: File[]) => Promise<void>}
 */
export function takerOf(store, { loadFiles, open, create, setKeys, complain }) {
  const update = store.update;
  const job = () => store.get().job;

  /** Files that were dropped or chosen: a drawing becomes a scenario, G-code the job's own, an image the release. @param {File[]} files */
  async function take(files) {
    for (const file of files) {
      const ending = endingOf(file.name);
      if (kJobs.includes(ending) && job()) {
        const text = await file.text();
        update((state) => S.gcodeEdited(state, text));
      } else if (kDrawings.includes(ending) || ['yaml', 'yml', 'hex', 'elf', 'bin', 'ihx'].includes(ending)) {
        await upload(file, ending);
      } else {
        update(
          S.failed(
            `“${file.name}” is neither a drawing (.dxf, .svg, .cf2, .pdf), a scenario (.yaml), G-code (.gcode) nor a release (.hex, .elf, .bin).`,
          ),
        );
      }
    }
  }

  /** What a file of the folder that was just brought in is for. @param {string} path @param {string} ending */
  async function use(path, ending) {
    if (kDrawings.includes(ending)) await create(path);
    else if (ending === 'yaml' || ending === 'yml') await open(path);
    else {
      update(S.having({ busy: '' }));
      const { session } = store.get();
      const before = job();
      if (before) await setKeys([{ path: 'firmware.image', value: nameInScenario(session, before.path, path) }]);
    }
  }

  /**
   * Brings a file into the folder. What is there already, byte for byte, is used as it is; where another file has the name the user
   * decides. A drawing that cannot be cut is refused before anything is written.
   * @param {File} file @param {string} ending @param {{ path?: string, as?: 'new' | 'replace' }} [how]
   */
  async function upload(file, ending, { path = tameName(file.name), as = 'new' } = {}) {
    update(S.having({ busy: `Loading ${file.name}`, notice: null }));
    try {
      const { was_there } = await putFile(path, file, as);
      await loadFiles();
      if (was_there || as === 'replace') await useAgain(path, ending, was_there);
      else await use(path, ending);
    } catch (error) {
      if (error instanceof ApiError && error.status === 409) askWhich(file, ending, path);
      else complain(error);
    }
  }

  /** A file that was there before, or has replaced one: a drawing's scenario is opened, and not written again. @param {string} path @param {string} ending @param {boolean} was_there */
  async function useAgain(path, ending, was_there) {
    const scenario = path.replace(/\.[^.]*$/, '.yaml');
    const { files } = store.get();
    const has = kDrawings.includes(ending) && files.scenarios.some((/** @type {any} */ f) => f.path === scenario);
    const current = store.get();
    const isShown = current.check.value?.drawing?.file === path;
    if (isShown) {
      // The job stays as it is edited; only what follows from the drawing is asked for anew.
      update((state) => S.drawingExchanged({ ...state, busy: '' }, !was_there));
    } else if (has) {
      await open(scenario);
      if (!was_there) update((state) => S.drawingExchanged(state, true));
    } else await use(path, ending);
    const what = was_there ? `${path} is in the folder already, byte for byte` : `${path} was replaced`;
    const done = has || isShown ? `: its scenario ${isShown ? current.job?.path : scenario} is open` : '';
    const acts = has || isShown ? [{ title: 'Make another scenario of it', act: () => void create(path) }] : [];
    if (!store.get().notice) update(S.having({ notice: { kind: 'done', text: `${what}${done}.`, issues: [], acts } }));
  }

  /** Another file has the name. @param {File} file @param {string} ending @param {string} path */
  function askWhich(file, ending, path) {
    const { files } = store.get();
    const taken = new Set([...files.drawings, ...files.scenarios, ...files.images].map((f) => f.path));
    const free = freeName(path, taken.add(path));
    const text = `There is another file ${path} in the folder. Nothing was written yet.`;
    const acts = [
      { title: `Replace ${path}`, act: () => void upload(file, ending, { path, as: 'replace' }) },
      { title: `Keep both: ${free}`, act: () => void upload(file, ending, { path: free }) },
    ];
    update(S.having({ busy: '', notice: { kind: 'done', text, issues: [], acts } }));
  }

  return take;
}
