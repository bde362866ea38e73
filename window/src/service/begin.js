// SPDX-License-Identifier: Apache-2.0
// How a calibration by hand is begun: for which machine, by which command, with which things at hand.
// @ts-check
import { quoted } from '../job/command.js';
import { isShipped } from '../job/state.js';
import { fill, h, say } from '../shared/dom.js';

/** @typedef {{ path: string, name?: string }} Machine */

/** The user's own machines before the shipped examples. @param {Machine[]} machines @returns {{ label: string, machines: Machine[] }[]} */
export const groupsOf = (machines) =>
  [
    { label: 'Yours, in this folder', machines: machines.filter(({ path }) => !isShipped(path)) },
    { label: 'Examples, shipped with Kerfbench', machines: machines.filter(({ path }) => isShipped(path)) },
  ].filter((group) => group.machines.length > 0);

/** A results folder that no calibration has yet. @param {{ path: string }[]} service calibrations of the folder */
export function freeFolder(service) {
  const taken = new Set(service.map(({ path }) => path.replace(/^results\//, '')));
  for (let k = 1; ; ++k) {
    const name = k === 1 ? 'head' : `head-${k}`;
    if (!taken.has(name)) return `results/${name}`;
  }
}

/**
 * The command that writes the first sheet, as it is typed in the folder that is served.
 * @param {string} machine path as the server lists it @param {string} folder of the results @param {string} shipped where the shipped files are
 */
export function beginCommand(machine, folder, shipped) {
  const file = isShipped(machine) ? `${shipped.replace(/\/$/, '')}/${machine.slice('shipped/'.length)}` : machine;
  return `kerfbench calibrate head --by-hand --machine ${quoted(file)} --results-dir ${quoted(folder)}`;
}

/** What has to be there. All of it is in docs/how-to/calibrate-a-head.md. */
const kNeeded = [
  'The machine with its scan head and laser, its controller, and the machine file that describes it. A gantry has no scan head to calibrate.',
  'A printer for the marks of the sheet (print.pdf, at 100 %), and board to print and cut.',
  'A way to measure the cut marks: a calibrated kerf camera on its table, or a flatbed scanner that was calibrated with a printed target. A scanner taken on trust works too, but then each mark counts with 50 µm.',
];

/**
 * @param {{ machines: Machine[], service: { path: string }[], session: { shipped?: string, folder?: string } }} known
 * @returns {HTMLElement}
 */
export function beginSection({ machines, service, session }) {
  const code = h('pre', { tabindex: 0, id: 'begin-command' });
  const select = h(
    'select',
    { id: 'begin-machine', on: { change: () => show() } },
    groupsOf(machines).map(({ label, machines: of }) =>
      h('optgroup', { label }, of.map(({ path, name }) => h('option', { value: path }, name ? `${name} (${path})` : path))),
    ),
  );
  const copy = h('button', { type: 'button', id: 'begin-copy', on: { click: onCopy } }, 'Copy');
  const told = h('span', { class: 'visually-hidden', role: 'status' });
  function show() {
    say(code, beginCommand(select.value, freeFolder(service), session.shipped ?? 'shipped'));
    say(copy, 'Copy');
    say(told, '');
  }
  async function onCopy() {
    try {
      await navigator.clipboard.writeText(code.textContent ?? '');
      say(copy, 'Copied');
      say(told, 'Copied.');
    } catch {
      // Without the right to write the clipboard the text is at least selected.
      getSelection()?.selectAllChildren(code);
      say(copy, 'Press Ctrl C');
    }
  }
  const section = h('section', { class: 'service-begin', 'aria-label': 'Calibrate a scan head' });
  fill(
    section,
    h('h2', {}, 'Calibrate a scan head'),
    h(
      'p',
      {},
      'A scan head that has just been mounted is off by millimetres. The machine cuts marks into a printed sheet, you photograph or scan them, and Kerfbench writes the correction table of the controller. This page then shows the steps, what was found on each sheet, and what is wrong with a picture.',
    ),
    h('h3', {}, 'What you need'),
    h('ul', { class: 'needed' }, kNeeded.map((words) => h('li', {}, words))),
    machines.length > 0
      ? [
          h('div', { class: 'begin-choice' }, h('label', { for: 'begin-machine' }, 'Machine'), select),
          h('p', {}, `Type this in a terminal${session.folder ? `, in the folder ${session.folder}` : ''}; the same command again after each step:`),
          h('div', { class: 'begin-line' }, code, copy, told),
        ]
      : h('p', { class: 'fault' }, 'This folder has no machine file. Write one first.'),
  );
  if (machines.length > 0) show();
  return section;
}
