// SPDX-License-Identifier: Apache-2.0
// @ts-check
// The machine in 3-D at one moment: parts, beam, spot, burnt lines, dieline. It is given a row of motion and what was burnt; where
// they come from, a file or a run that goes on, is not its matter.

import { Box3, BufferGeometry, Color, Float32BufferAttribute, Group, LineBasicMaterial, LineSegments, Matrix4, Vector3 } from 'three';
import { Beam } from './beam.js';
import { beamCorners } from './beam_path.js';
import { Burnt } from './burnt.js';
import { posesOf } from './kinematics.js';
import { cornersOf, Parts } from './parts.js';
import { Stage } from './stage.js';

/**
 * @typedef {import('../trace/machine.js').Machine} Machine
 * @typedef {import('../trace/tables.js').Table} Table
 * @typedef {'overall' | 'head' | 'sheet' | 'above'} ViewName
 */

const kOverallLook = new Vector3(-0.55, 1.0, -0.62); // As `kerfbench show` looks at the whole.
const kAboveLook = new Vector3(0, 0.08, -1);
const kSheetLook = new Vector3(-0.12, 0.75, -0.9);
const kOverBoard_mm = 1;
const kLineAbove_mm = 0.08;

/** Colours of the processes of a dieline. @type {Record<string, number>} */
const kProcess = { cut: 0x2f7fd6, crease: 0x2e9e62, perforation: 0xb07a1c };

export class MachineView {
  /** @type {ViewName} */
  view = 'overall';
  following = false;
  /** @type {Record<string, number> | undefined} */
  motion;
  t_s = 0;
  /** Time of the picture that was drawn last. */
  shown_s = NaN;

  /** @param {HTMLElement} element @param {Machine} machine */
  constructor(element, machine) {
    this.machine = machine;
    this.stage = new Stage(element, machine.views.overall, () => this.#arrange());
    this.parts = new Parts(machine.parts);
    this.beam = new Beam();
    this.burnt = new Burnt();
    this.fresh = new Burnt();
    this.dieline = dielineOf(machine);
    this.web = new Group();
    this.web.add(this.burnt.group, this.fresh.group, this.dieline);
    this.stage.scene.add(this.parts.group, this.beam.group, this.web);
    this.stage.onResize = (width, height, fov) => {
      this.beam.resize(height, fov);
      this.burnt.resize(width, height);
      this.fresh.resize(width, height);
    };
    this.stage.resize();
    this.look('overall');
  }

  /**
   * @param {number} t_s @param {Record<string, number> | undefined} motion row of the trace's motion @param {Table[]} burnt around it
   * @param {Table[]} [fresh] burnt since then, where that is not told yet
   */
  show(t_s, motion, burnt, fresh = []) {
    this.t_s = t_s;
    if (motion) this.motion = motion;
    this.burnt.give(burnt);
    this.fresh.give(fresh);
    this.stage.want();
  }

  /** @param {ViewName} view */
  look(view) {
    this.view = view;
    const { views } = this.machine;
    const poses = posesOf(this.machine.bodies, this.motion ?? {});
    const from = view === 'overall' ? views.overall : view === 'head' ? views.head : views.sheet;
    const pose = from.body === null ? undefined : new Matrix4().fromArray(poses[from.body]);
    const points = view === 'overall' ? this.parts.corners() : cornersOf(new Box3(new Vector3(...from.min_mm), new Vector3(...from.max_mm)));
    if (pose) for (const point of points) point.applyMatrix4(pose);
    const look = view === 'head' && from.look ? new Vector3(...from.look)
      : view === 'above' ? kAboveLook : view === 'sheet' ? kSheetLook : kOverallLook;
    this.parts.openAbove(view === 'above', kOverBoard_mm);
    this.beam.lit.layers.set(view === 'above' ? 1 : 0);
    this.beam.off.layers.set(view === 'above' ? 1 : 0);
    this.stage.lookAt(points, look, view === 'overall' ? 0.98 : 0.9);
  }

  /** @param {boolean} on */
  follow(on) {
    this.following = on;
    this.stage.want();
  }

  /** @param {boolean} on */
  showDieline(on) {
    this.dieline.visible = on;
    this.stage.want();
  }

  /** The plane in which the front of a flat part stands in the picture: a mirror's. @param {string} name of the part */
  planeOf(name) {
    const view = this.parts.views.find((one) => one.part.name === name);
    if (!view) return undefined;
    const m = view.object.matrixWorld.elements;
    return { at: [m[12], m[13], m[14]], normal: [m[8], m[9], m[10]] };
  }

  #arrange() {
    const { machine, motion } = this;
    if (!motion) return;
    this.shown_s = this.t_s;
    const poses = posesOf(machine.bodies, motion);
    this.parts.place(poses);
    const web_mm = [machine.web.start_x_mm + (motion.belt_mm ?? 0) + (motion.slip_x_mm ?? 0), motion.slip_y_mm ?? 0];
    this.web.position.set(web_mm[0], web_mm[1], 0);
    this.#showBeam(motion, poses);
    for (const lines of [this.burnt, this.fresh]) lines.show(this.t_s, motion.lit > 0.5);
    this.#placeDieline(web_mm[0]);
    if (this.following && Number.isFinite(motion.spot_x_mm))
      this.stage.follow(new Vector3(motion.spot_x_mm, motion.spot_y_mm, motion.spot_z_mm ?? 0));
  }

  /** @param {Record<string, number>} motion @param {import('./kinematics.js').Pose[]} poses */
  #showBeam(motion, poses) {
    const { machine } = this;
    const { corners, direction } = beamCorners(machine.beam, machine.parts, poses);
    const atBoard = Number.isFinite(motion.spot_x_mm) && Number.isFinite(motion.spot_y_mm);
    const points = [...corners];
    if (atBoard) points.push([motion.spot_x_mm, motion.spot_y_mm, motion.spot_z_mm || 0]);
    else if (direction) points.push(corners[corners.length - 1].map((value, k) => value + 0.5 * this.stage.span_mm * direction[k]));
    const radii_mm = points.map((_, i) => machine.beam.from[i]?.radius_mm ?? machine.beam.spot_radius_mm);
    const share = (motion.power_w ?? 0) / machine.laser.full_power_w;
    this.parts.glow(motion.lit > 0.5 ? share : 0);
    this.beam.show(points, radii_mm, { on: motion.lit > 0.5, share, atBoard, size_mm: 0.036 * this.#eye_mm(points) });
  }

  /** Distance of the eye from the end of the beam: the glow keeps its size in the picture. @param {number[][]} points */
  #eye_mm(points) {
    const end = points[points.length - 1];
    return end ? this.stage.camera.position.distanceTo(new Vector3(...end)) : this.stage.span_mm;
  }

  /** Units whose lines are near the field are drawn. @param {number} web_x_mm of S of unit 0 in W */
  #placeDieline(web_x_mm) {
    const { pitch_mm, units, unit } = this.machine.web;
    this.dieline.children.forEach((child, k) => {
      // The children stand for as many units around the field as fit; each takes the next unit when the web has gone on.
      const first = pitch_mm > 0 ? Math.round((web_x_mm + 0.5 * (unit.min_mm[0] + unit.max_mm[0])) / pitch_mm) : 0;
      const index = pitch_mm > 0 ? first + k - (this.dieline.children.length >> 1) : k;
      child.visible = index >= 0 && index < Math.max(1, units);
      child.position.x = -index * pitch_mm;
    });
  }

  close() {
    this.stage.close();
  }
}

/** @param {Machine} machine */
function dielineOf(machine) {
  const group = new Group();
  /** @type {Map<string, number[]>} */
  const byProcess = new Map();
  for (const { process, points_mm, closed } of machine.dieline) {
    const list = byProcess.get(process) ?? [];
    byProcess.set(process, list);
    const ring = closed ? [...points_mm, points_mm[0]] : points_mm;
    for (let i = 1; i < ring.length; ++i) list.push(...ring[i - 1], kLineAbove_mm, ...ring[i], kLineAbove_mm);
  }
  const { field } = machine;
  const pitch = machine.web.pitch_mm;
  const reach = pitch > 0 ? Math.ceil((field.max_mm[0] - field.min_mm[0]) / pitch) + 3 : 1;
  for (let k = 0; k < Math.min(reach | 1, 41); ++k) {
    const unit = new Group();
    for (const [process, points] of byProcess) {
      const geometry = new BufferGeometry();
      geometry.setAttribute('position', new Float32BufferAttribute(points, 3));
      const material = new LineBasicMaterial({ color: new Color(kProcess[process] ?? kProcess.cut), transparent: true, opacity: 0.75, toneMapped: false });
      unit.add(new LineSegments(geometry, material));
    }
    group.add(unit);
  }
  return group;
}
