// SPDX-License-Identifier: Apache-2.0
// Runs tests that need the packages of package.json for ctest:
//   node with_packages.mjs FILE…
// Ends with 77, and says why, where they are not there.
import { spawnSync } from 'node:child_process';
import { existsSync } from 'node:fs';
import { fileURLToPath } from 'node:url';

if (!existsSync(fileURLToPath(new URL('../node_modules/@mcap/core/package.json', import.meta.url)))) {
  console.log('SKIPPED: the packages of window/package.json are not there (window/get_modules.sh brings them)');
  process.exit(77);
}
const { status } = spawnSync(process.execPath, ['--test', ...process.argv.slice(2)], { stdio: 'inherit' });
process.exit(status ?? 1);
