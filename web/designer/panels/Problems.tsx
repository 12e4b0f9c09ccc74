import type { Crane } from "../../core/design/types";
import { useBench, useDesigner } from "../context";
import type { Selection } from "../store";

/** What has the fields of a place in the design. */
export function placeOf(crane: Crane, path: string): Selection {
  const [group, name] = /^(\w+)(?:\[(.*?)\])?/.exec(path)?.slice(1) ?? [];
  const index = (items: readonly { readonly name: string }[], wanted: string | undefined) =>
    items.findIndex((item) => item.name === wanted);
  const [link, cylinder] = [index(crane.links, name), index(crane.cylinders, name)];
  if (group === "links" && link >= 0) {
    const part = index(crane.links[link].parts ?? [], /\.parts\[(.*?)\]/.exec(path)?.[1]);
    return { kind: "link", index: link, part: part >= 0 ? part : undefined };
  }
  if (group === "cylinders" && cylinder >= 0) return { kind: "cylinder", index: cylinder };
  return group === "hoist" || group === "rating" ? { kind: group } : { kind: "crane" };
}

/** Everything that is wrong, in words; a click goes to its fields. */
export function Problems() {
  const { designer } = useBench();
  const problems = useDesigner((state) => state.problems);
  const crane = useDesigner((state) => state.crane);
  if (problems.length === 0) return null;
  const go = (path: string) => designer.select(placeOf(crane, path));
  return (
    <section className="problems" aria-label="Problems" aria-live="polite" data-testid="problems">
      <h2>{problems.length === 1 ? "This cannot be built" : `${problems.length} things cannot be built`}</h2>
      <ul>
        {problems.map(({ path, message }) => (
          <li key={`${path} ${message}`}>
            <button type="button" onClick={() => go(path)}>
              <b>{path}</b> {message}
            </button>
          </li>
        ))}
      </ul>
    </section>
  );
}
