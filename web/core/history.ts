// What was plotted: a sliding window of frames, one column per variable, all on one time base.

export interface Series {
  readonly time: Float64Array;
  readonly columns: ReadonlyMap<string, Float64Array>;
}

export class History {
  private time: Float64Array;
  private columns = new Map<string, Float64Array>();
  private start = 0;
  private count = 0;

  /** Frames older than `span` seconds of simulated time before the newest are dropped. */
  constructor(
    readonly span: number,
    capacity = 4096,
  ) {
    this.time = new Float64Array(capacity);
  }

  get length(): number {
    return this.count;
  }

  get latest(): number {
    return this.count ? this.time[this.start + this.count - 1] : Number.NaN;
  }

  /** Which variables are kept from now on; one already kept keeps its past, a new one has gaps before now. */
  keep(names: readonly string[]): void {
    const kept = new Map<string, Float64Array>();
    for (const name of names) {
      kept.set(name, this.columns.get(name) ?? new Float64Array(this.time.length).fill(Number.NaN));
    }
    this.columns = kept;
  }

  /** Adds a frame. One that is not later than the newest means the simulation started again: the past is dropped. */
  push(time: number, value: (name: string) => number | null | undefined): void {
    if (this.count && time <= this.latest) {
      if (time === this.latest) return;
      this.clear();
    }
    if (this.start + this.count === this.time.length) this.makeRoom();
    const at = this.start + this.count;
    this.time[at] = time;
    for (const [name, column] of this.columns) column[at] = value(name) ?? Number.NaN;
    this.count += 1;
    while (this.time[this.start] < time - this.span) {
      this.start += 1;
      this.count -= 1;
    }
  }

  clear(): void {
    this.start = 0;
    this.count = 0;
  }

  /** Views (no copies) of the frames with from <= time <= to. */
  slice(from = Number.NEGATIVE_INFINITY, to = Number.POSITIVE_INFINITY): Series {
    let low = this.start;
    let high = this.start + this.count;
    while (low < high && this.time[low] < from) low += 1;
    while (high > low && this.time[high - 1] > to) high -= 1;
    return {
      time: this.time.subarray(low, high),
      columns: new Map([...this.columns].map(([name, column]) => [name, column.subarray(low, high)])),
    };
  }

  /** Moves the live part to the front, into twice the room if it fills more than half. */
  private makeRoom(): void {
    const size = this.count * 2 > this.time.length ? this.time.length * 2 : this.time.length;
    const moved = (column: Float64Array) => {
      const out = new Float64Array(size).fill(Number.NaN);
      out.set(column.subarray(this.start, this.start + this.count));
      return out;
    };
    this.time = moved(this.time);
    for (const [name, column] of this.columns) this.columns.set(name, moved(column));
    this.start = 0;
  }
}

/** CSV as the recordings of the project have it: a header `name [unit]`, SI, nan where there is no value. */
export function toCsv(series: Series, unitOf: (name: string) => string): string {
  const names = [...series.columns.keys()];
  const quote = (text: string) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);
  const lines = [["time [s]", ...names.map((name) => `${name} [${unitOf(name)}]`)].map(quote).join(",")];
  const columns = names.map((name) => series.columns.get(name)!);
  for (let i = 0; i < series.time.length; i += 1) {
    lines.push([series.time[i], ...columns.map((c) => (Number.isFinite(c[i]) ? c[i] : "nan"))].join(","));
  }
  return `${lines.join("\n")}\n`;
}
