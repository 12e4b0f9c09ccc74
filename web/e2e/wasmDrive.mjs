// What is asked of an exported drive, in Node and in Chromium alike: a run of which every value is reported, and claims
// that throw where they do not hold. `plan` comes from tests/e2e/test_e2e_wasm.py.

function claim(holds, what) {
  if (!holds) throw new Error(`it does not hold that ${what}`);
}

const same = (a, b) => a.length === b.length && a.every((value, i) => Object.is(value, b[i]));

/** What an action is refused with. */
function refusal(action) {
  try {
    action();
  } catch (error) {
    return error.message;
  }
  throw new Error(`it does not hold that this is refused: ${action}`);
}

/** The drive with a load on its rod, which is integrated here; the chosen variables after each step. */
function lift(drive, { spool, step, mass, weight, position, names }) {
  let [x, v] = [position, 0];
  return spool.map((opening, i) => {
    v += (step * (drive.get("rod_force") - weight)) / mass;
    x += step * v;
    drive.set({ spool: opening, rod_velocity: v, rod_position: x });
    drive.step(step, i * step);
    return [...drive.get(names)];
  });
}

export async function run(WasmModel, source, plan) {
  const model = await WasmModel.load(source);
  const drive = model.instantiate();
  const refusals = [refusal(() => drive.step(plan.step))];
  drive.initialize();
  refusals.push(
    refusal(() => drive.step(plan.step, 0.005)),
    refusal(() => drive.step(0)),
    refusal(() => drive.restore(new Uint8Array(drive.save().length))),
    refusal(() => drive.restore(new Uint8Array(7))),
  );
  const trajectory = lift(drive, plan);

  const goOn = (instance) => {
    for (let i = 0; i < 50; i += 1) instance.step(0.01);
    return instance.get(plan.names);
  };
  const saved = drive.save();
  const first = goOn(drive);
  drive.restore(saved);
  claim(same(goOn(drive), first), "a restored state goes on bit for bit as it did");
  const other = model.instantiate("other");
  other.initialize();
  const untouched = drive.get(plan.names);
  goOn(other);
  claim(same(drive.get(plan.names), untouched), "a step of one instance leaves another as it is");
  other.restore(saved);
  claim(same(goOn(other), first), "a state can be restored in another instance");
  other.reset();
  other.initialize();
  const fresh = model.instantiate("fresh");
  fresh.initialize();
  claim(same(goOn(other), goOn(fresh)), "a reset instance is as a new one");

  const refused = (action, message) => claim(refusal(action).startsWith(message), `the message begins with ${message}`);
  const before = drive.get(["spool", "cylinder.bore"]);
  refused(
    () => drive.set("spol", 1),
    'boom_drive has no variable "spol". Its inputs are spool, rod_velocity, rod_position;',
  );
  refused(() => other.set("spool", Number.NaN), "other: spool cannot be set to nan: it is not a finite number");
  refused(
    () => drive.set({ spool: 1, "cylinder.bore": -1 }),
    "boom_drive: cylinder.bore = -1 m is outside its range of ",
  );
  claim(same(drive.get(["spool", "cylinder.bore"]), before), "of several values all are set or none");

  fresh.free();
  fresh.free();
  refused(() => fresh.get("spool"), "fresh: the instance has been freed");
  const size = model.memory;
  for (let i = 0; i < 1000; i += 1) {
    const passing = model.instantiate();
    passing.save();
    passing.free();
  }
  claim(model.memory === size, "freed instances leave their memory to others");
  const many = Array.from({ length: 100 }, (_, i) => model.instantiate(`drive ${i}`));
  claim(model.memory > size, "the memory grows when it must");
  many[99].restore(saved);
  claim(same(goOn(many[99]), first), "an instance runs the same in memory that has grown");
  return { trajectory, refusals };
}
