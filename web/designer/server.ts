// What the page asks the package's server for. Without one, each says so.

import type { Problem } from "../core/design/check";
import { fromData, text } from "../core/design/file";
import type { Front, Specification } from "../core/design/optimise";
import type { Posture } from "../core/design/plane";
import type { Crane, Imported } from "../core/design/types";

const ABSENT =
  "There is no seacrane server behind this page. Start it with `seacrane designer`, or save the design as JSON and use `seacrane design` on the command line.";

function post(path: string, body: BodyInit, type: string): Promise<Response> {
  return ask(path, { method: "POST", body, headers: { "Content-Type": type } });
}

async function ask(path: string, how?: RequestInit): Promise<Response> {
  const answer = await fetch(`./api/design/${path}`, how).catch(() => null);
  if (!answer || answer.status === 404 || answer.status === 405 || answer.status === 501) throw new Error(ABSENT);
  if (!answer.ok) throw new Error(await reason(answer));
  return answer;
}

async function reason(answer: Response): Promise<string> {
  const said = await answer.text();
  try {
    const { problems, error, message } = JSON.parse(said);
    if (Array.isArray(problems)) return problems.map(inWords).join("\n");
    return String(error?.message ?? error ?? message ?? said);
  } catch {
    return said || `The server answered ${answer.status}.`;
  }
}

/** A problem as the package tells it. */
export interface Told extends Problem {
  readonly value?: string | null;
  readonly allowed?: string | null;
  readonly hint?: string | null;
}

/** A problem in words at its place in the design; the package names first where it read the design from. */
export function placed(told: Told): Problem {
  return { path: told.path.replace(/^design: /, ""), message: sentence(told) };
}

export function inWords(told: Told): string {
  return `${told.path}: ${sentence(told)}`;
}

function sentence({ message, value, allowed, hint }: Told): string {
  const got = value ? ` (got ${value})` : "";
  return `${message}${got}${allowed ? `; allowed: ${allowed}` : ""}${hint ? `. ${hint}` : ""}`;
}

/** The archive with everything about the crane. */
export async function exported(crane: Crane): Promise<Blob> {
  return (await post("export", text(crane), "application/json")).blob();
}

/** The crane of an archive. */
export async function imported(archive: Blob): Promise<Crane> {
  return fromData(await (await post("import", archive, "application/zip")).json());
}

/** The part in a file with a mesh of another program; `unit` is that of an STL. */
export async function meshPart(file: File, unit: string): Promise<Imported> {
  const named = new URLSearchParams({ name: file.name, unit });
  return (await post(`mesh?${named}`, file, "application/octet-stream")).json();
}

/** The search for better designs as it stands. */
export interface Search {
  readonly running: boolean;
  /** At which it ends. */
  readonly generations: number;
  readonly front: Front | null;
  /** What the crane that it began with reaches in each goal, SI. */
  readonly stands: readonly number[] | null;
  /** Why none of the candidates can be built, of the one that misses least; empty if one can. */
  readonly hindered: readonly string[];
  readonly problems: readonly Told[];
}

export async function search(): Promise<Search> {
  return (await ask("optimise")).json();
}

export async function beginSearch(crane: Crane, wanted: Specification): Promise<Search> {
  return (await post("optimise", JSON.stringify({ design: crane, ...wanted }), "application/json")).json();
}

export async function stopSearch(): Promise<Search> {
  return (await post("optimise/stop", "", "application/json")).json();
}

/** Puts a saved front in the place of the one that the server has. */
export async function openFront(file: Blob): Promise<Search> {
  return (await post("optimise/open", file, "application/json")).json();
}

/** Goes on with the front that the server has, to so many generations in all. */
export async function resumeSearch(generations: number): Promise<Search> {
  return (await post("optimise/resume", JSON.stringify({ generations }), "application/json")).json();
}

/** The crane with other sizes [m] by path, strokes fitted. */
export async function changed(crane: Crane, changes: Record<string, number>): Promise<Crane> {
  const body = JSON.stringify({ design: crane, changes });
  return fromData(await (await post("change", body, "application/json")).json());
}

/** All that the package finds wrong. */
export async function checked(crane: Crane): Promise<Told[]> {
  return (await (await post("check", text(crane), "application/json")).json()).problems;
}

/** The address of an operation page with this crane in this posture. */
export async function simulated(crane: Crane, posture: Posture, load: number, waveHeight: number): Promise<string> {
  const body = JSON.stringify({ design: JSON.parse(text(crane)), posture, load, hs: waveHeight });
  const { address } = await (await post("simulate", body, "application/json")).json();
  return address;
}

/** The design that the command was given; null if it was given none, or there is no server. */
export async function given(): Promise<Crane | null> {
  try {
    const answer = await fetch("./api/design/opened");
    return answer.status === 200 ? fromData(await answer.json()) : null;
  } catch {
    return null;
  }
}
