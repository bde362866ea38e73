// SPDX-License-Identifier: Apache-2.0
// What all pages have at their top: the name, and the way to the other pages.
// @ts-check
import { h, svg } from './dom.js';
import { jobHref } from './job_address.js';

/** Pages of the window: how they are called and where they are.
 * @type {{ name: string, title: string, href: string }[]} */
export const kPages = [
  { name: 'job', title: 'Job', href: '/' },
  { name: 'view', title: 'Trace', href: '/view' },
  { name: 'station', title: 'Station', href: '/station' },
  { name: 'service', title: 'Service', href: '/service' },
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
      kPages.map(({ name, title, href }) =>
        h(
          'a',
          {
            href: name === 'job' && here !== 'job' ? jobHref(location.search, sessionStorage) : href,
            'aria-current': name === here ? 'page' : null,
          },
          title,
        ),
      ),
    ),
  ];
}
