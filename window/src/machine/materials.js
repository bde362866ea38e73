// SPDX-License-Identifier: Apache-2.0
// @ts-check
// What the machine's parts look like; the materials of docs/reference/trace.md.

import { Color, DoubleSide, MeshPhysicalMaterial, MeshStandardMaterial } from 'three';

/** @param {number} r @param {number} g @param {number} b linear */
const rgb = (r, g, b) => new Color(r, g, b);

/** @type {Record<string, () => MeshStandardMaterial>} */
const kLooks = {
  steel: () => new MeshStandardMaterial({ color: rgb(0.46, 0.47, 0.49), metalness: 0.9, roughness: 0.3 }),
  aluminium: () => new MeshStandardMaterial({ color: rgb(0.56, 0.58, 0.6), metalness: 0.65, roughness: 0.46 }),
  paint: () => new MeshPhysicalMaterial({ color: rgb(0.035, 0.1, 0.2), roughness: 0.5, clearcoat: 0.4, clearcoatRoughness: 0.35 }),
  dark: () => new MeshStandardMaterial({ color: rgb(0.032, 0.034, 0.039), roughness: 0.5 }),
  belt: () => new MeshStandardMaterial({ color: rgb(0.03, 0.044, 0.042), roughness: 0.85 }),
  belt_hole: () => new MeshStandardMaterial({ color: rgb(0.006, 0.008, 0.008), roughness: 1 }),
  board: () => new MeshStandardMaterial({ color: rgb(0.8, 0.76, 0.68), roughness: 0.9 }),
  print: () => new MeshStandardMaterial({ color: rgb(0.012, 0.012, 0.016), roughness: 0.8 }),
  mirror: () => new MeshStandardMaterial({ color: rgb(0.95, 0.72, 0.33), metalness: 1, roughness: 0.1 }),
  glass: () => clear(rgb(0.62, 0.8, 0.86), 0.16),
  tube: () => clear(rgb(0.78, 0.88, 0.95), 0.24),
  axis_x: () => new MeshStandardMaterial({ color: rgb(0.65, 0.03, 0.03), roughness: 0.6 }),
  axis_y: () => new MeshStandardMaterial({ color: rgb(0.02, 0.34, 0.05), roughness: 0.6 }),
  axis_z: () => new MeshStandardMaterial({ color: rgb(0.03, 0.1, 0.65), roughness: 0.6 }),
  light: () => new MeshStandardMaterial({ color: rgb(0.9, 0.9, 0.9), roughness: 0.7 }),
};

/** Materials that lie flat on another: they would only be taken for its shadow. */
const kFlat = new Set(['belt_hole', 'print']);
const kClear = new Set(['glass', 'tube']);

/** @param {Color} color @param {number} opacity */
function clear(color, opacity) {
  return new MeshStandardMaterial({ color, roughness: 0.08, transparent: true, opacity, depthWrite: false, side: DoubleSide });
}

/** @param {string} name @returns {MeshStandardMaterial} @throws {Error} for a material that docs/reference/trace.md does not have */
export function materialOf(name) {
  const make = kLooks[name];
  if (!make) throw new Error(`a part of the machine is of '${name}', which this page does not know`);
  const material = make();
  if (kFlat.has(name)) {
    material.polygonOffset = true;
    material.polygonOffsetUnits = -3; // Without a factor: on a slope it would pierce the board.
  }
  return material;
}

/** @param {string} name */
export const castsShadow = (name) => !kFlat.has(name) && !kClear.has(name);
