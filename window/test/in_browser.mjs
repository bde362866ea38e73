// SPDX-License-Identifier: Apache-2.0
// Runs a test in a browser for ctest:
//   node in_browser.mjs FILE --kerfbench=PROGRAM --server=PROGRAM --pages=index.html --shots=FOLDER
// Ends with 77, and says why, where there is no Chromium or the pages are not there.
import { spawnSync } from 'node:child_process';
import { existsSync, rmSync } from 'node:fs';
import { parseArgs } from 'node:util';
import { findChromium } from './browser.mjs';

const { values, positionals } = parseArgs({
  allowPositionals: true,
  options: {
    kerfbench: { type: 'string' },
    server: { type: 'string' },
    pages: { type: 'string' },
    shots: { type: 'string' },
  },
});
const missing = !findChromium()
  ? 'Chromium is not installed'
  : !existsSync(values.pages ?? '')
    ? `the window's pages are not built (${values.pages})`
    : '';
if (missing) {
  console.log(`SKIPPED: ${missing}, so no page was looked at`);
  process.exit(77);
}
rmSync(values.shots, { recursive: true, force: true });
const { status } = spawnSync(process.execPath, ['--test', ...positionals], {
  stdio: 'inherit',
  env: { ...process.env, KERFBENCH: values.kerfbench, KERFBENCH_SHOTS: values.shots },
});
process.exit(status ?? 1);
