// SPDX-License-Identifier: Apache-2.0
// `kerfbench serve` on a folder of its own, for tests.
import { spawn } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';

const kLimit_ms = Number(process.env.KERFBENCH_BROWSER_LIMIT_MS ?? 60000);

/**
 * Starts it on an empty folder and waits for the address that it prints.
 * @param {string} program path of kerfbench
 * @param {string[]} more words of its command line
 * @returns {Promise<{ url: string, folder: string, close: () => Promise<void> }>} url: with the token that lets in once
 */
export async function serve(program, more = []) {
  const folder = mkdtempSync(join(tmpdir(), 'kerfbench-window-'));
  const child = spawn(program, ['serve', folder, '--port', '0', ...more], { stdio: ['ignore', 'pipe', 'pipe'] });
  let said = '';
  let closing = false;
  const ended = new Promise((resolve) => child.once('exit', resolve));
  child.once('exit', (code, signal) => {
    if (!closing) console.error(`kerfbench serve ended by itself with ${signal ?? code}:\n${said}`);
  });
  const url = await new Promise((resolve, reject) => {
    const end = setTimeout(() => reject(new Error(`no address within the limit:\n${said}`)), kLimit_ms);
    const hear = (/** @type {Buffer} */ part) => {
      said += part;
      const found = /http:\/\/127\.0\.0\.1:\d+\/\?token=[\w-]+/.exec(said);
      if (!found) return;
      clearTimeout(end);
      resolve(found[0]);
    };
    child.stdout.on('data', hear);
    child.stderr.on('data', hear);
    child.once('exit', (code) => reject(new Error(`kerfbench serve ended with ${code}:\n${said}`)));
    child.once('error', reject);
  });
  return {
    url,
    folder,
    async close() {
      closing = true;
      child.kill('SIGTERM');
      await ended;
      rmSync(folder, { recursive: true, force: true });
    },
  };
}
