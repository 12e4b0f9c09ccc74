// What the page asks the package's server for. Without one, each says so.

import type { Problem } from "../core/design/check";
import { fromData, text } from "../core/design/file";
import type { Posture } from "../core/design/plane";
import type { Crane } from "../core/design/types";

const ABSENT =
  "There is no seacrane server behind this page. Start it with `seacrane designer`, or save the design as JSON and use `seacrane design` on the command line.";

async function post(path: string, body: BodyInit, type: string): Promise<Response> {
  const answer = await fetch(`./api/design/${path}`, { method: "POST", body, headers: { "Content-Type": type } }).catch(
    () => null,
  );
  if (!answer || answer.status === 404 || answer.status === 405 || answer.status === 501) throw new Error(ABSENT);
  if (!answer.ok) throw new Error(await reason(answer));
  return answer;
}

async function reason(answer: Response): Promise<string> {
  const said = await answer.text();
  try {
    const { problems, error, message } = JSON.parse(said);
    if (Array.isArray(problems))
      return problems
        .map((item: Problem | string) => (typeof item === "string" ? item : `${item.path}: ${item.message}`))
        .join("\n");
    return String(error?.message ?? error ?? message ?? said);
  } catch {
    return said || `The server answered ${answer.status}.`;
  }
}

/** The archive with everything about the crane. */
export async function exported(crane: Crane): Promise<Blob> {
  return (await post("export", text(crane), "application/json")).blob();
}

/** The crane of an archive. */
export async function imported(archive: Blob): Promise<Crane> {
  return fromData(await (await post("import", archive, "application/zip")).json());
}

/** All that the package finds wrong. */
export async function checked(crane: Crane): Promise<Problem[]> {
  const answer = await (await post("check", text(crane), "application/json")).json();
  return Array.isArray(answer) ? answer : answer.problems;
}

/** The address of an operation page with this crane in this posture. */
export async function simulated(crane: Crane, posture: Posture, load: number): Promise<string> {
  const body = JSON.stringify({ design: JSON.parse(text(crane)), posture, load });
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
