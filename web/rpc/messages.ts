// The wire contract of the simulation server: JSON-RPC 2.0 over the WebSocket at `/rpc`, parameters by name, SI units.
//
// Calls name a method of `Methods`; the server sends one notification, `stream.frame`, which the client answers with the
// notification `stream.ack` (at most four frames may be unacknowledged, later ones are dropped, the newest is kept).
// A frame's values stand in the order of the variables of its subscription; a value that is not finite is null.
// Commands to the crane lapse to zero 500 ms after the last `control.command` and when the link is lost.

export type Vec3 = readonly [number, number, number];

export interface Joint {
  name: string;
  kind: "revolute" | "prismatic";
  axis: Vec3;
  /** Origin of the joint in the frame of the link before it [m]. */
  origin: Vec3;
  limits: readonly [number, number] | null;
}

export interface Link {
  name: string;
  joint: Joint;
  mass: number;
  com: Vec3;
}

/** A point in the plane of the crane, fixed to a link [m]. */
export interface Attachment {
  link: string;
  x: number;
  z: number;
}

export interface Cylinder {
  name: string;
  count: number;
  bore: number;
  rod: number;
  stroke: number;
  /** Length between the pins with the rod fully in [m]. */
  retracted?: number | null;
  base: Attachment;
  eye: Attachment;
  moves: string;
}

export interface Hoist {
  /** Where the rope leaves the drum. */
  drum: Attachment;
  /** In the order the rope passes them; the last is where the rope leaves for the hook. */
  sheaves: readonly Attachment[];
  drum_radius: number;
  rope: { diameter: number };
}

export interface RatedLoad {
  radius: number;
  mass: number;
}

/** The parts of a crane's design file that a picture and its instruments need, in SI. */
export interface CraneDesign {
  name: string;
  about?: string;
  links: readonly Link[];
  cylinders: readonly Cylinder[];
  hoist: Hoist;
  /** Crane foot (centre of the slew ring) in the ship's axes [m]. */
  pedestal: Vec3;
  capacity?: readonly RatedLoad[];
}

export interface ShipDimensions {
  length: number;
  beam: number;
  draught: number;
  depth: number;
  pedestal: Vec3;
}

/** omega [rad/s], k [rad/m], direction going to [rad], amplitude [m], phase [rad]. */
export type WaveComponent = readonly [number, number, number, number, number];

export interface VariableInfo {
  name: string;
  unit: string;
  /** Engineering unit it is shown in; a value in it is the SI value times `factor`. */
  shown: string;
  factor: number;
  about: string;
}

export interface ModelDescription {
  crane: CraneDesign;
  load: { mass: number; size: Vec3 };
  ship: ShipDimensions;
  sea: { waves: readonly WaveComponent[]; about: string };
  slaves: readonly { name: string; about: string }[];
  variables: readonly VariableInfo[];
  /** Names of the command axes: one for each joint of the chain, then the hoist. */
  axes: readonly string[];
}

export interface SimulationStatus {
  time: number;
  running: boolean;
  finished: boolean;
  error: string | null;
  real_time_factor: number | null;
  macro_step: number;
  overruns: number;
  late_ms_p99: number | null;
  /** Time to which the recording reaches [s]. */
  recorded: number;
  clients: number;
  /** Numbers of clients. */
  driver: number | null;
  you: number;
}

/** Where the axes stand, by name, each in [-1, 1]. */
export type Axes = Readonly<Record<string, number>>;

/** Parameters and result of every method. */
export interface Methods {
  "server.info": [Record<string, never>, { name: string; version: string; protocol: string }];
  "simulation.status": [Record<string, never>, SimulationStatus];
  "simulation.pause": [Record<string, never>, SimulationStatus];
  "simulation.resume": [Record<string, never>, SimulationStatus];
  "simulation.reset": [Record<string, never>, SimulationStatus];
  "model.describe": [Record<string, never>, ModelDescription];
  "stream.subscribe": [{ variables: readonly string[]; rate: number }, { subscription: number; rate: number }];
  "stream.unsubscribe": [{ subscription: number }, unknown];
  "control.acquire": [{ take_over?: boolean }, { driver: number; lease: number }];
  "control.release": [Record<string, never>, unknown];
  "control.command": [{ axes: Axes; deadman: boolean }, { accepted: boolean }];
}

export interface StreamFrame {
  subscription: number;
  seq: number;
  time: number;
  values: readonly (number | null)[];
}

export interface Problem {
  path: string;
  message: string;
  allowed?: string;
  hint?: string;
}
