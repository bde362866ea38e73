// SPDX-License-Identifier: Apache-2.0
// The command that does what the page shows.
// @ts-check
import { isGoing } from './state.js';

/** A word as a shell takes it. @param {string} word */
export const quoted = (word) => (/^[\w@%+=:,./-]+$/.test(word) ? word : `'${word.replace(/'/g, `'\\''`)}'`);

/** The command of the present state: of the run that goes on, else of what Start would do. @param {import('./state.js').State} state */
export function commandOf(state) {
  const { run, job } = state;
  if (run && (isGoing(run) || run.scenario === job?.path) && run.command) return run.command;
  if (!job) return `kerfbench serve ${quoted(state.session?.folder ?? '.')}`;
  return `kerfbench run ${quoted(job.path)}`;
}
