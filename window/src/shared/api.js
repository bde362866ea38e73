// SPDX-License-Identifier: Apache-2.0
// What the pages ask the server for. docs/reference/window-api.md lists the requests.

/** A fault of a file or of a request, as the server tells it.
 * @typedef {{file?: string, line?: number, column?: number, message: string, severity?: string}} Issue */

/** The server refused; `message` is its sentence. */
export class ApiError extends Error {
  /** @param {number} status of HTTP; 0: there was no answer
   * @param {string} message
   * @param {Issue[]} issues */
  constructor(status, message, issues = []) {
    super(message);
    this.name = 'ApiError';
    this.status = status;
    this.issues = issues;
  }
}

/** @param {string} path @param {RequestInit} [options] @returns {Promise<Response>} an answer of 2xx
 * @throws {ApiError} */
async function ask(path, options) {
  let response;
  try {
    response = await fetch(path, { cache: 'no-store', ...options });
  } catch (fault) {
    if (fault instanceof DOMException && fault.name === 'AbortError') throw fault;
    throw new ApiError(0, 'kerfbench serve does not answer. Is it still running?');
  }
  if (response.ok) return response;
  const said = await response.json().catch(() => ({}));
  throw new ApiError(response.status, said.error ?? `The server answered ${response.status}.`, said.issues ?? []);
}

/** @param {string} path @param {AbortSignal} [signal] @returns {Promise<any>} */
export async function getJson(path, signal) {
  return (await ask(path, { signal })).json();
}

/** @param {string} path @param {AbortSignal} [signal] @returns {Promise<Response>} whose body is not read yet */
export async function getBytes(path, signal) {
  return ask(path, { signal });
}

/** Sends JSON, and gets it. @param {string} path @param {unknown} body @param {{method?: string, signal?: AbortSignal}} [options]
 * @returns {Promise<any>} */
export async function sendJson(path, body, { method = 'POST', signal } = {}) {
  const headers = { 'Content-Type': 'application/json', 'X-Kerfbench': '1' };
  return (await ask(path, { method, headers, body: JSON.stringify(body), signal })).json();
}

/** Brings a file into the folder: 409 where another one has the name, unless it is to be replaced.
 * @param {string} name below the folder @param {Blob | ArrayBuffer | string} content @param {'new' | 'replace'} as
 * @returns {Promise<{path: string, was_there: boolean}>} was_there: these very bytes, which were not written again */
export async function putFile(name, content, as) {
  const headers = { 'Content-Type': 'application/octet-stream', 'X-Kerfbench': '1' };
  return (
    await ask(`/api/files?path=${encodeURIComponent(name)}&as=${as}`, { method: 'PUT', headers, body: content })
  ).json();
}

/** Follows a run. The browser itself connects anew when the line breaks.
 * @param {string} id @param {Record<string, (data: any) => void>} handlers by the name of the event: state, log, progress
 * @returns {() => void} ends it */
export function followRun(id, handlers) {
  const source = new EventSource(`/api/runs/${encodeURIComponent(id)}/events`);
  for (const [name, handle] of Object.entries(handlers))
    source.addEventListener(name, (event) => handle(JSON.parse(event.data)));
  return () => source.close();
}

/** For styles that a library puts into the page (CodeMirror: EditorView.cspNonce). @returns {string} */
export function styleNonce() {
  return document.querySelector('meta[name="kerfbench-nonce"]')?.getAttribute('content') ?? '';
}
