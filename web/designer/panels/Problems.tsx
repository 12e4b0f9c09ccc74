import { useBench, useDesigner } from "../context";

/** Everything that is wrong, in words; a click goes to its fields. */
export function Problems() {
  const { designer } = useBench();
  const problems = useDesigner((state) => state.problems);
  const crane = useDesigner((state) => state.crane);
  if (problems.length === 0) return null;
  const go = (path: string) => {
    const name = /\[(.*?)\]/.exec(path)?.[1];
    const link = crane.links.findIndex((item) => item.name === name);
    const cylinder = crane.cylinders.findIndex((item) => item.name === name);
    if (path.startsWith("links") && link >= 0) designer.select({ kind: "link", index: link });
    else if (path.startsWith("cylinders") && cylinder >= 0) designer.select({ kind: "cylinder", index: cylinder });
  };
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
