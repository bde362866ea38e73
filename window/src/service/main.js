// SPDX-License-Identifier: Apache-2.0
// Calibrations and checks by hand as steps to follow: /service?path=FOLDER. The page reads what `kerfbench calibrate` has written and
// looks again while it is in view; what it asks for is done at the machine and in a terminal.
// @ts-check
import { getJson } from '../shared/api.js';
import { fill, h } from '../shared/dom.js';
import { beginSection } from './begin.js';
import { bySheet, calibrationWords, holdsWords, kindOf, ownCalibrations, progressOf, sheetWords } from './steps.js';

/** @typedef {import('./steps.js').Steps} Steps */

const kLook_ms = 2000;
const element = /** @type {Element} */ (document.getElementById('service'));
const folder = new URLSearchParams(location.search).get('path');

const signs = { done: '✓', now: '→', later: '' };
const states = { done: 'done', now: 'to do now', later: 'later' };

/** @param {import('./steps.js').Step} step */
const stepRow = (step) =>
  h(
    'li',
    { class: `step ${step.state}`, 'aria-current': step.state === 'now' ? 'step' : null },
    h('span', { class: 'tick', role: 'img', 'aria-label': states[step.state] }, signs[step.state]),
    h(
      'div',
      {},
      h('h3', {}, step.title),
      step.text.map((words) => h('p', {}, words)),
      step.found.map((words) => h('p', { class: 'found-words' }, words)),
      step.wrong.map((words) => h('p', { class: 'fault' }, words)),
      step.files.length > 0 &&
        h(
          'ul',
          { class: 'step-files' },
          step.files.map((file) => h('li', {}, h('a', { href: addressOf(file.path) }, file.path), ` ${file.what}`)),
        ),
    ),
  );

/** @param {string} file of the folder */
const addressOf = (file) =>
  '/' +
  `${folder?.startsWith('results/') ? '' : 'results/'}${folder}/${file}`.split('/').map(encodeURIComponent).join('/');

/** @param {Steps} steps */
function show(steps) {
  const { done, count } = progressOf(steps);
  fill(
    element,
    h(
      'div',
      { class: 'service-page' },
      h(
        'header',
        { class: `service-head ${kindOf(steps.verdict)}` },
        h('h1', {}, steps.verdict || `${steps.kind}: ${done} of ${count} steps done`),
        h('p', {}, steps.headline),
        h('p', { class: 'mute' }, [steps.machine, steps.date].filter(Boolean).join(' · ')),
      ),
      bySheet(steps).map((group) =>
        h('section', {}, h('h2', {}, sheetWords(group.sheet)), h('ol', {}, group.steps.map(stepRow))),
      ),
      h('p', { class: 'mute' }, 'After each step, in a terminal'),
      h('pre', { tabindex: 0 }, steps.command),
    ),
  );
}

/** @param {string} words @param {...any} more */
const tell = (words, ...more) =>
  fill(element, h('div', { class: 'service-page' }, h('h1', {}, 'Service'), h('p', {}, words), ...more));

let seen = '';
async function look() {
  if (document.visibilityState === 'visible') {
    try {
      const steps = await getJson(`/api/service?path=${encodeURIComponent(folder ?? '')}`);
      const text = JSON.stringify(steps);
      if (text !== seen) show(steps);
      seen = text;
    } catch (fault) {
      seen = '';
      tell(/** @type {Error} */ (fault).message);
    }
  }
  setTimeout(look, kLook_ms);
}

/** Which calibrations the folder has, and what they are made of. */
async function list() {
  const [{ service = [], service_files: files = [], machines = [] }, session] = await Promise.all([
    getJson('/api/files'),
    getJson('/api/session'),
  ]);
  const begin = beginSection({ machines, service, session });
  const own = ownCalibrations(files);
  const calibrations =
    own.length > 0
      ? [h('h2', {}, 'Cameras, scanners and targets'), h('ul', {}, own.map((file) => h('li', {}, calibrationWords(file))))]
      : [];
  if (service.length > 0)
    tell(
      'Calibrations and checks by hand in this folder:',
      h(
        'ul',
        { id: 'calibrations' },
        service.map((/** @type {any} */ one) => {
          const holds = holdsWords(files, one.path);
          return h(
            'li',
            {},
            h('a', { href: `/service?path=${encodeURIComponent(one.path)}` }, one.path),
            holds && h('span', { class: 'mute' }, `: ${holds}`),
          );
        }),
      ),
      calibrations,
      begin,
    );
  else tell('Nothing is calibrated or checked by hand in this folder yet.', begin, calibrations);
}

await (folder ? look() : list());
