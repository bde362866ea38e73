// SPDX-License-Identifier: Apache-2.0
// The server's HTTP interface (docs/reference/serve.md). An answer that is no success becomes an ApiError with the server's own
// sentence, so that a page can say it where it belongs.
// @ts-check

/** @typedef {{file?: string, line?: number, column?: number, message: string, severity?: string}} Issue */

export class ApiError extends Error {
  /** @param {string} message @param {number} status HTTP status, 0 if there was no answer @param {Issue[]} issues */
  constructor(message, status, issues = []) {
    super(message);
    this.status = status;
    this.issues = issues;
  }
}

/** What a status means, where the server gave no sentence. @param {number} status */
function sentenceFor(status) {
  if (status === 401 || status === 403) return 'This page is not signed in any more. Open the address that `kerfbench serve` prints.';
  if (status === 413) return 'The file is larger than the server takes.';
  if (status === 404) return 'The server does not have this.';
  return `The server answered with status ${status}.`;
}

/** @param {Response} answer */
async function refusal(answer) {
  const text = await answer.text();
  try {
    const said = JSON.parse(text);
    return new ApiError(said.error ?? sentenceFor(answer.status), answer.status, said.issues ?? []);
  } catch {
    return new ApiError(sentenceFor(answer.status), answer.status);
  }
}

/**
 * @param {{fetch?: typeof fetch}} [options]
 */
export function createApi({fetch: ask = (...a) => fetch(...a)} = {}) {
  /** @param {string} path @param {RequestInit} [init] */
  async function request(path, init = {}) {
    let answer;
    try {
      answer = await ask(path, {credentials: 'same-origin', ...init});
    } catch (error) {
      if (/** @type {any} */ (error)?.name === 'AbortError') throw error;
      throw new ApiError('The server does not answer. Is `kerfbench serve` still running?', 0);
    }
    if (!answer.ok) throw await refusal(answer);
    return answer;
  }
  const changing = {'X-Kerfbench': '1'};
  /** @param {string} path @param {any} body @param {AbortSignal} [signal] */
  const post = async (path, body, signal) => (await request(path, {
    method: 'POST', headers: {...changing, 'Content-Type': 'application/json'}, body: JSON.stringify(body ?? {}), signal,
  })).json();
  /** @param {string} path */
  const get = async (path) => (await request(path)).json();
  /** @param {string} key @param {string} value */
  const query = (key, value) => `?${key}=${encodeURIComponent(value)}`;

  return {
    session: () => get('/api/session'),
    files: () => get('/api/files'),
    /** @param {'scenario' | 'machine'} page */
    reference: (page) => get('/api/reference' + query('page', page)),
    /** @param {string} path */
    text: async (path) => (await request('/api/files/content' + query('path', path))).text(),
    /** @param {string} path @param {BodyInit} body */
    upload: async (path, body) => (await request('/api/files' + query('path', path), {
      method: 'PUT', headers: {...changing, 'Content-Type': 'application/octet-stream'}, body,
    })).json(),
    /** @param {{name: string, drawing?: string, from?: string, machine?: string}} what */
    create: (what) => post('/api/new', what),
    /** @param {{scenario_text: string, path: string}} what @param {AbortSignal} [signal] */
    check: (what, signal) => post('/api/check', what, signal),
    /** @param {{scenario_text: string, path: string, gcode?: string}} what @param {AbortSignal} [signal] */
    plan: (what, signal) => post('/api/plan', what, signal),
    /** @param {{text: string, set: {path: string | string[], value: any}[]}} what */
    edit: (what) => post('/api/edit', what),
    /** @param {string} path @param {{text: string, gcode?: string}} what */
    save: async (path, what) => (await request('/api/scenario' + query('path', path), {
      method: 'PUT', headers: {...changing, 'Content-Type': 'application/json'}, body: JSON.stringify(what),
    })).json(),
    runs: () => get('/api/runs'),
    /** @param {{scenario: string, image?: string, trace?: boolean, seed?: number}} what */
    start: (what) => post('/api/runs', what),
    /** @param {string} id */
    run: (id) => get('/api/runs/' + encodeURIComponent(id)),
    /** @param {string} id */
    stop: (id) => post(`/api/runs/${encodeURIComponent(id)}/stop`, {}),
    /** @param {string} id */
    events: (id) => new EventSource(`/api/runs/${encodeURIComponent(id)}/events`),
    /** @param {string} path as in a run's `results` or `report` */
    result: async (path) => (await request('/results/' + path.split('/').map(encodeURIComponent).join('/'))).json(),
  };
}
