// SPDX-License-Identifier: Apache-2.0
// @ts-check
// The machine in 3-D at the cursor.

import { h } from '../shared/dom.js';
import { machineTools } from '../machine/machine_tools.js';
import { MachineView } from '../machine/machine_view.js';
import { onTheme, themeOf } from '../view/theme.js';

/** What was burnt this long before the cursor is drawn, where the belt's speed does not say how long it stays in sight. */
const kWholeSheet_s = 60;

/** @type {import('../view/panel.js').MakePanel} */
export function machinePanel({ body, tools, trace, timeline }) {
  const element = h('div', { class: 'tv-stage', role: 'img', 'aria-label': `${trace.machine.machine} in three dimensions at the cursor's time` });
  body.append(element);
  const view = new MachineView(element, trace.machine);
  const dress = () => view.stage.background(themeOf().room);
  dress();
  const { elements, look, nextView, toggleFollow } = machineTools(view);
  tools.append(...elements);
  const update = () => {
    const { t_s } = timeline.get();
    view.show(t_s, trace.motionAt(t_s), trace.burnt(t_s - reach_s(trace), t_s + 1).tables);
  };
  update();
  const stop = [timeline.subscribe((state, before) => state.t_s !== before.t_s && update()), trace.onLoad(update), onTheme(dress)];
  return {
    view, look, nextView, toggleFollow,
    close() {
      for (const end of stop) end();
      view.close();
    },
  };
}

/** How long a place of the sheet stays in the picture at the belt's speed. @param {import('../trace/trace.js').Trace} trace */
function reach_s({ machine: { views, belt_mm_s } }) {
  if (!(belt_mm_s > 0)) return kWholeSheet_s;
  return Math.min(kWholeSheet_s, (views.overall.max_mm[0] - views.overall.min_mm[0]) / belt_mm_s);
}
