// The axes of a crane as its operator knows them: what each is called and what its two senses do.
import type { Joint, ModelDescription } from "../rpc/messages";

export const HOIST = "hoist";

export interface CraneAxis {
  /** As the server calls it. */
  readonly name: string;
  /** The joint that it moves; none for the hoist. */
  readonly joint: Joint | null;
  readonly label: string;
  /** What it does for a positive and for a negative command. */
  readonly senses: readonly [string, string];
}

/** The axes of a model: one for each joint in the order of the chain, then the hoist. */
export function craneAxes({ axes, crane }: Pick<ModelDescription, "axes" | "crane">): CraneAxis[] {
  return axes.map((name, i) => {
    const joint = name === HOIST ? null : (crane.links[i]?.joint ?? null);
    const said = name.replaceAll("_", " ");
    const label = name === "boom" ? "Main boom" : said[0].toUpperCase() + said.slice(1);
    if (!joint) return { name, joint, label, senses: ["hoist", "lower"] };
    if (name === "slew") return { name, joint, label, senses: ["slew left", "slew right"] };
    return {
      name,
      joint,
      label,
      senses: luffs(joint) ? [`${said} up`, `${said} down`] : [`${said} out`, `${said} in`],
    };
  });
}

/** Whether a joint raises what it carries rather than stretches it out. */
function luffs(joint: Joint): boolean {
  return joint.kind === "revolute" && joint.name === "luff";
}

/** What it means that a joint is held back at its upper or lower end. */
export function endText(axis: CraneAxis, side: number): string {
  const what = axis.name === "boom" ? "Boom" : axis.label;
  const ends = axis.joint && luffs(axis.joint) ? ["upper", "lower"] : ["outer", "inner"];
  return `${what} at its ${ends[side > 0 ? 0 : 1]} end`;
}
