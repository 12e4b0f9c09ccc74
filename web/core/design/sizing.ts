// A cylinder to begin with that is as strong as the rest of its crane.
import { holding } from "./holding";
import { capacity } from "./loadChart";
import { type Crane, type Cylinder, GRAVITY, HARBOUR, planeJoints } from "./types";

/** Of each joint. */
const COORDINATES = 7;
/** Of the postures in which the cylinder bears all that the other limits allow. */
const SHARE = 0.9;
const STEP = 0.005;
const LEAST = 0.04;

/**
 * The cylinder with a bore that bears, at its working pressure in harbour, what all other limits of the crane allow and no
 * more than it is rated for, in nine postures of ten; its rod keeps its share of the bore.
 */
export function sized(crane: Crane, cylinder: Cylinder): Cylinder {
  const joints = planeJoints(crane);
  const coordinates = joints.map(({ limits }) =>
    limits
      ? Array.from({ length: COORDINATES }, (_, i) => limits[0] + ((i + 0.5) * (limits[1] - limits[0])) / COORDINATES)
      : [0],
  );
  const others = crane.cylinders.filter(({ name }) => name !== cylinder.name);
  const { count, load } = capacity({ ...crane, cylinders: others }, coordinates, HARBOUR);
  const rated = Math.max(...crane.capacity.map(({ mass }) => mass));
  const { hook_mass } = crane.hoist;
  const pressures = Array.from({ length: count }, (_, index) => {
    let rest = index;
    const posture: Record<string, number> = {};
    for (let k = joints.length - 1; k >= 0; k -= 1) {
      posture[joints[k].name] = coordinates[k][rest % coordinates[k].length];
      rest = Math.floor(rest / coordinates[k].length);
    }
    const weight = (Math.min(load[index], rated) + (hook_mass ?? 0)) * GRAVITY * (crane.rating?.harbour_factor ?? 1);
    return holding({ ...crane, cylinders: [cylinder] }, posture, weight, HARBOUR)[0].pressure;
  })
    .filter(Number.isFinite)
    .sort((a, b) => a - b);
  const pressure = pressures[Math.floor(SHARE * (pressures.length - 1))];
  if (!(pressure > 0)) return cylinder;
  const wanted = cylinder.bore * Math.sqrt(pressure / cylinder.pressure);
  const bore = Math.max(LEAST, Number((STEP * Math.ceil(wanted / STEP)).toFixed(3)));
  const rod = STEP * Math.max(1, Math.round((bore * cylinder.rod) / cylinder.bore / STEP));
  return { ...cylinder, bore, rod: Math.min(Number(rod.toFixed(3)), bore - STEP) };
}
