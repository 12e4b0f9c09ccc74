// What a crane may lift in each of a grid of postures, and what keeps it from more. The same laws as
// src/seacrane/design/chart.py, which says where they come from; a shared fixture holds both equal.
//
// In a row of postures only one joint moves. Every moment is then a sum of three terms (see rows.ts), and the lever of a
// cylinder either stands still or is the same in all rows, so that the laws at the end of this file run over tables.
import { retracted } from "./plane";
import { Along, AlongPoint, type Line, ROW, Rows, U, V } from "./rows";
import { type Crane, type Cylinder, GRAVITY, type Mode } from "./types";

const STROKE_MARGIN = 0.01;
const LEAST_HANG = 1.0;
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
  readonly governs: Uint8Array;
}

/** The names of the limits of a crane in their order. */
export function limitNames(crane: Crane): string[] {
  const { rating, hoist } = crane;
  const names = crane.cylinders.map((cylinder) => cylinder.name);
  for (const item of rating?.structure ?? []) names.push(`structure at ${item.joint}`);
  if (rating?.slew_moment != null) names.push("slew moment");
  if (hoist.rope.breaking_load != null) names.push("rope");
  if (hoist.line_pull != null) names.push("winch");
  if (rating?.load_moment != null) names.push("load moment");
  if (rating?.heeling_moment != null) names.push("ship stability");
  return names.length > 0 ? names : ["nothing"];
}

/** Why the crane does not move in one plane, in words; empty if it does. */
export function planeProblems(crane: Crane): string[] {
  const problems: string[] = [];
  crane.links.forEach(({ name, joint }, index) => {
    const size = Math.hypot(...joint.axis);
    const [, y, z] = joint.axis.map((value) => value / size);
    if (joint.name === crane.slew?.joint) {
      if (index > 0 || joint.kind !== "revolute" || Math.abs(z) < 1 - 1e-9)
        problems.push(`${name}: the slewing joint must be the first, turning about the vertical`);
      return;
    }
    if (joint.kind === "revolute" && Math.abs(y) < 1 - 1e-9) problems.push(`${name}: turns out of the crane's plane`);
    if (joint.kind === "prismatic" && Math.abs(y) > 1e-9) problems.push(`${name}: slides out of the crane's plane`);
    if (!joint.limits) problems.push(`${name}: the joint needs limits, only slewing may be endless`);
  });
  return problems;
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

export function hookSpeedNeeded(crane: Crane, mode: Mode): number {
  return ((crane.hoist.falls ?? 1) === 1 ? 0.5 : 0.28) * meetingSpeed(crane, mode);
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
  sweep(crane, coordinates, mode, ({ count, radius, height, load, governs }, at) => {
    result.radius.set(radius.subarray(0, count), at);
    result.height.set(height.subarray(0, count), at);
    result.load.set(load.subarray(0, count), at);
    result.governs.set(governs.subarray(0, count), at);
  });
  return result;
}

/**
 * Visits such a grid in rows: the first `count` of the arrays are the postures from index `at` of the grid on, until the
 * next row takes their place.
 */
export function sweep(
  crane: Crane,
  coordinates: readonly ArrayLike<number>[],
  mode: Mode,
  visit: (row: Capacity, at: number) => void,
): void {
  if (coordinates.length === 0 || coordinates.some((values) => values.length === 0)) return;
  // rows along the last joint that has more than one coordinate
  const single = coordinates.map((values) => values.length === 1);
  const runs = Math.max(0, single.lastIndexOf(false));
  const running = Array.from(coordinates[runs]);
  const outer = coordinates.slice(0, runs);
  const standing = outer.reduce((product, values) => product * values.length, 1);
  const pieces = Math.ceil(running.length / ROW);
  for (let piece = 0; piece < pieces; piece += 1) {
    const from = Math.floor((piece * running.length) / pieces);
    const to = Math.floor(((piece + 1) * running.length) / pieces);
    const rows = new Rows(crane, runs, running.slice(from, to));
    for (const [k, values] of coordinates.entries()) if (k !== runs) rows.stand(k, values[0]);
    rows.pose();
    const lift = new Lift(crane, rows, mode);
    const index = outer.map(() => 0);
    for (let row = 0; row < standing; row += 1) {
      rows.pose();
      visit(lift.row(), row * running.length + from);
      for (let k = outer.length - 1; k >= 0; k -= 1) {
        index[k] = (index[k] + 1) % outer[k].length;
        rows.stand(k, outer[k][index[k]]);
        if (index[k] > 0) break;
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
    governs: new Uint8Array(count),
  };
}

// ---------------------------------------------------------------- one row
// Place of the tip, load and what governs; the weight with its dynamics that is borne [N]; the lead of the load over its
// height; how far a newton on the hook lets it down [m/N].
const RADIUS = new Float64Array(ROW);
const HEIGHT = new Float64Array(ROW);
const LOAD = new Float64Array(ROW);
const GOVERNS = new Uint8Array(ROW);
const BORNE = new Float64Array(ROW);
const LEAD = new Float64Array(ROW);
const COMPLIANCE = new Float64Array(ROW);

/** What bears a moment about a joint: a cylinder set, the structure, or the slewing ring. */
interface Bearer {
  /** Place of the joint; null for the slewing ring. */
  readonly joint: number | null;
  readonly ram?: Ram;
  /**
   * Four columns, a line for each posture or one for all of a row. The moments that it bears lie within HALF of MIDDLE
   * [N.m]; its oil lets the joint yield by SOFT [rad/(N.m), m/N]; the joint pulls in PULLED of the rope over the falls [m].
   */
  readonly table: Float64Array;
  /** Whether the table is the same in all rows. */
  readonly same: boolean;
}

const MIDDLE = 0;
const HALF = 1;
const SOFT = 2;
const PULLED = 3;
const COLUMNS = 4;

interface Ram {
  readonly line: Line;
  readonly length: Float64Array;
  readonly lever: Float64Array;
  readonly push: number;
  readonly pull: number;
  readonly bore: number;
  readonly annulus: number;
  readonly stroke: number;
  /** Length with the rod fully in [m]. */
  readonly closed: number;
}

/** A length of rope, and what each joint between its ends pulls in of it. */
interface Fall {
  readonly line: Line;
  readonly length: Float64Array;
  readonly levers: readonly Float64Array[];
}

/** The lift of a load along the rows of a grid. */
class Lift {
  private readonly atSea: boolean;
  /** Components of the upward direction along the crane's x and z. */
  private readonly upX: number;
  private readonly upZ: number;
  private readonly bearers: readonly Bearer[];
  private readonly rope: readonly Fall[];
  private readonly falls: number;
  /** Weight with its dynamics that rope and winch bear [N], and which of them bears less. */
  private readonly hoisted: number;
  private readonly hoistedBy: number;
  /** Index of the first limit that takes no dynamics. */
  private readonly momentsFrom: number;
  /** Of a link and all that it carries [kg]. */
  private readonly masses: readonly number[];
  /** Of a link and all that it carries: masses times places [kg.m]; nothing beyond the last link. */
  private readonly sums: readonly AlongPoint[];
  private readonly mass = new AlongPoint();
  private readonly tip = new AlongPoint();
  private readonly own = new Along();
  private readonly plumb = new Along();
  private readonly led = new Along();
  private readonly offlead: number;
  /** (v_r / g)^2 [s2] */
  private readonly impact: number;

  constructor(
    private readonly crane: Crane,
    private readonly rows: Rows,
    mode: Mode,
  ) {
    const { hoist, rating, cylinders, links } = crane;
    const { count } = rows;
    this.atSea = mode.waveHeight > 0;
    const heel = rating?.heel ?? 0;
    this.upX = -Math.sin(heel);
    this.upZ = Math.cos(heel);
    this.falls = hoist.falls ?? 1;
    this.offlead = 2.5 + 1.5 * mode.waveHeight;
    this.impact = (((0.5 * hoist.speed) / this.falls + meetingSpeed(crane, mode)) / GRAVITY) ** 2;
    this.sums = [...links, null].map(() => new AlongPoint());
    this.masses = links.map((_, i) => links.slice(i).reduce((sum, { mass }) => sum + mass, 0));

    const path = [hoist.drum, ...hoist.sheaves];
    this.rope = path.slice(1).map((to, i) => {
      const line = rows.line(path[i], to);
      const size = line.runs ? count : 1;
      return {
        line,
        length: new Float64Array(size),
        levers: rows.joints.map((_, k) => new Float64Array(line.joints.includes(k) ? size : 0)),
      };
    });
    for (const fall of this.rope) this.reeve(fall);
    const place = (name: string) => rows.joints.findIndex((joint) => joint.joint.name === name);
    const bearer = (joint: number | null, moment: number, ram?: Ram): Bearer => {
      const lines = [...this.rope, ...(ram ? [ram] : [])].map(({ line }) => line);
      const over = lines.filter(({ joints }) => joint !== null && joints.includes(joint));
      const table = new Float64Array(COLUMNS * (over.some(({ runs }) => runs) ? count : 1));
      for (let t = 0; t < table.length; t += COLUMNS) table[t + HALF] = moment;
      return { joint, ram, table, same: over.every(({ same }) => same) };
    };
    this.bearers = [
      ...cylinders.map((cylinder) => {
        const { base, eye, moves, stroke } = cylinder;
        const line = rows.line(base, eye);
        const [push, pull] = cylinderForces(cylinder);
        const [bore, annulus] = areas(cylinder);
        const size = line.runs ? count : 1;
        const tables = { length: new Float64Array(size), lever: new Float64Array(size) };
        const closed = retracted(crane, cylinder);
        return bearer(place(moves), 0, { line, ...tables, push, pull, bore, annulus, stroke, closed });
      }),
      ...(rating?.structure ?? []).map(({ joint, moment }) => bearer(place(joint), moment)),
      ...(rating?.slew_moment == null ? [] : [bearer(null, rating.slew_moment)]),
    ];
    for (const item of this.bearers) if (item.same) this.tabulate(item);

    const carried = this.falls * reeving(this.falls, hoist.sheave_efficiency ?? 1);
    const { breaking_load, safety_factor } = hoist.rope;
    const bearable = [
      breaking_load == null ? null : (carried * breaking_load) / (safety_factor ?? SAFETY_FACTOR),
      hoist.line_pull == null ? null : carried * hoist.line_pull,
    ].filter((value) => value !== null);
    this.hoisted = Math.min(Number.POSITIVE_INFINITY, ...bearable);
    this.hoistedBy = bearable.length ? this.bearers.length + bearable.indexOf(this.hoisted) : 0;
    this.momentsFrom = this.bearers.length + bearable.length;
  }

  /** The loads of the row in which the joints stand now. */
  row(): Capacity {
    const { rows, crane, bearers, masses, sums, upX, upZ, atSea, own, plumb, led } = this;
    const { count } = rows;
    const { x, z } = crane.hoist.sheaves[crane.hoist.sheaves.length - 1];
    const tip = rows.point(crane.links.length - 1, x, z, this.tip);
    fill(count, tip.x, RADIUS);
    fill(count, tip.z, HEIGHT);
    for (const fall of this.rope) if (!fall.line.same) this.reeve(fall);
    if (atSea) this.hang();
    BORNE.fill(this.hoisted, 0, count);
    GOVERNS.fill(this.hoistedBy, 0, count);
    this.sum();
    for (let i = 0; i < bearers.length; i += 1) {
      const { joint, table, same } = bearers[i];
      if (!same) this.tabulate(bearers[i]);
      const link = joint === null ? 0 : rows.joints[joint].link;
      rows.work(joint, sums[link], GRAVITY * upX, GRAVITY * upZ, masses[link], own);
      rows.work(joint, tip, upX, upZ, 1, plumb);
      if (atSea) sway(count, table, own, plumb, rows.work(joint, tip, -upZ, upX, 1, led), i);
      else bear(count, table, own, plumb, i);
    }
    this.lift();
    return { count, radius: RADIUS, height: HEIGHT, load: LOAD, governs: GOVERNS };
  }

  /** By link: sum of the masses times places of it and of all that it carries [kg.m]. */
  private sum(): void {
    const { rows, crane, sums } = this;
    for (let i = crane.links.length - 1; i >= 0; i -= 1) {
      const { com, mass } = crane.links[i];
      sums[i].sum(sums[i + 1], rows.point(i, com[0], com[2], this.mass), mass);
    }
  }

  private reeve({ line, length, levers }: Fall): void {
    this.rows.span(line, length);
    for (const k of line.joints) this.rows.lever(line, k, length, levers[k]);
  }

  /** What a bearer's cylinder bears, and what its joint pulls in of the rope. */
  private tabulate({ joint, ram, table }: Bearer): void {
    if (ram) {
      const { line, length, lever, push, pull, bore, annulus, stroke, closed } = ram;
      const margin = STROKE_MARGIN * stroke;
      const step = length.length > 1 ? 1 : 0;
      this.rows.span(line, length);
      if (line.joints.includes(joint!)) this.rows.lever(line, joint!, length, lever);
      for (let t = 0, j = 0; t < table.length; t += COLUMNS, j += step) {
        const arm = lever[j];
        const extension = Math.min(Math.max(length[j] - closed, margin), stroke - margin);
        const oil = this.crane.bulk_modulus * (bore / extension + annulus / (stroke - extension));
        table[t + MIDDLE] = 0.5 * (push - pull) * arm;
        // without a lever it bears nothing, not even a joint without load
        table[t + HALF] = arm === 0 ? -1 : 0.5 * (push + pull) * Math.abs(arm);
        table[t + SOFT] = arm === 0 ? 0 : 1 / (arm * arm * oil);
      }
    }
    for (let t = PULLED; t < table.length; t += COLUMNS) table[t] = 0;
    if (joint === null) return;
    for (const { levers } of this.rope) {
      const lever = levers[joint];
      if (lever.length === 0) continue;
      const step = lever.length > 1 ? 1 : 0;
      for (let t = PULLED, j = 0; t < table.length; t += COLUMNS, j += step) table[t] += lever[j] / this.falls;
    }
  }

  /** At sea: the lead of the load, and how the rope gives. */
  private hang(): void {
    const { crane, rope, offlead, falls } = this;
    const { count } = this.rows;
    const foot = crane.pedestal[2];
    const perHang = 1 / falls / crane.hoist.rope.EA;
    const perRope = perHang / falls;
    let standing = 0;
    for (const { line, length } of rope) if (!line.runs) standing += length[0];
    for (let j = 0; j < count; j += 1) {
      const above = HEIGHT[j] + foot;
      const hang = above > LEAST_HANG ? above : LEAST_HANG;
      LEAD[j] = offlead / hang;
      COMPLIANCE[j] = perHang * hang + perRope * standing;
    }
    for (const { line, length } of rope)
      if (line.runs) for (let j = 0; j < count; j += 1) COMPLIANCE[j] += perRope * length[j];
  }

  /** What is lifted of what is borne: without its dynamics, within the limits that take none, without the hook. */
  private lift(): void {
    const { crane, impact, atSea } = this;
    const { count } = this.rows;
    const { rating, hoist, pedestal } = crane;
    const steady = 1 / GRAVITY / (rating?.harbour_factor ?? 1);
    const hook = hoist.hook_mass ?? 0;
    for (let j = 0; j < count; j += 1) LOAD[j] = BORNE[j] * steady;
    if (atSea) dynamic(count, impact);
    const { load_moment, heeling_moment } = rating ?? {};
    const aside = Math.abs(pedestal[1]);
    if (load_moment != null) within(count, load_moment / GRAVITY, 0, this.momentsFrom);
    if (heeling_moment != null)
      within(count, heeling_moment / GRAVITY, aside, this.momentsFrom + (load_moment == null ? 0 : 1));
    for (let j = 0; j < count; j += 1) LOAD[j] = LOAD[j] > hook ? LOAD[j] - hook : 0;
  }
}

function fill(count: number, { terms }: Along, into: Float64Array): void {
  const one = terms[0];
  const u = terms[1];
  const v = terms[2];
  for (let j = 0; j < count; j += 1) into[j] = one + u * U[j] + v * V[j];
}

// ---------------------------------------------------------------- the laws, along a row
// Each ends with the weight that is borne where it is less than what the limits before leave.

/** In harbour: the largest weight with |own + weight load - middle| <= half. */
function bear(count: number, table: Float64Array, own: Along, load: Along, index: number): void {
  const a = own.terms[0];
  const aU = own.terms[1];
  const aV = own.terms[2];
  const b = load.terms[0];
  const bU = load.terms[1];
  const bV = load.terms[2];
  const step = table.length > COLUMNS ? COLUMNS : 0;
  for (let j = 0, t = 0; j < count; j += 1, t += step) {
    const half = table[t + HALF];
    const self = a + aU * U[j] + aV * V[j] - table[t + MIDDLE];
    const per = 1 / (b + bU * U[j] + bV * V[j] + table[t + PULLED]);
    const weight = Math.abs(self) > half ? 0 : half * Math.abs(per) - self * per;
    if (weight < BORNE[j]) {
      BORNE[j] = weight;
      GOVERNS[j] = index;
    }
  }
}

/** At sea the same for the load hanging plumb and led outboard; and what the oil gives. */
function sway(count: number, table: Float64Array, own: Along, load: Along, led: Along, index: number): void {
  const a = own.terms[0];
  const aU = own.terms[1];
  const aV = own.terms[2];
  const b = load.terms[0];
  const bU = load.terms[1];
  const bV = load.terms[2];
  const d = led.terms[0];
  const dU = led.terms[1];
  const dV = led.terms[2];
  const step = table.length > COLUMNS ? COLUMNS : 0;
  for (let j = 0, t = 0; j < count; j += 1, t += step) {
    const half = table[t + HALF];
    const self = a + aU * U[j] + aV * V[j] - table[t + MIDDLE];
    const plumb = b + bU * U[j] + bV * V[j] + table[t + PULLED];
    const outboard = plumb + LEAD[j] * (d + dU * U[j] + dV * V[j]);
    const per = 1 / plumb;
    const other = 1 / outboard;
    let weight = half * Math.abs(per) - self * per;
    const led = half * Math.abs(other) - self * other;
    if (led < weight) weight = led;
    if (Math.abs(self) > half) weight = 0;
    COMPLIANCE[j] += plumb * plumb * table[t + SOFT];
    if (weight < BORNE[j]) {
      BORNE[j] = weight;
      GOVERNS[j] = index;
    }
  }
}

/** The mass m with psi m = what is borne, psi = 1 + sqrt(b / m), b = (v_r / g)^2 stiffness. */
function dynamic(count: number, impact: number): void {
  for (let j = 0; j < count; j += 1) {
    const borne = BORNE[j] / GRAVITY;
    const b = impact / COMPLIANCE[j];
    const mass = 0.5 * (b + 2 * borne - Math.sqrt(b * (b + 4 * borne)));
    if (mass < LOAD[j]) LOAD[j] = mass;
  }
}

/** A limit to the moment of the load alone [kg.m], about an axis this far behind the slewing axis [m]. */
function within(count: number, moment: number, aside: number, index: number): void {
  for (let j = 0; j < count; j += 1) {
    const mass = moment / ((RADIUS[j] > 1e-9 ? RADIUS[j] : 1e-9) + aside);
    if (mass < LOAD[j]) {
      LOAD[j] = mass;
      GOVERNS[j] = index;
    }
  }
}
