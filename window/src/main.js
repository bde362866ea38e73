// SPDX-License-Identifier: Apache-2.0
// The window is one page. The address says what it shows; each part is fetched only when it is shown.
// @ts-check
import { fill, h } from './shared/dom.js';
import { kPages, shellBar } from './shared/shell.js';

/** What fills a page: it fills `<main id=NAME>` when it is loaded.
 * @type {Record<string, () => Promise<any>>} */
const kLoad = {
  view: () => import('./view/main.js'),
  station: () => import('./station/main.js'),
  service: () => import('./service/main.js'),
};

const body = /** @type {Element} */ (document.getElementById('window'));
const page = kPages.find(({ href }) => href === location.pathname) ?? kPages[0];
document.title = page.name === 'job' ? 'Kerfbench' : `${page.title} · Kerfbench`;
if (page.name === 'job') {
  const { showJob } = await import('./job/main.js');
  showJob(body);
} else {
  // The other pages fill the element of their name below the bar.
  fill(
    body,
    h('div', { class: 'other-page' }, h('header', { class: 'top' }, shellBar(page.name)), h('main', { id: page.name })),
  );
  await kLoad[page.name]();
}
