// SPDX-License-Identifier: Apache-2.0
// A bench as a station: what is tested by its serial number, what the operator has to do, how it goes; and other benches beside it.
// @ts-check
import { getJson, sendJson } from '../shared/api.js';
import { fill, h, say } from '../shared/dom.js';
import { benchCard, currentCard, testedTable } from './cards.js';
import { classOf, currentOf, firstScenario, nextStep, outcomeOf, overOf, queueWords, stationName, testedOf } from './words.js';

/** @typedef {import('./words.js').Run} Run */

const kLook_ms = 1000;
const kWithout = 'kerfbench-station-without-number';
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
  'aria-describedby': 'station-ask',
});
const start = h('button', { type: 'submit', class: 'primary' }, 'Start');
const without = h('input', { type: 'checkbox', id: 'station-without', on: { change: () => say(ask, '') } });
const ask = h('p', { class: 'fault', id: 'station-ask', role: 'alert' });
const queue = h('p', { class: 'mute', id: 'station-queue', role: 'status' });
serial.addEventListener('input', () => say(ask, ''));
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
  h('label', { class: 'station-without' }, without, 'Test one without a serial number'),
  ask,
  queue,
);

/** Runs that this station started without a number: they were asked for here, unlike those of the page Job. @returns {Set<string>} */
const startedWithout = () => new Set(JSON.parse(sessionStorage.getItem(kWithout) ?? '[]'));

/** A scanner of bar codes types the number and Enter: that starts the run. @param {Event} event */
async function onStart(event) {
  event.preventDefault();
  say(fault, '');
  const number = serial.value.trim();
  if (number === '' && !without.checked) {
    say(ask, 'Enter or scan the serial number first, or say that this one has none.');
    serial.focus();
    return;
  }
  start.disabled = true;
  try {
    const { id } = await sendJson('/api/runs', { scenario: scenario.value, serial_number: number, trace: true });
    if (number === '') sessionStorage.setItem(kWithout, JSON.stringify([...startedWithout(), String(id)]));
    serial.value = '';
    without.checked = false;
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
  const units = testedOf(over, startedWithout());
  const others_over = over.filter((run) => !units.includes(run));
  say(step, nextStep(now, units[0]));
  step.className = `station-step ${now || !units[0] ? '' : classOf(outcomeOf(units[0]))}`;
  say(queue, queueWords(now));
  say(start, now ? 'Queue' : 'Start');
  // A button that has the keyboard would lose it.
  if (!current.contains(document.activeElement) || !now) fill(current, now && currentCard(now, () => stop(now)));
  fill(
    tested,
    units.length > 0 && testedTable(units, true, 'Units tested'),
    others_over.length > 0 &&
      h(
        'details',
        { open: tested.querySelector('details')?.open ?? false },
        h('summary', {}, `Runs of scenarios, without a serial number (${others_over.length})`),
        testedTable(others_over, true, 'From the page Job or a command'),
      ),
  );
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
    h('section', { class: 'station-own', 'aria-label': 'This bench' }, h('h1', {}, stationName(station)), h('p', { class: 'mute' }, `Station on the computer ${station.name}`), step, form, fault, current, tested),
    session.benches.length > 0 && h('section', { 'aria-label': 'Other benches' }, others),
  ),
);
document.title = `${stationName(station)} · Station · Kerfbench`;
serial.focus();
keepLooking(look, kLook_ms);
if (session.benches.length > 0) keepLooking(lookAtOthers, 2 * kLook_ms);
