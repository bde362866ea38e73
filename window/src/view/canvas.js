// SPDX-License-Identifier: Apache-2.0
// @ts-check
// A canvas that is as sharp as the screen, as large as its element, and drawn once for any number of wishes.

import { onTheme, themeOf } from './theme.js';

/**
 * @param {HTMLElement} element that it fills @param {string} label what it shows, for those who do not see it
 * @param {(context: CanvasRenderingContext2D, width: number, height: number, theme: import('./theme.js').Theme) => void} draw in CSS pixels
 */
export function sharpCanvas(element, label, draw) {
  const canvas = document.createElement('canvas');
  canvas.setAttribute('role', 'img');
  canvas.setAttribute('aria-label', label);
  element.append(canvas);
  const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d'));
  /** @type {import('./theme.js').Theme | undefined} Read when the element is in the page. */
  let theme;
  let wanted = false;
  let closed = false;
  const want = () => {
    if (wanted || closed) return;
    wanted = true;
    requestAnimationFrame(() => {
      wanted = false;
      if (closed) return;
      const { clientWidth: width, clientHeight: height } = element;
      if (!width || !height) return;
      const ratio = devicePixelRatio;
      if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
        canvas.width = Math.round(width * ratio);
        canvas.height = Math.round(height * ratio);
      }
      context.setTransform(ratio, 0, 0, ratio, 0, 0);
      context.clearRect(0, 0, width, height);
      theme ??= themeOf();
      draw(context, width, height, theme);
    });
  };
  const resizing = new ResizeObserver(want);
  resizing.observe(element);
  const unTheme = onTheme(() => {
    theme = undefined;
    want();
  });
  want();
  return {
    canvas,
    want,
    close() {
      closed = true;
      resizing.disconnect();
      unTheme();
    },
  };
}
