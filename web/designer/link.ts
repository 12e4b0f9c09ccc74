// A design and how it is looked at in the fragment of an address, which no server sees: `#crane=1.` and compressed JSON.
import { DesignFileError, fromData } from "../core/design/file";
import type { Posture } from "../core/design/plane";
import { type Crane, modes } from "../core/design/types";
import type { Bench } from "./context";
import { keepVersions, versions } from "./saving";
import { SHIPPED } from "./shipped";
import type { Selection } from "./store";
import { type Camera, type Look, type Results, type Show, type Tools, type Vec, ZOOMS } from "./view";

const START = "crane=1.";
/** Longer addresses are cut by programs that pass them on. */
export const LONGEST = 32_000;
const LARGEST = 2 * 2 ** 20;
const FAR = 1e5;

export interface Shared {
  readonly crane: Crane;
  readonly posture: Posture;
  readonly mode: string;
  readonly selection: Selection;
  readonly show: Show;
  readonly results: Results;
  readonly look: Look | null;
  readonly camera: Camera | null;
  readonly tools: Pick<Tools, "cut" | "explode" | "volume" | "centres">;
}

/** What keeps a text from being a link, or a design from being put into one. */
export class LinkError extends Error {}

// ---------------------------------------------------------------- to and from the fragment
/** The fragment, without `#`, of a design as it is looked at; a shipped design is in it by its name. `LinkError`. */
export async function fragment(shared: Shared): Promise<string> {
  const { crane, look, camera, ...rest } = shared;
  const plain = content(crane);
  const ready = SHIPPED.find(({ name }) => name === crane.name);
  const byName = ready && content(await ready.load()) === plain;
  const data = {
    design: byName ? crane.name : crane,
    sum: sum(plain),
    ...rest,
    look: look && [look.x, look.z, look.zoom].map(shortened),
    camera: camera && [...camera.eye, ...camera.target].map(shortened),
  };
  const bytes = new TextEncoder().encode(content(data));
  const result = START + toText(await through(bytes, new CompressionStream("deflate"), Number.POSITIVE_INFINITY));
  if (result.length > LONGEST)
    throw new LinkError(
      `${crane.name} is too large for a link (${result.length} characters, at most ${LONGEST}): send its design file.`,
    );
  return result;
}

/** What a fragment holds, or an address with one. `LinkError` says all that is wrong. */
export async function readFragment(text: string): Promise<Shared> {
  const given = text.trim().replace(/^[^#]*#/, "");
  if (!given.startsWith(START)) {
    const other = /^crane=(\d+)\./.exec(given);
    throw new LinkError(
      other ? `is of a later version (${other[1]})` : `holds no crane: what follows its # does not begin with ${START}`,
    );
  }
  if (given.length > LONGEST) throw new LinkError(`is longer than ${LONGEST} characters`);
  let data: unknown;
  try {
    const bytes = await through(toBytes(given.slice(START.length)), new DecompressionStream("deflate"), LARGEST);
    data = JSON.parse(new TextDecoder("utf-8", { fatal: true }).decode(bytes));
  } catch (error) {
    if (error instanceof LinkError) throw error;
    throw new LinkError("is cut off or damaged: copy all of it");
  }
  if (!isObject(data)) throw new LinkError("holds no crane");
  const crane = await craneOf(data);
  const problems: string[] = [];
  const shared = { crane, ...looked(data, crane, problems) };
  if (problems.length) throw new LinkError(problems.join("; "));
  return shared;
}

async function craneOf({ design, sum: wanted }: Record<string, unknown>): Promise<Crane> {
  if (typeof design !== "string") {
    try {
      return fromData(design);
    } catch (error) {
      if (error instanceof DesignFileError) throw new LinkError(`holds a crane that cannot be read: ${error.message}`);
      throw error;
    }
  }
  const ready = SHIPPED.find(({ name }) => name === design);
  if (!ready) throw new LinkError(`names a design that does not come with this version: ${design.slice(0, 60)}`);
  const crane = await ready.load();
  if (sum(content(crane)) !== wanted)
    throw new LinkError(`is of another version of ${design} than the one that comes with this version`);
  return crane;
}

function looked(data: Record<string, unknown>, crane: Crane, problems: string[]): Omit<Shared, "crane"> {
  const { posture, mode, selection, show, results, look, camera, tools } = data;
  const need = (good: boolean, what: string, allowed: string) => good || problems.push(`${what} must be ${allowed}`);
  const numbers = (value: unknown, count: number) =>
    Array.isArray(value) && value.length === count && value.every((x) => Number.isFinite(x) && Math.abs(x) < FAR);
  const names = modes(crane).map(({ name }) => name);
  need(isObject(posture) && Object.values(posture).every(Number.isFinite), "posture", "numbers by joint");
  need(names.includes(mode as string), "mode", `one of ${names.join(", ")}`);
  need(selects(selection, crane), "selection", "something that the crane has");
  need(["section", "both", "solid"].includes(show as string), "show", "section, both or solid");
  need(["chart", "optimise"].includes(results as string), "results", "chart or optimise");
  const seen = look as readonly [number, number, number];
  need(!look || (numbers(look, 3) && seen[2] >= ZOOMS[0] && seen[2] <= ZOOMS[1]), "look", "x, z [m] and zoom");
  need(!camera || numbers(camera, 6), "camera", "six numbers [m]");
  const { cut, explode, volume, centres } = isObject(tools) ? tools : {};
  const share = (value: unknown, least: number) => typeof value === "number" && value >= least && value <= 1;
  need(
    (cut === null || cut === undefined || share(cut, -1)) &&
      share(explode, 0) &&
      typeof volume === "boolean" &&
      typeof centres === "boolean",
    "tools",
    "cut -1 to 1, explode 0 to 1, volume, centres",
  );
  return {
    posture: posture as Posture,
    mode: mode as string,
    selection: selection as Selection,
    show: show as Show,
    results: results as Results,
    look: look ? { x: seen[0], z: seen[1], zoom: seen[2] } : null,
    camera: camera
      ? { eye: (camera as number[]).slice(0, 3) as never as Vec, target: (camera as number[]).slice(3) as never as Vec }
      : null,
    tools: {
      cut: (cut as number) ?? null,
      explode: explode as number,
      volume: volume as boolean,
      centres: centres as boolean,
    },
  };
}

function selects(selection: unknown, { links, cylinders }: Crane): boolean {
  if (!isObject(selection)) return false;
  const { kind, index, part } = selection;
  const among = (list: readonly unknown[], i: unknown) => Number.isInteger(i) && (i as number) in list;
  if (kind === "cylinder") return among(cylinders, index);
  if (kind !== "link") return ["crane", "hoist", "rating"].includes(kind as string);
  return among(links, index) && (part === undefined || among(links[index as number].parts ?? [], part));
}

function isObject(value: unknown): value is Record<string, unknown> {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}

/** JSON without what is absent. */
function content(value: unknown): string {
  return JSON.stringify(value, (_, item) => item ?? undefined);
}

function shortened(value: number): number {
  return Number(value.toPrecision(7));
}

/** Tells one design from another version of it (FNV-1a, 32 bits). */
function sum(text: string): number {
  let hash = 0x811c9dc5;
  for (const byte of new TextEncoder().encode(text)) hash = Math.imul(hash ^ byte, 0x01000193) >>> 0;
  return hash;
}

function toText(bytes: Uint8Array): string {
  const binary = Array.from(bytes, (byte) => String.fromCharCode(byte)).join("");
  return btoa(binary).replaceAll("+", "-").replaceAll("/", "_").replace(/=+$/, "");
}

function toBytes(text: string): Uint8Array<ArrayBuffer> {
  return Uint8Array.from(atob(text.replaceAll("-", "+").replaceAll("_", "/")), (char) => char.charCodeAt(0));
}

/** What comes out of a stream, at most `most` bytes: a short text may inflate to any size. */
async function through(
  bytes: Uint8Array<ArrayBuffer>,
  { readable, writable }: CompressionStream | DecompressionStream,
  most: number,
): Promise<Uint8Array> {
  const writer = writable.getWriter();
  const reader = readable.getReader();
  // What goes wrong in writing is told in reading, too.
  void writer.write(bytes).catch(() => undefined);
  void writer.close().catch(() => undefined);
  const chunks: Uint8Array[] = [];
  let length = 0;
  for (let next = await reader.read(); !next.done; next = await reader.read()) {
    chunks.push(next.value);
    length += next.value.length;
    if (length > most) {
      await reader.cancel();
      throw new LinkError(`holds more than ${most / 2 ** 20} MiB`);
    }
  }
  const all = new Uint8Array(length);
  let at = 0;
  for (const chunk of chunks) {
    all.set(chunk, at);
    at += chunk.length;
  }
  return all;
}

// ---------------------------------------------------------------- the page's own
/** The address that shows this design as it is seen now. It has no token: that opens the server, not the design. */
export async function addressOf({ designer, view }: Bench): Promise<string> {
  const { crane, posture, mode, selection } = designer.store.getState();
  const { show, results, look, camera, tools } = view.store.getState();
  const { cut, explode, volume, centres } = tools;
  const shown = { crane, posture, mode, selection, show, results, look, camera };
  const part = await fragment({ ...shown, tools: { cut, explode, volume, centres } });
  return `${location.origin}${location.pathname}#${part}`;
}

/** Hands the address over; where the browser does not let it, shows it to be copied by hand. */
export async function copyLink(bench: Bench): Promise<void> {
  const { designer, view } = bench;
  try {
    const address = await addressOf(bench);
    try {
      await navigator.clipboard.writeText(address);
    } catch {
      return view.open("link");
    }
    designer.tell(
      `Copied a link of ${address.length} characters. It holds the design as you see it, and opens where \`seacrane designer\` runs.`,
    );
  } catch (error) {
    designer.tell((error as Error).message, "wrong");
  }
}

/**
 * Shows what a link holds. The work on the bench is kept as a version first; undo brings it back, too. Throws, in words,
 * where it is not opened, and then nothing has changed.
 */
export async function openLink({ designer, view }: Bench, text: string): Promise<void> {
  const { crane, posture, mode, selection, tools, ...seen } = await readFragment(text).catch((error) => {
    throw error instanceof LinkError ? new Error(`The link is not opened. It ${error.message}.`) : error;
  });
  const now = designer.store.getState().crane;
  const same = content(now) === content(crane);
  const kept = same ? null : await keep(now);
  designer.apply(`open the link to ${crane.name}`, same ? now : crane, posture);
  designer.setMode(mode);
  designer.select(selection);
  view.set({ ...seen, dialog: null });
  view.tool(tools);
  designer.tell(
    `Opened the link to ${crane.name}.${kept ? ` What you had is kept as the version \u201c${kept}\u201d.` : ""}`,
  );
}

/** Keeps a crane as a version, under the name that is given back; null if it is to be had anyway. */
async function keep(crane: Crane): Promise<string | null> {
  const plain = content(crane);
  const ready = SHIPPED.find(({ name }) => name === crane.name);
  if (ready && content(await ready.load()) === plain) return null;
  const known = versions();
  if (known.some((version) => content(version.crane) === plain)) return null;
  const name = `${crane.name} before a link`;
  try {
    keepVersions([{ name, at: Date.now(), crane }, ...known]);
  } catch {
    throw new Error(
      `The link is not opened. This browser keeps no more versions, and ${crane.name} must not be lost: save it to a file.`,
    );
  }
  return name;
}
