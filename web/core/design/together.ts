// What belongs together and stays so when one piece of a crane is changed: pins with the lugs, sheaves and drums that are
// built about them, and the weight of a link with the parts that it was taken from.
import { get, type Path, set } from "./edit";
import { endOf } from "./length";
import { ofLink } from "./mass";
import type { Point } from "./plane";
import type { Crane, Link } from "./types";

/** Closer than this two places are one [m]. */
const SAME = 1e-4;
const WEIGHED = 1e-9;

/** A place on a link where a pin is, or what is built about one. */
interface Spot {
  readonly path: Path;
  readonly link: string;
  readonly part: boolean;
  readonly x: number;
  readonly z: number;
}

/** The crane after a change, with what belonged to the piece that was changed brought after it. */
export function inStep(before: Crane, after: Crane): Crane {
  if (!after.links.some(({ parts }) => parts?.length)) return after;
  return weighedAgain(before, joined(before, after));
}

function joined(before: Crane, after: Crane): Crane {
  const were = spots(before);
  const are = new Map(spots(after).map((spot) => [spot.path.join(), spot]));
  if (were.length !== are.size) return after;
  const to = (spot: Spot): Spot | null => {
    const now = are.get(spot.path.join());
    return now && now.link === spot.link && distance(now, spot) > 0 ? now : null;
  };
  let crane = after;
  for (const from of were) {
    const now = to(from);
    if (!now) continue;
    const beside = were.filter(
      (spot) => spot.link === from.link && (spot.part || from.part) && distance(spot, from) < SAME && !to(spot),
    );
    for (const spot of beside) crane = movedTo(crane, spot, now);
  }
  return crane;
}

function distance(a: Spot, b: Spot): number {
  return Math.hypot(a.x - b.x, a.z - b.z);
}

function spots(crane: Crane): Spot[] {
  const { drum, sheaves } = crane.hoist;
  const pins = [
    ...crane.cylinders.flatMap(({ base, eye }, i) => [
      { ...base, path: ["cylinders", i, "base"] },
      { ...eye, path: ["cylinders", i, "eye"] },
    ]),
    { ...drum, path: ["hoist", "drum"] },
    ...sheaves.map((sheave, i) => ({ ...sheave, path: ["hoist", "sheaves", i] })),
  ];
  const parts = crane.links.flatMap((link, i) =>
    (link.parts ?? []).flatMap((part, k) =>
      part.kind === "lug" || part.kind === "sheave" || part.kind === "drum"
        ? [{ link: link.name, x: part.x, z: part.z, path: ["links", i, "parts", k] }]
        : [],
    ),
  );
  return [...pins.map((pin) => ({ ...pin, part: false })), ...parts.map((part) => ({ ...part, part: true }))];
}

function movedTo(crane: Crane, { path, link, x, z }: Spot, to: Spot): Crane {
  const there = { ...(get(crane, path) as object), x: to.x, z: to.z };
  if (!("root_x" in there && "root_z" in there)) return set(crane, path, there);
  // a lug stays across the link that it is welded to
  const [ex, ez] = endOf(
    crane,
    crane.links.findIndex(({ name }) => name === link),
  );
  const share = ((to.x - x) * ex + (to.z - z) * ez) / (ex ** 2 + ez ** 2 || 1);
  const root: Point = [Number(there.root_x) + share * ex, Number(there.root_z) + share * ez];
  return set(crane, path, { ...there, root_x: Number(root[0].toFixed(9)), root_z: Number(root[1].toFixed(9)) });
}

/** Whether mass, centre and inertia of a link are those of its parts. */
export function followsParts(link: Link): boolean {
  if (!link.parts?.length) return false;
  try {
    const { mass, centre, inertia } = ofLink(link);
    const close = (a: number, b: number, size: number) => Math.abs(a - b) <= WEIGHED * size;
    return (
      close(mass, link.mass, mass) &&
      centre.every((value, k) => close(value, link.com[k], 1)) &&
      link.inertia.every((value, k) => close(value, inertia[k], inertia[k]))
    );
  } catch {
    return false;
  }
}

/** A link that weighed what its parts weigh goes on doing so when they change. */
function weighedAgain(before: Crane, after: Crane): Crane {
  if (before.links.length !== after.links.length) return after;
  let changed = false;
  const links = after.links.map((link, i) => {
    const was = before.links[i];
    if (link.parts === was.parts || !link.parts?.length || !followsParts(was)) return link;
    try {
      const { mass, centre, inertia } = ofLink(link);
      // plates thicker than their part: what cannot be made weighs nothing, and the problem is said where it is
      if (!(mass > 0 && inertia.slice(0, 3).every((value) => value > 0))) return link;
      changed = true;
      return { ...link, mass, com: centre, inertia: [inertia[0], inertia[1], inertia[2]] as const };
    } catch {
      return link;
    }
  });
  return changed ? { ...after, links } : after;
}
