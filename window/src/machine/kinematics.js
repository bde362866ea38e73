// SPDX-License-Identifier: Apache-2.0
// @ts-check
// Where the bodies of a machine are when its joints stand somewhere: a pure function of the joints' description and of one
// row of the trace's motion. Frames as in docs/frames.md: W is the machine, lengths in mm, angles in rad. A pose is a 4 x 4
// matrix in columns, as three.js and WebGL have it.

/**
 * @typedef {number[]} Vec3
 * @typedef {Float64Array} Pose
 * @typedef {{kind: 'turn' | 'slide', axis: Vec3, origin_mm?: Vec3, by: string, scale?: number, wrap_mm?: number}} Joint
 *   turns about `axis` through `origin_mm` (W, every column 0), or slides along it, by scale * column, modulo wrap_mm
 * @typedef {{name: string, parent: number | null, joints: Joint[]}} Body parent: index of an earlier body
 */

/** @returns {Pose} */
export function identity() {
  const pose = new Float64Array(16);
  pose[0] = pose[5] = pose[10] = pose[15] = 1;
  return pose;
}

/** The pose X_AC of X_AB and X_BC. @param {Pose} a @param {Pose} b @returns {Pose} */
export function times(a, b) {
  const out = new Float64Array(16);
  for (let column = 0; column < 4; ++column) {
    for (let row = 0; row < 4; ++row) {
      let sum = 0;
      for (let k = 0; k < 4; ++k) sum += a[4 * k + row] * b[4 * column + k];
      out[4 * column + row] = sum;
    }
  }
  return out;
}

/** @param {Pose} pose @param {Vec3} p @returns {Vec3} */
export function applied(pose, [x, y, z]) {
  return [0, 1, 2].map((row) => pose[row] * x + pose[4 + row] * y + pose[8 + row] * z + pose[12 + row]);
}

/** A direction, without the shift. @param {Pose} pose @param {Vec3} v @returns {Vec3} */
export function rotated(pose, [x, y, z]) {
  return [0, 1, 2].map((row) => pose[row] * x + pose[4 + row] * y + pose[8 + row] * z);
}

/** @param {Vec3} axis of length 1 @param {number} distance_mm @returns {Pose} */
export function slid(axis, distance_mm) {
  const pose = identity();
  for (let i = 0; i < 3; ++i) pose[12 + i] = distance_mm * axis[i];
  return pose;
}

/**
 * Rotation about an axis through a point (Rodrigues).
 * @param {Vec3} axis of length 1 @param {Vec3} origin_mm @param {number} angle_rad @returns {Pose}
 */
export function turned(axis, origin_mm, angle_rad) {
  const c = Math.cos(angle_rad);
  const s = Math.sin(angle_rad);
  const [x, y, z] = axis;
  const pose = identity();
  pose.set([c + x * x * (1 - c), y * x * (1 - c) + z * s, z * x * (1 - c) - y * s], 0);
  pose.set([x * y * (1 - c) - z * s, c + y * y * (1 - c), z * y * (1 - c) + x * s], 4);
  pose.set([x * z * (1 - c) + y * s, y * z * (1 - c) - x * s, c + z * z * (1 - c)], 8);
  const moved = rotated(pose, origin_mm);
  for (let i = 0; i < 3; ++i) pose[12 + i] = origin_mm[i] - moved[i];
  return pose;
}

/**
 * Pose of a part: [x, y, z, qw, qx, qy, qz].
 * @param {number[]} part @returns {Pose}
 */
export function poseOfPart([x, y, z, w, a, b, c]) {
  const pose = identity();
  pose.set([1 - 2 * (b * b + c * c), 2 * (a * b + c * w), 2 * (a * c - b * w)], 0);
  pose.set([2 * (a * b - c * w), 1 - 2 * (a * a + c * c), 2 * (b * c + a * w)], 4);
  pose.set([2 * (a * c + b * w), 2 * (b * c - a * w), 1 - 2 * (a * a + b * b)], 8);
  pose.set([x, y, z], 12);
  return pose;
}

/**
 * Displacement of one joint from its zero. A column that the trace does not have counts as zero.
 * @param {Joint} joint @param {Readonly<Record<string, number>>} motion @returns {Pose}
 */
export function poseOfJoint(joint, motion) {
  const value = motion[joint.by] ?? 0;
  let by = (joint.scale ?? 1) * (Number.isFinite(value) ? value : 0);
  if (joint.wrap_mm) by -= joint.wrap_mm * Math.floor(by / joint.wrap_mm);
  return joint.kind === 'turn' ? turned(joint.axis, joint.origin_mm ?? [0, 0, 0], by) : slid(joint.axis, by);
}

/**
 * Displacements of all bodies from where they are with every column 0, X = X_parent * J1 * J2 ... * Jn: a part's pose in W is its
 * body's displacement times its pose in the description.
 * @param {Body[]} bodies each after its parent @param {Readonly<Record<string, number>>} motion one row, by column
 * @returns {Pose[]}
 * @throws {Error} for a parent that is not listed before its child
 */
export function posesOf(bodies, motion) {
  /** @type {Pose[]} */
  const poses = [];
  for (const body of bodies) {
    const parent = body.parent === null ? identity() : poses[body.parent];
    if (!parent) throw new Error(`the body ${body.name} comes before its parent`);
    poses.push(body.joints.reduce((pose, joint) => times(pose, poseOfJoint(joint, motion)), parent));
  }
  return poses;
}
