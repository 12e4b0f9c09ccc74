// What is wrong with a crane while it is being drawn, in words and at its place. The Python package checks everything
// (`seacrane design check`); these are the ones that dragging brings about, fast enough for every frame.
import { cylinderLengths, passesDeadPoint, planeProblems, retracted } from "./plane";
import { type Crane, FOOT } from "./types";

export interface Problem {
  /** Place in the design, such as `cylinders[jib_cylinder].stroke`. */
  readonly path: string;
  readonly message: string;
}

const metres = (value: number) => `${value.toFixed(3)} m`;

export function problems(crane: Crane): Problem[] {
  // each begins with the name of its link
  const found: Problem[] = planeProblems(crane).map((text) => {
    const link = crane.links.find(({ name }) => text.startsWith(`${name}: `));
    return link
      ? { path: `links[${link.name}].joint.axis`, message: text.slice(link.name.length + 2) }
      : { path: "links", message: text };
  });
  for (const { name, joint, mass } of crane.links) {
    const at = `links[${name}]`;
    if (joint.limits && !(joint.limits[0] < joint.limits[1]))
      found.push({
        path: `${at}.joint.limits`,
        message: "the lower limit must be below the upper: are they reversed?",
      });
    if (!(mass > 0)) found.push({ path: `${at}.mass`, message: "must be above 0 t" });
  }
  const movers = crane.cylinders.map(({ moves }) => moves);
  for (const joint of new Set(movers.filter((joint, i) => movers.indexOf(joint) < i)))
    found.push({ path: "cylinders", message: `${joint} is moved by two sets; cylinders side by side are one set` });
  for (const cylinder of crane.cylinders) {
    const at = `cylinders[${cylinder.name}]`;
    const say = (field: string, message: string) => found.push({ path: `${at}.${field}`, message });
    if (!(cylinder.bore > 0 && cylinder.stroke > 0 && cylinder.pressure > 0))
      say("bore", "bore, stroke and pressure must be above 0");
    if (!(cylinder.rod > 0 && cylinder.rod < cylinder.bore))
      say("rod", `must be thinner than the bore of ${(1e3 * cylinder.bore).toFixed(0)} mm`);
    const place = (link: string) => (link === FOOT ? -1 : crane.links.findIndex((other) => other.name === link));
    const [base, eye] = [place(cylinder.base.link), place(cylinder.eye.link)];
    const moved = crane.links.findIndex((link) => link.joint.name === cylinder.moves);
    if (moved < 0) {
      say("moves", `moves ${cylinder.moves}, a joint that the crane does not have`);
      continue;
    }
    if (moved <= Math.min(base, eye) || moved > Math.max(base, eye)) {
      say("moves", `the pins are not on both sides of ${cylinder.moves}`);
      continue;
    }
    if (Math.abs(base - eye) > 1) {
      const between = crane.links.slice(Math.min(base, eye) + 1, Math.max(base, eye) + 1);
      say("moves", `more than one joint lies between its pins: ${between.map(({ joint }) => joint.name).join(", ")}`);
      continue;
    }
    const limits = crane.links[moved].joint.limits;
    if (!limits) {
      say("moves", `cannot move ${cylinder.moves}: it is endless`);
      continue;
    }
    if (!(limits[0] < limits[1])) continue;
    const [shortest, longest] = cylinderLengths(crane, cylinder);
    if (shortest < 1e-6) {
      say("base", "its pins coincide within the joint's limits");
      continue;
    }
    if (passesDeadPoint(crane, cylinder))
      say(
        "moves",
        `passes a dead point within the limits of ${cylinder.moves}, where it has no lever: move its pins, or narrow the limits`,
      );
    const travel = `the pins are ${metres(shortest)} to ${metres(longest)} apart over the joint's limits`;
    if (longest - shortest > cylinder.stroke) {
      say("stroke", `${metres(cylinder.stroke)} is too short: ${travel}, which needs ${metres(longest - shortest)}`);
      continue;
    }
    const closed = retracted(crane, cylinder);
    if (closed < longest - cylinder.stroke - 1e-9 || closed > shortest + 1e-9)
      say("retracted", `${metres(closed)} does not let the joint reach its limits: ${travel}`);
    if (closed < cylinder.stroke + cylinder.bore)
      say(
        "retracted",
        `${metres(closed)} cannot be built: it needs stroke and bore, ${metres(cylinder.stroke + cylinder.bore)}`,
      );
  }
  return found;
}
