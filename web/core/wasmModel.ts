// A model exported by `seacrane fmu export --wasm`, run in the browser or in Node: the C of the FMU, solver included.
//
//   const model = await WasmModel.load(await fetch("boom_drive.wasm"));
//   const drive = model.instantiate();
//   drive.set("spool", 0.5);
//   drive.initialize();
//   for (let i = 0; i < 100; i += 1) drive.step(0.01);
//   const { shown, factor } = model.variable("cylinder.pressure_a");
//   console.log(drive.get("cylinder.pressure_a") * factor, shown);
//   drive.free();
import type { VariableInfo } from "../rpc/messages";

export type WasmKind =
  | "input"
  | "output"
  | "parameter"
  | "setting"
  | "state"
  | "derivative"
  | "algebraic"
  | "observable";

/** A variable of a model. All numbers are SI; times `factor` they are in the unit `shown`. */
export interface WasmVariable extends VariableInfo {
  kind: WasmKind;
  /** Value reference, as in the FMU of the same model. */
  reference: number;
  /** Absent where it is computed. */
  start?: number;
  minimum?: number;
  maximum?: number;
}

interface Description {
  format: string;
  name: string;
  about: string;
  guid: string;
  variables: readonly WasmVariable[];
}

/** What the core says when it cannot do as it was told, with the name of the instance before it. */
export class WasmModelError extends Error {
  override name = "WasmModelError";
}

type Pointer = number;

interface Exports {
  memory: WebAssembly.Memory;
  _initialize(): void;
  malloc(size: number): Pointer;
  free(at: Pointer): void;
  fmi2Instantiate(name: Pointer, type: 1, guid: Pointer, resources: 0, functions: 0, visible: 0, logging: 0): Pointer;
  fmi2FreeInstance(instance: Pointer): void;
  fmi2SetupExperiment(instance: Pointer, toleranced: 0, tolerance: 0, start: number, stops: 0, stop: 0): number;
  fmi2EnterInitializationMode(instance: Pointer): number;
  fmi2ExitInitializationMode(instance: Pointer): number;
  fmi2Reset(instance: Pointer): number;
  fmi2SetReal(instance: Pointer, references: Pointer, count: number, values: Pointer): number;
  fmi2GetReal(instance: Pointer, references: Pointer, count: number, values: Pointer): number;
  fmi2DoStep(instance: Pointer, from: number, size: number, final: 0): number;
  seacrane_message(instance: Pointer): Pointer;
  seacrane_time(instance: Pointer): number;
  seacrane_state_size(): number;
  seacrane_save(instance: Pointer, bytes: Pointer): void;
  seacrane_restore(instance: Pointer, bytes: Pointer): number;
}

const FORMAT = "seacrane-wasm/1";
const SECTION = "seacrane";
const OK = 0;

async function descriptionOf(module: WebAssembly.Module): Promise<Description> {
  const [section] = WebAssembly.Module.customSections(module, SECTION);
  if (!section) throw new WasmModelError("the WebAssembly module is no model exported by seacrane");
  const content = new Blob([section]).stream().pipeThrough(new DecompressionStream("deflate"));
  const description: Description = await new Response(content).json();
  if (description.format !== FORMAT)
    throw new WasmModelError(`the model has format ${description.format}; this program reads ${FORMAT}`);
  return description;
}

/** The functions of a module, and its memory as they want it. */
class Core {
  /** Room for the value references and values of one call. */
  private readonly references: Pointer;
  private readonly values: Pointer;

  constructor(
    readonly c: Exports,
    private readonly most: number,
  ) {
    c._initialize();
    this.values = this.allocate(8 * most);
    this.references = this.allocate(4 * most);
  }

  /** The bytes of the memory; not to be kept, as it may grow and move at any call. */
  get bytes(): Uint8Array {
    return new Uint8Array(this.c.memory.buffer);
  }

  allocate(size: number): Pointer {
    const at = this.c.malloc(Math.max(1, size));
    if (!at) throw new WasmModelError("not enough memory");
    return at;
  }

  /** Puts bytes where the core can read them, while `use` runs. */
  lend<T>(content: Uint8Array, use: (at: Pointer) => T): T {
    const at = this.allocate(content.length);
    try {
      this.bytes.set(content, at);
      return use(at);
    } finally {
      this.c.free(at);
    }
  }

  /** The arguments of a call about these variables, with their values if they are to be set. */
  about(variables: readonly WasmVariable[], values?: readonly number[]): [Pointer, number, Pointer] {
    if (variables.length > this.most) throw new WasmModelError(`${variables.length} variables are more than there are`);
    const view = new DataView(this.c.memory.buffer);
    for (let i = 0; i < variables.length; i += 1) {
      view.setUint32(this.references + 4 * i, variables[i].reference, true);
      if (values) view.setFloat64(this.values + 8 * i, values[i], true);
    }
    return [this.references, variables.length, this.values];
  }

  text(at: Pointer): string {
    const bytes = this.bytes.subarray(at);
    return new TextDecoder().decode(bytes.subarray(0, bytes.indexOf(0)));
  }
}

const zeroEnded = (text: string) => new TextEncoder().encode(`${text}\0`);

/** A loaded model. Its instances share one memory, which grows as they need and serves again what they free. */
export class WasmModel {
  readonly name: string;
  readonly about: string;
  readonly guid: string;
  readonly variables: readonly WasmVariable[];
  private readonly byName: ReadonlyMap<string, WasmVariable>;

  private constructor(
    description: Description,
    private readonly core: Core,
  ) {
    ({ name: this.name, about: this.about, guid: this.guid, variables: this.variables } = description);
    this.byName = new Map(this.variables.map((variable) => [variable.name, variable]));
  }

  /** Loads a module from its bytes or from the answer of `fetch`. */
  static async load(source: BufferSource | Response): Promise<WasmModel> {
    if (source instanceof Response && !source.ok)
      throw new WasmModelError(`${source.url} cannot be loaded: ${source.status} ${source.statusText}`);
    const bytes = source instanceof Response ? await source.arrayBuffer() : source;
    const module = await WebAssembly.compile(bytes).catch((error) => {
      throw new WasmModelError(`what was loaded is no WebAssembly module: ${error.message}`);
    });
    const description = await descriptionOf(module);
    const { exports } = await WebAssembly.instantiate(module);
    return new WasmModel(description, new Core(exports as unknown as Exports, description.variables.length));
  }

  /** Size of the memory of its instances [byte]. */
  get memory(): number {
    return this.core.bytes.length;
  }

  /** A new instance, named for its messages; it holds the start values until it is initialized. */
  instantiate(name = this.name): WasmInstance {
    const { c } = this.core;
    const handle = this.core.lend(zeroEnded(name), (label) =>
      this.core.lend(zeroEnded(this.guid), (guid) => c.fmi2Instantiate(label, 1, guid, 0, 0, 0, 0)),
    );
    if (!handle) throw new WasmModelError(`${name} cannot be made: it needs a name, and memory`);
    return new WasmInstance(this, this.core, name, handle);
  }

  /** The variable of this name; an error if there is none. */
  variable(name: string): WasmVariable {
    const found = this.byName.get(name);
    if (found) return found;
    const inputs = this.variables.filter(({ kind }) => kind === "input").map((input) => input.name);
    throw new WasmModelError(
      `${this.name} has no variable ${JSON.stringify(name)}. Its inputs are ${inputs.join(", ") || "none"}; ` +
        "all others are in `variables`",
    );
  }
}

/**
 * A running copy of a model. A call that the core refuses throws a `WasmModelError` and changes nothing, but for a step
 * that fails: it leaves the instance at the last good point, which is `time`.
 */
export class WasmInstance {
  /** Made by `WasmModel.instantiate`. */
  constructor(
    readonly model: WasmModel,
    private readonly core: Core,
    readonly name: string,
    private handle: Pointer,
  ) {}

  /** Simulated time [s]. */
  get time(): number {
    return this.core.c.seacrane_time(this.live());
  }

  /** Solves the algebraic equations at the start time [s]; from now on the instance can be stepped. */
  initialize(time = 0): void {
    this.check(this.core.c.fmi2SetupExperiment(this.live(), 0, 0, time, 0, 0));
    this.check(this.core.c.fmi2EnterInitializationMode(this.handle));
    this.check(this.core.c.fmi2ExitInitializationMode(this.handle));
  }

  /** Sets inputs and parameters at any time, states and starts of algebraic unknowns before `initialize`: all or none. */
  set(name: string, value: number): void;
  set(values: Readonly<Record<string, number>>): void;
  set(first: string | Readonly<Record<string, number>>, value?: number): void {
    const values = typeof first === "string" ? { [first]: value as number } : first;
    const variables = Object.keys(values).map((name) => this.model.variable(name));
    this.check(this.core.c.fmi2SetReal(this.live(), ...this.core.about(variables, Object.values(values))));
  }

  /** The present value of one variable, or those of several. */
  get(name: string): number;
  get(names: readonly string[]): Float64Array;
  get(names: string | readonly string[]): number | Float64Array {
    const several = typeof names === "string" ? [names] : names;
    const passed = this.core.about(several.map((name) => this.model.variable(name)));
    this.check(this.core.c.fmi2GetReal(this.live(), ...passed));
    const values = new Float64Array(this.core.c.memory.buffer, passed[2], several.length);
    return typeof names === "string" ? values[0] : values.slice();
  }

  /** Advances by `size` [s] with the inputs held; `from`, the present time, may be given free of rounding. */
  step(size: number, from = this.time): void {
    this.check(this.core.c.fmi2DoStep(this.live(), from, size, 0));
  }

  /** The complete state; `restore` brings it back bit for bit, also in another instance or at another time. */
  save(): Uint8Array {
    const handle = this.live();
    const saved = new Uint8Array(this.core.c.seacrane_state_size());
    return this.core.lend(saved, (at) => {
      this.core.c.seacrane_save(handle, at);
      return this.core.bytes.slice(at, at + saved.length);
    });
  }

  /** Returns to a saved state of this model; any other is refused. */
  restore(saved: Uint8Array): void {
    const handle = this.live();
    const size = this.core.c.seacrane_state_size();
    if (saved.length !== size)
      throw new WasmModelError(`${this.name}: ${saved.length} bytes are not a state of this model, which has ${size}`);
    this.check(this.core.lend(saved, (at) => this.core.c.seacrane_restore(handle, at)));
  }

  /** Back to the start values, as just made. */
  reset(): void {
    this.check(this.core.c.fmi2Reset(this.live()));
  }

  /** Gives its memory back; it cannot be used afterwards. */
  free(): void {
    if (this.handle) this.core.c.fmi2FreeInstance(this.handle);
    this.handle = 0;
  }

  private live(): Pointer {
    if (!this.handle) throw new WasmModelError(`${this.name}: the instance has been freed`);
    return this.handle;
  }

  private check(status: number): void {
    if (status !== OK)
      throw new WasmModelError(`${this.name}: ${this.core.text(this.core.c.seacrane_message(this.handle))}`);
  }
}
