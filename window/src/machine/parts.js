// SPDX-License-Identifier: Apache-2.0
// @ts-check
// The machine's parts as objects of three.js, moved by the displacements of their bodies.

import {
  Box3, BoxGeometry, BufferGeometry, ConeGeometry, CylinderGeometry, Group, InstancedMesh, LatheGeometry, Matrix4, Mesh, MeshBasicMaterial, Plane, Vector2,
  Vector3,
} from 'three';
import { RoundedBoxGeometry } from 'three/addons/geometries/RoundedBoxGeometry.js';
import { applied, poseOfPart, times } from './kinematics.js';
import { castsShadow, materialOf } from './materials.js';

/**
 * @typedef {import('../trace/machine.js').Part} Part
 * @typedef {import('../trace/machine.js').Shape} Shape
 * @typedef {import('./kinematics.js').Pose} Pose
 */

const kSides = 48;

/** @param {number} radius_mm @param {number} length_mm @param {number} bore_mm along z, centred */
function cylinder(radius_mm, length_mm, bore_mm) {
  const half = 0.5 * length_mm;
  // A fine chamfer catches the light, as that of a turned part does.
  const edge = Math.min(0.06 * radius_mm, 0.2 * length_mm, 0.6);
  const outline = bore_mm > 0
    ? [[bore_mm, -half], [radius_mm - edge, -half], [radius_mm, -half + edge], [radius_mm, half - edge], [radius_mm - edge, half], [bore_mm, half], [bore_mm, -half]]
    : [[0, -half], [radius_mm - edge, -half], [radius_mm, -half + edge], [radius_mm, half - edge], [radius_mm - edge, half], [0, half]];
  return flatLathe(outline);
}

/** A turned body whose outline has corners. @param {number[][]} outline pairs of radius and height */
function flatLathe(outline) {
  // Each piece of the outline has its own points: its edges stay sharp.
  const points = outline.slice(1).flatMap((to, i) => [outline[i], to]);
  const lathe = new LatheGeometry(points.map(([r, z]) => new Vector2(r, z)), kSides);
  lathe.computeVertexNormals();
  smoothAround(lathe, points.length);
  return lathe.rotateX(Math.PI / 2);
}

/**
 * Normals of each piece of a lathe's outline from its slope: around the axis they are smooth, along the outline they are not.
 * @param {LatheGeometry} lathe @param {number} rows points of the outline
 */
function smoothAround(lathe, rows) {
  const normals = lathe.getAttribute('normal');
  const { points } = lathe.parameters;
  for (let i = 0; i <= kSides; ++i) {
    const phi = (2 * Math.PI * i) / kSides;
    for (let j = 0; j < rows; ++j) {
      const from = points[j - (j % 2)];
      const to = points[j - (j % 2) + 1];
      const length = Math.hypot(to.x - from.x, to.y - from.y) || 1;
      const across = (to.y - from.y) / length;
      normals.setXYZ(i * rows + j, across * Math.sin(phi), -(to.x - from.x) / length, across * Math.cos(phi));
    }
  }
}

/** @param {Shape} shape @returns {BufferGeometry} in the part's frame, mm */
export function geometryOf(shape) {
  if ('box' in shape) {
    const { size_mm: [x, y, z], edge_radius_mm } = shape.box;
    const radius = Math.min(edge_radius_mm, 0.49 * Math.min(x, y, z));
    return radius > 0 ? new RoundedBoxGeometry(x, y, z, 2, radius) : new BoxGeometry(x, y, z);
  }
  if ('cylinder' in shape) return cylinder(shape.cylinder.radius_mm, shape.cylinder.length_mm, shape.cylinder.bore_mm);
  if ('disc' in shape) {
    const { radius_mm: [a, b], thickness_mm } = shape.disc;
    const disc = thickness_mm > 0 ? cylinder(1, thickness_mm, 0) : new CylinderGeometry(1, 1, 1e-3, kSides).rotateX(Math.PI / 2);
    return disc.scale(a, b, 1).translate(0, 0, -0.5 * thickness_mm);
  }
  const { radius_mm, length_mm } = shape.cone;
  return new ConeGeometry(radius_mm, length_mm, kSides).rotateX(Math.PI / 2).translate(0, 0, 0.5 * length_mm);
}

/** Places one part, all its copies included. */
class PartView {
  /** @param {Part} part */
  constructor(part) {
    this.part = part;
    this.rest = poseOfPart(part.pose);
    this.copies = part.repeat?.count ?? 1;
    const material = materialOf(part.material);
    const cut = part.clip?.cut_x_mm;
    if (cut) material.clippingPlanes = [new Plane(new Vector3(1, 0, 0), -cut[0]), new Plane(new Vector3(-1, 0, 0), cut[1])];
    const geometry = geometryOf(part.shape);
    this.object = this.copies > 1 ? new InstancedMesh(geometry, material, this.copies) : new Mesh(geometry, material);
    this.object.name = part.name;
    this.object.castShadow = castsShadow(part.material);
    this.object.receiveShadow = true;
    this.object.matrixAutoUpdate = false;
    this.object.frustumCulled = this.copies === 1;
  }

  /** What it takes up with every column 0, without its copies. */
  box() {
    const { geometry } = this.object;
    geometry.computeBoundingBox();
    return /** @type {Box3} */ (geometry.boundingBox).clone().applyMatrix4(new Matrix4().fromArray(this.rest));
  }

  /** @param {Pose | undefined} body displacement */
  place(body) {
    const pose = body ? times(body, this.rest) : this.rest;
    if (this.object instanceof InstancedMesh) this.#placeCopies(pose, body);
    else {
      this.object.matrix.fromArray(pose);
      this.object.matrixWorldNeedsUpdate = true;
      this.object.visible = this.#shown(body, 0);
    }
  }

  /** @param {Pose} pose @param {Pose | undefined} body */
  #placeCopies(pose, body) {
    const object = /** @type {InstancedMesh} */ (this.object);
    const step = this.part.repeat?.step_mm ?? [0, 0, 0];
    const matrix = new Matrix4();
    let shown = 0;
    for (let i = 0; i < this.copies; ++i) {
      if (!this.#shown(body, i)) continue;
      matrix.fromArray(pose);
      for (let k = 0; k < 3; ++k) matrix.elements[12 + k] += i * step[k];
      object.setMatrixAt(shown++, matrix);
    }
    object.count = shown;
    object.instanceMatrix.needsUpdate = true;
  }

  /** @param {Pose | undefined} body @param {number} copy */
  #shown(body, copy) {
    const clip = this.part.clip;
    if (!clip?.within_x_mm || !clip.at_mm) return true;
    const [x] = body ? applied(body, clip.at_mm) : clip.at_mm;
    const at = x + copy * (this.part.repeat?.step_mm[0] ?? 0);
    return at >= clip.within_x_mm[0] && at <= clip.within_x_mm[1];
  }
}

/** All parts of a machine. */
export class Parts {
  /** @param {Part[]} parts */
  constructor(parts) {
    this.group = new Group();
    this.views = parts.map((part) => new PartView(part));
    this.group.add(...this.views.map((view) => view.object));
    this.discharges = this.views.filter(({ part }) => part.material === 'tube' && 'cylinder' in part.shape).map((view) => dischargeIn(view));
  }

  /** Corners of the parts that are as long as the machine, with every column 0: what a picture of the whole shows. @returns {Vector3[]} */
  corners() {
    return this.views.filter(({ part }) => !/^(board|axis_|light)/.test(part.material) && part.name !== 'scale bar' && !part.repeat && !part.clip).flatMap((view) => cornersOf(view.box()));
  }

  /** @param {Pose[]} poses displacement of each body */
  place(poses) {
    for (const view of this.views) view.place(view.part.body === null ? undefined : poses[view.part.body]);
  }

  /** The discharge in the laser's tube. @param {number} share of full power; 0: dark */
  glow(share) {
    for (const { material } of this.discharges) material.opacity = share > 0 ? 0.35 + 0.5 * Math.min(1, share) : 0;
  }

  /** Takes away what hangs over a height: the view of the sheet from above. @param {boolean} open @param {number} z_mm */
  openAbove(open, z_mm) {
    for (const view of this.views) view.object.layers.set(open && view.box().min.z > z_mm ? 1 : 0);
  }
}

/** @param {PartView} tube */
function dischargeIn({ part, object }) {
  const { radius_mm, length_mm } = /** @type {{cylinder: {radius_mm: number, length_mm: number}}} */ (part.shape).cylinder;
  const material = new MeshBasicMaterial({ color: 0xff5c8f, transparent: true, opacity: 0, depthWrite: false });
  const light = new Mesh(new CylinderGeometry(0.42 * radius_mm, 0.42 * radius_mm, length_mm, kSides).rotateX(Math.PI / 2), material);
  object.add(light);
  return light;
}

/** @param {Box3} box @returns {Vector3[]} */
export function cornersOf({ min, max }) {
  return Array.from({ length: 8 }, (_, i) => new Vector3(i & 1 ? max.x : min.x, i & 2 ? max.y : min.y, i & 4 ? max.z : min.z));
}
