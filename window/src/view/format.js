// SPDX-License-Identifier: Apache-2.0
// @ts-check
// Numbers as people read them.

const kThin = '\u2009';

/** Digits in groups of three: 12 345. @param {number} count */
export function grouped(count) {
  return String(Math.round(count)).replace(/\B(?=(\d{3})+(?!\d))/g, kThin);
}

/** A duration with its own unit: 12.5 µs. @param {number} seconds @param {number} [digits] that count */
export function duration(seconds, digits = 4) {
  if (!Number.isFinite(seconds)) return '–';
  const size = Math.abs(seconds);
  if (size === 0) return '0 s';
  const [unit, scale] = size < 0.9995e-6 ? ['ns', 1e9] : size < 0.9995e-3 ? ['µs', 1e6] : size < 0.9995 ? ['ms', 1e3] : ['s', 1];
  const value = seconds * scale;
  const places = Math.min(6, Math.max(0, digits - 1 - Math.floor(Math.log10(Math.abs(value)) + 1e-9)));
  return `${Number(value.toFixed(places))}${kThin}${unit}`;
}

/** A moment of the run, to a tenth of a microsecond: 3.210 512 4. @param {number} t_s */
export function moment(t_s) {
  const [whole, part] = t_s.toFixed(7).split('.');
  return `${grouped(Number(whole))}.${part.slice(0, 3)}${kThin}${part.slice(3, 6)}${kThin}${part.slice(6)}`;
}

/** A value with so many digits behind the point; a dash where it is not known. @param {number | null | undefined} value @param {number} places @param {string} [unit] */
export function quantity(value, places, unit = '') {
  if (value === null || value === undefined || !Number.isFinite(value)) return '–';
  const text = value.toFixed(places).replace(/^-(0(\.0*)?)$/, '$1').replace('-', '−');
  return unit ? `${text}${kThin}${unit}` : text;
}

/** How fast it plays: 1/1000 … 10×. @param {number} speed */
export function speedWords(speed) {
  if (speed >= 1) return `${speed}×`;
  return `1/${Math.round(1 / speed)}`;
}

/**
 * A round step of an axis: 1, 2 or 5 times a power of ten, not below a least one.
 * @param {number} least
 */
export function roundStep(least) {
  const power = 10 ** Math.floor(Math.log10(least) + 1e-9);
  for (const factor of [1, 2, 5, 10]) if (factor * power >= least * (1 - 1e-9)) return factor * power;
  return 10 * power;
}
