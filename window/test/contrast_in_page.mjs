// SPDX-License-Identifier: Apache-2.0
// Contrast of texts as a page paints them: the colour of an element against the grounds behind it, laid over each other.

/**
 * @param {import('./browser.mjs').Page} page @param {string} selector
 * @returns {Promise<{ words: string, contrast: number }[]>} of those that are visible
 */
export const contrastsOf = (page, selector) =>
  page.run(
    `(selector) => {
    const canvas = document.createElement('canvas').getContext('2d', { willReadFrequently: true });
    // Whatever way a colour is written in, the canvas knows it as four bytes.
    const rgba = (colour) => { canvas.clearRect(0, 0, 1, 1); canvas.fillStyle = colour; canvas.fillRect(0, 0, 1, 1); const [r, g, b, a] = canvas.getImageData(0, 0, 1, 1).data; return [r, g, b, a / 255]; };
    const over = ([r, g, b, a], ground) => [r, g, b].map((c, i) => a * c + (1 - a) * ground[i]);
    const ground = (e) => {
      const under = e.parentElement ? ground(e.parentElement) : [255, 255, 255];
      return over(rgba(getComputedStyle(e).backgroundColor), under);
    };
    const luminance = (rgb) => { const [r, g, b] = rgb.map((c) => (c / 255 <= 0.04045 ? c / 255 / 12.92 : ((c / 255 + 0.055) / 1.055) ** 2.4)); return 0.2126 * r + 0.7152 * g + 0.0722 * b; };
    return [...document.querySelectorAll(selector)].filter((e) => e.checkVisibility() && e.innerText.trim() !== '').map((e) => {
      const at = ground(e);
      const [x, y] = [luminance(at), luminance(over(rgba(getComputedStyle(e).color), at))].sort((p, q) => q - p);
      return { words: e.innerText.slice(0, 40), contrast: (x + 0.05) / (y + 0.05) };
    });
  }`,
    selector,
  );
