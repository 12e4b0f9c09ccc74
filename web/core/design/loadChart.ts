// What a crane may lift in each of a grid of postures, and what keeps it from more: the crane and the rows of its grid
// for loadChart.c, which has the laws, in WebAssembly. The same as src/seacrane/design/chart.py; a shared fixture holds
// both equal.
import compiled from "./loadChart.wasm?url&inline";
import { planar, retracted, span } from "./plane";
import { type Attachment, type Crane, type Cylinder, GRAVITY, type Mode, tilt } from "./types";

const SAFETY_FACTOR = 3;

/** Loads of a grid of postures; the last joint runs fastest. */
export interface Capacity {
  readonly count: number;
  /** Of the tip, from the slewing axis and above the foot [m]. */
  readonly radius: Float64Array;
  readonly height: Float64Array;
  /** [kg]; 0 where not even the hook is held. */
  readonly load: Float64Array;
  /** Index into `limits`. */
  readonly governs: Float64Array;
}

/** The names of the limits of a crane in their order. */
export function limitNames(crane: Crane): string[] {
  const { rating, hoist } = crane;
  const names = crane.cylinders.map((cylinder) => cylinder.name);
  for (const item of rating?.structure ?? []) names.push(`structure at ${item.joint}`);
  if (rating?.slew_moment != null) names.push("slew moment");
  if (rating?.slew_torque != null) names.push("slew torque");
  if (hoist.rope.breaking_load != null) names.push("rope");
  if (hoist.line_pull != null) names.push("winch");
  if (rating?.load_moment != null) names.push("load moment");
  if (rating?.heeling_moment != null) names.push("ship stability");
  return names.length > 0 ? names : ["nothing"];
}

/** Push and pull of a cylinder set at its working pressure, the other side empty [N]. */
export function cylinderForces(cylinder: Cylinder): [push: number, pull: number] {
  const [bore, annulus] = areas(cylinder);
  const force = (cylinder.efficiency ?? 1) * cylinder.pressure;
  return [force * bore, force * annulus];
}

/** Areas that a cylinder set pushes with on its bore side and on its rod side [m2]. */
export function areas(cylinder: Cylinder): [bore: number, annulus: number] {
  const quarter = ((cylinder.count ?? 1) * Math.PI) / 4;
  return [quarter * cylinder.bore ** 2, quarter * (cylinder.bore ** 2 - cylinder.rod ** 2)];
}

/** Vertical speed with which a load in these waves is met [m/s]. */
export function meetingSpeed(crane: Crane, mode: Mode): number {
  const deck = (6 * mode.waveHeight) / (mode.waveHeight + 8);
  return Math.hypot(deck, (crane.rating?.tip_speed_per_height ?? 0) * mode.waveHeight);
}

/** How far outboard a load may lead at the sea's surface [m]; not at all in harbour. */
export function offlead({ waveHeight }: Mode): number {
  return waveHeight > 0 ? 2.5 + 1.5 * waveHeight : 0;
}

/** Weight on the hook over (falls times tension at the winch), each sheave turning. */
export function reeving(falls: number, sheave: number): number {
  let sum = 0;
  for (let i = 0; i < falls; i += 1) sum += sheave ** i;
  return sum / falls;
}

/** Loads on the grid of `coordinates`, one array for each joint of the plane. */
export function capacity(crane: Crane, coordinates: readonly ArrayLike<number>[], mode: Mode): Capacity {
  const result = allocate(coordinates.reduce((product, values) => product * values.length, 1));
  sweep(crane, coordinates, mode, ({ count, radius, height, load, governs }, at, stride) => {
    for (let j = 0, to = at; j < count; j += 1, to += stride) {
      result.radius[to] = radius[j];
      result.height[to] = height[j];
      result.load[to] = load[j];
      result.governs[to] = governs[j];
    }
  });
  return result;
}

/**
 * Visits such a grid in rows: the first `count` of the arrays are the postures `at`, `at + stride` and so on of the grid,
 * until the next row takes their place. What governs is there only if it is to tell that.
 */
export function sweep(
  crane: Crane,
  coordinates: readonly ArrayLike<number>[],
  mode: Mode,
  visit: (row: Capacity, at: number, stride: number) => void,
  tells = true,
): void {
  const counts = coordinates.map((values) => values.length);
  if (counts.length === 0 || counts.includes(0)) return;
  const joints = planar(crane);
  const strides = counts.map((_, k) => counts.slice(k + 1).reduce((product, count) => product * count, 1));
  // the longer the rows, the fewer
  const runs = counts.indexOf(Math.max(...counts));
  const running = coordinates[runs];
  const standing = counts.map((_, k) => k).filter((k) => k !== runs);
  // travel, cosine and sine
  const place = (k: number, q: number): [number, number, number] =>
    joints[k].turns ? [0, Math.cos(q), Math.sin(q) * joints[k].sign] : [q, 1, 0];
  fitting(() => describe(crane, mode));
  const pieces = Math.ceil(running.length / ROW);
  for (let piece = 0; piece < pieces; piece += 1) {
    const from = Math.floor((piece * running.length) / pieces);
    const count = Math.floor(((piece + 1) * running.length) / pieces) - from;
    for (let j = 0; j < count; j += 1) {
      const [q, c, s] = place(runs, running[from + j]);
      U[j] = joints[runs].turns ? c : q;
      V[j] = s;
    }
    fitting(() => chart.rows(runs, Math.ceil(count / 2)));
    for (const k of standing) chart.stand(k, ...place(k, coordinates[k][0]));
    const row = { count, radius: RADIUS, height: HEIGHT, load: LOAD, governs: GOVERNS };
    const index = counts.map(() => 0);
    let at = from * strides[runs];
    for (let rest = (strides[0] * counts[0]) / running.length; rest > 0; rest -= 1) {
      chart.row(tells);
      visit(row, at, strides[runs]);
      // the next posture of the standing joints, the last fastest
      for (let i = standing.length - 1; i >= 0; i -= 1) {
        const k = standing[i];
        const next = (index[k] + 1) % counts[k];
        at += (next - index[k]) * strides[k];
        index[k] = next;
        if (counts[k] > 1) chart.stand(k, ...place(k, coordinates[k][next]));
        if (next > 0) break;
      }
    }
  }
}

function allocate(count: number): Capacity {
  return {
    count,
    radius: new Float64Array(count),
    height: new Float64Array(count),
    load: new Float64Array(count),
    governs: new Float64Array(count),
  };
}

// ---------------------------------------------------------------- the crane, for the laws
/** Each is explained where it is written, in loadChart.c. */
interface Chart {
  describe(links: number, joints: number, rams: number, ropes: number, strengths: number): void;
  link(mass: number, x: number, z: number, originX: number, originZ: number): void;
  joint(link: number, turns: boolean, sign: number, slideX: number, slideZ: number): void;
  ram(
    ...of: [
      ...Pins,
      joint: number,
      push: number,
      pull: number,
      bore: number,
      annulus: number,
      stroke: number,
      closed: number,
    ]
  ): void;
  rope(...between: Pins): void;
  strength(joint: number, moment: number): void;
  gear(torque: number, by: number): void;
  stand_on(sine: number, cosine: number, foot: number, aside: number, bulkModulus: number): void;
  hoist(tipX: number, tipZ: number, falls: number, give: number, hoisted: number, by: number, hook: number): void;
  rate(factor: number, loadMoment: number, loadBy: number, heelingMoment: number, heelingBy: number): void;
  sea(offlead: number, impact: number): void;
  rows(runs: number, pairs: number): void;
  stand(k: number, q: number, c: number, s: number): void;
  row(tells: boolean): void;
  raster(
    width: number,
    height: number,
    left: number,
    low: number,
    perCell: number,
    perKilogram: number,
    most: number,
    indices: number,
  ): number;
  bring(count: number, first: number, stride: number): void;
  loads(): number;
}

/** Place of the link, or -1 for the foot, and the pin on it; the inner one first. */
type Pins = [inner: number, innerX: number, innerZ: number, outer: number, outerX: number, outerZ: number];

/** Postures of a row at most. */
const ROW = 640;

const bytes = Uint8Array.from(atob(compiled.slice(compiled.indexOf(",") + 1)), (letter) => letter.charCodeAt(0));
const { exports } = new WebAssembly.Instance(new WebAssembly.Module(bytes));

export const chart = exports as unknown as Chart;

export const memory = (exports.memory as WebAssembly.Memory).buffer;
const [U, V, RADIUS, HEIGHT, LOAD, GOVERNS] = ["u", "v", "radius", "height", "load", "governs"].map(
  (name) => new Float64Array(memory, (exports[name] as () => number)(), ROW),
);

/** Tells in words that there is no room for what the laws are to keep in mind. */
function fitting(run: () => void): void {
  try {
    run();
  } catch (error) {
    if (!(error instanceof WebAssembly.RuntimeError)) throw error;
    throw new Error("the crane has more cylinders and sheaves than the load chart has room for");
  }
}

function describe(crane: Crane, mode: Mode): void {
  const { links, cylinders, hoist, rating, pedestal } = crane;
  const joints = planar(crane);
  const structure = rating?.structure ?? [];
  const slewing = rating?.slew_moment == null ? [] : [{ joint: null, moment: rating.slew_moment }];
  const strengths = [...structure, ...slewing];
  const path = [hoist.drum, ...hoist.sheaves];
  const jointOf = (name: string | null) => {
    const k = name === null ? joints.length : joints.findIndex(({ joint }) => joint.name === name);
    if (k < 0) throw new Error(`no joint ${name} moves the crane in its plane`);
    return k;
  };
  const pins = (a: Attachment, b: Attachment): Pins => {
    const { inner, outer, innerLink, outerLink } = span(crane, a, b);
    return [innerLink, inner.x, inner.z, outerLink, outer.x, outer.z];
  };
  chart.describe(links.length, joints.length, cylinders.length, path.length - 1, strengths.length);
  for (const { mass, com, joint } of links) chart.link(mass, com[0], com[2], joint.origin[0], joint.origin[2]);
  for (const { link, turns, sign, slideX, slideZ } of joints) chart.joint(link, turns, sign, slideX, slideZ);
  for (const cylinder of cylinders) {
    const { base, eye, moves, stroke } = cylinder;
    chart.ram(
      ...pins(base, eye),
      jointOf(moves),
      ...cylinderForces(cylinder),
      ...areas(cylinder),
      stroke,
      retracted(crane, cylinder),
    );
  }
  path.slice(1).forEach((to, i) => {
    chart.rope(...pins(path[i], to));
  });
  for (const { joint, moment } of strengths) chart.strength(jointOf(joint), moment);

  const falling = tilt(crane);
  chart.stand_on(Math.sin(falling), Math.cos(falling), pedestal[2], Math.abs(pedestal[1]), crane.bulk_modulus);
  const falls = hoist.falls ?? 1;
  const carried = falls * reeving(falls, hoist.sheave_efficiency ?? 1);
  const { breaking_load, safety_factor, EA } = hoist.rope;
  const bearable = [
    breaking_load == null ? null : (carried * breaking_load) / (safety_factor ?? SAFETY_FACTOR),
    hoist.line_pull == null ? null : carried * hoist.line_pull,
  ].filter((value) => value !== null);
  const hoisted = Math.min(Number.POSITIVE_INFINITY, ...bearable);
  const gear = cylinders.length + strengths.length;
  const hoists = gear + (rating?.slew_torque == null ? 0 : 1);
  const by = bearable.length ? hoists + bearable.indexOf(hoisted) : 0;
  const { x, z } = hoist.sheaves[hoist.sheaves.length - 1];
  chart.hoist(x, z, falls, 1 / EA, hoisted, by, hoist.hook_mass ?? 0);
  const { load_moment, heeling_moment } = rating ?? {};
  const moments = hoists + bearable.length;
  const heeling = moments + (load_moment == null ? 0 : 1);
  const endless = Number.POSITIVE_INFINITY;
  chart.gear(rating?.slew_torque ?? endless, gear);
  chart.rate(rating?.harbour_factor ?? 1, load_moment ?? endless, moments, heeling_moment ?? endless, heeling);
  const speed = (0.5 * hoist.speed) / falls + meetingSpeed(crane, mode);
  chart.sea(offlead(mode), mode.waveHeight > 0 ? (speed / GRAVITY) ** 2 : 0);
}
