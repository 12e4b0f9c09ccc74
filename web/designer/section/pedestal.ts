import { endOf } from "../../core/design/length";
import type { Crane } from "../../core/design/types";

/** What a crane is drawn to stand on, of a size that suits it: radii and depth below the foot [m]. */
export function pedestal(crane: Crane) {
  const top = 0.045 * crane.links.reduce((sum, _, i) => sum + Math.hypot(...endOf(crane, i)), 0) + 0.3;
  return { top, bottom: 1.1 * top, depth: Math.min(Math.max(crane.pedestal[2], 1), 4 * top) };
}
