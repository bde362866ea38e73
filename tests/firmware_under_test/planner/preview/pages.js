// SPDX-License-Identifier: Apache-2.0
'use strict';
const {execFileSync, spawnSync} = require('child_process');
const path = require('path');

const [kerfplan, source] = process.argv.slice(2);
const gantry = ['--head', 'gantry', '--x-min', '-20', '--x-max', '760', '--y-min', '-410', '--y-max', '410'];

// Name -> arguments of kerfplan, for jobs of each kind.
exports.jobs = {
  'label at rest': ['fixtures/dielines/label-60x40.dxf', '--web-start', '30'],
  'label on the belt': ['fixtures/dielines/label-60x40.dxf', '--belt-speed', '100'],
  'carton on the belt': ['fixtures/dielines/tuck-end-carton.dxf', '--belt-speed', '30'],
  'perforation': ['fixtures/dielines/coupon-perforated.dxf', '--belt-speed', '20'],
  'strip': ['fixtures/dielines/strip-crosscut.dxf', ...gantry, '--belt-speed', '200', '--acceleration', '2500'],
  'carton that does not fit': ['fixtures/dielines/tuck-end-carton.dxf', '--belt-speed', '300', '--full-power', '10'],
};

exports.run = (command, args) =>
  execFileSync(kerfplan, [command, path.join(source, args[0]), ...args.slice(1)], {encoding: 'utf8', maxBuffer: 1 << 28});
exports.fails = (command, args) => spawnSync(kerfplan, [command, ...args], {encoding: 'utf8'});

const inner = (html, id) => {
  const from = html.indexOf('>', html.indexOf(`<script id=${id}`)) + 1;
  return html.slice(from, html.indexOf('</script>', from));
};
exports.dataOf = (html) => JSON.parse(inner(html, 'job'));
exports.playerOf = (html) => {
  const module = {exports: {}};
  new Function('module', inner(html, 'player'))(module);
  return module.exports;
};
