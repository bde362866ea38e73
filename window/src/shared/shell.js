// SPDX-License-Identifier: Apache-2.0
// What all pages have at their top: the name, and the way to the other pages.
// @ts-check
import { h, svg } from './dom.js';

/** Pages of the window: how they are called, where they are, and what fills them. A page but `job` fills `<main id=NAME>`.
 * @type {{ name: string, title: string, href: string, load: () => Promise<any> }[]} */
export const kPages = [
  { name: 'job', title: 'Job', href: '/', load: () => import('../job/main.js') },
  { name: 'view', title: 'Trace', href: '/view', load: () => import('../view/main.js') },
  { name: 'station', title: 'Station', href: '/station', load: () => import('../station/main.js') },
  { name: 'service', title: 'Service', href: '/service', load: () => import('../service/main.js') },
];

/** @param {string} here name of the page that is shown @returns {Element[]} */
export function shellBar(here) {
  // A kerf: a beam that has opened half of a sheet.
  const sign = svg(
    'svg',
    { viewBox: '0 0 20 20', 'aria-hidden': 'true' },
    svg('path', { d: 'M1 14h6m6 0h6M10 1v9' }),
    svg('path', { d: 'M7 14l3 4 3-4' }),
  );
  return [
    h('span', { class: 'brand' }, sign, 'Kerfbench'),
    h(
      'nav',
      { 'aria-label': 'Pages' },
      kPages.map(({ name, title, href }) => h('a', { href, 'aria-current': name === here ? 'page' : null }, title)),
    ),
  ];
}
