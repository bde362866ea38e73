// SPDX-License-Identifier: Apache-2.0
// @ts-check
// The machine in 3-D at the cursor.

import { h } from '../shared/dom.js';
import { MachineView } from '../machine/machine_view.js';
import { onTheme, themeOf } from '../view/theme.js';

/** @typedef {import('../view/panel.js').Panel} Panel */

/** What was burnt this long before the cursor is drawn: the sheet takes about that to leave the machine. */
const kWholeSheet_s = 60;

/** @type {[import('../machine/machine_view.js').ViewName, string][]} */
const kViews = [['overall', 'Whole'], ['head', 'Head'], ['sheet', 'Sheet'], ['above', 'From above']];

/** @type {import('../view/panel.js').MakePanel} */
export function machinePanel({ body, tools, trace, timeline }) {
  const element = h('div', { class: 'stage', role: 'img', 'aria-label': `${trace.machine.machine} in three dimensions at the cursor's time` });
  body.append(element);
  const view = new MachineView(element, trace.machine);
  const dress = () => view.stage.background(themeOf(element).room);
  dress();

  const buttons = kViews.map(([name, words]) => h('button', { type: 'button', on: { click: () => look(name) } }, words));
  const look = (/** @type {import('../machine/machine_view.js').ViewName} */ name) => {
    view.look(name);
    kViews.forEach(([one], i) => buttons[i].setAttribute('aria-pressed', String(one === name)));
  };
  const follow = h('button', { type: 'button', 'aria-pressed': 'false', title: 'Keep the spot in the middle (O)', on: { click: () => toggle(follow, (on) => view.follow(on)) } }, 'Follow the spot');
  const lines = h('button', { type: 'button', 'aria-pressed': 'true', title: 'The dieline on the sheet', on: { click: () => toggle(lines, (on) => view.showDieline(on)) } }, 'Dieline');
  tools.append(h('span', { class: 'choice', role: 'group', 'aria-label': 'View' }, buttons), follow, lines);

  const update = () => {
    const { t_s } = timeline.get();
    view.show(t_s, trace.motionAt(t_s), trace.burnt(t_s - reach_s(trace), t_s + 1).tables);
  };
  look('overall');
  update();
  const stop = [timeline.subscribe((state, before) => state.t_s !== before.t_s && update()), trace.onLoad(update), onTheme(dress)];
  return {
    view,
    look,
    nextView: () => look(kViews[(kViews.findIndex(([name]) => name === view.view) + 1) % kViews.length][0]),
    toggleFollow: () => follow.click(),
    close() {
      for (const end of stop) end();
      view.close();
    },
  };
}

/** @param {HTMLElement} button @param {(on: boolean) => void} act */
function toggle(button, act) {
  const on = button.getAttribute('aria-pressed') !== 'true';
  button.setAttribute('aria-pressed', String(on));
  act(on);
}

/** How long a place of the sheet stays in the picture at the belt's speed. @param {import('../trace/trace.js').Trace} trace */
function reach_s({ machine: { views, belt_mm_s } }) {
  if (!(belt_mm_s > 0)) return kWholeSheet_s;
  return Math.min(kWholeSheet_s, (views.overall.max_mm[0] - views.overall.min_mm[0]) / belt_mm_s);
}
