// SPDX-License-Identifier: Apache-2.0
// @ts-check
// The beam as light: a ribbon that always faces the eye, bright in its core, with a soft hem; and the spot on the board.

import {
  AdditiveBlending, BufferAttribute, BufferGeometry, CanvasTexture, Color, CustomBlending, DoubleSide, Group, Mesh, OneFactor,
  OneMinusSrcAlphaFactor, PointLight, ShaderMaterial, Sprite, SpriteMaterial,
} from 'three';

/** @typedef {import('./kinematics.js').Vec3} Vec3 */

const kMost = 12; // Corners of a beam.
const kLeast_px = 5; // Half the width of the ribbon, however far away.

const vertexShader = `
attribute vec3 next;
attribute float side;
attribute float radius;
uniform float pixelRatio_px;  // Height of the picture in pixels over twice the tangent of half the view's angle.
uniform float least_px;
varying float vSide;
void main() {
  vec4 here = modelViewMatrix * vec4(position, 1.0);
  vec4 there = modelViewMatrix * vec4(next, 1.0);
  vec3 along = normalize(there.xyz - here.xyz);
  vec3 across = normalize(cross(along, here.xyz));
  float least = least_px * -here.z / pixelRatio_px;
  here.xyz += side * max(3.0 * radius, least) * across;
  vSide = side;
  gl_Position = projectionMatrix * here;
}`;
const fragmentShader = `
uniform vec3 colour;
uniform float strength;
varying float vSide;
void main() {
  float r2 = vSide * vSide;
  float hem = 0.30 * exp(-3.5 * r2) * (1.0 - r2);
  float core = exp(-14.0 * r2);
  float heart = exp(-60.0 * r2);
  vec3 light = colour * (hem + core) + vec3(0.0, 0.34, 0.16) * core + vec3(0.1, 0.4, 0.45) * heart;
  gl_FragColor = vec4(light, min(1.0, 0.8 * hem + core)) * strength;
}`;

export class Beam {
  constructor() {
    this.group = new Group();
    this.lit = this.#ribbon(new Color(1.0, 0.2, 0.03));
    this.off = this.#ribbon(new Color(0.62, 0.06, 0.05));
    this.off.material.uniforms.strength.value = 0.4;
    this.off.material.uniforms.least_px.value = 3;
    this.spot = new Sprite(new SpriteMaterial({ map: glow(), blending: AdditiveBlending, depthTest: false, depthWrite: false, transparent: true }));
    this.lamp = new PointLight(new Color(1, 0.42, 0.12), 0, 0, 2);
    this.mark = new Sprite(new SpriteMaterial({ map: ring(), depthTest: false, depthWrite: false, transparent: true, toneMapped: false }));
    this.mark.renderOrder = 2;
    this.group.add(this.lit, this.off, this.spot, this.lamp, this.mark);
  }

  /** @param {Color} colour */
  #ribbon(colour) {
    const geometry = new BufferGeometry();
    const vertices = 4 * (kMost - 1);
    geometry.setAttribute('position', new BufferAttribute(new Float32Array(3 * vertices), 3));
    geometry.setAttribute('next', new BufferAttribute(new Float32Array(3 * vertices), 3));
    geometry.setAttribute('side', new BufferAttribute(new Float32Array(vertices), 1));
    geometry.setAttribute('radius', new BufferAttribute(new Float32Array(vertices), 1));
    const index = [];
    for (let i = 0; i < kMost - 1; ++i) index.push(4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 2, 4 * i + 1, 4 * i + 3);
    geometry.setIndex(index);
    const material = new ShaderMaterial({
      uniforms: { colour: { value: colour }, strength: { value: 1 }, pixelRatio_px: { value: 1 }, least_px: { value: kLeast_px } },
      vertexShader, fragmentShader, transparent: true,
      // Light covers what is behind it: added to a bright room it would only be white.
      blending: CustomBlending, blendSrc: OneFactor, blendDst: OneMinusSrcAlphaFactor, depthWrite: false, side: DoubleSide, toneMapped: false,
    });
    const mesh = new Mesh(geometry, material);
    mesh.frustumCulled = false;
    return mesh;
  }

  /**
   * @param {Vec3[]} points corners and end of the beam, W @param {number[]} radii_mm 1/e² radius at each
   * @param {{on: boolean, share: number, atBoard: boolean, size_mm: number}} light share of full power; size of the spot's glow
   */
  show(points, radii_mm, { on, share, atBoard, size_mm }) {
    this.lit.visible = on && points.length > 1;
    this.off.visible = !on && points.length > 1;
    const mesh = on ? this.lit : this.off;
    if (points.length > 1) this.#shape(mesh.geometry, points.slice(0, kMost), radii_mm);
    this.lit.material.uniforms.strength.value = 0.55 + 0.45 * Math.sqrt(Math.min(1, share));
    const end = points[points.length - 1];
    this.spot.visible = on && atBoard;
    this.lamp.intensity = on && atBoard ? share * 2.5 * size_mm * size_mm : 0;
    this.mark.visible = atBoard && Boolean(end);
    if (!end) return;
    this.mark.position.set(end[0], end[1], end[2] + 0.3);
    this.mark.scale.setScalar(0.8 * size_mm);
    this.spot.position.set(end[0], end[1], end[2] + 0.3);
    this.lamp.position.set(end[0], end[1], end[2] + 0.35 * size_mm);
    const glowSize = size_mm * (0.7 + 0.3 * Math.sqrt(Math.min(1, share)));
    this.spot.scale.set(glowSize, glowSize, 1);
  }

  /** @param {BufferGeometry} geometry @param {Vec3[]} points @param {number[]} radii_mm */
  #shape(geometry, points, radii_mm) {
    const position = geometry.getAttribute('position');
    const next = geometry.getAttribute('next');
    const side = geometry.getAttribute('side');
    const radius = geometry.getAttribute('radius');
    for (let i = 0; i + 1 < points.length; ++i) {
      const [a, b] = [points[i], points[i + 1]];
      const beyond = b.map((value, k) => 2 * value - a[k]);
      for (let k = 0; k < 4; ++k) {
        const at = 4 * i + k;
        const atEnd = k >= 2;
        position.setXYZ(at, .../** @type {Vec3 & [number, number, number]} */ (atEnd ? b : a));
        next.setXYZ(at, .../** @type {Vec3 & [number, number, number]} */ (atEnd ? beyond : b));
        side.setX(at, k % 2 === 0 ? 1 : -1);
        radius.setX(at, radii_mm[atEnd ? i + 1 : i]);
      }
    }
    geometry.setDrawRange(0, 6 * (points.length - 1));
    for (const attribute of [position, next, side, radius]) attribute.needsUpdate = true;
  }

  /** @param {number} height_px of the picture @param {number} fov_deg of the view, from top to bottom */
  resize(height_px, fov_deg) {
    const ratio = height_px / (2 * Math.tan((fov_deg * Math.PI) / 360));
    for (const mesh of [this.lit, this.off]) mesh.material.uniforms.pixelRatio_px.value = ratio;
  }
}

/** Where the beam meets the board, lit or not: a dark ring with a light hem is seen on anything. */
function ring() {
  const canvas = document.createElement('canvas');
  canvas.width = canvas.height = 128;
  const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d'));
  for (const [colour, width] of /** @type {[string, number][]} */ ([['rgba(255,255,255,0.75)', 13], ['#1c6fd1', 7]])) {
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.beginPath();
    context.arc(64, 64, 54, 0, 7);
    context.stroke();
  }
  return new CanvasTexture(canvas);
}

/** A soft round light. */
function glow() {
  const canvas = document.createElement('canvas');
  canvas.width = canvas.height = 128;
  const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext('2d'));
  const light = context.createRadialGradient(64, 64, 0, 64, 64, 64);
  light.addColorStop(0, 'rgba(255,244,225,1)');
  light.addColorStop(0.06, 'rgba(255,205,130,0.95)');
  light.addColorStop(0.16, 'rgba(255,120,40,0.45)');
  light.addColorStop(0.42, 'rgba(255,70,15,0.12)');
  light.addColorStop(1, 'rgba(255,50,0,0)');
  context.fillStyle = light;
  context.fillRect(0, 0, 128, 128);
  return new CanvasTexture(canvas);
}
