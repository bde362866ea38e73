// SPDX-License-Identifier: Apache-2.0
// A bench as a station: what is tested by its serial number, what the operator has to do, how it goes; and other benches beside it.
// @ts-check
import { getJson, sendJson } from '../shared/api.js';
import { fill, h, say } from '../shared/dom.js';
import { benchCard, currentCard, testedTable } from './cards.js';
import { currentOf, firstScenario, nextStep, overOf } from './words.js';

/** @typedef {import('./words.js').Run} Run */

const kLook_ms = 1000;
const element = /** @type {Element} */ (document.getElementById('station'));

const step = h('p', { class: 'station-step', role: 'status' });
const fault = h('p', { class: 'fault', role: 'alert' });
const scenario = h('select', { id: 'station-scenario' });
const serial = h('input', {
  id: 'station-serial',
  type: 'text',
  maxlength: 64,
  autocomplete: 'off',
  spellcheck: 'false',
  autofocus: true,
});
const start = h('button', { type: 'submit', class: 'primary' }, 'Start');
const current = h('div');
const tested = h('div');
const others = h('div', { class: 'station-others' });
const form = h(
  'form',
  { class: 'station-form', on: { submit: onStart } },
  h('label', { for: 'station-scenario' }, 'Scenario'),
  scenario,
  h('label', { for: 'station-serial' }, 'Serial number'),
  serial,
  start,
);

/** A scanner of bar codes types the number and Enter: that starts the run. @param {Event} event */
async function onStart(event) {
  event.preventDefault();
  say(fault, '');
  start.disabled = true;
  try {
    await sendJson('/api/runs', { scenario: scenario.value, serial_number: serial.value.trim(), trace: true });
    serial.value = '';
  } catch (problem) {
    say(fault, problem instanceof Error ? problem.message : String(problem));
  }
  start.disabled = false;
  serial.focus();
  await look();
}

/** @param {Run} run */
async function stop(run) {
  try {
    await sendJson(`/api/runs/${run.id}/stop`, {});
  } catch (problem) {
    say(fault, problem instanceof Error ? problem.message : String(problem));
  }
  await look();
}

async function look() {
  const own = await getJson('/api/station');
  const now = currentOf(own.runs);
  const over = overOf(own.runs);
  say(step, nextStep(now, over[0]));
  // A button that has the keyboard would lose it.
  if (!current.contains(document.activeElement) || !now) fill(current, now && currentCard(now, () => stop(now)));
  fill(tested, over.length > 0 && testedTable(over, true));
}

async function lookAtOthers() {
  const { benches } = await getJson('/api/benches');
  fill(others, benches.map(benchCard));
}

/** Looks again and again while the page is in view. @param {() => Promise<void>} once @param {number} every_ms */
function keepLooking(once, every_ms) {
  const again = async () => {
    if (!document.hidden) {
      try {
        await once();
        say(fault, '');
      } catch (problem) {
        say(fault, problem instanceof Error ? problem.message : String(problem));
      }
    }
    setTimeout(again, every_ms);
  };
  again();
}

const [session, files, station] = await Promise.all([
  getJson('/api/session'),
  getJson('/api/files'),
  getJson('/api/station'),
]);
fill(
  scenario,
  files.scenarios
    .filter((/** @type {any} */ each) => !each.problem)
    .map((/** @type {any} */ { path, name }) => h('option', { value: path }, `${name} (${path})`)),
);
scenario.value = firstScenario(files.scenarios, station.runs);
fill(
  element,
  h(
    'div',
    { class: 'station-page' },
    h('section', { class: 'station-own', 'aria-label': 'This bench' }, h('h1', {}, station.name), step, form, fault, current, tested),
    session.benches.length > 0 && h('section', { 'aria-label': 'Other benches' }, others),
  ),
);
serial.focus();
keepLooking(look, kLook_ms);
if (session.benches.length > 0) keepLooking(lookAtOthers, 2 * kLook_ms);
