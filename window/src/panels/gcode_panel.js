// SPDX-License-Identifier: Apache-2.0
// @ts-check
// The program with the line that the pulses are on. A click goes to the next moment at which a line begins.

import { h, mark, say } from '../shared/dom.js';
import { countUpTo } from '../trace/search.js';
import { rowsList } from './rows_list.js';

/** @type {import('../view/panel.js').MakePanel} */
export function gcodePanel({ body, tools, trace, timeline }) {
  const where = h('span', { class: 'mute', role: 'status' });
  tools.append(where);
  let current = 0;
  const list = rowsList(body, 'Lines of the program', {
    make: (/** @type {{text: string, line: number}} */ { text, line }) => h('button', { type: 'button', class: 'tv-row tv-code', on: { click: () => void jump(line) } },
      h('span', { class: 'tv-line-number' }, line), h('code', {}, text)),
    update: (element, { line }) => mark(element, 'aria-current', line === current ? 'true' : null),
  });
  list.give(trace.machine.gcode.map((text, i) => ({ text, line: i + 1 })));
  const note = noteOf(trace.machine);
  if (note) body.append(h('p', { class: trace.machine.gcode.length ? 'tv-note mute' : 'tv-empty' }, note));

  async function jump(/** @type {number} */ line) {
    const { t_s } = timeline.get();
    const found = (await beginOf(trace, line, t_s)) ?? (await beginOf(trace, line, -1));
    if (found === undefined) say(where, `line ${line} was not run`);
    else timeline.go(found);
  }
  const update = () => {
    const now = trace.lineAt(timeline.get().t_s);
    const line = now?.line ?? 0;
    say(where, line > 0 ? `line ${line}, unit ${now?.unit ?? 0}` : 'between programs');
    if (line === current) return;
    current = line;
    if (line > 0) list.reveal(line - 1);
    list.draw();
  };
  update();
  const stop = [timeline.subscribe((state, before) => state.t_s !== before.t_s && update()), trace.onLoad(update)];
  return { current: () => current, close: () => { for (const end of stop) end(); list.close(); } };
}

/** What must be known of the program, or why there is none. @param {import('../trace/machine.js').Machine} machine */
function noteOf({ gcode, gcode_from }) {
  if (!gcode.length) return 'The program of this run is not known: the controller ran a job of its own, or its pins were recorded without it.';
  return gcode_from === 'planned' ? 'Planned anew from the scenario: what the recorded controller was sent is not known.' : '';
}

/** When a line next begins after a time. @param {import('../trace/trace.js').Trace} trace @param {number} line @param {number} after_s */
async function beginOf(trace, line, after_s) {
  for (const index of trace.file.chunksOf('/gcode')) {
    const part = await trace.details.part('/gcode', index);
    for (let i = countUpTo(part.t_s, after_s + 1e-9); i < part.t_s.length; ++i) if (part.columns.line[i] === line) return part.t_s[i];
  }
  return undefined;
}
