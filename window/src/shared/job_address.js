// SPDX-License-Identifier: Apache-2.0
// The address of a job and of the verdict that is shown with it: what leads from any page back to them.
// @ts-check

const kKept = 'kerfbench-job';

/** "#scenario=label.yaml&results=results/label/…"; empty without a scenario. @param {{ scenario?: string, results?: string }} of */
export function jobHash({ scenario = '', results = '' }) {
  if (scenario === '') return '';
  const part = (/** @type {string} */ name, /** @type {string} */ value) => `${name}=${encodeURIComponent(value)}`;
  return `#${part('scenario', scenario)}${results === '' ? '' : `&${part('results', results)}`}`;
}

/** @param {string} hash @returns {{ scenario: string, results: string }} */
export function jobOfHash(hash) {
  const parts = new URLSearchParams(hash.replace(/^#/, ''));
  return { scenario: parts.get('scenario') ?? '', results: parts.get('results') ?? '' };
}

/** Folder of results in which a trace lies; empty: none. @param {string} trace path */
export const resultsOfTrace = (trace) => (/^results\/.+\/[^/]+$/.test(trace) ? trace.slice(0, trace.lastIndexOf('/')) : '');

/**
 * Where the pages' link “Job” leads: to the job and the verdict that a trace's address names, else to those that this tab had last.
 * @param {string} search of the page's address @param {Pick<Storage, 'getItem'> | null} kept
 */
export function jobHref(search, kept) {
  const asked = new URLSearchParams(search);
  const named = jobHash({ scenario: asked.get('job') ?? '', results: resultsOfTrace(asked.get('trace') ?? '') });
  return `/${named || (kept?.getItem(kKept) ?? '')}`;
}

/** Keeps where this tab's job is. @param {string} hash */
export const keepJob = (hash) => sessionStorage.setItem(kKept, hash);
