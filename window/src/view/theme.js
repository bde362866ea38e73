// SPDX-License-Identifier: Apache-2.0
// @ts-check
// Colours of the page's style for what is drawn on a canvas.

const kNames = ['bg', 'fg', 'mute', 'line', 'card', 'acc', 'pass', 'fail', 'np', 'inv', 'room', 'pul', 'gate', 'pwm', 'sensor', 'true', 'commanded', 'measured'];

/** @typedef {Record<string, string>} Theme */

/** @returns {Theme} */
export function themeOf() {
  const style = getComputedStyle(document.documentElement);
  return Object.fromEntries(kNames.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]));
}

/** Calls back whenever the scheme of colours changes. @param {() => void} listener @returns {() => void} ends it */
export function onTheme(listener) {
  const media = matchMedia('(prefers-color-scheme: dark)');
  media.addEventListener('change', listener);
  return () => media.removeEventListener('change', listener);
}
