import { useRef } from "react";
import { within, withoutLink, withStroke } from "../../core/design/edit";
import { lengthened, lengthOf, SHORTEST } from "../../core/design/length";
import { ofPart } from "../../core/design/mass";
import { inStep } from "../../core/design/together";
import type { Crane } from "../../core/design/types";
import { fixed, TONNE } from "../../core/units";
import { useBench, useDesigner } from "../context";
import type { Selection } from "../store";
import { Form } from "./Form";
import { NumberField } from "./NumberField";
import { Parts } from "./Parts";

/** The crane as a tree, and the fields of what is selected in it. */
export function Inspector() {
  const { designer } = useBench();
  const crane = useDesigner((state) => state.crane);
  const selection = useDesigner((state) => state.selection);
  const problems = useDesigner((state) => state.problems);
  const node = (label: string, to: Selection, path: string, detail = "", depth = 0) => (
    <button
      type="button"
      key={`${to.kind} ${label}`}
      className="twig"
      style={{ paddingLeft: 8 + 16 * depth }}
      aria-current={same(selection, to)}
      data-testid={`select-${label}`}
      onClick={() => designer.select(to)}
    >
      <span>{label}</span>
      {path && problems.some((item) => item.path.startsWith(path)) && <b title="Something is wrong here">!</b>}
      <small>{detail}</small>
    </button>
  );
  return (
    <>
      <nav className="tree" aria-label="Parts of the design">
        {node(crane.name, { kind: "crane" }, "", `${crane.links.length} links`)}
        {crane.links.flatMap((link, index) => [
          node(
            link.name,
            { kind: "link", index },
            `links[${link.name}]`,
            `${link.joint.name}, ${fixed(link.mass / TONNE, 1)} t`,
            1,
          ),
          ...crane.cylinders.flatMap((cylinder, k) =>
            cylinder.moves === link.joint.name
              ? [
                  node(
                    cylinder.name,
                    { kind: "cylinder", index: k },
                    `cylinders[${cylinder.name}]`,
                    `${cylinder.count ?? 1} \u00d7 ${fixed(cylinder.bore * 1e3, 0)} mm`,
                    2,
                  ),
                ]
              : [],
          ),
        ])}
        {node(
          "hoist",
          { kind: "hoist" },
          "hoist",
          crane.hoist.falls && crane.hoist.falls > 1 ? `${crane.hoist.falls} falls` : "1 fall",
          1,
        )}
        {node("rating", { kind: "rating" }, "rating", "limits, sea states", 1)}
        <p className="tools">
          <button type="button" onClick={() => designer.addLink("revolute")} data-testid="add-link">
            + turning link
          </button>
          <button type="button" onClick={() => designer.addLink("prismatic")}>
            + sliding link
          </button>
        </p>
      </nav>
      <div className="details" data-testid="details" key={JSON.stringify({ ...selection, part: null })}>
        <Details selection={selection} />
      </div>
    </>
  );
}

function same(a: Selection, b: Selection): boolean {
  return a.kind === b.kind && ("index" in a ? a.index : 0) === ("index" in b ? b.index : 0);
}

function Details({ selection }: { selection: Selection }) {
  const { designer } = useBench();
  const crane = useDesigner((state) => state.crane);
  switch (selection.kind) {
    case "crane":
      return (
        <>
          <h2>{crane.name}</h2>
          <p className="tools">
            <button
              type="button"
              title="best loads in harbour at round radii"
              data-testid="rate"
              onClick={() => designer.rate()}
            >
              Rated loads from the chart
            </button>
          </p>
          <Form shape="crane" path={[]} without={["format", "links", "cylinders", "hoist", "rating"]} />
        </>
      );
    case "link": {
      const link = crane.links[selection.index];
      const parts = (link.parts ?? []).reduce((sum, part) => sum + ofPart(part).mass, 0);
      const removed = withoutLink(crane, selection.index);
      return (
        <>
          <h2>{link.name}</h2>
          <Coordinate index={selection.index} />
          <Length index={selection.index} />
          <p className="tools">
            <button type="button" onClick={() => designer.addCylinder(selection.index)}>
              + cylinder
            </button>
            {removed && (
              <button type="button" data-testid="remove-link" onClick={() => designer.apply("remove link", removed)}>
                Remove link
              </button>
            )}
          </p>
          <Form shape="link" path={["links", selection.index]} without={["parts"]} />
          <Parts index={selection.index} part={selection.part} mass={parts} />
        </>
      );
    }
    case "cylinder": {
      const cylinder = crane.cylinders[selection.index];
      return (
        <>
          <h2>{cylinder.name}</h2>
          <p className="tools">
            <button
              type="button"
              onClick={() => designer.edit("fit stroke", ["cylinders", selection.index], withStroke(crane, cylinder))}
            >
              Fit stroke to limits
            </button>
            <button
              type="button"
              onClick={() => designer.edit("remove cylinder", ["cylinders", selection.index], undefined)}
            >
              Remove
            </button>
          </p>
          <Form shape="cylinder" path={["cylinders", selection.index]} />
        </>
      );
    }
    case "hoist":
      return (
        <>
          <h2>Hoist</h2>
          <Form shape="hoist" path={["hoist"]} />
        </>
      );
    case "rating":
      return (
        <>
          <h2>Rating</h2>
          {crane.rating ? (
            <Form shape="rating" path={["rating"]} />
          ) : (
            <p className="absent">
              None: usual sea states, no heel, no limits but those of cylinders, rope and winch{" "}
              <button type="button" className="plain" onClick={() => designer.edit("add rating", ["rating"], {})}>
                Set
              </button>
            </p>
          )}
        </>
      );
  }
}

/** How long a link is, where it has a length to change. */
function Length({ index }: { index: number }) {
  const { designer } = useBench();
  const crane = useDesigner((state) => state.crane);
  const length = lengthOf(crane, index);
  const begun = useRef(crane);
  if (length < SHORTEST) return null;
  const to = (from: Crane, next: number) => inStep(from, lengthened(from, index, next));
  return (
    <NumberField
      label="Length"
      hint="of the same section: mass and what is beyond the middle follow; to the next joint, or to the tip"
      value={length}
      unit="m"
      check={(next) => (next >= SHORTEST ? null : "must be at least 0.01 m")}
      onChange={(next) => next !== undefined && designer.apply("length", to(crane, next))}
      onDrag={(next) => {
        const now = designer.store.getState();
        if (!now.dragging) {
          begun.current = now.crane;
          designer.begin();
        }
        designer.change({ crane: to(begun.current, next), posture: now.posture });
      }}
      onDragged={(cancelled) => (cancelled ? designer.cancel() : designer.end("length"))}
    />
  );
}

/** Where the joint of a link stands now. */
function Coordinate({ index }: { index: number }) {
  const { designer } = useBench();
  const { joint } = useDesigner((state) => state.crane.links[index]);
  const value = useDesigner((state) => state.posture[joint.name] ?? 0);
  const to = (next: number) => {
    const { crane, posture } = designer.store.getState();
    return { crane, posture: { ...posture, [joint.name]: within(joint, next) } };
  };
  return (
    <NumberField
      label={`${joint.name} now`}
      hint="the posture shown; it is no part of the design"
      value={value}
      unit={joint.kind === "revolute" ? "deg" : "m"}
      onChange={(next) => next !== undefined && designer.pose({ [joint.name]: within(joint, next) })}
      onDrag={(next) => {
        if (!designer.store.getState().dragging) designer.begin();
        designer.change(to(next));
      }}
      onDragged={(cancelled) => (cancelled ? designer.cancel() : designer.end("posture"))}
    />
  );
}
