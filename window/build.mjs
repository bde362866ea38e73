// SPDX-License-Identifier: Apache-2.0
// Bundles the pages into a folder from which `kerfbench serve` hands them out:
//   node build.mjs --out FOLDER
// In: this folder and node_modules. Out: FOLDER with the pages, their scripts and styles, and licences.txt, which has the licence of
// each package of which something is in the bundle; FOLDER-maps beside it with the source maps, which are never served.
// FOLDER is there as a whole or not at all: it is written beside and then renamed.
import { build } from 'esbuild';
import { cp, mkdir, readFile, readdir, rename, rm, writeFile } from 'node:fs/promises';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';

const here = path.dirname(fileURLToPath(import.meta.url));
/** Scripts of the pages, by the name under which a page asks for them. */
const scripts = { main: 'src/main.js', unpack: 'src/trace/unpack_worker.js' };
/** Files that are handed out as they are. */
const pages = ['index.html'];

/**
 * The packages of which a bundle has something, by their folder in node_modules.
 * @param {Record<string, unknown>} inputs esbuild's metafile, its inputs
 * @returns {string[]} folders, relative to this one, sorted
 */
function packagesOf(inputs) {
  const folders = new Set();
  for (const input of Object.keys(inputs)) {
    const found = /^(.*node_modules\/(?:@[^/]+\/)?[^/]+)\//.exec(input);
    if (found) folders.add(found[1]);
  }
  return [...folders].sort();
}

/**
 * @param {string} folder of a package
 * @returns {Promise<string>} its name, version, licence and the licence's text
 */
async function licenceOf(folder) {
  const about = JSON.parse(await readFile(path.join(here, folder, 'package.json'), 'utf8'));
  const file = (await readdir(path.join(here, folder))).find((name) => /^licen[cs]e/i.test(name));
  if (typeof about.license !== 'string') throw new Error(`${folder} does not say under which licence it is`);
  const text = file ? await readFile(path.join(here, folder, file), 'utf8') : '(the package has no file with its text)\n';
  return `${about.name} ${about.version}: ${about.license}\n\n${text.trim()}\n`;
}

/**
 * The page that stands alone: everything but the trace itself is in it. Who writes a page puts {{title}} (escaped for HTML),
 * {{moment_s}} (seconds, or nothing) and {{trace_base64}} into it.
 * @param {string} made folder that is written
 * @returns {Promise<Record<string, unknown>>} inputs of esbuild's metafile
 */
async function clipPage(made) {
  const { outputFiles, metafile } = await build({
    absWorkingDir: here,
    entryPoints: { clip: 'src/clip.js', style: 'clip.css' },
    outdir: made,
    bundle: true,
    format: 'esm',
    target: ['chrome110', 'firefox115', 'safari16'],
    minify: true,
    legalComments: 'none',
    metafile: true,
    write: false,
    define: { kWorkerScript: "''" }, // It asks for nothing, not even for a worker.
    logLevel: 'warning',
  });
  const text = (/** @type {string} */ end) => outputFiles.find((file) => file.path.endsWith(end))?.text ?? '';
  // Within HTML nothing may end the element early.
  const script = text('clip.js').replaceAll('</script', '<\\/script').replaceAll('<!--', '<\\!--');
  const page = (await readFile(path.join(here, 'clip.html'), 'utf8'))
    .replace('{{style}}', () => text('style.css').replaceAll('</style', '<\\/style'))
    .replace('<script>{{script}}', () => `<script type="module">${script}`);
  await writeFile(path.join(made, 'clip.html'), page);
  return metafile.inputs;
}

/** @param {string} out folder that is written */
async function bundle(out) {
  const made = `${out}.new`;
  const maps = `${out}-maps`;
  for (const folder of [made, maps]) {
    await rm(folder, { recursive: true, force: true });
    await mkdir(folder, { recursive: true });
  }
  const { metafile } = await build({
    absWorkingDir: here,
    entryPoints: { ...scripts, style: 'style.css' },
    outdir: made,
    bundle: true,
    splitting: true,
    define: { kWorkerScript: "'./unpack.js'" },
    format: 'esm',
    target: ['chrome110', 'firefox115', 'safari16'],
    minify: true,
    sourcemap: 'external',
    legalComments: 'none',
    metafile: true,
    logLevel: 'warning',
  });
  for (const name of (await readdir(made)).filter((file) => file.endsWith('.map')))
    await rename(path.join(made, name), path.join(maps, name));
  for (const page of pages) await cp(path.join(here, page), path.join(made, page));
  const inputs = { ...metafile.inputs, ...(await clipPage(made)) };
  const licences = await Promise.all(packagesOf(inputs).map(licenceOf));
  await writeFile(path.join(made, 'licences.txt'), licences.join(`\n${'-'.repeat(78)}\n\n`));
  await rm(out, { recursive: true, force: true });
  await rename(made, out);
}

const { values } = parseArgs({ options: { out: { type: 'string' } } });
if (!values.out) throw new Error('usage: node build.mjs --out FOLDER');
await bundle(path.resolve(values.out));
