import { readFileSync } from "node:fs";
import { act } from "react";
import { createRoot, type Root } from "react-dom/client";
import { afterEach, beforeEach, describe, expect, it } from "vitest";
import { read } from "../../core/design/file";
import { furthestLoad } from "../../core/design/rated";
import { type Bench, BenchContext } from "../context";
import { createDesigner } from "../store";
import { NewCrane } from "./New";

const offshore = read(readFileSync("../src/seacrane/design/cranes/offshore-100t.json", "utf8"));
const designer = createDesigner(offshore);
let root: Root;
let closed: boolean;

beforeEach(() => {
  Object.assign(globalThis, { IS_REACT_ACT_ENVIRONMENT: true });
  document.body.innerHTML = "<div></div>";
  root = createRoot(document.body.firstElementChild!);
  closed = false;
  act(() =>
    root.render(
      <BenchContext value={{ designer } as Bench}>
        <NewCrane
          onClose={() => {
            closed = true;
          }}
        />
      </BenchContext>,
    ),
  );
});
afterEach(() => act(() => root.unmount()));

const field = (label: string) =>
  document.getElementById(
    [...document.querySelectorAll("label")].find(({ textContent }) => textContent === label)!.htmlFor,
  ) as HTMLInputElement;

/** Types into a field and leaves it, as by the tabulator. */
function type(label: string, text: string) {
  const input = field(label);
  const put = Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, "value")!.set!;
  act(() => {
    put.call(input, text);
    input.dispatchEvent(new Event("input", { bubbles: true }));
  });
  act(() => void input.dispatchEvent(new FocusEvent("focusout", { bubbles: true })));
}

const submit = () =>
  act(async () => {
    document.querySelector("form")!.dispatchEvent(new Event("submit", { bubbles: true, cancelable: true }));
    // the ready design is read from its file
    for (let i = 0; i < 2000 && !closed; i += 1) await new Promise((done) => setTimeout(done, 10));
  });

describe("the form of a new crane", () => {
  it("makes nothing while a field is wrong, and goes to that field", async () => {
    type("Largest radius", "500 m");
    const before = designer.store.getState().crane;
    await act(async () => {
      document.querySelector("form")!.dispatchEvent(new Event("submit", { bubbles: true, cancelable: true }));
    });
    expect(document.body.textContent).toContain("must be 2 to 150 m");
    expect(document.activeElement).toBe(field("Largest radius"));
    expect(designer.store.getState().crane).toBe(before);
    expect(closed).toBe(false);
  });

  it("makes one crane, however often it is told to", async () => {
    const steps = designer.store.getState().past.length;
    for (let i = 0; i < 2; i += 1)
      document.querySelector("form")!.dispatchEvent(new Event("submit", { bubbles: true, cancelable: true }));
    await submit();
    await act(async () => new Promise((done) => setTimeout(done, 200)));
    expect(designer.store.getState().past.length).toBe(steps + 1);
  }, 30_000);

  it("makes the crane of the radius and the load that are typed", async () => {
    type("Largest radius", "80 ft");
    type("Load at this radius", "12");
    await submit();
    expect(closed).toBe(true);
    const { radius, mass } = furthestLoad(designer.store.getState().crane)!;
    expect(radius).toBeCloseTo(24.4, 0);
    expect(mass).toBeGreaterThan(0.97 * 12e3);
    expect(mass).toBeLessThan(1.2 * 12e3);
  }, 30_000);
});
