// SPDX-License-Identifier: Apache-2.0
// @ts-check
// The way of the beam from the laser over the mirrors to the board, from the poses of the bodies alone. Frames: W, mm.

import { applied, poseOfPart, rotated, times } from './kinematics.js';

/**
 * @typedef {import('./kinematics.js').Vec3} Vec3
 * @typedef {import('./kinematics.js').Pose} Pose
 * @typedef {{at_mm?: Vec3, body?: number | null, direction?: Vec3, mirror?: number, plane?: {at_mm: Vec3, normal: Vec3}, radius_mm: number}} Corner
 * @typedef {{from: Corner[], spot_radius_mm: number}} Beam radii are 1/e²
 * @typedef {{body: number | null, pose: number[]}} PlacedPart
 */

/** @param {Vec3} a @param {Vec3} b */
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
/** @param {Vec3} a @param {Vec3} b @param {number} s @returns {Vec3} */
const plus = (a, b, s = 1) => [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]];

/** Where a ray meets a plane; undefined if it runs along it. @param {Vec3} from @param {Vec3} direction @param {Vec3} place @param {Vec3} normal */
function met(from, direction, place, normal) {
  const slope = dot(direction, normal);
  if (Math.abs(slope) < 1e-12) return undefined;
  return plus(from, direction, dot(plus(place, from, -1), normal) / slope);
}

/**
 * Corners of the beam in order, without its end on the board, and the direction in which it leaves the last of them.
 * @param {Beam} beam @param {PlacedPart[]} parts @param {Pose[]} poses displacement of each body
 * @returns {{corners: Vec3[], direction: Vec3 | undefined}}
 */
export function beamCorners(beam, parts, poses) {
  /** @type {Vec3[]} */
  const corners = [];
  /** @type {Vec3 | undefined} */
  let direction;
  for (const corner of beam.from) {
    const last = corners[corners.length - 1];
    if (corner.at_mm) {
      const pose = corner.body === null || corner.body === undefined ? undefined : poses[corner.body];
      corners.push(pose ? applied(pose, corner.at_mm) : corner.at_mm);
      if (corner.direction) direction = pose ? rotated(pose, corner.direction) : corner.direction;
      continue;
    }
    if (!direction) break;
    const plane = corner.plane ?? mirrorPlane(parts[corner.mirror ?? 0], poses);
    const point = met(last, direction, plane.at_mm, plane.normal);
    if (!point) break;
    corners.push(point);
    if (!corner.plane) direction = plus(direction, plane.normal, -2 * dot(direction, plane.normal));
  }
  return { corners, direction };
}

/** @param {PlacedPart} part @param {Pose[]} poses */
function mirrorPlane(part, poses) {
  const rest = poseOfPart(part.pose);
  const pose = part.body === null ? rest : times(poses[part.body], rest);
  return { at_mm: applied(pose, [0, 0, 0]), normal: rotated(pose, [0, 0, 1]) };
}
